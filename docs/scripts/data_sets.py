"""Write data_sets.csv of docs/howto/validating.rst: how near the defaults are to the numbers of the built-in data sets.

It takes some minutes, most of them for the samples of the measured torque.
"""

import json

import numpy as np
from output import write_table

import rollslip
from rollslip.results.text import two_digits


def main():
    """Compare the models of each data set with its rows."""
    found = rollslip.validate()
    sets = json.loads(found.attrs["data_sets"])
    rows = []
    pairs = dict.fromkeys(zip(found.row_data_set.values, found.row_series.values, strict=True))
    for name, series in pairs:
        own = found.sel(row=(found.row_data_set == name) & (found.row_series == series))
        ratios = own.ratio.values[np.isfinite(own.ratio.values)]
        low, median, high = (two_digits(float(np.quantile(ratios, q))) for q in (0.0, 0.5, 1.0))
        inside = int((own.row_verdict == "inside").sum())
        how = "measured" if sets[name]["measured"] else "computed"
        rows.append(
            [name, series, how, f"{median} ({low} to {high})", f"{inside} of {own.sizes['row']}"]
        )
        print(*rows[-1], sep=" | ", flush=True)
    rows.sort(key=lambda row: row[2] != "measured")
    write_table(
        "data_sets",
        ("data set", "series", "values", "calculated over these", "inside both uncertainties"),
        rows,
    )


if __name__ == "__main__":
    main()
