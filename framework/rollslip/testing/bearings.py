"""The rules of models of a whole bearing: heat, damage, friction torque by formulas, rating life, and rings.

- Heat is conserved and flows from warm to cold.
- Damage models are evaluated on slices that the laws of a bearing have filled (`_contacts`).
- Each term of a friction torque resists the motion, and not less with more load.
- Losses beside the rollers take power, and none from a bearing at rest.
- A rating life is finite and shorter under more load.
- Flexible rings take a part of a preload.
"""

import math
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.bearing.raceway import RINGS
from rollslip.errors import DomainError
from rollslip.rings import RingModel, Rings, RingShapes
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene
from rollslip.search import Array
from rollslip.studies.rating_life.model import LifeDuty, LifeModel, modified_factor
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import Duty, TorqueFormula
from rollslip.studies.surface_damage.model import Contacts, DamageModel, harm
from rollslip.studies.thermal_balance.model import PLACES, ROLES, ThermalModel
from rollslip.testing.rules import (
    CITATIONS_WANTED,
    Inapplicable,
    Nonconformance,
    Questionable,
    is_citation,
    refuse_unless,
    rule,
)
from rollslip.units import UnitError, check_unit
from rollslip_kernels.slices import COLUMNS

#: Rounding error of a sum of heat flows, relative to the largest of them [1]. Doubling it accepts the same models: a
#: missing flow is larger by orders of magnitude. Chosen far above the rounding of a sum of a few terms.
_ROUNDING = 1e-10
#: f_0 of Palmgren's torque [1]: that of a bath and series 2 in ISO 15312.
_F0 = 2.0
#: f_1 of Palmgren's torque [1], of the same series.
_F1 = 3e-4
#: Factor by which a torque may differ from Palmgren's. Formulas in use differ by up to 4; a wrong unit by 9 or more,
#: in powers. Doubling it accepts a torque in N mm of small bearings.
_SIZE = 50.0
#: Factor by which a loss beside the rollers may differ from Palmgren's power without a question. Built-in seals
#: differ by up to 62 on the drawn bearings; a torque in N mm differs by 1000 more. Doubling it still finds that.
_LOSS_SIZE = 100.0
#: Radial load over the square of the bore [Pa]: a tenth of usual ratings. Chosen.
_USUAL_PRESSURE = 4e6
#: Pitch diameter times speed [m/s] of usual bearings at work. Chosen.
_USUAL_SPEED = 10.0
#: Number of random inputs per rule. Doubling it doubles the time of the checks and finds rarer faults. Chosen.
_DRAWN = 25


def _bound(model: ThermalModel) -> tuple[ThermalModel, Array]:
    """Return the model bound to a bearing, and its initial temperatures [K]."""
    scene = load_scene("1032930-70C")
    bound = model.of(assemble(scene))
    if not bound.nodes:
        raise Inapplicable("it has no nodes: temperatures do not follow from losses")
    return bound, np.asarray(bound.start(scene), dtype=float)


def _draws(start: Array) -> Iterator[tuple[Array, Mapping[str, float]]]:
    """Yield random temperatures [K] and losses [W] of all sizes, the same in each run."""
    random = np.random.default_rng(4)
    for _ in range(_DRAWN):
        yield (
            start + random.uniform(-60.0, 150.0, start.size),
            dict(zip(PLACES, 10.0 ** random.uniform(-2.0, 4.0, len(PLACES)), strict=True)),
        )


@rule(ThermalModel, DamageModel, TorqueFormula, LossModel, LifeModel, RingModel)
def check_has_an_equation_and_references(
    model: ThermalModel | DamageModel | TorqueFormula | LossModel | LifeModel | RingModel,
) -> None:
    """A name, an equation, and references."""
    refuse_unless(isinstance(model.equation, str) and model.equation.strip(), "it has no equation")
    refuse_unless(model.references and all(map(is_citation, model.references)), CITATIONS_WANTED)


@rule(ThermalModel)
def check_heat_is_conserved(model: ThermalModel) -> None:
    """What flows into all nodes is what is lost, less what is carried away."""
    bound, start = _bound(model)
    for T, losses in _draws(start):
        flows = np.asarray(bound.inflows(T, losses))
        away = bound.carried_away(T)
        refuse_unless(
            flows.shape == T.shape, f"inflows have shape {flows.shape}, there are {T.size} nodes"
        )
        missing = sum(losses.values()) - sum(away.values()) - float(flows.sum())
        size = max([sum(losses.values()), *np.abs(flows), *map(abs, away.values())])
        if not abs(missing) <= _ROUNDING * size:
            raise Nonconformance(
                f"{missing:.6g} W are lost on the way: losses {sum(losses.values()):.6g} W, into the nodes "
                f"{float(flows.sum()):.6g} W, carried away {sum(away.values()):.6g} W"
            )


@rule(ThermalModel)
def check_a_warmer_node_takes_less_heat_and_the_others_no_less(model: ThermalModel) -> None:
    """Heat flows from warm to cold."""
    bound, start = _bound(model)
    for T, losses in _draws(start):
        before = np.asarray(bound.inflows(T, losses))
        for k, node in enumerate(bound.nodes):
            warmer = T.copy()
            warmer[k] += 1.0
            change = np.asarray(bound.inflows(warmer, losses)) - before
            slack = _ROUNDING * float(np.abs(before).max())
            refuse_unless(
                change[k] <= slack,
                f"the {node} takes {change[k]:.3g} W more where it is 1 K warmer",
            )
            refuse_unless(
                np.all(np.delete(change, k) >= -slack),
                f"other nodes take less heat where the {node} is 1 K warmer",
            )


@rule(ThermalModel)
def check_nodes_have_capacities_and_keys_of_the_scene(model: ThermalModel) -> None:
    """Capacities are above zero; the temperatures of the scene are among what changes."""
    bound, start = _bound(model)
    capacities = np.asarray(bound.capacities(), dtype=float)
    refuse_unless(
        capacities.shape == start.shape
        and np.all(capacities > 0.0)
        and np.all(np.isfinite(capacities)),
        f"capacities are {capacities}; give one above zero for each of {', '.join(bound.nodes)}",
    )
    changes = bound.changes(start, load_scene("1032930-70C"))
    missing = [key for key in ROLES if not math.isfinite(changes.get(key, math.nan))]
    refuse_unless(not missing, f"changes() gives no value for {', '.join(missing)}")


# Damage models --------------------------------------------------------------------------------------------------------

#: Relative difference allowed between measures of a slice in tables with other slices, or in another order [1].
#: Doubling it accepts the same models; it is some thousand roundings.
_ORDER_TOLERANCE = 1e-12
#: Relative difference allowed between the measure of a contact and the worst of 201 points across it [1]. Doubling it
#: accepts coarser models; it is the error of sampling a smooth maximum at so many points.
_SAMPLING_TOLERANCE = 1e-3


@cache
def _contacts() -> tuple[Contacts, ...]:
    """Return evaluated contacts of both rings at different temperatures, with random loads, speeds and slips."""
    scene = evolve(load_scene("1032930-70C"), {"operation.roller_temperature": "85 degC"})
    assembly = assemble(scene)
    random = np.random.default_rng(7)
    load = 10.0 ** random.uniform(3.0, 5.3, _DRAWN)
    rolling = 10.0 ** random.uniform(-0.3, 1.6, _DRAWN)
    sliding = rolling * random.uniform(-1.0, 1.0, _DRAWN)
    return tuple(
        Contacts.of(assembly, ring, raceway.evaluate(load, rolling, sliding))
        for ring, raceway in zip(RINGS, assembly.raceways, strict=True)
    )


def _changed(contacts: Contacts, order: Any = slice(None), **columns: Any) -> Contacts:
    """Return slices of an order with other columns, in a table of their own."""
    slices = contacts.slices.taken(order)
    for name, values in columns.items():
        getattr(slices, name)[:] = values
    return attrs.evolve(contacts, slices=slices)


def _value(model: DamageModel, contacts: Contacts) -> Array:
    return np.asarray(model.evaluate(contacts), dtype=float)


@rule(DamageModel)
def check_describes_its_unit_and_limits(model: DamageModel) -> None:
    """No measure of damage holds in general; who reads a value has to know its unit and its limits."""
    for name in ("measure", "unit", "scope"):
        text = getattr(model, name)
        refuse_unless(
            isinstance(text, str) and bool(text.strip()), f"{name} is {text!r}; say it in words"
        )
    try:
        check_unit(model.unit)
    except UnitError as error:
        raise Nonconformance(f"unit {model.unit!r} is not an SI unit: {error}") from error
    refuse_unless(
        model.worst in ("largest", "smallest"),
        f"worst is {model.worst!r}; it is largest or smallest",
    )


@rule(DamageModel)
def check_value_of_each_slice_is_finite(model: DamageModel) -> None:
    """A measure is a finite number, not negative, of every loaded slice."""
    for contacts in _contacts():
        values = _value(model, contacts)
        refuse_unless(
            values.shape == (_DRAWN,), f"the measure of {_DRAWN} slices has shape {values.shape}"
        )
        wrong = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
        refuse_unless(not wrong.size, f"the measure of slice {wrong[:1]} is {values[wrong[:1]]}")


@rule(DamageModel)
def check_slices_are_measured_alone_and_left_as_they_are(model: DamageModel) -> None:
    """Each slice has its own measure, whatever is beside it, and laws that follow see what was there."""
    for contacts in _contacts():
        before = contacts.slices.taken()
        values = _value(model, contacts)
        for name in COLUMNS:
            same = np.array_equal(
                getattr(before, name), getattr(contacts.slices, name), equal_nan=True
            )
            refuse_unless(same, f"evaluate() writes to {name}; work on a copy")
        back = _value(model, _changed(contacts, slice(None, None, -1)))[::-1]
        off = float(np.abs(back - values).max() / (np.abs(values).max() or 1.0))
        refuse_unless(
            off <= _ORDER_TOLERANCE, f"in another order measures differ by {off:.1e} (relative)"
        )


@rule(DamageModel)
def check_more_friction_is_no_better(model: DamageModel) -> None:
    """With more friction surfaces fare no better, and without friction no worse."""
    for contacts in _contacts():
        values = harm(model, _value(model, contacts))
        slices = contacts.slices
        slack = _ROUNDING * np.abs(values)
        more = harm(model, _value(model, _changed(contacts, friction=2.0 * slices.friction)))
        refuse_unless(np.all(more >= values - slack), "a measure is better with twice the friction")
        none = harm(model, _value(model, _changed(contacts, friction=0.0)))
        refuse_unless(
            np.all(none <= values + slack), "a measure is worse without friction than with it"
        )


@rule(DamageModel)
def check_values_across_a_contact_agree_with_the_measure(model: DamageModel) -> None:
    """What is told of the inside of a contact is one value a place, and holds what the measure says of the whole."""
    places = np.linspace(-1.0, 1.0, 201)
    for contacts in _contacts():
        if (across := model.across(contacts, places)) is None:
            raise Inapplicable("it has one value for a contact")
        across = np.asarray(across, dtype=float)
        refuse_unless(
            across.shape == (_DRAWN, places.size), f"across() has shape {across.shape}, not (n, m)"
        )
        refuse_unless(bool(np.all(np.isfinite(across))), "across() has places without a value")
        values = _value(model, contacts)
        short = harm(model, values) - harm(model, across).max(axis=1)
        worst = float((short / np.maximum(np.abs(values), np.finfo(float).tiny)).max())
        refuse_unless(
            worst <= _SAMPLING_TOLERANCE,
            f"no place across a contact is as bad as it says: {worst:.1e} (relative) less",
        )


@rule(DamageModel)
def check_a_limit_has_a_source(model: DamageModel) -> None:
    """A limit is a number above zero and who found it; where there is none, None says so."""
    if (limit := model.limit) is None:
        raise Inapplicable("it has no limit")
    refuse_unless(
        isinstance(limit, tuple) and len(limit) == 2,
        f"limit is {limit!r}; give value and source, or None",
    )
    value, source = limit
    refuse_unless(
        isinstance(value, int | float) and 0.0 < value < math.inf, f"the limit is {value!r}"
    )
    refuse_unless(
        isinstance(source, str) and bool(source.strip()), f"the source of the limit is {source!r}"
    )


# Formulas of the friction torque -------------------------------------------------------------------------------------


def _duties() -> Iterator[Duty]:
    """Yield random bearings with a bore of 10 mm to 1 m, loads and speeds, the same in each run."""
    random = np.random.default_rng(6)
    for temperature in np.linspace(273.15, 423.15, _DRAWN):
        bore = 10.0 ** random.uniform(-2.0, 0.0)
        outside = bore * random.uniform(1.3, 2.5)
        yield Duty(
            bore=bore,
            outside_diameter=outside,
            pitch_diameter=0.5 * (bore + outside),
            radial_load=10.0 ** random.uniform(1.0, 5.0),
            speed=10.0 ** random.uniform(-1.0, 3.5),
            viscosity=10.0 ** random.uniform(-3.0, 0.0),
            density=random.uniform(700.0, 1000.0),
            width=(outside - bore) * random.uniform(0.3, 0.7),
            series=str(random.choice(["10", "2", "22", "3", "23", "4"])),
            supply=str(random.choice(["bath", "splash", "circulating", "jet", "mist", "grease"])),
            roller_diameter=0.25 * (outside - bore),
            temperature=float(temperature),
        )


def _torque(formula: TorqueFormula, duty: Duty) -> Mapping[str, float]:
    terms = formula.terms(duty)
    refuse_unless(
        isinstance(terms, Mapping)
        and terms
        and all(isinstance(term, str) and term.strip() for term in terms),
        f"terms() returned {terms!r}; return torques [N m] by what makes them",
    )
    return terms


@rule(TorqueFormula)
def check_every_term_resists(formula: TorqueFormula) -> None:
    """Terms are finite and not below zero, and the same terms for all bearings."""
    names = None
    for duty in _duties():
        terms = _torque(formula, duty)
        bad = {
            term: torque
            for term, torque in terms.items()
            if not (math.isfinite(torque) and torque >= 0.0)
        }
        refuse_unless(not bad, f"terms are {bad} at {duty}")
        refuse_unless(
            names in (None, tuple(terms)), f"terms are {', '.join(terms)} here, {names} elsewhere"
        )
        names = tuple(terms)


def _palmgren(duty: Duty) -> float:
    """Return Palmgren's torque [N m]: 1e-7 f_0 (nu n)^(2/3) d_m^3 + f_1 F d_m, in mm2/s, 1/min, mm and N mm."""
    assert duty.density is not None
    flow = 1e6 * duty.viscosity / duty.density * abs(duty.speed) * 30.0 / math.pi
    of_oil = 1e-7 * _F0 * max(flow, 2000.0) ** (2.0 / 3.0) * (1e3 * duty.pitch_diameter) ** 3
    return float(1e-3 * (of_oil + _F1 * duty.radial_load * 1e3 * duty.pitch_diameter))


@rule(TorqueFormula)
def check_torque_is_of_the_size_that_bearings_have(formula: TorqueFormula) -> None:
    """It is held against Palmgren's: what is a thousand times as large takes a speed or a length in another unit."""
    for duty in _duties():
        duty = attrs.evolve(
            duty,
            radial_load=_USUAL_PRESSURE * duty.bore * duty.bore,
            speed=_USUAL_SPEED / duty.pitch_diameter,
        )
        torque = sum(_torque(formula, duty).values())
        usual = _palmgren(duty)
        refuse_unless(
            usual / _SIZE <= torque <= usual * _SIZE,
            f"{torque:.4g} N m, and {usual:.4g} N m by Palmgren, at {duty}; a speed in 1/min or a length in mm?",
        )


@rule(TorqueFormula)
def check_more_load_resists_no_less(formula: TorqueFormula) -> None:
    """The sum of the terms does not fall with load."""
    for duty in _duties():
        less, more = (
            sum(
                _torque(formula, attrs.evolve(duty, radial_load=factor * duty.radial_load)).values()
            )
            for factor in (1.0, 2.0)
        )
        refuse_unless(
            more >= less * (1.0 - 1e-12), f"{less:.6g} N m at {duty}, {more:.6g} at twice the load"
        )


@rule(TorqueFormula)
def check_oil_without_density_is_refused_or_accepted(formula: TorqueFormula) -> None:
    """What is not known is asked for by `Duty`, not guessed."""
    for duty in _duties():
        try:
            known = sum(_torque(formula, attrs.evolve(duty, density=None)).values())
        except DomainError:
            continue
        refuse_unless(
            known == sum(_torque(formula, duty).values()),
            "without a density the torque is another one",
        )


# Losses beside the rollers -------------------------------------------------------------------------------------------

#: Fraction of a speed at which next to nothing may be lost [1], and the largest fraction of the power there. A torque
#: that does not depend on speed leaves 1e-6; a constant power leaves all of it. Doubling either finds the same faults.
_SLOW = 1e-6
#: Largest fraction of the power at that speed [1], of torques that rise towards rest as those of dry seals do.
_MAX_SLOW_POWER = 1e-3


def _powers(model: LossModel, speed_factor: float = 1.0) -> Iterator[tuple[Duty, float]]:
    """Yield duties at a multiple of their speeds and the power lost there [W], of those that a loss does not refuse."""
    refusals = 0
    for drawn in _duties():
        duty = attrs.evolve(drawn, speed=speed_factor * drawn.speed)
        try:
            yield duty, model.power(duty)
        except DomainError:
            refusals += 1
    if refusals == _DRAWN:
        raise Inapplicable("it refuses all bearings: test it with parameters that it needs")


@rule(LossModel)
def check_power_is_finite_and_not_negative(model: LossModel) -> None:
    """Seals, grease and gears take power and give none."""
    for duty, power in _powers(model):
        refuse_unless(
            isinstance(power, int | float) and 0.0 <= power < math.inf,
            f"power() returned {power!r} at {duty}; return a number of watts, zero or more",
        )


@rule(LossModel)
def check_a_bearing_at_rest_loses_nothing(model: LossModel) -> None:
    """Power vanishes with the speed: at rest it is zero, and a slow bearing loses little."""
    for duty, power in _powers(model, 0.0):
        refuse_unless(power == 0.0, f"{power!r} W are lost at rest, at {duty}")
    for (duty, power), (_, slow) in zip(_powers(model), _powers(model, _SLOW), strict=True):
        refuse_unless(
            slow <= _MAX_SLOW_POWER * power,
            f"{slow:.4g} W are lost at {_SLOW:g} of a speed at which {power:.4g} W are, at {duty}: a torque without "
            "bound",
        )


@rule(LossModel)
def check_power_is_of_the_size_that_bearings_have(model: LossModel) -> None:
    """Its torque is compared with Palmgren's: far more or less may be a length in mm or a torque in N mm."""
    for duty, power in _powers(model):
        usual = _palmgren(duty) * duty.speed
        ratio = power / usual
        if power and not 1.0 / _LOSS_SIZE <= ratio <= _LOSS_SIZE:
            raise Questionable(
                f"{power:.4g} W are {ratio:.2g} times what the bearing itself loses by Palmgren, at {duty}; a speed in "
                "1/min, a length in mm or a torque in N mm?"
            )


# Rating lives ---------------------------------------------------------------------------------------------------------


def _life_duties() -> Iterator[LifeDuty]:
    """Yield random loads on half of 20 rollers, uneven along them, the same in each run."""
    random = np.random.default_rng(9)
    orbit = np.maximum(np.cos(0.1 * np.pi * np.arange(20)), 0.0)
    for slices in range(2, _DRAWN):
        load = 10.0 ** random.uniform(2.0, 5.0)
        yield LifeDuty(
            rollers=20,
            roller_diameter=0.01,
            roller_length=0.01,
            pitch_diameter=0.1,
            radial_load=load,
            dynamic_rating=load * random.uniform(2.0, 50.0),
            load=np.tile(
                25.0 * load * orbit[:, None] * random.uniform(0.2, 1.0, slices), (2, 1, 1, 1)
            ),
            widths=np.full(slices, 0.01 / slices),
        )


@rule(LifeModel)
def check_more_load_shortens_the_life(model: LifeModel) -> None:
    """A life is finite and above zero, and twice the load shortens it."""
    for duty in _life_duties():
        doubled = attrs.evolve(duty, radial_load=2.0 * duty.radial_load, load=2.0 * duty.load)
        longer, shorter = (model.rate(loaded).revolutions for loaded in (duty, doubled))
        refuse_unless(
            0.0 < shorter < longer < math.inf,
            f"{longer:.6g} revolutions at {duty.radial_load:.3g} N, {shorter:.6g} at twice the load",
        )


@rule(LifeModel)
def check_fractions_of_the_damage_add_up(model: LifeModel) -> None:
    """Fractions of the damage are those of all slices, and the modified life is finite."""
    for duty in _life_duties():
        life = model.rate(duty)
        factor = modified_factor(life, 1.0, 0.1 * duty.radial_load)
        refuse_unless(0.0 < factor < math.inf, f"the modification factor is {factor!r}")
        if life.damage is None:
            raise Inapplicable("it does not say where damage arises")
        damage = np.asarray(life.damage)
        refuse_unless(
            damage.shape == (2, duty.widths.size)
            and bool(np.all(damage >= 0.0))
            and abs(float(damage.sum()) - 1.0) < _ROUNDING,
            f"damage of shape {damage.shape} adds up to {float(damage.sum()):.6g}, not 1",
        )


@rule(RingModel)
def check_a_preloaded_bearing_rests_in_it_and_presses_less(model: RingModel) -> None:
    """Forces of rollers with the ring as outer and as inner one, tight by 20 um, are below those of rigid rings."""
    scene = evolve(load_scene("1032930-70C"), {"bearing.radial_clearance": -20e-6}, si=True)
    rigid = assemble(scene).load_distribution().inner_force
    for ring, speed in (("outer", False), ("inner", True)):
        shapes = model.shapes(scene.bearing, ring, speed)
        rings = Rings(*((RingShapes(), shapes) if ring == "outer" else (shapes, RingShapes())))
        loads = attrs.evolve(assemble(scene), rings=rings, load_cache={}).load_distribution()
        refuse_unless(
            loads.inner_force.mean() <= rigid.mean() * (1.0 + 1e-9),
            f"a yielding {ring} ring presses more",
        )
