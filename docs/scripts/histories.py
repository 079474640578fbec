"""Write the table and the figure of docs/howto/history.rst: four histories of bearing 1032930, a minute or two.

- histories.csv: of each the largest slip and when, time beyond the slip of running away, sliding, frictional work;
- history_run_up.svg: the slip of the run-up in 0.3 s within its band.
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
HEADER = (
    "history", "largest slip [%]", "at [s]", "beyond running away [s]", "slid on the inner ring [m]",
    "work there [J]",
)  # fmt: skip


def rows():
    """Rows of the table; the first run-up is drawn."""
    for name, history in HISTORIES.items():
        scene = evolve(SCENE, {"study.dynamics.history": history})
        result = run(scene, "dynamics")
        told = record(result)
        if name == next(iter(HISTORIES)):
            save_figure(slip_along(result), "history_run_up")
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
