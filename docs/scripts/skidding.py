"""Write the tables skidding*.csv of docs/trust/skidding.rst, on random scenes.

The scenes are those of plan_proof.py (tests/support/plan_scenes.py), up to a slip of 95 %. For each: where the cage
skids, the critical slip of the curve of each closure, the smaller one of both rings, and where the effective
friction of the raceways lets it skid. Slices and instants are the same for all of it. About ten minutes.
"""

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import attrs
import numpy as np
from output import percent, write_table
from plan_proof import described

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from plan_scenes import points, scene
from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.errors import RollslipError
from rollslip_studies.effective_friction.study import CLOSURES, EffectiveFriction
from rollslip_studies.motion.torque_balance import skidding_onset, torque_balance

COUNT = 224
WORKERS = 2
SCENES = 200
HELD = 64
SLICES = 24
N_POSITIONS = 2
RANGE = 0.95
POINTS = 25
#: Error of the tables of effective friction, over ten.
TABLES = 1e-2
#: Of the drag at which the cage skids: where the two frictions are held against each other at small slip.
SMALL = 0.3
OFF = "limit drag torque [%]", "slip there [points]", "cage speed at 30 % of that drag [%]"


@attrs.frozen
class Found:
    """What came of a scene; ``refused`` is why there is nothing."""

    what: str
    refused: str = ""
    fold: object = None
    critical: dict = attrs.Factory(dict)
    earlier: int = 0
    seconds: float = np.nan


def critical(assembly, closure):
    """Smaller critical slip of both rings; infinite where neither curve has its maximum in the range."""
    study = EffectiveFriction(
        closure=closure, max_cage_slip=RANGE, points=POINTS, map_points=0, skidding_range=0.0
    )
    raceways = study.loaded(assembly, N_POSITIONS)
    slip = slip_grid(RANGE, POINTS)
    slips = [found.slip for found in raceways.critical(slip, raceways.curve(slip))]
    return min((one for one in slips if one == one), default=np.inf)


def maxima_before(assembly, slip):
    """Count smaller maxima of the torque at smaller slips, at which slip would jump."""
    if slip != slip:
        return 0
    return sum(
        jump.slip < slip
        for jump in torque_balance(assembly, N_POSITIONS).loading_branch(RANGE).jumps
    )


def slip_at(balance, drag, end):
    """Smallest slip at which a drag is carried."""
    from scipy.optimize import brentq

    low = 0.0
    for high in slip_grid(end, 12)[1:]:
        if balance.torque(float(high)) >= drag:
            return brentq(
                lambda s: balance.torque(s) - drag if s else -drag, low, float(high), rtol=1e-8
            )
        low = float(high)
    return np.nan


def bearing(x):
    """What a scene is in words, and its bearing; None if no roller is loaded."""
    one = evolve(scene(x), {"accuracy.tolerance": 1e-3})
    fine = assemble(one)
    slices = min(SLICES, fine.slices)
    made = fine.at(
        attrs.evolve(
            fine.resolution, slices=slices, n_positions=N_POSITIONS, table_tolerance=TABLES
        )
    )
    loaded = made.load_distribution(N_POSITIONS).inner_force.any()
    return described(one).rpartition(";")[0], made if loaded else None


def look(x):
    """Where the cage of a scene skids, and the critical slips of its curves."""
    try:
        what, assembly = bearing(x)
        if assembly is None:
            return Found(what, refused="no roller is loaded")
        begin = time.process_time()
        fold = skidding_onset(torque_balance(assembly, N_POSITIONS), RANGE, "")
        seconds = time.process_time() - begin
        of_curves = {closure: critical(assembly, closure) for closure in CLOSURES}
        return Found(what, "", fold, of_curves, maxima_before(assembly, fold.slip), seconds)
    except RollslipError as error:
        return Found("", refused=str(error))


def hold(given):
    """What effective friction makes of a scene: errors of limit drag torque, its slip and the cage speed."""
    x, fold = given
    _, assembly = bearing(x)
    try:
        effective = skidding_onset(torque_balance(assembly, N_POSITIONS, effective=True), RANGE, "")
        exact, simple = (
            torque_balance(assembly, N_POSITIONS, effective=effective)
            for effective in (False, True)
        )
        slips = [slip_at(balance, SMALL * fold.drag, fold.slip) for balance in (exact, simple)]
    except RollslipError:
        return None
    speed = (1.0 - slips[1]) / (1.0 - slips[0]) - 1.0
    return effective.drag / fold.drag - 1.0, effective.slip - fold.slip, speed


def quantiles(values):
    """Median, 90 % and largest, in points."""
    return (
        [f"{100 * np.quantile(values, q):.1f}" for q in (0.5, 0.9, 1.0)]
        if len(values)
        else ["none"] * 3
    )


def main():
    """Look at all scenes and write the tables."""
    every = points(COUNT)
    with ProcessPoolExecutor(WORKERS) as pool:
        found = list(zip(every, pool.map(look, every), strict=True))
        known = [(x, f) for x, f in found if not f.refused][:SCENES]
        away = [(x, f) for x, f in known if f.fold.slip == f.fold.slip]
        closures([f for _, f in known], [f for _, f in away])
        print(f"{len(found)} scenes, {len(known)} known, {len(away)} of them skid")
        print(f"{sum(f.earlier > 0 for _, f in away)} have a smaller maximum before")
        print(f"time of the processor: {1e3 * np.median([f.seconds for _, f in known]):.0f} ms")
        held = [
            (f, off)
            for (_, f), off in zip(
                away, pool.map(hold, [(x, f.fold) for x, f in away[:HELD]]), strict=False
            )
        ]
    effective_friction([(f, off) for f, off in held if off is not None])


def closures(known, away):
    """Write what the critical slips of the closures are beside the slips at which skidding begins."""
    write_table(
        "skidding",
        ["scene", "what", "skids from [%]", "drag [N m]", *(f"{c} [%]" for c in CLOSURES)],
        [
            [
                k,
                f.what,
                percent(f.fold.slip),
                f"{f.fold.drag:.4g}",
                *(
                    "beyond" if np.isinf(f.critical[c]) else percent(f.critical[c])
                    for c in CLOSURES
                ),
            ]
            for k, f in enumerate(known)
        ],
    )
    off = {c: np.array([f.critical[c] - f.fold.slip for f in away]) for c in CLOSURES}
    size = np.array([np.abs(off[c]) for c in CLOSURES])
    ratio = {c: np.array([f.critical[c] / f.fold.slip for f in away]) for c in CLOSURES}
    rows = []
    for k, c in enumerate(CLOSURES):
        there = np.isfinite(off[c])
        unsafe = off[c] > 0.0
        rows.append(
            [
                c,
                np.count_nonzero(size.argmin(axis=0) == k),
                *quantiles(size[k][there]),
                f"{np.count_nonzero(unsafe)} of {len(away)}",
                *quantiles(off[c][unsafe & there]),
                f"{np.median(ratio[c][there]):.2f}",
                np.count_nonzero(~there),
            ]
        )
    header = [
        "closure", "nearest", "off, median [points]", "off, 90 %", "off, most", "on the unsafe side",
        "by, median [points]", "by, 90 %", "by, most", "over the slip at which skidding begins, median", "no maximum",
    ]  # fmt: skip
    write_table("skidding_closures", header, rows)


def effective_friction(held):
    """Write what effective friction makes of skidding."""
    write_table(
        "skidding_effective",
        ["what", "skids from [%]", *OFF],
        [
            [
                f.what,
                percent(f.fold.slip),
                f"{100 * drag:+.2f}",
                f"{100 * slip:+.1f}",
                f"{100 * speed:+.3f}",
            ]
            for f, (drag, slip, speed) in held
        ],
    )
    rows = []
    for name, values in zip(OFF, np.abs(np.array([off for _, off in held])).T, strict=True):
        there = values[np.isfinite(values)]
        rows.append(
            [name, *(f"{100 * np.quantile(there, q):.2g}" for q in (0.5, 0.9, 1.0)), len(there)]
        )
    write_table("skidding_effective_summary", ["off", "median", "90 %", "most", "scenes"], rows)


if __name__ == "__main__":
    main()
