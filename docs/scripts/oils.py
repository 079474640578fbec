"""Write docs/tables/oils_alpha.csv: the pressure-viscosity coefficient of the named oils beside three formulas.

Gold's alpha = s nu^t with s and t of the oil's family; So and Klaus (1980); Wu, Klaus and Duda (1989); nu in mm2/s. The
formulas are written out once more in tests/plugins/test_oils.py.
"""

import math

from output import write_table

from rollslip import available, get_model

#: Family -> s [1/GPa] and t of Gold; oils that are none of the last two are mineral.
GOLD = {"mineral": (9.904, 0.1390), "polyalphaolefin": (7.382, 0.1335), "ester": (6.605, 0.1360)}
ESTERS = ("mil-prf-7808", "mil-prf-23699", "vnii-np-50-1-4u", "b-3v")
POLYALPHAOLEFINS = ("pao-68", "ipm-10")


def family(name):
    return (
        "ester" if name in ESTERS else "polyalphaolefin" if name in POLYALPHAOLEFINS else "mineral"
    )


def kinematic(oil, celsius):
    T = celsius + 273.15
    return 1e6 * oil.at(T).viscosity / oil.density(T)


def formulas(oil, celsius):
    """Return alpha [1/GPa] after Gold, So and Klaus, and Wu, Klaus and Duda."""
    high, low = (math.log10(math.log10(kinematic(oil, c) + 0.7)) for c in (40.0, 100.0))
    m = (high - low) / (math.log10(373.15) - math.log10(313.15))
    nu = kinematic(oil, celsius)
    rho = 1e-3 * oil.density(celsius + 273.15)
    log = math.log10(nu)
    (s, t) = GOLD[family(oil.name)]
    so = (
        1.216
        + 4.143 * log**3.0627
        + 2.848e-4 * m**5.1903 * log**1.5976
        - 3.999 * log**3.0975 * rho**0.1162
    )
    return s * nu**t, 10.0 * so, 10.0 * m * (0.1657 + 0.2332 * log)


if __name__ == "__main__":
    rows = []
    for name in available("lubricant"):
        oil = get_model("lubricant", name)
        row = [
            name,
            "traction fluid" if name == "santotrac-50" else family(name),
            oil.grades["pressure_viscosity"],
        ]
        for celsius in (40.0, 100.0):
            values = oil.at(celsius + 273.15).pressure_viscosity * 1e9, *formulas(oil, celsius)
            row += [f"{value:.1f}" for value in values]
        rows.append(row)
    columns = ("used", "Gold", "So-Klaus", "Wu-Klaus-Duda")
    write_table(
        "oils_alpha",
        (
            "oil",
            "family",
            "grade",
            *(f"{column}_at_{c}_degC" for c in (40, 100) for column in columns),
        ),
        rows,
    )
