"""Results of a motion as record, tables and sentences, from its dataset alone."""

import json
import math
import re
from collections.abc import Mapping
from typing import Any, ClassVar, Final, Literal

import numpy as np

from rollslip.results.account import Account, Contact, Table
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.results.text import (
    EFFECTIVE_FRICTION_ERROR,
    SMALLEST_SLIP,
    describe_skidding,
    percent,
    precise_percent,
)
from rollslip.results.verdict import Verdict
from rollslip.search import Array
from rollslip.units import format_quantity
from rollslip_studies.dynamics import history_findings
from rollslip_studies.steady_slip.findings import next_of_others, reserve_row
from rollslip_studies.surface_damage import findings as damage

#: Option for a run that is longer, or stores more, in the status of a slip that is not known to be steady.
_LONGER: Final = re.compile(r"; (?:run longer|store more) with (--set [^\s;]+)")
#: Part of the names of events that are passages of the slip at which skidding begins.
SKIDDING: Final = "skidding"
#: Attributes of a result on the onset of skidding: slip, drag and status.
ONSET: Final = ("skidding_slip", "limit_drag", "skidding_status")
#: Entry of the ledger in the kernels -> its name in tables and figures.
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
#: Attributes that count the work of the integration.
_COUNTS: Final = ("steps", "rejected", "rate_evaluations", "jacobians", "contacts_evaluated")
#: Fraction of the skidding slip from which on effective friction is doubted: its limit drag errs by up to 23 %
#: (docs/trust/skidding.rst). Doubled, the advice comes only when the cage skids. Chosen.
_NEAR_SKIDDING: Final = 0.5
#: Slip below which effective friction is doubted, and what it adds there at most (docs/tables/effective_slip.csv).
#: Doubled, slips of up to 10 % are doubted, of which it changes two by 2 and 13 %.
_SMALL_SLIP: Final = 0.05
_SMALL_SLIP_ERROR: Final = "40 %"
#: Least ratio of a speed to that without slip from which the latter is computed. Halved, rounding counts twice as much.
#: Chosen.
_MIN_SPEED_RATIO: Final = 1e-3
#: Rank of the slip and the reserve among those of other studies; that of study steady-slip is higher.
_RANK: Final = 1
#: Relative error of both, up to which another study agrees. Halved, 5 % count as a disagreement, of which steady slips
#: with play and motions have up to 4 % (tests/studies/test_pockets.py); doubled, differences of a fifth do not. Chosen.
_TOLERANCE: Final = 0.1
#: Status of skidding of results of versions that did not compute it.
_UNKNOWN_STATUS: Final = "this result does not say where skidding begins; run it again"
#: Kinds of events, and passages of the skidding slip, that have a sentence each; further ones are counted. Doubled,
#: answers get up to ten lines longer. Chosen.
_MAX_SENTENCES = 5


def median_epicyclic_speed(dataset: "xr.Dataset", part: Literal["cage", "roller"]) -> float:
    """Return the speed of cage or rollers without slip [rad/s], the median over all samples with a speed; or NaN."""
    speed, slip = (dataset[f"{part}_{name}"].to_numpy().ravel() for name in ("speed", "slip"))
    turning = np.abs(1.0 - slip) > _MIN_SPEED_RATIO
    return float(np.median(speed[turning] / (1.0 - slip[turning]))) if np.any(turning) else math.nan


def ledger(dataset: "xr.Dataset") -> dict[str, Array]:
    """Return the work since the start [J] of each entry of the ledger, by its name; no entry without work."""
    return {
        _ENTRIES.get(str(name), str(name)): work
        for name, work in zip(
            dataset["work"].to_numpy(), dataset["work_done"].to_numpy(), strict=True
        )
        if np.any(work != 0.0)
    }


def turnover(dataset: "xr.Dataset") -> float:
    """Return the energy turnover since the start [J]: the input, which is output and stored energy, too."""
    works = np.abs(dataset["work_done"].isel(time=-1).to_numpy()).sum()
    energy = dataset["energy"].to_numpy()
    return 0.5 * float(works + abs(energy[-1] - energy[0]))


def energy_closure(dataset: "xr.Dataset") -> float:
    """Return the largest residual of the energy ledger over the energy turnover; NaN without turnover."""
    return _relative_residual(dataset["energy_residual"], turnover(dataset))


def momentum_closure(dataset: "xr.Dataset") -> float:
    """Return the largest residual of the angular momentum over its largest value; NaN without angular momentum."""
    return _relative_residual(
        dataset["momentum_residual"], float(np.abs(dataset["angular_momentum"]).max())
    )


def _relative_residual(residual: "xr.DataArray", size: float) -> float:
    """Return the largest residual over a size; NaN if that is 0."""
    return float(np.abs(residual).max()) / size if size > 0.0 else math.nan


def smallest_film(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the smallest film parameter at each ring; NaN if it is not known, or no roller was loaded."""
    return {
        str(ring): float(dataset["film_parameter"].sel(ring=ring).min())
        for ring in dataset["ring"].to_numpy()
    }


class DynamicsAccount(Account):
    """Answer, topics, record and tables of a motion, with its energy ledger and its events."""

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
                         "smallest_film_parameter_inner", "smallest_film_parameter_outer", "steady_cage_slip",
                         "steady_slip_error", "drag_reserve"), "1"),
        **dict.fromkeys(("energy_turned_over", "frictional_work_inner", "frictional_work_outer", "heat_carried_away",
                         "heat_made", "heat_stored"), "J"),
        "limit_drag": "N m", "sliding_distance_inner": "m", "sliding_distance_outer": "m",
        "final_temperatures": "K", "hottest_temperature": "K",
    }  # fmt: skip
    figures_function = ".figures:motion_figures"
    together_function = ".figures:motions_together"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the slip at the end, along a history the largest slip, and the measures of damage."""
        slips = (
            [history_findings.row(dataset)]
            if history_findings.has_history(dataset)
            else steady_rows(dataset)
        )
        ended_early = dataset.attrs["outcome"] in ("failed", "interrupted")
        faults = (outcome(dataset).partition(": ")[2],) if ended_early else ()
        commands = next_of_others(dataset)
        if longer := _LONGER.search(str(dataset.attrs["steady_status"])):
            step = f"rollslip run {{scene}} --study dynamics {longer[1]}"
            commands = {**commands, Verdict.UNKNOWN: (step,)}
        return Answer(rows=(*slips, *damage.rows(dataset)), commands=commands, faults=faults)

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the sentences on a motion by topic, the most important first; no sentence has its full stop."""
        sentences = {
            "motion": [outcome(dataset)],
            "steady slip": [_describe_steady_slip(dataset), *_describe_friction_error(dataset)],
            "skidding": _describe_skidding(dataset),
            "slip at largest traction": [_describe_critical_slip(dataset)],
            "largest slip": [_describe_largest_slips(dataset)],
            "events": _describe_events(dataset),
            "film": [_describe_films(dataset)],
            "cage": _describe_cage(dataset),
            "steps": _describe_step_error(dataset),
            "ledger": [_describe_ledger(dataset)],
            "cost": [_describe_cost(dataset)],
        }
        topics = {topic: texts for topic, texts in sentences.items() if texts}
        return history_findings.with_history_topics(dataset, topics) | damage.over_motion(dataset)

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values of a motion; None in place of NaN."""
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
            "steady_slip_error": float(a.get("steady_slip_error", math.nan)),
            "steady_status": str(a["steady_status"]),
            "drag_reserve": float(a.get("drag_reserve", math.nan)),
            "largest_cage_slip": float(dataset["cage_slip"].max()),
            "final_cage_slip": float(slip[-1]),
            **dict(zip(ONSET, _skidding_onset(a), strict=True)),
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
        """Return the energy ledger, and number, first and last time of the events of each kind."""
        events = [
            [what, str(len(passages)), f"{min(passages)[0]:.4g} s", f"{max(passages)[0]:.4g} s"]
            for what, passages in _passages(dataset).items()
        ]
        return [
            Table("Energy ledger", *ledger_table(dataset)),
            Table("Events", ("event", "times", "first", "last"), events),
        ]

    def contacts(self, dataset: "xr.Dataset") -> list[Contact]:
        """Return the contacts with both rings."""
        return [Contact(f"{ring} ring", "", film) for ring, film in smallest_film(dataset).items()]


def _passages(dataset: "xr.Dataset") -> dict[str, list[tuple[float, bool]]]:
    """Return time and direction (True while rising) of the events, by their meaning."""
    found: dict[str, list[tuple[float, bool]]] = {}
    for what, time, rising in zip(
        *(dataset[name].to_numpy() for name in ("event_what", "event_time", "event_rising")),
        strict=True,
    ):
        found.setdefault(str(what), []).append((float(time), bool(rising)))
    return found


def _skidding_onset(attributes: Mapping[str, Any]) -> tuple[float, float, str]:
    """Return slip, drag [N m] and status of the onset of skidding."""
    slip, drag = (float(attributes.get(name, math.nan)) for name in ONSET[:2])
    return slip, drag, str(attributes.get("skidding_status", _UNKNOWN_STATUS))


def skidding_slip(dataset: "xr.Dataset") -> float:
    """Return the cage slip at which skidding begins, NaN where it is not known."""
    return _skidding_onset(dataset.attrs)[0]


def skidding_passages(dataset: "xr.Dataset") -> list[tuple[float, bool]]:
    """Return times at which the cage slip passed the skidding slip, in order, and whether it was rising."""
    return sorted(
        passage
        for what, passages in _passages(dataset).items()
        if SKIDDING in what
        for passage in passages
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
        [
            name,
            format_quantity(value, "J", 4),
            f"{100 * value / size:+.3g} %" if size > 0.0 else "–",
        ]
        for name, value in entries.items()
    ]


def describe_differences(datasets: "Mapping[str, xr.Dataset]") -> list[str]:
    """Describe how motions of one bearing differ from the first: steady slip, speeds, time of the integration."""
    (first, reference), *others = datasets.items()
    sentences = [f"{name}: {_describe_steady_slip(dataset)}" for name, dataset in datasets.items()]
    reference_slip = float(reference.attrs["steady_cage_slip"])
    reference_factor = float(reference.attrs["real_time_factor"])
    for name, dataset in others:
        gap = np.abs(relative_difference(reference, dataset, "cage_speed")).max(initial=0.0)
        sentences.append(
            f"the cage speed of {name} is never further than {precise_percent(gap)} of its largest from that of {first}"
        )
        if _is_steady(reference) and _is_steady(dataset):
            change = float(dataset.attrs["steady_cage_slip"]) - reference_slip
            change /= max(abs(reference_slip), SMALLEST_SLIP)
            sentences.append(
                f"the steady cage slip of {name} differs by {100 * change:+.2g} % of that of {first}"
            )
        factor = float(dataset.attrs["real_time_factor"])
        if min(factor, reference_factor) > 0.0 and max(factor, reference_factor) < math.inf:
            sentences.append(f"{name} is {factor / reference_factor:.3g} times as fast as {first}")
    return sentences


def relative_difference(reference: "xr.Dataset", dataset: "xr.Dataset", name: str) -> Array:
    """Return the difference of a speed from that of a reference over the largest speed of the reference.

    A speed of many rollers is their mean. There is a value for each time of the reference that both motions cover.

    Parameters
    ----------
    reference : xarray.Dataset
        The result to compare with.
    dataset : xarray.Dataset
        The result.
    name : str
        Name of the speed.
    """
    reference_speed, speed = (
        np.interp(
            common_times(reference, dataset),
            run["time"].to_numpy(),
            run[name].to_numpy().reshape(run.sizes["time"], -1).mean(axis=1),
        )
        for run in (reference, dataset)
    )
    largest = float(np.abs(reference[name]).max())
    difference = speed - reference_speed
    return np.asarray(difference / largest if largest > 0.0 else difference)


def common_times(reference: "xr.Dataset", dataset: "xr.Dataset") -> Array:
    """Return the times of a reference that another motion covers, too."""
    times = reference["time"].to_numpy()
    others = dataset["time"].to_numpy()
    return np.asarray(times[(times >= others[0]) & (times <= others[-1])])


# Sentences ----------------------------------------------------------------------------------------------------------


def _time(seconds: float) -> str:
    """Return a time with its unit."""
    return f"t = {seconds:.3g} s"


def outcome(dataset: "xr.Dataset") -> str:
    """Describe how the motion ended, and why if it was not at its end."""
    a = dataset.attrs
    motion = f"{a['level']}, {a['friction']} friction, {a['integrator']}"
    end = f"{a['outcome']} at {_time(float(dataset['time'][-1]))}"
    reason = str(a["outcome_message"]).strip().rstrip(".") or "no reason is known"
    if a["outcome"] == "finished":
        return f"{motion}: {end}"
    text = reason if reason.startswith(a["outcome"]) else f"{end}: {reason}"
    return f"{motion}: {text}; what was computed is stored"


def _is_steady(dataset: "xr.Dataset") -> bool:
    """Return whether the slip of a motion is steady at its end."""
    return str(dataset.attrs["steady_status"]).startswith("steady")


def _describe_friction_error(dataset: "xr.Dataset") -> list[str]:
    """Describe the error of effective friction where the slip is small."""
    a = dataset.attrs
    slip = float(a["steady_cage_slip"])
    if a["friction"] != "effective" or not SMALLEST_SLIP <= slip < _SMALL_SLIP:
        return []
    return [
        f"effective friction may add up to {_SMALL_SLIP_ERROR} to slips below {precise_percent(_SMALL_SLIP)}: run with "
        f"--set study.{a['study']}.friction=conventional to be sure"
    ]


def _mean_of(dataset: "xr.Dataset") -> str:
    """Return what the steady slip of a motion is the mean of, with its error where it fluctuates."""
    status = str(dataset.attrs["steady_status"])
    return "mean of the last orbit" if status == "steady" else f"mean of a motion that is {status}"


def _relative_error(slip: float, error: float) -> float:
    """Return the relative error of a slip by its fluctuation, or that up to which another study agrees if larger."""
    if math.isnan(error) or slip == 0.0:
        return _TOLERANCE
    return max(_TOLERANCE, error / abs(slip))


def steady_rows(dataset: "xr.Dataset") -> list[Row]:
    """Return the rows of the steady slip and of the reserve to skidding; one without a value if nothing is steady.

    The band of the slip covers its error by the fluctuation, not the scatter of data.
    """
    a = dataset.attrs
    slip = float(a["steady_cage_slip"]) if _is_steady(dataset) else math.nan
    if math.isnan(slip):
        return [
            Row(
                key="cage_slip",
                label="cage slip",
                text="not steady",
                note=_LONGER.sub("", _describe_steady_slip(dataset)),
            )
        ]
    error = float(a.get("steady_slip_error", math.nan))
    mean_of = re.sub("(steady within .*?): .*", r"\1", _mean_of(dataset))
    steady = Row(key="cage_slip", label="cage slip", value=slip, text=percent(slip),
                 note=f"{mean_of}; scatter of data left out",
                 band=None if math.isnan(error) else (abs(slip) - error, abs(slip) + error),
                 rank=_RANK, tolerance=_relative_error(slip, error))  # fmt: skip
    if "drag_reserve" not in a:
        return [steady]
    reserve = reserve_row(
        float(a["drag_reserve"]),
        str(a["reserve_status"]),
        known=_RANK,
        within=_TOLERANCE,
        slip=slip,
    )
    return [steady, reserve]


def _describe_steady_slip(dataset: "xr.Dataset") -> str:
    """Describe the steady slip, or why the slip is not steady."""
    a = dataset.attrs
    if _is_steady(dataset):
        return f"steady cage slip {precise_percent(float(a['steady_cage_slip']))}, the {_mean_of(dataset)}"
    status = str(a["steady_status"])
    text = (
        f"cage slip is {status}" if status.startswith("not ") else f"no steady cage slip: {status}"
    )
    last = float(dataset["cage_slip"][-1])
    return text if math.isnan(last) else f"{text}; at the end it is {precise_percent(last)}"


def _describe_critical_slip(dataset: "xr.Dataset") -> str:
    """Describe the slip at the largest traction of the inner ring."""
    a = dataset.attrs
    critical = float(a["critical_cage_slip"])
    text = "slip at largest traction of the inner ring's friction curve"
    if math.isnan(critical):
        text = f"{text} unknown: {a['critical_status']}"
    else:
        text = f"{text} {precise_percent(critical)} {a.get('curves_with', '')}".rstrip()
    first = float(a.get("first_maximum_slip", math.nan))
    if first < (math.inf if math.isnan(critical) else critical):
        text += (
            f"; friction falls already from a slip of {precise_percent(first)} on, then rises again"
        )
    return text


def _describe_skidding(dataset: "xr.Dataset") -> list[str]:
    """Describe where skidding begins, and when the cage slip passed it."""
    a = dataset.attrs
    slip = dataset["cage_slip"].to_numpy()
    limit = skidding_slip(dataset)
    sentences = [describe_skidding(*_skidding_onset(a))]
    if math.isnan(limit):
        return sentences
    if a["friction"] == "effective" and slip.max() > _NEAR_SKIDDING * limit:
        sentences.append(
            f"{EFFECTIVE_FRICTION_ERROR}, and slip comes near: run with --set study.{a['study']}.friction=conventional "
            "to be sure"
        )
    value = f"the {precise_percent(limit)} at which skidding begins"
    passages = skidding_passages(dataset)
    if not passages:
        side = "below" if slip.max() <= limit else "beyond"
        return [*sentences, f"cage slip stays {side} {value}"]
    events = [
        _describe_passage(dataset, value, passage, is_last=k + 1 == len(passages))
        for k, passage in enumerate(passages)
    ]
    if slip[0] > limit:
        events.insert(0, f"cage slip begins at {precise_percent(float(slip[0]))}, beyond {value}")
    if len(events) > _MAX_SENTENCES:
        between = f"it passed {value} {len(events) - 2} more times in between"
        events = [events[0], between, events[-1]]
    return sentences + events


def _describe_passage(
    dataset: "xr.Dataset", value: str, passage: tuple[float, bool], is_last: bool
) -> str:
    """Describe a passage of the slip at which skidding begins, and what followed."""
    time, rising = passage
    if not rising:
        return f"cage slip fell below {value} at {_time(time)}"
    slip = dataset["cage_slip"].to_numpy()
    if not is_last:
        end = "but the cage came back"
    elif _is_steady(dataset):
        end = "but the cage settled beyond it"
    elif dataset.attrs["outcome"] == "stopped":
        end = "and the cage was beyond it when the run was stopped"
    elif slip[-1] >= slip.max():
        end = "and the cage still skids at the end"
    else:
        end = "and the cage was still beyond it at the end"
    return f"cage slip passed {value} at {_time(time)} while rising: the rollers' drive falls from there on, {end}"


def _describe_largest_slips(dataset: "xr.Dataset") -> str:
    """Describe the largest slips of the cage and of a roller."""
    times, cage, rollers = (
        dataset[name].to_numpy() for name in ("time", "cage_slip", "roller_slip")
    )
    k = int(np.argmax(cage))
    i, j = np.unravel_index(np.argmax(rollers), rollers.shape)
    return (
        f"largest cage slip {precise_percent(float(cage[k]))} at {_time(times[k])}; largest slip of a roller "
        f"{precise_percent(float(rollers[i, j]))}, roller {dataset['roller'].to_numpy()[j]} at {_time(times[i])}"
    )


def _describe_events(dataset: "xr.Dataset") -> list[str]:
    """Describe the events that are not passages of the skidding slip."""
    sentences = []
    others = [(what, sorted(p)) for what, p in _passages(dataset).items() if SKIDDING not in what]
    for what, passages in others[:_MAX_SENTENCES]:
        times = f"at {_time(passages[0][0])}"
        if len(passages) > 1:
            times = f"{len(passages)} times, first {times}, last at {_time(passages[-1][0])}"
        sentences.append(f"{what}: {times}")
    if len(others) > _MAX_SENTENCES:
        rest = sum(len(passages) for _, passages in others[_MAX_SENTENCES:])
        sentences.append(f"{rest} more events of {len(others) - _MAX_SENTENCES} other kinds")
    return sentences


def _describe_films(dataset: "xr.Dataset") -> str:
    """Describe the smallest film parameters."""
    known = {ring: film for ring, film in smallest_film(dataset).items() if not math.isnan(film)}
    if not known:
        loaded = bool(np.any(dataset["normal_force"].to_numpy() > 0.0))
        status = dataset["film_parameter"].attrs["film_status"]
        return f"film parameter unknown: {status if loaded else 'no roller was loaded'}"
    return "smallest film parameter " + ", ".join(
        f"{film:.3g} at the {ring} ring" for ring, film in known.items()
    )


def _describe_cage(dataset: "xr.Dataset") -> list[str]:
    """Describe the drag on the cage, and its contacts."""
    drags = json.loads(dataset.attrs["drag"])
    equations = "; ".join(f"{drag['name']}, {drag['equation']}" for drag in drags)
    sentences = ["no drag acts on the cage"]
    if drags:
        sentences = [f"drag on the cage: {equations}"]
    if "pocket_force" in dataset:
        force = format_quantity(float(np.abs(dataset["pocket_force"]).max()), "N", 3)
        sentences.append(f"largest force between a roller and the cage {force}")
    if "land_eccentricity" in dataset:
        eccentricity = float(dataset["land_eccentricity"].max())
        sentences.append(f"largest eccentricity of the cage on its lands {eccentricity:.3g}")
    return sentences


def _describe_step_error(dataset: "xr.Dataset") -> list[str]:
    """Describe an error of the steps that exceeds the tolerance, or that no trial motion shows."""
    rows = json.loads(dataset.attrs.get("accuracy", "[]"))
    rows = [row for row in rows if row["result"] == "cage_speed"]
    if any(row["estimated"] is None and row["found"] is None for row in rows):
        return [
            "how far the steps put the cage speed off is not known, as a trial motion failed; they keep the "
            "smallest tolerance that a plan chooses"
        ]
    return [
        f"the cage speed may err by {row['estimated']:.1e} of its largest at an instant, more than the tolerance of "
        f"{row['tolerance']:g}, as motions with other steps diverge; raise accuracy.cage_speed"
        for row in rows
        if (row["estimated"] or 0.0) > row["tolerance"]
    ]


def _describe_ledger(dataset: "xr.Dataset") -> str:
    """Describe the residuals of energy and angular momentum."""
    size = turnover(dataset)
    momentum = momentum_closure(dataset)
    text = "no energy was turned over"
    if size > 0.0:
        turned_over = format_quantity(size, "J", 4)
        text = f"the energy ledger closes to {energy_closure(dataset):.1e} of the {turned_over} turned over"
    if math.isnan(momentum):
        return text
    return f"{text}, angular momentum to {momentum:.1e} of its largest"


def _describe_cost(dataset: "xr.Dataset") -> str:
    """Describe the work of the integration."""
    a = dataset.attrs
    rejected = f"{a['rejected']:,} rejected" if a["rejected"] >= 0 else "rejected ones not counted"
    factor = float(a["real_time_factor"])
    speed = "its time was not taken"
    if 1.0 <= factor < math.inf:
        speed = f"{factor:.3g} times as fast as real time"
    elif 0.0 < factor < 1.0:
        speed = f"{1.0 / factor:.3g} times slower than real time"
    return (
        f"{a['steps']:,} steps ({rejected}), {a['rate_evaluations']:,} evaluations of the rates, {a['jacobians']:,} "
        f"Jacobians, {a['contacts_evaluated']:,} contacts evaluated; {speed}{_describe_frozen_friction(a)}"
    )


def _describe_frozen_friction(attributes: Mapping[str, Any]) -> str:
    """Describe for how long friction was linearised between its evaluations, and the error; empty if never."""
    if "friction_held" not in attributes:
        return ""
    interval, error, max_error = (
        attributes[f"friction_{name}"] for name in ("held", "off", "most_off")
    )
    return (
        f"; friction was evaluated every {interval:.2g} s, linear in speed and time in between, and off by {error:.1e} "
        f"of it when it was again, by {max_error:.1e} at most"
    )


ACCOUNT: Final = DynamicsAccount("dynamics")
