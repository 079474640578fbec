"""Write traction_local_error.csv: the law at the mean pressure and that at the local one, against the integrated field.

The contacts are the 300 of tools/references/traction_local.csv, to which no constant was fitted, with the friction of
the field. Errors are means, root mean squares and largest sizes in percent, for all contacts and for parts of them.
"""

import csv
import itertools
from pathlib import Path

import attrs
import numpy as np
from output import write_table

from rollslip import Chain, Conditions, Slices
from rollslip_kernels.slices import COLUMNS
from rollslip_plugins.pressure_viscosity import Barus, Roelands
from rollslip_plugins.traction.eyring import MaxwellEyring
from rollslip_plugins.traction.heating import OIL_HEAT_CAPACITY
from rollslip_plugins.traction.local import MaxwellEyringLocal

CONTACTS = Path(__file__).parents[2] / "tools" / "references" / "traction_local.csv"
STEEL = Conditions(conductivity=0.14, effusivity=13e3, shear_modulus=0.3e9, temperature=350.0)
#: Quantity of `quantities_of` -> its name, and the limits between parts.
PARTS = {
    "deborah": ("Deborah number D", (1e-3, 1e-2, 0.1, 1.0)),
    "softening": ("heating Phi sigma S", (0.01, 0.1, 1.0)),
    "capacity": ("conduction over transit time C", (1.0, 10.0)),
    "pressure": ("mean pressure [GPa]", (0.15, 0.3, 0.5, 0.8)),
    "ratio": ("slide-roll ratio V/u", (1e-3, 1e-2, 0.1)),
}


def contact(row):
    """Return the law of viscosity of a row, and its slice."""
    values = {name: float(text) for name, text in row.items() if name != "set"}
    oil = {f.name: values[f.name] for f in attrs.fields(Conditions) if f.name in values}
    columns = {k: value for k, value in values.items() if k in COLUMNS and k != "friction"}
    law = Barus() if row["set"] == "barus" else Roelands()
    return law, Slices(1, attrs.evolve(STEEL, **oil), **columns)


def quantities_of(law, slices):
    """Return the quantities by which contacts are divided, of a slice with its friction."""
    c = slices.conditions
    capacity = OIL_HEAT_CAPACITY * slices.film_thickness**2 * slices.rolling_speed
    return {
        **law.quantities(slices),
        "capacity": capacity / (c.conductivity * slices.half_width),
        "pressure": slices.pressure / 1e9,
        "ratio": slices.sliding_speed / slices.rolling_speed,
    }


def summary(errors):
    """Return mean, root mean square and largest size of errors [%]."""
    return (
        f"{errors.mean():.1f}",
        f"{np.sqrt(np.mean(errors**2)):.1f}",
        f"{np.abs(errors).max():.0f}",
    )


def main():
    """Evaluate both laws at all contacts, and write the table."""
    errors, found = [], []
    with CONTACTS.open() as stream:
        for row in csv.DictReader(stream):
            oil, slices = contact(row)
            local = MaxwellEyringLocal(law=oil)
            both = []
            for chain in (Chain(oil, MaxwellEyring()), Chain(local)):
                chain(slices)
                both.append(100 * (slices.friction[0] / float(row["friction"]) - 1))
            errors.append(both)
            found.append({k: values[0] for k, values in quantities_of(local, slices).items()})
    errors = np.array(errors)
    rows = [("all", "", len(errors), *summary(errors[:, 0]), *summary(errors[:, 1]))]
    for name, (title, limits) in PARTS.items():
        values = np.abs([quantities[name] for quantities in found])
        edges = (0.0, *limits, np.inf)
        for low, high in itertools.pairwise(edges):
            part = (values >= low) & (values < high)
            if part.sum() < 5:
                continue
            bounds = f"{low:g} to {high:g}"
            if low == 0:
                bounds = f"below {high:g}"
            elif high == np.inf:
                bounds = f"above {low:g}"
            rows.append(
                (title, bounds, part.sum(), *summary(errors[part, 0]), *summary(errors[part, 1]))
            )
    header = ["of", "range", "contacts"]
    for law in ("mean pressure", "local pressure"):
        header += [f"{law}: mean", "rms", "largest"]
    write_table("traction_local_error", header, rows)


if __name__ == "__main__":
    main()
