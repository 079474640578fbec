"""Packages of others bring things of every kind: from a template, as an example of the documentation shows, or here."""

import shutil
import tomllib
from pathlib import Path

import pytest

from architecture import ROOT
from foreign_models import FOREIGN
from packages import install, python
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip_campaigns.measurement import sets

CHECK = """\
from rollslip import get_model
from rollslip.testing import conformance
for kind in {kinds}:
    found = conformance(get_model(kind, f"own-{{kind}}"))
    passed = [one.check for one in found if one.status == "ok"]
    print([kind, passed, [f"{{one.check}}: {{one.message}}" for one in found if one.status == "failed"]])
"""


def test_every_kind_is_brought_by_a_package_of_others():
    examples = (ROOT / "docs" / "example-plugins").glob("*/pyproject.toml")
    points = [
        tomllib.loads(path.read_text(encoding="utf-8"))["project"]["entry-points"]
        for path in examples
    ]
    shown = {group.removeprefix("rollslip.").replace("_", "-") for of in points for group in of}
    written = {kind for kind in kinds() if get_kind(kind).template is not None}
    assert shown - written == {"format"}
    assert set(kinds()) == written | shown | FOREIGN.keys() | {
        "scene"
    }  # tests/catalogue/test_named_data.py


@pytest.mark.slow
def test_the_kit_passes_what_packages_of_others_bring(tmp_path):
    """All in one process, which imports the kit once."""
    data = shutil.copytree(Path(sets.__file__).parent / "guo-keller-2020", tmp_path / "data")
    about = (data / "measurement.toml").read_text(encoding="utf-8")
    (data / "measurement.toml").write_text(about.replace('"guo-keller-2020"', '"own-measurement"'))
    for kind, source in FOREIGN.items():
        file = kind.replace("-", "_")
        text = source.replace("DATA", data.as_posix())
        install(tmp_path, f"own-{kind}", text, kind=file, name=f"own-{kind}", module=f"own_{file}")
    found = python(CHECK.format(kinds=[*FOREIGN]), tmp_path)
    assert [kind for kind, *_ in found] == [*FOREIGN]
    for kind, passed, failed in found:
        assert (kind, failed) == (kind, [])
        assert "check_is_named_as_its_entry_point" in passed
