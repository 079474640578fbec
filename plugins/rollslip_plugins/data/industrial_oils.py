"""Mineral oils of ISO VG grades, a polyalphaolefin, a steam turbine oil, and the reference oil FVA 3.

Where alpha was not measured it is that of Wu, Klaus and Duda, and its scatter reaches as far as the formulas of Gold
and of So and Klaus: on FVA 3, the one mineral oil here with measured values, the three are 4 to 12 % low, 12 to 17 %
low and 4 to 17 % high (``docs/scripts/oils.py``). Dynamic viscosity is kinematic viscosity times density.
"""

from rollslip.hookspecs import hookimpl
from rollslip.lubricant import Constant, Hyperbola, Lubricant, Product, Table, Vogel, fit_walther
from rollslip.lubricant.base_oil import (
    BASE_OILS,
    estimate_properties,
    exponent_factor,
    falling_density,
)
from rollslip.references import Reference
from rollslip_plugins.bibliography import (
    ASTM_D341,
    GEARPIE,
    ISO_3448,
    TU_TP_22S,
    WINGERTSZAHN_2023,
    WU_1989,
)
from rollslip_plugins.data.lubricants import scatter_of
from rollslip_plugins.pressure_viscosity import Roelands

_RANGE = "Range 0 to 120 degC (D), 40 K below and 20 K above the points of the viscosity."
#: Relative scatter of the viscosity of a grade, its grade, and the source.
_GRADE_SCATTER = (0.1, "(B)", "ISO 3448 allows a grade 10 % either way")
_SHEAR = (
    "Eyring stress 5 MPa: 3 to 8 MPa are recalled of mineral oils, 2 to 6 of others (C); shear modulus 0.3 GPa (C), "
    "published traction curves give 0.05 to 1 GPa."
)


def _correlated(
    name: str,
    description: str,
    source: str,
    points: dict[float, float],
    density: tuple[float, float],
    kind: str,
    *,
    grades: dict[str, str],
    references: tuple[Reference, ...],
    synonyms: tuple[str, ...] = (),
) -> Lubricant:
    """Return an oil by kinematic viscosities [mm2/s] at temperatures [degC], and densities at 15 and 100 degC."""
    kinematic = fit_walther(
        [T + 273.15 for T in points], [1e-6 * nu for nu in points.values()], density=1.0
    )
    rho = falling_density(*density)
    base_oil = BASE_OILS[kind]
    properties, text = estimate_properties(kind, kinematic, {"density": rho})
    eta = kinematic(333.15) * rho(333.15)
    alpha = properties["pressure_viscosity"](333.15)
    return Lubricant(
        name=name,
        description=description,
        viscosity=Product(kinematic, rho),
        density=rho,
        **properties,
        base_oil=kind,
        minimum_temperature=273.15,
        maximum_temperature=393.15,
        source=(
            f"{source} Between and beyond Walther's law. Pressure-viscosity coefficient: formula of Wu, Klaus and Duda "
            "on this viscosity (B), taken as the slope at no pressure (C: it lies between that and the film's); it "
            f"scatters by {base_oil.alpha_scatter:.0%}. {text} {_RANGE}"
        ),
        references=(*references, ASTM_D341, WU_1989),
        scatter=scatter_of(
            exponent_factor(Roelands(), base_oil.exponent, eta, alpha),
            *_GRADE_SCATTER,
            base_oil.alpha_scatter,
            base_oil.alpha_source,
        ),
        grades={**base_oil.grades, **grades},
        synonyms=synonyms,
    )


def _iso_vg(grade: int, at_40: float, at_100: float) -> Lubricant:
    """Return a mineral oil of an ISO VG grade by its kinematic viscosities at 40 and 100 degC [mm2/s]."""
    return _correlated(
        f"iso-vg-{grade}",
        f"Mineral oil of the grade ISO VG {grade}",
        f"Kinematic viscosity {at_40:g} mm2/s at 40 degC and {at_100:g} at 100 degC, density 902 kg/m3 at 15 degC and "
        "858 at 100 degC: from the constants of the mineral oil in the open library GEARpie (B).",
        {40.0: at_40, 100.0: at_100},
        BASE_OILS["mineral"].density,
        "mineral",
        grades={"viscosity": "B", "density": "B", "pressure_viscosity": "B"},
        references=(GEARPIE, ISO_3448),
        synonyms=(f"VG {grade}",),
    )


#: Grade, and kinematic viscosity [mm2/s] at 40 and 100 degC.
iso_vg = [
    _iso_vg(*row)
    for row in (
        (32, 31.8, 5.38),
        (46, 45.7, 6.48),
        (68, 67.5, 8.47),
        (100, 99.1, 10.95),
        (150, 148.9, 14.45),
        (220, 218.0, 18.91),
        (320, 316.0, 22.23),
    )
]

pao_68 = _correlated(
    "pao-68",
    "Polyalphaolefin of the grade ISO VG 68",
    "Kinematic viscosity 67.5 mm2/s at 40 degC and 10.96 at 100 degC, density 859 kg/m3 at 15 degC and 819 at 100 "
    "degC: from the constants of the polyalphaolefin in the open library GEARpie (B).",
    {40.0: 67.5, 100.0: 10.96},
    BASE_OILS["pao"].density,
    "pao",
    grades={"viscosity": "B", "density": "B", "pressure_viscosity": "B"},
    references=(GEARPIE, ISO_3448),
)

tp_22s = _correlated(
    "tp-22s",
    "Steam turbine oil TP-22S, a mineral oil of the grade ISO VG 32",
    "Kinematic viscosity 32 mm2/s at 40 degC and 21.5 at 50 degC, the middles of 28.8 to 35.2 and 20 to 23 that "
    "TU 38.101821-2001 allows, known from a dealer's page (C). Density 880 kg/m3 at 15 degC and 836 at 100 degC (D).",
    {40.0: 32.0, 50.0: 21.5},
    (880.0, 836.0),
    "mineral",
    grades={"viscosity": "C", "density": "D", "pressure_viscosity": "C"},
    references=(TU_TP_22S,),
)

# eta = eta0(T) exp(p/(a1 + a2 T + (b1 + b2 T) p)), p in bar, T in degC, a1 = 327.7918, a2 = 2.9862: at no pressure the
# slope of ln(eta) is 1/(a1 + a2 T), a hyperbola without a limit.
#: a1 of this law at 0 degC [Pa].
_A1 = 327.7918e5
#: a2 of this law [Pa/K].
_A2 = 2.9862e5

fva_3 = Lubricant(
    name="fva-3",
    description="Reference mineral oil FVA 3 without additives, ISO VG 100, of measured viscosity under pressure",
    viscosity=Vogel(limit=0.062e-3, slope=1021.7, pole=273.15 - 101.5517),
    pressure_viscosity=Hyperbola(limit=0.0, slope=1.0 / _A2, pole=273.15 - _A1 / _A2),
    conductivity=Constant(0.134),
    density=Table((273.15, 423.15), (887.6 + 15.0 * 0.6, 887.6 - 135.0 * 0.6)),
    eyring_stress=5e6,
    shear_modulus=0.3e9,
    minimum_temperature=273.15,
    maximum_temperature=423.15,
    source=(
        "Viscosity, its rise with pressure, density (887.6 kg/m3 at 15 degC, falling by 0.6 kg/m3 per K) and "
        "conductivity: printed with the bearing tests of the reference (A). alpha is the slope at no pressure of the "
        "printed law eta0 exp(p/(a1 + a2 T + (b1 + b2 T) p)); at 40 degC Barus's law with it is 1.4 times that law at "
        "0.2 GPa and 3.2 times at 0.4 GPa, that of Roelands 0.73 and 0.44 times: what was measured lies between. "
        f"{_SHEAR} Range 0 to 150 degC (D): that of the measurements is not printed with the constants."
    ),
    references=(WINGERTSZAHN_2023.at("Table A1"),),
    scatter=scatter_of(
        0.074,
        0.03,
        "(D)",
        "one oil, measured",
        0.05,
        "measured: slope at no pressure against the reciprocal mean, 4 %",
    ),
    grades={
        "viscosity": "A",
        "density": "A",
        "pressure_viscosity": "A",
        "conductivity": "A",
        "eyring_stress": "C",
        "shear_modulus": "C",
        "pressure_viscosity_kind": "A",
    },
)


@hookimpl
def lubricants() -> list[Lubricant]:
    """Offer the oils of this module."""
    return [*iso_vg, pao_68, tp_22s, fva_3]
