"""What a reader cannot see whole is found: docs/scripts/clipping.py on pages with a fault each."""

import importlib.util
import shutil
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
pytestmark = [pytest.mark.soak, pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")]

FORMULA = "<math display='block'><mfrac><mi>a</mi><mi>b</mi></mfrac><mo>=</mo><mi>c</mi></math>"
PAGES = {
    "whole": ("<p>words</p>", set()),
    "cut": (
        f"<div style='overflow:hidden;height:14px'>{FORMULA}</div>",
        {"cut off above or below"},
    ),
    "scrolled": (
        f"<div style='overflow:auto;width:20px'>{FORMULA}</div>",
        {"a formula has to be scrolled"},
    ),
    "beyond": (
        "<p style='white-space:nowrap'>" + "wide " * 300 + "</p>",
        {"out of the page", "the page has to be scrolled sideways"},
    ),
    "cell": (
        "<table style='table-layout:fixed;width:60px'><tr><td>unbreakable</td><td></td></tr></table>",
        {"runs out of its cell"},
    ),
    "pale": ("<p style='color:#ccc'>words</p>", {"too little contrast: rgb(204, 204, 204)"}),
    "lost": ("<img src='nowhere.png' width='20' height='20'>", {"picture is missing"}),
}


def test_every_fault_is_found_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "scripts")
    spec = importlib.util.spec_from_file_location("clipping", DOCS / "scripts" / "clipping.py")
    clipping = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(clipping)
    monkeypatch.setitem(sys.modules, "clipping", clipping)
    for name, (body, _) in PAGES.items():
        page = f"<!doctype html><title>{name}</title><body style='background:white;color:black'>{body}</body>"
        (tmp_path / f"{name}.html").write_text(page, encoding="utf-8")
    found = clipping.look(tmp_path, [(f"/{name}.html", 1280) for name in PAGES], CHROMIUM)
    for name, (_, faults) in PAGES.items():
        assert {
            row[3] for row in found if row[0] == f"/{name}.html" and row[2] == "light"
        } == faults, name
