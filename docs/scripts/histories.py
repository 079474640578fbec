"""Write the table and the figures of docs/howto/history.rst: five histories of bearing 1032930, a minute or two.

- histories.csv: of each the largest slip and when, time beyond where skidding begins, sliding, frictional work, and
  the largest power density of sliding;
- history_run_up.svg, history_load_drop.svg, history_emergency_stop.svg: the slip of three of them within its band;
- limit_run_up.svg: the largest slip over the time of that run-up, and where it keeps 5 %;
- history_damage.svg: what the run-up does to the surfaces;
- history_warm_up.svg: temperatures of a cold bearing that follow from its losses and from the oil that flows in.
"""

from output import percent, save_figure, write_table

from rollslip import evolve, limit, load_scene, run
from rollslip_campaigns.limit.figures import draw_limit
from rollslip_studies.dynamics.history.figures import slip_along
from rollslip_studies.dynamics.history_findings import record
from rollslip_studies.surface_damage.figures import over_time
from rollslip_studies.thermal_balance.figures import course

SCENE = evolve(
    load_scene("1032930-50C"),
    {
        "accuracy.slices": 7,
        "operation.radial_load": "3000 N",
        "study.dynamics.friction": "conventional",
        "study.dynamics.duration": "1.5 s",
        "models.damage": ["power-density", "film-parameter"],
    },
)
WARM_UP = {
    "accuracy.tolerance": 0.01,
    "operation.temperature": "10 degC",
    "models.damage": [],
    "models.thermal": {
        "model": "network",
        "oil_flow": "15 g/s",
        "oil_inlet_temperature": "50 degC",
    },
    "study.dynamics": {"friction": "effective", "level": "cage-set", "duration": "120 s"},
}
HISTORIES = {
    "run-up in 0.3 s": {"inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "0.3 s"}},
    "run-up in 1.2 s": {"inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "1.2 s"}},
    "load drops to 600 N": {"radial_load": {"shape": "step", "to": "600 N", "at": "0.3 s"}},
    "stop in 1 s": {"inner_speed": {"shape": "emergency-stop", "at": "0.2 s", "within": "1 s"}},
    "oil from 10 degC": {
        "temperature": {"shape": "ramp", "from": "10 degC", "to": "50 degC", "within": "1.5 s"}
    },
}
DRAWN = {
    "run-up in 0.3 s": "history_run_up",
    "load drops to 600 N": "history_load_drop",
    "stop in 1 s": "history_emergency_stop",
}
HEADER = (
    "history", "largest slip [%]", "at [s]", "beyond where skidding begins [s]", "slid on the inner ring [m]",
    "work there [J]", "power density there [MW/m2]",
)  # fmt: skip


def rows():
    """Rows of the table; three of them are drawn."""
    for name, history in HISTORIES.items():
        scene = evolve(SCENE, {"study.dynamics.history": history}, si=True)
        result = run(scene, "dynamics")
        told = record(result)
        if name in DRAWN:
            save_figure(slip_along(result), DRAWN[name])
            if name.startswith("run-up"):
                save_figure(over_time(result), "history_damage")
        beyond = told["time_beyond_skidding"]
        yield (
            name,
            percent(told["largest_cage_slip"]),
            f"{told['largest_cage_slip_time']:.2f}",
            "unknown" if beyond is None else f"{beyond:.2f}",
            f"{told['sliding_distance_inner']:.1f}",
            f"{told['frictional_work_inner']:.0f}",
            f"{1e-6 * float(result['worst'].sel(measure='power-density', ring='inner')):.1f}",
        )


def gentlest():
    """Search the gentlest run-up that keeps a slip of 5 percent."""
    scene = evolve(
        SCENE,
        {"study.dynamics.history": HISTORIES["run-up in 0.3 s"], "study.dynamics.duration": "3 s"},
        si=True,
    )
    over = {"study.dynamics.history.inner_speed.within": "0.1 s:3 s"}
    return limit(scene, over, "largest_cage_slip <= 5 %", study="dynamics")


if __name__ == "__main__":
    save_figure(draw_limit(gentlest()), "limit_run_up")
    write_table("histories", HEADER, rows())
    save_figure(course(run(evolve(SCENE, WARM_UP), "dynamics")), "history_warm_up")
