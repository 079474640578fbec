"""Oils of Russian aircraft engines: the paper's VNII NP 50-1-4U, IPM-10 and B-3V.

No rheology of them was found. What is known is recalled from their specifications, least viscosities at 100 degC and
largest ones at -40 degC, so all of this is graded (C) or (D): it is for comparisons, and for those who know better than
nothing and will replace single values in ``[lubricant]``.
"""

from rollslip.lubricant import (
    Constant,
    Hyperbola,
    Lubricant,
    PowerOfViscosity,
    Product,
    TemperatureLaw,
    Walther,
    WuKlausDuda,
    fit_walther,
)
from rollslip.lubricant.base_oil import falling_density
from rollslip.references import Reference
from rollslip_plugins.bibliography import GOST_13076, TU_B_3V, TU_IPM_10
from rollslip_plugins.data.lubricants import mil_prf_23699, scatter_of


def _kinematic(at_minus_40: float, at_100: float) -> Walther:
    """Walther's law through viscosities [mm2/s] at -40 and 100 degC."""
    return fit_walther([233.15, 373.15], [1e-6 * at_minus_40, 1e-6 * at_100], density=1.0)


def _of_limits(
    name: str,
    description: str,
    limits: tuple[float, float],
    density: tuple[float, float],
    alpha: TemperatureLaw,
    alpha_source: str,
    specification: Reference,
    base_oil: str,
    exponent: float,
) -> Lubricant:
    """An oil of which the limits of its viscosity are recalled."""
    rho = falling_density(*density)
    return Lubricant(
        name=name,
        description=description,
        base_oil=base_oil,
        viscosity=Product(_kinematic(*limits), rho),
        pressure_viscosity=alpha,
        conductivity=Constant(0.15),
        density=rho,
        eyring_stress=4e6,
        shear_modulus=0.3e9,
        minimum_temperature=273.15,
        maximum_temperature=453.15,
        source=(
            f"Walther's law through the limits of its specification, at least {limits[1]:g} mm2/s at 100 degC and at "
            f"most {limits[0]:g} mm2/s at -40 degC, recalled and not read (C): a delivery can be thicker at 100 degC. "
            f"Density {density[0]:g} kg/m3 at 15 degC (D). Pressure-viscosity coefficient: {alpha_source} (D). "
            "Conductivity 0.15 W/(m K), recalled of such oils (C). Eyring stress 4 MPa (D), published traction curves "
            "give 1 to 10 MPa; shear modulus 0.3 GPa (C), 0.05 to 1 GPa. Range 0 to 180 degC (D)."
        ),
        references=(specification,),
        scatter=scatter_of(
            exponent,
            0.1,
            "(D)",
            "the specification sets a least viscosity only; as wide as a grade of ISO 3448, 10 % either way",
            0.3,
            "no measurement was found; formulas for esters and polyalphaolefins differ by 30 %",
        ),
        grades={
            "viscosity": "C",
            "density": "D",
            "pressure_viscosity": "D",
            "conductivity": "C",
            "eyring_stress": "D",
            "shear_modulus": "C",
            "pressure_viscosity_kind": "D",
        },
    )


_ESTER = _kinematic(12500.0, 5.0)
_B_3V = falling_density(987.7, 919.8)
_PAO = _kinematic(2000.0, 3.0)
_OF_23699 = mil_prf_23699.pressure_viscosity
assert isinstance(_OF_23699, PowerOfViscosity)

vnii_np_50_1_4u = _of_limits(
    "vnii-np-50-1-4u",
    "Synthetic diester VNII NP 50-1-4U of aircraft engines, the paper's oil, 3.2 mm2/s at 100 degC",
    (2000.0, 3.2),
    (920.6, 860.8),
    Hyperbola(limit=7.5808e-10, slope=1.0742e-6, pole=215.56),
    "that of mil-prf-7808, an oil of the same class",
    GOST_13076,
    "ester",
    0.27,
)
ipm_10 = _of_limits(
    "ipm-10",
    "Synthetic hydrocarbon oil IPM-10 of aircraft engines, 3 mm2/s at 100 degC",
    (2000.0, 3.0),
    (825.0, 785.0),
    WuKlausDuda(_PAO),
    "formula of Wu, Klaus and Duda on this viscosity",
    TU_IPM_10,
    "pao",
    0.18,
)
b_3v = _of_limits(
    "b-3v",
    "Pentaerythritol ester B-3V of helicopter gears and aircraft engines, 5 mm2/s at 100 degC",
    (12500.0, 5.0),
    (987.7, 919.8),
    PowerOfViscosity(Product(_ESTER, _B_3V), _OF_23699.factor, _OF_23699.exponent),
    "from this viscosity as for mil-prf-23699, a polyol ester too",
    TU_B_3V,
    "ester",
    0.2,
)
