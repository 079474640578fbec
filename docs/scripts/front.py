"""Draw docs/figures/front.svg, the picture of the first page and of the README: who drives the cage, and how far.

Left the shipped bearing at 50 degC with the forces of its rollers, right the balance of torques on its cage.
"""

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Wedge
from output import BLACK, BLUE, ORANGE, save_figure
from scipy.interpolate import PchipInterpolator

import rollslip

SCENE = "1032930-50C"
GREY = "#b5bcc4"


def draw_bearing(axes, scene):
    """The rings, the cage, and every roller in the colour of its force; the load points down."""
    bearing = scene.bearing
    forces = rollslip.load_distribution(scene).normal_force.sel(ring="inner").isel(instant=0).values
    inner, outer, size = (
        500 * value  # radii in mm
        for value in (
            bearing.inner_raceway_diameter,
            bearing.outer_raceway_diameter,
            bearing.roller_diameter,
        )
    )
    ring = 1.0 * size
    pitch = (inner + outer) / 2
    colours = ListedColormap(matplotlib.colormaps["cividis"](np.linspace(0.85, 0.05, 40)))
    scale = Normalize(0, forces.max())
    for radius, width in ((inner, ring), (outer + ring, ring)):
        axes.add_patch(Wedge((0, 0), radius, 0, 360, width=width, color="#e3e6ea", ec=GREY, lw=0.6))
    step = 360 / len(forces)
    gap = np.degrees(1.12 * size / pitch)
    for k, force in enumerate(forces):
        angle = -90 + k * step
        axes.add_patch(
            Wedge(
                (0, 0),
                pitch + 0.3 * size,
                angle + gap,
                angle + step - gap,
                width=0.6 * size,
                color=ORANGE,
                lw=0,
            )
        )
        at = np.radians(angle)
        face = colours(scale(force)) if force > 0 else "white"
        axes.add_patch(
            Circle((pitch * np.cos(at), pitch * np.sin(at)), 0.97 * size, fc=face, ec=BLACK, lw=0.5)
        )
    axes.annotate(
        "load",
        (0, -0.72 * inner),
        (0, -0.3 * inner),
        ha="center",
        arrowprops={"arrowstyle": "-|>", "color": BLACK},
    )
    axes.add_patch(Arc((0, 0), 1.5 * inner, 1.5 * inner, theta1=50, theta2=130, color=BLACK, lw=1))
    tip = 0.75 * inner * np.array([np.cos(np.radians(130)), np.sin(np.radians(130))])
    axes.annotate(
        "",
        tip,
        tip + np.array([2.2, 2.6]),
        arrowprops={"arrowstyle": "-|>", "color": BLACK, "lw": 1},
    )
    axes.text(
        0,
        0.2 * inner,
        "inner ring turns,\nrollers and cage (orange)\nlag behind",
        ha="center",
        va="center",
    )
    axes.set(
        xlim=(-1.03 * (outer + ring), 1.03 * (outer + ring)),
        ylim=(-1.03 * (outer + ring), 1.03 * (outer + ring)),
    )
    axes.set_aspect("equal")
    axes.axis("off")
    return ScalarMappable(scale, colours)


def draw_torques(axes, result):
    """The torque by which the rollers drive the cage, its drag, and what comes of the two."""
    slip = 100 * result.cage_slip
    drive = 1e3 * result.driving_torque
    drag = 1e3 * result.drag_torque
    fold = 100 * float(result.skidding_slip)
    top = 1e3 * float(result.limit_drag)
    steady = 100 * float(result.steady_slip[0])
    held = 1e3 * float(result.torque[0])
    fine = np.linspace(0, float(slip[-1]), 400)
    axes.axvspan(fold, float(slip[-1]), color=ORANGE, alpha=0.12, lw=0)
    axes.plot(fine, PchipInterpolator(slip, drive)(fine), color=BLUE)
    axes.plot(slip, drag, color=BLACK, dashes=(4, 2))
    axes.plot([steady, fold], [held, top], "o", color=BLUE, mec="white", ms=7)
    axes.annotate(
        f"here the cage runs:\n{steady:.1f} % slip",
        (steady, held),
        (steady + 13, 1.12 * held),
        va="bottom",
        arrowprops={"arrowstyle": "-", "color": BLACK, "lw": 0.6, "shrinkB": 5},
    )
    axes.annotate(
        f"limit drag torque, at {fold:.0f} % slip", (fold, top), (fold, 1.08 * top), ha="center"
    )
    axes.text(
        float(slip[-1]) - 1,
        0.6 * top,
        "beyond, more slip\ndrives less: the\ncage skids",
        ha="right",
    )
    axes.text(21, 0.76 * top, "the film drives", color=BLUE)
    axes.text(40, 0.24 * top, "the oil around it brakes", ha="right", va="top")
    axes.set(
        xlim=(0, float(slip[-1])),
        ylim=(0, 1.2 * top),
        xlabel="Cage slip [%]",
        ylabel="Torque on the cage [mN m]",
    )


def main():
    scene = rollslip.load_scene(SCENE)
    made = Figure(figsize=(7.6, 3.3), layout="constrained")
    left, right = made.subplots(1, 2, width_ratios=(1, 1.15))
    forces = draw_bearing(left, scene)
    bar = made.colorbar(forces, ax=left, location="left", shrink=0.6, aspect=25)
    bar.set_label("Force on the inner ring [N]")
    bar.outline.set_visible(False)
    draw_torques(right, rollslip.run(scene, "steady-slip"))
    save_figure(made, "front")


if __name__ == "__main__":
    main()
