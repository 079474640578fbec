"""What a result's models were made for, and how far it left that: the one place where warnings about models are made.

- Bounds, consequences and remedies are the models' own (`rollslip.models.Validity`); nothing here knows a model by
  name. They are held against the slices at the state that a result speaks of (`Study.validity_slices`).
- Warnings come by consequence: what a law is off another, measured on the slices of the result, then the share of the
  force outside times the consequence in the middle of it. One that nobody knows counts as the whole. What is below the
  tolerance, and what nearly every bearing leaves with a consequence that nobody knows, is counted in one sentence.
- A law that approximates another (``solved_by``) is evaluated beside it on the same slices: what it is off there is
  known, so that its own bounds are told with it and not one by one.
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
from rollslip.results.words import OTHER_BOUNDS, REPORTED_FROM
from rollslip.studies.answers import LoadedSlices
from rollslip.units import format_quantity
from rollslip_kernels.slices import COLUMNS, CONDITIONS, PLACES, Slices

__all__ = [
    "Difference",
    "Filled",
    "Outside",
    "Told",
    "bound_of",
    "corrections",
    "difference",
    "filled",
    "judged",
    "outside",
    "quantity",
    "record",
    "rolling_slices",
    "sentences",
    "told",
]

#: Code of what a law is off another that it approximates, which has no bound.
APPROXIMATION: Final = "W23"

_KINDS: Final = (
    (ContactModel, "contact"),
    (FilmModel, "film"),
    (PressureModel, "pressure"),
    (TractionModel, "traction"),
)


@attrs.frozen(kw_only=True)
class Outside:
    """How much of a ring's contact force, or of rows of data, lies outside one bound of a law.

    ``law`` is kind and name, ``fraction`` is 1 for all, ``values`` what the quantity is outside, by force from
    5 to 95 %,
    and ``middle`` in the middle of it; ``known`` is False where the quantity takes data that the oil does not give.
    """

    law: str
    validity: Validity
    fraction: float
    values: tuple[float, ...] = ()
    middle: float = math.nan
    ring: str = ""
    detail: str = ""
    known: bool = True

    @property
    def weight(self) -> float:
        """Share of the force outside times the consequence in its middle; that is 1 where nobody knows it."""
        error = self.validity.error
        return self.fraction * (
            0.01 * error(self.middle) if error is not None and self.values else 1.0
        )

    @property
    def counted(self) -> bool:
        """Whether nearly every bearing leaves the bound, with a consequence that nobody knows."""
        return self.validity.common and self.validity.error is None


@attrs.frozen(kw_only=True)
class Told:
    """A bound that was left, in a sentence and in a few words.

    ``weight`` is its consequence, relative, ``measured`` whether on the slices of the result; ``warned`` is one that is
    a warning of its own.
    """

    law: str
    made_for: str
    weight: float
    text: str
    short: str
    warned: bool
    measured: bool = False
    code: str = ""


@attrs.frozen(kw_only=True)
class Difference:
    """How far a law is off the one that it approximates, on slices that both were evaluated on.

    Of each ring at each slip the friction by force, sum F (mu - mu_ref)/sum F |mu_ref|: root of the mean square over
    them, mean, and the one of the largest size. ``key`` is that of the scene under which the law stands.
    """

    law: str
    reference: str
    key: str
    rms: float
    mean: float
    largest: float


@attrs.frozen(eq=False)
class Filled:
    """Evaluated slices of a ring, the force on each, and where those of one slip begin."""

    ring: str
    slices: Slices
    force: Array
    starts: NDArray[np.intp] = attrs.field(factory=lambda: np.zeros(1, dtype=np.intp))


def filled(contacts: Sequence[LoadedSlices], assembly: Assembly) -> list[Filled]:
    """Return slices evaluated by the laws that a result was computed with, a table for each ring."""
    tables = []
    for raceway in assembly.raceways:
        those = [one for one in contacts if one.ring == raceway.ring and len(one.load)]
        if not those:
            continue
        load, rolling, sliding, force = (
            np.concatenate([np.broadcast_to(getattr(one, name), len(one.load)) for one in those])
            for name in ("load", "rolling", "sliding", "force")
        )
        places = {
            name: np.concatenate(
                [np.broadcast_to(one.places[name], len(one.load)) for one in those]
            )
            for name in those[0].places
        }
        slices = raceway.evaluate(load, rolling, sliding, **places)
        starts = np.cumsum([0, *(len(one.load) for one in those[:-1])], dtype=np.intp)
        tables.append(Filled(raceway.ring, slices, force.astype(float), starts))
    return tables


def judged(
    contacts: Sequence[LoadedSlices], assembly: Assembly, traction: TractionModel
) -> tuple[list[Outside], Difference | None]:
    """Return where slices lie outside of what all laws were made for, and what the traction that is named is off."""
    tables = filled(contacts, assembly)
    laws = [model for model in assembly.inner.chain.models if not isinstance(model, TractionModel)]
    laws += [] if assembly.pressure in laws else [assembly.pressure]
    return outside([*laws, traction], tables), difference(traction, tables, assembly)


def quantity(model: SliceModel, name: str, slices: Slices) -> Array:
    """Return a quantity in which a law states validity or regimes, of evaluated slices; NaN where data are missing."""
    if name in (own := model.quantities(slices)):
        found = own[name]
    elif name in QUANTITIES:
        found = QUANTITIES[name].of(slices)
    elif name in COLUMNS:
        found = getattr(slices, name)
    elif name in CONDITIONS:
        found = getattr(slices.conditions, name)
    else:
        raise KeyError(
            f"{model.name!r} states its validity or its regimes in {name!r}, which is no quantity"
        )
    return np.broadcast_to(np.asarray(found, dtype=float), (len(slices),))


def symbol_of(name: str) -> tuple[str, str]:
    """Return how a quantity is written in sentences, and its unit."""
    if name in QUANTITIES:
        symbol = QUANTITIES[name].symbol
        return f"{name.replace('_', ' ')} {symbol}".strip(), "1"
    return name.replace("_", " "), {**COLUMNS, **CONDITIONS}.get(name, ("1", ""))[0]


def laws_of(
    model: SliceModel, covered: frozenset[str] = frozenset()
) -> Iterator[tuple[str, SliceModel, Validity]]:
    """Yield kind and name of a law, itself and each of its validities, then those of its submodels."""
    kind = next((name for base, name in _KINDS if isinstance(model, base)), "")
    if isinstance(model, ResistanceModel):
        kind = "drag"
    label = f"{kind} {model.name!r}".strip()
    yield from ((label, model, one) for one in model.validity if one.quantity not in covered)
    cls: Any = type(model)
    if attrs.has(cls):
        for attribute in attrs.fields(cls):
            child = getattr(model, attribute.name)
            if isinstance(child, SliceModel):
                yield from laws_of(child, covered | model.covers)


def outside(models: Sequence[SliceModel], tables: Sequence[Filled]) -> list[Outside]:
    """Return where slices lie outside of what laws were made for: the ring with the larger share for each bound."""
    found = []
    rings = {
        ring: [table for table in tables if table.ring == ring]
        for ring in dict.fromkeys(t.ring for t in tables)
    }
    for label, model, validity in (row for one in models for row in laws_of(one)):
        if not rings:
            break
        with np.errstate(all="ignore"):
            values = {
                ring: np.concatenate(
                    [quantity(model, validity.quantity, table.slices) for table in those]
                )
                for ring, those in rings.items()
            }
        force = {
            ring: np.concatenate([table.force for table in those]) for ring, those in rings.items()
        }
        fractions = {ring: _fraction(validity, values[ring], force[ring]) for ring in rings}
        ring = max(fractions, key=lambda name: fractions[name])
        alike = fractions[ring] - min(fractions.values()) < REPORTED_FROM
        found.append(
            _outside(
                label, validity, fractions[ring], values[ring], force[ring], "" if alike else ring
            )
        )
    return found


def _fraction(validity: Validity, values: Array, force: Array) -> float:
    """Share of the force that lies outside of a bound; what is not known lies inside."""
    total = float(force.sum())
    return (
        min(float(force[validity.excess(values) > 0.0].sum()) / total, 1.0) if total > 0.0 else 0.0
    )


def _outside(
    label: str, validity: Validity, fraction: float, values: Array, force: Array, ring: str
) -> Outside:
    spread = tuple[float, ...]()
    middle = math.nan
    detail = ""
    if fraction > 0.0:
        beyond = validity.excess(values) > 0.0
        low, middle, high = _quantiles(values[beyond], force[beyond], (0.05, 0.5, 0.95))
        spread = low, high
    if validity.quantity == "film_regime" and fraction > 0.0:
        parts = {
            LONG_NAMES[name]: float(force[values == code].sum() / force.sum())
            for code, name in enumerate(NAMES)
        }
        told = (name for name in parts if parts[name] > 0.0 and name not in validity.bound)
        detail = " and ".join(f"{_percent(parts[name])} {name}" for name in told)
    known = not bool(np.isnan(values).all())
    return Outside(
        law=label,
        validity=validity,
        fraction=fraction,
        values=spread,
        middle=middle,
        ring=ring,
        detail=detail,
        known=known,
    )


def _quantiles(values: Array, weight: Array, places: Sequence[float]) -> tuple[float, ...]:
    order = np.argsort(values)
    below = np.cumsum(weight[order])
    return tuple(float(values[order][np.searchsorted(below, at * below[-1])]) for at in places)


def difference(
    traction: TractionModel, tables: Sequence[Filled], assembly: Assembly
) -> Difference | None:
    """Return how far the law of the full film is off the one that it approximates, within the friction of a contact."""
    law = traction.full_film
    if law.solved_by is None or assembly.resolution.traction != "named":
        return None
    cls = type(law)
    reference = get_class("traction", law.solved_by)
    given = {a.name for a in attrs.fields(cls)} & {a.name for a in attrs.fields(reference)}  # type: ignore[arg-type]
    exact = reference(**{name: getattr(law, name) for name in given})
    models = assembly.inner.chain.models
    chain = Chain(
        *(m.with_full_film(exact) if isinstance(m, TractionModel) else m for m in models),
        compiled=assembly.resolution.compiled,
    )
    found = []
    for table in tables:
        own = table.slices
        force = table.force
        columns = {name: getattr(own, name) for name in ("load", "rolling_speed", "sliding_speed")}
        columns |= {name: getattr(own, name) for name in (PLACES if chain.placed else ())}
        other = Slices(len(own), own.conditions, **columns)
        chain(other)
        size = np.add.reduceat(force * np.abs(other.friction), table.starts)
        more = np.add.reduceat(
            force * (np.abs(own.friction) - np.abs(other.friction)), table.starts
        )
        found.append(more[size > 0.0] / size[size > 0.0])
    off = np.concatenate(found) if found else np.empty(0)
    if off.size == 0:
        return None
    return Difference(
        law=law.name,
        reference=exact.name,
        key=_key_of(law, traction),
        rms=float(np.sqrt((off**2).mean())),
        mean=float(off.mean()),
        largest=float(off[np.argmax(np.abs(off))]),
    )


def _key_of(law: TractionModel, traction: TractionModel) -> str:
    """Return the key of the scene under which a law stands: that of the traction, or of a submodel of it."""
    cls: Any = type(traction)
    child = "".join(f".{a.name}" for a in attrs.fields(cls) if getattr(traction, a.name) is law)
    return f"models.traction{child}"


def told(
    found: Sequence[Outside],
    off: Difference | None,
    where: str = "",
    what: str = "of the contact force",
    tolerance: float = 0.0,
) -> list[Told]:
    """Return what was left, with share, consequence and remedy, by consequence; no sentence has its full stop."""
    said = list[Told]()
    for one in sorted(found, key=lambda each: (each.counted, -each.weight)):
        if one.fraction < REPORTED_FROM or (off is not None and _told_with(one, off)):
            continue
        ring = f" of the {one.ring} ring" if one.ring else ""
        detail = f" ({one.detail})" if one.detail else ""
        left = f"{_percent(one.fraction)} {what}{ring} is"
        if left.startswith("100 % of the contact force"):
            left = f"all loaded contacts{ring} are"
        text = (
            f"{one.law} is valid for {bound_of(one.validity)}; {left} outside"
            f"{f' {where}' if where else ''}{detail}, where {one.validity.consequence_at(*one.values)}; "
            f"remedy: {one.validity.remedy}"
        )
        short = f"{one.law} ({bound_of(one.validity)}; {_percent(one.fraction)} outside)"
        warned = not one.counted and one.weight > tolerance
        said.append(
            Told(
                law=one.law,
                made_for=bound_of(one.validity),
                weight=one.weight,
                text=text,
                short=short,
                warned=warned,
                code=one.validity.code,
            )
        )
    if off is not None:
        text = _off(off, found, where, what)
        short = f"{off.law!r} for {off.reference!r}"
        first = Told(
            law=off.law,
            made_for=off.reference,
            weight=off.rms,
            text=text,
            short=short,
            warned=off.rms > tolerance,
            measured=True,
            code=APPROXIMATION,
        )
        said.insert(0 if first.warned else len(said), first)
    return said


def sentences(said: Sequence[Told], tolerance: float = 0.0) -> list[str]:
    """Return the warnings of what was left, and one sentence that counts the rest; none has its full stop."""
    rest = [one.short for one in said if not one.warned]
    texts = [one.text for one in said if one.warned]
    if not rest:
        return texts
    below = f" or below accuracy.tolerance = {tolerance:g}" if tolerance > 0.0 else ""
    return [
        *texts,
        f"{OTHER_BOUNDS} not known{below}: {'; '.join(rest)}; rollslip run of the scene tells of each",
    ]


def _percent(fraction: float) -> str:
    return f"{100.0 * fraction:.0f} %"


def bound_of(validity: Validity) -> str:
    """Return a bound in words: "load parameter M >= 2", "pressure <= 100 MPa"."""
    if validity.made_for:
        return validity.made_for
    name, unit = symbol_of(validity.quantity)
    name = validity.called or name
    if unit == "1":
        return f"{name} {validity.bound}"
    ends = ((">=", validity.low), ("<=", validity.high))
    return f"{name} {' and '.join(f'{sign} {format_quantity(x, unit, 3)}' for sign, x in ends if np.isfinite(x))}"


def _told_with(one: Outside, off: Difference) -> bool:
    """Whether a bound is one of the approximation itself, whose error is known already."""
    return one.law == f"traction {off.law!r}" and one.validity.quantity not in {
        *QUANTITIES,
        *COLUMNS,
        *CONDITIONS,
    }


def _off(off: Difference, found: Sequence[Outside], where: str, what: str) -> str:
    bounds = [
        f"{_percent(one.fraction)} at {bound_of(one.validity).replace('<=', '>').replace('>=', '<')}"
        for one in found
        if _told_with(one, off) and one.fraction >= REPORTED_FROM
    ]
    beyond = f", with {' and '.join(bounds)} {what}" if bounds else ""
    rms, mean, largest = (100.0 * fraction for fraction in (off.rms, off.mean, off.largest))
    return (
        f"the friction of {off.law!r} is {rms:.2g} % (rms) off that of {off.reference!r}, the law that it "
        f"approximates, {where or 'on these slices'}: {mean:+.2g} % in the mean, {largest:+.2g} % at most{beyond}; "
        f"remedy: {off.key} = {off.reference!r}"
    )


def corrections(film: FilmModel) -> list[str]:
    """Say that want of oil thins the film, which a reader must know who compares it with others."""
    said = f"want of oil in the inlets, by lubrication or models.film, thins the film by {film.inlet_starvation}"
    return [said] if film.inlet_starvation else []


def record(
    found: Sequence[Outside], off: Difference | None, said: Sequence[Told] = ()
) -> dict[str, Any]:
    """Return all as plain values: each bound with its share, what the law is off, and how it is told; NaN is None."""
    rows = [
        {
            "code": one.validity.code,
            "law": one.law,
            "made_for": bound_of(one.validity),
            "fraction_outside": one.fraction if one.known else None,
            "ring": one.ring,
            "values_outside": list(one.values),
            "consequence": one.validity.consequence_at(*one.values)
            if one.values
            else one.validity.told,
            "remedy": one.validity.remedy,
            "source": one.validity.source,
        }
        for one in found
    ]
    return {
        "bounds": rows,
        "approximation": None if off is None else attrs.asdict(off),
        "told": [attrs.asdict(one) for one in said],
    }


def rolling_slices(assembly: Assembly) -> list[LoadedSlices]:
    """Return the loaded slices of both rings at the first instant, where the bearing rolls without slip."""
    loads = assembly.load_distribution(1)
    speeds = assembly.kinematics.surface_speeds(0.0, 0.0)
    found = []
    for raceway, load, rolling in (
        (assembly.inner, loads.inner_load, speeds.inner_rolling),
        (assembly.outer, loads.outer_load, speeds.outer_rolling),
    ):
        places = assembly.places(raceway.ring, loads.psi[0], np.arange(float(loads.psi.shape[1])))
        one = LoadedContacts(raceway, load[0], assembly.widths, 1.0, places=places)
        found.append(
            LoadedSlices(0, raceway.ring, one.load, float(rolling), 0.0, one.force, one.places)
        )
    return found
