"""Estimate the properties of an oil from its kind of base oil and its viscosity, and compute viscosity indices.

The built-in oils of ISO VG grades are made of the same numbers. Grades of data are `rollslip.lubricant.oil.GRADES`.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

import attrs

from rollslip.lubricant.temperature import (
    Constant,
    Product,
    Table,
    TemperatureLaw,
    Walther,
    WuKlausDuda,
)
from rollslip_kernels.slices import Conditions

__all__ = ["BASE_OILS", "ISO_GRADES", "BaseOil", "falling_density", "viscosity_index"]

#: Grades of ISO 3448: kinematic viscosity at 40 degC [mm2/s], with a tolerance of 10 %.
ISO_GRADES: Final = (
    2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200,
)  # fmt: skip
#: Lowest viscosity index without a warning [1]. Naphthenic and traction oils have about -50 (C).
LOWEST_INDEX = -100.0
#: Highest viscosity index without a warning [1]. Oils in use have at most 300 (C), silicones about 400.
HIGHEST_INDEX = 400.0


@attrs.frozen(kw_only=True)
class BaseOil:
    """Typical properties of the oils of one kind."""

    #: Density at 15 and 100 degC [kg/m3].
    density: tuple[float, float]
    #: Viscosity index of an oil of which only the grade is known [1].
    viscosity_index: float
    #: Thermal conductivity [W/(m K)].
    conductivity: float
    #: Eyring stress [Pa].
    eyring_stress: float
    #: Shear modulus [Pa].
    shear_modulus: float = 0.3e9
    #: Pressure-viscosity coefficient over that of Wu, Klaus and Duda [1].
    alpha_factor: float = 1.0
    #: Relative half width of the scatter of the coefficient [1].
    alpha_scatter: float
    #: Source of the coefficient and its scatter.
    alpha_source: str
    #: Standard deviation of ln(eta/eta0) at 0.3 to 0.6 GPa by Roelands's law [1].
    exponent: float
    #: Property -> letter of its grade.
    grades: Mapping[str, str]
    #: Sources of the numbers.
    sources: str

    def coefficient(self, kinematic: Walther) -> TemperatureLaw:
        """Return the pressure-viscosity coefficient alpha(T) at zero pressure for a kinematic viscosity [m2/s]."""
        law = WuKlausDuda(attrs.evolve(kinematic, scale=1e-6))
        return law if self.alpha_factor == 1.0 else Product(Constant(self.alpha_factor), law)


_GRADES: Final = {"density": "C", "pressure_viscosity": "C", "conductivity": "C", "eyring_stress": "C",
                  "shear_modulus": "C", "pressure_viscosity_kind": "C"}  # fmt: skip
_SHEAR: Final = "published traction curves give a shear modulus of 0.05 to 1 GPa (C)"

#: Kind of base oil -> its typical properties.
BASE_OILS: Final[Mapping[str, BaseOil]] = MappingProxyType(
    {
        "mineral": BaseOil(
            density=(902.0, 858.0),
            viscosity_index=95.0,
            conductivity=0.134,
            eyring_stress=5e6,
            alpha_scatter=0.25,
            alpha_source="35 of 38 measured coefficients of 13 mineral oils (Stachowiak and Batchelor, Table 2.3) lie "
            "within 25 % of it, all from 5 % below to 31 % above; formulas of Gold and of So and Klaus within 25 %",
            exponent=0.5,
            grades=_GRADES | {"density": "B", "pressure_viscosity": "B"},
            sources="density of the mineral oils of the open library GEARpie (B), conductivity of FVA 3 (C), "
            f"an Eyring stress of 3 to 8 MPa is recalled (C), {_SHEAR}",
        ),
        "pao": BaseOil(
            density=(859.0, 819.0),
            viscosity_index=150.0,
            conductivity=0.15,
            eyring_stress=5e6,
            alpha_scatter=0.3,
            alpha_source="formulas of Gold and of So and Klaus lie within 30 % of that of Wu, Klaus and Duda",
            exponent=0.5,
            grades=_GRADES | {"density": "B", "pressure_viscosity": "B"},
            sources="density of the polyalphaolefins of GEARpie (B), conductivity recalled (C), an Eyring stress "
            f"of 2 to 6 MPa is recalled (C), {_SHEAR}",
        ),
        "ester": BaseOil(
            density=(915.0, 852.0),
            viscosity_index=140.0,
            conductivity=0.15,
            eyring_stress=4e6,
            alpha_factor=0.79,
            alpha_scatter=0.3,
            alpha_source="0.79 of the formula of Wu, Klaus and Duda, as fits of MIL-L-7808 and MIL-L-23699 have (D); "
            "formulas for esters differ by 30 %",
            exponent=0.8,
            grades=_GRADES | {"pressure_viscosity": "D"},
            sources="density of an ester of GEARpie (C; esters have 900 to 1000), conductivity recalled (C), an Eyring "
            f"stress of 2 to 6 MPa is recalled (C), {_SHEAR}",
        ),
        "pag": BaseOil(
            density=(1030.0, 966.0),
            viscosity_index=220.0,
            conductivity=0.15,
            eyring_stress=4e6,
            alpha_factor=0.9,
            alpha_scatter=0.3,
            alpha_source="0.9 of the formula of Wu, Klaus and Duda, halfway to that of Gold (D); they are 20 % apart",
            exponent=0.8,
            grades=_GRADES | {"density": "D", "pressure_viscosity": "D", "conductivity": "D", "eyring_stress": "D"},
            sources="density 980 to 1100 and conductivity 0.15 to 0.2 are recalled (D), a viscosity index of 180 to "
            f"280 is printed (A), an Eyring stress as of esters (D), {_SHEAR}",
        ),
    }
)  # fmt: skip


def falling_density(at_15: float, at_100: float) -> Table:
    """Return the density of an oil, a straight line from 0 to 200 degC.

    Parameters
    ----------
    at_15, at_100 : float
        Density at 15 and 100 degC [kg/m3].
    """
    slope = (at_100 - at_15) / 85.0
    return Table((273.15, 473.15), (at_15 - 15.0 * slope, at_15 + 185.0 * slope))


def exponent_factor(law: Any, deviation: float, viscosity: float, alpha: float) -> float:
    """Return the relative deviation of ln(eta/eta0) [1] that changes ln(eta) by a ``deviation`` at 0.45 GPa.

    >>> from rollslip.lubricant.pressure import default_law
    >>> round(exponent_factor(default_law(), 0.5, 0.0219, 1.8e-8), 3)
    0.081
    """
    conditions = Conditions(
        viscosity=viscosity,
        pressure_viscosity=alpha,
        thermoviscosity=0.0,
        pressure_thermoviscosity=0.0,
    )
    rise = math.log(float(law.at(conditions, 0.45e9)[0]) / viscosity)
    return deviation / rise


#: Lower limit of the viscosity Y at 100 degC of a row [mm2/s], and a to f of L = a Y^2 + b Y + c, H = d Y^2 + e Y + f.
_L_AND_H: Final = (
    (2.0, 1.14673, 1.7576, -0.109, 0.84155, 1.5521, -0.077),
    (3.8, 3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183),
    (4.4, 2.5, -7.2143, 13.812, 0.82143, 1.5679, 0.119),
    (5.0, 0.101, 16.635, -45.469, 0.04985, 9.1613, -18.557),
    (6.4, 3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656),
    (7.0, 0.01191, 21.475, -72.87, 0.79762, -0.7321, 14.61),
    (7.7, 0.41858, 16.1558, -56.04, 0.05794, 10.5156, -28.24),
    (9.0, 0.88779, 7.5527, -16.6, 0.26665, 6.7015, -10.81),
    (12.0, 0.7672, 10.7972, -38.18, 0.20073, 8.4658, -22.49),
    (15.0, 0.97305, 5.3135, -2.2, 0.28889, 5.9741, -4.93),
    (18.0, 0.97256, 5.25, -0.98, 0.24504, 7.416, -16.73),
    (22.0, 0.91413, 7.4759, -21.82, 0.20323, 9.1267, -34.23),
    (28.0, 0.87031, 9.7157, -50.77, 0.18411, 10.1015, -46.75),
    (40.0, 0.84703, 12.6752, -133.31, 0.17029, 11.4866, -80.62),
    (55.0, 0.85921, 11.1009, -83.19, 0.1713, 11.368, -76.94),
    (70.0, 0.83531, 14.6731, -216.246, 0.16841, 11.8493, -96.947),
)


def viscosity_index(at_40: float, at_100: float) -> float:
    """Return the viscosity index of an oil after ASTM D2270.

    VI = 100 (L - U)/(L - H) with the viscosities Y and U at 100 and 40 degC in mm2/s and the polynomials L(Y), H(Y) of
    the standard; with U below H it is 100 + (10^N - 1)/0.00715, N = log(H/U)/log Y. The polynomials are quoted from
    memory (C): they reproduce the two examples and four rows of the table of the standard.

    Parameters
    ----------
    at_40, at_100 : float
        Kinematic viscosity at 40 and 100 degC [m2/s].

    Returns
    -------
    float
        Viscosity index [1]; nan below 2 mm2/s at 100 degC, where the standard defines none.

    Examples
    --------
    >>> round(viscosity_index(73.30e-6, 8.86e-6)), round(viscosity_index(22.83e-6, 5.05e-6))
    (92, 156)
    """
    Y = 1e6 * at_100
    U = 1e6 * at_40
    if (row := next((row for row in reversed(_L_AND_H) if row[0] <= Y), None)) is None:
        return math.nan
    _, a, b, c, d, e, f = row
    L = (a * Y + b) * Y + c
    H = (d * Y + e) * Y + f
    if U >= H:
        return 100.0 * (L - U) / (L - H)
    return 100.0 + (math.pow(10.0, math.log10(H / U) / math.log10(Y)) - 1.0) / 0.00715


def viscosity_at_100(at_40: float, index: float) -> float:
    """Return the kinematic viscosity [m2/s] at 100 degC of an oil with a viscosity index, by bisection; nan if none.

    >>> round(1e6 * viscosity_at_100(73.30e-6, 92.43), 2)
    8.86
    """
    low = 2e-6
    high = at_40
    if not viscosity_index(at_40, low) <= index <= viscosity_index(at_40, 0.999 * high):
        return math.nan
    for _ in range(100):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if viscosity_index(at_40, middle) < index else (low, middle)
    return math.sqrt(low * high)


def estimate_properties(
    kind: str, kinematic: Walther | None, given: Mapping[str, Any]
) -> tuple[dict[str, Any], str]:
    """Return the properties that a kind of base oil suggests in place of missing ones, and a sentence on sources."""
    base = BASE_OILS[kind]
    properties: dict[str, Any] = {
        "density": falling_density(*base.density),
        "conductivity": Constant(base.conductivity),
        "eyring_stress": base.eyring_stress,
        "shear_modulus": base.shear_modulus,
    }
    if kinematic is not None:
        properties["pressure_viscosity"] = base.coefficient(kinematic)
    properties = {key: value for key, value in properties.items() if given.get(key) is None}
    if not properties:
        return {}, ""
    names = ", ".join(f"{key} ({base.grades[key]})" for key in properties)
    return (
        properties,
        f"Estimated from base_oil = {kind!r}: {names}; {base.sources}; alpha: {base.alpha_source}.",
    )
