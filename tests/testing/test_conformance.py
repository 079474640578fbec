"""Every model in the box against the conformance kit, and the kit as packages use it: class, function, process."""

import contextlib
import json
import subprocess
import sys
from types import SimpleNamespace

import attrs
import pytest

from broken_models import Explicit, Film
from kit import LEFT
from rollslip import available, get_model
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.cli.models import print_models
from rollslip.errors import PluginError
from rollslip.testing import (
    Conformance,
    Finding,
    all_checks,
    as_dict,
    check_in_subprocess,
    checks_of,
    conformance,
    format_findings,
)
from rollslip.testing.declared import check_computes_its_equation
from rollslip.testing.findings import cases_of, run_after_prerequisite
from rollslip.testing.numbers import OPERATIONS, operations
from rollslip.testing.rules import Inapplicable
from rollslip.testing.samples import table, with_scene
from rollslip_plugins.drag.torques import ConstantTorque, PetroffLand
from rollslip_plugins.film.formulas import PanHamrock
from rollslip_plugins.integrators.rules import check_error_falls_with_the_tolerance
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from rollslip_plugins.traction.blend import GreenwoodTripp, LambdaBlend, LinearBlend, ZhouHoeprich
from rollslip_plugins.traction.boundary import Constant, Kragelsky
from rollslip_plugins.traction.eyring import Eyring, MaxwellEyring, Muraki

pytest_plugins = ["pytester"]


#: The numerical references take minutes; they are checked apart.
REFERENCES = {"reynolds-line", "maxwell-eyring-field"}
#: Needs an extra; test_cvode.py checks it where that is installed.
OPTIONAL = {"cvode"}


def box(*kinds):
    """All models of the box of some kinds, with their default parameters, but for references and optional ones."""
    return [
        get_model(kind, name)
        for kind in kinds
        for name, offer in available(kind).items()
        if offer.package == "rollslip" and name not in REFERENCES | OPTIONAL
    ]


class TestContact(Conformance):
    models = box("contact")


class TestFilm(Conformance):
    models = box("film")


class TestPressure(Conformance):
    models = box("pressure")


class TestPressureViscosity(Conformance):
    models = (
        Barus(),
        Roelands(),
        Yasutomi(glass_temperature=200.0, a1=60.0, a2=1e-9, b1=0.2, b2=5e-9, c1=16.0, c2=22.0),
    )


#: Blends, but for one: their law of the film, which costs most, is the same by default.
OTHER_BLENDS = (GreenwoodTripp, LinearBlend, ZhouHoeprich)


class TestTraction(Conformance):
    models = (
        *(model for model in box("traction") if not isinstance(model, OTHER_BLENDS)),
        *(blend(hydrodynamic=Eyring()) for blend in OTHER_BLENDS),
    )


@pytest.mark.soak
class TestReferences(Conformance):
    models = (get_model("film", "reynolds-line"), get_model("traction", "maxwell-eyring-field"))


class TestDrag(Conformance):
    models = box("drag")


class TestIntegrator(Conformance):
    models = box("integrator")


class TestEngine(Conformance):
    models = (
        get_model("engine", "serial"),
        get_model("engine", "threads"),
        get_model("engine", "processes"),
    )


class TestThermal(Conformance):
    models = box("thermal")


class TestDamage(Conformance):
    models = box("damage")


class TestTorque(Conformance):
    models = box("torque")


class TestLoss(Conformance):
    models = box("loss")


class TestRib(Conformance):
    models = box("rib")


class TestLife(Conformance):
    models = box("life")


class TestRings(Conformance):
    models = (
        get_model("ring", "rigid"),
        get_model("ring", "annulus"),
        get_model("ring", "thin"),
        get_model("ring", "thin", seat_stiffness="1 GPa", fit_clearance="20 um"),
    )


DATA = [kind for kind in kinds() if get_kind(kind).data or get_kind(kind).waits]


class TestData(Conformance):
    models = box(*DATA)


#: Built-in models with other parameters than their defaults, which choose other branches.
VARIANTS = (
    PanHamrock(thickness="central"),
    Barus(factor=1.2),
    Roelands(factor=0.8),
    Roelands(alpha="film"),
    Muraki(flash=1.0),
    MaxwellEyring(flash=1.0),
    Kragelsky(limit=0.05, rise=10.0, decay=400.0),
    Constant(coefficient=0.2, transition=0.05),
    LambdaBlend(
        boundary=Constant(), hydrodynamic=MaxwellEyring(), boundary_limit=0.0, exponent=1.0
    ),
    LambdaBlend(hydrodynamic=LambdaBlend(hydrodynamic=Eyring(), boundary_limit=0.5, exponent=2.5)),
    LambdaBlend(hydrodynamic=MaxwellEyring(flash=1.0)),
    PetroffLand(ring="inner"),
    ConstantTorque(size=0.0),
    get_model("thermal", "network", oil_flow=0.02, contact_fraction=0.1),
    get_model("damage", "power-density", over="maximum", allowed="50 MW/m2"),
    get_model("damage", "flash-temperature", conduction="fast", roller_conductivity=25.0),
    get_model(
        "damage", "contact-temperature", flash={"model": "flash-temperature", "conduction": "fast"}
    ),
    get_model("damage", "scuffing-iso", fzg_stage=10, viscosity="15 mPa s", oil="polyglycol"),
    get_model("damage", "scuffing-agma", oil="MIL-PRF-23699", risk=0.01),
    get_model("torque", "skf", series="23", drag="2006"),
    get_model("loss", "radial-lip-seal", number=2, diameter="40 mm"),
    get_model("rib", "open-film", reach=0.3, boundary_coefficient=0.05),
    get_model("life", "iso16281", edge_stress=False),
)


@pytest.mark.soak
class TestVariants(Conformance):
    models = VARIANTS


@pytest.mark.slow
@pytest.mark.parametrize("model", VARIANTS, ids=lambda model: type(model).__name__)
def test_other_parameters_keep_the_rules_of_numbers(model):
    """Processes, threads and imports, which no parameter changes, are those of the defaults above."""
    findings = [
        run_after_prerequisite(*case)[0]
        for case in cases_of(model, {})
        if not any(word in case[1].__name__ for word in LEFT)
    ]
    assert not [finding for finding in findings if finding.status == "failed"]


def test_no_kind_is_left_out():
    classes = {
        "contact",
        "film",
        "traction",
        "drag",
        "integrator",
        "engine",
        "study",
        "thermal",
        "damage",
        "torque",
        "loss",
        "life",
        "rib",
    }
    assert set(kinds()) == {*classes, "pressure", "pressure-viscosity", "ring", *DATA}


def test_laws_of_the_box_that_python_runs_are_what_others_are_held_against():
    counted = {
        model.name: operations(model, table(model, 256))
        for model in box("contact", "film", "pressure", "traction")
        if model.kernel() is None
    }
    assert max(counted.values()) < 0.5 * OPERATIONS


# The function --------------------------------------------------------------------------------------------------------


def test_a_contact_is_checked_with_its_deflection():
    cases = cases_of(get_model("contact", "lundberg"), {})
    assert {subject.name for subject, *_ in cases} == {"lundberg", "lundberg-deflection"}
    named = [case for case in cases if case[1].__name__ == "check_is_named_as_its_entry_point"]
    statuses = {case[0].name: run_after_prerequisite(*case)[0].status for case in named}
    assert statuses == {"lundberg": "ok", "lundberg-deflection": "skipped"}


@pytest.mark.quick
def test_an_expected_failure_has_to_happen_and_a_reason():
    model = get_model("film", "moes")
    finding = by_check(
        conformance(model, {"check_film_is_positive": "negative films exist, doi:none"})
    )
    assert finding["check_film_is_positive"].status == "failed"
    assert (
        "it passes, but is listed as an expected failure"
        in finding["check_film_is_positive"].message
    )
    with pytest.raises(
        PluginError, match="'check_film_is_nice', which is not a check; there are: check_a"
    ):
        conformance(model, {"check_film_is_nice": "it is not"})
    with pytest.raises(
        PluginError, match="expected failure of check_film_is_positive has no reason"
    ):
        conformance(model, {"check_film_is_positive": " "})
    with pytest.raises(PluginError, match="Moes is a class; the checks take a model"):
        conformance(type(model))


@pytest.mark.quick
def test_a_failure_that_the_class_declares_is_expected():
    """LSODA stands on the spot before a singularity."""
    finding = by_check(conformance(get_model("integrator", "lsoda")))["check_reports_a_failure"]
    assert finding.status == "expected"
    assert "LSODA" in finding.message


def by_check(findings):
    return {finding.check: finding for finding in findings}


@pytest.mark.quick
def test_findings_are_text_and_json():
    findings = [
        Finding("flat", "check_is_frozen", "ok"),
        Finding("flat", "check_is_odd_in_slip", "expected", "it is not"),
        Finding("round", "check_is_frozen", "failed", "it can be set"),
    ]
    assert format_findings(findings) == (
        "flat: 1 ok, 1 expected\n  expected  check_is_odd_in_slip: it is not\n"
        "round: 1 failed\n  failed    check_is_frozen: it can be set"
    )
    read = json.loads(json.dumps(as_dict(findings)))
    assert read["passed"] is False
    assert read["counts"] == {"expected": 1, "failed": 1, "ok": 1}
    assert read["findings"][2]["message"] == "it can be set"
    assert as_dict(findings[:2])["passed"] is True


@pytest.mark.quick
def test_every_check_is_named_as_a_sentence_and_says_why():
    for check in all_checks():
        assert check.__name__.startswith("check_")
        assert check.__name__.count("_") >= 2
        assert check.__doc__.strip().endswith(".")


# The class -----------------------------------------------------------------------------------------------------------


@pytest.mark.soak
def test_a_test_class_gives_one_test_a_model_and_check(pytester):
    pytester.makepyfile(
        """
        from rollslip.testing import Conformance
        from rollslip_plugins.integrators.scipy import Lsoda, Rk23, Rk45

        class TestGood(Conformance):
            models = [Rk23(), Rk45()]

        class TestDeclared(Conformance):
            models = [Lsoda()]
            expected_failures = {"check_adapts_its_steps": "no reason at all"}
        """
    )
    checks = len(conformance(get_model("integrator", "rk23")))
    result = pytester.runpytest_subprocess("-p", "no:cacheprovider", "-n0", "-q", "-W", "error")
    # LSODA: one declared by its class, one without a fixed order
    result.assert_outcomes(passed=3 * checks - 3, failed=1, xfailed=1, skipped=1)
    result.stdout.fnmatch_lines(
        ["*it passes, but is listed as an expected failure (no reason at all)*"]
    )


def test_a_class_without_models_is_an_error():
    class TestNothing(Conformance):
        pass

    with pytest.raises(
        PluginError, match=r"^TestNothing\.models is empty; list the models to check$"
    ):
        TestNothing().pytest_generate_tests(SimpleNamespace(fixturenames=["conformance_case"]))


def test_the_kit_needs_hypothesis_and_says_so():
    code = (
        "import sys, rollslip\n"
        "assert not {'hypothesis', 'pytest', 'rollslip.testing'} & set(sys.modules)\n"
        "sys.modules['hypothesis'] = None\n"
        "from rollslip.errors import PluginError\n"
        "try:\n    import rollslip.testing\n"
        "except PluginError as error:\n    assert 'install rollslip[kit]' in str(error)\n"
        "else:\n    raise SystemExit('no error')\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.slow
def test_the_kit_does_not_need_pytest():
    code = (
        "import sys\nsys.modules['pytest'] = None\n"
        "from rollslip import get_model\nfrom rollslip.testing import conformance\n"
        "assert {f.status for f in conformance(get_model('ring', 'rigid'))} == {'ok'}\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# The process ---------------------------------------------------------------------------------------------------------


@pytest.mark.soak
def test_a_good_model_passes_in_a_process_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    findings = check_in_subprocess("traction", "kragelsky")
    assert not [*tmp_path.iterdir()], "nothing is left where the user works"
    assert {finding.status for finding in findings} == {"ok"}
    assert by_check(findings).keys() == by_check(conformance(Kragelsky())).keys()


def test_a_model_that_nobody_offers_is_no_finding():
    with pytest.raises(PluginError, match="no film is called 'mos'; did you mean 'moes'"):
        check_in_subprocess("film", "mos")


def test_a_model_shows_the_numbers_of_others_that_it_reproduces(capsys):
    print_models("moes")
    shown = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("value "))
    # H = 7.187242 of the source, times R sqrt(2 U)
    assert f"{7.187242 * 0.01 * 2e-10**0.5:.7g} at load = 200000" in shown
    assert "composed in thirty digits" in shown


def test_errors_of_rounding_need_not_fall_with_the_tolerance():
    @attrs.frozen
    class Careful(Explicit):
        solver_name = "Careful"

    check_error_falls_with_the_tolerance(Careful())


#: Built-in laws whose equation is explicit in symbols that are documented.
EXPLICIT = """barus blok churning constant constant-torque dowson-1968 dowson-higginson dowson-toyoda
    goksem-hargreaves gupta herrebrugh hertz hysteresis iso16281 kragelsky light-contact lundberg martin palmgren
    zhou-hoeprich"""


def test_which_equations_of_built_in_laws_are_evaluated():
    """The names are of explicit equations, read one by one; what iterates, integrates or has submodels is not."""
    compared = set()
    models = box("contact", "film", "pressure", "traction", "drag")
    for model in (*models, *TestPressureViscosity.models):
        if check_computes_its_equation in checks_of(model):
            with contextlib.suppress(Inapplicable):
                check_computes_its_equation(with_scene(model))
                compared.add(model.name)
    assert compared == set(EXPLICIT.split())


@pytest.mark.parametrize(
    "equation",
    [
        "h = __import__(c)",
        "h = c.factor",
        "h = (lambda: c)()",
        "h = c if c else c",
        "h = x, x = c x",
        "h = mean of c",
        "h = c (",
        "",
    ],
)
def test_an_equation_is_never_executed(equation):
    """What is no arithmetic in known symbols is left out, and so is what needs itself."""
    other = type("Other", (Film,), {"equation": equation, "__module__": __name__})
    with pytest.raises(Inapplicable):
        check_computes_its_equation(other())
