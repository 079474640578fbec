"""The rules of the model contract, one function each; the name of a function is the rule as a sentence.

- A check takes a model and raises `Nonconformance` with the wrong value, the slice, and the allowed value. It does not
  need pytest, a scene or the registry.
- Checks evaluate a model as a chain does, in both of its forms, and name the form that fails.
- Compiled forms must be equal to the bit. NumPy forms may differ within the model's ``tolerance``: the loop that NumPy
  takes for exp or pow depends on the processor and on the position of a value in its array, and an iteration over an
  array ends with its slowest element. Measured with the built-in models: up to 4.4e-16 between block sizes, for the two
  iterative laws only; 0 between orders of slices.
- An exception to a rule is declared with its reason, in the class of the law if it concerns the law: a class attribute
  ``expected_failures = {"check_name": "reason"}``. A declared failure that does not happen is a failure.
- Units come from the tables of the slices and from the metadata of the parameters. A law that is the same in any units
  proves that these are right, and that no constant has a hidden dimension.
"""

import math
import re
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any, Final, cast

import attrs
import numpy as np
from hypothesis import strategies as st

from rollslip.bearing.chain import Chain, stage
from rollslip.bearing.regimes import QUANTITIES
from rollslip.errors import DomainError, PluginError
from rollslip.lubricant.pressure import with_law
from rollslip.models import SliceModel, Validity
from rollslip.studies.validity import quantity
from rollslip.testing.rules import (
    MODELS,
    STAGES,
    Inapplicable,
    Nonconformance,
    bits,
    refuse_unless,
    rule,
    same,
    without_evaluation,
)
from rollslip.testing.samples import (
    Exponential,
    Unlimited,
    Unsuitable,
    changed,
    copy_of,
    evaluate,
    for_all,
    for_all_tables,
    forms_of,
    members,
    refuses,
    shown,
    table,
    thin_films,
    typical_values,
)
from rollslip.units import UnitError, _unit
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

#: Relative change of a result allowed after a change of units [1]: some hundred roundings, most of them in powers.
#: Doubling it finds the same faults, because a constant with a dimension changes results by factors.
UNITS_TOLERANCE: Final = 1e-10
#: Number of slices of a large table: two blocks of 256 and a remainder, with the end of a vector loop.
MANY: Final = 515
#: Number of slices for NumPy forms where many calls are made: a block of 64 and a remainder. Doubling it finds the same
#: faults in twice the time.
N_NUMPY_SLICES: Final = 67
#: Number of threads that evaluate a model at once. Doubling it makes collisions more likely and the check slower.
#: Chosen.
THREADS: Final = 8
#: Time for which threads evaluate at once [s]. Halving it may miss a shared array; with this value it is found in 40
#: of 40 runs, on one core or two.
MEETING: Final = 0.06


# Slices --------------------------------------------------------------------------------------------------------------


@rule(SliceModel)
@without_evaluation
def check_reads_and_writes_members_that_exist(model: SliceModel) -> None:
    """What is read needs a range, what is written a column, and nothing is both."""
    known = {*COLUMNS, *CONDITIONS}
    refuse_unless(
        model.reads <= known,
        f"it reads {sorted(model.reads - known)}, which the slices do not have",
    )
    refuse_unless(
        model.writes and model.writes <= {*COLUMNS},
        f"it writes {sorted(model.writes)}; it must write at least one column and columns only",
    )
    both = model.reads & model.writes
    refuse_unless(
        not both, f"it reads and writes {sorted(both)}; a second run would give something else"
    )
    for base in STAGES:
        if isinstance(model, base):
            missing = set(base.writes) - set(model.writes)
            refuse_unless(not missing, f"a {base.__name__} also writes {sorted(missing)}")
    refuse_unless(
        set(model.domain) == set(model.reads),
        f"its domain must have a range for each member it reads and no other; it differs in "
        f"{sorted(set(model.domain) ^ set(model.reads))}",
    )
    for name, (low, high) in model.domain.items():
        refuse_unless(
            -math.inf < low < high < math.inf,
            f"the domain of {name} is ({low}, {high}); give two finite numbers, rising",
        )
    refuse_unless(
        0.0 < model.tolerance <= 1e-6,
        f"its tolerance is {model.tolerance!r}; two forms of one law agree to rounding, 1e-6 at worst",
    )


@rule(SliceModel)
@without_evaluation
def check_states_what_it_was_made_for_in_quantities_that_can_be_evaluated(
    model: SliceModel,
) -> None:
    """A validity is a bound of a quantity that slices have, with consequence, remedy and source; its error a number.

    Nobody has to state one.
    """
    slices = Slices(
        4, Conditions(**typical_values(model, CONDITIONS)), **typical_values(model, COLUMNS)
    )
    for bound in model.validity:
        refuse_unless(
            isinstance(bound, Validity),
            f"validity holds {bound!r}, which is not a rollslip.models.Validity",
        )
        where = f"validity in {bound.quantity!r}"
        refuse_unless(
            bound.low <= bound.high and (bound.low > -math.inf or bound.high < math.inf),
            f"{where}: valid for {bound.low} to {bound.high}; give one finite bound, or two that rise",
        )
        for name in ("consequence", "remedy", "source"):
            text = getattr(bound, name)
            refuse_unless(
                isinstance(text, str) and text.strip(),
                f"{where}: {name} is {text!r}; say it in words",
            )
        try:
            values = quantity(model, bound.quantity, slices)
        except Exception as error:
            raise Nonconformance(
                f"{where}: {type(error).__name__}: {error}; state it in quantities() of the law, in one of "
                f"{', '.join(QUANTITIES)}, or in a member of the slices"
            ) from error
        refuse_unless(
            np.all(np.isfinite(values)),
            f"{where}: it is {values[0]} where every member has a usual value",
        )
        refuse_unless(
            ("{error}" in bound.consequence) == (bound.error is not None),
            f"{where}: error and {{error}} in the consequence go together",
        )
        if bound.error is None:
            continue
        for limit, factor in ((bound.low, 0.5), (bound.high, 2.0)):
            for value in (limit, factor * limit) if math.isfinite(limit) else ():
                off = bound.error(value)
                refuse_unless(
                    isinstance(off, float | int) and math.isfinite(off) and off >= 0.0,
                    f"{where}: the error at {value:g} is {off!r}; give per cent, not negative",
                )


@rule(SliceModel)
@without_evaluation
def check_can_be_bound_in_a_chain(model: SliceModel) -> None:
    """A kernel is None or a capsule of ``rollslip.h``, the same on each call."""
    try:
        Chain(model, model)
        stage(model)
    except PluginError as error:
        raise Nonconformance(str(error)) from error


@rule(SliceModel)
def check_takes_what_a_bearing_gives(model: SliceModel) -> None:
    """A model that refuses most of its own domain passes every other check without being looked at."""
    for form, shaped in forms_of(model):
        n = len(table(shaped, 64))
        message = "no number"
        if n < 32:
            try:
                # the refusal of the first is in the words that a user would read
                conditions = Conditions(**typical_values(model, members(model, CONDITIONS)))
                evaluate(
                    shaped, Slices(1, conditions, **typical_values(model, members(model, COLUMNS)))
                )
            except DomainError as error:
                message = str(error)
        refuse_unless(
            n >= 32,
            f"the {form} form takes {n} of 64 slices of engineering size from its own domain ({message})",
        )


@rule(SliceModel)
def check_fills_what_it_writes_and_touches_nothing_else(model: SliceModel) -> None:
    """Every slice gets a number made from what the model reads, whatever stood there and in the other columns."""
    for form, shaped in forms_of(model):
        lean = table(shaped, MANY)
        results = []
        for filling in (0.25, -7.0, math.nan):
            given = copy_of(lean)
            if not math.isnan(filling):
                others = {name: abs(filling) for name in CONDITIONS if name not in model.reads}
                given = copy_of(given, **others)
            for name in COLUMNS:
                if name not in model.reads:
                    getattr(given, name)[:] = filling
            before = copy_of(given)
            results.append(evaluate(shaped, given))
            same(
                given,
                before,
                shaped,
                0.0,
                f"the {form} form changes a column it does not write",
                [name for name in COLUMNS if name not in model.writes],
            )
        for other in results[1:]:
            what = f"the {form} form gives another result where what it does not read was another"
            same(other, results[0], shaped, 0.0, what)


@rule(SliceModel)
def check_takes_read_only_inputs(model: SliceModel) -> None:
    """The convenience methods call ``evaluate`` with the arrays of a user, who may have locked them."""
    slices = table(model, 16)
    columns: dict[str, Any] = {}
    for name in {*members(model, COLUMNS), *model.writes}:
        columns[name] = getattr(slices, name).copy()
        columns[name].flags.writeable = name in model.writes
    try:
        with np.errstate(all="ignore"):
            model.evaluate(Slices.of_columns(slices.conditions, columns))
    except (ValueError, AttributeError) as error:
        raise Nonconformance(
            f"evaluate() takes more than it reads, or writes to it: {error}"
        ) from error


@rule(SliceModel)
def check_compiled_equals_numpy(model: SliceModel) -> None:
    """Two forms of one law: the readable one is the reference."""
    if model.kernel() is None:
        raise Inapplicable("it has no kernel")
    forms = dict(forms_of(model))

    def equal(slices: Slices) -> None:
        refused = {form: refuses(shaped, slices) for form, shaped in forms.items()}
        if any(refused.values()):
            # at the edge of its domain rounding may decide
            refuse_unless(
                all(refused.values())
                or any(
                    refuses(shaped, nudged) for shaped in forms.values() for nudged in near(slices)
                ),
                f"the {'compiled' if refused['compiled'] else 'NumPy'} form refuses what the other takes; "
                f"at {shown(model, slices, 0)}",
            )
            raise Unsuitable
        compiled, numpy = (evaluate(shaped, copy_of(slices)) for shaped in forms.values())
        same(compiled, numpy, model, model.tolerance, "compiled against NumPy")

    def near(slices: Slices) -> Iterator[Slices]:
        for factor in (1 - 1e-9, 1 + 1e-9):
            nudged = copy_of(slices)
            for name in members(model, COLUMNS):
                getattr(nudged, name)[:] *= factor
                yield nudged

    for_all_tables(model, equal)
    slices = table(model, MANY)
    if not refuses(forms["NumPy"], slices):
        equal(slices)
    if {"film_thickness", "roughness"} <= model.reads:
        equal(thin_films(model, 4 * MANY))


@rule(SliceModel)
def check_does_not_depend_on_the_block_size(model: SliceModel) -> None:
    """A chain cuts its slices into blocks as it likes."""
    for form, shaped in forms_of(model):
        slices = table(shaped, MANY if form == "compiled" else N_NUMPY_SLICES)
        whole = evaluate(shaped, copy_of(slices), 0)
        for block in (1, 2, 7, 64, 256):
            same(
                evaluate(shaped, copy_of(slices), block),
                whole,
                shaped,
                bits(form, model),
                f"{form} form, blocks of {block} against all at once",
            )


@rule(SliceModel)
def check_does_not_depend_on_the_order_of_slices(model: SliceModel) -> None:
    """A slice knows nothing of its neighbours."""
    for form, shaped in forms_of(model):
        slices = table(shaped, MANY)
        straight = evaluate(shaped, copy_of(slices))
        n = len(slices)
        # backwards, rotated, and alternately from both ends
        for order in (
            np.arange(n)[::-1],
            np.roll(np.arange(n), 101),
            np.argsort(np.arange(n) % 2, kind="stable"),
        ):
            same(
                evaluate(shaped, slices.taken(order)),
                straight.taken(order),
                shaped,
                bits(form, model),
                f"{form} form, another order of slices",
            )


@rule(SliceModel)
def check_has_no_hidden_state(model: SliceModel) -> None:
    """Same input, same bits: again, after another input, and from a model made anew."""
    for form, shaped in forms_of(model):
        slices = table(shaped, MANY)
        first = evaluate(shaped, copy_of(slices))
        same(
            evaluate(shaped, copy_of(slices)),
            first,
            shaped,
            0.0,
            f"{form} form, the same input again",
        )
        evaluate(shaped, slices.taken(np.arange(len(slices))[::-3]))
        same(
            evaluate(shaped, copy_of(slices)),
            first,
            shaped,
            0.0,
            f"{form} form, after another input",
        )
    slices = table(model, MANY)
    first = evaluate(model, copy_of(slices))
    same(evaluate(attrs.evolve(cast(Any, model)), slices), first, model, 0.0, "a model made anew")


@rule(SliceModel)
def check_gives_the_same_bits_in_eight_threads(model: SliceModel) -> None:
    """Kernels run without the GIL, on other slices in each thread, through one capsule."""
    for form, shaped in forms_of(model):
        # the reference beside a kernel is not what threads run: a few slices, once
        is_run = form == "compiled" or model.kernel() is None
        slices = table(shaped, MANY if is_run else N_NUMPY_SLICES)
        if not len(slices):
            continue
        n = _slices_of_a_millisecond(shaped, slices) if form == "compiled" else len(slices)
        chain = Chain(shaped)
        tasks = []
        for k in range(THREADS):
            given = slices.taken((np.arange(n) + 37 * k) % len(slices))
            compare = partial(
                same,
                expected=evaluate(shaped, copy_of(given)),
                model=shaped,
                tolerance=0.0,
                what=f"{form} form, eight threads",
            )
            tasks.append(partial(_repeat, chain, given, compare, MEETING if is_run else 0.0))
        _together(tasks)


def _slices_of_a_millisecond(model: SliceModel, slices: Slices) -> int:
    """Return how many slices keep a kernel busy for so long that calls in other threads overlap with it."""
    chain = Chain(model)
    given = copy_of(slices)
    start = time.perf_counter()
    chain(given)
    seconds = time.perf_counter() - start
    return min(max(int(len(slices) * 1e-3 / seconds), len(slices)), 1 << 16)


def _repeat(
    chain: Chain, slices: Slices, compare: Callable[[Slices], None], seconds: float
) -> None:
    """Evaluate slices again and again for a while, and look at the result each time."""
    # by the clock: on one core, or a busy one, calls overlap only where the system switches threads inside them
    end = time.perf_counter() + seconds
    with np.errstate(all="ignore"):
        while True:
            chain(slices)
            compare(slices)
            if time.perf_counter() >= end:
                return


def _together(tasks: Sequence[Callable[[], None]]) -> None:
    """Run tasks in a thread each, all at once; the first error is raised."""
    start = threading.Barrier(len(tasks))

    def work(task: Callable[[], None]) -> None:
        start.wait()
        task()

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)  # Python stages meet too
    try:
        with ThreadPoolExecutor(len(tasks)) as pool:
            list(pool.map(work, tasks))
    finally:
        sys.setswitchinterval(interval)


@rule(SliceModel)
def check_refuses_values_outside_its_domain(model: SliceModel) -> None:
    """NaN, infinities and what lies beyond a range end in an error that names the member; nothing computes on."""
    for form, shaped in forms_of(model):
        slices = table(shaped, 64).taken(slice(0, 5))
        if not len(slices):
            raise Inapplicable("there is no slice that it takes, so that none can be spoiled")
        for member in sorted(model.reads):
            low, high = model.domain.get(member, (-sys.float_info.max, sys.float_info.max))
            beyond = [
                limit
                for limit in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf))
                if math.isfinite(limit)
            ]
            for value in (math.nan, math.inf, -math.inf, *beyond):
                if member in CONDITIONS:
                    spoiled = copy_of(slices, **{member: value})
                else:
                    spoiled = copy_of(slices)
                    getattr(spoiled, member)[-1] = value
                try:
                    evaluate(shaped, spoiled)
                except DomainError as error:
                    refuse_unless(
                        re.search(rf"\b{member}\b", str(error)),
                        f"{form} form, {member} = {value!r}: the error does not name the member: {error}",
                    )
                else:
                    raise Nonconformance(
                        f"{form} form, {member} = {value!r} is taken: there is no error"
                    )


@rule(SliceModel)
def check_answers_its_whole_domain_with_numbers_or_an_error(model: SliceModel) -> None:
    """The smallest and the largest floats of a domain give a finite number or a `DomainError`, nothing else."""
    extremes = {
        name: (low, high, max(low, 1e-300), min(high, 1e300), max(low, 1e-30), min(high, 1e30))
        for name, (low, high) in model.domain.items()
    }
    base = typical_values(model, extremes)
    choices = st.fixed_dictionaries(
        {name: st.just(base[name]) | st.sampled_from(extremes[name]) for name in sorted(extremes)}
    )

    def answers(chosen: Mapping[str, float], form: str, shaped: SliceModel) -> None:
        conditions = Conditions(**{name: chosen[name] for name in members(model, CONDITIONS)})
        slices = Slices(1, conditions, **{name: chosen[name] for name in members(model, COLUMNS)})
        try:
            evaluate(shaped, slices)
        except DomainError:
            return
        except Exception as error:
            raise Nonconformance(
                f"{form} form: {type(error).__name__}: {error}; only a DomainError may leave it; "
                f"at {shown(model, slices, 0)}"
            ) from error
        for name in sorted(model.writes):
            value = float(getattr(slices, name)[0])
            refuse_unless(
                math.isfinite(value),
                f"{form} form: {name} = {value}; at {shown(model, slices, 0)}",
            )

    def all_answer(chosen: Mapping[str, float]) -> None:
        for form, shaped in forms_of(model):
            answers(chosen, form, shaped)

    for name, values in extremes.items():
        for value in values:
            all_answer(base | {name: value})
    for_all(choices, all_answer)


# Units ---------------------------------------------------------------------------------------------------------------

_FACTOR = re.compile(r"([A-Za-z]+|1)\^?(\d+(?:\.\d+)?)?")


def dimension(unit: str) -> tuple[float, float, float, float]:
    """Return the exponents of metre, kilogram, second and kelvin of an SI unit; they may be halves.

    Examples
    --------
    >>> dimension("J/(m2 K s^0.5)")
    (0.0, 1.0, -2.5, -1.0)
    """
    total = np.zeros(4)
    for sign, factors in zip((1.0, -1.0), unit.partition("/")[::2], strict=True):
        for word in factors.strip(" ()").split():
            if (factor := _FACTOR.fullmatch(word)) is None:
                raise UnitError(f"{unit!r} is not a unit that is known here")
            total += sign * float(factor[2] or 1) * np.array(_unit(factor[1])[1][:4])
    metre, kilogram, second, kelvin = map(float, total)
    return metre, kilogram, second, kelvin


def in_other_units(value: Any, unit: str, powers: tuple[int, int, int, int]) -> Any:
    """Return a value in units that are 4^powers times smaller than metre, kilogram, second and kelvin."""
    # Powers of four, so that neither the value nor the square root of a unit is rounded.
    return value * 2.0 ** (2 * sum(a * b for a, b in zip(dimension(unit), powers, strict=True)))


def parameters_in_other_units(model: Any, powers: tuple[int, int, int, int]) -> Any:
    """Return a model whose parameters, and those of its children, are given in other units."""
    changes = {}
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        unit = attribute.metadata.get("unit")
        if isinstance(value, MODELS):
            changes[attribute.alias] = parameters_in_other_units(value, powers)
        elif isinstance(value, float) and unit is not None and any(dimension(unit)):
            changes[attribute.alias] = in_other_units(value, unit, powers)
    with attrs.validators.disabled():  # limits are written in SI
        return attrs.evolve(model, **changes)


@rule(SliceModel)
def check_does_not_know_metre_kilogram_second_and_kelvin(model: SliceModel) -> None:
    """A law of nature is the same in any units: finds hidden constants, wrong units and members read by mistake.

    How the oil's viscosity rises is not the model's: an exponential law, which has no number of its own, stands for it.
    """
    model = with_law(model, Exponential())
    random = np.random.default_rng(1)

    def equal(slices: Slices) -> None:
        powers = cast(tuple[int, int, int, int], tuple(random.integers(-5, 6, 4).tolist()))
        if (expected := changed(slices, model)) is None:
            raise Unsuitable
        conditions = {
            name: in_other_units(getattr(slices.conditions, name), CONDITIONS[name][0], powers)
            for name in members(model, CONDITIONS)
        }
        columns = {
            name: in_other_units(getattr(slices, name), COLUMNS[name][0], powers)
            for name in members(model, COLUMNS)
        }
        other = Slices(len(slices), Conditions(**conditions), **columns)
        units = " and ".join(
            f"{4.0**-power:g} {unit}"
            for power, unit in zip(powers, ("m", "kg", "s", "K"), strict=True)
            if power
        )
        try:
            evaluate(Unlimited(parameters_in_other_units(model, powers)), other)  # type: ignore[arg-type]
        except DomainError as error:
            raise Nonconformance(
                f"counted in units of {units} it refuses what it took in SI, so a number in it, such as a limit, has a "
                f"dimension: {error}"
            ) from error
        for name in sorted(model.writes):
            getattr(expected, name)[:] = in_other_units(
                getattr(expected, name), COLUMNS[name][0], powers
            )
        what = (
            f"counted in units of {units} the law is another, so a number in it, such as the place of a jump, has a "
            "dimension that no parameter declares"
        )
        same(other, expected, model, max(UNITS_TOLERANCE, model.tolerance), what)

    for_all_tables(model, equal)
