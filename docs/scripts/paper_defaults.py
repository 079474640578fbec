"""Write docs/tables/paper_defaults.csv: the paper's bearing by the models of its scenes, and by defaults.

The defaults are what a scene gets that states neither models, pressure-viscosity law nor drags: geometry, oil and cage
stay as the shipped scenes have them. `note` is what each of these scenes says of it; a test holds it to that.
"""

import tomllib

from output import write_table

from rollslip import evolve, load_scene, run
from rollslip.scene.reading import from_raw

NAMES = ("1032930-30C", "1032930-50C", "1032930-70C")
TOLERANCE = {"accuracy.tolerance": 1e-2}


def by_default(name):
    """A shipped scene without the models, law and drags that it states."""
    raw = tomllib.loads(load_scene(name).text)
    raw.pop("models")
    raw["cage"].pop("drag")
    raw["lubricant"].pop("pressure_viscosity_law")
    return evolve(from_raw(raw, name), TOLERANCE)


def found(scene):
    """Steady slip, drag there [N m], and friction torque [N m]."""
    result = run(scene, "steady-slip")
    return tuple(float(result[name][0]) for name in ("steady_slip", "torque", "friction_torque"))


def note(name):
    """What a scene of the paper says of itself beside the defaults."""
    slip, _, torque = found(by_default(name))
    return (
        "models, law and drags are the paper's or assumed for it; by the defaults of rollslip (Roelands, local "
        "pressure, light contacts, heated inlets, every drag of an oil bath) this cage slips "
        f"{100 * slip:.0f} %, and the friction torque is {torque:.1f} N m"
    )


def main():
    rows = []
    for name in NAMES:
        for models, scene in (
            ("the paper's", evolve(load_scene(name), TOLERANCE)),
            ("defaults of rollslip", by_default(name)),
        ):
            slip, drag, torque = found(scene)
            rows.append((name, models, f"{100 * slip:.3g}", f"{drag:.3g}", f"{torque:.3g}"))
        print(f'note = "{note(name)}"')
    header = ("scene", "models", "slip_percent", "drag_N_m", "friction_torque_N_m")
    write_table("paper_defaults", header, rows)


if __name__ == "__main__":
    main()
