"""The built-in oils.

The temperature laws are published fits. Eyring stress and shear modulus, which scenes of slip need too, are rarely
measured for a named oil. Each ``source`` states that, and each datum has a grade of `rollslip.lubricant.GRADES`: no oil
lacks a value that a built-in model reads, but values without a source are graded (C) or (D). ``scatter`` states how
uncertain the data are, with grades of its own.
"""

from math import exp, log

from rollslip.lubricant import (
    Andrade,
    Constant,
    Exponential,
    Hyperbola,
    Lubricant,
    PowerOfViscosity,
    Scatter,
    Table,
    Walther,
    oil,
)
from rollslip.lubricant.base_oil import falling_density
from rollslip_plugins.bibliography import GUPTA_1984

#: Eyring stress of the turbine oils [Pa] (D), see `_SHEAR_SOURCE`.
_EYRING_STRESS = 4e6
#: Shear modulus of the turbine oils [Pa] (C), see `_SHEAR_SOURCE`.
_SHEAR_MODULUS = 0.3e9
_SHEAR_SOURCE = (
    "Eyring stress 4 MPa (D), published traction curves give 1 to 10 MPa; shear "
    "modulus 0.3 GPa (C), 0.05 to 1 GPa."
)
_REFERENCES = (GUPTA_1984,)
_KIND_SOURCE = (
    "alpha is taken as the slope at no pressure (C): its source does not say which it is."
)
_ATTRIBUTION = "as in the lubricant library of the bearing code ADORE (Gupta, 1984; attribution C)"


def _grades(**own: str) -> dict[str, str]:
    """Grades of an oil: its own, and those of what is common to all."""
    return own | {"eyring_stress": "D", "shear_modulus": "C", "pressure_viscosity_kind": "C"}


#: Lowest temperature of the turbine oils [K] (D), see `_RANGE_SOURCE`.
_LOWEST = 273.15
#: Highest temperature of the turbine oils [K] (D), see `_RANGE_SOURCE`.
_HIGHEST = 473.15
_RANGE_SOURCE = (
    "Range 0 to 200 degC (D): the service range of such oils; over it the laws are finite and fall, but the "
    "temperatures behind the fits are not published."
)


_FORMULAS = (
    "correlations of the coefficient after So and Klaus, Wu, Klaus and Duda, and Gold differ by"
)


def scatter_of(
    exponent: float,
    viscosity: float,
    grade: str,
    source: str,
    pressure_viscosity: float = 0.25,
    pressure_viscosity_source: str = f"{_FORMULAS} 25 %",
) -> tuple[Scatter, ...]:
    """Return the scatter of an oil; ``exponent`` is that of ln(eta/eta0), after `rollslip.lubricant.base_oil`."""
    return oil.scatter_of(
        viscosity, grade, source, pressure_viscosity, pressure_viscosity_source, exponent
    )


mil_prf_7808 = Lubricant(
    name="mil-prf-7808",
    base_oil="ester",
    synonyms=("MIL-L-7808",),
    description="Diester turbine oil after MIL-PRF-7808 (formerly MIL-L-7808), 3 mm2/s at 100 degC",
    # Published in natural logarithms: eta = 9.997e-4 [exp(exp(22.216 - 3.7048 ln T)) - 0.87] Pa s.
    viscosity=Walther(
        intercept=(22.216 - log(log(10.0))) / log(10.0), slope=3.7048, constant=0.87, scale=9.997e-4
    ),
    pressure_viscosity=Hyperbola(limit=7.5808e-10, slope=1.0742e-6, pole=215.56),
    conductivity=Table(
        temperatures=(303.15, 313.15, 323.15, 343.15, 373.15),
        values=(0.145, 0.144, 0.1425, 0.1386, 0.1338),
    ),
    source=(
        "Viscosity, pressure-viscosity coefficient and conductivity: property functions of the bearing code ADORE "
        "(Gupta, 1984) for MIL-L-7808; conductivity as table from 30 to 100 degC, linear between and constant beyond. "
        "The coefficient scatters by 25 % between correlations. Density 921 kg/m3 at 15 degC and 861 at 100 degC, read "
        f"from a chart (C). {_KIND_SOURCE} {_SHEAR_SOURCE} {_RANGE_SOURCE}"
    ),
    references=_REFERENCES,
    density=falling_density(920.6, 860.8),
    grades=_grades(viscosity="B", pressure_viscosity="B", conductivity="B", density="C"),
    eyring_stress=_EYRING_STRESS,
    shear_modulus=_SHEAR_MODULUS,
    minimum_temperature=_LOWEST,
    maximum_temperature=_HIGHEST,
    scatter=scatter_of(
        0.27,
        0.1,
        "(D)",
        "the specification sets a least viscosity only; as wide as a grade of ISO 3448, 10 % either way",
    ),
)

_VISCOSITY_23699 = Andrade(
    reference_viscosity=0.0276, reference_temperature=311.111, slope=3609.6, curvature=7.7657e5
)

mil_prf_23699 = Lubricant(
    name="mil-prf-23699",
    base_oil="ester",
    synonyms=("MIL-L-23699",),
    description="Polyol ester turbine oil after MIL-PRF-23699 (formerly MIL-L-23699), 5 mm2/s at 100 degC",
    viscosity=_VISCOSITY_23699,
    # Published as alpha = exp(1.15607 ln eta - 17.496) / eta.
    pressure_viscosity=PowerOfViscosity(_VISCOSITY_23699, factor=exp(-17.496), exponent=0.15607),
    source=(
        f"Viscosity and pressure-viscosity coefficient: fits for MIL-L-23699 {_ATTRIBUTION}. Conductivity "
        "0.15 W/(m K), common of esters (C). Density 988 kg/m3 at 15 degC and 920 at 100 degC, read from a chart (C). "
        f"{_KIND_SOURCE} {_SHEAR_SOURCE} {_RANGE_SOURCE}"
    ),
    references=_REFERENCES,
    conductivity=Constant(0.15),
    density=falling_density(987.7, 919.8),
    grades=_grades(viscosity="C", pressure_viscosity="C", conductivity="C", density="C"),
    eyring_stress=_EYRING_STRESS,
    shear_modulus=_SHEAR_MODULUS,
    minimum_temperature=_LOWEST,
    maximum_temperature=_HIGHEST,
    scatter=scatter_of(0.2, 0.05, "(B)", "the specification allows 4.90 to 5.40 mm2/s at 100 degC"),
)

santotrac_50 = Lubricant(
    name="santotrac-50",
    description="Synthetic cycloaliphatic traction fluid",
    viscosity=Walther(intercept=9.5363, slope=3.7452, constant=0.8, scale=889e-6),
    pressure_viscosity=Exponential(
        reference_value=3.916e-8, reference_temperature=277.78, rate=0.0083178
    ),
    source=(
        f"Kinematic viscosity and pressure-viscosity coefficient: fits {_ATTRIBUTION}; the first gives 37.5 mm2/s at "
        "38 degC, where data sheets print 34 (C). Density 889 kg/m3 (C), its value at 38 degC, constant in the "
        "viscosity; for drags it falls by 0.65 kg/m3 per K (D). Conductivity 0.13 W/(m K), printed with a rig test of "
        f"this fluid (B). {_SHEAR_SOURCE} A traction fluid lies at the upper end. {_RANGE_SOURCE}"
    ),
    references=_REFERENCES,
    conductivity=Constant(0.13),
    density=falling_density(904.0, 848.7),
    grades=_grades(viscosity="C", pressure_viscosity="C", conductivity="B", density="C"),
    eyring_stress=_EYRING_STRESS,
    shear_modulus=_SHEAR_MODULUS,
    minimum_temperature=_LOWEST,
    maximum_temperature=_HIGHEST,
    scatter=scatter_of(
        0.078,
        0.1,
        "(D)",
        "no tolerance of the maker was found; as wide as a grade of ISO 3448, 10 % either way",
    ),
)

_VISCOSITY_SAE_30 = Andrade(reference_viscosity=0.07166, reference_temperature=311.11, slope=4104.3)
#: Exponent of the viscosity in the pressure-viscosity coefficient of mineral oils [1], by Gold's correlation (C): 0 is
#: the constant coefficient of the source, with which the oil thickens with heat above 0.7 GPa at 68 degC by Roelands's
#: law. With 0.139 it does not up to 3 GPa and 150 degC.
_GOLD_EXPONENT = 0.139

sae_30 = Lubricant(
    name="sae-30",
    base_oil="mineral",
    description="Mineral engine oil of grade SAE 30",
    viscosity=_VISCOSITY_SAE_30,
    pressure_viscosity=PowerOfViscosity(
        _VISCOSITY_SAE_30, factor=1.9e-8 / 0.07166**_GOLD_EXPONENT, exponent=_GOLD_EXPONENT
    ),
    source=(
        f"Viscosity and pressure-viscosity coefficient: fits {_ATTRIBUTION}; the coefficient does not depend on "
        "temperature there. Here its 19 1/GPa are those at 38 degC, and it falls with the viscosity to the power of "
        "0.139, as in mineral oils by Gold's correlation (C). Conductivity 0.134 W/(m K), that of the mineral oil "
        f"FVA 3 (C). Density of the mineral oils of ISO VG grades here (D). {_KIND_SOURCE} {_SHEAR_SOURCE} "
        f"{_RANGE_SOURCE}"
    ),
    references=_REFERENCES,
    conductivity=Constant(0.134),
    density=falling_density(902.0, 858.0),
    grades=_grades(viscosity="C", pressure_viscosity="C", conductivity="C", density="D"),
    eyring_stress=_EYRING_STRESS,
    shear_modulus=_SHEAR_MODULUS,
    minimum_temperature=_LOWEST,
    maximum_temperature=_HIGHEST,
    scatter=scatter_of(0.091, 0.15, "(B)", "SAE J300 allows 9.3 to 12.5 mm2/s at 100 degC"),
)
