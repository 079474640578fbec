"""Models without a package: functions and classes of a process, C libraries through ctypes, and Numba."""

import ctypes
import gc
import importlib.util
import json
import shutil
import subprocess
import threading
import weakref

import attrs
import numpy as np
import pytest

from rollslip import (
    Chain,
    Conditions,
    Slices,
    available,
    evolve,
    get_include,
    get_model,
    load_scene,
    run,
    sweep,
)
from rollslip.catalogue import discovery
from rollslip.catalogue.packages import packages, requirements
from rollslip.catalogue.registry import catalogue, find, get_class
from rollslip.catalogue.session import model, register
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.fields import parameter, positive
from rollslip.foreign import EVALUATE, SlicesStruct, capsule_from_address, numba_slices
from rollslip.models import FINITE, POSITIVE, ContactModel, FilmModel, TractionModel
from rollslip.planning.plan import plan
from rollslip.testing import conformance
from rollslip_kernels.layout import layout
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_plugins.film.formulas import Moes
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.boundary import Constant

pytestmark = pytest.mark.quick

READS = ("rolling_speed", "sliding_speed")


@pytest.fixture(autouse=True)
def fresh_process(monkeypatch):
    """Every test begins like a process of its own."""
    monkeypatch.setattr(discovery, "_registered", {})


def law(slices):
    """Half the slide-roll ratio."""
    return 0.5 * slices.sliding_speed / slices.rolling_speed


def filled(stage, n=600, **conditions):
    slices = Slices(
        n, Conditions(**conditions), rolling_speed=np.arange(1.0, n + 1), sliding_speed=2.0
    )
    Chain(stage)(slices)
    return slices.friction


EXPECTED = 0.5 * 2.0 / np.arange(1.0, 601)


# Functions of a process ----------------------------------------------------------------------------------------------


def test_a_function_is_a_model_by_name():
    assert model("traction", "my-law", reads=READS)(law) is law
    offer = available("traction")["my-law"]
    assert (offer.package, offer.version, offer.state) == ("(this process)", "unpackaged", "ok")
    assert find("traction", "my-law") == offer
    assert offer in catalogue()
    made = get_model("traction", "my-law")
    np.testing.assert_array_equal(filled(made), EXPECTED)
    assert made == get_model("traction", "my-law")
    assert hash(made) == hash(get_model("traction", "my-law"))
    assert type(made).__doc__ == "Half the slide-roll ratio."
    assert made.equation == "friction = law(slices)"
    assert made.domain == {
        "rolling_speed": POSITIVE,
        "sliding_speed": FINITE,
    }  # what they physically can be
    assert get_model("traction", "lambda-blend", boundary="my-law").boundary == made
    with pytest.raises(attrs.exceptions.FrozenInstanceError):
        made.name = "another"


def test_a_function_may_fill_its_column_itself():
    @model("traction", "fills", reads=READS)
    def fills(slices):
        slices.friction[...] = law(slices)

    np.testing.assert_array_equal(filled(get_model("traction", "fills")), EXPECTED)


def test_a_function_may_have_a_compiled_form():
    """It is given the parameters, and computes in place of the function."""
    scale = parameter(default=4.0, unit="1", doc="film", validator=positive)
    given = []

    def kernel(factor):
        given.append(factor)
        return get_model("film", "martin").kernel()

    @model("film", "own-compiled", parameters={"factor": scale}, kernel=kernel)
    def own(slices, factor):
        return factor + 0.0 * slices.load

    films = []
    for law in (get_model("film", "own-compiled", factor=2.0), get_model("film", "martin")):
        state = Conditions(viscosity=0.01, radius=0.007, modulus=2.2e11, pressure_viscosity=2e-8)
        slices = Slices(1, state, load=[2e3], rolling_speed=10.0)
        Chain(law)(slices)
        films.append(slices.film_thickness.tolist())
    assert set(given) == {2.0}
    assert films[0] == films[1]


def test_a_domain_is_kept():
    model("traction", "my-law", domain={"rolling_speed": (1.0, 500.0), "sliding_speed": FINITE})(
        law
    )
    with pytest.raises(
        DomainError, match=r"^my-law: rolling_speed = 501 m/s at slice 500 is outside its domain \("
    ):
        filled(get_model("traction", "my-law"))


def test_a_film_reads_what_films_read():
    model("film", "flat", domain={"load": (1.0, 2.0)}, equation="h = h0", references=["me"])(
        lambda slices: 1e-6
    )
    flat = get_model("film", "flat")
    assert flat.reads == FilmModel.reads
    assert flat.domain == {**FilmModel.domain, "load": (1.0, 2.0)}
    assert (flat.equation, flat.references, flat.location) == ("h = h0", ("me",), "not stated")
    assert flat.film_thickness(1.5, 1.0, 0.01, 2e11, 0.1, 1e-8) == 1e-6


def test_a_study_runs_with_it_and_says_that_it_is_not_packaged():
    model("traction", "my-law", reads=READS, references=["A Notebook of Mine, 2024."])(law)
    changes = {
        "models.traction": "my-law",
        "study.friction-curve": {"points": 11, "normal_force": ["300 N"]},
    }
    result = run(evolve(load_scene("1032930-70C"), changes, si=True), "friction-curve")
    np.testing.assert_allclose(
        result.friction.to_numpy()[0], 0.5 * result.slip.to_numpy(), rtol=1e-12
    )
    traction = next(one for one in json.loads(result.attrs["models"]) if one["kind"] == "traction")
    assert (traction["package"], traction["version"]) == ("(this process)", "unpackaged")
    assert json.loads(result.attrs["packages"])["(this process)"] == "unpackaged"
    assert "A Notebook of Mine, 2024." in json.loads(result.attrs["citations"])


def test_an_error_of_a_function_says_that_it_is_of_this_session():
    @model("traction", "fails", reads=READS)
    def fails(slices):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine") as caught:
        filled(get_model("traction", "fails"))
    assert caught.value.__notes__ == [
        "raised by evaluate() of model 'fails'; it was registered in this process"
    ]


@pytest.mark.slow
def test_a_function_has_parameters_that_scenes_sweeps_and_fits_set():
    limit = parameter(
        default=0.05, unit="1", doc="largest friction", validator=positive, usual=(0.01, 0.2)
    )
    stress = parameter(default=4e6, unit="Pa", doc="limiting stress", validator=positive)

    @model(
        "traction",
        "limited",
        reads=(*READS, "pressure"),
        parameters={"limit": limit, "stress": stress},
    )
    def limited(slices, limit, stress):
        most = np.minimum(limit, stress / slices.pressure)
        return most * np.sign(slices.sliding_speed)

    law = get_model("traction", "limited", stress="6 MPa")
    assert (law.limit, law.stress) == (0.05, 6e6)
    assert conformance(law)
    with pytest.raises(SceneError, match=r"limited\.limit: must be above 0, not -1"):
        get_model("traction", "limited", limit=-1.0)
    scene = evolve(
        load_scene("1032930-70C"),
        {"models.traction": {"model": "limited", "limit": 0.02, "stress": "1 GPa"}},
    )
    assert plan(scene, "friction-curve").assembly.traction.limit == 0.02
    swept = sweep(
        scene,
        {"models.traction.limit": "0.01:0.03:3"},
        study="friction-curve",
        output=["friction"],
        engine="serial",
    )
    np.testing.assert_allclose(
        swept["friction"].max(("slip", "normal_force")), [0.01, 0.02, 0.03], rtol=1e-12
    )
    slices = Slices(2, sliding_speed=[1.0, -1.0], rolling_speed=10.0, pressure=1e9)
    np.testing.assert_allclose(
        limited(slices, 0.05, 1e6), [1e-3, -1e-3]
    )  # the function is left as it is


def two(slices, other):
    """A function that takes another parameter."""


@pytest.mark.parametrize(
    ("parameters", "function", "sentence"),
    [
        (
            {"limit": 0.05},
            two,
            "limit is not a parameter with a default; declare it by rollslip.fields.parameter(default=",
        ),
        (
            {"limit": parameter(unit="1", doc="limit")},
            two,
            "limit is not a parameter with a default",
        ),
        (
            {"limit": parameter(default=1.0, unit="1", doc="limit")},
            two,
            "two has to take the slices and limit, but ",
        ),
        (None, two, "two has to take the slices alone, but missing a required argument: 'other'"),
    ],
)
def test_parameters_that_a_function_does_not_take_are_refused(parameters, function, sentence):
    with pytest.raises(PluginError) as error:
        model("traction", "odd", reads=READS, parameters=parameters)(function)
    assert str(error.value).startswith(f"traction 'odd' cannot be registered: {sentence}")


@pytest.mark.parametrize(
    ("kind", "arguments", "sentence"),
    [
        (
            "contact",
            {},
            "a function cannot be a contact model, only film or traction; write a class and register it",
        ),
        (
            "traction",
            {"reads": ("speed", "load")},
            "traction 'mine' cannot be registered: it reads speed, but slices have approach, conductivity, effusivity",
        ),
        (
            "traction",
            {"reads": ("friction",)},
            "traction 'mine' cannot be registered: it reads friction, but",
        ),
        (
            "traction",
            {"reads": READS, "domain": {"load": POSITIVE}},
            "traction 'mine' cannot be registered: its domain limits load, which reads does not name",
        ),
        (
            "traction",
            {},
            "traction 'mine' cannot be registered: reads must name the columns and conditions that the function reads",
        ),
    ],
)
def test_a_function_that_cannot_be_a_model_is_refused(kind, arguments, sentence):
    with pytest.raises(PluginError) as error:
        model(kind, "mine", **arguments)(law)
    assert str(error.value).startswith(sentence)
    assert not discovery._registered


# Names ---------------------------------------------------------------------------------------------------------------


def test_a_taken_name_is_replaced_on_purpose_only():
    def other(slices):
        return 0.0 * slices.sliding_speed

    model("traction", "my-law", reads=READS)(law)
    for name, whose in [("my-law", "in this process"), ("muraki", "by package rollslip")]:
        with pytest.raises(PluginError) as error:
            model("traction", name, reads=READS)(other)
        sentence = (
            f"traction {name!r} is offered {whose} already; rename yours, or set replace=True"
        )
        assert str(error.value) == sentence
        assert (
            find("traction", name).package
            == {"my-law": "(this process)", "muraki": "rollslip"}[name]
        )
        model("traction", name, reads=READS, replace=True)(other)
        assert find("traction", name).package == "(this process)"
        np.testing.assert_array_equal(filled(get_model("traction", name)), 0.0)
    replaced = next(o for o in catalogue() if (o.name, o.package) == ("muraki", "rollslip"))
    assert replaced.state == "shadowed"
    assert replaced.cause == "replaced in this process; restart it to have this one back"
    model("film", "my-law")(lambda slices: 1e-6)  # a name is one of its kind


def test_what_is_registered_belongs_to_no_package():
    before = requirements()
    model("traction", "my-law", reads=READS)(law)
    assert requirements() == before
    assert "(this process)" not in {package.name for package in packages()}


def test_a_misspelt_name_of_the_session_gets_the_nearest():
    model("traction", "my-law", reads=READS)(law)
    with pytest.raises(
        PluginError, match=r"^no traction is called 'my-lav'; did you mean 'my-law'\?"
    ):
        find("traction", "my-lav")


def test_many_threads_may_register_and_ask():
    def task(k):
        model("traction", f"law-{k}", reads=READS)(lambda slices: k + 0.0 * slices.sliding_speed)
        assert {offer.name for offer in catalogue()} >= {f"law-{k}", "muraki"}
        answers[k] = filled(get_model("traction", f"law-{k}"), 3)[0]

    answers = {}
    threads = [threading.Thread(target=task, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == {k: float(k) for k in range(8)}


# Classes and values of a process -------------------------------------------------------------------------------------


def made(base, **body):
    """A class as a notebook would define it."""
    about = {"name": "mine", "equation": "1 = 1", "references": (), "__module__": __name__}
    return attrs.frozen(type("Mine", (base,), about | body))


def test_a_class_is_offered_under_its_kind():
    cls = made(Moes)
    assert register(cls) is cls
    assert get_class("film", "mine") is cls
    assert get_model("film", "mine").film_thickness(1e4, 10.0, 0.007, 2e11, 0.01, 1e-8) > 0
    assert "mine" not in available("contact")
    with pytest.raises(
        PluginError, match=r"^film 'mine' is offered in this process already; rename yours, or set"
    ):
        register(made(Moes))
    other = made(Moes)
    register(other, replace=True)
    assert get_class("film", "mine") is other


def test_named_data_are_offered_as_they_are():
    bearing = attrs.evolve(get_model("bearing", "1032930"), name="my-bearing")
    register(bearing)
    assert get_model("bearing", "my-bearing") is bearing
    oil = attrs.evolve(get_model("lubricant", "mil-prf-7808"), name="my-oil")
    register(oil)
    scene = evolve(
        load_scene("1032930-70C"), {"lubricant.name": "my-oil", "bearing": {"name": "my-bearing"}}
    )
    assert plan(scene).assembly.lubricant.name == "my-oil"
    assert scene.bearing == bearing.bearing


@pytest.mark.parametrize(
    ("thing", "sentence"),
    [
        (42, "42 cannot be registered: a class derived from, or a value of, one of Account, BearingData, Campaign, "
             "ContactModel, DamageModel, "
             "Drag, Engine, FilmModel, SceneFormat, IntegratorModel, LifeModel, LossModel, Lubricant, "
             "Measurement, PressureModel, PressureViscosity, RibModel, RingModel, SceneData, Study, "
             "ThermalModel, TorqueFormula, TractionModel can; "
             "a function can with @model(kind, name, reads=...)"),
        (Constant(), "Constant(coefficient=0.05, transition=0.001) cannot be registered: a class derived from, or a"),
        (made(ContactModel), "contact 'mine' cannot be registered: class Mine does not define deflection, evaluate"),
        (made(TractionModel, evaluate=law), "traction 'mine' cannot be registered: class Mine does not define reads"),
    ],
    ids=["number", "instance", "abstract", "incomplete"],
)  # fmt: skip
def test_what_cannot_be_used_is_not_registered(thing, sentence):
    with pytest.raises(PluginError) as error:
        register(thing)
    assert str(error.value).startswith(sentence)
    assert not discovery._registered


# Kernels from elsewhere ----------------------------------------------------------------------------------------------


@attrs.frozen
class Foreign(TractionModel):
    name = "foreign"
    equation = "mu = f V/u"
    references = ()
    reads = frozenset(READS)
    domain = {"rolling_speed": POSITIVE, "sliding_speed": FINITE}  # noqa: RUF012

    capsule: object

    def evaluate(self, slices):
        slices.friction[...] = law(slices)

    def kernel(self):
        return self.capsule


def address_of(function):
    return ctypes.cast(function, ctypes.c_void_p).value


def test_the_structure_of_ctypes_is_that_of_c():
    size, offsets = layout()
    assert ctypes.sizeof(SlicesStruct) == size
    assert {
        name: getattr(SlicesStruct, name).offset for name, _ in SlicesStruct._fields_
    } == offsets
    assert [name for name, _ in SlicesStruct._fields_] == ["n", *CONDITIONS, *COLUMNS]


def test_a_function_of_ctypes_is_a_kernel():
    @EVALUATE
    def evaluate(slices, params):
        s = slices.contents
        for i in range(s.n):
            s.friction[i] = 0.5 * s.sliding_speed[i] / s.rolling_speed[i] + s.viscosity
        return 0

    friction = filled(
        Foreign(capsule_from_address(address_of(evaluate), owner=evaluate)), viscosity=1.0
    )
    np.testing.assert_array_equal(friction, EXPECTED + 1.0)


C_SOURCE = """
#include "rollslip.h"
typedef struct { double factor; } parameters;
int ramp(const rs_slices *s, const void *params)
{
    const double factor = ((const parameters *)params)->factor;
    for (size_t i = 0; i < s->n; i++) {
        if (s->sliding_speed[i] > 1e3) return (int)i + 1;
        s->friction[i] = factor * s->sliding_speed[i] / s->rolling_speed[i];
    }
    return 0;
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """A bare C library: no Python in it, nothing of rollslip but the header."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no C compiler is installed")
    folder = tmp_path_factory.mktemp("library")
    (folder / "ramp.c").write_text(C_SOURCE)
    command = [
        compiler,
        "-O1",
        "-Wall",
        "-Werror",
        "-shared",
        "-fPIC",
        "-I",
        get_include(),
        "ramp.c",
        "-o",
        "ramp.so",
    ]
    subprocess.run(command, cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "ramp.so"))


def ramp(library, factor):
    parameters = ctypes.c_double(factor)
    return capsule_from_address(
        address_of(library.ramp), ctypes.addressof(parameters), owner=(library, parameters)
    )


def test_a_c_library_is_a_kernel(library):
    stage = Foreign(ramp(library, 0.5))
    gc.collect()
    np.testing.assert_array_equal(filled(stage), EXPECTED)
    slices = Slices(600, rolling_speed=1.0, sliding_speed=np.arange(600) * 10.0)
    with pytest.raises(DomainError, match=r"^foreign: slice 101 is outside its domain$"):
        Chain(stage)(slices)
    blend = LambdaBlend(boundary=stage, hydrodynamic=stage)
    slices = Slices(
        3, Conditions(roughness=1e-6), rolling_speed=1.0, sliding_speed=0.5, film_thickness=1e-6
    )
    Chain(blend)(slices)
    np.testing.assert_array_equal(slices.friction, 0.25)


def test_a_capsule_keeps_what_it_needs_and_lets_it_go(library):
    class Kept:
        pass

    kept = Kept()
    alive = weakref.ref(kept)
    chain = Chain(Foreign(capsule_from_address(address_of(library.ramp), owner=kept)))
    del kept
    gc.collect()
    assert alive() is not None
    del chain
    gc.collect()
    assert alive() is None


@pytest.mark.parametrize("address", [0, None])
def test_an_address_of_nothing_is_refused(address):
    with pytest.raises(PluginError) as error:
        Chain(Foreign(capsule_from_address(address)))
    assert str(error.value) == (
        f"model 'foreign': {__name__}.Foreign.kernel() gave a table whose evaluate is NULL; "
        f"it comes from module {__name__}, which no package offers"
    )


@pytest.mark.skipif(
    importlib.util.find_spec("numba") is None,
    reason="Numba is not installed; rollslip does not need it",
)
def test_a_function_of_numba_is_a_kernel():
    from numba import carray, cfunc

    signature, column = numba_slices()

    @cfunc(signature)
    def evaluate(slices, params):
        s = carray(slices, 1)[0]
        friction = carray(column(s.friction), s.n)
        V = column(s.sliding_speed)
        u = column(s.rolling_speed)
        for i in range(s.n):
            friction[i] = 0.5 * V[i] / u[i] + s.viscosity
        return 0

    friction = filled(
        Foreign(capsule_from_address(evaluate.address, owner=evaluate)), viscosity=1.0
    )
    np.testing.assert_array_equal(friction, EXPECTED + 1.0)


@pytest.mark.skipif(importlib.util.find_spec("numba") is not None, reason="Numba is installed")
def test_without_numba_its_name_is_in_the_error():
    with pytest.raises(ImportError, match="numba"):
        numba_slices()
