"""Limits, balances of heat and measures of damage against brute force, on random scenes; brute_force.csv.

    python tools/references/brute_force.py [LIMITS [BALANCES [DAMAGES [STEADY]]]]

- *limit*: ten results over five quantities. What is kept is the result of a single run somewhere in the range, with a
  plan of its own and a tenth of the tolerance, so that the limit is known to be passed there: the two neighbours
  between which the campaign tells that it is have to be beside it. Further passages that it tells are held against
  Brent's method over single runs, up to the middle of the next one. *Within tolerance* is a limit beside both where the
  result at the nearer one is as near to what is asked as accuracy.tolerance. *Touched*: there the result turns back,
  and the campaign, which found no passage, says that it may pass the limit unseen; where it found none and a value is
  within tolerance, the result is level.
- *balance*: settled temperatures of study thermal-balance against the heat equations of its network, written anew here
  and solved by substitution with Anderson's acceleration (damped substitution alone leads to the same within 2e-5 K,
  in scenes 0 to 5), with losses at temperatures that the scene gives: each with a steady slip sought for itself, at
  the resolution that a tenth of the tolerance takes, nothing left out. Scenes of loading_branch_scenes.py.
  Allowed is the share
  of the rise above the surroundings that both tolerances make together, as both are tolerances of friction.
- *damage*: the largest value of each measure, or the least film parameter, on the ring where it is off most, at a cage
  slip of 10 % against four times the slices and instants that were taken, and twelve times the instants that were
  planned; *steady damage* at the steady slip that either has. *Told* is one that is off by more than the tolerance,
  but not by more than a warning of the result says.

A row is written as soon as it is known, and the script goes on where it was interrupted, up to so many scenes that are
judged: two of damage (18, 39) are refused, as Roelands's law with a coefficient that does not fall with temperature
lets the viscosity rise with it. A scene has as much time of the processor as SECONDS says.
"""

import csv
import json
import math
import signal
import sys
import tempfile
import time
from collections import Counter
from functools import cache, partial
from itertools import count
from pathlib import Path

import attrs
import numpy as np
from scipy.optimize import brentq, root

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))
sys.path.insert(0, str(Path(__file__).parent))

from accuracy_scenes import TooDearError, finer, stop

import loading_branch_scenes
import promise_scenes
from rollslip import evolve, limit, run
from rollslip.bearing.assembly import assemble
from rollslip.errors import ConvergenceError, DomainError, RollslipError
from rollslip.planning.execution import execute
from rollslip.planning.plan import estimate, plan
from rollslip.results.accounts import account_of
from rollslip.studies.study import study_class
from rollslip.studies.surface_damage.model import OWN
from rollslip.studies.thermal_balance.model import ROLES, thermal_model

#: Seed and first number that nothing else uses, tolerance, and share of a value to which a limit is asked for.
SEED = 350
FIRST = 350_000
TOLERANCE = 1e-3
WITHIN = 2e-3
HEADER = [
    "what",
    "scene",
    "quantity",
    "told",
    "reference",
    "difference",
    "allowed",
    "verdict",
    "seconds",
]
#: What effective friction is asked for curves alone.
CURVES = {"study.effective-friction": {"map_points": 0, "skidding_range": 0.0}}
#: Study, result, which side of the limit is kept, and what the scene has beside: what limits are searched of.
QUESTIONS = (
    ("effective-friction", "film_parameter", ">=", CURVES),
    ("effective-friction", "effective_friction", "<=", CURVES),
    ("surface-damage", "worst", "<=", {"models.damage": ["flash-temperature"]}),
    ("steady-slip", "steady_slip", "<=", {}),
    ("steady-slip", "drag_reserve", ">=", {}),
    ("steady-slip", "film_parameter", ">=", {}),
    ("steady-slip", "friction_torque", "<=", {}),
    ("steady-slip", "minimum_load", "<=", {}),
    (
        "surface-damage",
        "worst",
        "<=",
        {"models.damage": ["power-density"], "study.surface-damage.cage_slip": 0.1},
    ),
    ("thermal-balance", "stationary_temperature", "<=", {"models.thermal": "network"}),
)
#: Key, its unit, and how far to either side of its own value it goes: by a share of that, or by a step.
VARIED = (
    ("operation.inner_speed", "rad/s", 0.4, 0.0),
    ("operation.radial_load", "N", 0.4, 0.0),
    ("lubricant.viscosity_factor", "", 0.3, 0.0),
    ("bearing.radial_clearance", "m", 0.0, 10e-6),
    ("operation.temperature", "K", 0.0, 10.0),
)
#: What is asked of a bearing that warms up.
SETTLED = {"stationary_temperature", "stationary_status"}
#: How temperatures are substituted: until they change by no more [K], how often, the damping, and from how many before.
MIXED = {"fatol": 2e-5, "maxiter": 60, "line_search": None, "jac_options": {"alpha": 0.6, "M": 6}}
#: Time of the processor that a scene may take [s].
SECONDS = {"limit": 600.0, "balance": 300.0, "damage": 240.0, "steady damage": 300.0}
#: Scenes that are judged of each, and verdicts of one that is not.
COUNTS = (50, 50, 50, 20)
UNJUDGED = ("refused", "no slip", "no balance", "no reference", "too dear")
#: Measures of damage; contact temperature and that after AGMA 925 are the sum that the one after ISO is.
MEASURES = [
    "power-density", "pass-energy", "flash-temperature", "film-parameter", {"model": "scuffing-iso", "fzg_stage": 12},
]  # fmt: skip
#: Links of the network: ends, or the one that the surroundings are beyond.
LINKS = {
    "oil_inner_ring": "oil,inner ring", "oil_rollers": "oil,rollers", "oil_outer_ring": "oil,outer ring",
    "inner_ring_rollers": "inner ring,rollers", "outer_ring_rollers": "outer ring,rollers",
    "inner_ring_shaft": "inner ring,shaft", "outer_ring_housing": "outer ring,housing",
    "shaft_ambient": "shaft", "housing_ambient": "housing",
}  # fmt: skip


def limits(k):
    """Rows of a scene whose limit is searched."""
    study, name, sense, own = QUESTIONS[k % len(QUESTIONS)]
    key, unit, fraction, step = VARIED[k // len(QUESTIONS) % len(VARIED)]
    kind = loading_branch_scenes.catalogue if k % 2 else loading_branch_scenes.free
    scene = evolve(
        kind(FIRST + k, even=k % 4 > 0), {"accuracy.tolerance": TOLERANCE, **own}, si=True
    )
    table, name_varied = key.split(".")
    here = getattr(getattr(scene, table), name_varied, 1.0)
    low, high = (
        ((1.0 - fraction) * here, (1.0 + fraction) * here)
        if fraction
        else (here - step, here + step)
    )
    start = low + float(np.random.default_rng([SEED, k]).uniform(0.1, 0.9)) * (high - low)
    worst = np.nanmax if sense == "<=" else np.nanmin
    cls = study_class(study)
    others = cls.outputs.keys() - {name, cls.outputs[name].status, *cls.controlled_outputs.values()}

    @cache
    def result(at, tolerance=0.1 * TOLERANCE):
        made = plan(
            evolve(scene, {key: at, "accuracy.tolerance": tolerance}, si=True),
            study,
            without=others,
        )
        values = execute(made, study)[name].values
        return float(worst(values)) if np.isfinite(values).any() else math.nan

    kept = float(f"{result(start):.9g}")
    shown = f"{name} {sense} {{}} over {key}"
    what = shown.format(f"{kept:.6g}")
    if not math.isfinite(kept):
        yield what, "", "", "", "", "no value"
        return
    unit_kept = cls.outputs[name].unit
    unit_kept = {OWN: "W/m2" if k % 10 == 8 else "K", "1": ""}.get(unit_kept, unit_kept)
    output = f"{kept!r} {unit_kept}"
    with tempfile.TemporaryDirectory() as folder:
        found = limit(
            scene, {key: f"{low!r} {unit}:{high!r} {unit}:5"}, f"{name} {sense} {output}", study=study, within=WITHIN,
            engine="serial", out=Path(folder) / "limit",
        )  # fmt: skip
    edges = sorted(
        tuple(sorted(pair))
        for pair in zip(found.edge_kept.values, found.edge_passed.values, strict=True)
    )
    if not edges or (found.status != "ok").any():
        course = " ".join(account_of(found).topics(found).get("course", []))
        nearest = float(np.nanmin(np.abs(found.result / kept - 1.0)))
        verdict = (
            "within tolerance"
            if nearest <= TOLERANCE
            else "touched"
            if "turns back" in course
            else "missed"
        )
        verdict = "a point failed" if (found.status != "ok").any() else verdict
        yield what, "", f"{start:.8g}", "", "", verdict
        return
    nearest = min(edges, key=lambda edge: abs(0.5 * sum(edge) - start))
    for n, (a, b) in enumerate(edges):
        begin = 0.5 * (edges[n - 1][1] + a) if n else low
        end = 0.5 * (edges[n + 1][0] + b) if n + 1 < len(edges) else high
        exact = (
            start
            if (a, b) == nearest
            else brentq(lambda at: result(at) - kept, begin, end, rtol=1e-2 * WITHIN)
        )
        off = max(a - exact, exact - b, 0.0) / (high - low)
        near = abs(result(min((a, b), key=lambda at: abs(at - exact))) / kept - 1.0)
        verdict = (
            "kept" if off == 0.0 else "within tolerance" if near <= 1.1 * TOLERANCE else "missed"
        )
        yield (
            what,
            f"{a:.8g} to {b:.8g}",
            f"{exact:.8g}",
            f"{off:.1e}",
            f"{(b - a) / (high - low):.1e}",
            verdict,
        )


def balances(k):
    """Rows of a scene that warms up."""
    kind = loading_branch_scenes.catalogue if k % 2 else loading_branch_scenes.free
    study = study_class("thermal-balance")
    flow = {"oil_flow": "20 g/s"} if k % 4 > 1 else {}
    scene = evolve(
        kind(FIRST + k, even=True),
        {"accuracy.tolerance": TOLERANCE, "models.thermal": {"model": "network", **flow}},
        si=True,
    )
    found = execute(
        plan(scene, "thermal-balance", without=study.outputs.keys() - SETTLED), "thermal-balance"
    )
    told = found.stationary_temperature.values
    nodes = found.node.values.tolist()
    if np.isnan(told).any():
        yield "temperatures", found.stationary_status.item()[:100], "", "", "", "no balance"
        return
    made = assemble(scene)
    model = thermal_model(scene).of(made)
    matrix = np.zeros((len(nodes),) * 2)
    fixed = np.zeros(len(nodes))
    for name, ends in LINKS.items():
        rows = [nodes.index(end) for end in ends.split(",")]
        conductance = getattr(model, name)
        matrix[np.ix_(rows, rows)] += conductance * (
            2.0 * np.eye(len(rows)) - 1.0 if len(rows) == 2 else 1.0
        )
        fixed[rows] += conductance * model.ambient_temperature * (len(rows) == 1)
    carried = model.oil_flow * model.oil_specific_heat
    matrix[0, 0] += carried
    fixed[0] += carried * model.oil_inlet_temperature
    against = {drag.name: drag.against for drag in made.cage.drags.torques}

    def given(at):
        known = dict(zip(nodes, at.tolist(), strict=True))
        named = {key: known[part] for key, part in ROLES.items()}
        return evolve(
            scene,
            named | {"models.thermal": "given", "accuracy.tolerance": 0.1 * TOLERANCE},
            si=True,
        )

    def heat(at):
        there = assemble(given(at), resolution)
        losses = study.from_scene(there.scene).run(there)
        into = dict.fromkeys(nodes, 0.0)
        if np.isnan(losses.given_slip):
            raise DomainError(losses.given_status.item())
        for source, power in zip(
            losses.source.values.tolist(), losses.loss.values[:, 0].tolist(), strict=True
        ):
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
    for _ in range(2):  # once more with what a run takes where it settled
        own = estimate(study.from_scene(scene), assemble(given(at))).resolution
        resolution = attrs.evolve(
            own, traction="named", boundary=True, inlet_heating=True, light_contacts=True
        )
        with np.errstate(
            invalid="ignore"
        ):  # SciPy divides by a step of nought where nothing is left to do
            settled = root(
                lambda T: np.linalg.solve(matrix, fixed + heat(T)) - T,
                at,
                method="anderson",
                options=MIXED,
            )
        at = settled.x
        if not settled.success:
            yield "temperatures", "", "", "", "", "no reference"
            return
    worst = int(np.argmax(np.abs(at - told)))
    base = (
        model.ambient_temperature
        if not carried
        else min(model.ambient_temperature, model.oil_inlet_temperature)
    )
    off = abs(at[worst] - told[worst])
    allowed = 1.1 * TOLERANCE * float(np.abs(at - base).max())
    verdict = "kept" if off <= allowed else "missed"
    if verdict == "missed":
        every = run(scene, "thermal-balance")
        lasting = every.temperature.values[:, every.stable.values == 1]
        near = (np.abs(lasting - at[:, None]) <= allowed).all(axis=0).any()
        verdict = "another balance" if near else verdict
    what = f"temperature of {nodes[worst]} [K]"
    yield what, f"{told[worst]:.5f}", f"{at[worst]:.5f}", f"{off:.1e}", f"{allowed:.1e}", verdict


def damages(k, slip=0.1):
    """Rows of a scene whose surfaces are measured, at its own steady slip where none is given."""
    changes = {
        "accuracy.tolerance": TOLERANCE,
        "cage.drag": ["churning"],
        "models.damage": MEASURES,
    }
    changes |= {} if slip is None else {"study.surface-damage.cage_slip": slip}
    scene = evolve(promise_scenes.scene(k, SEED), changes, si=True)
    made = plan(scene, "surface-damage")
    result = execute(made, "surface-damage")
    if result.status.item() != "found":
        yield "", result.status.item()[:100], "", "", "", "no slip"
        return
    own = made.choices["surface-damage"].resolution
    planned = own.n_positions
    taken, claimed = (json.loads(result.attrs[name]) for name in ("resolution", "accuracy"))
    claims = {row["result"]: row["found"] for row in claimed}
    own = attrs.evolve(own, slices=taken["slices"], n_positions=taken["n_positions"])
    most = max(taken["n_positions"], 3 * planned)

    def finer_by(times):
        fine = finer(made.assembly, own, result.assign_attrs(n_positions=most), times)
        return made.studies["surface-damage"].run(assemble(scene, fine))

    try:
        exact = finer_by(4)
    except ConvergenceError:  # thousands of slices may find no equilibrium
        exact = finer_by(3)
    for measure in result.measure.values.tolist():
        told, reference = (one.worst.sel(measure=measure).values for one in (result, exact))
        apart = np.abs(told / reference - 1.0)
        ring = int(np.nanargmax(apart))
        name = f"worst {result.meaning.sel(measure=measure).item()}"
        off = float(apart[ring])
        warned = any(
            text.startswith(f"{name} is off by") for text in json.loads(result.attrs["warnings"])
        )
        verdict = (
            "kept" if off <= TOLERANCE else "told" if warned and off <= claims[name] else "silent"
        )
        yield (
            measure,
            f"{told[ring]:.6g}",
            f"{reference[ring]:.6g}",
            f"{off:.1e}",
            f"{TOLERANCE:.0e}",
            verdict,
        )


KINDS = {
    "limit": limits,
    "balance": balances,
    "damage": damages,
    "steady damage": partial(damages, slip=None),
}


def rows(kind, k):
    """Rows of a scene, and what they took."""
    begin = time.process_time()
    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS[kind])
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
    for kind, most in zip(KINDS, counts or COUNTS, strict=False):
        for k in count():
            judged = {one[1] for one in known if one[0] == kind and one[7] not in UNJUDGED}
            if len(judged) >= int(most):
                break
            if any(one[:2] == [kind, str(k)] for one in known):
                continue
            known = sorted(
                [*known, *rows(kind, k)], key=lambda one: ([*KINDS].index(one[0]), int(one[1]))
            )
            with path.open("w", newline="", encoding="utf-8") as file:
                csv.writer(file, lineterminator="\n").writerows([HEADER, *known])
    print(Counter((one[0], one[7]) for one in known))


if __name__ == "__main__":
    main(*sys.argv[1:])
