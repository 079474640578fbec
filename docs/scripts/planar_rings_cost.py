"""Write planar_rings_cost.csv of docs/trust/dynamics.rst: what rings that yield cost in plane motion beside rigid ones.

0.1 s of the 1032930 at 50 degC, 15 slices, by leapfrog at 1e-5; all rings in turn, five times, and the median of the
ratios to the rigid rings of the same turn. Times are those of the processor. A minute.
"""

import numpy as np
from output import write_table

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.registry import get_model
from rollslip_studies.dynamics.levels.planar import PlanarMotion, PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_studies.motion.time_integration import InitialValueProblem, integrate

TURNS = 5
DURATION = 0.1
TOLERANCE = 1e-5
LIST = {
    "bearing.catalogue": {"bore": 0.15, "outside_diameter": 0.21, "width": 0.028},
    "accuracy.slices": 15,
}


def sleeve(highest: int, outside: str = "230 mm") -> dict[str, object]:
    return {"models.outer_ring": {"model": "annulus", "outside": outside, "harmonics": highest}}


LOBES: dict[str, object] = {"bearing.outer_raceway.form": [{"lobes": 3, "amplitude": "2 um"}]}
TURNING: dict[str, object] = {"bearing.inner_raceway.form": [{"lobes": 2, "amplitude": "2 um"}]}
HOOP: dict[str, object] = {"models.inner_ring": {"model": "annulus", "harmonics": 0}}
RINGS: dict[str, dict[str, object]] = {
    "rigid": {},
    "10 mm sleeve, n = 0": sleeve(0),
    "10 mm sleeve, n up to 2": sleeve(2),
    "10 mm sleeve, n up to 4": sleeve(4),
    "the same, and the hoop of the inner ring": sleeve(4) | HOOP,
    "10 mm sleeve, n up to 6": sleeve(6),
    "thick housing, n up to 4": sleeve(4, "2 m"),
    "thick housing, n up to 6": sleeve(6, "2 m"),
    "bare thin ring, n up to 12": {"models.outer_ring": {"model": "thin", "harmonics": 12}},
    "rigid, three lobes": LOBES,
    "10 mm sleeve, n up to 4, three lobes": sleeve(4) | LOBES,
    "rigid, two lobes of the inner ring, which turn": TURNING,
}


def moving(rings: dict[str, object], friction: str) -> PlanarMotion:
    assembly = assemble(evolve(load_scene("1032930-50C"), LIST | rings, si=True))
    return planar_motion(
        assembly,
        PlanarSettings(inner_ring_mass=5.0),
        FrictionSettings(name=friction, tolerance=1e-2),
    )


def main() -> None:
    rows: dict[str, list[str]] = {}
    for friction in ("effective", "conventional"):
        motions = {name: moving(rings, friction) for name, rings in RINGS.items()}
        seconds = {name: list[float]() for name in motions}
        evaluations = dict[str, int]()
        for _ in range(TURNS):
            for name, motion in motions.items():
                problem = InitialValueProblem(
                    rates=motion.system,
                    y=motion.initial(0.002),
                    atol=TOLERANCE * motion.system.scale,
                )
                times = np.linspace(0.0, DURATION, 51)
                found = integrate(
                    problem, get_model("integrator", "leapfrog"), times, rtol=TOLERANCE
                )
                assert found.outcome == "finished"
                seconds[name].append(found.processor_time)
                evaluations[name] = found.evaluations
        for name, motion in motions.items():
            ratio = np.median(np.array(seconds[name]) / np.array(seconds["rigid"]))
            if name not in rows:
                shapes = 0 if motion.bent is None else len(motion.bent.names) // 2
                rows[name] = [name, f"{shapes}", f"{evaluations[name] / evaluations['rigid']:.2f}"]
            rows[name] += [f"{ratio:.1f}", f"{DURATION / np.median(seconds[name]):.1f}"]
    header = ["rings", "shapes", "evaluations, of rigid rings'"]
    for friction in ("effective", "conventional"):
        header += [f"time, of rigid rings', {friction}", f"times real time, {friction}"]
    write_table("planar_rings_cost", header, rows.values())


if __name__ == "__main__":
    main()
