"""Run alternatives of one scene: the answer of each, best first, and bounds of the ratio of their slips.

- Each alternative runs as ``rollslip run`` would run it, by study steady-slip, and its answer is that of this study.
- Data scatter alike in all alternatives, so that the ratio of two slips is known better than each slip. A quantity that
  both share changes both slips: what counts is the difference of the changes of their logarithms. A quantity that they
  do not share, such as data of two oils, counts for each alternative on its own. Both kinds are added in squares, as in
  the band of one slip (first-order propagation of uncertainty).
"""

import itertools
import json
import math
import time
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError, SceneError
from rollslip.planning.campaign import listed
from rollslip.planning.execution import measured_attribute, run
from rollslip.planning.progress import ProgressReporter
from rollslip.planning.provenance import combine_origins, origin
from rollslip.results.accounts import answer
from rollslip.results.answer import Answer
from rollslip.results.dataset import about, xr
from rollslip.scene.changes import evolve
from rollslip.scene.values import Scene
from rollslip.structure import resolved, scene_hash
from rollslip.studies.measured import MeasuredPoints
from rollslip_campaigns.comparison import ComparisonSettings
from rollslip_studies.steady_slip.study import SteadySlip

__all__ = ["KEYS", "STUDY", "Alternatives", "plan_alternatives", "ratio_band", "run_alternatives"]

#: Key of the scene that each option changes.
KEYS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "bearing": "bearing.name",
        "clearance_class": "bearing.clearance_class",
        "oil": "lubricant",
        "cage": "cage.make",
        "outer_ring": "models.outer_ring",
        "inner_ring": "models.inner_ring",
        "rib": "models.rib",
    }
)
#: Study whose answers are compared.
STUDY: Final = SteadySlip.name
#: Unit, meaning and missing value of each variable of the result. The first have the names of rows of an answer.
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
#: Separator of the names in the label of an alternative.
_SEPARATOR: Final = " / "
#: Verdicts from worst to best.
_WORST_FIRST: Final = ("SKIDS", "UNKNOWN", "SLIPS", "OK")


@attrs.frozen(eq=False)
class Alternatives:
    """Scenes to run, and why others cannot run.

    Attributes
    ----------
    scene : Scene
        The scene that is changed.
    keys : tuple of str
        Keys of the scene that differ.
    scenes : mapping
        Changed scenes by label.
    refused : mapping
        Reasons why other combinations cannot run, by label.
    measured : MeasuredPoints or None
        Measured points to compare with.
    """

    scene: Scene
    keys: tuple[str, ...]
    scenes: Mapping[str, Scene]
    refused: Mapping[str, str]
    measured: MeasuredPoints | None = None

    @property
    def unusual(self) -> list[str]:
        """Warnings of the combinations that cannot run."""
        return [f"{label} is left out: {reason}" for label, reason in self.refused.items()]


def plan_alternatives(requested: "ComparisonSettings") -> Alternatives:
    """Return a scene for each combination of the named alternatives."""
    named = {option: listed(value) for option in KEYS if (value := getattr(requested, option))}
    laws = [
        option
        for option in ("traction", "film", "contact", "reference", "study")
        if getattr(requested, option)
    ]
    if laws:
        options = " and ".join(f"--{option.replace('_', '-')}" for option in named)
        raise SceneError(
            [
                f"{laws[0]}: laws are compared by their curves, {options} by the answer; ask for one of both"
            ]
        )
    scenes = dict[str, Scene]()
    refused = dict[str, str]()
    for names in itertools.product(*named.values()):
        label = _SEPARATOR.join(names)
        try:
            scene = evolve(
                requested.base_scene,
                {KEYS[option]: name for option, name in zip(named, names, strict=True)},
                si=True,
            )
            assemble(scene)  # refuse unknown oils and clearance classes at once
            scenes[label] = scene
        except RollslipError as error:
            refused[label] = str(error).removeprefix("changes: ")
    if len(scenes) < 2:
        raise SceneError(
            [f"{label}: {reason}" for label, reason in refused.items()]
            or [f"{next(iter(named))}: name two at least, with commas between, to compare them"]
        )
    return Alternatives(
        requested.base_scene,
        tuple(KEYS[option] for option in named),
        scenes,
        refused,
        requested.measured_points,
    )


def run_alternatives(plan: Alternatives, show: "ProgressReporter") -> "xr.Dataset":
    """Run all alternatives and return their answers, best first.

    Parameters
    ----------
    plan : Alternatives
        Scenes to run.
    show : ProgressReporter
        Is called with the progress.

    Returns
    -------
    xarray.Dataset
        Variables of `VARIABLES` over ``alternative``; NaN and ``status`` "failed" where an alternative did not run.
    """
    start = time.perf_counter()
    done = dict[str, Any]()
    failed = dict(plan.refused)
    for k, (label, scene) in enumerate(plan.scenes.items()):
        show(label, k / len(plan.scenes), math.nan)
        try:
            done[label] = run(scene, STUDY)
        except RollslipError as error:
            failed[label] = str(error).removeprefix("changes: ")
    if not done:
        raise SceneError([f"{label}: {reason}" for label, reason in failed.items()])

    answers = {label: answer(result, scene=label) for label, result in done.items()}
    order = sorted(done, key=lambda label: _rank(answers[label]))
    bands = _ratio_bands(order, done, plan.keys)
    rows = [_values(answers[label], band) for label, band in zip(order, bands, strict=True)]
    rows += [{"message": reason} for reason in failed.values()]
    dim = "alternative"
    runs = [result.attrs for result in done.values()]
    return xr.Dataset(
        {
            name: (dim, np.array([row.get(name, missing) for row in rows]), about(unit, meaning))
            for name, (unit, meaning, missing) in VARIABLES.items()
        },
        {dim: (dim, [*order, *failed], about("1", "what differs"))},
        origin(
            study="alternatives",
            source=plan.scene.source,
            title=plan.scene.title,
            differ=list(plan.keys),
            acceptable_slip=next(iter(answers.values())).acceptable,
            rows={label: {row.key: row.text for row in answers[label].rows} for label in order},
            scene_resolved=resolved(plan.scene),
            scene_hash=scene_hash(plan.scene),
            **combine_origins(runs),
            warnings=[],
            evaluations=sum(int(attributes["evaluations"]) for attributes in runs),
            wall_time=time.perf_counter() - start,
        )
        | _measured(plan, order, done, show),
    )


def _measured(
    plan: Alternatives, order: Iterable[str], done: Mapping[str, Any], show: "ProgressReporter"
) -> dict[str, str]:
    """Return the comparison of the alternatives that ran with measured points, as an attribute."""
    return measured_attribute(
        plan.measured,
        {label: plan.scenes[label] for label in order},
        {label: result.complete() for label, result in done.items()},
        show,
    )


def _values(answer: Answer, ratio: tuple[float, float]) -> dict[str, Any]:
    """Return the values of an alternative, by the names of `VARIABLES`."""
    values: dict[str, Any] = {
        "ratio_low": ratio[0],
        "ratio_high": ratio[1],
        "verdict": answer.verdict,
        "status": "done",
    }
    for row in answer.rows:
        values[row.key] = row.value
        if row.key == "cage_slip" and row.band is not None:
            values["cage_slip_low"], values["cage_slip_high"] = row.band
    return values


def _rank(answer: Answer) -> tuple[int, float]:
    """Return the sort key of an answer: the better verdict first, then the smaller slip."""
    slip = next((row.value for row in answer.rows if row.key == "cage_slip"), math.nan)
    worst = _WORST_FIRST.index(answer.verdict) if answer.verdict in _WORST_FIRST else 0
    return -worst, math.inf if math.isnan(slip) else abs(slip)


def _ratio_bands(
    order: list[str], done: "Mapping[str, xr.Dataset]", keys: Iterable[str]
) -> list[tuple[float, float]]:
    """Return the 5 and 95 % bounds of each slip over that of the first alternative; NaN where they are unknown."""
    position = next((k for k, key in enumerate(keys) if key == KEYS["oil"]), None)
    oils = {label: "" if position is None else label.split(_SEPARATOR)[position] for label in order}
    first = order[0]
    return [
        ratio_band(
            done[label], done[first], own=() if oils[label] == oils[first] else ("lubricant.",)
        )
        for label in order
    ]


def ratio_band(
    result: "xr.Dataset", other: "xr.Dataset", own: tuple[str, ...] = ()
) -> tuple[float, float]:
    """Return the 5 and 95 % bounds of the ratio of two steady slips.

    Parameters
    ----------
    result, other : xarray.Dataset
        Results with bands: the numerator and the denominator.
    own : tuple of str
        Prefixes of keys whose values the two do not share.

    Returns
    -------
    tuple of float
        Lower and upper bound; (1, 1) for one result twice, NaN where a band is not known.
    """
    if result is other:
        return 1.0, 1.0
    numerator = _log_changes(result)
    denominator = _log_changes(other)
    if not numerator or not denominator:
        return math.nan, math.nan
    up = 0.0
    down = 0.0
    for key in dict.fromkeys((*numerator, *denominator)):
        a = numerator.get(key, (0.0, 0.0))
        b = denominator.get(key, (0.0, 0.0))
        pairs = [tuple(x - y for x, y in zip(a, b, strict=True))]
        if key.startswith(own):
            pairs = [a, tuple(-x for x in b)]
        for ends in pairs:
            up += max(*ends, 0.0) ** 2
            down += min(*ends, 0.0) ** 2
    ratio = float(result["steady_slip"][0]) / float(other["steady_slip"][0])
    return ratio * math.exp(-math.sqrt(down)), ratio * math.exp(math.sqrt(up))


def _log_changes(result: "xr.Dataset") -> dict[str, tuple[float, ...]]:
    """Return the change of the logarithm of the slip by each quantity, low and high; empty if any is unknown."""
    bands = json.loads(result.attrs.get("band", "{}"))
    slip = float(np.ravel(result["steady_slip"])[0])
    changes = dict[str, tuple[float, ...]]()
    if not slip > 0.0:
        return {}
    for row in bands.get("steady_slip", {}).get("changes", ()):
        if any(value is None or not value > 0.0 for value in row["values"]):
            return {}
        changes[row["key"]] = tuple(math.log(value / slip) for value in row["values"])
    return changes
