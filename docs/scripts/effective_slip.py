"""Write effective_slip.csv of docs/trust/dynamics.rst: what effective friction and play add to small slips.

Ten minutes on one core. Each scene moves for a second, from a start without slip, with both frictions and at
levels cage-set and pocket, with films or metal in the pockets; slips are means over its last half.
"""

from output import write_table

from rollslip import evolve, load_scene
from rollslip.planning.execution import execute
from rollslip.planning.new_scene import new
from rollslip.planning.plan import plan

#: Scene -> how it is named in the table.
SCENES = {
    "NU 2210, 3000 rpm, 1.5 kN": new(
        "NU2210", oil="iso-vg-68", speed="3000 rpm", load="1.5 kN", temperature="70 degC"
    ),
    "NU 310, 2000 rpm, 1.2 kN": new(
        "NU310", oil="iso-vg-100", speed="2000 rpm", load="1200 N", temperature="80 degC"
    ),
    "NU 422, 600 rpm, 3 kN": new(
        "NU422", oil="iso-vg-220", speed="600 rpm", load="3 kN", temperature="50 degC"
    ),
    "NU 1012, 8000 rpm, 800 N": new(
        "NU1012", oil="iso-vg-32", speed="8000 rpm", load="800 N", temperature="80 degC"
    ),
    "gearbox": load_scene("gearbox"),
    "turbine": load_scene("turbine"),
    "1032930-50C": load_scene("1032930-50C"),
}
#: Column -> settings of the motion.
MOTIONS = {
    "cage-set, conventional": ("cage-set", "conventional", "film"),
    "cage-set, effective": ("cage-set", "effective", "film"),
    "pocket, conventional": ("pocket", "conventional", "film"),
    "pocket, effective": ("pocket", "effective", "film"),
    "pocket, metal": ("pocket", "conventional", "metal"),
}
DURATION = 1.0
#: Scenes that take longer to settle -> their duration [s].
LONGER = {"1032930-50C": 4.0, "turbine": 2.0}


def slip_and_seconds(scene, duration, level, friction, contact):
    """Return the mean slip over the second half of a motion, and the processor time of its integration [s]."""
    changes = {"level": level, "friction": friction, "duration": duration, "points": 2001}
    moved = evolve(
        scene,
        {"cage.pocket_contact": contact, "accuracy.tolerance": 1e-2}
        | {f"study.dynamics.{name}": value for name, value in changes.items()},
        si=True,
    )
    found = execute(plan(moved, "dynamics"), "dynamics")
    slip = found["cage_slip"].to_numpy()
    return float(slip[slip.size // 2 :].mean()), float(found.attrs["integration_seconds"])


def more(slip, reference):
    """Return by how much a slip exceeds a reference, in per cent."""
    return f"{float(f'{100.0 * (slip / reference - 1.0):.2g}'):+g} %"


def main():
    """Integrate all motions."""
    rows = []
    for name, scene in SCENES.items():
        found = {
            column: slip_and_seconds(scene, LONGER.get(name, DURATION), *settings)
            for column, settings in MOTIONS.items()
        }
        slips = {column: slip for column, (slip, _) in found.items()}
        rigid = slips["cage-set, conventional"]
        film = slips["pocket, conventional"]
        rows.append(
            (
                name,
                f"{100.0 * rigid:.3g} %",
                more(slips["cage-set, effective"], rigid),
                f"{100.0 * film:.3g} %",
                more(slips["pocket, effective"], film),
                more(film, rigid),
                more(slips["pocket, metal"], rigid),
                f"{found['pocket, effective'][1]:.2g}",
                f"{found['pocket, conventional'][1]:.2g}",
            )
        )
        print(*rows[-1], sep=" | ", flush=True)
    head = (
        "bearing",
        "slip, cage-set",
        "by effective friction",
        "slip, pocket",
        "by effective friction there",
        "by play, film",
        "by play, metal",
        "s, effective",
        "s, conventional",
    )
    write_table("effective_slip", head, rows)


if __name__ == "__main__":
    main()
