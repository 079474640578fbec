"""The rules of each kind of law, one function each: contact, film, traction, viscosity under pressure, drag, and oils.

- Each rule applies to every known law of its kind, over all magnitudes, and not only to the built-in laws.
- Derivatives are compared with difference quotients, orders and errors with solutions in closed form.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial, wraps
from itertools import pairwise
from typing import Final

import attrs
import numpy as np
from hypothesis import strategies as st

from rollslip.catalogue.registry import available, get_model
from rollslip.errors import DomainError
from rollslip.fields import FieldError
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import Array, PressureViscosity
from rollslip.lubricant.table import unusual_properties
from rollslip.models import (
    ContactModel,
    DragModel,
    FilmModel,
    PocketFriction,
    PressureModel,
    ResistanceModel,
    SliceModel,
    TractionModel,
)
from rollslip.testing.rules import (
    CITATIONS_WANTED,
    DENORMAL,
    Check,
    Inapplicable,
    Nonconformance,
    drawn,
    first_of,
    is_citation,
    on_drawn_slices,
    refuse_unless,
    rule,
    same,
    without_evaluation,
)
from rollslip.testing.samples import (
    BEARING,
    Unsuitable,
    assume,
    changed,
    copy_of,
    evaluate,
    for_all,
    forms_of,
    shown,
    signed,
    table,
)
from rollslip.units import format_quantity
from rollslip_kernels.chain import Chain
from rollslip_kernels.slices import CONDITIONS, Conditions, Slices
from rollslip_kernels.stages import drag as compiled

# Contact and deflection ----------------------------------------------------------------------------------------------


@rule(ContactModel, PressureModel)
@on_drawn_slices
def check_mean_pressure_carries_the_load(filled: Slices, form: str, shaped: SliceModel) -> None:
    """The mean pressure over the width 2 b is the load per length, w = 2 b p."""
    carried = copy_of(filled)
    carried.load[:] = 2 * filled.half_width * filled.pressure
    same(
        carried,
        filled,
        shaped,
        max(1e-12, shaped.tolerance),
        f"{form} form, 2 b p against w",
        ["load"],
    )
    refuse_unless(np.all(filled.half_width > 0), f"{form} form: half_width is not positive")


@rule(ContactModel)
def check_half_width_rises_with_the_load(model: ContactModel) -> None:
    """A heavier contact is wider, and its mean pressure does not fall."""
    drawn(model, _monotonic("load", {"half_width": 1, "pressure": 0}))


@rule(ContactModel)
@without_evaluation
def check_deflection_is_a_stage_of_its_own(model: ContactModel) -> None:
    """The deflection fills load and stiffness from the approach, and is the same stage whenever it is asked for."""
    stage = model.deflection()
    refuse_unless(
        isinstance(stage, SliceModel), f"deflection() must return a SliceModel, not {stage!r}"
    )
    refuse_unless(stage == model.deflection(), "deflection() returns another stage each time")
    refuse_unless(
        stage.writes == {"load", "stiffness"} and "approach" in stage.reads,
        f"deflection() must read the approach and write load and stiffness, it writes {sorted(stage.writes)}",
    )


def _monotonic(of: str, columns: Mapping[str, int]) -> Callable[[Slices, str, SliceModel], None]:
    """Return a property: columns rise (1), do not fall (0) or do not rise (-1) as another is raised."""

    def condition(filled: Slices, form: str, shaped: SliceModel) -> None:
        for factor in (1.01, 2.0, 30.0):
            more = changed(filled, shaped, **{of: getattr(filled, of) * factor})
            if more is None:
                continue
            for name, direction in columns.items():
                before = getattr(filled, name)
                after = getattr(more, name)
                slack = 10 * shaped.tolerance * np.abs(before)
                good = {1: after > before, 0: after >= before - slack, -1: after <= before + slack}[
                    direction
                ]
                if (i := first_of(~good & (getattr(filled, of) > 0))) is not None:
                    wanted = {1: "must rise", 0: "must not fall", -1: "must not rise"}[direction]
                    raise Nonconformance(
                        f"{form} form: {name} {wanted} with {of}, it goes from {before[i]:.17g} to {after[i]:.17g} as "
                        f"{of} is multiplied by {factor:g}; at {shown(shaped, filled, i)}"
                    )

    return condition


def _check_no_load_without_contact(filled: Slices, form: str, shaped: SliceModel) -> None:
    for name in ("load", "stiffness"):
        values = getattr(filled, name)
        good = np.where(filled.approach > 0, values >= 0, values == 0)
        if (i := first_of(~good)) is not None:
            raise Nonconformance(
                f"{form} form: {name} = {values[i]:g} at {shown(shaped, filled, i)}"
            )


@rule("deflection")
def check_separated_surfaces_carry_no_load(model: SliceModel) -> None:
    """No load and no stiffness at an approach of zero or below; both positive or zero above."""
    drawn(model, _check_no_load_without_contact)
    for form, shaped in forms_of(model):
        base = table(shaped, 16)
        for approach in (0.0, -0.0, -1e-9, -1e-3):
            if (separated := changed(base, shaped, approach=approach)) is None:
                raise Nonconformance(
                    f"{form} form refuses an approach of {approach:g}: surfaces may be apart"
                )
            _check_no_load_without_contact(separated, form, shaped)


@rule("deflection")
def check_load_rises_with_the_approach(model: SliceModel) -> None:
    """A contact pressed harder carries more, or the equilibrium has no unique solution."""
    drawn(model, _monotonic("approach", {"load": 1}))


@rule("deflection")
@on_drawn_slices
def check_stiffness_is_the_derivative_of_the_load(
    filled: Slices, form: str, shaped: SliceModel
) -> None:
    """The slope that Newton's method is given is that of the load, by central differences."""
    step = 1e-5  # leaves 1e-10 of the third derivative, and 1e-11 of rounding
    filled = filled.taken(filled.approach > 1e-12)
    assume(len(filled))
    # a law whose stiffness has no bound at the end of its range is not told by differences there
    assume(changed(filled, shaped, approach=filled.approach * 1.03) is not None)
    sides = [
        changed(filled, shaped, approach=filled.approach * factor)
        for factor in (1 - step, 1 + step)
    ]
    if sides[0] is None or sides[1] is None:
        raise Unsuitable
    slope = copy_of(filled)
    slope.stiffness[:] = (sides[1].load - sides[0].load) / (sides[1].approach - sides[0].approach)
    same(
        filled, slope, shaped, 1e-7, f"{form} form, stiffness against dw/d(approach)", ["stiffness"]
    )


# Film ----------------------------------------------------------------------------------------------------------------


@rule(FilmModel)
@on_drawn_slices
def check_film_is_positive(filled: Slices, form: str, shaped: FilmModel) -> None:
    """No film is thinner than nothing, and a traction model divides by it."""
    if shaped.regime in ("VR", "VE"):
        # without pressure viscosity a piezoviscous film vanishes: a right answer outside that regime
        assume(filled.conditions.pressure_viscosity > 0)
    if (i := first_of(~(filled.film_thickness > 0))) is not None:
        thickness = filled.film_thickness[i]
        raise Nonconformance(
            f"{form} form: film_thickness = {thickness:g}; at {shown(shaped, filled, i)}"
        )


@rule(FilmModel)
def check_film_does_not_grow_with_the_load(model: FilmModel) -> None:
    """More load, less film; or the same, where a regime does not know the load."""
    drawn(model, _monotonic("load", {"film_thickness": -1}))


@rule(FilmModel)
def check_film_grows_with_the_rolling_speed(model: FilmModel) -> None:
    """More speed, more film, as long as the inlet stays cold."""
    if model.inlet_heating:
        raise Inapplicable("shear heats its inlet, which thins the film at high speed")

    def condition(filled: Slices, form: str, shaped: SliceModel) -> None:
        assume(np.all(filled.film_thickness > 0))
        _monotonic("rolling_speed", {"film_thickness": 1})(filled, form, shaped)

    drawn(model, condition)


# Pressure in the film ------------------------------------------------------------------------------------------------


@rule(PressureModel)
def check_pressure_does_not_fall_with_the_load(model: PressureModel) -> None:
    """More load, more pressure in the film, or the same."""
    drawn(model, _monotonic("load", {"pressure": 0}))


# Traction ------------------------------------------------------------------------------------------------------------


@rule(TractionModel)
@on_drawn_slices
def check_is_odd_in_slip(filled: Slices, form: str, shaped: SliceModel) -> None:
    """Friction does not know which surface is the faster one: mu(-V) = -mu(V)."""
    mirrored = changed(filled, shaped, sliding_speed=-filled.sliding_speed)
    if mirrored is None:
        raise Nonconformance(
            f"{form} form refuses the opposite slip; at {shown(shaped, filled, 0)}"
        )
    mirrored.friction[:] *= -1
    same(mirrored, filled, shaped, shaped.tolerance, f"{form} form, -mu(-V) against mu(V)")


@rule(TractionModel)
@on_drawn_slices
def check_is_zero_at_zero_slip(filled: Slices, form: str, shaped: SliceModel) -> None:
    """Pure rolling needs no force here; rolling resistance is another term."""
    if (still := changed(filled, shaped, sliding_speed=0.0)) is None:
        raise Nonconformance(f"{form} form refuses pure rolling; at {shown(shaped, filled, 0)}")
    if (i := first_of(still.friction != 0)) is not None:
        raise Nonconformance(
            f"{form} form: mu = {still.friction[i]:g} at V = 0; at {shown(shaped, still, i)}"
        )


@rule(TractionModel)
@on_drawn_slices
def check_takes_power_out_of_sliding(filled: Slices, form: str, shaped: SliceModel) -> None:
    """Friction is along the sliding and never drives it: mu V >= 0."""
    if (i := first_of(np.sign(filled.friction) * np.sign(filled.sliding_speed) < 0)) is not None:
        raise Nonconformance(
            f"{form} form: mu = {filled.friction[i]:g} drives; at {shown(shaped, filled, i)}"
        )


@rule(TractionModel)
def check_friction_coefficient_is_below_unity(model: TractionModel) -> None:
    """In a loaded, lubricated bearing the traction coefficient is some hundredths; above one a unit is wrong."""
    for form, shaped in forms_of(model):
        filled = evaluate(shaped, table(shaped, 4096, BEARING))
        if len(filled):
            i = int(np.argmax(np.abs(filled.friction)))
            refuse_unless(
                abs(filled.friction[i]) <= 1,
                f"{form} form: mu = {filled.friction[i]:g}; at {shown(shaped, filled, i)}",
            )


# Viscosity under pressure ---------------------------------------------------------------------------------------------


@rule(PressureViscosity)
@on_drawn_slices
def check_without_pressure_the_oil_is_as_it_was(
    filled: Slices, form: str, shaped: SliceModel
) -> None:
    """A law says how viscosity rises: at no pressure eta is eta0 and its fall with temperature beta0."""
    if (still := changed(filled, shaped, pressure=0.0)) is None:
        raise Nonconformance(f"{form} form refuses no pressure; at {shown(shaped, filled, 0)}")
    ambient = copy_of(still)
    ambient.film_viscosity[:] = still.conditions.viscosity
    ambient.film_thermoviscosity[:] = still.conditions.thermoviscosity
    same(
        still,
        ambient,
        shaped,
        max(1e-12, shaped.tolerance),
        f"{form} form, at no pressure against the oil's",
    )


@rule(PressureViscosity)
def check_viscosity_does_not_fall_with_pressure(law: PressureViscosity) -> None:
    """An oil that is pressed does not thin."""
    drawn(law, _monotonic("pressure", {"film_viscosity": 0}))


#: Change of temperature in differences of the logarithm of the viscosity [K]. Half and twice the value find the same
#: faults; chosen, because what it leaves of the third derivative, and of the rounding, is far below the tolerance.
_WARMING: Final = 0.01
#: Pressures at which the fall of the viscosity with temperature is compared [Pa]: up to those of heavy contacts.
_PRESSURES: Final = (0.0, 0.2e9, 0.5e9, 1.0e9)


def _conditions_of_oils() -> Iterator[Conditions]:
    """Yield those of the built-in oils that give an alpha and its fall, at both ends and the middle of their ranges."""
    for name, offer in available("lubricant").items():
        if offer.package != "rollslip":
            continue
        oil = get_model("lubricant", name)
        for T in np.linspace(oil.minimum_temperature, oil.maximum_temperature, 3).tolist():
            state = attrs.asdict(oil.at(T))
            values = {name: state[name] for name in CONDITIONS if name in state}
            yield Conditions(**{**values, "temperature": T})


def _log_viscosity(law: PressureViscosity, conditions: Conditions, pressures: Array) -> Array:
    return np.log(law.at(conditions, pressures)[0])


@rule(PressureViscosity)
def check_fall_with_temperature_is_the_derivative_of_the_viscosity(law: PressureViscosity) -> None:
    """-dln(eta)/dT of the built-in oils, by differences: eta0 changes by beta0 and alpha by gamma with temperature."""
    for c in _conditions_of_oils():
        for pressure in _PRESSURES:
            ends = []
            try:
                found = float(law.at(c, np.array([pressure]))[1][0])
                for kelvin in (-_WARMING, _WARMING):
                    warmed = attrs.evolve(
                        c,
                        temperature=c.temperature + kelvin,
                        viscosity=c.viscosity * math.exp(-c.thermoviscosity * kelvin),
                        pressure_viscosity=c.pressure_viscosity
                        - c.pressure_thermoviscosity * kelvin,
                    )
                    ends.append(float(_log_viscosity(law, warmed, np.array([pressure]))[0]))
            except DomainError:
                continue
            expected = (ends[0] - ends[1]) / (2.0 * _WARMING)
            refuse_unless(
                abs(found - expected) <= 1e-4 * abs(expected) + 1e-8,
                f"film_thermoviscosity is {found:.6g} 1/K, by differences of ln(eta) over the temperature "
                f"{expected:.6g} 1/K, at {format_quantity(pressure, 'Pa')}, {format_quantity(c.temperature, 'K')}, "
                f"eta0 = {c.viscosity:.6g} Pa s and alpha = {c.pressure_viscosity:.6g} 1/Pa",
            )


@rule(PressureViscosity)
def check_slope_without_pressure_is_alpha(law: PressureViscosity) -> None:
    """dln(eta)/dp at no pressure is the alpha of the oil, or ``coefficient`` of a law that determines it."""
    law = law.of_oil()
    refuse_unless(
        "pressure_viscosity" in law.reads or not math.isnan(law.coefficient(300.0)),
        "it does not read pressure_viscosity, and coefficient() is nan: return the slope of ln(eta) at no pressure",
    )
    for c in _conditions_of_oils():
        alpha = law.coefficient(c.temperature)
        if math.isnan(alpha):
            alpha = c.pressure_viscosity
        small = 1e-4 / alpha
        try:
            none, once, twice = _log_viscosity(law, c, np.array([0.0, small, 2.0 * small]))
        except DomainError:
            continue
        slope = (2.0 * (once - none) - 0.5 * (twice - none)) / small
        refuse_unless(
            abs(slope - alpha) <= 1e-5 * alpha,
            f"dln(eta)/dp at no pressure is {slope:.6g} 1/Pa, by differences, for an alpha of {alpha:.6g} 1/Pa, at "
            f"{format_quantity(c.temperature, 'K')} and eta0 = {c.viscosity:.6g} Pa s",
        )


@rule(PressureViscosity)
@on_drawn_slices
def check_values_at_pressures_are_those_of_the_stage(
    filled: Slices, form: str, shaped: PressureViscosity
) -> None:
    """``at``, which traction models ask for pressures within a contact, gives what the stage gives for a slice."""
    requested = copy_of(filled)
    values = shaped.at(filled.conditions, filled.pressure.reshape(1, -1))
    refuse_unless(
        all(np.shape(column) == (1, len(filled)) for column in values),
        "at() loses the shape of its pressures",
    )
    requested.film_viscosity[:] = np.ravel(values[0])
    requested.film_thermoviscosity[:] = np.ravel(values[1])
    same(
        requested,
        filled,
        shaped,
        max(1e-9, shaped.tolerance),
        f"{form} form, at() against it",
        ["film_viscosity"],
    )


@rule(PressureViscosity)
@on_drawn_slices
def check_log_kernel_gives_the_logarithm(
    filled: Slices, form: str, shaped: PressureViscosity
) -> None:
    """``log_kernel``, which laws at several pressures of a contact call, gives ln(eta) in place of eta."""
    if (capsule := shaped.log_kernel()) is None:
        raise Inapplicable("it has no log_kernel")
    found = copy_of(filled)
    Chain([(capsule, {}, shaped.writes)]).run(found)
    found.film_viscosity[:] = np.exp(found.film_viscosity)
    tolerance = max(1e-9, shaped.tolerance)
    same(found, filled, shaped, tolerance, f"exp of log_kernel() against the {form} form")


@rule(PressureViscosity)
def check_uses_the_pressure_factor_of_an_oil(law: PressureViscosity) -> None:
    """A law that takes a factor of the oil multiplies ln(eta/eta0) by it, and one that takes none refuses one."""
    plain = law.of_oil()
    try:
        raised = law.of_oil(factor=1.5)
    except FieldError:
        return

    def condition(filled: Slices, form: str, shaped: SliceModel) -> None:
        with np.errstate(all="ignore"):
            rise, more = (
                np.log(own.at(filled.conditions, filled.pressure)[0] / filled.conditions.viscosity)
                for own in (plain, raised)
            )
        assume(np.all(rise < 400.0))
        refuse_unless(
            np.allclose(more, 1.5 * rise, rtol=1e-9, atol=1e-12),
            f"ln(eta/eta0) is {rise[0]:g}, with a factor of 1.5 {more[0]:g}; at {shown(shaped, filled, 0)}",
        )

    drawn(law, condition)


# Drag ----------------------------------------------------------------------------------------------------------------

_SPEEDS = st.tuples(*[st.just(0.0) | signed(st.floats(1e-3, 3e3))] * 3)
_TIMES = st.tuples(st.floats(0.0, 100.0))


def _given(model: DragModel) -> st.SearchStrategy[tuple[float, ...]]:
    """Speeds of cage, inner and outer ring [rad/s], and a time [s] where the torque varies in it."""
    return st.builds(tuple.__add__, _SPEEDS, _TIMES) if model.varies_in_time else _SPEEDS


def _on_drawn_speeds(condition: Callable[[DragModel, tuple[float, ...]], None]) -> Check:
    """Return the check that a property holds for drawn speeds; under the same name."""

    @wraps(condition)
    def check(model: DragModel) -> None:
        for_all(_given(model), partial(condition, model))

    return check


def _torque(model: DragModel, speeds: tuple[float, ...]) -> float:
    torque = model.torque(*speeds)
    refuse_unless(
        isinstance(torque, float) and math.isfinite(torque),
        f"the torque is {torque!r} at cage, inner and outer speed {speeds} rad/s; it must be a finite float",
    )
    return torque


@rule(DragModel)
@_on_drawn_speeds
def check_torque_is_finite_and_the_same_again(model: DragModel, speeds: tuple[float, ...]) -> None:
    """Any speeds of either sign, zero included, give one finite torque."""
    first = _torque(model, speeds)
    _torque(model, (*speeds[2::-1], *speeds[3:]))
    refuse_unless(
        _torque(model, speeds) == first,
        f"the torque at {speeds} rad/s is another at the second time",
    )


@rule(DragModel)
@_on_drawn_speeds
def check_torque_changes_sign_with_all_speeds(model: DragModel, speeds: tuple[float, ...]) -> None:
    """A bearing seen from its other side is the same bearing."""
    torque = _torque(model, speeds)
    mirrored = _torque(model, (*(-speed for speed in speeds[:3]), *speeds[3:]))
    refuse_unless(
        abs(torque + mirrored) <= 1e-12 * abs(torque),
        f"the torque is {torque:g} at {speeds} rad/s, mirrored {mirrored:g}",
    )


@rule(DragModel)
@_on_drawn_speeds
def check_torque_takes_power_out_of_a_cage_between_still_rings(
    model: DragModel, speeds: tuple[float, ...]
) -> None:
    """With both rings at rest nothing drives the cage; and nothing acts on a cage at rest there."""
    torque = _torque(model, (speeds[0], 0.0, 0.0, *speeds[3:]))
    refuse_unless(
        torque * speeds[0] <= 0,
        f"the torque {torque:g} N m drives a cage at {speeds[0]:g} rad/s",
    )
    refuse_unless(
        speeds[0] != 0 or torque == 0, f"the torque is {torque:g} N m where all is at rest"
    )


@rule(DragModel)
def check_compiled_torque_equals_python(model: DragModel) -> None:
    """Two forms of one law: ``kernel()`` is None or a capsule ``rs_drag`` of ``rollslip.h`` with the same numbers."""
    if (capsule := model.kernel()) is None:
        raise Inapplicable("it has no kernel")
    if problem := compiled.problem(capsule):
        raise Nonconformance(f"its kernel() {problem}")

    def condition(speeds: tuple[float, ...]) -> None:
        found = compiled.torque(capsule, *speeds)
        expected = _torque(model, speeds)
        refuse_unless(
            abs(found - expected) <= model.tolerance * abs(expected) + DENORMAL,
            f"the compiled torque is {found:.17g} at {speeds} rad/s, that of Python {expected:.17g}",
        )

    for_all(_given(model), condition)


@rule(ResistanceModel)
@on_drawn_slices
def check_resistance_takes_power_out_of_rolling(
    filled: Slices, form: str, shaped: SliceModel
) -> None:
    """A surface that rolls is resisted, never driven."""
    if (i := first_of(filled.resistance < 0)) is not None:
        resistance = filled.resistance[i]
        raise Nonconformance(
            f"{form} form: the resistance is {resistance:g} N/m; at {shown(shaped, filled, i)}"
        )


@rule(ResistanceModel)
@on_drawn_slices
def check_resistance_does_not_fall_with_load_and_speed(
    filled: Slices, form: str, shaped: SliceModel
) -> None:
    """A contact that is loaded more, or rolls faster, resists at least as much."""
    for of in ("load", "rolling_speed"):
        _monotonic(of, {"resistance": 0})(filled, form, shaped)


@rule(PocketFriction)
def check_pocket_coefficient_is_a_fraction(model: PocketFriction) -> None:
    """Friction that a pocket has is a part of the force there; above one a unit is wrong."""
    refuse_unless(
        isinstance(model.coefficient, float) and 0.0 <= model.coefficient <= 1.0,
        f"its coefficient is {model.coefficient!r}; it must be a float from 0 to 1",
    )


# Lubricants ----------------------------------------------------------------------------------------------------------


def _temperatures(oil: Lubricant) -> "st.SearchStrategy[float]":
    low = oil.minimum_temperature
    high = oil.maximum_temperature
    return st.sampled_from([low, high]) | st.floats(low, high)


@rule(Lubricant)
def check_oil_has_description_and_references(oil: Lubricant) -> None:
    """Every oil has a name, a description, a source and references."""
    refuse_unless(
        re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", oil.name),
        f"its name is {oil.name!r}; use small letters, digits and hyphens, as in 'sae-30'",
    )
    refuse_unless(
        len(oil.description.split()) >= 3, f"its description is {oil.description!r}; say what it is"
    )
    refuse_unless(
        len(oil.source.split()) >= 3, f"its source is {oil.source!r}; say where its data come from"
    )
    refuse_unless(
        isinstance(oil.references, tuple)
        and oil.references
        and all(map(is_citation, oil.references)),
        f"its references are {oil.references!r}; {CITATIONS_WANTED}",
    )


@rule(Lubricant)
def check_viscosity_falls_with_temperature(oil: Lubricant) -> None:
    """Every liquid's does, and the film heating rests on it; every property it has is positive and finite."""
    states = [
        oil.at(float(T)) for T in np.linspace(oil.minimum_temperature, oil.maximum_temperature, 201)
    ]
    for before, after in pairwise(states):
        refuse_unless(
            after.viscosity < before.viscosity,
            f"the viscosity goes from {before.viscosity:.6g} to {after.viscosity:.6g} Pa s as the temperature rises "
            f"from {before.temperature:.6g} to {after.temperature:.6g} K",
        )
    for state in states:
        for name, value in attrs.asdict(state).items():
            low = {"pressure_thermoviscosity": -math.inf, "thermoviscosity": 0.0}.get(name, 5e-324)
            refuse_unless(
                math.isnan(value) or low <= value < math.inf,
                f"{name} = {value:g} at {state.temperature:g} K",
            )


@rule(Lubricant)
def check_properties_are_usual(oil: Lubricant) -> None:
    """They are in the ranges that a scene takes for usual, in SI units: a wrong unit is a factor of 1000 off."""
    found = unusual_properties(oil)
    refuse_unless(not found, "; ".join(f"{key} {text}" for key, text in found.items()))


@rule(Lubricant)
def check_constants_are_parameters_of_laws(oil: Lubricant) -> None:
    """Constants in a table of a law are its parameters, others those of some law of a contact; laws accept them."""
    from rollslip.scene.oil import faulty_constants

    found = faulty_constants(oil)
    refuse_unless(not found, f"its constants: {'; '.join(found)}")


@rule(Lubricant)
def check_slopes_are_those_of_its_laws(oil: Lubricant) -> None:
    """beta0 = -dln(eta0)/dT and gamma = -dalpha/dT, by differences; at the corner of a table either side will do."""
    low = oil.minimum_temperature
    high = oil.maximum_temperature
    step = 1e-4 * (high - low) / 100

    def slopes(T: float, value: Callable[[float], float]) -> list[float]:
        below = max(T - step, low)
        above = min(T + step, high)
        ends = [(below, above), (below, T), (T, above)]
        return [-(value(b) - value(a)) / (b - a) for a, b in ends if b > a]

    laws: dict[str, Callable[[float], float]] = {
        "thermoviscosity": lambda T: math.log(oil.at(T).viscosity),
        "pressure_thermoviscosity": lambda T: (
            oil.at(T).pressure_viscosity * oil.pressure_thermoviscosity_factor
        ),
    }

    def condition(T: float) -> None:
        state = oil.at(T)
        for name, of in laws.items():
            found = getattr(state, name)
            expected = slopes(T, of)
            scale = abs(of(T)) / T
            refuse_unless(
                math.isnan(found)
                or any(abs(found - e) <= 1e-4 * abs(e) + 1e-6 * scale for e in expected),
                f"{name} = {found:.9g} at {T:g} K, by differences {expected[0]:.9g}",
            )

    for_all(_temperatures(oil), condition)


@rule(Lubricant)
def check_refuses_temperatures_outside_its_range(oil: Lubricant) -> None:
    """Beyond the range there is an error that names the oil, no number."""
    low = oil.minimum_temperature
    high = oil.maximum_temperature
    refuse_unless(
        200.0 < low < high < 800.0,
        f"its range is {low:g} to {high:g} K; give the range of its data",
    )
    oil.at(low)
    oil.at(high)
    for T in (
        math.nan,
        math.inf,
        -math.inf,
        math.nextafter(low, 0.0),
        math.nextafter(high, math.inf),
    ):
        try:
            oil.at(T)
        except DomainError as error:
            refuse_unless(
                oil.name in str(error), f"the error at {T!r} K does not name the oil: {error}"
            )
        else:
            raise Nonconformance(f"{T!r} K is taken: there is no error")
