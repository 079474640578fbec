"""Write the tables coupled_fold*.csv of docs/theory/heat.rst: what bulk temperatures make of where skidding begins.

The scenes are those of plan_proof.py (tests/support/plan_scenes.py) with the built-in network, once in a bath and
once with a flow of oil that enters at the scene's temperature. At every cage slip the network settles with the losses
that belong to it, and the rollers carry a torque: its largest value is the fold of the coupled system. Beside it stand
the folds of temperatures that are held: as the scene gives them, and as they are where the cage runs with its own drag.
What a further drag takes off the cage is work that leaves the bearing. Some two minutes.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import attrs
import numpy as np
from output import percent, write_table
from plan_proof import described
from scipy.optimize import minimize_scalar

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

from plan_scenes import points, scene
from rollslip import evolve
from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.errors import RollslipError
from rollslip.studies.thermal_balance.model import PLACES, thermal_model
from rollslip_studies.motion.losses import power_balance
from rollslip_studies.motion.torque_balance import skidding_onset, torque_balance

COUNT = 128
WORKERS = 2
SCENES = 100
SLICES = 12
RANGE = 0.95
POINTS = 41
COOLED = {"bath": "network", "20 g/s": {"model": "network", "oil_flow": "20 g/s"}}
#: When temperatures are settled [K], and after how many rounds they never are.
SETTLED = 0.02
ROUNDS = 60


class UnsettledError(RollslipError):
    """The network finds no temperatures at a slip."""


@attrs.frozen
class Found:
    """Folds of a scene: slip, torque and oil temperature of each; or why there is none."""

    what: str
    refused: str = ""
    slip: float = np.nan
    warmed: float = np.nan
    given: object = None
    held: object = None
    coupled: tuple = ()
    ended: str = ""


class Coupled:
    """A bearing whose temperatures settle at every cage slip."""

    def __init__(self, one):
        made = assemble(one)
        slices = min(SLICES, made.slices)
        self.made = made.at(attrs.evolve(made.resolution, slices=slices, n_positions=1))
        self.scene, self.model = one, thermal_model(one).of(self.made)
        self.start = self.model.start(one)

    def at(self, T):
        """The bearing at temperatures of the nodes."""
        changed = evolve(self.scene, self.model.changes(T, self.scene), si=True)
        return assemble(changed, self.made.resolution, like=self.made)

    def cooled(self, heat, guess):
        """Temperatures at which the network carries these losses away."""
        T = guess.copy()
        n = guess.size
        for _ in range(20):
            flow = self.model.inflows(T, heat)
            columns = [self.model.inflows(T + step, heat) - flow for step in np.eye(n)]
            moved = np.linalg.solve(np.array(columns).T, -flow)
            T = T + moved
            if np.abs(moved).max() <= 1e-3 * SETTLED:
                return T
        raise UnsettledError("the network does not settle")

    def settled(self, slip, T):
        """Temperatures at a slip, and the torque that the rollers carry there and the drag of the scene [N m]."""
        before = None
        for _ in range(ROUNDS):
            balance = torque_balance(self.at(T), 1)
            orbit = balance.orbit(slip)
            power = power_balance(balance, orbit)
            moved = self.cooled({place: power.heat(place) for place in PLACES}, T) - T
            if np.abs(moved).max() <= SETTLED:
                return T, orbit.torque, balance.drag(slip)
            mixed = moved
            if before is not None:  # Anderson's acceleration with one step behind
                change = moved - before[1]
                step = T - before[0]
                mixed = moved - (moved @ change) / (change @ change) * (step + change)
            before = (T, moved)
            T = T + np.clip(mixed, -20.0, 20.0)
        raise UnsettledError(f"no temperatures at a slip of {slip:.3g}")


def folded(coupled):
    """Fold of the coupled system, what ended its curve, and slip and temperatures at which the cage runs."""
    T = coupled.start
    known = []
    ended = ""
    for slip in slip_grid(RANGE, POINTS)[1:]:
        try:
            T, torque, drag = coupled.settled(float(slip), T)
        except RollslipError as error:
            ended = str(error)
            break
        known.append((float(slip), torque, drag, T))
    if not known:
        raise UnsettledError(ended)
    carries = next(
        (k for k, (_, torque, drag, _) in enumerate(known) if torque + drag >= 0.0), None
    )
    if carries is None:
        raise UnsettledError("the rollers do not carry the drag of the scene at any slip")
    slip, torque, drag, T = known[carries]
    below = 0.0
    left = drag
    if carries:
        below = known[carries - 1][0]
        left = known[carries - 1][1] + known[carries - 1][2]
    slip = below + (slip - below) * left / (left - torque - drag)
    runs = coupled.settled(slip, T)[0]
    best = max(range(len(known)), key=lambda k: known[k][1])
    if best == len(known) - 1:
        return known[best], ended or "no fold in the range", slip, runs
    low = known[best - 1][0] if best else 0.5 * known[0][0]

    def lost(at):
        return -coupled.settled(at, known[best][3])[1]

    top = minimize_scalar(
        lost, bounds=(low, known[best + 1][0]), method="bounded", options={"xatol": 1e-3}
    )
    T, torque, drag = coupled.settled(float(top.x), known[best][3])
    return (float(top.x), torque, drag, T), "", slip, runs


def look(given):
    """Folds of a scene with one cooling."""
    x, cooling = given
    try:
        one = evolve(
            scene(x), {"accuracy.tolerance": 1e-2, "models.thermal": COOLED[cooling]}, si=True
        )
        what = described(one).rpartition(";")[0]
        coupled = Coupled(one)
        fold, ended, slip, runs = folded(coupled)
        held = skidding_onset(torque_balance(coupled.at(runs), 1), RANGE, "")
        as_given = skidding_onset(torque_balance(coupled.made, 1), RANGE, "")
        oil = coupled.model.nodes.index("oil")
        found = fold[0], fold[1], fold[3][oil] - runs[oil]
        warmed = runs[oil] - one.operation.temperature
        return Found(what, "", slip, warmed, as_given, held, found, ended)
    except RollslipError as error:
        return Found("", refused=str(error))


def quantiles(values, unit=1.0):
    """Least, median and largest."""
    return (
        [f"{unit * np.quantile(values, q):.3g}" for q in (0.0, 0.1, 0.5, 0.9, 1.0)]
        if len(values)
        else ["none"] * 5
    )


def main():
    """Look at all scenes and write the tables."""
    every = points(COUNT)
    rows = []
    summary = []
    with ProcessPoolExecutor(WORKERS) as pool:
        for cooling in COOLED:
            all_found = list(pool.map(look, [(x, cooling) for x in every], chunksize=2))
            known = [f for f in all_found if not f.refused][:SCENES]
            rows += [row(cooling, k, f) for k, f in enumerate(known)]
            summary += summed(cooling, known, [f.refused for f in all_found if f.refused])
    write_table("coupled_fold", [
        "oil", "scene", "what", "runs at [%]", "oil warmer there [K]", "given: drag [N m]", "slip [%]",
        "held: drag [N m]", "slip [%]", "coupled: drag [N m]", "slip [%]", "oil warmer than where it runs [K]",
        "what ended it",
    ], rows)  # fmt: skip
    write_table(
        "coupled_fold_summary",
        ["oil", "what", "least", "10 %", "median", "90 %", "largest"],
        summary,
    )


def row(cooling, k, f):
    """Cells of a scene."""
    return [
        cooling, k, f.what, percent(f.slip, 2), f"{f.warmed:.1f}", f"{f.given.drag:.4g}", percent(f.given.slip),
        f"{f.held.drag:.4g}", percent(f.held.slip), f"{f.coupled[1]:.4g}", percent(f.coupled[0]),
        f"{f.coupled[2]:.1f}", f.ended,
    ]  # fmt: skip


def summed(cooling, known, refused):
    """Rows of the summary of one cooling."""
    both = [f for f in known if not f.ended and np.isfinite(f.held.slip)]
    given = [f for f in both if np.isfinite(f.given.slip)]
    print(cooling, len(known), "scenes,", len(refused), "refused,", len(both), "with both folds,",
          sum(bool(f.ended) for f in known), "without a coupled one,",
          sum(not np.isfinite(f.held.slip) for f in known), "without that of held temperatures")  # fmt: skip
    for text in sorted(
        {one.split(":")[0][:90] for one in refused + [f.ended for f in known if f.ended]}
    ):
        print("   ", text)
    return [
        [
            cooling,
            "oil warmer than given, where the cage runs [K]",
            *quantiles([f.warmed for f in both]),
        ],
        [cooling, "and warmer still at the fold [K]", *quantiles([f.coupled[2] for f in both])],
        [cooling, "coupled over held drag", *quantiles([f.coupled[1] / f.held.drag for f in both])],
        [
            cooling,
            "coupled over given drag",
            *quantiles([f.coupled[1] / f.given.drag for f in given]),
        ],
        [
            cooling,
            "coupled less held slip [points]",
            *quantiles([f.coupled[0] - f.held.slip for f in both], 100.0),
        ],
    ]


if __name__ == "__main__":
    main()
