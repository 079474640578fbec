"""The doctor finds a healthy installation healthy, and names what is broken with what to do."""

import json

import pytest

from broken_models import oil
from packages import TRACTION, install, python, rollslip
from registrations import registrations_rolled_back
from rollslip.catalogue.discovery import add
from rollslip.cli import doctor
from rollslip.cli.doctor import Finding, as_text, examine, healthy
from rollslip.fields import Scatter
from rollslip.scene.oil import faulty_constants
from rollslip_kernels.stages import simd


def test_this_installation_is_healthy():
    code, out, _ = rollslip("doctor", "--json", path="")
    found = [Finding(**row) for row in json.loads(out)]
    assert code == 0, as_text(found)
    by_check = {finding.check: finding for finding in found}
    assert {"python", "numpy", "instructions", "plugin rollslip"} <= set(by_check)
    assert by_check["instructions"].found.startswith(f"{simd.active()}, of ")
    assert all(finding.remedy for finding in found if finding.state != "ok")
    assert {finding.state for finding in found} <= {"ok", "warning"}


def test_a_warning_is_no_fault_and_numbers_of_both_are_told():
    warned = [Finding("x", "warning", "y"), Finding("z", "ok", "1")]
    assert healthy(warned)
    assert as_text(warned).splitlines()[0].startswith("1 warning: rollslip ")
    faults = [*warned, Finding("a", "fault", "b", "c"), Finding("d", "fault", "e", "f")]
    assert not healthy(faults)
    assert as_text(faults).splitlines()[0].startswith("2 faults and 1 warning: ")
    assert "ok " not in as_text(faults)
    assert "ok " in as_text(faults, verbose=True)


def test_an_instruction_set_that_is_not_there_is_the_only_fault():
    code, out, _ = rollslip("doctor", path="", fresh=True, ROLLSLIP_SIMD="v9")
    assert code == 5
    faults = [line for line in out.splitlines() if line.startswith("fault")]
    assert len(faults) == 1
    assert "ROLLSLIP_SIMD = 'v9' names no instruction set of this machine" in faults[0]
    assert out.splitlines()[0].startswith("1 fault and ")
    assert "-> unset ROLLSLIP_SIMD" in out
    assert "not examined" in out


def test_packages_of_strangers_are_told_with_their_state(tmp_path):
    install(tmp_path, "rollslip-good", TRACTION)
    install(tmp_path, "rollslip-exits", "raise SystemExit(3)")
    install(tmp_path, "rollslip-new", "", requires=["rollslip>=99"])
    install(tmp_path, "rollslip-off", "")
    code = "from rollslip.cli.doctor import _plugins\nprint([(f.check, f.state, f.remedy) for f in _plugins()])"
    (found,) = python(code, tmp_path, ROLLSLIP_DISABLED_PLUGINS="rollslip-off")
    assert {check: state for check, state, _ in found} == {
        "plugin rollslip": "ok",
        "plugin rollslip-good": "ok",
        "plugin rollslip-exits": "fault",
        "plugin rollslip-new": "fault",
        "plugin rollslip-off": "warning",
    }
    remedies = {check: remedy for check, _, remedy in found}
    assert "cannot be imported (SystemExit: 3); repair" in remedies["plugin rollslip-exits"]


@pytest.mark.parametrize(
    ("installed", "found"), [("", "is not installed, needs >="), ("0.1", "0.1, needs >=")]
)
def test_a_dependency_that_is_missing_or_old_is_a_fault(monkeypatch, installed, found):
    monkeypatch.setattr(
        doctor, "_version", lambda name: installed if name == "h5netcdf" else "9999"
    )
    (fault,) = [finding for finding in doctor._dependencies() if finding.state == "fault"]
    assert fault.check == "h5netcdf"
    assert fault.found.startswith(found)
    assert fault.remedy.startswith("install it with: pip install 'h5netcdf>=")


def test_a_narrower_instruction_set_than_could_run_is_a_warning(monkeypatch):
    monkeypatch.setattr(simd, "available", lambda: (simd.active(), "v99"))
    (instructions,) = doctor._kernels()
    assert instructions.state == "warning"
    assert instructions.remedy == "unset ROLLSLIP_SIMD to use v99"


def test_variables_that_nobody_reads_are_a_warning(monkeypatch):
    monkeypatch.setenv("ROLLSLIP_SMID", "v3")
    monkeypatch.setenv("ROLLSLIP_THREADS", "1")
    states = {finding.check: finding for finding in doctor._environment()}
    finding = states["ROLLSLIP_SMID"]
    assert finding.state == "warning"
    assert states["ROLLSLIP_THREADS"].state == "ok"
    assert "ROLLSLIP_SIMD" in finding.remedy


def test_a_check_that_fails_is_a_fault_of_its_own(monkeypatch):
    def _broken():
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(doctor, "CHECKS", (_broken, doctor._python))
    found = examine()
    assert {finding.check: finding.state for finding in found} == {
        "broken": "fault",
        "python": "ok",
        "rollslip": "ok",
    }
    assert "cannot be examined (ZeroDivisionError: oh)" in found[0].found
    assert not healthy(found)
    assert as_text(found).startswith("1 fault: ")


def test_an_oil_of_a_package_with_unusual_data_or_constants_of_no_law_is_a_warning():
    with registrations_rolled_back():
        models = {"muraki": {"flash": -1.0}, "nobody": {"x": 1.0}, "flush": 1.0}
        add("lubricant", oil(name="odd", eyring_stress=5.0, models=models))
        add("lubricant", oil(name="even"))
        found = {finding.check: finding for finding in doctor._oils()}
    assert {name: one.state for name, one in found.items()} == {
        "oil odd": "warning",
        "oil even": "ok",
    }
    assert found["oil odd"].found.endswith(
        "'5 MPa'?; nobody is of no law that is installed; flush is of no law that is installed; "
        "did you mean 'flash'?; "
        "muraki.flash: must be above 0, not -1"
    )


@pytest.mark.parametrize(
    ("quantity", "is_known"),
    [
        ("viscosity_factor", True),
        ("muraki.flash", True),
        ("viscosty", False),
        ("muraki.flush", False),
    ],
)
def test_the_scatter_of_what_no_oil_and_no_law_has_is_a_fault(quantity, is_known):
    scatter = Scatter(
        quantity=quantity,
        distribution="lognormal",
        parameters={"scatter": 0.3},
        grade="(D)",
        source="-",
    )
    faults = faulty_constants(oil(name="own", scatter=(scatter,)))
    assert faults == (
        []
        if is_known
        else [f"scatter of {quantity}, which no oil and no law that is installed has"]
    )
