"""Write docs/tables/surface_damage.csv: measures of damage of the three scenes, at the steady slip and at others."""

from output import write_table

from rollslip import evolve, load_scene, run

SCENES = ("1032930-30C", "1032930-50C", "1032930-70C")
SLIPS = (None, 0.1, 0.3)
MEASURES = ("power-density", "pass-energy", "film-parameter", "flash-temperature")
#: What a measure is divided by to be read.
READ = {"power-density": 1e6}


def row(name, slip):
    changes = {"models.damage": list(MEASURES)} | (
        {} if slip is None else {"study.surface-damage.cage_slip": slip}
    )
    result = run(evolve(load_scene(name), changes, si=True), "surface-damage")
    values = (
        f"{float(result.worst.sel(measure=measure, ring=ring)) / READ.get(measure, 1.0):.3g}"
        for measure in MEASURES
        for ring in ("inner", "outer")
    )
    return name, "steady" if slip is None else "given", f"{100 * float(result.slip):.3g}", *values


if __name__ == "__main__":
    head = (
        "scene", "slip is", "cage slip [%]", "inner q [MW/m2]", "outer q [MW/m2]", "inner e [J/m2]", "outer e [J/m2]",
        "inner Lambda", "outer Lambda", "inner dT [K]", "outer dT [K]",
    )  # fmt: skip
    write_table("surface_damage", head, [row(name, slip) for name in SCENES for slip in SLIPS])
