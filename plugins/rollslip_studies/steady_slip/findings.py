"""Account of study steady-slip, from the dataset alone: rows of its answer, sentences, and a record of numbers."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.results.account import Account
from rollslip.results.accounts import largest_load_row, with_assumptions
from rollslip.results.answer import ACCEPTABLE, Answer, Row
from rollslip.results.text import (
    Status,
    force_unit,
    format_force,
    format_plain,
    format_slip_band,
    load_settings,
    percent,
    stated_load,
    two_digits,
)
from rollslip.results.text import precise_percent as _percent
from rollslip.results.verdict import Fact
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.axial import findings as axial
from rollslip_studies.steady_slip.friction_torque.findings import (
    describe_losses,
    losses_record,
    torque_row,
)
from rollslip_studies.steady_slip.play_findings import (
    WITHOUT_PLAY,
    assumed_without_play,
    describe_play,
    describe_pockets,
    slip_without_play,
)

if TYPE_CHECKING:
    import xarray as xr

#: Fraction of the largest load from which on its row stands beside that of the minimum load; below, it is the last one.
#: Chosen: at half of it the life is ten times the required one.
_NEAR_LIMIT: Final = 0.5
#: Factor from rad/s to revolutions per minute.
_RPM: Final = 30.0 / math.pi
#: Commands for the next step, by verdict, where no minimum load is known.
NEXT: Final[dict[str, tuple[str, ...]]] = {
    "OK": ("rollslip run {scene} --report",),
    "SLIPS": ("rollslip uncertainty {scene}",),
    "SKIDS": ("rollslip uncertainty {scene}",),
    "UNKNOWN": ("rollslip uncertainty {scene}",),
}
#: Row of the minimum load in answers of studies that do not compute it.
UNCOMPUTED_MINIMUM_LOAD: Final = Row(
    key="minimum_load",
    label="minimum load",
    unit="N",
    text="not computed",
    rank=-1,
    note="run --study steady-slip",
)
#: Slip ahead of pure rolling, as a positive number, from which a cage is called driven: 0.1 %, as printed. Twice as
#: much leaves cages uncalled that are printed as 0.1 % ahead.
_MIN_DRIVEN_SLIP: Final = 1e-3
#: Note of an infinite reserve at a slip: neither drags nor their absence explain it.
_BRAKED: Final = "rolling resistance, no drag, brakes the cage"
#: Reserve above which only "over 1000" is printed, as its size has no consequence. Chosen.
_MAX_PRINTED_RESERVE: Final = 1000.0
#: Ratio of the slip at the medians of all that scatters to the slip of the scene from which both are told apart.
#: Chosen: of most scenes both are nearer.
_DIFFERS: Final = 1.2
#: Fraction of the load of the scene below which a minimum load is printed in its own unit instead of that of the load,
#: so that at least two digits of it are seen: 5 N of 1 kN are 0.0050 kN. Chosen.
_MIN_SHARED_UNIT_FRACTION: Final = 0.005
#: Rank of this study among those of a run in its knowledge of slip, load and reserve; rows of the highest rank are
#: kept.
_KNOWN: Final = 2
#: Command for the steady slip, of answers of other studies.
RUN_STEADY_SLIP: Final = "rollslip run {scene} --study steady-slip"


def next_of_others(dataset: "xr.Dataset") -> dict[str, tuple[str, ...]]:
    """Return commands for the next step by verdict, of studies without a steady slip.

    There are none where the form of a raceway turns with its ring, because study steady-slip refuses such a bearing.
    """
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    bearing = scene.get("bearing", {})
    operation = scene.get("operation", {})
    turns = any(
        operation.get(f"{ring}_speed") and (bearing.get(f"{ring}_raceway") or {}).get("form")
        for ring in ("inner", "outer")
    )
    return {} if turns else dict.fromkeys(NEXT, (RUN_STEADY_SLIP,))


def _next(dataset: "xr.Dataset", rows: tuple[Row, ...]) -> dict[str, tuple[str, ...]]:
    """Return commands for the next step by verdict: a run at the upper bound of the minimum load, where it has more."""
    operation = json.loads(dataset.attrs.get("scene_resolved", "{}")).get("operation", {})
    load = stated_load(operation)
    row = next((row for row in rows if row.key == "minimum_load"), None)
    more = math.nan if row is None else (row.band or (row.value,))[-1]
    if not load < more < math.inf:
        return NEXT
    run = f"rollslip run {{scene}} {load_settings(operation, more)}"
    return {
        verdict: commands if verdict == "OK" else (run, *commands)
        for verdict, commands in NEXT.items()
    }


def _rows(dataset: "xr.Dataset", acceptable: float) -> "Iterator[Row | None]":
    """Yield the rows of an answer, None where a row does not apply."""
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    state = dataset.isel(steady=int(lasting[0]) if lasting.size else 0)
    scene: dict[str, Any] = json.loads(dataset.attrs.get("scene_resolved", "{}"))
    operation = scene.get("operation", {})
    load = stated_load(operation)
    clearance = _clearance(scene.get("bearing", {}))
    slip = float(state["steady_slip"]) if has_steady(dataset) else math.nan
    status = str(dataset["status"].item())
    yield slip_row(dataset, slip, status, known=_KNOWN, within=0.02)
    preload = max(0.0, -(clearance or 0.0))
    limit = largest_load_row(dataset, load)
    is_heavy = limit is not None and load > _NEAR_LIMIT * limit.value
    if "minimum_load" in dataset:
        if slip < -acceptable or Status.DRIVEN in status:
            note = "it is for a cage that lags"
            yield attrs.evolve(UNCOMPUTED_MINIMUM_LOAD, text="not found", rank=_KNOWN, note=note)
        else:
            yield _minimum_load_row(dataset, acceptable, scene, preload)
        if is_heavy:
            yield limit
        if preload == 0.0 or float(dataset["minimum_load"]) > 0.0:
            yield _makers_row(dataset, load)
        yield _acceptable_reserve_row(dataset, acceptable)
    if "drag_reserve" in dataset:
        yield reserve_row(
            float(dataset["drag_reserve"]),
            str(dataset["reserve_status"].item()),
            known=_KNOWN,
            within=0.02,
            slip=slip,
        )
    yield axial.axial_row(dataset, state)
    yield torque_row(dataset, state, _KNOWN)
    yield _film_row(dataset, state)
    if clearance is not None:
        source = json.loads(dataset.attrs.get("clearance", "{}")).get("text", "")
        yield Row(
            key="clearance",
            label="operating clearance",
            value=clearance,
            unit="m",
            text=f"{two_digits(1e6 * clearance)} µm",
            note=source.partition(" = ")[0].replace("um", "µm"),
        )
    if "minimum_load" in dataset and not is_heavy:
        yield limit


def _clearance(bearing: Mapping[str, Any]) -> float | None:
    """Return the clearance of a resolved bearing [m]; None of a tapered one, which has none under load."""
    return None if "contact_angle" in bearing else bearing.get("radial_clearance")


def _facts(dataset: "xr.Dataset", kappa: float) -> dict[Fact, float]:
    """Return the facts that are not among the rows: the viscosity ratio, and the axial over the radial load."""
    load, ratio = axial.axial_load_of(dataset)
    facts = {} if math.isnan(kappa) else {Fact.VISCOSITY_RATIO: kappa}
    return facts | ({Fact.AXIAL_RATIO: ratio} if load > 0.0 else {})


def slip_row(dataset: "xr.Dataset", slip: float, status: str, *, known: int, within: float) -> Row:
    """Return the row of the cage slip, with its band where the result has one.

    Parameters
    ----------
    dataset : Dataset
        The result.
    slip : float
        Steady cage slip [-]; NaN where there is none.
    status : str
        Status of the slip, the note of the row where there is none.
    known : int
        Rank of the study in its knowledge of the slip; see `Row`.
    within : float
        Relative error of the slip; see `Row`.
    """
    if math.isnan(slip):
        return Row(key="cage_slip", label="cage slip", text="not found", note=status, rank=known)
    band = None if slip else (0.0, 0.0)  # no data slow down a cage that no drag brakes
    note = ""
    driven = "driven: it runs ahead of pure rolling" if slip < -_MIN_DRIVEN_SLIP else ""
    stored = json.loads(dataset.attrs.get("band", "{}")).get("steady_slip")
    if stored is not None:
        band = stored["low"], math.inf if stored["high"] is None else stored["high"]
        note = format_slip_band(*band)
        near, far = sorted((slip, stored.get("median") or slip))
        if far > max(_DIFFERS * near, _MIN_DRIVEN_SLIP):
            note += f", {percent(stored['median'])} with all data at their medians"
        if missing := stored.get("left_out"):
            note += f", without the scatter of {', '.join(missing)}"
    note = ", ".join(filter(None, (note, driven, slip_without_play(dataset))))
    return Row(
        key="cage_slip",
        label="cage slip",
        value=slip,
        text=percent(slip),
        band=band,
        note=note,
        rank=known,
        tolerance=within,
    )


def reserve_row(reserve: float, status: str, *, known: int, within: float, slip: float) -> Row:
    """Return the row of the drag reserve to skidding: the factor on the drags of the scene at which the cage skids.

    Where no drag brakes the cage and it nevertheless lags, the rolling resistance of the rollers brakes it.

    Parameters
    ----------
    reserve : float
        Drag reserve [-]; infinite without drag, NaN where it is not known.
    status : str
        Status of the reserve; see `Status`.
    known : int
        Rank of the study in its knowledge of the reserve; see `Row`.
    within : float
        Relative error of the reserve; see `Row`.
    slip : float
        Steady cage slip [-].
    """
    row: Any = {
        "key": "drag_reserve",
        "label": "reserve to skidding",
        "value": reserve,
        "rank": known,
        "tolerance": within,
    }
    if math.isnan(reserve):
        return Row(**row, text="not found", note=status)
    is_bound = Status.of(status) is Status.AT_LEAST
    if math.isinf(reserve):
        note = f"no drag brakes the cage{' without slip' * (slip < -_MIN_DRIVEN_SLIP)}"
        if slip > _MIN_DRIVEN_SLIP:
            note = _BRAKED
        return Row(**row, text="no limit", note=note)
    band = (reserve, math.inf) if is_bound else (reserve, reserve)
    text = _format_reserve(reserve, is_bound) if reserve > 0.0 else "none"
    return Row(**row, text=text, band=band)


def _minimum_load_row(
    dataset: "xr.Dataset", acceptable: float, scene: Mapping[str, Any], preload: float
) -> Row:
    """Return the row of the minimum load, with its band where the result has one."""
    operation = scene.get("operation", {})
    load = stated_load(operation)
    minimum = float(dataset["minimum_load"])
    status = str(dataset["minimum_load_status"].item())
    row: Any = {"key": "minimum_load", "label": "minimum load", "unit": "N", "rank": _KNOWN}
    outcome = Status.of(status)
    is_unlimited = outcome in (Status.NO_LOAD_NEEDED, Status.ANY_LOAD)
    condition = f"for a slip below {format_plain(100.0 * acceptable)} %"
    if operation.get("axial_load"):
        condition += axial.describe_load(scene, is_unlimited=is_unlimited)
    if preload > 0.0 and is_unlimited:
        return Row(**row, text="none", note=f"preloaded by {two_digits(1e6 * preload)} µm")
    if math.isnan(minimum):
        if is_unlimited:
            return Row(**row, text="none", note=f"{Status.ANY_LOAD}, {condition}")
        why = f"{Status.NO_LOAD}, {condition}" if outcome is Status.NO_LOAD else status
        return Row(**row, text="not found", note=why)
    if minimum < (weight := float(dataset.attrs.get("rollers_weight", 0.0))):
        note = f"{condition}; rollers weigh as much, which is left out"
        text = f"below {format_force(weight, weight)}"
        return Row(**row, value=minimum, text=text, note=note, band=(0.0, weight))
    if outcome is Status.FOUND_AT_SKIDDING:
        condition += "; with less it skids"
    if status.endswith(WITHOUT_PLAY):
        condition += f", {WITHOUT_PLAY}"
    stored = json.loads(dataset.attrs.get("band", "{}")).get("minimum_load")
    lower = minimum if stored is None else stored["low"]
    reference = load if lower >= _MIN_SHARED_UNIT_FRACTION * load else lower
    text = format_force(minimum, reference)
    if stored is None or stored["high"] is None:
        return Row(**row, value=minimum, text=text, note=condition)
    band = lower, stored["high"]
    bounds = f"{format_force(lower, reference, unit=False)} to {format_force(band[1], reference)}"
    return Row(**row, value=minimum, text=text, band=band, note=f"{bounds}, {condition}")


def _format_reserve(reserve: float, is_bound: bool = False) -> str:
    """Return a reserve in two digits, as a lower bound if it is one."""
    if reserve > _MAX_PRINTED_RESERVE:
        return f"over {_MAX_PRINTED_RESERVE:g}"
    return f"{'at least ' * is_bound}{two_digits(reserve)}"


def _makers_row(dataset: "xr.Dataset", load: float) -> Row | None:
    """Return the row of catalogue minimum loads, the smallest first, and whether the load of the scene is enough."""
    required = sorted(
        (float(minimum), str(maker), str(status))
        for maker, minimum, status in zip(
            dataset["maker"].to_numpy(),
            dataset["makers_minimum_load"].to_numpy(),
            dataset["makers_status"].to_numpy(),
            strict=True,
        )
        if minimum > 0.0
    )
    if not required:
        return None
    met = [load >= minimum for minimum, *_ in required]
    text = "met" if all(met) else "met in part"
    if not any(met):
        text = "not met"
    loads = ", ".join(
        f"{maker}{_at_rest(status)} {format_force(minimum, load, unit=False)}"
        for minimum, maker, status in required
    )
    return Row(
        key="makers_minimum_load",
        label="makers' minimum",
        value=required[0][0],
        unit="N",
        text=text,
        note=f"{loads} {force_unit(load)[0]}",
    )


def _at_rest(status: str) -> str:
    """Return the words that a catalogue load is the one at rest, where the status of a maker says so."""
    return " at rest" if Status.of(status) is Status.FOUND_AT_REST else ""


def _acceptable_reserve_row(dataset: "xr.Dataset", acceptable: float) -> Row | None:
    """Return the row of the reserve to the acceptable slip; None where it is not known."""
    reserve = float(dataset.get("acceptable_reserve", math.nan))
    if math.isnan(reserve):
        return None
    return Row(
        key="acceptable_reserve",
        label="reserve to slipping",
        value=reserve,
        text="none" if reserve <= 0.0 else _format_reserve(reserve),
        note=f"to a slip of {format_plain(100.0 * acceptable)} %",
    )


def _film_row(dataset: "xr.Dataset", state: "xr.Dataset") -> Row | None:
    """Return the row of the smallest film parameter, with kappa and the film regime."""
    if "film_parameter" not in state or not np.isfinite(state["film_parameter"]).any():
        return None
    thinnest = float(state["film_parameter"].min())
    limits = json.loads(dataset.attrs.get("film_limits", "{}"))
    kappa = float(dataset.get("viscosity_ratio", math.nan))
    notes = [f"kappa {two_digits(kappa)}"] if kappa > 0.0 else []
    if "mixed" in limits:
        regime = "full film" if thinnest >= limits["mixed"] else "mixed friction"
        notes.append("boundary friction" if thinnest <= limits.get("boundary", 0.0) else regime)
    parts = [Row(key="film_parameter", label="Lambda", value=thinnest, text=two_digits(thinnest))]
    if kappa > 0.0:
        parts.append(Row(key="viscosity_ratio", label="kappa", value=kappa, text=two_digits(kappa)))
    return Row(
        key="film_parameter",
        label="oil film",
        value=thinnest,
        text=f"Lambda {two_digits(thinnest)}",
        note=", ".join(notes),
        parts=tuple(parts),
    )


def varied(dataset: "xr.Dataset") -> list[str]:
    """Return the names of the operating conditions over which steady slips were followed."""
    return [
        str(name).removesuffix("_limit_status")
        for name in dataset
        if str(name).endswith("_limit_status")
    ]


def has_steady(dataset: "xr.Dataset") -> bool:
    """Whether there is a steady slip."""
    return "steady_slip" in dataset and bool(np.isfinite(dataset["steady_slip"]).any())


def _describe_inertia(dataset: "xr.Dataset") -> str:
    """Return the relative effect of the inertia of the rollers' spin on the driving torque."""
    effect = float(dataset.attrs["inertia_effect"])
    other = "without" if bool(dataset.attrs["inertia"]) else "with"
    if math.isnan(effect):
        return f"the effect of roller inertia is not known: {other} it no steady motion of the rollers was found"
    return (
        f"{other} inertia of the rollers' spin the torque that drives the cage would differ by up to "
        f"{_percent(effect)}"
    )


def _describe_steady_slips(dataset: "xr.Dataset") -> list[str]:
    """Return a sentence for each steady slip, or the status where there is none."""
    if not has_steady(dataset) or Status.of(str(dataset["status"].item())) is not Status.FOUND:
        return [str(dataset["status"].item())]
    sentences = []
    for k in range(dataset.sizes["steady"]):
        state = dataset.isel(steady=k)
        sentences.append(
            f"steady cage slip {_percent(float(state['steady_slip']))} ({state['stability'].item()}): the cage runs at "
            f"{_RPM * float(state['cage_speed']):.5g} rpm {_describe_drag(float(state['torque']))}"
        )
    return sentences


def _describe_drag(drag: float) -> str:
    """Return the drag that a cage carries, or the torque by which its drags drive it."""
    size = format_quantity(abs(drag), "N m", 3)
    return f"{'against a drag of' if drag >= 0.0 else 'and its drags, as a land has, drive it by'} {size}"


def _describe_limit_drag(dataset: "xr.Dataset") -> str:
    """Return the limit drag torque and its slip, or why there is none and the largest torque of the rollers."""
    limit = float(dataset["limit_drag"])
    sentence = str(dataset["skidding_status"].item())
    if math.isfinite(limit):
        sentence = (
            f"the limit drag torque is {format_quantity(limit, 'N m', 3)}, at a cage slip of "
            f"{_percent(float(dataset['skidding_slip']))}{_describe_jump(dataset)}"
        )
    return sentence + _describe_first_maximum(dataset)


def _describe_jump(dataset: "xr.Dataset") -> str:
    """Return the error of the limit drag torque, the slip after the jump, and the largest torque beyond."""
    low, high, jump_slip = (
        float(dataset[name]) for name in ("limit_drag_low", "limit_drag_high", "jump_slip")
    )
    error = float(dataset["limit_drag_error"])
    within = _percent(float(dataset["limit_drag_low"].attrs["within"]))
    sentence = f", or anywhere between {_percent(low)} and {_percent(high)}, where it is within {within} of that"
    sentence += (
        f" (right to {_percent(error)})" if math.isfinite(error) else " (how exactly is not known)"
    )
    if math.isnan(jump_slip):
        return f"{sentence}; nothing in the range carries more"
    return (
        f"{sentence}; a larger one takes it to {_percent(jump_slip)}, where slips carry up to "
        f"{format_quantity(float(dataset['largest_torque']), 'N m', 3)} at "
        f"{_percent(float(dataset['largest_torque_slip']))}"
    )


def _describe_minimum_load(dataset: "xr.Dataset") -> list[str]:
    """Return the status of the minimum load, unless it is found, and what the rules of makers lack."""
    status = str(dataset["minimum_load_status"].item())
    rules = [
        f"{maker}'s rule {lack}"
        for maker, lack in zip(
            dataset["maker"].to_numpy(), dataset["makers_status"].to_numpy(), strict=True
        )
        if lack and Status.of(lack) is not Status.FOUND
    ]
    return rules if status == Status.FOUND else [f"minimum load: {status}", *rules]


def _describe_first_maximum(dataset: "xr.Dataset") -> str:
    """Return the first maximum of the torque where it lies before the onset of skidding; else an empty text."""
    slip = float(dataset["first_maximum_slip"])
    if math.isnan(slip) or slip >= float(dataset["skidding_slip"]):  # which may be NaN
        return ""
    torque = format_quantity(float(dataset["first_maximum_torque"]), "N m", 3)
    jump_slip = float(dataset.get("first_jump_slip", math.nan))
    end = "slips beyond" if math.isnan(jump_slip) else _percent(jump_slip)
    return (
        f"; their torque falls with slip already from {_percent(slip)} on, a first maximum of {torque}, before it "
        f"rises once more: a larger drag takes the cage to {end}"
    )


def _describe_limit(dataset: "xr.Dataset", name: str) -> str:
    """Return the limit of an operating condition at a fold of steady slips, or why there is none."""
    limit = float(dataset[f"{name}_limit"])
    if math.isnan(limit):
        return str(dataset[f"{name}_limit_status"].item())
    values = dataset[name].to_numpy()
    branch = dataset[f"{name}_branch"].to_numpy()
    on_branch = values[branch == branch[np.argmin(np.abs(values - limit))]]
    neighbour = on_branch[max(int(np.argmin(np.abs(on_branch - limit))) - 1, 0)]
    which = "least" if neighbour > limit else "largest"
    return (
        f"the {which} {name.replace('_', ' ')} at which a stable steady slip goes on is "
        f"{format_quantity(limit, dataset[name].attrs['units'], 4)}, where the slip is "
        f"{_percent(float(dataset[f'{name}_limit_slip']))}"
    )


class SteadySlipAccount(Account):
    """Account of study steady-slip."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "curve_error": ("error by the points of the slip-drag curve", "1"),
        "rollers_weight": ("weight of all rollers, not in their loads", "N"),
    }
    units: ClassVar[Mapping[str, str]] = {"cage_slip": "1", "losses": "W", "inertia_effect": "1"}

    figures_function = ".figures:steady_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the answer: slip, minimum loads, reserves, friction torque, film and clearance."""
        acceptable = float(dataset.attrs.get("acceptable_slip", ACCEPTABLE))
        rows = tuple(row for row in _rows(dataset, acceptable) if row is not None)
        kappa = float(dataset.get("viscosity_ratio", math.nan))
        answer = Answer(
            rows=rows,
            acceptable=acceptable,
            assumed=assumed_without_play(dataset),
            commands=_next(dataset, rows),
            facts=_facts(dataset, kappa),
        )
        return with_assumptions(answer, dataset)

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return sentences by topic, the most important first, without full stops."""
        return {
            "steady slip": _describe_steady_slips(dataset)
            + describe_play(dataset)
            + describe_pockets(dataset),
            **({"axial load": ribs} if (ribs := axial.describe_ribs(dataset)) else {}),
            "limit drag torque": [_describe_limit_drag(dataset)],
            **(
                {"losses": describe_losses(dataset)}
                if "loss" in dataset and has_steady(dataset)
                else {}
            ),
            **(
                {"minimum load": _describe_minimum_load(dataset)}
                if "minimum_load" in dataset
                else {}
            ),
            **{
                f"limit of the {name.replace('_', ' ')}": [_describe_limit(dataset, name)]
                for name in varied(dataset)
            },
            "inertia of the rollers": [_describe_inertia(dataset)],
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the numbers and statuses of a result; a number that is not known is None."""
        followed = varied(dataset)
        numbers = [
            "limit_drag",
            "skidding_slip",
            "first_maximum_torque",
            "first_maximum_slip",
            "minimum_load",
            *(f"{name}_limit{of}" for name in followed for of in ("", "_slip")),
        ]
        texts = [
            "status",
            "skidding_status",
            "minimum_load_status",
            *(f"{name}_limit_status" for name in followed),
        ]
        states = [
            {
                "cage_slip": float(dataset["steady_slip"][k]),
                "cage_speed": float(dataset["cage_speed"][k]),
                "torque": float(dataset["torque"][k]),
                "stable": bool(dataset["stable"][k]),
                "stability": str(dataset["stability"][k].item()),
                **losses_record(dataset.isel(steady=k)),
            }
            for k in range(dataset.sizes["steady"] if has_steady(dataset) else 0)
        ]
        values = {name: float(dataset[name]) for name in numbers if name in dataset}
        known = ("inertia_effect", "positions_error", "slices_error")
        values |= {name: float(dataset.attrs[name]) for name in known if name in dataset.attrs}
        return (
            {"steady": states}
            | ({"band": json.loads(dataset.attrs["band"])} if "band" in dataset.attrs else {})
            | {name: None if math.isnan(value) else value for name, value in values.items()}
            | {name: str(dataset[name].item()) for name in texts if name in dataset}
        )


ACCOUNT: Final = SteadySlipAccount("steady-slip")
