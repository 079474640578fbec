"""Write rings.csv, rings_tight, rings_play and rings_cost of docs/trust/rings.rst: what rings do to slip and drag.

Bearing 1032930, 15 slices; ten minutes. tests/plugins/test_rings.py and test_published_slip.py hold some cells.
"""

import sys
import time
from functools import partial
from itertools import product

import numpy as np
from output import write_table

from rollslip import evolve, load_scene, run
from rollslip.bearing.assembly import assemble
from rollslip.results.text import two_digits
from rollslip_studies.steady_slip.study import SteadySlip

BASE = {
    "accuracy.slices": 15,
    "bearing.catalogue": {"bore": 0.15, "outside_diameter": 0.21, "width": 0.028},
}
#: Lobes, preload that they make [um]; nearest to the rollers across the load or at 60 degrees from it.
FORMS = ((0, 0), (2, 20), (3, 20), (2, 50), (3, 50))
#: Thickness of a housing of steel [mm]; none for a rigid ring.
HOUSINGS = (None, 100, 50, 20, 10, 0)
OILED = [
    "petroff-land",
    "rolling-resistance",
    {"model": "churning", "oil_fraction": 0.01, "density": 930.0},
]


def held(thickness, bore=None, **more):
    """Models of rings in a housing of a thickness [mm], None for rigid; with a bore [mm] the inner one on a shaft."""
    found = {}
    if thickness is not None:
        found["models.outer_ring"] = {
            "model": "annulus",
            "outside": 0.21 + 2e-3 * thickness,
            **more,
        }
    if bore is not None:
        found["models.inner_ring"] = {"model": "annulus", "bore": 1e-3 * bore, **more}
    return found


def lobed(lobes, preload):
    """A form that leaves a preload [um] of the diameter."""
    where = {
        "lobes": lobes,
        "amplitude": f"{preload / 2} um",
        "angle": f"{180 / lobes if lobes == 3 else 90} deg",
    }
    return {"bearing.outer_raceway.form": [where]}


def solved(name, changes):
    """Slip [%], largest drag [N m] and pressure on the inner ring [MPa] of a shipped scene with changes."""
    bearing = assemble(evolve(load_scene(name), BASE | changes, si=True))
    result = SteadySlip(points=13).run(bearing)
    b = bearing.scene.bearing
    radius = 1.0 / (2.0 / b.roller_diameter + 2.0 / b.inner_raceway_diameter)
    load = bearing.load_distribution(4).inner_force.max() / b.roller_length  # straight rollers
    pressure = np.sqrt(load * b.material.elastic_modulus / 1.82 / np.pi / radius)
    slips = result.steady_slip.to_numpy()
    return (
        100.0 * float(slips[0]) if slips.size else float("nan"),
        float(result.limit_drag),
        pressure / 1e6,
    )


def lobes_and_housings():
    """Slip and largest drag over lobes and housing."""
    rows = []
    for name, thickness in product(("1032930-50C", "1032930-70C"), HOUSINGS):
        cells = []
        for lobes, preload in FORMS:
            changes = held(thickness) | (lobed(lobes, preload) if lobes else {})
            slip, drag, _ = solved(name, changes)
            cells.append(f"{two_digits(slip)} %; {two_digits(drag)} N m")
        housing = "rigid" if thickness is None else f"{thickness} mm" if thickness else "none"
        rows.append((name[8:10] + " °C", housing, *cells))
        print(*rows[-1], sep=" | ", flush=True)
    header = [f"{lobes} lobes; {preload} um" if lobes else "round" for lobes, preload in FORMS]
    write_table("rings", ("at", "housing", *header), rows)


def tight():
    """The tightness that Belomytcev reports, over the housings and shafts that may be."""
    rows = []
    places = [("rigid", None, None), *((f"bare; bore {bore}", t, bore) for t, bore in ((0, 150),))]
    places += [(f"{t} mm; shaft with a bore of 120 mm", t, 120) for t in (5, 15)]
    for place, thickness, bore in places:
        cells = []
        for preload, drags in product((46.4, 55.8), (OILED[:1], OILED)):
            state = {
                "operation.radial_load": "1037 N",
                "operation.inner_speed": "10000 rpm",
                "cage.drag": drags,
            }
            state["bearing.radial_clearance"] = f"{-preload} um"
            slip, _, pressure = solved("1032930-70C", state | held(thickness, bore, harmonics=0))
            cells += (
                [f"{two_digits(slip)} %"]
                if len(drags) > 1
                else [f"{pressure:.0f} MPa", f"{two_digits(slip)} %"]
            )
        rows.append((place.partition(";")[0] if thickness == 0 else place, *cells))
        print(*rows[-1], sep=" | ", flush=True)
    columns = [
        f"{what}, {preload} um"
        for preload in (46.4, 55.8)
        for what in ("pressure", "slip", "slip, more drags")
    ]
    write_table("rings_tight", ("rings", *columns), rows)


def play():
    """Slip over preload by how the hoop yields."""
    rows = []
    for place, thickness, bore in (
        ("rigid", None, None),
        ("10 mm, solid shaft", 10, 0),
        ("bare", 0, 150),
    ):
        slips = [
            solved(
                "1032930-50C",
                held(thickness, bore, harmonics=0) | {"bearing.radial_clearance": f"{-tight} um"},
            )[0]
            for tight in (0, 5, 10, 20)
        ]
        rows.append((place, *(f"{two_digits(slip)} %" for slip in slips)))
        print(*rows[-1], sep=" | ", flush=True)
    write_table("rings_play", ("rings", "0 um", "-5 um", "-10 um", "-20 um"), rows)


def cost():
    """Processor time beside rigid rings, in turn: of equilibria and of whole runs."""
    rows = []
    kept = {"accuracy.tolerance": 1e-3, "accuracy.slices": 15}
    states = {
        "round": {},
        "20 um tight": {"bearing.radial_clearance": "-20 um"},
        "2 lobes; 50 um": lobed(2, 50),
    }
    whole = {
        "effective-friction": {},
        "steady-slip": {},
        "dynamics": {"study.dynamics.duration": "1 s"},
    }
    for (state, changes), (housing, thickness) in product(
        states.items(), {"10 mm": 10, "none": 0}.items()
    ):
        yielding = held(thickness)
        few = {"models.outer_ring": yielding["models.outer_ring"] | {"harmonics": 3}}
        scenes = [
            evolve(load_scene("1032930-50C"), BASE | kept | changes | more, si=True)
            for more in ({}, few, yielding)
        ]
        bearings = [assemble(scene) for scene in scenes]
        counts = [bearing.load_case(8).rings for bearing in bearings]
        cells = [str(rings.parity.size) for rings in counts[1:]]
        solves = [partial(bearing.load_distribution, 32, cage_speed=300.0) for bearing in bearings]
        cells += [f"{ratio(solves[0], solves[k]):.1f}" for k in (1, 2)]
        for study, own in whole.items():
            pair = [
                partial(run, evolve(scene, own, si=True), study) for scene in (scenes[0], scenes[2])
            ]
            cells.append(f"{ratio(*pair, times=2):.1f}")
        rows.append((state, housing, *cells))
        print(*rows[-1], sep=" | ", flush=True)
    header = (
        "few shapes",
        "shapes",
        "equilibrium; few",
        "equilibrium",
        *(f"run of {study}" for study in whole),
    )
    write_table("rings_cost", ("raceway", "housing", *header), rows)


def ratio(one, other, times=5):
    """Least processor time of another over that of one, called in turn."""
    spent = [[], []]
    for _ in range(times):
        for k, call in enumerate((one, other)):
            begin = time.process_time()
            call()
            spent[k].append(time.process_time() - begin)
    return min(spent[1]) / min(spent[0])


if __name__ == "__main__":
    for part in (lobes_and_housings, tight, play, cost):
        if sys.argv[1:] in ([], [part.__name__]):
            part()
