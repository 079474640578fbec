"""The rules on the numbers of a law: plausible sizes, no jumps, double precision, and the shape of friction over slip.

- Units and signs may be right and a constant a million times too large. Therefore films, widths and stiffnesses are
  compared with radius and modulus, at the loads and speeds of bearings.
- Jumps are located by bisection, and lost digits by steps relative to a value. Both stop Newton's method and the search
  for a maximum, and a comparison of the two forms of a law does not show them.
- A slow law has right numbers: it gets a warning and not a failure. Operations are counted, because their number does
  not depend on the load of the computer.
- A law declares the shape of its friction in ``shapes``; the same rule checks the built-in laws.
"""

import math
import time
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import DomainError
from rollslip.models import (
    ContactModel,
    DragModel,
    FilmModel,
    PressureModel,
    ResistanceModel,
    SliceModel,
    TractionModel,
)
from rollslip.references import ReferenceValue
from rollslip.search import Array
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import Duty, TorqueFormula
from rollslip.testing.rules import (
    Inapplicable,
    Nonconformance,
    Questionable,
    first_of,
    refuse_unless,
    rule,
    without_evaluation,
)
from rollslip.testing.samples import (
    BEARING,
    MAGNITUDES,
    SCENE,
    changed,
    copy_of,
    evaluate,
    forms_of,
    shown,
    table,
)
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

#: Column -> member with which it is compared, smallest and largest plausible ratio. Bearings have about 1e-5 to 1e-3 of
#: film, 1e-3 to 1e-1 of width, 0.1 to 1 of stiffness (20 with elastic foundations), 1e-5 to 1e-2 of resistance, or 0.
SIZES: Final[Mapping[str, tuple[str, float, float]]] = {
    "film_thickness": ("radius", 1e-9, 1e-2),
    "half_width": ("radius", 1e-6, 0.5),
    "stiffness": ("modulus", 1e-4, 100.0),
    "resistance": ("load", 0.0, 0.1),
}
#: Change of friction between two adjacent slips, over its maximum [1], above which it is a jump. Doubling it finds the
#: same jumps: a continuous law changes by rounding errors. Chosen.
JUMP: Final = 1e-6
#: Number of bisections of an interval of slips: 53 binary digits of a float, and some for an interval from zero.
HALVINGS: Final = 60
#: Number of operations on columns per evaluation above which a law without a compiled form is reported as slow.
#: Doubling it hides slow laws. Built-in laws without a compiled form need less than half of it, which a test checks.
OPERATIONS: Final = 100
#: Time of one evaluation of 256 slices above which a law without a compiled form is reported as slow [s]. Half of it
#: would report laws on a busy computer; built-in laws without a compiled form need a tenth.
SLOW: Final = 2e-3
#: Number of evaluations that are timed. Half as many are disturbed more often by other work; chosen.
_TIMED: Final = 5
#: Smallest coefficient of friction that loaded contacts must reach at some slip and pressure [1]: measured ones are 100
#: times as large. Doubling it finds the same faults.
MIN_FRICTION: Final = 1e-4
#: Largest relative tolerance of a reference value [1]. Doubling it accepts numbers that do not exclude a factor of two.
MAX_RTOL: Final = 0.25
#: Relative step of values that counts as rounding [1]. Doubling it hides very flat maxima. Chosen.
ROUNDING: Final = 1e-12


@rule(ContactModel, FilmModel, PressureModel, ResistanceModel, "deflection")
def check_results_are_of_the_size_that_bearings_have(model: SliceModel) -> None:
    """A film in microns is no unit that is wrong, but a film of decimetres; it is held against the radius."""
    for form, shaped in forms_of(model):
        filled = evaluate(shaped, table(shaped, 256, BEARING))
        for name in sorted(model.writes & SIZES.keys()):
            member, lower, upper = SIZES[name]
            scale = getattr(filled.conditions if member in CONDITIONS else filled, member)
            if member not in model.reads:  # any usual value will do
                scale = MAGNITUDES[member][1]
            ratio = getattr(filled, name) / scale
            bad = ~((ratio >= lower) & (ratio <= upper))
            if name == "stiffness":
                bad &= filled.load > 0  # surfaces without contact have none
            if (i := first_of(bad)) is not None:
                raise Nonconformance(
                    f"{form} form: {name} = {getattr(filled, name)[i]:.4g}, which is {ratio[i]:.2g} times the "
                    f"{member}; loaded bearings give {lower:g} to {upper:g}, so a unit or a constant is another; "
                    f"at {shown(shaped, filled, i)}"
                )


@rule(DragModel)
def check_torque_is_less_than_rollers_can_exert(model: DragModel) -> None:
    """Rollers drive a cage by friction, so that no drag exceeds the load times the radius of their orbit."""
    largest = float(SCENE["radial_load"]) * float(SCENE["orbit_radius"])
    for cage_speed in (40.0, -40.0, 300.0):
        torque = model.torque(cage_speed, 2.25 * cage_speed, 0.0)
        refuse_unless(
            abs(torque) <= largest,
            f"{torque:.4g} N m act on a cage of 180 mm pitch diameter at {cage_speed:g} rad/s; rollers under "
            f"{SCENE['radial_load']:g} N exert {largest:.4g} N m at a coefficient of friction of 1",
        )


@rule(TractionModel)
def check_friction_does_not_jump_in_slip(model: TractionModel) -> None:
    """Between two adjacent floats of the sliding speed friction is the same; a ramp as steep as you like is none."""
    base = table(model, 16, BEARING)
    low, high = model.domain.get("sliding_speed", (0.0, 1e2))
    grid = np.clip([0.0, *np.logspace(-6, 2, 81)], low, high)
    if not len(base) or "sliding_speed" not in model.reads:
        raise Inapplicable("there is no slip to change")
    at = base.taken(np.repeat(np.arange(len(base)), grid.size - 1))
    ends = [np.tile(grid[:-1], len(base)), np.tile(grid[1:], len(base))]
    friction = [_friction(at, model, speed) for speed in ends]
    largest = np.abs(friction[1]).reshape(len(base), -1).max(axis=1).repeat(grid.size - 1)
    for _ in range(HALVINGS):
        middle = 0.5 * (ends[0] + ends[1])
        there = _friction(at, model, middle)
        left = np.abs(there - friction[0]) > np.abs(friction[1] - there)
        ends = [np.where(left, ends[0], middle), np.where(left, middle, ends[1])]
        friction = [np.where(left, friction[0], there), np.where(left, there, friction[1])]
    jump = np.abs(friction[1] - friction[0])
    i = int(np.argmax(jump - JUMP * largest))
    refuse_unless(
        jump[i] <= JUMP * largest[i],
        f"mu jumps from {friction[0][i]:.6g} to {friction[1][i]:.6g} between the adjacent sliding speeds "
        f"{ends[0][i]:.17g} and {ends[1][i]:.17g} m/s; at {shown(model, at, i)}",
    )


@rule(TractionModel)
def check_friction_at_high_stress_is_measurable(model: TractionModel) -> None:
    """Loaded contacts that slide have coefficients of some hundredths; below 1e-4 a unit or a constant is wrong."""
    for form, shaped in forms_of(model):
        filled = evaluate(shaped, table(shaped, 4096, BEARING))
        largest = float(np.abs(filled.friction).max(initial=0.0))
        refuse_unless(
            not len(filled) or largest >= MIN_FRICTION,
            f"{form} form: mu is {largest:.2g} at most, over all slips and pressures of loaded bearings",
        )


def _compared(model: Any, reference: ReferenceValue) -> Iterator[tuple[str, float]]:
    """Yield the number that a reference value states, by each form of a model with default or stated parameters."""
    defaults = {a.name: a.default for a in attrs.fields(type(model)) if type(a.default) is float}
    model = attrs.evolve(model, **defaults | dict(reference.parameters))
    if isinstance(model, DragModel):
        yield "its", model.torque(**reference.inputs)
    elif isinstance(model, TorqueFormula):
        yield "its", sum(model.terms(Duty(**reference.inputs)).values())
    elif isinstance(model, LossModel):
        yield "its", model.power(Duty(**reference.inputs))
    else:
        conditions = {
            name: reference.inputs[name] for name in CONDITIONS if name in reference.inputs
        }
        columns = {name: reference.inputs[name] for name in COLUMNS if name in reference.inputs}
        refuse_unless(
            {*conditions, *columns} == {*reference.inputs} and {*reference.inputs} >= model.reads,
            f"a reference value gives {', '.join(sorted(reference.inputs))}; the law reads "
            f"{', '.join(sorted(model.reads))}",
        )
        column = reference.column or (min(model.writes) if len(model.writes) == 1 else "")
        refuse_unless(
            column in model.writes,
            f"a reference value has the column {column!r}; the law fills {', '.join(sorted(model.writes))}",
        )
        for form, shaped in forms_of(model):
            filled = evaluate(shaped, Slices(1, Conditions(**conditions), **columns))
            yield f"{form} form: {column}", float(getattr(filled, column)[0])


@rule(SliceModel, DragModel, TorqueFormula, LossModel)
def check_reproduces_its_reference_values(model: Any) -> None:
    """``reference_values`` are numbers of others: of a table, a figure, another program, or worked out by hand.

    Nobody has to state one.
    """
    for reference in model.reference_values:
        refuse_unless(
            isinstance(reference, ReferenceValue)
            and 0.0 < reference.rtol <= MAX_RTOL
            and len(reference.source.split()) >= 3,
            f"{reference!r} needs a relative tolerance up to {MAX_RTOL:g} and a source in words",
        )
        for form, found in _compared(model, reference):
            refuse_unless(
                abs(found - reference.value) <= reference.rtol * abs(reference.value),
                f"{form} is {found:.6g}, and {reference.value:.6g} by {reference.source} ({reference.rtol:g} allowed)",
            )


def _friction(slices: Slices, model: SliceModel, speed: Array, **others: float) -> Array:
    if (filled := changed(slices, model, sliding_speed=speed, **others)) is None:
        raise Inapplicable("it refuses some slips of loaded bearings")
    return np.asarray(filled.friction)


@rule(SliceModel)
def check_computes_in_double_precision(model: SliceModel) -> None:
    """A change of an input by 1e-8 shows: single precision, and an iteration that ends early, go in coarser steps."""
    step = max(1e-8, 10.0 * model.tolerance)
    for form, shaped in forms_of(model):
        slices = table(shaped, 64, BEARING)
        for member in sorted(model.reads - {"regime"}):
            try:
                unchanged, small, large = (
                    _scaled(slices, shaped, member, 1.0 + by) for by in (0.0, step, 1e4 * step)
                )
            except DomainError:
                continue  # at the end of its range
            for name in sorted(model.writes - {"regime"}):
                value = getattr(unchanged, name)
                found = getattr(small, name) - value
                expected = 1e-4 * (getattr(large, name) - value)
                significant = np.abs(expected) > 0.01 * step * np.abs(value)
                lost = significant & (np.abs(found - expected) > 0.2 * np.abs(expected))
                if np.sum(significant) >= 8 and 2 * np.sum(lost) > np.sum(significant):
                    i = int(np.argmax(lost))
                    raise Nonconformance(
                        f"{form} form: {name} goes in steps: as {member} rises by {step:g} of itself it changes by "
                        f"{found[i] / value[i]:.2g} of itself, and should by {expected[i] / value[i]:.2g}; compute in "
                        f"double precision, and end iterations there; at {shown(shaped, slices, i)}"
                    )


def _scaled(slices: Slices, model: SliceModel, member: str, factor: float) -> Slices:
    other = copy_of(slices)
    if member in CONDITIONS:
        other = copy_of(slices, **{member: factor * getattr(slices.conditions, member)})
    else:
        getattr(other, member)[:] *= factor
    return evaluate(model, other)


class _Counted(np.ndarray[Any, Any]):
    """An array that counts the operations on it and on arrays derived from it: ufuncs, and items read or set."""

    count: ClassVar[int] = 0

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        _Counted.count += 1
        plain = [x.view(np.ndarray) if isinstance(x, _Counted) else x for x in inputs]
        if out := options.get("out"):
            options["out"] = tuple(
                x.view(np.ndarray) if isinstance(x, _Counted) else x for x in out
            )
        result = getattr(ufunc, method)(*plain, **options)
        return result.view(_Counted) if type(result) is np.ndarray else result

    def __getitem__(self, key: Any) -> Any:
        _Counted.count += 1
        return super().__getitem__(key)

    def __setitem__(self, key: Any, value: Any) -> None:
        _Counted.count += 1
        super().__setitem__(key, value)


def operations(model: SliceModel, slices: Slices) -> int:
    """Return the number of operations on columns of one evaluation in NumPy.

    The columns count them, because tracing in Python 3.11 has a fault by which it does not end.
    """
    given = copy_of(slices)
    columns = {name: getattr(given, name).view(_Counted) for name in COLUMNS}
    _Counted.count = 0
    try:
        with np.errstate(all="ignore"):
            model.evaluate(Slices.of_columns(given.conditions, columns))
    except Exception as error:  # of a compiler that takes plain arrays alone
        raise Inapplicable(
            f"operations on its columns cannot be counted ({type(error).__name__})"
        ) from error
    return _Counted.count


def _shortest_time(model: SliceModel, slices: Slices) -> float:
    """Return the shortest time of some evaluations [s], or the first that is not slow; other work may lengthen one."""
    shortest = math.inf
    for _ in range(_TIMED):
        start = time.perf_counter()
        with np.errstate(all="ignore"):
            model.evaluate(slices)
        shortest = min(shortest, time.perf_counter() - start)
        if shortest <= SLOW:
            break
    return shortest


@rule(SliceModel)
def check_python_runs_once_for_all_slices(model: SliceModel) -> None:
    """A law without a compiled form is slow by what Python does in it, slice by slice or time and again."""
    if model.kernel() is not None:
        return  # which is what runs
    slices = table(model, 256)
    quarter = slices.taken(slice(0, max(len(slices) // 4, 1)))
    if len(slices) < 8:
        raise Inapplicable("there are too few slices that it takes")
    seconds = _shortest_time(model, slices)
    if seconds > SLOW:
        raise Questionable(
            f"evaluate() takes {1e3 * seconds:.2g} ms for {len(slices)} slices, the fastest of {_TIMED}; more than "
            f"{1e3 * SLOW:g} ms make a run last minutes; move what does not depend on the slices to its parameters, or "
            "compile it"
        )
    count = operations(model, slices)
    count_of_quarter = operations(model, quarter)
    advice = (
        "they grow with the slices: put arrays in place of the loop"
        if count > 2 * count_of_quarter
        else "evaluate it less often"
    )
    if count > OPERATIONS:
        raise Questionable(
            f"evaluate() takes {count:,} operations on columns for {len(slices)} slices and {count_of_quarter:,} for "
            f"{len(quarter)}; built-in laws without a compiled form take less than {OPERATIONS} for any number; "
            f"{advice}, or compile "
            "it, as a package does that rollslip plugins new NAME --kind traction --compiled writes"
        )


# Shapes over slip ----------------------------------------------------------------------------------------------------

#: Shape -> signs of the steps of friction over slip, without repetition.
SHAPES: Final[Mapping[str, tuple[list[float], ...]]] = {
    "rises": ([1.0],),
    "one maximum": ([1.0, -1.0],),
    "at most one maximum": ([], [1.0], [1.0, -1.0]),
    "any": (),
}
#: Shape of a law that declares none.
USUAL_SHAPE: Final = "at most one maximum"


def turns(values: Array) -> list[float]:
    """Return the signs of the steps of values, -1 and 1, without repetition; rounding errors are not steps."""
    size = np.abs(values[1:])
    steps = np.diff(values)
    signs = np.sign(steps[np.abs(steps) > ROUNDING * size])
    return [float(sign) for sign in signs[np.flatnonzero(np.diff(signs, prepend=0.0))]]


@rule(TractionModel)
@without_evaluation
def check_shapes_are_known(model: TractionModel) -> None:
    """``shapes`` says of "cold" and "heated" what friction does over slip, and of "bound" what it stays below."""
    known = f"'cold' and 'heated' may be {', '.join(map(repr, SHAPES))}; 'bound' names a parameter or a method"
    for of, shape in model.shapes.items():
        good = (
            shape in SHAPES if of in ("cold", "heated") else of == "bound" and hasattr(model, shape)
        )
        refuse_unless(good, f"its shapes say {of!r}: {shape!r}; {known} of the law")


@rule(TractionModel)
def check_friction_has_its_declared_shapes(model: TractionModel) -> None:
    """Over slips from none to all, cold and heated, and below its bound; at most one maximum if it declares none."""
    if "sliding_speed" not in model.reads:
        raise Inapplicable("there is no slip to change")
    cold = {
        name: 0.0 for name in ("thermoviscosity", "pressure_thermoviscosity") if name in model.reads
    }
    heats = "film_thermoviscosity" in model.reads
    low, high = model.domain["sliding_speed"]
    speed = np.clip(np.logspace(-9, 6, 301), low, high)
    for form, shaped in forms_of(model):
        base = table(shaped, 16, BEARING)
        for of, slope in (("cold", 0.0), ("heated", MAGNITUDES["film_thermoviscosity"][1])):
            others = {"film_thermoviscosity": slope} if heats else {}
            shape = model.shapes.get(of, USUAL_SHAPE)
            wanted = SHAPES[shape]
            for i in range(len(base)) if wanted else ():
                at = base.taken(np.full(speed.size, i))
                given = copy_of(at, **cold) if of == "cold" else at
                mu = _friction(given, shaped, speed, **others)
                refuse_unless(
                    turns(mu) in wanted,
                    f"{form} form: {of} friction over slip is to have the shape {shape!r}, its steps have the "
                    f"signs {turns(mu)}, the largest {mu.max():.4g} at {speed[np.argmax(mu)]:.3g} m/s; "
                    f"at {shown(model, at, 0)}",
                )
        if "bound" in model.shapes and len(base):
            at = base.taken(np.repeat(np.arange(len(base)), speed.size))
            filled = changed(at, shaped, sliding_speed=np.tile(speed, len(base)))
            bound = getattr(model, model.shapes["bound"])
            over = (
                np.zeros(1)
                if filled is None
                else filled.friction - (bound(filled) if callable(bound) else bound)
            )
            i = int(np.argmax(over))
            refuse_unless(
                over[i] <= 1e-9,
                f"{form} form: mu is {over[i]:.3g} above {model.shapes['bound']}; at {shown(model, filled or at, i)}",
            )
