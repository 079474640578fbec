"""What a kind of base oil tells of an oil of which the viscosity alone is known, and the viscosity index.

The oils of ISO VG grades in the box are made of the same numbers. Grades of data are `rollslip.lubricant.oil.GRADES`.
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

#: Grades of ISO 3448: mid kinematic viscosity at 40 degC [mm2/s], which may be 10 % off.
ISO_GRADES: Final = (
    2,
    3,
    5,
    7,
    10,
    15,
    22,
    32,
    46,
    68,
    100,
    150,
    220,
    320,
    460,
    680,
    1000,
    1500,
    2200,
    3200,
)
#: Viscosity indices beyond these are questioned: of oils in use the highest are about 300 (C), of silicones about 400,
#: and the lowest, of naphthenic and traction oils, about -50 (C).
LOWEST_INDEX = -100.0
HIGHEST_INDEX = 400.0


@attrs.frozen(kw_only=True)
class BaseOil:
    """What oils of one kind have in common."""

    called: str  # what it is, in words
    density: tuple[float, float]  # at 15 and 100 degC [kg/m3]
    viscosity_index: float  # of an oil of which only the grade is known [1]
    conductivity: float  # [W/(m K)]
    eyring_stress: float  # [Pa]
    shear_modulus: float = 0.3e9  # [Pa]
    alpha_factor: float = (
        1.0  # its pressure-viscosity coefficient over that of Wu, Klaus and Duda [1]
    )
    alpha_scatter: float  # relative half width of that [1]
    alpha_source: str  # what that rests on
    exponent: float  # standard deviation of ln(eta/eta0) at 0.3 to 0.6 GPa by Roelands's law [1]
    grades: Mapping[str, str]  # property -> letter
    sources: str  # where the numbers come from

    def coefficient(self, kinematic: Walther) -> TemperatureLaw:
        """Return the pressure-viscosity coefficient alpha(T), the tangent at no pressure, of a viscosity [m2/s]."""
        law = WuKlausDuda(attrs.evolve(kinematic, scale=1e-6))
        return law if self.alpha_factor == 1.0 else Product(Constant(self.alpha_factor), law)


_GRADES: Final = {"density": "C", "pressure_viscosity": "C", "conductivity": "C", "eyring_stress": "C",
                  "shear_modulus": "C", "pressure_viscosity_kind": "C"}  # fmt: skip
_SHEAR: Final = "published traction curves give a shear modulus of 0.05 to 1 GPa (C)"

#: Kind of base oil, as scenes name it -> what is known of it.
BASE_OILS: Final[Mapping[str, BaseOil]] = MappingProxyType(
    {
        "mineral": BaseOil(
            called="mineral oil",
            density=(902.0, 858.0),
            viscosity_index=95.0,
            conductivity=0.134,
            eyring_stress=5e6,
            alpha_scatter=0.25,
            alpha_source="formulas of Gold and of So and Klaus lie within 25 % of that of Wu, Klaus and Duda",
            exponent=0.5,
            grades=_GRADES | {"density": "B", "pressure_viscosity": "B"},
            sources="density of the mineral oils of the open library GEARpie (B), conductivity of FVA 3 (C), "
            f"an Eyring stress of 3 to 8 MPa is recalled (C), {_SHEAR}",
        ),
        "pao": BaseOil(
            called="polyalphaolefin",
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
            called="ester",
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
            called="polyalkylene glycol",
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
    """Density of an oil [kg/m3]: a straight line from 0 to 200 degC through its values at 15 and 100 degC."""
    slope = (at_100 - at_15) / 85.0
    return Table((273.15, 473.15), (at_15 - 15.0 * slope, at_15 + 185.0 * slope))


def exponent_factor(law: Any, deviation: float, viscosity: float, alpha: float) -> float:
    """Relative deviation of ln(eta/eta0) that makes ln(eta) deviate so much at 0.45 GPa, by a law of pressure.

    >>> from rollslip.lubricant.pressure import default_law
    >>> round(exponent_factor(default_law(), 0.5, 0.0219, 1.8e-8), 3)
    0.081
    """
    here = Conditions(
        viscosity=viscosity,
        pressure_viscosity=alpha,
        thermoviscosity=0.0,
        pressure_thermoviscosity=0.0,
    )
    rise = math.log(float(law.at(here, 0.45e9)[0]) / viscosity)
    return deviation / rise


#: Viscosity Y at 100 degC from which a row holds [mm2/s], and a to f of L = a Y^2 + b Y + c, H = d Y^2 + e Y + f.
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
    """Return the viscosity index [1] of kinematic viscosities [m2/s] at 40 and 100 degC, after ASTM D2270.

    VI = 100 (L - U)/(L - H) with Y and U those at 100 and 40 degC in mm2/s and L(Y), H(Y) the standard's polynomials;
    of a U below H it is 100 + (10^N - 1)/0.00715, N = log(H/U)/log Y. nan below 2 mm2/s at 100 degC, where the standard
    has none. Its polynomials are recalled (C): they give the two examples that it prints, and four rows of its table.

    Examples
    --------
    >>> round(viscosity_index(73.30e-6, 8.86e-6)), round(viscosity_index(22.83e-6, 5.05e-6))
    (92, 156)
    """
    Y = 1e6 * at_100
    U = 1e6 * at_40
    row = next((row for row in reversed(_L_AND_H) if row[0] <= Y), None)
    if row is None:
        return math.nan
    _, a, b, c, d, e, f = row
    L = (a * Y + b) * Y + c
    H = (d * Y + e) * Y + f
    if U >= H:
        return 100.0 * (L - U) / (L - H)
    return 100.0 + (math.pow(10.0, math.log10(H / U) / math.log10(Y)) - 1.0) / 0.00715


def at_100_of(at_40: float, index: float) -> float:
    """Return the kinematic viscosity [m2/s] at 100 degC that has a viscosity index with that at 40 degC; nan if none.

    >>> round(1e6 * at_100_of(73.30e-6, 92.43), 2)
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


def estimated(
    kind: str, kinematic: Walther | None, given: Mapping[str, Any]
) -> tuple[dict[str, Any], str]:
    """Return what a kind of base oil gives of what is not given, and a sentence on where that comes from."""
    of = BASE_OILS[kind]
    found: dict[str, Any] = {
        "density": falling_density(*of.density),
        "conductivity": Constant(of.conductivity),
        "eyring_stress": of.eyring_stress,
        "shear_modulus": of.shear_modulus,
    }
    if kinematic is not None:
        found["pressure_viscosity"] = of.coefficient(kinematic)
    found = {key: value for key, value in found.items() if given.get(key) is None}
    told = ", ".join(f"{key} ({of.grades[key]})" for key in found)
    return (
        found,
        f"Estimated from base_oil = {kind!r}: {told}; {of.sources}; alpha: {of.alpha_source}."
        if told
        else "",
    )
