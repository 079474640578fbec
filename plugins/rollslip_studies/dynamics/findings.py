"""What a motion in time says: its single values as a record, tables and sentences, from the dataset alone."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account, Contact, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.words import EFFECTIVE_FRICTION_ERROR, describe_skidding, percent
from rollslip.search import Array
from rollslip.units import format_quantity
from rollslip_studies.dynamics import history_findings
from rollslip_studies.dynamics.history_findings import format_energy
from rollslip_studies.steady_slip.findings import next_of_others
from rollslip_studies.surface_damage import findings as damage

if TYPE_CHECKING:
    import xarray as xr


#: An event is the passing of the slip at which the cage runs away if this stands in what it is called.
SKIDDING: Final = "skidding"
#: Attributes of a result on the onset of skidding: slip, drag and status.
ONSET: Final = ("skidding_slip", "limit_drag", "skidding_status")
#: Entries of the ledger, as the kernels call them, in words.
_ENTRIES: Final = {
    "work_rings": "rings",
    "work_load": "load",
    "work_gravity": "weight",
    "work_drag": "drag",
    "work_raceway_elastic": "elasticity of the raceways",
    "work_cage_elastic": "elasticity of the cage's contacts",
    "lost_inner": "sliding at the inner ring",
    "lost_outer": "sliding at the outer ring",
    "lost_rolling": "rolling resistance",
    "lost_damping": "damping of the raceways",
    "lost_pockets": "pockets",
    "lost_land": "lands of the cage",
}
#: Attributes that count what a motion took.
_COUNTS: Final = ("steps", "rejected", "rate_evaluations", "jacobians", "contacts_evaluated")
#: Share of the slip of running away from which on effective friction is not trusted.
_NEAR: Final = 0.5
#: What a result of an older version says.
_OLD: Final = "this result does not say where skidding begins; run it again"
#: Kinds of events that are spoken of one by one; the others are counted.
_KINDS = 5


def unslipped_cage_speed(dataset: "xr.Dataset") -> float:
    """Cage speed of pure rolling [rad/s], NaN if the cage stood still all the time."""
    return _unslipped(dataset["cage_speed"].to_numpy(), dataset["cage_slip"].to_numpy())


def unslipped_roller_speed(dataset: "xr.Dataset") -> float:
    """Spin of a roller of pure rolling, relative to the cage [rad/s]; NaN if none ever turned."""
    return _unslipped(
        dataset["roller_speed"].to_numpy().ravel(), dataset["roller_slip"].to_numpy().ravel()
    )


def _unslipped(speed: Array, slip: Array) -> float:
    turning = np.abs(1.0 - slip) > 1e-3  # else the quotient is rounding
    return float(np.median(speed[turning] / (1.0 - slip[turning]))) if np.any(turning) else math.nan


def ledger(dataset: "xr.Dataset") -> dict[str, Array]:
    """Return the work since the start [J] of each entry of the ledger, by its name in words; none that did nothing."""
    return {
        _ENTRIES.get(str(name), str(name)): work
        for name, work in zip(
            dataset["work"].to_numpy(), dataset["work_done"].to_numpy(), strict=True
        )
        if np.any(work != 0.0)
    }


def turnover(dataset: "xr.Dataset") -> float:
    """Energy that was turned over since the start [J]: what came in, which is also what went out or was stored."""
    works = np.abs(dataset["work_done"].isel(time=-1).to_numpy()).sum()
    energy = dataset["energy"].to_numpy()
    return 0.5 * float(works + abs(energy[-1] - energy[0]))


def energy_closure(dataset: "xr.Dataset") -> float:
    """Largest residual of the energy ledger over the energy turned over; NaN if none was."""
    return _over(dataset["energy_residual"], turnover(dataset))


def momentum_closure(dataset: "xr.Dataset") -> float:
    """Largest residual of the angular momentum over its largest value; NaN if there was none."""
    return _over(dataset["momentum_residual"], float(np.abs(dataset["angular_momentum"]).max()))


def _over(residual: "xr.DataArray", size: float) -> float:
    return float(np.abs(residual).max()) / size if size > 0.0 else math.nan


def smallest_film(dataset: "xr.Dataset") -> dict[str, float]:
    """Smallest film parameter at each ring, NaN where it is not known or no roller was loaded."""
    films = {
        str(ring): dataset["film_parameter"].sel(ring=ring).to_numpy()
        for ring in dataset["ring"].to_numpy()
    }
    return {
        ring: float(np.nanmin(film)) if np.any(np.isfinite(film)) else math.nan
        for ring, film in films.items()
    }


class DynamicsAccount(Account):
    """How a motion is told: with its energy ledger and its events."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "level": ("level of the motion", ""),
        "friction": ("friction of the motion", ""),
        "integrator": ("integrator", ""),
        "steps": ("steps", ""),
        "rejected": ("steps rejected", ""),
        "rate_evaluations": ("evaluations of the rates", ""),
        "jacobians": ("Jacobians", ""),
        "contacts_evaluated": ("contacts evaluated in the motion", ""),
        "real_time_factor": ("time of the motion over that of its integration", "1"),
    }
    units: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("end_time", "largest_cage_slip_time", "smallest_cage_slip_time", "smallest_margin_time",
                         "time", "time_beyond_skidding"), "s"),
        **dict.fromkeys(("critical_cage_slip", "energy_closure", "final_cage_slip", "largest_cage_slip",
                         "smallest_cage_slip", "smallest_margin_to_skidding", "momentum_closure", "skidding_slip",
                         "smallest_film_parameter_inner", "smallest_film_parameter_outer", "steady_cage_slip"), "1"),
        **dict.fromkeys(("energy_turned_over", "frictional_work_inner", "frictional_work_outer", "heat_carried_away",
                         "heat_made", "heat_stored"), "J"),
        "limit_drag": "N m", "sliding_distance_inner": "m", "sliding_distance_outer": "m",
        "final_temperatures": "K", "hottest_temperature": "K",
    }  # fmt: skip
    drawn = ".figures:motion_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the slip at the end, along a history the largest, and measures of damage on the way."""
        slip = history_findings.row(dataset) if history_findings.along(dataset) else row(dataset)
        cut = dataset.attrs["outcome"] in ("failed", "interrupted")
        faults = (outcome(dataset).partition(": ")[2],) if cut else ()
        return Answer(
            rows=(slip, *damage.rows(dataset)), commands=next_of_others(dataset), faults=faults
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what a motion found, by what it is about, the most important first; no sentence has its full stop."""
        said = {
            "motion": [outcome(dataset)],
            "steady slip": [_steady(dataset)],
            "skidding": _skidding_sentences(dataset),
            "slip at largest traction": [_critical(dataset)],
            "largest slip": [_largest(dataset)],
            "events": _events(dataset),
            "film": [_films(dataset)],
            "cage": _cage(dataset),
            "steps": _steps(dataset),
            "ledger": [_ledger(dataset)],
            "cost": [_cost(dataset)],
        }
        told = {about: texts for about, texts in said.items() if texts}
        return history_findings.told(dataset, told) | damage.over_motion(dataset)

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values of a motion; what has no value is None."""
        a = dataset.attrs
        slip = dataset["cage_slip"].to_numpy()
        values: dict[str, Any] = {
            "outcome": str(a["outcome"]),
            "outcome_message": str(a["outcome_message"]),
            "level": str(a["level"]),
            "friction": str(a["friction"]),
            "integrator": str(a["integrator"]),
            "end_time": float(dataset["time"][-1]),
            "steady_cage_slip": float(a["steady_cage_slip"]),
            "steady_status": str(a["steady_status"]),
            "largest_cage_slip": float(np.nanmax(slip)) if np.isfinite(slip).any() else math.nan,
            "final_cage_slip": float(slip[-1]),
            **dict(zip(ONSET, _away(a), strict=True)),
            "critical_cage_slip": float(a["critical_cage_slip"]),
            "critical_status": str(a["critical_status"]),
            **{
                f"smallest_film_parameter_{ring}": film
                for ring, film in smallest_film(dataset).items()
            },
            "energy_turned_over": turnover(dataset),
            "energy_closure": energy_closure(dataset),
            "momentum_closure": momentum_closure(dataset),
            **{name: int(a[name]) for name in _COUNTS},
            "real_time_factor": float(a["real_time_factor"]),
        }
        events: list[dict[str, Any]] = [
            {"time": time, "what": what, "rising": rising}
            for what, passages in _passages(dataset).items()
            for time, rising in passages
        ]
        return {
            **history_findings.without_nan(values),
            "events": sorted(events, key=lambda event: float(event["time"])),
            **history_findings.record(dataset),
            **history_findings.heat_record(dataset),
            **damage.record(dataset),
        }

    def tables(self, dataset: "xr.Dataset") -> list[Table]:
        """Return the energy ledger, and the events by kind: how often, when first and last."""
        events = [
            [what, str(len(p)), *(f"{time:.4g} s" for time in (min(p)[0], max(p)[0]))]
            for what, p in _passages(dataset).items()
        ]
        return [
            Table("Energy ledger", *ledger_table(dataset)),
            Table("Events", ("event", "times", "first", "last"), events),
        ]

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts with both rings."""
        return [Contact(f"{ring} ring", "", film) for ring, film in smallest_film(dataset).items()]


def _passages(dataset: "xr.Dataset") -> dict[str, list[tuple[float, bool]]]:
    """Events by what they are called: times, and whether they were passed while rising."""
    found: dict[str, list[tuple[float, bool]]] = {}
    columns = (dataset[name].to_numpy() for name in ("event_what", "event_time", "event_rising"))
    for what, time, rising in zip(*columns, strict=True):
        found.setdefault(str(what), []).append((float(time), bool(rising)))
    return found


def _away(attributes: Mapping[str, Any]) -> tuple[float, float, str]:
    """Where the cage runs away: slip, drag and status."""
    slip, drag = (float(attributes.get(name, math.nan)) for name in ONSET[:2])
    return slip, drag, str(attributes.get("skidding_status", _OLD))


def headline(dataset: "xr.Dataset") -> str:
    """Say where the cage runs away."""
    return describe_skidding(*_away(dataset.attrs))


def skidding_slip(dataset: "xr.Dataset") -> float:
    """Cage slip at which the cage runs away, NaN where it is not known."""
    return _away(dataset.attrs)[0]


def skidding_passages(dataset: "xr.Dataset") -> list[tuple[float, bool]]:
    """Times at which cage slip passed that at which the cage runs away, in order, and whether it was rising."""
    return sorted(
        p for what, passages in _passages(dataset).items() if SKIDDING in what for p in passages
    )


def ledger_table(dataset: "xr.Dataset") -> tuple[tuple[str, ...], list[list[str]]]:
    """Return head and rows of the energy ledger at the end."""
    size = turnover(dataset)
    energy = dataset["energy"].to_numpy()
    entries = {name: float(work[-1]) for name, work in ledger(dataset).items()}
    entries |= {
        "kept in the motion": float(energy[-1] - energy[0]),
        "residual": float(dataset["energy_residual"][-1]),
    }
    return ("energy since the start", "", "of what was turned over"), [
        [name, format_energy(value), f"{100 * value / size:+.3g} %" if size > 0.0 else "–"]
        for name, value in entries.items()
    ]


def compared(datasets: "Mapping[str, xr.Dataset]") -> list[str]:
    """Say how motions of one bearing differ from the first of them: steady slip, speed on the way, time they took."""
    (first, reference), *others = datasets.items()
    said = [f"{name}: {_steady(dataset)}" for name, dataset in datasets.items()]
    for name, dataset in others:
        gap = np.abs(difference(reference, dataset, "cage_speed")).max(initial=0.0)
        said.append(
            f"the cage speed of {name} is never further than {_fraction(gap)} of its largest from that of {first}"
        )
        steady = [1.0 - float(one.attrs["steady_cage_slip"]) for one in (dataset, reference)]
        if _is_steady(reference) and _is_steady(dataset) and steady[1] != 0.0:
            said.append(
                f"the steady cage speed of {name} differs by {100 * (steady[0] / steady[1] - 1.0):+.2g} %"
            )
        speeds = [float(one.attrs["real_time_factor"]) for one in (dataset, reference)]
        if min(speeds) > 0.0 and max(speeds) < math.inf:
            said.append(f"{name} is {speeds[0] / speeds[1]:.3g} times as fast as {first}")
    return said


def difference(reference: "xr.Dataset", dataset: "xr.Dataset", name: str) -> Array:
    """Difference of a speed from that of a reference over the reference's largest, at the instants that both cover.

    A speed of many rollers is that of their mean. The result has a value for each instant of the reference up to the
    last of the shorter motion.
    """
    times = common_times(reference, dataset)
    one, other = (
        np.interp(
            times,
            run["time"].to_numpy(),
            run[name].to_numpy().reshape(run.sizes["time"], -1).mean(axis=1),
        )
        for run in (reference, dataset)
    )
    largest = float(np.abs(reference[name]).max())
    return np.asarray((other - one) / largest if largest > 0.0 else other - one)


def common_times(reference: "xr.Dataset", dataset: "xr.Dataset") -> Array:
    """Instants of a reference that another motion covers too."""
    times = reference["time"].to_numpy()
    others = dataset["time"].to_numpy()
    return np.asarray(times[(times >= others[0]) & (times <= others[-1])])


# Sentences ----------------------------------------------------------------------------------------------------------


def _fraction(value: float) -> str:
    return f"{100 * value:.3g} %"


def _time(seconds: float) -> str:
    return f"t = {seconds:.3g} s"


def outcome(dataset: "xr.Dataset") -> str:
    """Say how the motion ended, and why if it did not come to its end."""
    a = dataset.attrs
    who = f"{a['level']}, {a['friction']} friction, {a['integrator']}"
    end = f"{a['outcome']} at {_time(float(dataset['time'][-1]))}"
    why = str(a["outcome_message"]).strip().rstrip(".") or "no reason is known"
    if a["outcome"] == "finished":
        return f"{who}: {end}"
    return f"{who}: {why if why.startswith(a['outcome']) else f'{end}: {why}'}; what was computed is kept"


def _is_steady(dataset: "xr.Dataset") -> bool:
    return bool(dataset.attrs["steady_status"] == "steady")


def row(dataset: "xr.Dataset") -> Row:
    """Return the row of the slip at the end; none is known of a motion that is not steady."""
    slip = float(dataset.attrs["steady_cage_slip"]) if _is_steady(dataset) else math.nan
    if math.isnan(slip):
        return Row(key="cage_slip", label="cage slip", text="not steady", note=_steady(dataset))
    return Row(key="cage_slip", label="cage slip", value=slip, text=percent(slip), note="mean of the last orbit",
               known=1, within=0.1)  # fmt: skip


def _steady(dataset: "xr.Dataset") -> str:
    a = dataset.attrs
    if _is_steady(dataset):
        return f"steady cage slip {_fraction(float(a['steady_cage_slip']))}, the mean of the last orbit"
    why = str(a["steady_status"])
    what = f"cage slip is {why}" if why.startswith("not ") else f"no steady cage slip: {why}"
    last = float(dataset["cage_slip"][-1])
    return what if math.isnan(last) else f"{what}; at the end it is {_fraction(last)}"


def _critical(dataset: "xr.Dataset") -> str:
    a = dataset.attrs
    critical = float(a["critical_cage_slip"])
    rests_on = str(a.get("curves_with", ""))
    if math.isnan(critical):
        said = f"slip at largest traction of the inner ring's friction curve unknown: {a['critical_status']}"
    else:
        said = f"slip at largest traction of the inner ring's friction curve {_fraction(critical)} {rests_on}".rstrip()
    first = float(a.get("first_maximum_slip", math.nan))
    if first < (math.inf if math.isnan(critical) else critical):
        said += f"; friction falls already from a slip of {_fraction(first)} on, then rises again"
    return said


def _skidding_sentences(dataset: "xr.Dataset") -> list[str]:
    a = dataset.attrs
    slip = dataset["cage_slip"].to_numpy()
    away = skidding_slip(dataset)
    said = [headline(dataset)]
    if math.isnan(away):
        return said
    if a["friction"] == "effective" and slip.max() > _NEAR * away:
        said.append(
            f"{EFFECTIVE_FRICTION_ERROR}, and slip comes near: run with --set study.{a['study']}.friction=conventional to be sure"
        )
    value = f"the {_fraction(away)} at which skidding begins"
    passages = skidding_passages(dataset)
    if not passages:
        return [*said, f"cage slip stays {'below' if slip.max() <= away else 'beyond'} {value}"]
    begun = len(said)
    said += (
        [f"cage slip begins at {_fraction(float(slip[0]))}, beyond {value}"]
        if slip[0] > away
        else []
    )
    for k, (time, rising) in enumerate(passages):
        if not rising:
            said.append(f"cage slip fell below {value} at {_time(time)}")
            continue
        sentence = f"cage slip passed {value} at {_time(time)} while rising: the rollers' drive falls from there on, "
        if k + 1 < len(passages):
            sentence += "but the cage came back"
        elif _is_steady(dataset):
            sentence += "but the cage settled beyond it"
        elif a["outcome"] == "stopped":
            sentence += "and the cage was beyond it when the run was stopped"
        elif slip[-1] >= slip.max():
            sentence += "and the cage still skids at the end"
        else:
            sentence += "and the cage was still beyond it at the end"
        said.append(sentence)
    if len(said) - begun > _KINDS:
        between = f"it passed {value} {len(said) - begun - 2} more times in between"
        said = [*said[: begun + 1], between, said[-1]]
    return said


def _largest(dataset: "xr.Dataset") -> str:
    times, cage, rollers = (
        dataset[name].to_numpy() for name in ("time", "cage_slip", "roller_slip")
    )
    k = int(np.argmax(cage))
    i, j = np.unravel_index(np.argmax(rollers), rollers.shape)
    return (
        f"largest cage slip {_fraction(float(cage[k]))} at {_time(times[k])}; largest slip of a roller "
        f"{_fraction(float(rollers[i, j]))}, roller {dataset['roller'].to_numpy()[j]} at {_time(times[i])}"
    )


def _events(dataset: "xr.Dataset") -> list[str]:
    said = []
    others = [(what, sorted(p)) for what, p in _passages(dataset).items() if SKIDDING not in what]
    for what, passages in others[:_KINDS]:
        times = [time for time, _ in passages]
        many = f"{len(times)} times, first at {_time(times[0])}, last at {_time(times[-1])}"
        said.append(f"{what}: {many if len(times) > 1 else f'at {_time(times[0])}'}")
    if len(others) > _KINDS:
        rest = sum(len(passages) for _, passages in others[_KINDS:])
        said.append(f"{rest} more events of {len(others) - _KINDS} other kinds")
    return said


def _films(dataset: "xr.Dataset") -> str:
    known = {ring: film for ring, film in smallest_film(dataset).items() if not math.isnan(film)}
    if not known:
        loaded = bool(np.any(dataset["normal_force"].to_numpy() > 0.0))
        why = dataset["film_parameter"].attrs["film_status"] if loaded else "no roller was loaded"
        return f"film parameter unknown: {why}"
    return "smallest film parameter " + ", ".join(
        f"{film:.3g} at the {ring} ring" for ring, film in known.items()
    )


def _cage(dataset: "xr.Dataset") -> list[str]:
    drags = json.loads(dataset.attrs["drag"])
    named = "; ".join(f"{one['name']}, {one['equation']}" for one in drags)
    said = [f"drag on the cage: {named}" if drags else "no drag on the cage: nothing holds it back"]
    if "pocket_force" in dataset:
        largest = format_quantity(float(np.abs(dataset["pocket_force"]).max()), "N", 3)
        said.append(f"largest force between a roller and the cage {largest}")
    if "land_eccentricity" in dataset:
        said.append(
            f"largest eccentricity of the cage on its lands {float(dataset['land_eccentricity'].max()):.3g}"
        )
    return said


def _steps(dataset: "xr.Dataset") -> list[str]:
    rows = json.loads(dataset.attrs.get("accuracy", "[]"))
    return [
        f"the cage speed may be off by {row['estimated']:.1e} of its largest at an instant, more than the tolerance of "
        f"{row['tolerance']:g}, as motions with other steps come apart; raise accuracy.cage_speed"
        for row in rows
        if row["result"] == "cage_speed" and (row["estimated"] or 0.0) > row["tolerance"]
    ]


def _ledger(dataset: "xr.Dataset") -> str:
    size = turnover(dataset)
    momentum = momentum_closure(dataset)
    if size > 0.0:
        said = f"the energy ledger closes to {energy_closure(dataset):.1e} of the {format_energy(size)} turned over"
    else:
        said = "no energy was turned over"
    return (
        said
        if math.isnan(momentum)
        else f"{said}, angular momentum to {momentum:.1e} of its largest"
    )


def _cost(dataset: "xr.Dataset") -> str:
    a = dataset.attrs
    rejected = f"{a['rejected']:,} rejected" if a["rejected"] >= 0 else "rejected ones not counted"
    factor = float(a["real_time_factor"])
    speed = (
        f"{factor:.3g} times as fast as real time"
        if 1.0 <= factor < math.inf
        else f"{1.0 / factor:.3g} times slower than real time"
        if 0.0 < factor < 1.0
        else "its time was not taken"
    )
    return (
        f"{a['steps']:,} steps ({rejected}), {a['rate_evaluations']:,} evaluations of the rates, {a['jacobians']:,} "
        f"Jacobians, {a['contacts_evaluated']:,} contacts evaluated; {speed}{_held(a)}"
    )


def _held(attributes: Mapping[str, Any]) -> str:
    """For how long friction was held, and by how much it was off then; empty where it was evaluated every time."""
    if "friction_held" not in attributes:
        return ""
    held, off, most = (attributes[f"friction_{what}"] for what in ("held", "off", "most_off"))
    return (
        f"; friction was evaluated every {held:.2g} s, linear in speed and time in between, and off by {off:.1e} of it "
        f"when it was again, by {most:.1e} at most"
    )


ACCOUNT: Final = DynamicsAccount("dynamics")
