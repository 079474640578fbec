"""A torque on the rollers, such as of flanges, is a resistance that differs between the rings.

Resistances F_i and F_o of both contacts brake the spin by r (F_i + F_o), and what they pull on the cage by is that less
R_i F_i - R_o F_o. Both are the torque N, and the cage feels nothing, where ::

    F_i = N (R_m + 2 r)/(2 r R_m)      F_o = N (R_m - 2 r)/(2 r R_m)

with r, R_m radii of roller and orbit, R_o = R_m + r, R_i = R_m - r. The rings bear the reaction, R_i F_i - R_o F_o = N.
"""

from types import MappingProxyType

import attrs
import numpy as np
import pytest

from kit import failed
from registrations import registrations_rolled_back
from rollslip import evolve, load_scene, register
from rollslip.bearing.assembly import assemble
from rollslip.fields import non_negative, parameter
from rollslip.models import POSITIVE, ResistanceModel, from_scene
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import torque_balance
from without_bands import run

SIZE = 2e-3  # N m


@attrs.frozen(kw_only=True)
class FlangeTorque(ResistanceModel):
    """Torque of the flanges on every loaded roller, which falls with temperature.

    N = N_0 exp(-b (T - T_0)), N torque [N m] at the temperature T of the operation [K], b its fall [1/K].
    """

    name = "flange-torque"
    equation = "N = N_0 exp(-b (T - T_0))"
    references = ("An example. 2020, made for a test.",)
    reads = frozenset({"load", "radius"})
    domain = MappingProxyType({"load": POSITIVE, "radius": POSITIVE})

    size: float = parameter(
        default=SIZE, unit="N m", validator=non_negative, doc="torque at the reference"
    )
    reference: float = parameter(default=343.0, unit="K", validator=non_negative, doc="T_0")
    fall: float = parameter(
        default=0.02, unit="1/K", validator=non_negative, doc="its fall with temperature"
    )
    temperature: float = from_scene("temperature", doc="temperature")
    length: float = from_scene("roller_length", doc="length of a roller")
    diameter: float = from_scene("roller_diameter", doc="diameter of a roller")
    orbit: float = from_scene("orbit_radius", doc="radius of the orbit")

    def evaluate(self, slices):
        """Fill the resistance: the inner contact is the one whose equivalent radius is below that of the roller."""
        sense = np.where(slices.conditions.radius < self.diameter / 2, 1.0, -1.0)
        fraction = (self.orbit + sense * self.diameter) / (self.diameter * self.orbit)
        torque = self.size * np.exp(-self.fall * (self.temperature - self.reference))
        slices.resistance[...] = torque * fraction / self.length + 0.0 * slices.load


#: Straight rollers of which both contacts are loaded all round.
PRELOADED = evolve(
    load_scene("1032930-70C"),
    {
        "bearing.profile": "none",
        "bearing.radial_clearance": "-40 um",
        "operation.radial_load": "500 N",
    },
)


@pytest.fixture(autouse=True)
def known():
    with registrations_rolled_back():
        register(FlangeTorque)
        yield


def scene(**changes):
    torque = {"model": "constant-torque", "size": "0.1 N m"}
    return evolve(
        PRELOADED, {"cage.drag": [torque, {"model": "flange-torque"}], **changes}, si=True
    )


def test_it_brakes_the_spin_and_leaves_the_cage_alone():
    balance = torque_balance(assemble(scene()), 2)
    k = balance.assembly.kinematics
    orbit = balance.orbit(0.05)
    assert (orbit.force > 0.0).all()
    torque = SIZE * np.exp(-0.02 * 0.15)
    traction, (inner, outer), on_cage = balance.forces(orbit)
    np.testing.assert_allclose(
        k.roller_radius * (inner + outer), torque, rtol=1e-6
    )  # u over that of the film
    np.testing.assert_allclose(
        k.inner_radius * inner - k.outer_radius * outer, torque, rtol=1e-3
    )  # R_o - R_i is 2 r
    only_tractions = k.orbit_radius * (traction[0] + traction[1])
    np.testing.assert_allclose(on_cage, only_tractions, atol=2e-3 * torque)


def test_the_rings_pay_for_it_what_its_reaction_takes():
    """N w_r for the spin, and the reaction of each ring at the speed at which it passes the rollers."""
    balance = torque_balance(assemble(scene()), 2)
    k = balance.assembly.kinematics
    orbit = balance.orbit(0.05)
    found = power_balance(balance, orbit)
    torque = SIZE * np.exp(-0.02 * 0.15)
    lost = sum(loss.power for loss in found.losses if loss.source.startswith("flange-torque"))
    spin = k.surface_speeds(0.05, orbit.roller_slip).roller_speed.mean()
    cage = balance.cage_speed(0.05)
    r = k.roller_radius
    orbit_radius = k.orbit_radius
    inner, outer = (
        torque * (orbit_radius + 2.0 * side * r) / (2.0 * r * orbit_radius) for side in (1.0, -1.0)
    )
    reaction = inner * k.inner_radius * (k.inner_speed - cage) + outer * k.outer_radius * (
        cage - k.outer_speed
    )
    assert lost == pytest.approx(28 * (torque * spin + reaction), rel=1e-6)
    rings = sum(found.rings)
    assert rings == pytest.approx(found.total + found.stored, rel=1e-9)


def test_warmer_flanges_brake_less_and_rollers_slip_less():
    slips = []
    for temperature in ("60 degC", "90 degC"):
        balance = torque_balance(assemble(scene(**{"operation.temperature": temperature})), 2)
        _, resistance, _ = balance.forces(balance.orbit(0.0))
        slips.append(float(resistance.sum(axis=0).mean()))
    assert slips[1] / slips[0] == pytest.approx(np.exp(-0.6), rel=1e-6)


def test_a_motion_has_it():
    changes = {"study.dynamics.duration": "2 ms", "study.dynamics.friction": "conventional"}
    found = run(scene(**changes), "dynamics")
    assert found.outcome == "finished"
    lost = float(found.work_done.sel(work="lost_rolling").isel(time=-1))
    spin = float(found.roller_speed.mean())
    assert -lost == pytest.approx(2.0 * 28 * SIZE * np.exp(-0.02 * 0.15) * spin * 2e-3, rel=1e-3)


def test_it_keeps_the_contract():
    model = FlangeTorque(temperature=343.0, length=0.02, diameter=0.014, orbit=0.0825)
    assert not failed(model)
