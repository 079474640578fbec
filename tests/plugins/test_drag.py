"""Drags: torques on the cage and resistances to rolling, against quadrature, closed solutions and a solved film."""

import ctypes
import math
import pickle

import attrs
import numpy as np
import pytest

from foreign_stages import RsModel, Stage, _new_capsule
from rollslip import Chain, Slices, get_model
from rollslip.bearing.drags import Drags, TotalResistance, torque_capsule
from rollslip.catalogue.kinds import get_kind
from rollslip.errors import DomainError, PluginError, SceneError
from rollslip.fields import FieldError, parameter, positive
from rollslip.models import (
    POSITIVE,
    SCENE_VALUES,
    DragModel,
    PocketFriction,
    ResistanceModel,
    from_scene,
)
from rollslip.testing import conformance, samples
from rollslip.units import check_unit
from rollslip_kernels.stages import drag as compiled
from rollslip_plugins.drag.rolling import Hysteresis, RollingResistance
from rollslip_plugins.drag.torques import Churning, ConstantTorque, CoulombPocket, PetroffLand
from strategies import STEEL, resistance_in_both_forms

#: The law alone, in an inlet that is cold.
COLD = RollingResistance(inlet_heating="none")
#: Lengths in m, viscosity in Pa s.
LAND = {"ring": "outer", "viscosity": 0.01, "radius": 0.1, "width": 0.01, "clearance": 1e-4}
#: 20 rollers of 10 mm by 20 mm, in an oil of 900 kg/m3 that fills 2 % of the space; lengths in m.
ROLLERS = {
    "density": 900.0,
    "oil_fraction": 0.02,
    "rollers": 20.0,
    "roller_diameter": 0.01,
    "roller_length": 0.02,
    "orbit_radius": 0.05,
}


# Torques -------------------------------------------------------------------------------------------------------------


def test_a_constant_torque_is_its_size_on_a_cage_that_turns_and_smooth_at_rest():
    drag = ConstantTorque(size=0.2, transition=2.0)
    assert drag.torque(0.0, 600.0, 0.0) == 0.0
    assert drag.torque(3.0, 600.0, 0.0) == pytest.approx(-0.2 * 3 / math.sqrt(13), rel=1e-15)
    assert drag.torque(-1e6, 0.0, 0.0) == pytest.approx(0.2, rel=1e-11)
    assert drag.torque(20.0, 0.0, 0.0) == pytest.approx(-0.2, rel=5e-3)


def test_the_land_has_the_torque_of_a_thin_annulus():
    """Couette's flow between cylinders is known for any gap, T = 4 pi eta W w R1^2 R2^2/(R2^2 - R1^2)."""
    for c, allowed in ((1e-3, 1.6e-2), (1e-4, 1.6e-3), (1e-5, 1.6e-4)):
        drag = PetroffLand(**LAND | {"clearance": c})
        inner = 0.1
        outer = 0.1 + c
        exact = 4 * math.pi * 0.01 * 0.01 * 300.0 * (inner * outer) ** 2 / (outer**2 - inner**2)
        assert drag.torque(300.0, 667.0, 0.0) == pytest.approx(-exact, rel=allowed)
    assert PetroffLand(**LAND).torque(300.0, 667.0, 300.0) == 0.0
    # the inner ring drives a cage that it guides
    driven = PetroffLand(**LAND | {"ring": "inner"})
    assert driven.torque(300.0, 667.0, 0.0) == pytest.approx(2 * math.pi * 1e-3 * 367.0, rel=1e-14)


def test_churning_by_hand():
    drag = Churning(coefficient=0.5, **ROLLERS)
    # 200 rad/s at 0.05 m: 10 m/s; 0.5 x 18 kg/m3 x 2 cm2 x 100 m2/s2 / 2 = 0.09 N a roller, at 0.05 m, 20 times
    assert drag.torque(200.0, 600.0, 0.0) == pytest.approx(-0.09, rel=1e-14)
    assert drag.torque(-400.0, 600.0, 0.0) == pytest.approx(0.36, rel=1e-14)


@pytest.mark.parametrize(
    "drag",
    [
        ConstantTorque(),
        PetroffLand(**LAND),
        PetroffLand(**LAND | {"ring": "inner"}),
        Churning(**ROLLERS),
    ],
)
def test_torques_are_the_same_compiled(drag):
    capsule = torque_capsule(drag)
    for speeds in ((300.0, 667.0, 0.0), (-3.0, 0.0, 500.0), (0.0, 0.0, 0.0), (1e-9, 1.0, -1.0)):
        assert compiled.torque(capsule, *speeds) == pytest.approx(
            drag.torque(*speeds), rel=1e-15, abs=0.0
        )


# What the scene gives ------------------------------------------------------------------------------------------------


def test_what_is_left_to_a_scene_is_refused_outside_of_one():
    for drag in (PetroffLand(), Churning(density=900.0)):
        for use in (lambda drag=drag: drag.torque(1.0, 2.0, 0.0), drag.kernel):
            with pytest.raises(
                DomainError,
                match=rf"drag '{drag.name}' takes .* from a scene; outside of one give them",
            ):
                use()
    with pytest.raises(
        DomainError,
        match="takes oil_fraction, rollers, roller_diameter, roller_length, orbit_radius from",
    ):
        Churning(density=900.0).kernel()


def test_drags_that_leave_the_same_to_a_scene_are_equal():
    one = PetroffLand(viscosity=float("nan"))
    other = pickle.loads(pickle.dumps(PetroffLand()))
    assert one == other
    assert hash(one) == hash(other)
    assert one != PetroffLand(viscosity=0.01)


def test_what_is_given_is_checked():
    with pytest.raises(
        FieldError, match=r"viscosity: must be from 0.01 mPa s to 1e\+06 Pa s, not -0.01 Pa s"
    ):
        PetroffLand(viscosity=-0.01)
    with pytest.raises(FieldError, match="ring: must be one of 'inner', 'outer', not 'roller'"):
        PetroffLand(ring="roller")
    with pytest.raises(SceneError, match="'2 mm' is a length, here a density is expected"):
        get_model("drag", "churning", density="2 mm")
    assert get_model("drag", "petroff-land", clearance="0.1 mm").clearance == 1e-4


def test_the_kit_knows_all_that_a_scene_gives():
    assert samples.SCENE.keys() == SCENE_VALUES.keys()
    for name, (unit, meaning) in SCENE_VALUES.items():
        assert isinstance(samples.SCENE[name], float if unit else str)
        assert unit is None or check_unit(unit) == unit
        assert meaning
    with pytest.raises(KeyError):
        from_scene("colour", doc="a colour")


# Sorts ---------------------------------------------------------------------------------------------------------------


def test_all_three_sorts_are_of_the_kind_drag():
    for name, sort in (
        ("petroff-land", DragModel),
        ("hysteresis", ResistanceModel),
        ("pocket-friction", PocketFriction),
    ):
        assert isinstance(get_model("drag", name), sort)
    assert CoulombPocket().coefficient == 0.1


def test_a_drag_that_lacks_what_its_sort_has_is_refused():
    @attrs.frozen
    class Mine(PocketFriction):
        """A pocket without a coefficient."""

        name = "mine"
        equation = "M = 0"
        references = ("Nobody.",)

    assert get_kind("drag").fault(Mine) == "class Mine does not define coefficient"

    @attrs.frozen
    class Other(ResistanceModel):
        """A resistance that does not say what it reads."""

        name = "other"
        equation = "F = 0"
        references = ("Nobody.",)

        def evaluate(self, slices):
            slices.resistance[...] = 0.0

    assert get_kind("drag").fault(Other) == "class Other does not define reads, domain"
    assert "is not a class derived from Drag" in get_kind("drag").fault(Stage)


# Torques in Python and of strangers ----------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Stribeck(DragModel):
    """A torque in Python."""

    name = "stribeck"
    equation = "T = -k w_c"
    references = ("Nobody N. On nothing. J. None 1, 2000.",)
    k: float = parameter(default=1e-3, unit="1", validator=positive, doc="k")

    def torque(self, cage_speed, inner_speed, outer_speed):
        if cage_speed > 1e3:
            raise RuntimeError("no torque is known there")
        return -self.k * cage_speed if cage_speed < 900 else math.nan


def test_a_torque_in_python_is_called_from_compiled_code():
    capsule = torque_capsule(Stribeck())
    assert compiled.torque(capsule, 5.0, 2.0, 3.0) == -5e-3
    with pytest.raises(RuntimeError, match="no torque is known there") as caught:
        compiled.torque(capsule, 2e3, 0.0, 0.0)
    assert "raised by torque() of drag 'stribeck'" in caught.value.__notes__[0]
    with pytest.raises(
        DomainError,
        match="drag 'stribeck' gives a torque of nan at cage, inner and outer speed 950, 1,",
    ):
        compiled.torque(capsule, 950.0, 1.0, 2.0)


def test_a_function_of_python_may_not_give_nan_or_nothing():
    for function, error in ((lambda *_: math.nan, ArithmeticError), (lambda *_: None, TypeError)):
        with pytest.raises(error):
            compiled.torque(compiled.python_drag(function), 1.0, 2.0, 3.0)


def test_a_capsule_keeps_its_function_alive():
    capsule = compiled.python_drag(lambda cage, inner, outer: cage + 10 * inner + 100 * outer)
    assert [compiled.torque(capsule, *np.eye(3)[k]) for k in range(3)] == [1.0, 10.0, 100.0]


TORQUE = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.c_void_p
)
_ALIVE = []


def stranger(function=None, *, name=b"rollslip.drag.v1", abi=1, size=24):
    """A capsule as a third party would make it; ``rs_drag`` has the members of ``rs_model``."""
    pointer = None if function is None else TORQUE(function)
    address = None if pointer is None else ctypes.cast(pointer, ctypes.c_void_p).value
    table = RsModel(abi, size, address, None)
    _ALIVE.append((pointer, table, name))
    return _new_capsule(ctypes.addressof(table), name, None)


@attrs.frozen
class Foreign(Stribeck):
    """A torque of a third party."""

    capsule: object = None

    def kernel(self):
        if isinstance(self.capsule, Exception):
            raise self.capsule
        return self.capsule


def test_a_strangers_torque_is_taken():
    capsule = torque_capsule(
        Foreign(capsule=stranger(lambda cage, inner, outer, _: cage - 2 * outer))
    )
    assert compiled.torque(capsule, 5.0, 7.0, 1.0) == 3.0
    assert math.isnan(
        compiled.torque(
            torque_capsule(Foreign(capsule=stranger(lambda *_: math.nan))), 1.0, 2.0, 3.0
        )
    )


@pytest.mark.parametrize(
    ("capsule", "sentence"),
    [
        (42, "must return None or a capsule named 'rollslip.drag.v1', got 42"),
        (
            stranger(name=b"rollslip.slice_model.v1"),
            "must return None or a capsule named 'rollslip.drag.v1'",
        ),
        (stranger(lambda *_: 0.0, abi=7), "was built for ABI 7 of rollslip.h, this is 1"),
        (stranger(lambda *_: 0.0, size=8), "has 8 bytes of rs_drag, this rollslip reads 24"),
        (stranger(), "gave a table whose torque is NULL"),
        (RuntimeError("no compiler"), "fails (RuntimeError: no compiler)"),
    ],
    ids=["number", "stage", "abi", "size", "null", "error"],
)
def test_a_kernel_that_breaks_the_contract_is_refused(capsule, sentence):
    with pytest.raises(PluginError) as error:
        torque_capsule(Foreign(capsule=capsule))
    assert sentence in str(error.value)
    assert str(error.value).startswith(f"drag 'stribeck': {Foreign.__module__}.Foreign.kernel() ")


# Several -------------------------------------------------------------------------------------------------------------


def test_drags_add_up():
    none = Drags()
    some = Drags(torques=(ConstantTorque(), PetroffLand(**LAND), Stribeck()))
    assert not none
    assert none.torque(300.0, 667.0, 0.0) == 0.0
    assert none.capsules() == ()
    assert some
    parts = [compiled.torque(capsule, 300.0, 667.0, 0.0) for capsule in some.capsules()]
    assert sum(parts) == pytest.approx(some.torque(300.0, 667.0, 0.0), rel=1e-14)
    assert Drags(pocket_friction=CoulombPocket())
    assert Drags(resistance=Hysteresis())


@attrs.frozen(kw_only=True)
class InPython(ResistanceModel):
    """A resistance without a kernel."""

    name = "in-python"
    equation = "F = k w"
    references = ("Nobody N. On nothing. J. None 1, 2000.",)
    reads = frozenset({"load"})
    domain = {"load": (5e-324, 1e6)}  # noqa: RUF012 - never changed

    def evaluate(self, slices):
        if np.any(slices.load == 666.0):
            raise RuntimeError("not that load")
        slices.resistance[...] = 1e-3 * slices.load


TERMS = (RollingResistance(), Hysteresis(), InPython())


def test_resistances_add_up_in_one_column():
    n = 700  # more than one block, and a rest
    columns = {
        "load": np.linspace(1e3, 1e5, n),
        "rolling_speed": 20.0,
        "half_width": np.linspace(1e-5, 1e-4, n),
    }
    expected = sum(resistance_in_both_forms(term, **columns) for term in TERMS)
    total = TotalResistance(terms=TERMS)
    np.testing.assert_allclose(resistance_in_both_forms(total, **columns), expected, rtol=1e-14)
    slices = Slices(n, STEEL, **columns)
    Chain(total, block=0)(slices)
    np.testing.assert_allclose(slices.resistance, expected, rtol=1e-14)
    assert (
        total.reads == RollingResistance().reads
    )  # steel and InPython ask for no more; Hertz's b is of the load
    assert total.domain["load"] == (POSITIVE[0], 1e6)


def test_a_term_that_fails_is_heard():
    total = TotalResistance(terms=TERMS)
    with pytest.raises(RuntimeError, match="not that load"):
        resistance_in_both_forms(total, load=666.0, rolling_speed=1.0, half_width=1e-5)
    with pytest.raises(
        DomainError, match=r"total-resistance: load = 1e\+07 N/m at slice 0 is outside its domain"
    ):
        resistance_in_both_forms(total, load=1e7, rolling_speed=1.0, half_width=1e-5)
    with pytest.raises(ValueError, match="at most 8 can be added, got 9"):
        compiled.total_resistance([Hysteresis().kernel()] * 9)


def test_a_sum_keeps_the_rules_of_resistances():
    findings = conformance(TotalResistance(terms=(COLD, Hysteresis(loss=0.05))))
    assert [(f.check, f.message) for f in findings if f.status == "failed"] == []
