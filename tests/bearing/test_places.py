"""Where a slice is, for laws that ask: right in every study or refused, and free for all who do not ask."""

import ctypes
import re
import shutil
import subprocess
from pathlib import Path
from types import MappingProxyType, SimpleNamespace

import attrs
import numpy as np
import pytest

from foreign_stages import Stage
from kit import failed
from registrations import registrations_rolled_back
from rollslip import Chain, Conditions, Slices, evolve, get_include, get_model, load_scene, register
from rollslip.bearing.assembly import assemble
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium
from rollslip.errors import DomainError, PluginError, RollslipError
from rollslip.fields import parameter
from rollslip.foreign import capsule_from_address
from rollslip.models import FINITE, POSITIVE, FilmModel, TractionModel
from rollslip.studies.law_outputs import law_outputs
from rollslip_kernels.motion import raceway
from rollslip_kernels.slices import COLUMNS, PLACES
from rollslip_studies.motion.torque_balance import torque_balance
from rollslip_studies.steady_slip.study import SteadySlip
from without_bands import run

PAPER = evolve(
    load_scene("1032930-70C"),
    {"accuracy.slices": 4, "operation.misalignment": 2e-4, "models.film": "moes"},
    si=True,
)


@attrs.frozen
class Placed(TractionModel):
    """Friction that knows where it is: mu = 0.05 tanh(40 V/u) (1 + f x), x one of the places."""

    name = "placed"
    equation = "mu = 0.05 tanh(40 V/u) (1 + f x)"
    references = ("an example",)
    outputs = MappingProxyType({"place": ("1", "where"), "mu": ("1", "its friction")})
    of: str = parameter(default="position", doc="which place")
    factor: float = parameter(default=0.0, unit="1", doc="f")

    @property
    def reads(self):
        return frozenset({"sliding_speed", "rolling_speed", self.of})

    @property
    def domain(self):
        return {"sliding_speed": FINITE, "rolling_speed": POSITIVE, self.of: FINITE}

    def evaluate(self, slices):
        rise = 0.05 * np.tanh(40.0 * slices.sliding_speed / slices.rolling_speed)
        slices.friction[...] = rise * (1.0 + self.factor * getattr(slices, self.of))

    def quantities(self, slices):
        return {"place": getattr(slices, self.of), "mu": slices.friction}


@pytest.fixture
def placed():
    """Scenes with the law of a place and a factor."""

    def scene(of, factor=0.0, **changes):
        return evolve(
            PAPER,
            {"models.traction": {"model": "placed", "of": of, "factor": factor}, **changes},
            si=True,
        )

    with registrations_rolled_back():
        register(Placed)
        yield scene


def expected(scene, ring, n_positions, cage_slip=0.0):
    """Mean of every place by the force of the rollers of a bearing, from its loads alone."""
    a = assemble(scene)
    loads = a.load_distribution(
        int(n_positions), (1.0 - cage_slip) * a.kinematics.epicyclic_cage_speed
    )
    load = loads.inner_load if ring == "inner" else loads.outer_load
    force = load * a.widths
    angle = loads.psi[..., None]
    number = np.arange(loads.psi.shape[1])[None, :, None]
    k = a.kinematics
    tilt = 2e-4 if ring == "inner" else 0.0
    places = {
        "position": loads.position,
        "orbit_angle": angle,
        "roller": number,
        "transverse_speed": tilt * k.inner_speed * k.inner_radius * np.sin(angle),
    }
    return {name: float((force * where).sum() / force.sum()) for name, where in places.items()}


#: Few slips, a map of few points, none of it beyond skidding: what is compared are means over rollers.
CURVES = {"study.effective-friction.points": 5, "study.effective-friction.map_points": 3,
          "study.effective-friction.skidding_range": 0, "study.effective-friction.closure": "epicyclic"}  # fmt: skip


@pytest.mark.parametrize("of", PLACES)
def test_effective_friction_has_places(placed, of):
    found = run(placed(of, **CURVES), "effective-friction")
    for ring in ("inner", "outer"):
        want = expected(placed(of), ring, found.n_positions)[of]
        np.testing.assert_allclose(found.place.sel(ring=ring), want, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("of", PLACES)
def test_effective_friction_is_that_of_the_places(placed, of):
    """Linear in the place, the mean is that at the mean place; its map is evaluated in the same way."""
    plain = run(placed(of, **CURVES), "effective-friction")
    factor = 1e-2 if of != "position" else 10.0
    found = run(placed(of, factor, **CURVES), "effective-friction")
    for ring in ("inner", "outer"):
        more = 1.0 + factor * expected(placed(of), ring, found.n_positions)[of]
        for name in ("effective_friction", "friction_map"):
            np.testing.assert_allclose(
                found[name].sel(ring=ring), more * plain[name].sel(ring=ring), rtol=1e-9
            )


@pytest.mark.parametrize("of", PLACES)
def test_a_friction_curve_is_of_the_roller_in_the_line_of_load(placed, of):
    changes = {"study.friction-curve.points": 5, "bearing.profile": {"shape": "none"}}
    plain, found = (run(placed(of, factor, **changes), "friction-curve") for factor in (0.0, 100.0))
    assert np.all(
        np.abs(found.place) < 1e-12
    )  # the mean along the roller, its angle and its number
    if of == "position":  # but slices off the middle differ
        a = assemble(placed(of))
        slices = a.inner.evaluate(np.full(4, 1e4), 10.0, 0.1, position=a.position)
        assert slices.friction[0] == slices.friction[-1]  # whose factor is 0
    np.testing.assert_allclose(found.friction, plain.friction, rtol=1e-12)


DRAG = {"cage.drag": [{"model": "constant-torque", "size": "0.1 N m"}]}


@pytest.mark.slow
@pytest.mark.parametrize(
    "of",
    [
        "orbit_angle",
        *(pytest.param(name, marks=pytest.mark.soak) for name in ("position", "transverse_speed")),
    ],
)
def test_a_steady_slip_has_places(placed, of):
    bearing = assemble(placed(of, **DRAG))
    study = SteadySlip()
    found = study.run(bearing)
    found = found.assign(law_outputs(study, bearing, found))
    for ring in ("inner", "outer"):
        want = expected(placed(of), ring, found.n_positions, float(found.steady_slip[0]))[of]
        np.testing.assert_allclose(found.place.sel(ring=ring), want, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("of", "factor"), [("position", 100.0), ("orbit_angle", -0.1), ("transverse_speed", 5.0)]
)
def test_rollers_that_are_followed_in_compiled_code_have_them_too(placed, of, factor):
    """Their torques are those of tractions which the laws give of all slices of the motion, called in Python."""
    balance = torque_balance(assemble(placed(of, factor, **DRAG)), 2, inertia=False)
    orbit = balance.orbit(0.1)
    of_each = balance.forces(orbit)[2]
    assert orbit.torque == pytest.approx(28 * of_each.mean() * balance.motions.sense, rel=1e-6)
    plain = torque_balance(assemble(placed(of, **DRAG)), 2, inertia=False).orbit(0.1)
    both = ([one.torque, *one.roller_slip] for one in (orbit, plain))
    assert not np.allclose(*both, rtol=1e-6, atol=0.0)


def test_a_steady_slip_does_not_know_which_roller_it_is(placed):
    with pytest.raises(
        RollslipError, match=r"placed: slice 0 has no roller \(number of the roller, from 0, 1\); "
    ):
        run(placed("roller", **DRAG), "steady-slip")


MOTION = {
    "study.dynamics.duration": "0.05 ms", "study.dynamics.friction": "conventional",
    "study.dynamics.integrator": "rk45", "study.dynamics.relative_tolerance": 1e-5,
    "study.effective-friction.skidding_range": 0, **DRAG
}  # fmt: skip


@pytest.mark.parametrize(
    ("of", "level"), [*((of, "cage-set") for of in PLACES), ("orbit_angle", "pocket")]
)
def test_a_motion_has_places(placed, of, level):
    """What stays the same along a roller is what the motion says of it; along it, the mean is not that of friction."""
    factor = {"position": 100.0, "orbit_angle": 0.3, "roller": 0.5, "transverse_speed": 2.0}[of]
    found = run(placed(of, factor, **MOTION, **{"study.dynamics.level": level}), "dynamics").isel(
        time=-1
    )
    k = assemble(PAPER).kinematics
    force = found.normal_force
    speeds = k.surface_speeds(float(found.cage_slip), found.roller_slip.to_numpy())
    tilted = np.array([2e-4 * k.inner_speed * k.inner_radius, 0.0])[:, None]
    where = {
        "position": np.zeros(28),
        "orbit_angle": found.orbit_angle.to_numpy(),
        "roller": np.arange(28.0),
        "transverse_speed": tilted * np.sin(found.orbit_angle.to_numpy()),
    }[of]
    rolling = np.array([speeds.inner_rolling, speeds.outer_rolling])
    sliding = found.sliding_speed.to_numpy()
    mu = 0.05 * np.tanh(40.0 * sliding / rolling) * (1.0 + factor * where)
    assert int((force > 0.0).sum()) > 10
    if of == "position":
        assert (
            np.abs(found.traction_force - mu * force).max()
            > 1e-3 * np.abs(found.traction_force).max()
        )
    else:
        np.testing.assert_allclose(found.traction_force, mu * force, rtol=1e-5, atol=1e-9)


def test_a_plane_motion_does_not_follow_angles(placed):
    changes = {**MOTION, "study.dynamics.level": "planar", "operation.misalignment": 0.0, "bearing.profile": "none",
               "study.dynamics.planar": {"inner_ring_mass": "5 kg"}}  # fmt: skip
    found = run(placed("orbit_angle", **changes), "dynamics")
    assert found.outcome == "failed"
    assert (
        "placed: slice 0 has no orbit_angle (place of the roller on its orbit"
        in found.outcome_message
    )


def test_a_motion_fills_its_table_roller_by_roller():
    law = Placed("position", 100.0)
    width = np.array([1e-3, 2e-3, 3e-3])
    for of, place in (
        ("position", np.array([[-4e-3, 0.0, 7e-3]])),
        ("roller", np.arange(4.0)[:, None]),
    ):
        law = Placed(of, 100.0)
        table = Slices(12)
        table.places()
        made = raceway.conventional(Chain(law).kernel, table, 4, width, False, [-4e-3, 0.0, 7e-3])
        load = np.array([[1e4, 0.0, 2e4], [0.0, 0.0, 0.0], [3e4, 2e4, 1e4], [0.0, 5e4, 0.0]])
        traction, *_, status = raceway.friction(made, load, 0.0, 0.01, 1.0, 0.0)
        assert status == 0
        want = (load * width * (1.0 + 100.0 * place)).sum(axis=1) * 0.05 * np.tanh(40.0 * 0.01)
        np.testing.assert_allclose(
            traction, want, rtol=1e-5
        )  # the film's speed is sqrt(u^2 + u_0^2)


def test_a_deflection_that_asks_is_refused_in_words():
    def bend(slices):
        slices.load[:] = 1e10 * slices.approach
        slices.stiffness[:] = 1e10

    law = Stage(
        bend,
        name="bent",
        reads=frozenset({"approach", "position"}),
        writes=frozenset({"load", "stiffness"}),
    )
    ring = SimpleNamespace(conditions=Conditions(length=0.014), deflection=Chain(law))
    case = LoadCase(
        angular_positions(14, 1), 0.014, [0.0], radial_clearance=2e-5, radial_load=5000.0
    )
    with pytest.raises(
        DomainError, match=r"bent: slice 0 has no position \(place along the roller, from its "
    ):
        solve_equilibrium(case, (ring, ring))


# Nobody pays who does not ask ----------------------------------------------------------------------------------------


def test_a_table_has_places_only_when_asked():
    slices = Slices(5000, Conditions(radius=0.006875, modulus=2.2857e11), load=1e4)
    Chain(get_model("contact", "palmgren"))(slices)
    assert slices._table.shape[0] == len(COLUMNS) - len(PLACES) == 13
    assert slices._places is None
    assert np.isnan(slices.roller).all()
    slices.roller = np.arange(5000)
    assert slices.taken([3, 1]).roller.tolist() == [3.0, 1.0]


@pytest.mark.parametrize("n", [1, 7, 300, 30000])
def test_places_arrive_in_blocks_and_threads(n):
    law = Placed("roller", 1.0)
    number = np.arange(float(n))
    slices = Slices(n, rolling_speed=1.0, sliding_speed=0.01, roller=number)
    Chain(law, block=64)(slices)
    np.testing.assert_allclose(slices.friction, 0.05 * np.tanh(0.4) * (1.0 + number), rtol=1e-14)


# Packages built before -----------------------------------------------------------------------------------------------

BEFORE = """
#include "rollslip.h"
#include <math.h>
static int law(const rs_slices *s, const void *params) {
    const double ER = s->modulus * s->radius;
    for (size_t i = 0; i < s->n; i++)
        s->film_thickness[i] = s->radius * 1.95 * pow(s->load[i] / ER, -1.0 / 11.0)
            * pow(s->pressure_viscosity * s->viscosity / s->radius * s->rolling_speed[i], 8.0 / 11.0);
    return 0;
}
const rs_model MODEL = {ROLLSLIP_ABI, sizeof(rs_slices), law, 0};
"""


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    """A law of a stranger, built against the header as it was without places, and its table ``rs_model``."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler is installed")
    folder = tmp_path_factory.mktemp("before")
    header = (Path(get_include()) / "rollslip.h").read_text()
    header = re.sub(
        r"#define ROLLSLIP_PLACES\(X\) (?:.*\\\n)+.*\n", "#define ROLLSLIP_PLACES(X)\n", header
    )
    assert not any(f"X({name}," in header for name in PLACES)
    (folder / "rollslip.h").write_text(header)
    (folder / "law.c").write_text(BEFORE)
    subprocess.run(
        [compiler, "-O2", "-shared", "-fPIC", "law.c", "-o", "law.so", "-lm"],
        cwd=folder,
        check=True,
    )
    LIBRARY[:] = [ctypes.CDLL(str(folder / "law.so"))]


class Model(ctypes.Structure):
    _fields_ = [("abi", ctypes.c_uint32), ("size", ctypes.c_uint32), ("evaluate", ctypes.c_void_p),
                ("params", ctypes.c_void_p)]  # fmt: skip


_capsule = ctypes.pythonapi.PyCapsule_New
_capsule.restype = ctypes.py_object
_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_NAME = b"rollslip.slice_model.v1"


LIBRARY = []


@attrs.frozen
class Before(FilmModel):
    """Film after Ertel and Grubin, its kernel that of the library.

    h/R = 1.95 (G U)^(8/11) W^(-1/11)
    """

    name = "before"
    equation = "h/R = 1.95 (G U)^(8/11) W^(-1/11)"
    references = ("an example, 1949.",)
    location = "central"
    regime = "VE"
    domain = MappingProxyType({**FilmModel.domain, "pressure_viscosity": POSITIVE})

    def evaluate(self, slices):
        """Fill the film thickness."""
        c = slices.conditions
        gu = c.pressure_viscosity * c.viscosity * slices.rolling_speed / c.radius
        w = slices.load / (c.modulus * c.radius)
        slices.film_thickness[...] = c.radius * 1.95 * gu ** (8 / 11) * w ** (-1 / 11)

    def kernel(self):
        """Return the compiled form."""
        return _capsule(ctypes.addressof(Model.in_dll(LIBRARY[0], "MODEL")), _NAME, None)


def test_a_package_built_against_the_former_header_goes_on(before):
    assert Model.in_dll(LIBRARY[0], "MODEL").size == 8 * (1 + 13 + 13)
    assert not failed(Before())


def test_it_stands_beside_a_law_that_asks(before, placed):
    slices = Slices(
        300, Conditions(radius=5e-3, modulus=2.28e11, viscosity=8e-3, pressure_viscosity=1.5e-8),
        load=1e5, rolling_speed=2.0, sliding_speed=0.01, roller=np.arange(300.0),
    )  # fmt: skip
    Chain(Before(), Placed("roller", 1.0))(slices)
    alone = Chain(Before(), Placed("roller", 1.0), compiled=False)
    other = slices.taken()
    alone(other)
    np.testing.assert_allclose(slices.film_thickness, other.film_thickness, rtol=1e-12)
    np.testing.assert_array_equal(slices.friction, other.friction)


def test_it_cannot_ask_for_what_it_does_not_know(before):
    class Asks(Before):
        reads = Before.reads | {"position"}

    with pytest.raises(
        PluginError, match=r"reads where slices are, but knows only 216 bytes of rs_slices"
    ):
        Chain(Asks())


def test_a_law_behind_an_address_reads_places():
    from rollslip.foreign import EVALUATE

    @EVALUATE
    def evaluate(s, _):
        for i in range(s.contents.n):
            s.contents.friction[i] = s.contents.roller[i]
        return 0

    class Address(Placed):
        def kernel(self):
            return capsule_from_address(
                ctypes.cast(evaluate, ctypes.c_void_p).value, owner=evaluate
            )

    slices = Slices(5, rolling_speed=1.0, sliding_speed=0.1, roller=np.arange(5.0))
    Chain(Address("roller"))(slices)
    assert slices.friction.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
