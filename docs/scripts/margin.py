"""Write the tables and figures of docs/howto/uncertainty.rst: what scatter leaves of reserve and slip.

- margin.csv: drag reserve, steady slip, where skidding begins and critical slip of the paper's bearing at 70 degC, with
  all that scatters by default;
- margin_indices.csv: Sobol indices, of the first quantity that the figure shows;
- margin_models.csv: quantiles of the critical slip for several laws and films, on the same samples of the oil alone;
- margin.svg, margin_indices.svg, margin_convergence.svg, margin_laws.svg, margin_films.svg, margin_map.svg.

Samples are kept in build/margin, from where the script goes on; remove it to compute anew. About seven minutes of one
core.
"""

import shutil
import tempfile
from pathlib import Path

import numpy as np
from output import DOCS, write_table

from rollslip import sweep
from rollslip.results.accounts import account_of
from rollslip.results.figures import save_plots
from rollslip_campaigns.sweep.figures import describe_models
from rollslip_campaigns.uncertainty import UncertaintySettings
from rollslip_campaigns.uncertainty.run import run_uncertainty

SCENE = "1032930-70C"
#: Enough for a quantile of 1 %: ten samples lie below it.
SAMPLES = 1024
KEPT = DOCS.parent / "build" / "margin"
SCATTER = {
    "lubricant.viscosity_factor": "0.9:1.1",
    "lubricant.pressure_viscosity_factor": "0.75:1.25",
    "lubricant.eyring_stress": "1 MPa:10 MPa:log",
    "lubricant.shear_modulus": "0.05 GPa:1 GPa:log",
}
LAWS = ("models.traction.hydrodynamic", ["muraki", "eyring", "maxwell-eyring"])
FILMS = ("models.film", ["moes", "regime", "dowson-1968", "pan-hamrock"])
MAP = {"operation.radial_load": "1 kN:10 kN:12", "operation.inner_speed": "2000 rpm:12000 rpm:12"}


def figures(dataset, **names):
    """Draw the figures of a dataset and keep those that are named, under other names."""
    with tempfile.TemporaryDirectory() as folder:
        save_plots(dataset, Path(folder))
        for theirs, ours in names.items():
            shutil.copyfile(
                Path(folder) / f"{theirs.replace('_', '-')}.svg", DOCS / "figures" / f"{ours}.svg"
            )


def percent(fraction):
    return f"{100 * float(fraction):.3g}" if np.isfinite(fraction) else "beyond the range"


if __name__ == "__main__":
    found = run_uncertainty(
        UncertaintySettings(
            SCENE, samples=SAMPLES, indices=64, probability=0.99, plain=True
        ).plan(),
        KEPT,
        print_line=print,
    )
    figures(
        found,
        uncertainty="margin",
        uncertainty_indices="margin_indices",
        uncertainty_convergence="margin_convergence",
    )
    print("\n".join(account_of(found).sentences(found)))
    quantities = ("drag reserve", "steady slip", "slip at which skidding begins", "critical slip")
    rows = []
    for name in quantities:
        one = found.sel(quantity=name)
        size = 100.0 if "slip" in name else 1.0
        quantiles = [
            size * one.quantile_value.sel(probability=p).item() for p in (0.01, 0.05, 0.5, 0.95)
        ]
        values = [f"{value:.3g}" if np.isfinite(value) else "beyond" for value in quantiles]
        rows.append(
            (
                f"{name} [{'%' if size > 1 else '–'}]",
                int(one.samples),
                int(one.beyond),
                int(one.unknown),
                *values,
            )
        )
    write_table(
        "margin", ("quantity", "samples", "beyond", "unknown", "1 %", "5 %", "median", "95 %"), rows
    )
    print("indices of", *found.indexed.values)
    fraction = found.isel(indexed=0)
    write_table(
        "margin_indices",
        ("input", "first order", "95 % interval", "total", "95 % interval"),
        [
            (
                key,
                *(
                    text
                    for order in ("first_order", "total_order")
                    for text in (
                        f"{fraction[order].sel(input=key).item():.3f}",
                        f"{fraction[f'{order}_low'].sel(input=key).item():.3f} to "
                        f"{fraction[f'{order}_high'].sel(input=key).item():.3f}",
                    )
                ),
            )
            for key in map(str, found.input.values)
        ],
    )
    rows = []
    for (key, names), figure in ((LAWS, "margin_laws"), (FILMS, "margin_films")):
        apart = sweep(SCENE, {**SCATTER, key: names}, samples=256, study="effective-friction")
        figures(apart, sweep_models=figure)
        print(describe_models(apart))
        slips = apart.critical_cage_slip.sel(ring="inner").fillna(np.inf)
        for name in names:
            values = np.quantile(
                slips.sel({key.rpartition(".")[2]: name}), (0.05, 0.5, 0.95), method="inverted_cdf"
            )
            rows.append((key, name, *map(percent, values)))
    write_table("margin_models", ("key", "choice", "5 % [%]", "median [%]", "95 % [%]"), rows)
    films = {"models.film": ["moes", "dowson-1968", "pan-hamrock"]}
    figures(sweep(SCENE, {**MAP, **films}, study="effective-friction"), sweep_map="margin_map")
