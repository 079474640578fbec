"""A drag that varies in time, and one that follows the load of the moment: impulses against SciPy's quadrature."""

import ctypes
import math

import attrs
import numpy as np
import pytest
from scipy.integrate import quad

from foreign_stages import _new_capsule
from kit import failed
from registrations import registrations_rolled_back
from rollslip import evolve, get_model, load_scene, register, run
from rollslip.bearing.assembly import assemble
from rollslip.bearing.drags import torque_capsule
from rollslip.errors import DomainError
from rollslip.fields import non_negative, parameter, positive
from rollslip.models import DragModel, from_scene
from rollslip.structure import Location, structure
from rollslip_kernels.stages import drag as compiled
from rollslip_studies.dynamics.history.settings import HistorySettings
from rollslip_studies.dynamics.history.varying import varying_motion
from rollslip_studies.dynamics.levels.planar import PlanarSettings
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

END = 0.002  # s
#: A load that stays; the motion is then the one without a history.
FIXED = {"radial_load": {"shape": "step", "to": "1037 N", "at": "1 ms"}}
HELD = {
    "radial_load": {"shape": "step", "to": "1037.0 N", "at": "1 ms"}
}  # one with a history, of what stays
RAMP = {"radial_load": {"shape": "ramp", "to": "900 N", "within": "2 ms"}}


@attrs.frozen(kw_only=True)
class RunningIn(DragModel):
    """A seal that runs in: T = -T_0 exp(-t/tau) tanh(w_c/w_0), w_0 = 1 rad/s."""

    name = "running-in"
    equation = "T = -T_0 exp(-t/tau)"
    references = ("An example. 2020, made for a test.",)
    varies_in_time = True

    size: float = parameter(default=0.05, unit="N m", validator=non_negative, doc="T_0")
    decay: float = parameter(default=0.004, unit="s", validator=positive, doc="tau")

    def torque(self, cage_speed, inner_speed, outer_speed, time=0.0):
        """Return the torque."""
        return -self.size * math.exp(-time / self.decay) * math.tanh(cage_speed)


@attrs.frozen(kw_only=True)
class LoadedLip(DragModel):
    """T = -c F tanh(w_c/w_0), F the radial load."""

    name = "loaded-lip"
    equation = "T = -c F"
    references = ("An example. 2020, made for a test.",)

    lever: float = parameter(default=2e-5, unit="m", validator=non_negative, doc="c")
    load: float = from_scene("radial_load", doc="F")

    def torque(self, cage_speed, inner_speed, outer_speed):
        """Return the torque."""
        return -self.lever * self.load * math.tanh(cage_speed)


@pytest.fixture(autouse=True)
def known():
    with registrations_rolled_back():
        register(RunningIn)
        register(LoadedLip)
        yield


def scene(drag):
    return evolve(load_scene("1032930-50C"), {"accuracy.slices": 5, "cage.drag": [{"model": drag}]})


def impulse(drag, level, history, method="rk45", friction="conventional"):
    """Impulse of the drags on the cage over time [N m s], at five instants."""
    of = scene(drag)
    problems = []
    where = Location({}, ("study", "dynamics", "history"))
    way = structure(HistorySettings, history, where, problems).history(of, END, where)
    m = varying_motion(
        assemble(of), FrictionSettings(name=friction), way, level=level,
        planar=PlanarSettings(inner_ring_mass=1.0) if level == "planar" else None,
    )  # fmt: skip
    system = m.system if history != FIXED else m.base.system
    problem = InitialValueProblem(
        rates=system, y=m.initial(), atol=1e-10 * system.scale, breaks=m.breaks
    )
    times = np.linspace(0.0, END, 5)
    ours = integrate(problem, get_model("integrator", method), times, rtol=1e-8)
    assert ours.outcome == "finished"
    if method == "rodas5p" and level != "planar":
        assert (
            ours.steps < 500
        )  # some 100; thousands where a method is not told that rates vary in time
    assert np.abs(m.split(ours.y)["cage_speed"]).min() > 20.0  # tanh is 1
    return m.direction * m.split(ours.y)["impulse_drag"], times, way


@pytest.mark.parametrize("method", ["rk45", "rodas5p"])
@pytest.mark.parametrize("level", ["cage-set", "pocket", "planar"])
@pytest.mark.parametrize("history", [FIXED, HELD, RAMP], ids=["fixed", "held", "ramp"])
def test_a_torque_knows_the_time_since_the_motion_began(level, method, history):
    found, times, _ = impulse("running-in", level, history, method)
    true = [quad(lambda t: -0.05 * math.exp(-t / 0.004), 0.0, end)[0] for end in times]
    np.testing.assert_allclose(found, true, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("level", ["cage-set", "pocket", "planar"])
def test_a_torque_follows_the_load_of_the_moment(level):
    history = {"radial_load": {"shape": "ramp", "to": "900 N", "at": "0.5 ms", "within": "1 ms"}}
    found, times, way = impulse("loaded-lip", level, history)
    load = way.courses["radial_load"].at
    true = [
        quad(lambda t: -2e-5 * float(load(np.array([t]))[0]), 0.0, end, points=[5e-4, 1.5e-3])[0]
        for end in times
    ]
    np.testing.assert_allclose(found, true, rtol=1e-4, atol=1e-12)


def test_what_is_steady_is_refused_in_words_and_a_motion_tells_none():
    of = scene("running-in")
    with pytest.raises(
        DomainError, match="drag 'running-in' varies in time, and no motion is steady with it"
    ):
        run(of, "steady-slip")
    moved = run(evolve(of, {"study.dynamics.duration": "10 ms"}), "dynamics")
    assert (
        moved.attrs["steady_status"]
        == "drag 'running-in' varies in time, and no motion is steady with it"
    )
    assert math.isnan(moved.attrs["steady_cage_slip"])


def test_the_kit_holds_it_to_its_rules_at_any_time():
    assert not failed(RunningIn())

    class Driving(RunningIn):
        def torque(self, cage_speed, inner_speed, outer_speed, time=0.0):
            return (1.0 if time > 1.0 else -1.0) * self.size * math.tanh(cage_speed)

    assert "check_torque_takes_power_out_of_a_cage_between_still_rings" in failed(Driving())


# In C, by a stranger: the former rs_drag, and today's ---------------------------------------------------------------

TORQUE = ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * 3, ctypes.c_void_p)
TORQUE_AT = ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * 4, ctypes.c_void_p)


class RsDrag(ctypes.Structure):
    """``rs_drag`` of rollslip.h."""

    _fields_ = (
        ("abi", ctypes.c_uint32), ("size", ctypes.c_uint32), ("torque", TORQUE), ("params", ctypes.c_void_p),
        ("torque_at", TORQUE_AT),
    )  # fmt: skip


@pytest.mark.parametrize(("size", "expected"), [(24, 1.0), (32, 8.0)])
def test_a_drag_built_against_the_former_header_has_no_time(size, expected):
    drag = RsDrag(1, size, TORQUE(lambda *_: 1.0), None, TORQUE_AT(lambda c, i, o, t, _: 4.0 * t))
    name = b"rollslip.drag.v1"
    capsule = _new_capsule(ctypes.addressof(drag), name, None)
    assert not compiled.problem(capsule)
    assert compiled.torque(capsule, 1.0, 2.0, 3.0) == 1.0
    assert compiled.torque(capsule, 1.0, 2.0, 3.0, 2.0) == expected


def test_an_error_says_at_which_time():
    capsule = torque_capsule(RunningIn(size=math.inf))
    with pytest.raises(DomainError, match="nan at cage, inner and outer speed 1, 2, 3 rad/s, 4 s"):
        compiled.torque(capsule, 1.0, 2.0, 3.0, 4.0)
