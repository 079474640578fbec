"""Check whether models are used within their range of validity, and word the warnings where they are not.

1. Evaluate the slices at the state that a result describes (`Study.validity_slices`), a table for each ring
   (`evaluate_rings`).
2. For each bound of each law find the fraction of the contact force which lies outside, and the quantiles of the
   bounded quantity there (`range_excesses`). Bounds, consequences and remedies are the models' own
   (`rollslip.models.Validity`); nothing here knows a model by name.
3. A law that approximates another (``solved_by``) is compared with that law on the same slices (`law_difference`). Its
   measured error replaces the messages about the approximation's own bounds.
4. Word each excess (`validity_messages`), in the order of its severity: the fraction of the force outside times the
   relative error of the law at the median of the bounded quantity there, weighted by force. An error that is not known
   counts as the whole.
5. Count the rest in one sentence (`warning_texts`): what is below the tolerance, and bounds that nearly every bearing
   exceeds with an error that is not known.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.bearing.assembly import Assembly
from rollslip.bearing.chain import Chain
from rollslip.bearing.raceway import Array, LoadedContacts
from rollslip.bearing.regimes import LONG_NAMES, NAMES, QUANTITIES
from rollslip.catalogue.registry import get_class
from rollslip.models import (
    ContactModel,
    FilmModel,
    PressureModel,
    ResistanceModel,
    SliceModel,
    TractionModel,
    Validity,
)
from rollslip.results.text import OTHER_BOUNDS, REPORTED_FROM
from rollslip.studies.answers import LoadedSlices
from rollslip.units import format_quantity
from rollslip_kernels.slices import COLUMNS, CONDITIONS, PLACES, Slices

__all__ = [
    "LawDifference",
    "RangeExcess",
    "RingSlices",
    "ValidityMessage",
    "check_validity",
    "describe_bound",
    "evaluate_rings",
    "law_difference",
    "quantity",
    "range_excesses",
    "rolling_slices",
    "validity_messages",
    "validity_record",
    "warning_texts",
]

#: Code of the message on the measured error of a law that approximates another; messages on bounds have the codes of
#: these (`rollslip.models.Validity`).
APPROXIMATION: Final = "W23"
#: Quantiles of the bounded quantity outside, weighted by force: a message has the outer ones, the severity the middle
#: one. Chosen; 0 and 1 would let a single slice decide what a message says.
_QUANTILES: Final = (0.05, 0.5, 0.95)
#: End of "37 % of the contact force" in messages; 100 % of it is "all loaded contacts". Messages on rows of data pass
#: another text.
_OF_FORCE: Final = "of the contact force"

#: Base class of a law -> what messages call its kind.
_KINDS: Final = (
    (ContactModel, "contact"),
    (FilmModel, "film"),
    (PressureModel, "pressure"),
    (TractionModel, "traction"),
    (ResistanceModel, "drag"),
)


@attrs.frozen(kw_only=True)
class RangeExcess:
    """How much of a ring's contact force, or of rows of data, lies outside one bound of a law."""

    #: Kind and name of the law.
    law: str
    validity: Validity
    #: Fraction of the force outside, 0 to 1; 1 only where no loaded contact lies inside.
    fraction: float
    #: Quantiles of the bounded quantity outside, weighted by force, 5 % and 95 %; empty where nothing is outside.
    values: tuple[float, ...] = ()
    #: Median of the same; NaN where nothing is outside.
    median: float = math.nan
    #: Ring with the larger fraction, or with all of it; empty where both have about the same.
    ring: str = ""
    #: Fractions of the regimes of the film, in words.
    detail: str = ""
    #: False where the quantity needs data that the oil does not have.
    is_known: bool = True

    @property
    def severity(self) -> float:
        """Fraction of the force outside times the relative error in its median; an error that is not known is 1."""
        error = self.validity.error
        if error is None or not self.values:
            return self.fraction
        return self.fraction * (0.01 * error(self.median))  # from per cent

    @property
    def is_common(self) -> bool:
        """Whether nearly every bearing exceeds the bound, with an error that is not known: such are only counted."""
        return self.validity.common and self.validity.error is None


@attrs.frozen(kw_only=True)
class ValidityMessage:
    """A bound that was exceeded, or the error of an approximation, in a sentence and in a few words."""

    #: Kind and name of the law.
    law: str
    #: The bound in words, or the law that is approximated.
    made_for: str
    #: Relative error, see `RangeExcess.severity`.
    severity: float
    #: A sentence without its full stop.
    text: str
    #: A few words, for a list.
    short: str
    #: Whether it is a warning of its own; otherwise it is counted with others.
    is_warning: bool
    #: Whether the error was measured on the slices of the result.
    measured: bool = False
    #: Code by which ``rollslip explain`` finds it.
    code: str = ""


@attrs.frozen(kw_only=True)
class LawDifference:
    """Error of a law against the law that it approximates, on slices on which both were evaluated.

    It is the error of friction by force, sum F (|mu| - |mu_ref|)/sum F |mu_ref|, of each ring at each slip.
    """

    law: str
    reference: str
    #: Key of the scene under which the law stands.
    key: str
    #: Root of the mean square over rings and slips.
    rms: float
    mean: float
    #: The error of largest size, with its sign.
    largest: float


@attrs.frozen(eq=False)
class RingSlices:
    """Evaluated slices of a ring, (n,), for all slips one after the other."""

    ring: str
    slices: Slices
    #: Force on each slice [N], (n,).
    force: Array
    #: Index of the first slice of each slip.
    starts: NDArray[np.intp] = attrs.field(factory=lambda: np.zeros(1, dtype=np.intp))


def evaluate_rings(contacts: Sequence[LoadedSlices], assembly: Assembly) -> list[RingSlices]:
    """Return slices evaluated by the laws of a bearing, a table for each ring that has loaded slices.

    Parameters
    ----------
    contacts : sequence of LoadedSlices
        Loads and speeds of the slices.
    assembly : Assembly
        The bearing with which the result was computed.
    """
    tables = []
    for raceway in assembly.raceways:
        loaded = [item for item in contacts if item.ring == raceway.ring and len(item.load)]
        if not loaded:
            continue
        load, rolling, sliding, force = (
            np.concatenate(
                [np.broadcast_to(getattr(item, name), len(item.load)) for item in loaded]
            )
            for name in ("load", "rolling", "sliding", "force")
        )
        places = {
            name: np.concatenate(
                [np.broadcast_to(item.places[name], len(item.load)) for item in loaded]
            )
            for name in loaded[0].places
        }
        slices = raceway.evaluate(load, rolling, sliding, **places)
        starts = np.cumsum([0, *(len(item.load) for item in loaded[:-1])], dtype=np.intp)
        tables.append(RingSlices(raceway.ring, slices, force.astype(float), starts))
    return tables


def check_validity(
    contacts: Sequence[LoadedSlices], assembly: Assembly, traction: TractionModel
) -> tuple[list[RangeExcess], LawDifference | None]:
    """Return where slices lie outside the ranges of validity of all laws, and the error of an approximating law.

    Parameters
    ----------
    contacts : sequence of LoadedSlices
        Slices at the state of the result.
    assembly : Assembly
        The bearing with which the result was computed.
    traction : TractionModel
        The traction that the scene names, which a closed form may have replaced in the bearing.
    """
    tables = evaluate_rings(contacts, assembly)
    laws = [model for model in assembly.inner.chain.models if not isinstance(model, TractionModel)]
    if assembly.pressure not in laws:
        laws.append(assembly.pressure)
    return range_excesses([*laws, traction], tables), law_difference(traction, tables, assembly)


def quantity(model: SliceModel, name: str, slices: Slices) -> Array:
    """Return a quantity in which a law states its validity or its regimes.

    Parameters
    ----------
    model : SliceModel
        The law, whose own quantities come first.
    name : str
        Name of the quantity.
    slices : Slices
        Evaluated slices, (n,).

    Returns
    -------
    array, shape (n,)
        Values in SI units; NaN where data of the oil are missing.
    """
    own = model.quantities(slices)
    if name in own:
        values = own[name]
    elif name in QUANTITIES:
        values = QUANTITIES[name].of(slices)
    elif name in COLUMNS:
        values = getattr(slices, name)
    elif name in CONDITIONS:
        values = getattr(slices.conditions, name)
    else:
        raise KeyError(
            f"{model.name!r} states its validity or its regimes in {name!r}, which is not a quantity"
        )
    return np.broadcast_to(np.asarray(values, dtype=float), (len(slices),))


def symbol_of(name: str) -> tuple[str, str]:
    """Return how a quantity is written in sentences, and its unit."""
    if name in QUANTITIES:
        return f"{name.replace('_', ' ')} {QUANTITIES[name].symbol}".strip(), "1"
    return name.replace("_", " "), {**COLUMNS, **CONDITIONS}.get(name, ("1", ""))[0]


def laws_of(
    model: SliceModel, covered: frozenset[str] = frozenset()
) -> Iterator[tuple[str, SliceModel, Validity]]:
    """Yield (kind and name, law, validity) for each validity of a law and of its submodels.

    Those in quantities that an outer law covers are left out.
    """
    kind = next((name for base, name in _KINDS if isinstance(model, base)), "")
    label = f"{kind} {model.name!r}".strip()
    for validity in model.validity:
        if validity.quantity not in covered:
            yield label, model, validity
    cls: Any = type(model)
    if attrs.has(cls):
        for attribute in attrs.fields(cls):
            child = getattr(model, attribute.name)
            if isinstance(child, SliceModel):
                yield from laws_of(child, covered | model.covers)


def range_excesses(models: Sequence[SliceModel], tables: Sequence[RingSlices]) -> list[RangeExcess]:
    """Return for each bound of some laws the fraction of the force outside, on the ring with the larger one.

    Parameters
    ----------
    models : sequence of SliceModel
        The laws, whose submodels are checked, too.
    tables : sequence of RingSlices
        Evaluated slices; without any nothing is checked.
    """
    if not tables:
        return []
    rings = {
        ring: [table for table in tables if table.ring == ring]
        for ring in dict.fromkeys(table.ring for table in tables)
    }
    force = {ring: np.concatenate([table.force for table in rings[ring]]) for ring in rings}
    excesses = []
    for label, model, validity in (row for law in models for row in laws_of(law)):
        with np.errstate(all="ignore"):
            values = {
                ring: np.concatenate(
                    [quantity(model, validity.quantity, table.slices) for table in rings[ring]]
                )
                for ring in rings
            }
        fractions = {ring: _fraction_outside(validity, values[ring], force[ring]) for ring in rings}
        ring = max(fractions, key=lambda name: fractions[name])
        excess = _range_excess(label, validity, fractions[ring], values[ring], force[ring])
        # a message names the ring if its fraction is larger by as much as is reported, or if all of it is outside
        smallest = min(fractions.values())
        if fractions[ring] - smallest >= REPORTED_FROM or fractions[ring] == 1.0 > smallest:
            excess = attrs.evolve(excess, ring=ring)
        excesses.append(excess)
    return excesses


def _fraction_outside(validity: Validity, values: Array, force: Array) -> float:
    """Return the fraction of the force outside a bound; values that are not known lie inside.

    It is 1 only where no loaded contact is inside: a sum that is rounded to the whole is the next number below 1.
    """
    total = float(force.sum())
    if total <= 0.0:
        return 0.0
    is_outside = validity.excess(values) > 0.0
    if not force[~is_outside].any():
        return 1.0
    return min(float(force[is_outside].sum()) / total, math.nextafter(1.0, 0.0))


def _range_excess(
    label: str, validity: Validity, fraction: float, values: Array, force: Array
) -> RangeExcess:
    """Return the excess of a bound, with the quantiles of its quantity by force, and the other regimes of a film."""
    outer_quantiles = tuple[float, ...]()
    median = math.nan
    detail = ""
    if fraction > 0.0:
        is_beyond = validity.excess(values) > 0.0
        low, median, high = _quantiles(values[is_beyond], force[is_beyond], _QUANTILES)
        outer_quantiles = low, high
    if validity.quantity == "film_regime" and fraction > 0.0:
        # a regime is a number, and the range of a formula is that of one regime
        fractions = {
            LONG_NAMES[name]: float(force[values == code].sum() / force.sum())
            for code, name in enumerate(NAMES)
            if not validity.low <= code <= validity.high
        }
        detail = " and ".join(
            f"{_percent(fractions[name])} {name}" for name in fractions if fractions[name] > 0.0
        )
    return RangeExcess(
        law=label,
        validity=validity,
        fraction=fraction,
        values=outer_quantiles,
        median=median,
        detail=detail,
        is_known=not bool(np.isnan(values).all()),
    )


def _quantiles(values: Array, weights: Array, fractions: Sequence[float]) -> tuple[float, ...]:
    """Return weighted quantiles of values."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return tuple(
        float(values[order][np.searchsorted(below, fraction * below[-1])]) for fraction in fractions
    )


def law_difference(
    traction: TractionModel, tables: Sequence[RingSlices], assembly: Assembly
) -> LawDifference | None:
    """Return the error of the law of the full film against the law that it approximates, on the same slices.

    Parameters
    ----------
    traction : TractionModel
        The traction that the scene names.
    tables : sequence of RingSlices
        Slices evaluated by the bearing's laws.
    assembly : Assembly
        The bearing with which the result was computed.

    Returns
    -------
    LawDifference or None
        None where the law approximates no other, a closed form replaced it in this run, or no slice has friction.
    """
    law = traction.full_film
    if law.solved_by is None or assembly.resolution.traction != "named":
        return None
    cls = type(law)
    reference = get_class("traction", law.solved_by)
    shared = {a.name for a in attrs.fields(cls)} & {a.name for a in attrs.fields(reference)}  # type: ignore[arg-type]
    exact = reference(**{name: getattr(law, name) for name in shared})
    models = (
        model.with_full_film(exact) if isinstance(model, TractionModel) else model
        for model in assembly.inner.chain.models
    )
    fields = attrs.fields(type(traction))  # type: ignore[arg-type]
    # the law is the traction itself, or a submodel of it
    child = "".join(f".{field.name}" for field in fields if getattr(traction, field.name) is law)
    chain = Chain(*models, compiled=assembly.resolution.compiled)
    differences = [_friction_differences(table, chain) for table in tables]
    errors = np.concatenate(differences) if differences else np.empty(0)
    if errors.size == 0:
        return None
    return LawDifference(
        law=law.name,
        reference=exact.name,
        key=f"models.traction{child}",
        rms=float(np.sqrt((errors**2).mean())),
        mean=float(errors.mean()),
        largest=float(errors[np.argmax(np.abs(errors))]),
    )


def _friction_differences(table: RingSlices, chain: Chain) -> Array:
    """Return the relative errors of the friction of a ring against another chain, at each slip with friction."""
    own = table.slices
    force = table.force
    columns = {name: getattr(own, name) for name in ("load", "rolling_speed", "sliding_speed")}
    if chain.placed:
        columns |= {name: getattr(own, name) for name in PLACES}
    other = Slices(len(own), own.conditions, **columns)
    chain(other)
    size = np.add.reduceat(force * np.abs(other.friction), table.starts)
    change = np.add.reduceat(force * (np.abs(own.friction) - np.abs(other.friction)), table.starts)
    differences: Array = change[size > 0.0] / size[size > 0.0]
    return differences


def validity_messages(
    excesses: Sequence[RangeExcess],
    difference: LawDifference | None,
    where: str = "",
    what: str = _OF_FORCE,
    tolerance: float = 0.0,
) -> list[ValidityMessage]:
    """Return a message for each bound that is exceeded and for the error of an approximation, by severity.

    Common bounds come after all others, and bounds of the approximation itself have no message. The approximation is
    the first if it is a warning, else the last.

    Parameters
    ----------
    excesses : sequence of RangeExcess
        What lies outside the bounds of all laws. Below a fraction of `REPORTED_FROM` there is no message.
    difference : LawDifference or None
        Error of an approximating law.
    where : str
        State of the slices: "over the curves".
    what : str
        What the fractions are of.
    tolerance : float
        Relative error up to which a message is no warning of its own.
    """
    messages = list[ValidityMessage]()
    for excess in sorted(excesses, key=lambda each: (each.is_common, -each.severity)):
        if excess.fraction < REPORTED_FROM or (
            difference is not None and _is_of_approximation(excess, difference)
        ):
            continue
        bound = describe_bound(excess.validity)
        messages.append(
            ValidityMessage(
                law=excess.law,
                made_for=bound,
                severity=excess.severity,
                text=_describe_excess(excess, bound, where, what),
                short=f"{excess.law} ({bound}; {_percent(excess.fraction)} outside)",
                is_warning=not excess.is_common and excess.severity > tolerance,
                code=excess.validity.code,
            )
        )
    if difference is None:
        return messages
    approximation = ValidityMessage(
        law=difference.law,
        made_for=difference.reference,
        severity=difference.rms,
        text=_describe_difference(difference, excesses, where, what),
        short=f"{difference.law!r} for {difference.reference!r}",
        is_warning=difference.rms > tolerance,
        measured=True,
        code=APPROXIMATION,
    )
    return [approximation, *messages] if approximation.is_warning else [*messages, approximation]


def _describe_excess(excess: RangeExcess, bound: str, where: str, what: str) -> str:
    """Return the sentence on a bound that is exceeded: the bound, what is outside, its consequence and remedy."""
    ring = f" of the {excess.ring} ring" if excess.ring else ""
    state = f" {where}" if where else ""
    if excess.detail:
        state += f" ({excess.detail})"
    subject = f"{_percent(excess.fraction)} {what}{ring} is"
    if excess.fraction == 1.0 and what == _OF_FORCE:
        subject = f"all loaded contacts{ring} are"
    validity = excess.validity
    return (
        f"{excess.law} is valid for {bound}; {subject} outside{state}, where "
        f"{validity.consequence_at(*excess.values)}; remedy: {validity.remedy}"
    )


def warning_texts(messages: Sequence[ValidityMessage], tolerance: float = 0.0) -> list[str]:
    """Return the sentences of warnings, and one sentence that counts the other messages; without full stops.

    Parameters
    ----------
    messages : sequence of ValidityMessage
        Messages in the order of their severity.
    tolerance : float
        The tolerance by which warnings were chosen; 0 for none.
    """
    others = [message.short for message in messages if not message.is_warning]
    texts = [message.text for message in messages if message.is_warning]
    if not others:
        return texts
    below = f" or below accuracy.tolerance = {tolerance:g}" if tolerance > 0.0 else ""
    return [
        *texts,
        f"{OTHER_BOUNDS} not known{below}: {'; '.join(others)}; rollslip run of the scene lists each",
    ]


def _percent(fraction: float) -> str:
    """Return a fraction in whole per cent; "100 %" is all and "0 %" nothing, without rounding."""
    whole = f"{100.0 * fraction:.0f} %"
    if whole == "100 %" and fraction < 1.0:
        return "over 99 %"
    return "under 1 %" if whole == "0 %" and fraction > 0.0 else whole


def describe_bound(validity: Validity, *, is_outside: bool = False) -> str:
    """Return a bound in words: "load parameter M >= 2", "pressure <= 100 MPa".

    Parameters
    ----------
    validity : Validity
        The bound.
    is_outside : bool, optional
        Whether the values outside are described: "load parameter M < 2".
    """
    if validity.made_for:
        return f"values outside {validity.made_for}" if is_outside else validity.made_for
    name, unit = symbol_of(validity.quantity)
    bounds = [
        f"{signs[is_outside]} {f'{limit:.3g}' if unit == '1' else format_quantity(limit, unit, 3)}"
        for *signs, limit in validity.limits
    ]
    return f"{validity.quantity_name or name} {(' and ', ' or ')[is_outside].join(bounds)}"


def _is_of_approximation(excess: RangeExcess, difference: LawDifference) -> bool:
    """Whether a bound is one of an approximation itself, whose error is known by its difference.

    A bound in a quantity of all laws concerns the physics, which the approximated law shares.
    """
    is_general = excess.validity.quantity in {*QUANTITIES, *COLUMNS, *CONDITIONS}
    return excess.law == f"traction {difference.law!r}" and not is_general


def _describe_difference(
    difference: LawDifference, excesses: Sequence[RangeExcess], where: str, what: str
) -> str:
    """Return the sentence on the error of an approximation, with what is outside its own bounds."""
    bounds = [
        f"{_percent(excess.fraction)} at {describe_bound(excess.validity, is_outside=True)}"
        for excess in excesses
        if _is_of_approximation(excess, difference) and excess.fraction >= REPORTED_FROM
    ]
    beyond = f", with {' and '.join(bounds)} {what}" if bounds else ""
    return (
        f"the friction of {difference.law!r} is {100.0 * difference.rms:.2g} % (rms) off that of "
        f"{difference.reference!r}, the law that it approximates, {where or 'on these slices'}: "
        f"{100.0 * difference.mean:+.2g} % in the mean, {100.0 * difference.largest:+.2g} % at most{beyond}; "
        f"remedy: {difference.key} = {difference.reference!r}"
    )


def validity_record(
    excesses: Sequence[RangeExcess],
    difference: LawDifference | None,
    messages: Sequence[ValidityMessage] = (),
) -> dict[str, Any]:
    """Return a check of validity as plain values, for JSON.

    Parameters
    ----------
    excesses : sequence of RangeExcess
        One for each bound; a fraction that is not known is None.
    difference : LawDifference or None
        Error of an approximating law.
    messages : sequence of ValidityMessage
        How these are reported.
    """
    rows = [
        {
            "code": excess.validity.code,
            "law": excess.law,
            "made_for": describe_bound(excess.validity),
            "fraction_outside": excess.fraction if excess.is_known else None,
            "ring": excess.ring,
            "values_outside": list(excess.values),
            "consequence": excess.validity.consequence_at(*excess.values)
            if excess.values
            else excess.validity.consequence_range,
            "remedy": excess.validity.remedy,
            "source": excess.validity.source,
        }
        for excess in excesses
    ]
    return {
        "bounds": rows,
        "approximation": None if difference is None else attrs.asdict(difference),
        "messages": list(map(attrs.asdict, messages)),
    }


def rolling_slices(assembly: Assembly) -> list[LoadedSlices]:
    """Return the loaded slices of both rings at the first roller position, where the bearing rolls without slip."""
    loads = assembly.load_distribution(1)
    speeds = assembly.kinematics.surface_speeds(0.0, 0.0)
    contacts = []
    for raceway, load, rolling in (
        (assembly.inner, loads.inner_load, speeds.inner_rolling),
        (assembly.outer, loads.outer_load, speeds.outer_rolling),
    ):
        places = assembly.places(raceway.ring, loads.psi[0], np.arange(float(loads.psi.shape[1])))
        loaded = LoadedContacts(raceway, load[0], assembly.widths, 1.0, places=places)
        contacts.append(
            LoadedSlices(
                0, raceway.ring, loaded.load, float(rolling), 0.0, loaded.force, loaded.places
            )
        )
    return contacts
