"""Write docs/tables/smearing_limits.csv: how near the three scenes are to published limits, at some slips.

A share of 1 is a limit that is just reached. Of temperatures it is the rise over the warmer bulk, over that which
leads to the limit; of the film it is the limit over the film parameter; of a load it is that which a maker asks for,
over the load. The oil of the scenes is an ester: the standard for gears has it as a mineral oil here. Some 20 s.
"""

import numpy as np
from output import write_table

from rollslip import evolve, load_scene, run
from rollslip_studies.steady_slip.minimum_load import RULES

SCENES = ("1032930-30C", "1032930-50C", "1032930-70C")
SLIPS = (None, 0.1, 0.3, 0.6)
MEASURES = {
    "ISO, stage 6": {"model": "scuffing-iso", "fzg_stage": 6, "oil": "mineral"},
    "ISO, stage 12": {"model": "scuffing-iso", "fzg_stage": 12, "oil": "mineral"},
    "AGMA, 10 %": {"model": "scuffing-agma", "oil": "MIL-PRF-7808"},
    "film": "film-parameter",
}
MAKERS = ("NTN", "Schaeffler")


def fraction(one, bulk):
    """Return how much of a limit is used on the ring that fares worse."""
    worst = one.worst.to_numpy()
    limit = float(one.limit)
    return np.nanmax(
        limit / worst if one.sense.item() == "smallest" else (worst - bulk) / (limit - bulk)
    )


def rows(name):
    """Yield the rows of a scene."""
    scene = load_scene(name)
    operation = scene.operation
    loads = [RULES[maker].requested(scene.bearing, 0.0)[0] for maker in MAKERS]
    for slip in SLIPS:
        fractions = []
        at = {} if slip is None else {"study.surface-damage.cage_slip": slip}
        for measure in MEASURES.values():
            result = run(evolve(scene, {"models.damage": measure, **at}, si=True), "surface-damage")
            fractions.append(fraction(result.isel(measure=0), operation.temperature))
        fractions += [load / operation.radial_load for load in loads]
        state = f"{100 * float(result.slip):.3g}{' (steady)' if slip is None else ''}"
        yield (
            name,
            state,
            *(f"{one:.2g}" for one in fractions),
            f"{max(fractions) / min(fractions):.0f}",
        )


if __name__ == "__main__":
    head = (
        "scene",
        "cage slip [%]",
        *MEASURES,
        *(f"load, {maker}" for maker in MAKERS),
        "largest/smallest",
    )
    write_table("smearing_limits", head, [row for name in SCENES for row in rows(name)])
