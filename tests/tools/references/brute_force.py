"""Limits, balances of heat and measures of damage against brute force, on random scenes; brute_force.csv.

    python tests/tools/references/brute_force.py [LIMITS [BALANCES [DAMAGES]]]

- *limit*: the two neighbours between which the campaign tells that a result passes, against Brent's method over single
  runs, each with a plan of its own and a tenth of the tolerance: in the whole range, or to the middle of the next
  passage. Scenes of promise_scenes.py: odd ones keep the least film parameter, even ones the largest effective
  friction, over speed or load. *Within tolerance* is a limit beside both where the result at the nearer one is as near
  to what is asked as accuracy.tolerance.
- *balance*: settled temperatures of study thermal-balance against the heat equations of its network, written anew here
  and solved by damped substitution, with losses of single runs at temperatures that the scene gives, at a tenth of the
  tolerance. Scenes of way_up_scenes.py. Allowed is the share of the rise above the surroundings that both tolerances
  make together, as both are tolerances of friction.
- *damage*: the largest value of each measure at a cage slip of 10 % against four times the slices and twelve times the
  instants. Of these a result claims no error: *coarse* are those farther off than the tolerance of friction.

A row is written as soon as it is known, and the script goes on where it was interrupted. Every scene has at most
20 s of the processor.
"""

import csv
import json
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import attrs
import numpy as np
from scipy.optimize import brentq

sys.path.insert(0, str(Path(__file__).parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).parent))

from accuracy_scenes import TooDearError, finer, stop

import promise_scenes
import way_up_scenes
from rollslip import evolve, limit, run
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
from rollslip.studies.thermal_balance.model import ROLES, thermal_model

#: Seed and first number that nothing else uses, tolerance, and share of a value to which a limit is asked for.
SEED, FIRST, TOLERANCE, WITHIN = 350, 350_000, 1e-3, 2e-3
HEADER = ["what", "scene", "quantity", "told", "reference", "difference", "allowed", "verdict", "seconds"]
#: Change between two substitutions at which temperatures are found [K], and how many there may be.
STILL, MOST = 1e-4, 60
#: Time of the processor that a scene may take [s].
SECONDS = 20.0
#: Links of the network: ends, or the one that the surroundings are beyond.
LINKS = {
    "oil_inner_ring": "oil,inner ring", "oil_rollers": "oil,rollers", "oil_outer_ring": "oil,outer ring",
    "inner_ring_rollers": "inner ring,rollers", "outer_ring_rollers": "outer ring,rollers",
    "inner_ring_shaft": "inner ring,shaft", "outer_ring_housing": "outer ring,housing",
    "shaft_ambient": "shaft", "housing_ambient": "housing",
}  # fmt: skip


def limits(k):
    """Rows of a scene whose limit is searched."""
    scene = evolve(promise_scenes.scene(k, SEED), {"accuracy.tolerance": TOLERANCE})
    name, sense, worst = (("film_parameter", ">=", np.nanmin), ("effective_friction", "<=", np.nanmax))[1 - k % 2]
    key, unit = (("operation.inner_speed", "rad/s"), ("operation.radial_load", "N"))[k // 2 % 2]
    here = getattr(scene.operation, key.partition(".")[2])
    low, high = 0.6 * here, 1.6 * here

    def result(at, tolerance=0.1 * TOLERANCE):
        one = evolve(scene, {key: at, "accuracy.tolerance": tolerance})
        return float(worst(run(one, promise_scenes.STUDY)[name]))

    kept = f"{float(np.sqrt(result(low) * result(high))):.9g}"
    with tempfile.TemporaryDirectory() as folder:
        found = limit(
            scene, {key: f"{low!r} {unit}:{high!r} {unit}:5"}, f"{name} {sense} {kept}", study=promise_scenes.STUDY,
            within=WITHIN, engine="serial", out=Path(folder) / "limit",
        )  # fmt: skip
    edges = sorted(tuple(sorted(pair)) for pair in zip(found.edge_kept.values, found.edge_passed.values, strict=True))
    what = f"{name} {sense} {kept} over {key}"
    if not edges or (found.status != "ok").any():
        yield what, "", "", "", "", "a point failed" if edges else "no passage"
        return
    for n, (a, b) in enumerate(edges):
        begin = 0.5 * (edges[n - 1][1] + a) if n else low
        end = 0.5 * (edges[n + 1][0] + b) if n + 1 < len(edges) else high
        exact = brentq(lambda at: result(at) - float(kept), begin, end, rtol=1e-2 * WITHIN)
        off = max(a - exact, exact - b, 0.0) / exact
        near = abs(result(min((a, b), key=lambda at: abs(at - exact))) / float(kept) - 1.0)
        verdict = "kept" if off == 0.0 else "within tolerance" if near <= TOLERANCE else "missed"
        yield what, f"{a:.8g} to {b:.8g}", f"{exact:.8g}", f"{off:.1e}", f"{b / a - 1.0:.1e}", verdict


def balances(k):
    """Rows of a scene that warms up."""
    kind = way_up_scenes.catalogue if k % 2 else way_up_scenes.free
    flow = {"oil_flow": "20 g/s"} if k % 4 > 1 else {}
    scene = evolve(
        kind(FIRST + k, even=True),
        {"accuracy.tolerance": TOLERANCE, "models.thermal": {"model": "network", **flow}},
    )
    found = run(scene, "thermal-balance")
    told, nodes = found.settled_temperature.values, found.node.values.tolist()
    if np.isnan(told).any():
        yield "temperatures", found.settled_status.item()[:100], "", "", "", "no balance"
        return
    made = assemble(scene)
    model = thermal_model(scene).of(made)
    matrix, fixed = np.zeros((len(nodes),) * 2), np.zeros(len(nodes))
    for name, ends in LINKS.items():
        rows, conductance = [nodes.index(end) for end in ends.split(",")], getattr(model, name)
        matrix[np.ix_(rows, rows)] += conductance * (2.0 * np.eye(len(rows)) - 1.0 if len(rows) == 2 else 1.0)
        fixed[rows] += conductance * model.ambient_temperature * (len(rows) == 1)
    carried = model.oil_flow * model.oil_specific_heat
    matrix[0, 0] += carried
    fixed[0] += carried * model.oil_inlet_temperature
    against = {drag.name: drag.against for drag in made.cage.drags.torques}

    def heat(at):
        known, into = dict(zip(nodes, at.tolist(), strict=True)), dict.fromkeys(nodes, 0.0)
        given = {key: known[part] for key, part in ROLES.items()}
        given |= {"models.thermal": "given", "accuracy.tolerance": 0.1 * TOLERANCE}
        losses = run(evolve(scene, given), "thermal-balance")
        for source, power in zip(losses.source.values.tolist(), losses.loss.values[:, 0].tolist(), strict=True):
            name, _, raceway = source.partition(", ")
            if raceway:  # half of it warms the ring, half the rollers
                parts = raceway.replace("raceway", "ring"), "rollers"
            else:  # rubbing in pockets warms rollers, a drag what bears its reaction, and both the oil
                body = f"{against[name]} ring" if name in against else "rollers"
                parts = body if body in nodes else "oil", "oil"
            for part in parts:
                into[part] += 0.5 * power
        return np.array([into[part] for part in nodes])

    at = model.start(scene)
    for _ in range(MOST):
        step = np.linalg.solve(matrix, fixed + heat(at)) - at
        at = at + 0.6 * step
        if float(np.abs(step).max()) <= STILL:
            break
    else:
        yield "temperatures", "", "", "", "", "no reference"
        return
    worst = int(np.argmax(np.abs(at - told)))
    lasting = found.stable.values == 1
    nearest = float(np.abs(found.temperature.values[:, lasting] - at[:, None]).max(axis=0).min())
    base = model.ambient_temperature if not carried else min(model.ambient_temperature, model.oil_inlet_temperature)
    off, allowed = abs(at[worst] - told[worst]), 1.1 * TOLERANCE * float(np.abs(at - base).max())
    verdict = "kept" if off <= allowed else "another balance" if nearest <= allowed else "missed"
    what = f"temperature of {nodes[worst]} [K]"
    yield what, f"{told[worst]:.5f}", f"{at[worst]:.5f}", f"{off:.1e}", f"{allowed:.1e}", verdict


def damages(k):
    """Rows of a scene whose surfaces are measured."""
    changes = {"accuracy.tolerance": TOLERANCE, "cage.drag": ["churning"]}
    measures = ["power-density", "pass-energy", "flash-temperature"]
    changes |= {"models.damage": measures, "study.surface-damage.cage_slip": 0.1}
    scene = evolve(promise_scenes.scene(k, SEED), changes)
    made = plan(scene, "surface-damage")
    result = execute(made, "surface-damage")
    own = made.estimated["surface-damage"].resolution
    taken = json.loads(result.attrs["resolution"])
    own = attrs.evolve(own, slices=taken["slices"], instants=taken["instants"])
    fine = finer(made.assembly, own, result.assign_attrs(instants=3 * taken["instants"]))  # twelve times
    exact = made.studies["surface-damage"].run(assemble(scene, fine))
    for measure in measures:
        told, reference = (float(one.worst.sel(measure=measure).max()) for one in (result, exact))
        off = abs(told / reference - 1.0)
        verdict = "kept" if off <= TOLERANCE else "coarse"
        yield measure, f"{told:.6g}", f"{reference:.6g}", f"{off:.1e}", f"{TOLERANCE:.0e}", verdict


KINDS = {"limit": limits, "balance": balances, "damage": damages}


def rows(kind, k):
    """Rows of a scene, and what they took."""
    begin = time.process_time()
    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        found = list(KINDS[kind](k))
    except TooDearError:
        found = [("", "", "", "", "", "too dear")]
    except RollslipError as error:
        found = [("", str(error).replace("\n", " ")[:100], "", "", "", "refused")]
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    seconds = f"{time.process_time() - begin:.1f}"
    return [[kind, str(k), *one, seconds] for one in found]


def main(*counts):
    """Judge the scenes that are not known yet and write the table."""
    path = Path(__file__).with_suffix(".csv")
    known = list(csv.reader(path.open(encoding="utf-8")))[1:] if path.exists() else []
    for kind, count in zip(KINDS, counts or (50, 12, 50), strict=False):
        for k in range(int(count)):
            if any(one[:2] == [kind, str(k)] for one in known):
                continue
            known = sorted([*known, *rows(kind, k)], key=lambda one: ([*KINDS].index(one[0]), int(one[1])))
            with path.open("w", newline="", encoding="utf-8") as file:
                csv.writer(file, lineterminator="\n").writerows([HEADER, *known])
    print(Counter((one[0], one[7]) for one in known))


if __name__ == "__main__":
    main(*sys.argv[1:])
