"""Write the tables and the figure of docs/trust/dynamics.rst on friction by three names and on steady slip.

Everything is run from the shipped scene 1032930-50C; only what a column names is changed.

- dynamics_figure_4.csv, dynamics_figure_4.svg: cage and rollers from the same start with conventional and with
  effective friction, as in Fig. 4 of the paper, beside steady-slip; how far apart they are, how well the ledgers close;
- dynamics_cost.csv: what the three frictions cost, against each other and against real time;
- dynamics_steady.csv: the end of a long motion against study steady-slip, for several loads, speeds, oils and drags.

Times are those of one core of a machine that others used, too; all variants take turns, and the fastest counts.
"""

import numpy as np
from output import BLACK, BLUE, figure, percent, save_figure, write_table

from rollslip import evolve, load_scene, run
from rollslip_studies.dynamics.findings import (
    energy_closure,
    median_epicyclic_speed,
    momentum_closure,
    relative_difference,
)

SCENE = load_scene("1032930-50C")
#: Constant friction that lets the cage slip about as much as the film does: the largest effective friction, and the
#: sliding speed at which the line through its rise at no slip reaches it.
CONSTANT = {"friction": "constant", "friction_coefficient": 0.0035, "friction_speed": "4.5 m/s"}
FRICTIONS = {
    "conventional": {"friction": "conventional"},
    "effective": {"friction": "effective"},
    "constant": CONSTANT,
}
#: Level, slices, duration [s].
COSTS = (("cage-set", 101, 4.0), ("cage-set", 15, 4.0), ("pocket", 15, 0.2))
TURNS = 3
STEADY = {
    "as shipped": {},
    "radial load 2000 N": {"operation.radial_load": "2000 N"},
    "inner ring at 4000 rpm": {"operation.inner_speed": "4000 rpm"},
    "70 degC": {"operation.temperature": "70 degC"},
    "clearance 20 um": {"bearing.radial_clearance": "20 um"},
    "churning alone, 25 s": {
        "cage.drag": [{"model": "churning", "density": "930 kg/m3"}],
        "study.dynamics.duration": 25.0,
    },
    "hysteresis added": {"cage.drag": ["petroff-land", "hysteresis"]},
}


def motion(changes):
    """Return a motion of the scene with changes of study.dynamics."""
    return run(
        evolve(SCENE, {f"study.dynamics.{key}": value for key, value in changes.items()}, si=True),
        "dynamics",
    )


def frictions():
    """Fig. 4: conventional and effective friction from the same start."""
    set_in_cage = evolve(SCENE, {"study.steady-slip.pockets": "set"})
    steady = float(run(set_in_cage, "steady-slip").steady_slip[0])
    found = {name: motion(changes) for name, changes in FRICTIONS.items()}
    reference = found["conventional"]
    rows = []

    def ends(slip):
        return percent(slip, 2), f"{100 * ((1 - slip) / (1 - slip_of(reference)) - 1):+.2f}"

    for name, data in found.items():
        apart = [
            100 * np.abs(relative_difference(reference, data, which)).max()
            for which in ("cage_speed", "roller_speed")
        ]
        closures = energy_closure(data), momentum_closure(data)
        cells = (
            *(f"{value:.2f}" for value in apart),
            data.attrs["steps"],
            *(f"{value:.0e}" for value in closures),
        )
        rows.append((name, *ends(slip_of(data)), *cells))
    rows.append(("study steady-slip", *ends(steady), *[""] * len(cells)))
    header = (
        "friction,cage_slip_at_the_end_percent,cage_speed_against_conventional_percent,"
        "largest_difference_of_cage_speed_percent,largest_difference_of_mean_roller_speed_percent,steps,"
        "energy_residual,angular_momentum_residual"
    )
    write_table("dynamics_figure_4", header.split(","), rows)
    draw(found, steady)


def slip_of(data):
    """Mean cage slip over the last orbit."""
    t = data.time.to_numpy()
    speed = float(data.cage_speed[-1])
    return float(data.cage_slip.to_numpy()[t > t[-1] - 2 * np.pi / abs(speed)].mean())


def draw(found, steady):
    """Draw both motions on top of each other, and their difference."""
    made, axes = figure(3, width=2.6)
    rpm = 30 / np.pi
    styles = {
        "conventional": {"color": "0.7", "linewidth": 3.2},
        "effective": {"color": BLUE, "linewidth": 1.0},
    }
    for name, style in styles.items():
        data = found[name]
        speeds = rpm * data.roller_speed
        axes[0].plot(data.time, rpm * data.cage_speed, label=f"{name} friction", **style)
        axes[1].plot(data.time, speeds.mean("roller"), **style)
    cage = median_epicyclic_speed(found["conventional"], "cage")
    axes[0].axhline(
        rpm * cage * (1 - steady),
        color=BLACK,
        linestyle=":",
        linewidth=0.8,
        label="study steady-slip",
    )
    gap = 100 * relative_difference(found["conventional"], found["effective"], "cage_speed")
    axes[2].plot(found["conventional"].time, gap, color=BLUE, linewidth=1.0, label="effective")
    axes[2].axhline(0, color="0.6", linewidth=0.8)
    axes[0].set(title="cage [rpm]", xlabel="time [s]")
    axes[1].set(title="rollers, relative to the cage, mean [rpm]", xlabel="time [s]")
    axes[2].set(title="cage speed, from conventional [%]", xlabel="time [s]")
    axes[0].legend()
    axes[2].legend(loc="lower right")
    save_figure(made, "dynamics_figure_4")


def costs():
    """What friction costs."""
    rows = []
    for level, slices, duration in COSTS:
        best = {}
        for _ in range(TURNS):
            for name, changes in FRICTIONS.items():
                settings = {"level": level, "duration": duration, "points": 2, **changes}
                scene = evolve(
                    SCENE,
                    {f"study.dynamics.{key}": value for key, value in settings.items()},
                    si=True,
                )
                made = run(evolve(scene, {"accuracy.slices": slices}), "dynamics").attrs
                if name not in best or made["integration_time"] < best[name]["integration_time"]:
                    best[name] = made
        constant = best["constant"]["integration_time"] / best["constant"]["rate_evaluations"]
        for name, made in best.items():
            each = made["integration_time"] / made["rate_evaluations"]
            rows.append(
                (
                    level,
                    slices,
                    name,
                    made["rate_evaluations"],
                    made["contacts_evaluated"],
                    f"{1e6 * each:.3g}",
                    f"{each / constant:.2f}",
                    f"{made['integration_time'] / best['constant']['integration_time']:.2f}",
                    f"{made['real_time_factor']:.3g}",
                )
            )
    header = (
        "level,slices,friction,evaluations_of_the_rates,contacts_evaluated,microseconds_an_evaluation,"
        "evaluation_over_constant,run_over_constant,simulated_over_wall_time"
    )
    write_table("dynamics_cost", header.split(","), rows)


def steady():
    """The slip of a long motion against the slip that is found without one."""
    rows = []
    for name, changes in STEADY.items():
        scene = evolve(
            SCENE, {"accuracy.slices": 15, "study.dynamics.duration": 8.0, **changes}, si=True
        )
        data = run(scene, "dynamics")
        found = run(evolve(scene, {"study.steady-slip.pockets": "set"}), "steady-slip")
        speed = abs((1 - slip_of(data)) / (1 - float(found.steady_slip[0])) - 1)
        rows.append(
            (
                name,
                percent(slip_of(data), 3),
                percent(float(found.steady_slip[0]), 3),
                f"{100 * speed:.4f}",
            )
        )
    header = "change,cage_slip_after_8_s_percent,study_steady-slip_percent,difference_of_cage_speed_percent"
    write_table("dynamics_steady", header.split(","), rows)


if __name__ == "__main__":
    frictions()
    costs()
    steady()
