"""Write the table bulk_temperatures.csv of docs/howto/thermal-balance.rst: what the shipped scenes settle at.

Each scene with its own temperatures held, in a bath of oil, and with a flow of oil that enters at the scene's
temperature; the two warmer ones with the resistances that they leave out, too. Conductances are the estimates of the
network. About a minute of one core.
"""

import numpy as np
from output import write_table

from rollslip import evolve, load_scene, run

SCENES = "1032930-30C", "1032930-50C", "1032930-70C"
MORE = {
    "cage.drag": ["petroff-land", "churning", "rolling-resistance"],
    "lubricant.density": "930 kg/m3",
}
COOLED = {
    "held": {"models.thermal": "given"},
    "bath": {"models.thermal": "network"},
    "15 g/s": {"models.thermal": {"model": "network", "oil_flow": "15 g/s"}},
}
TOLERANCE = {"accuracy.tolerance": 0.01}


def row(name, drags, changes, cooling):
    """Return the cells of one case."""
    scene = evolve(load_scene(name), {**TOLERANCE, **changes, **COOLED[cooling]}, si=True)
    result = run(scene, "thermal-balance")
    shown = [
        f"{float(result.steady_slip[0]):.2%}" if np.isfinite(result.steady_slip[0]) else "none"
    ]
    loss = float(result.loss.isel(balance=0).sum()) if result.sizes["source"] else np.nan
    nodes = [
        f"{float(result.temperature.sel(node=part)[0]) - 273.15:.1f}"
        if np.isfinite(loss)
        else "none"
        for part in ("oil", "inner ring", "rollers", "outer ring")
    ]
    return [name, drags, cooling, f"{loss:.0f}", *nodes, *shown, result.sizes["balance"]]


def main():
    """Write the table."""
    head = [
        "scene", "drags", "oil", "lost [W]", "oil [degC]", "inner ring [degC]", "rollers [degC]", "outer ring [degC]",
        "cage slip", "balances",
    ]  # fmt: skip
    rows = [
        row(name, drags, changes, cooling)
        for name in SCENES
        for drags, changes, coolings in (
            ("land", {}, COOLED),
            ("land, churning, rolling", MORE, ("held", "15 g/s")),
        )
        for cooling in coolings
        if not (changes and name.endswith("30C"))
    ]
    write_table("bulk_temperatures", head, rows)


if __name__ == "__main__":
    main()
