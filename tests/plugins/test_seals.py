"""Losses beside the rollers: their formulas by hand, and where their power goes in a bearing."""

import math
from typing import ClassVar

import attrs
import numpy as np
import pytest

from coarse import COARSE
from rollslip import evolve, load_scene, run
from rollslip.bearing.assembly import assemble
from rollslip.catalogue import discovery
from rollslip.errors import DomainError, PluginError, SceneError, UnknownNameError
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import Duty
from rollslip_campaigns.surrogate import SurrogateSettings
from rollslip_plugins.seals import RadialLipSeal, SkfSeals
from rollslip_studies.dynamics import heating
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import TorqueBalance
from rollslip_studies.steady_slip.findings import SteadySlipAccount
from rollslip_studies.steady_slip.friction_torque.findings import _ratio_to_formulas

DUTY = Duty(
    bore=0.06, outside_diameter=0.13, pitch_diameter=0.0965, radial_load=5e3, speed=400.0, viscosity=0.02,
    roller_diameter=0.0195,
)  # fmt: skip
SCENE = evolve(load_scene("gearbox"), COARSE, si=True)
#: Losses of the tests: those of a sealed bearing, and of two seals on the shaft.
SEALS = ["skf-seals", {"model": "radial-lip-seal", "number": 2}]


@attrs.frozen(kw_only=True)
class Gear(LossModel):
    """A gear that stirs the oil; `exponent` of the speed."""

    name: ClassVar[str] = "own-gear"
    equation: ClassVar[str] = "P = c w^3"
    references: ClassVar[tuple[str, ...]] = ("Nobody N. On gears that are made to be tested.",)
    value: float = 1e-5

    def power(self, duty):
        return self.value * duty.speed**3


@pytest.fixture(autouse=True)
def only_built_in(monkeypatch):
    monkeypatch.setattr(discovery, "_registered", {})


def test_powers_are_those_worked_by_hand():
    # d_s = 96.5 + 19.5 = 116 mm: 0.032 116^2 + 50 = 480.592 N mm; 7.69e-6 60^2 W min for each lip
    assert SkfSeals().power(DUTY) == pytest.approx(0.480592 * 400.0, rel=1e-12)
    assert SkfSeals(diameter=0.1, factor=2.0).power(DUTY) == pytest.approx(0.74 * 400.0, rel=1e-12)
    revolutions = 400.0 * 30.0 / math.pi
    lips = RadialLipSeal(number=3)
    assert lips.power(DUTY) == pytest.approx(3 * 7.69e-6 * 3600 * revolutions, rel=1e-12)
    with pytest.raises(DomainError, match="needs the diameter on which the lip rubs"):
        SkfSeals().power(attrs.evolve(DUTY, roller_diameter=None))


@pytest.mark.parametrize("outer", [0.0, -60.0, 300.0])
def test_the_rings_supply_what_seals_lose_and_nothing_else_changes(outer):
    at = evolve(SCENE, {"operation.outer_speed": outer}, si=True)
    balances = []
    for changes in ({}, {"models.loss": SEALS}):
        bearing = assemble(evolve(at, changes)).with_resistance()
        balance = TorqueBalance(bearing, bearing.cage.drags, n_positions=2)
        balances.append(power_balance(balance, balance.orbit(0.02)))
    without, sealed = balances
    added = sum(model.power(Duty.of(bearing)) for model in (SkfSeals(), RadialLipSeal(number=2)))
    assert sealed.losses[: len(without.losses)] == without.losses
    assert [loss.source for loss in sealed.losses[-2:]] == ["skf-seals", "radial-lip-seal"]
    assert sealed.total - without.total == pytest.approx(added, rel=1e-12)
    assert sealed.heat("inner land") == pytest.approx(added, rel=1e-12)
    assert sum(sealed.rings) - sum(without.rings) == pytest.approx(added, rel=1e-9)
    assert sealed.stored == without.stored
    # both rings are braked by the same torque, in opposite senses
    assert sum(sealed.torques) == pytest.approx(sum(without.torques), abs=1e-12)
    speed = abs(at.operation.inner_speed - outer)
    assert sealed.external_torque == pytest.approx(added / speed, rel=1e-12)
    assert sealed.friction_torque - without.friction_torque == pytest.approx(added / speed)
    assert without.external_torque == 0.0


@pytest.mark.slow
def test_a_result_has_the_seals_and_is_compared_with_formulas_without_them():
    plain = run(SCENE, "steady-slip")
    sealed = run(evolve(SCENE, {"models.loss": SEALS}), "steady-slip")
    assert "external_torque" not in plain
    same = [name for name in plain.data_vars if plain[name].dims == sealed[name].dims]
    changed = {"ring_power", "ring_torque", "friction_torque"}
    for name in {*same} - changed:
        if plain[name].dtype.kind == "f" and "source" not in plain[name].dims:
            assert np.array_equal(plain[name], sealed[name], equal_nan=True), name
    torque = sealed.friction_torque - sealed.external_torque
    assert torque.to_numpy() == pytest.approx(plain.friction_torque.to_numpy(), rel=1e-9)
    assert _ratio_to_formulas(sealed) == pytest.approx(_ratio_to_formulas(plain), rel=1e-9)
    topics = SteadySlipAccount.topics(sealed).values()
    sentences = "\n".join(sentence for topic in topics for sentence in topic)
    assert "% skf-seals" in sentences
    assert "without the losses of models.loss" in sentences
    assert "no other drag, nor models.loss" in sentences


def test_the_heat_of_seals_has_to_be_carried_away():
    given = evolve(SCENE, {"models.loss": ["skf-seals"], "models.thermal": "given"})
    result = run(given, "thermal-balance")
    power = SkfSeals().power(Duty.of(assemble(SCENE)))
    assert float(result.loss.sel(source="skf-seals")[0]) == pytest.approx(power, rel=1e-12)
    assert result.carried_away.to_numpy().sum() == pytest.approx(result.loss.to_numpy().sum())


@pytest.mark.soak
def test_seals_warm_a_bearing():
    changes = {"study.thermal-balance.points": 8}
    plain, sealed = (
        run(evolve(SCENE, changes | {"models.loss": loss}), "thermal-balance")
        for loss in ([], ["skf-seals"])
    )
    balance = sealed.isel(balance=0)
    assert float(balance.carried_away.sum()) == pytest.approx(float(balance.loss.sum()), rel=1e-5)
    assert float(balance.temperature.sel(node="oil")) > float(plain.temperature.sel(node="oil")[0])


def test_the_heat_of_a_motion_is_the_integral_of_the_power_over_its_history():
    """A power c w^3 makes c (b^4 - a^4)/(4 (b - a)) t of heat while the speed rises linearly from a to b."""
    discovery.add("loss", Gear)
    bearing = assemble(evolve(SCENE, {"models.loss": ["own-gear"]}))
    times = np.linspace(0.0, 2.0, 1001)
    speeds = np.array([np.linspace(50.0, 100.0, times.size), np.zeros(times.size)])
    ((place, heat),) = heating._external_heat(bearing, None, times, speeds)
    assert place == "oil"
    assert heat[-1] == pytest.approx(1e-5 * (100.0**4 - 50.0**4) / (4.0 * 50.0) * 2.0, rel=1e-6)
    assert [*heating._external_heat(assemble(SCENE), None, times, speeds)] == []


@pytest.mark.soak
def test_a_motion_is_heated_by_the_power_at_the_speeds_of_its_history():
    discovery.add("loss", Gear)
    duration = 0.02
    start = 50.0
    end = 100.0
    settings = {
        "duration": duration,
        "points": 5,
        "level": "cage-set",
        "friction": "effective",
        "history": {"inner_speed": {"time": [0.0, duration], "value": [start, end]}},
    }
    nodes = ("oil", "inner_ring", "rollers", "outer_ring", "housing", "shaft")
    network = {"model": "network", **{f"{node}_capacity": 1e12 for node in nodes}}  # one pass
    changes = {"study.dynamics": settings, "models.thermal": network, **COARSE}
    scene = evolve(load_scene("1032930-70C"), changes, si=True)
    made = []
    for value in (1e-12, 1e-3):
        own = evolve(scene, {"models.loss": [{"model": "own-gear", "value": value}]}, si=True)
        made.append(Dynamics.from_scene(own).run(assemble(own)).attrs["heat_made"])
    expected = 1e-3 * (end**4 - start**4) / (4.0 * (end - start)) * duration
    assert made[1] - made[0] == pytest.approx(expected, rel=1e-3)


def test_bad_powers_and_unknown_losses_are_refused_by_name():
    discovery.add("loss", Gear)
    own = evolve(SCENE, {"models.loss": [{"model": "own-gear", "value": -1.0}]}, si=True)
    with pytest.raises(DomainError, match=r"models\.loss: 'own-gear' gives -\d.* W at 1500 rpm"):
        run(own, "steady-slip")
    with pytest.raises(UnknownNameError, match="no loss is called 'own-seal'"):
        run(evolve(SCENE, {"models.loss": ["own-seal"]}), "steady-slip")
    with pytest.raises(SceneError, match="tables hold the friction of rollers and cage alone"):
        SurrogateSettings(evolve(SCENE, {"models.loss": SEALS}), {}, engine="serial").plan()
    with pytest.raises(PluginError, match="place is 'shaft'; heat arises at one of inner contact"):
        discovery.add("loss", attrs.frozen(type("Far", (Gear,), {"place": "shaft"})))
