"""Write the table and the figures of docs/howto/history.rst: four histories of bearing 1032930, a minute or two.

- histories.csv: of each the largest slip and when, time beyond the slip of running away, sliding, frictional work;
- history_run_up.svg, history_load_drop.svg: the slip of two of them within its band.
"""

from output import percent, save_figure, write_table

from rollslip import evolve, load_scene, run
from rollslip.studies.dynamics.history_figures import slip_along
from rollslip.studies.dynamics.history_findings import record

SCENE = evolve(
    load_scene("1032930-50C"),
    {
        "accuracy.slices": 7,
        "operation.radial_load": "3000 N",
        "study.dynamics.friction": "conventional",
        "study.dynamics.duration": "1.5 s",
    },
)
HISTORIES = {
    "run-up in 0.3 s": {"inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "0.3 s"}},
    "run-up in 1.2 s": {"inner_speed": {"shape": "run-up", "from": "1000 rpm", "within": "1.2 s"}},
    "load drops to 600 N": {"radial_load": {"shape": "step", "to": "600 N", "at": "0.3 s"}},
    "oil from 10 degC": {"temperature": {"shape": "ramp", "from": "10 degC", "to": "50 degC", "within": "1.5 s"}},
}
DRAWN = {"run-up in 0.3 s": "history_run_up", "load drops to 600 N": "history_load_drop"}
HEADER = (
    "history", "largest slip [%]", "at [s]", "beyond running away [s]", "slid on the inner ring [m]",
    "work there [J]",
)  # fmt: skip


def rows():
    """Rows of the table; two of them are drawn."""
    for name, history in HISTORIES.items():
        scene = evolve(SCENE, {"study.dynamics.history": history})
        result = run(scene, "dynamics")
        told = record(result)
        if name in DRAWN:
            save_figure(slip_along(result), DRAWN[name])
        beyond = told["time_beyond_runaway"]
        yield (
            name,
            percent(told["largest_cage_slip"]),
            f"{told['largest_cage_slip_time']:.2f}",
            "unknown" if beyond is None else f"{beyond:.2f}",
            f"{told['sliding_distance_inner']:.1f}",
            f"{told['frictional_work_inner']:.0f}",
        )


if __name__ == "__main__":
    write_table("histories", HEADER, rows())
