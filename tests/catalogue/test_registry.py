"""Finding models: the catalogue without imports, one fault one sentence, parameters, and what every model declares."""

import inspect
import tomllib
from pathlib import Path
from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from packages import python
from rollslip import available, get_model, hookspecs
from rollslip.catalogue import discovery, installed
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.catalogue.registry import catalogue, find, get_class
from rollslip.engine import Engine
from rollslip.errors import PluginError, SceneError
from rollslip.hookspecs import hookspec
from rollslip.lubricant import Lubricant
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import (
    ContactModel,
    Drag,
    FilmModel,
    IntegratorModel,
    PressureModel,
    RibModel,
    TractionModel,
    submodel,
)
from rollslip.planning.campaign import Campaign
from rollslip.rings import RingModel
from rollslip.studies.rating_life.model import LifeModel
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import TorqueFormula
from rollslip.studies.study import Study
from rollslip.studies.surface_damage.model import DamageModel
from rollslip.studies.thermal_balance.model import ThermalModel
from rollslip_plugins.traction.boundary import Constant, Kragelsky
from rollslip_plugins.traction.eyring import MaxwellEyring
from rollslip_plugins.traction.local import MaxwellEyringLocal

PROMISED = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"][
    "entry-points"
]
KINDS = PROMISED.pop("rollslip.kind")
FAMILIES = {
    name: (group.removeprefix("rollslip."), path)
    for group, names in PROMISED.items()
    for name, path in names.items()
    if ":" in path
}
OFFERED = [
    (group.removeprefix("rollslip.").replace("_", "-"), name)
    for group, names in PROMISED.items()
    for name in names
    if name not in FAMILIES
]
#: Parameters of laws that have no defaults: constants are an oil's own.
MADE = {
    "yasutomi": {
        "glass_temperature": 245.0,
        "a1": 134.0,
        "a2": 2e-9,
        "b1": 4.8,
        "b2": 1.6e-10,
        "c1": 16.0,
        "c2": 20.7,
    }
}
BASES = {
    "contact": ContactModel,
    "film": FilmModel,
    "pressure": PressureModel,
    "traction": TractionModel,
    "pressure-viscosity": PressureViscosity,
    "drag": Drag,
    "integrator": IntegratorModel,
}
every_offer = pytest.mark.parametrize(
    ("kind", "name"), OFFERED, ids=["-".join(offer) for offer in OFFERED]
)


# Catalogue -----------------------------------------------------------------------------------------------------------


def test_the_catalogue_lists_what_the_package_promises():
    ours = [(offer.kind, offer.name) for offer in catalogue() if offer.package == "rollslip"]
    assert sorted(ours) == sorted(
        [*OFFERED, *((kind, name) for name, (kind, _) in FAMILIES.items())]
    )
    assert {offer.state for offer in catalogue() if offer.package == "rollslip"} == {"ok"}
    assert set(kinds()) == set(KINDS)
    for kind in kinds():
        assert set(available(kind)) >= {name for other, name in OFFERED if other == kind}
    with pytest.raises(TypeError):
        available("film")["mine"] = None


def test_a_family_offers_all_its_names_and_is_none_itself():
    assert list(FAMILIES) == [
        "cylindrical-roller",
        "full-complement",
        "needle-roller",
        "tapered-roller",
    ]
    for name, (kind, path) in FAMILIES.items():
        ((offer, family),) = (pair for pair in discovery.families(kind) if pair[0].name == name)
        assert (offer.name, offer.module) == (family.name, path) == (name, path)
        assert family.name not in available(kind)
        assert not set(family.names) & set(available(kind))
        assert get_class(kind, family.names[0]).name == family.names[0]


@pytest.mark.parametrize(
    ("module", "told"),
    [
        ("rollslip_plugins.data.cylindrical:NOTHING", "is not a family of named data"),
        ("rollslip_plugins.data.cylindrical:RULES", "is not a family of named data"),
        ("rollslip_plugins.data.nowhere:CATALOGUE", "cannot be imported"),
    ],
)
def test_a_broken_family_says_why_and_hides_no_other_name(monkeypatch, module, told):
    broken = discovery.Offer(
        kind="bearing", name="broken", package="broken", version="1", module=module
    )
    installed = (*discovery._installed(), broken)
    monkeypatch.setattr(discovery, "_installed", lambda: installed)
    with pytest.raises(PluginError, match=told):
        discovery.load(broken)
    assert find("bearing", "nu 2210").name == "NU2210E"


def test_two_that_mean_the_same_are_both_named(monkeypatch):
    twin = discovery.Offer(
        kind="bearing",
        name="twin",
        package="other",
        version="1",
        module=FAMILIES["cylindrical-roller"][1],
    )
    installed = (*discovery._installed(), twin)
    monkeypatch.setattr(discovery, "_installed", lambda: installed)
    monkeypatch.setattr(
        discovery,
        "load",
        lambda offer, load=discovery.load: load(attrs.evolve(offer, name="cylindrical-roller")),
    )
    with pytest.raises(
        PluginError, match="may be 'NU2210E' of package rollslip and 'NU2210E' of package other"
    ):
        find("bearing", "NU2210")


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("ISO VG 68", "iso-vg-68"),
        ("vg68", "iso-vg-68"),
        ("MIL-L-7808", "mil-prf-7808"),
        ("SAE30", "sae-30"),
    ],
)
def test_names_of_data_are_found_in_any_spelling_and_by_synonyms(written, meant):
    assert find("lubricant", written).name == meant
    with pytest.raises(PluginError, match="no film is called 'Moes'"):
        find("film", "Moes")  # of a law a scene means what it says


def test_listing_imports_no_model_and_asking_for_one_only_its_module():
    loaded = "print(sorted(name for name in sys.modules if name.startswith(('rollslip_plugins', 'scipy', 'pluggy'))))"
    listed, film, again, traction = python(
        f"""
        import sys
        from rollslip import available, get_model
        for kind in ("contact", "film", "traction", "drag", "integrator", "lubricant"):
            available(kind)
        {loaded}
        get_model("film", "moes")
        print(sorted(name for name in sys.modules if name.startswith("rollslip_plugins")))
        get_model("film", "martin")
        print(sorted(name for name in sys.modules if name.startswith("rollslip_plugins")))
        get_model("traction", "kragelsky")
        print(sorted(name for name in sys.modules if name.startswith("rollslip_plugins")))
    """,
        fresh=True,
    )
    assert listed == []
    first = [
        f"rollslip_plugins{name}"
        for name in ("", ".bibliography", ".film", ".film.formulas", ".symbols")
    ]
    assert film == again == first
    assert traction == [*first, "rollslip_plugins.traction", "rollslip_plugins.traction.boundary"]


@every_offer
def test_every_entry_point_leads_to_a_thing_of_its_kind_and_name(kind, name):
    thing = get_class(kind, name)
    assert thing.name == name
    beside = {
        "thermal": ThermalModel, "damage": DamageModel, "torque": TorqueFormula, "loss": LossModel,
        "life": LifeModel, "ring": RingModel, "rib": RibModel,
    }  # fmt: skip
    classes = {**BASES, **beside, "engine": Engine, "study": Study, "campaign": Campaign}
    if kind in classes:
        assert issubclass(thing, classes[kind])
        assert not inspect.isabstract(thing)
    else:
        assert not isinstance(thing, type)  # data: a value, checked when it was made
        assert isinstance(thing, Lubricant) == (kind == "lubricant")
    offer = find(kind, name)
    assert (offer.package, offer.module) == (
        "rollslip",
        PROMISED[f"rollslip.{kind.replace('-', '_')}"][name],
    )
    assert get_class(kind, name) is thing


@pytest.mark.parametrize(
    ("kind", "name", "sentence"),
    [
        ("film", "mos", "no film is called 'mos'; did you mean 'moes'?"),
        (
            "film",
            "dowson",
            "no film is called 'dowson'; did you mean 'dowson-1968' or 'dowson-toyoda'",
        ),
        ("traction", "maxwell", "no traction is called 'maxwell'; did you mean 'maxwell-eyring'"),
        (
            "traction",
            "zzz",
            "no traction is called 'zzz'; there are: carreau, constant, eyring, eyring-thermal, ",
        ),
        ("film", "muraki", "no film is called 'muraki'"),
        ("fil", "moes", "no kind of model is called 'fil'; did you mean 'film'?"),
        (
            "zzz",
            "x",
            "no kind of model is called 'zzz'; there are: account, bearing, campaign, contact, damage, drag, engine,",
        ),
    ],
)
def test_an_unknown_name_is_answered_with_the_nearest(kind, name, sentence):
    for ask in (find, get_class, get_model):
        with pytest.raises(PluginError) as error:
            ask(kind, name)
        assert sentence in str(error.value)
        assert "\n" not in str(error.value)


def test_an_unknown_kind_has_no_models():
    with pytest.raises(
        PluginError, match="no kind of model is called 'lubricants'; did you mean 'lubricant'"
    ):
        available("lubricants")


# Packages of strangers -----------------------------------------------------------------------------------------------

MODULE = """\
import attrs
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.models import FilmModel

@attrs.frozen(kw_only=True)
class Flat(FilmModel):
    name = {name!r}
    equation = "h = h0"
    references = ("none",)
    location = "minimum"
    thickness: float = parameter(default=1e-6, unit="m", validator=positive, doc="film thickness")

    def evaluate(self, slices):
        slices.film_thickness[...] = self.thickness

@hookimpl
def film_models():
    return [Flat]
"""


def package(
    folder, name, *, film="flat", module=None, source=None, requires=("rollslip",), version="1.0"
):
    """Install a package that offers a film model, as pip would leave it: a module, METADATA, entry points."""
    module = module or name.replace("-", "_")
    info = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    lines = ["Metadata-Version: 2.1", f"Name: {name}", f"Version: {version}"]
    lines += [f"Requires-Dist: {requirement}" for requirement in requires]
    (info / "METADATA").write_text("\n".join(lines) + "\n")
    (info / "entry_points.txt").write_text(f"[rollslip.film]\n{film} = {module}\n")
    (folder / f"{module}.py").write_text(MODULE.format(name=film) if source is None else source)


ASK = """
    from rollslip import available, get_model
    from rollslip.errors import PluginError
    from rollslip.catalogue.registry import catalogue
    print([(o.name, o.package, o.version, o.state, o.cause) for o in catalogue() if o.package != "rollslip"])
    print("flat" in available("film"))
    try:
        print(repr(str(get_model("film", "flat"))))
    except PluginError as error:
        print(repr(str(error).removeprefix("flat: ")))  # the place in the scene comes first
    print([get_model("film", name).name for name in available("film") if name != "flat"])  # nobody else suffers
"""
OTHERS = sorted(PROMISED["rollslip.film"])


@pytest.mark.parametrize(
    "hook", ["@hookimpl\ndef film_models", "def film_models", "@hookimpl\ndef traction_models"]
)
def test_a_package_of_a_stranger_is_found_by_its_hook_or_by_its_class(tmp_path, hook):
    source = MODULE.format(name="flat").replace("@hookimpl\ndef film_models", hook)
    package(tmp_path, "rollslip-flat", source=source, requires=["rollslip>=0.1", "numpy"])
    offers, listed, answer, others = python(ASK, tmp_path)
    assert offers == [("flat", "rollslip-flat", "1.0", "ok", "")]
    assert (listed, answer, others) == (True, "Flat(thickness=1e-06)", OTHERS)


BROKEN = "film 'flat' of package rollslip-flat 1.0"
IMPORT = "cannot be imported ({}); repair or uninstall rollslip-flat"


@pytest.mark.parametrize(
    ("source", "answer"),
    [
        (
            "import nothing_of_that_name",
            IMPORT.format("ModuleNotFoundError: No module named 'nothing_of_that_name'"),
        ),
        ("raise RuntimeError('half a module')", IMPORT.format("RuntimeError: half a module")),
        ("def (", IMPORT.format("SyntaxError: invalid syntax (rollslip_flat.py, line 1)")),
        ("1 / 0", IMPORT.format("ZeroDivisionError: division by zero")),
    ],
    ids=["missing module", "error", "syntax", "zero"],
)
def test_a_package_that_cannot_be_imported_says_why(tmp_path, source, answer):
    package(tmp_path, "rollslip-flat", source=source)
    offers, listed, said, others = python(ASK, tmp_path)
    assert offers == [("flat", "rollslip-flat", "1.0", "ok", "")]  # without an import nobody knows
    assert (listed, said, others) == (True, f"{BROKEN} {answer}", OTHERS)


@pytest.mark.parametrize(
    ("source", "offered"),
    [
        (MODULE.format(name="round"), "'round'"),
        (MODULE.format(name="flat").replace("return [Flat]", "return []"), "nothing"),
        ("", "nothing"),
    ],
    ids=["another name", "empty list", "empty module"],
)
def test_a_package_that_does_not_offer_what_it_promises_says_so(tmp_path, source, offered):
    package(tmp_path, "rollslip-flat", source=source)
    *_, said, others = python(ASK, tmp_path)
    assert (
        said == f"{BROKEN}: its film_models() offers {offered}, but its entry point promises 'flat'"
    )
    assert others == OTHERS


def test_an_entry_point_without_a_module_says_so(tmp_path):
    package(tmp_path, "rollslip-flat")
    (tmp_path / "rollslip_flat.py").unlink()
    *_, said, others = python(ASK, tmp_path)
    assert said == f"{BROKEN} " + IMPORT.format(
        "ModuleNotFoundError: No module named 'rollslip_flat'"
    )
    assert others == OTHERS


@pytest.mark.parametrize("requires", ["rollslip>=99", "rollslip<0.1", "rollslip==0.0.1,>0"])
def test_a_package_for_another_rollslip_is_incompatible_without_an_import(tmp_path, requires):
    package(
        tmp_path,
        "rollslip-flat",
        requires=["numpy>=99", requires],
        source="raise SystemExit('imported')",
    )
    offers, listed, said, others = python(ASK, tmp_path)
    (name, _, _, state, cause), *rest = offers
    assert (name, state, listed, rest, others) == ("flat", "incompatible", False, [], OTHERS)
    assert cause.startswith("requires rollslip")
    assert cause.endswith("; install a version that fits")
    assert said == f"film 'flat' of package rollslip-flat: {cause}"


def test_a_disabled_package_is_not_imported(tmp_path):
    package(tmp_path, "rollslip-flat", source="raise SystemExit('imported')")
    package(tmp_path, "rollslip-other", film="other")
    for disabled in ("rollslip-flat", "x, rollslip-flat ,y"):
        offers, listed, said, others = python(ASK, tmp_path, ROLLSLIP_DISABLED_PLUGINS=disabled)
        cause = "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it"
        assert offers == [
            ("flat", "rollslip-flat", "1.0", "disabled", cause),
            ("other", "rollslip-other", "1.0", "ok", ""),
        ]
        assert (listed, said) == (False, f"film 'flat' of package rollslip-flat: {cause}")
        assert others == sorted([*OTHERS, "other"])


def test_two_packages_with_one_name_are_both_named(tmp_path):
    package(tmp_path, "rollslip-flat")
    package(tmp_path, "flatter")
    offers, listed, said, others = python(ASK, tmp_path)
    cause = "packages flatter and rollslip-flat offer this name; uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS"
    assert [(package, state) for _, package, _, state, _ in offers] == [
        ("flatter", "shadowed"),
        ("rollslip-flat", "shadowed"),
    ]
    assert (listed, said, others) == (False, f"film 'flat' of package flatter: {cause}", OTHERS)
    # the remedies work
    *_, said, _ = python(ASK, tmp_path, ROLLSLIP_DISABLED_PLUGINS="flatter")
    assert said == "Flat(thickness=1e-06)"


def test_a_package_cannot_take_over_a_name_of_the_box(tmp_path):
    package(tmp_path, "impostor", film="moes")
    code = ASK.replace('"flat"', '"moes"')
    _, listed, said, _ = python(code, tmp_path)
    assert not listed
    assert "packages impostor and rollslip offer this name" in said


def test_a_package_found_twice_on_the_path_is_one(tmp_path):
    first = tmp_path / "first"
    second = tmp_path / "second"
    package(first, "rollslip-flat")
    package(second, "rollslip-flat", version="0.9")
    offers, *_, said, others = python(ASK, first, second)
    assert offers == [("flat", "rollslip-flat", "1.0", "ok", "")]
    assert (said, others) == ("Flat(thickness=1e-06)", OTHERS)


def test_several_faults_do_not_hide_a_good_package(tmp_path):
    package(tmp_path, "rollslip-flat")
    package(tmp_path, "bad-import", film="bad", source="import nothing_of_that_name")
    package(tmp_path, "too-new", film="new", requires=["rollslip>99"])
    package(tmp_path, "no-version-syntax", film="odd", requires=["rollslip !! 3"])
    offers, listed, said, _ = python(
        ASK.replace('if name != "flat"', 'if name not in ("flat", "bad")'), tmp_path
    )
    assert {name: state for name, _, _, state, _ in offers} == {
        "flat": "ok",
        "bad": "ok",
        "new": "incompatible",
        "odd": "ok",
    }
    assert (listed, said) == (True, "Flat(thickness=1e-06)")


def test_parameters_of_a_stranger_are_read_with_their_units(tmp_path):
    package(tmp_path, "rollslip-flat")
    good, *faults = python(
        """
        from rollslip import get_model
        from rollslip.errors import SceneError
        print([get_model("film", "flat", thickness=t).thickness for t in ("2 um", "0.5 mm", 3e-7)])
        for value in ("2 K", "2,5 um", "2", "thick", True, -1.0, "0 um"):
            try:
                print(repr(get_model("film", "flat", thickness=value)))
            except SceneError as error:
                print(error.problems)
        """,
        tmp_path,
    )
    assert good == [2e-6, 5e-4, 3e-7]
    expected = [
        "'2 K' is a temperature, here a length is expected, such as '15 mm'",
        "decimal comma",
        "'2'",
        "'thick'",
        "true is not a quantity",
        "must be above 0, not -1 m",
        "must be above 0",
    ]
    for (problem,), part in zip(faults, expected, strict=True):
        assert problem.startswith("flat.thickness: ")
        assert part in problem


# Parameters ----------------------------------------------------------------------------------------------------------


def test_get_model_reads_plain_numbers_and_percent():
    assert get_model("traction", "constant", coefficient="5 %", transition=2e-3) == Constant(
        coefficient=0.05, transition=2e-3
    )
    assert get_model("film", "pan-hamrock", thickness="central").law.c == 2.922
    assert get_model("traction", "kragelsky") == Kragelsky()


@pytest.mark.parametrize(
    ("kind", "name", "parameters", "problems"),
    [
        (
            "traction",
            "constant",
            {"coeficient": 1},
            ["constant.coeficient: unknown key, did you mean 'coefficient'?"],
        ),
        (
            "traction",
            "constant",
            {"coefficient": "5 mm"},
            ["'5 mm' is a length, here a plain number is expected"],
        ),
        (
            "traction",
            "constant",
            {"coefficient": "0,05"},
            ["a decimal comma is not read; write '0.05'"],
        ),
        (
            "traction",
            "constant",
            {"coefficient": -1, "transition": 0, "x": 1},
            [
                "constant.coefficient: must be above 0, not -1",
                "constant.transition: must be above 0",
                "constant.x: unk",
            ],
        ),
        ("film", "moes", {"thickness": "central"}, ["moes.thickness: unknown key"]),
        (
            "film",
            "pan-hamrock",
            {"thickness": "centre"},
            ["must be one of 'minimum', 'central', not 'centre'"],
        ),
        (
            "traction",
            "lambda-blend",
            {"boundary": {"coefficient": 1}},
            ["lambda-blend.boundary: a traction model is"],
        ),
        (
            "traction",
            "lambda-blend",
            {
                "boundary": {"model": "constant", "coefficient": -1},
                "hydrodynamic": {"model": "muraki", "flesh": 1},
            },
            [
                "lambda-blend.boundary.coefficient: must be above 0",
                "lambda-blend.hydrodynamic.flesh: unknown key",
            ],
        ),
        (
            "traction",
            "lambda-blend",
            {"boundary_limit": 2.0},
            ["hydrodynamic_limit: must be above boundary_limit = 2"],
        ),
    ],
)
def test_bad_parameters_are_all_reported(kind, name, parameters, problems):
    with pytest.raises(SceneError) as error:
        get_model(kind, name, **parameters)
    assert len(error.value.problems) == len(problems)
    for said, expected in zip(sorted(error.value.problems), sorted(problems), strict=True):
        assert expected in said


def test_models_can_be_nested_by_name_by_table_and_as_objects():
    blend = get_model(
        "traction",
        "lambda-blend",
        boundary={"model": "constant", "coefficient": "10 %"},
        hydrodynamic={
            "model": "lambda-blend",
            "boundary": "kragelsky",
            "hydrodynamic": MaxwellEyring(flash=1.0),
        },
    )
    assert blend.boundary == Constant(coefficient=0.1)
    assert blend.hydrodynamic.boundary == Kragelsky()
    assert blend.hydrodynamic.hydrodynamic == MaxwellEyring(flash=1.0)
    assert get_model("traction", "lambda-blend").hydrodynamic == MaxwellEyringLocal()


@pytest.mark.parametrize("child", ["moes", "kragelski"])
def test_an_unknown_nested_model_is_named_with_its_place(child):
    with pytest.raises(
        PluginError, match=f"^lambda-blend.boundary: no traction is called '{child}'; "
    ):
        get_model("traction", "lambda-blend", boundary={"model": child})


def test_a_lubricant_is_a_value_and_takes_no_parameters():
    assert get_model("lubricant", "sae-30").name == "sae-30"
    with pytest.raises(
        PluginError, match="takes no parameters here, got eyring_stress; set them in a scene"
    ):
        get_model("lubricant", "sae-30", eyring_stress=1e6)


# What is declared ----------------------------------------------------------------------------------------------------


def test_every_kind_has_a_hook_and_every_hook_a_docstring():
    marked = {
        name: thing
        for name, thing in vars(hookspecs).items()
        if hasattr(thing, f"{hookspec.project_name}_spec")
    }
    assert set(marked) == {get_kind(kind).hook for kind in kinds()}
    for hook in marked.values():
        assert (hook.__doc__ or "").strip().endswith(".")
        assert not inspect.signature(hook).parameters  # hooks only collect


def test_every_law_of_a_slice_is_compiled_but_for_references_and_a_table_that_scipy_interpolates():
    laws = [
        (kind, name)
        for kind, name in OFFERED
        if kind in ("contact", "film", "traction", "pressure-viscosity")
    ]
    in_numpy = {
        name for kind, name in laws if get_model(kind, name, **MADE.get(name, {})).kernel() is None
    }
    assert in_numpy == {"reynolds-line", "maxwell-eyring-field", "tabulated"}


# Integrators ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "scipy_name"),
    [
        ("rk23", "RK23"),
        ("rk45", "RK45"),
        ("dop853", "DOP853"),
        ("radau", "Radau"),
        ("bdf", "BDF"),
        ("lsoda", "LSODA"),
    ],
)
def test_scipys_integrators_come_as_they_are(name, scipy_name):
    """y' = -y to t = 1: the global error is some ten times the tolerance of a step for every one of them."""
    import scipy.integrate

    cls = get_model("integrator", name).solver()
    assert cls is getattr(scipy.integrate, scipy_name)
    assert issubclass(cls, scipy.integrate.OdeSolver)
    solution = scipy.integrate.solve_ivp(
        lambda t, y: -y, (0.0, 1.0), [1.0], method=cls, rtol=1e-6, atol=1e-9
    )
    assert solution.success
    np.testing.assert_allclose(solution.y[0, -1], np.exp(-1.0), rtol=2e-5)


def test_the_box_has_all_of_scipys_integrators():
    import scipy.integrate

    theirs = {cls.__name__ for cls in scipy.integrate.OdeSolver.__subclasses__()} - {"RungeKutta"}
    theirs |= {cls.__name__ for cls in scipy.integrate.RK45.__mro__[1].__subclasses__()}
    integrators = PROMISED["rollslip.integrator"]
    listed = [
        name
        for name, module in integrators.items()
        if module == "rollslip_plugins.integrators.scipy"
    ]
    ours = {get_model("integrator", name).solver().__name__ for name in listed}
    assert set(integrators) - set(listed) == {"rodas5p", "leapfrog", "cvode"}
    assert ours == {name for name in theirs if hasattr(scipy.integrate, name)}


def test_a_submodel_may_be_declared_by_its_name():
    class Halved(TractionModel):
        name = "halved"
        of: TractionModel = submodel("traction", default="muraki", doc="the law that is halved")

        def evaluate(self, slices):
            self.of.evaluate(slices)

    halved = attrs.frozen(kw_only=True)(Halved)
    assert halved().of == get_model("traction", "muraki")
    assert halved(of=Constant()).of == Constant()
    for given in ({}, {"factory": Constant, "default": "muraki"}):
        with pytest.raises(
            TypeError, match="takes a factory or the name of its default, one of them"
        ):
            submodel("traction", doc="", **given)


def test_a_release_candidate_of_rollslip_is_one_that_fits(monkeypatch):
    monkeypatch.setattr("importlib.metadata.version", lambda name: "0.2.0rc1")
    assert installed._state(SimpleNamespace(name="x", requires=["rollslip>=0.1"])) == ("ok", "")
    assert (
        installed._state(SimpleNamespace(name="x", requires=["rollslip>=0.3"]))[0] == "incompatible"
    )


def test_of_offers_that_cannot_be_used_the_one_is_told_whose_remedy_helps(monkeypatch):
    offers = tuple(
        discovery.Offer(
            kind="film",
            name="flat",
            package=state,
            version="1",
            module="m",
            state=state,
            cause=state,
        )
        for state in ("incompatible", "shadowed", "disabled")
    )
    monkeypatch.setattr(discovery, "catalogue", lambda: offers)
    with pytest.raises(PluginError, match="film 'flat' of package shadowed: shadowed"):
        find("film", "flat")
