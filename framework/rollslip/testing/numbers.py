"""The rules on what numbers of a law are like: of the size of bearings, without jumps, in double precision, its shape.

- Units and signs may be right and a constant a million times too large: so films, widths and stiffnesses are held
  against radius and modulus, at what loaded bearings give.
- Jumps and lost digits are looked for where they are, by halving and by steps relative to a value; they stop Newton's
  method and the search for a maximum, and no comparison of the two forms of a law shows them.
- What costs time makes no number wrong: it is told, and no failure. Instructions are counted, which a busy computer
  does not change.
- Shapes are asked for by the law itself, ``shapes``: the laws in the box are held to theirs by the same rule.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, Final

import numpy as np

from rollslip.errors import DomainError
from rollslip.models import (
    ContactModel,
    FilmModel,
    PressureModel,
    ResistanceModel,
    SliceModel,
    TractionModel,
)
from rollslip.testing.rules import (
    Inapplicable,
    Nonconformance,
    Questionable,
    changed,
    first_of,
    refuse_unless,
    rule,
    without_evaluation,
)
from rollslip.testing.samples import (
    BEARING,
    MAGNITUDES,
    copy_of,
    evaluate,
    forms_of,
    picked,
    shown,
    table,
)
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Slices

Array = np.ndarray[Any, np.dtype[np.float64]]

#: Column -> member that it is held against, and the least and largest ratio; bearings give some 1e-5 to 1e-3 of film,
#: 1e-3 to 1e-1 of width, 0.1 to 1 of stiffness, elastic foundations 20, 1e-5 to 1e-2 of resistance, which may be none.
SIZES: Final[Mapping[str, tuple[str, float, float]]] = {
    "film_thickness": ("radius", 1e-9, 1e-2),
    "half_width": ("radius", 1e-6, 0.5),
    "stiffness": ("modulus", 1e-4, 100.0),
    "resistance": ("load", 0.0, 0.1),
}
#: Part of the largest friction that it may go up or down by between two adjacent slips.
JUMP: Final = 1e-6
#: Each halves an interval; 60 are the digits of a float and what zero is apart from what is no slip any more.
HALVINGS: Final = 60
#: Operations on columns for one evaluation beyond which a law without a compiled form is told to be slow: the laws in
#: the box that have none need less than half of it for any number of slices, a test holds that.
OPERATIONS: Final = 100
#: Relative step below which two values are rounding.
ROUNDING: Final = 1e-12


@rule(ContactModel, FilmModel, PressureModel, ResistanceModel, "deflection")
def check_results_are_of_the_size_that_bearings_have(model: SliceModel) -> None:
    """A film in microns is no unit that is wrong, but a film of decimetres; it is held against the radius."""
    for form, shaped in forms_of(model):
        filled = evaluate(shaped, table(shaped, 256, BEARING))
        for name in sorted(model.writes & SIZES.keys()) if len(filled) else ():
            of, least, most = SIZES[name]
            scale = getattr(filled.conditions if of in CONDITIONS else filled, of)
            if of not in model.reads:  # any usual one will do
                scale = MAGNITUDES[of][1]
            ratio = getattr(filled, name) / scale
            bad = ~((ratio >= least) & (ratio <= most))
            if name == "stiffness":
                bad &= filled.load > 0  # surfaces apart have none
            if (i := first_of(bad)) is not None:
                raise Nonconformance(
                    f"{form} form: {name} = {getattr(filled, name)[i]:.4g}, which is {ratio[i]:.2g} times the {of}; "
                    f"loaded bearings give {least:g} to {most:g}, so a unit or a constant is another; "
                    f"at {shown(shaped, filled, i)}"
                )


@rule(TractionModel)
def check_friction_does_not_jump_in_slip(model: TractionModel) -> None:
    """Between two adjacent floats of the sliding speed friction is the same; a ramp as steep as you like is none."""
    base = table(model, 16, BEARING)
    low, high = model.domain.get("sliding_speed", (0.0, 1e2))
    grid = np.clip([0.0, *np.logspace(-6, 2, 81)], low, high)
    if not len(base) or "sliding_speed" not in model.reads:
        raise Inapplicable("there is no slip to change")
    at = picked(base, np.repeat(np.arange(len(base)), grid.size - 1))
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


def _friction(slices: Slices, model: SliceModel, speed: Array, **others: float) -> Array:
    filled = changed(slices, model, sliding_speed=speed, **others)
    if filled is None:
        raise Inapplicable("it refuses some slips of loaded bearings")
    return np.asarray(filled.friction)


@rule(SliceModel)
def check_computes_in_double_precision(model: SliceModel) -> None:
    """A change of an input by 1e-8 shows: single precision, and an iteration that ends early, go in coarser steps."""
    step = max(1e-8, 10.0 * model.tolerance)
    for form, shaped in forms_of(model):
        slices = table(shaped, 64, BEARING)
        for member in sorted(model.reads - {"regime"}) if len(slices) else ():
            try:
                one, small, large = (
                    _scaled(slices, shaped, member, 1.0 + by) for by in (0.0, step, 1e4 * step)
                )
            except DomainError:
                continue  # at the end of its range
            for name in sorted(model.writes - {"regime"}):
                value = getattr(one, name)
                found = getattr(small, name) - value
                expected = 1e-4 * (getattr(large, name) - value)
                seen = np.abs(expected) > 0.01 * step * np.abs(value)
                lost = seen & (np.abs(found - expected) > 0.2 * np.abs(expected))
                if np.sum(seen) >= 8 and 2 * np.sum(lost) > np.sum(seen):
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
    """An array that counts the operations on it and on what becomes of it: ufuncs, and values taken or set."""

    count: ClassVar[int] = 0

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        _Counted.count += 1
        plain = [one.view(np.ndarray) if isinstance(one, _Counted) else one for one in inputs]
        if out := options.get("out"):
            options["out"] = tuple(
                one.view(np.ndarray) if isinstance(one, _Counted) else one for one in out
            )
        found = getattr(ufunc, method)(*plain, **options)
        return found.view(_Counted) if type(found) is np.ndarray else found

    def __getitem__(self, key: Any) -> Any:
        _Counted.count += 1
        return super().__getitem__(key)

    def __setitem__(self, key: Any, value: Any) -> None:
        _Counted.count += 1
        super().__setitem__(key, value)


def operations(model: SliceModel, slices: Slices) -> int:
    """Return how many operations on columns one evaluation in NumPy takes.

    They are counted by the columns: tracing what Python runs has a fault in Python 3.11 that ends in no end.
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


@rule(SliceModel)
def check_python_runs_once_for_all_slices(model: SliceModel) -> None:
    """A law without a compiled form is slow by what Python does in it, slice by slice or time and again."""
    if model.kernel() is not None:
        return  # which is what runs
    slices = table(model, 256)
    few = picked(slices, slice(0, max(len(slices) // 4, 1)))
    if len(slices) < 8:
        raise Inapplicable("there are too few slices that it takes")
    many = operations(model, slices)
    less = operations(model, few)
    why = (
        "they grow with the slices: put arrays in place of the loop"
        if many > 2 * less
        else "evaluate it less often"
    )
    if many > OPERATIONS:
        raise Questionable(
            f"evaluate() takes {many:,} operations on columns for {len(slices)} slices and {less:,} for {len(few)}; "
            f"laws of the box without a compiled form take less than {OPERATIONS} for any number; {why}, or compile "
            "it, as a package does that rollslip plugins new NAME --kind traction --compiled writes"
        )


# Shapes over slip ----------------------------------------------------------------------------------------------------

#: Shape -> signs of the steps of friction over slip, without repetition.
SHAPES: Final[Mapping[str, tuple[list[float], ...]]] = {
    "rises": ([1.0],),
    "one maximum": ([1.0, -1.0],),
    "at most one maximum": ([1.0], [1.0, -1.0]),
}


def turns(values: Array) -> list[float]:
    """Return the signs of the steps of values, -1 and 1, without repetition; rounding is no step."""
    size = np.abs(values[1:])
    steps = np.diff(values)
    signs = np.sign(steps[np.abs(steps) > ROUNDING * size])
    return [float(sign) for sign in signs[np.flatnonzero(np.diff(signs, prepend=0.0))]]


@rule(TractionModel)
@without_evaluation
def check_shapes_are_words_that_are_known(model: TractionModel) -> None:
    """``shapes`` says of "cold" and "heated" what friction does over slip, and of "bound" what it stays below."""
    known = f"'cold' and 'heated' may be {', '.join(map(repr, SHAPES))}; 'bound' names a parameter or a method"
    for of, shape in model.shapes.items():
        good = (
            shape in SHAPES if of in ("cold", "heated") else of == "bound" and hasattr(model, shape)
        )
        refuse_unless(good, f"its shapes say {of!r}: {shape!r}; {known} of the law")


@rule(TractionModel)
def check_friction_has_the_shapes_that_it_says(model: TractionModel) -> None:
    """Over slips from none to all, cold and heated, and below its bound, as laws in the box are held to theirs."""
    if not model.shapes:
        raise Inapplicable("it declares no shapes")
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
            wanted = SHAPES.get(model.shapes.get(of, ""))
            for i in range(len(base)) if wanted else ():
                at = picked(base, np.full(speed.size, i))
                given = copy_of(at, **cold) if of == "cold" else at
                mu = _friction(given, shaped, speed, **others)
                refuse_unless(
                    turns(mu) in (wanted or ()),
                    f"{form} form: {of} friction over slip is to have the shape {model.shapes[of]!r}, its steps have "
                    f"the signs {turns(mu)}, the largest {mu.max():.4g} at {speed[np.argmax(mu)]:.3g} m/s; "
                    f"at {shown(model, at, 0)}",
                )
        if "bound" in model.shapes and len(base):
            at = picked(base, np.repeat(np.arange(len(base)), speed.size))
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
