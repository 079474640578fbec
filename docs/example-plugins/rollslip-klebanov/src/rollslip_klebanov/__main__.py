"""Print the critical cage slips that every set gives: ``python -m rollslip_klebanov``."""

from rollslip import run

from rollslip_klebanov.scenes import SETS, figure_scene


def critical_slips(of_set: str) -> list[float]:
    """Return the critical cage slips of the inner ring at 70 and 50 degC with a set."""
    found = (run(figure_scene(figure, of_set), "effective-friction") for figure in ("fig-2", "fig-3"))
    return [float(data["critical_cage_slip"].sel(ring="inner")) for data in found]


if __name__ == "__main__":
    print(f"{'the paper':<28}{0.11:>9.0%}{0.50:>9.0%}")
    for name in SETS:
        at_70, at_50 = critical_slips(name)
        print(f"{name:<28}{at_70:>9.2%}{at_50:>9.2%}")
