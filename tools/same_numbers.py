"""Record where curves of random bearings are largest or balanced, and hold two records against each other.

``python tools/same_numbers.py record FILE [SCENES]`` keeps of scenes of tests/support/loading_branch_scenes.py the
largest drag, where the cage runs away, steady slips, least loads, critical slips, what is said of each, and at how many
slips rollers and friction were evaluated. ``... compare FILE FILE`` tells how far these moved and whose words differ.
"""

import json
import math
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import attrs
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

import loading_branch_scenes as scenes
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip_studies.effective_friction import raceways, study
from rollslip_studies.motion.spins import Motions
from rollslip_studies.motion.torque_balance import running, skidding_onset
from rollslip_studies.steady_slip.minimum_load import minimum_load

RANGE = 0.95
SCENES = 1000
LOADS = 10  # one in so many scenes is asked for its least load
CLOSURES = "outer-rolling", "epicyclic", "free-roller"
CRITICAL = frozenset(
    {"critical_cage_slip", "critical_friction", "critical_status", "first_maximum_slip"}
)
counted = {"rollers": 0, "friction": 0}


def count() -> None:
    """Count the slips at which rollers and friction are evaluated."""
    at = Motions.find
    mean_friction = raceways.mean_friction

    def counted_at(self: Motions, slips: Any, starts: Any = None) -> Any:
        counted["rollers"] += slips.size
        return at(self, slips, starts)

    def counted_friction(rings: Any) -> Any:
        counted["friction"] += sum(len(sliding) for *_, sliding in rings)
        return mean_friction(rings)

    Motions.find = counted_at  # type: ignore[method-assign]
    raceways.mean_friction = counted_friction


def found(number: int) -> Iterator[tuple[str, Any]]:
    """Values and words of a scene, by name."""
    scene = scenes.wide(number)
    balance = scenes.balance(scene)
    begin = time.process_time()
    way = balance.loading_branch(RANGE)
    away = skidding_onset(balance, RANGE, "")
    steady = way.find_steady_motions(balance.drag)
    runs = running(balance, RANGE)
    yield "runaway slip", away.slip
    yield "runaway drag", away.drag
    yield "jumps to", away.slip_after
    yield "runaway error", away.error
    yield "runaway status", away.status
    yield "largest slip", way.maximum[0]
    yield "largest drag", way.maximum[1]
    yield "steady slips", len(steady)
    yield "held", str([one.slope > 0.0 for one in steady])
    for k, one in enumerate(steady):
        yield f"steady slip {k}", one.slip
        yield f"steady torque {k}", one.torque
    yield "running status", runs.status
    yield "seconds of rollers", time.process_time() - begin
    begin = time.process_time()
    requested = attrs.evolve(
        study.EffectiveFriction.from_scene(scene), closure=CLOSURES[number % len(CLOSURES)]
    )
    made = assemble(scene)
    made = made.at(attrs.evolve(made.resolution, slices=min(12, made.slices), n_positions=4))
    critical, _ = (study.EffectiveFriction.run_batch([(requested, made)], CRITICAL) or [])[0]
    for name in sorted(CRITICAL):
        yield from (
            (f"{name} {ring}", value) for ring, value in enumerate(critical[name][1].tolist())
        )
    yield "seconds of friction", time.process_time() - begin
    if number % LOADS == 0:

        def loaded(load: float) -> Any:
            return scenes.balance(
                scenes.evolve(scene, {"operation.radial_load": load}), inertia=False
            )

        load, status, _ = minimum_load(loaded, scene.operation.radial_load, 0.1)
        yield "least load", load
        yield "least load status", status


def record(file: str, number: int = SCENES) -> None:
    """Write what is found of the scenes to a file."""
    count()
    rows = []
    for k in range(number):
        row = dict[str, Any]()
        before = dict(counted)
        try:
            for name, value in found(k):
                row[name] = value
        except (RollslipError, ArithmeticError, LookupError) as error:
            row["refused"] = str(error)
        rows.append(
            row | {f"evaluations of {name}": counted[name] - before[name] for name in counted}
        )
    Path(file).write_text(json.dumps(rows), encoding="utf-8")


def compare(one: str, two: str) -> None:
    """Print by how much values moved, and whose words are others."""
    pairs = list(
        zip(
            *(json.loads(Path(file).read_text(encoding="utf-8")) for file in (one, two)),
            strict=True,
        )
    )
    moved = dict[str, list[float]]()
    others = list[str]()
    for k, (before, after) in enumerate(pairs):
        if before.keys() != after.keys():
            others.append(f"{k}: {sorted(before.keys() ^ after.keys())}")
        for name in before.keys() & after.keys():
            a = before[name]
            b = after[name]
            if (
                not isinstance(a, float)
                or not isinstance(b, float)
                or math.isnan(a) != math.isnan(b)
            ):
                if a != b and not name.startswith("evaluations"):
                    others.append(f"{k}: {name}: {a} | {b}")
            elif not name.startswith("seconds") and not math.isnan(a):
                moved.setdefault(name.rstrip("0123456789 "), []).append(
                    0.0 if a == b else abs(b - a) / abs(a or b)
                )
    print(
        f"{'moved, relative':28}{'scenes':>8}{'the same':>10}{'middle':>12}{'95 %':>12}{'most':>12}"
    )
    for name, by in sorted(moved.items()):
        numbers = np.quantile(by, [0.5, 0.95, 1.0])
        print(
            f"{name:28}{len(by):8}{by.count(0.0):10}"
            + "".join(f"{value:12.2g}" for value in numbers)
        )
    for name in sorted(
        {name for pair in pairs for name in pair[0] if name.startswith(("seconds", "evaluations"))}
    ):
        sums = [sum(row.get(name, 0.0) for row in rows) for rows in zip(*pairs, strict=True)]
        print(f"{name}: {sums[0]:.6g}, then {sums[1]:.6g} ({sums[1] / (sums[0] or 1.0):.3f})")
    print(f"others: {len(others)}", *others, sep="\n")


if __name__ == "__main__":
    what, *files = sys.argv[1:]
    record(files[0], *map(int, files[1:])) if what == "record" else compare(*files)
