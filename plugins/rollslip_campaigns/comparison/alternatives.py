"""Alternatives of one scene side by side: the answer of each, best first, and how sure it is that one slips less.

- Each is run as ``rollslip run`` would, by the study of steady slips: what is told of it is what that tells.
- Data scatter in all of them alike. So the ratio of two slips is surer than either: what moves a quantity of both moves
  both slips, and the difference of the logarithms counts, in squares, as in the band of one. Two oils share no data of
  theirs, so what moves the oil counts for each.
"""

import itertools
import json
import math
import time
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError, SceneError
from rollslip.planning.campaign import listed
from rollslip.planning.execution import run
from rollslip.planning.provenance import origin, together
from rollslip.results.accounts import answer
from rollslip.results.dataset import about
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.structure import resolved, scene_hash
from rollslip_studies.steady_slip.study import SteadySlip

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.progress import Shown
    from rollslip_campaigns.comparison import ComparisonSettings

__all__ = ["KEYS", "STUDY", "Alternatives", "plan_alternatives", "ratio_band", "run_alternatives"]

#: Option -> key of the scene that it changes.
KEYS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "bearing": "bearing.name",
        "clearance_class": "bearing.clearance_class",
        "oil": "lubricant",
        "cage": "cage.make",
        "outer_ring": "models.outer_ring",
        "inner_ring": "models.inner_ring",
    }
)
STUDY: Final = SteadySlip.name
#: Variable -> unit, meaning, and what it is where it is not known. The first have the names of rows of an answer.
VARIABLES: Final[Mapping[str, tuple[str, str, float | str]]] = MappingProxyType(
    {
        "cage_slip": ("1", "steady cage slip", math.nan),
        "minimum_load": ("N", "minimum radial load for an acceptable slip", math.nan),
        "acceptable_reserve": (
            "1",
            "driving torque at the acceptable slip over the drags there",
            math.nan,
        ),
        "drag_reserve": ("1", "limit drag torque over the drag", math.nan),
        "friction_torque": ("N m", "friction torque of the bearing", math.nan),
        "film_parameter": ("1", "smallest film parameter", math.nan),
        "clearance": ("m", "operating clearance", math.nan),
        "cage_slip_low": ("1", "steady cage slip, 5 % where data scatter", math.nan),
        "cage_slip_high": ("1", "steady cage slip, 95 % where data scatter", math.nan),
        "ratio_low": ("1", "slip over that of the first, 5 % where data scatter", math.nan),
        "ratio_high": ("1", "slip over that of the first, 95 % where data scatter", math.nan),
        "verdict": ("1", "verdict", ""),
        "status": ("1", "done or failed", "failed"),
        "message": ("1", "why it failed", ""),
    }
)
#: Between the names of one alternative.
_BETWEEN: Final = " / "
_WORST_FIRST: Final = ("SKIDS", "UNKNOWN", "SLIPS", "OK")


@attrs.frozen(eq=False)
class Alternatives:
    """Scenes to be run, by what differs, and why others cannot be; ``keys`` are those that differ."""

    scene: Scene
    keys: tuple[str, ...]
    scenes: Mapping[str, Scene]
    refused: Mapping[str, str]
    told: tuple[str, ...] = ()


def plan_alternatives(requested: "ComparisonSettings") -> Alternatives:
    """Make a scene of each combination of what is named."""
    named = {option: listed(value) for option in KEYS if (value := getattr(requested, option))}
    others = [
        one
        for one in ("traction", "film", "contact", "reference", "study")
        if getattr(requested, one)
    ]
    if others:
        asked_for = " and ".join(f"--{option.replace('_', '-')}" for option in named)
        one = others[0]
        raise SceneError(
            [
                f"{one}: laws are compared by their curves, {asked_for} by the answer; ask for one of both"
            ]
        )
    scenes = dict[str, Scene]()
    refused = dict[str, str]()
    for names in itertools.product(*named.values()):
        label = _BETWEEN.join(names)
        try:
            there = evolve(
                requested.given,
                {KEYS[option]: name for option, name in zip(named, names, strict=True)},
            )
            assemble(there)  # an oil that nobody knows is refused at once, as is a class
            scenes[label] = there
        except RollslipError as error:
            refused[label] = str(error).removeprefix("changes: ")
    if len(scenes) < 2:
        faults = [f"{label}: {why}" for label, why in refused.items()]
        raise SceneError(
            faults
            or [f"{next(iter(named))}: name two at least, with commas between, to compare them"]
        )
    keys = tuple(KEYS[option] for option in named)
    return Alternatives(requested.given, keys, scenes, refused)


def run_alternatives(made: Alternatives, show: "Shown") -> "xr.Dataset":
    """Run all and put them side by side, best first."""
    begin = time.perf_counter()
    done = dict[str, Any]()
    failed = dict(made.refused)
    for k, (label, scene) in enumerate(made.scenes.items()):
        show(label, k / len(made.scenes), math.nan)
        try:
            done[label] = run(scene, STUDY)
        except RollslipError as error:
            failed[label] = str(error).removeprefix("changes: ")
    if not done:
        raise SceneError([f"{label}: {why}" for label, why in failed.items()])
    import xarray as xr

    answers = {label: answer(one, scene=label) for label, one in done.items()}
    order = sorted(done, key=lambda label: _rank(answers[label]))
    rows = list[dict[str, Any]]()
    for label, (low, high) in zip(order, _surer(order, done, made.keys), strict=True):
        found: dict[str, Any] = {
            "ratio_low": low,
            "ratio_high": high,
            "verdict": answers[label].verdict,
        }
        for row in answers[label].rows:
            found[row.key] = row.value
            if row.key == "cage_slip" and row.band is not None:
                found["cage_slip_low"], found["cage_slip_high"] = row.band
        rows.append(found | {"status": "done"})
    rows += [{"message": why} for why in failed.values()]
    over = "alternative"
    runs = [one.attrs for one in done.values()]
    return xr.Dataset(
        {
            name: (over, np.array([row.get(name, missing) for row in rows]), about(unit, meaning))
            for name, (unit, meaning, missing) in VARIABLES.items()
        },
        {over: (over, [*order, *failed], about("1", "what differs"))},
        origin(
            study="alternatives",
            source=made.scene.source,
            title=made.scene.title,
            differ=list(made.keys),
            acceptable_slip=next(iter(answers.values())).acceptable,
            rows={label: {row.key: row.text for row in answers[label].rows} for label in order},
            scene_resolved=resolved(made.scene),
            scene_hash=scene_hash(made.scene),
            **together(runs),
            warnings=[],
            evaluations=sum(int(one["evaluations"]) for one in runs),
            wall_time=time.perf_counter() - begin,
        ),
    )


def _rank(of: Any) -> tuple[int, float]:
    """The better verdict first, then the smaller slip."""
    slip = next((row.value for row in of.rows if row.key == "cage_slip"), math.nan)
    worst = _WORST_FIRST.index(of.verdict) if of.verdict in _WORST_FIRST else 0
    return -worst, math.inf if math.isnan(slip) else abs(slip)


def _surer(
    order: list[str], done: "Mapping[str, xr.Dataset]", keys: Iterable[str]
) -> list[tuple[float, float]]:
    """Between what the slip of each is, over that of the first, 5 and 95 %; NaN where it is not known."""
    oil = next((k for k, key in enumerate(keys) if key == KEYS["oil"]), None)
    oils = {label: "" if oil is None else label.split(_BETWEEN)[oil] for label in order}
    first = order[0]
    return [
        ratio_band(
            done[label], done[first], own=() if oils[label] == oils[first] else ("lubricant.",)
        )
        for label in order
    ]


def ratio_band(
    one: "xr.Dataset", other: "xr.Dataset", own: tuple[str, ...] = ()
) -> tuple[float, float]:
    """Return between what the ratio of two steady slips lies, 5 and 95 %; NaN where a band is not known.

    Parameters
    ----------
    one, other : xarray.Dataset
        Results with bands.
    own : tuple of str
        Beginnings of keys whose values the two do not share.
    """
    moved = [_moves(of) for of in (one, other)]
    if one is other or not all(moved):
        return (1.0, 1.0) if one is other else (math.nan, math.nan)
    up = down = 0.0
    for key in dict.fromkeys((*moved[0], *moved[1])):
        a, b = (of.get(key, (0.0, 0.0)) for of in moved)
        shared = not any(key.startswith(one) for one in own)
        pairs = (
            [tuple(x - y for x, y in zip(a, b, strict=True))]
            if shared
            else [a, tuple(-x for x in b)]
        )
        for ends in pairs:
            up += max(*ends, 0.0) ** 2
            down += min(*ends, 0.0) ** 2
    middle = float(one["steady_slip"][0]) / float(other["steady_slip"][0])
    return middle * math.exp(-math.sqrt(down)), middle * math.exp(math.sqrt(up))


def _moves(of: "xr.Dataset") -> dict[str, tuple[float, ...]]:
    """By how much the logarithm of the slip moves with each quantity, low and high; nothing where that is not known."""
    band = json.loads(of.attrs.get("band", "{}")).get("steady_slip", {})
    slip = float(np.ravel(of["steady_slip"])[0])
    found = dict[str, tuple[float, ...]]()
    if not slip > 0.0:
        return {}
    for row in band.get("moved", ()):
        if any(value is None or not value > 0.0 for value in row["values"]):
            return {}
        found[row["key"]] = tuple(math.log(value / slip) for value in row["values"])
    return found
