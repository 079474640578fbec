"""Friction torque of a cylindrical roller bearing by the formulas of manufacturers' catalogues and of Palmgren."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Final

import attrs

from rollslip.errors import DomainError
from rollslip.fields import choice_of, non_negative, parameter
from rollslip.references import Reference
from rollslip.studies.steady_slip.torque import Duty, TorqueFormula
from rollslip.units import format_quantity
from rollslip_plugins.bibliography import HARRIS_2007, ISO_15312, PALMGREN_1959

_SKF_CATALOGUE: Final = Reference(
    kind="remark",
    title="SKF. General catalogue 6000 (2006), pages 88 to 101, tables 1, 2a, 3c and 5: model of the friction torque.",
)
_SKF_LATER: Final = Reference(
    kind="remark",
    title="SKF. Rolling bearings, catalogues from 2012 on: drag losses of the model of the friction torque, recalled "
    "(C) and found alike in two open programs, but for the diagram of the losses by the level of oil.",
)
#: Dimension series of bearings with a cage -> R1 of table 3c of the catalogue.
_ROLLING: Final[Mapping[str, float]] = MappingProxyType(
    {
        "2": 1.09e-6, "3": 1.09e-6, "4": 1.00e-6, "10": 1.12e-6, "12": 1.23e-6, "20": 1.23e-6, "22": 1.40e-6,
        "23": 1.48e-6,
    }
)  # fmt: skip
#: S_1 of SKF's friction torque [mm^0.1], of cylindrical roller bearings with a cage under axial load (B).
_S1: Final = 0.16
#: S2 of table 3c: sliding friction is proportional to it.
_S2 = 0.0015
#: K_Z of table 5, of cylindrical roller bearings with a cage: starvation and drag of the oil depend on it.
_K_Z = 5.1
#: K_L of table 5, of cylindrical roller bearings with a cage: drag of the oil depends on it.
_K_L = 0.65
#: Coefficient of sliding friction of mixed lubrication, by the catalogue.
_MIXED_FRICTION = 0.15
#: Coefficient of sliding friction of a full film, by the catalogue for cylindrical roller bearings.
_FULL_FILM_FRICTION = 0.02
#: Largest level of oil over d_m up to which V_M is known to rise in proportion (C).
_MAX_OIL_LEVEL = 0.3
#: Slope of V_M over the level of oil over d_m (C).
_V_M_SLOPE = 7.3e-4
#: Dimension series -> f_0r and f_1r of ISO 15312, of a bath to the middle of the lowest roller.
_ISO: Final[Mapping[str, tuple[float, float]]] = MappingProxyType(
    {
        "10": (2.0, 2e-4),
        "2": (2.0, 3e-4),
        "3": (2.0, 3.5e-4),
        "4": (2.0, 4e-4),
        "22": (3.0, 4e-4),
        "23": (4.0, 4e-4),
    }
)
#: Kind of supply -> Palmgren's f_0 over that of a bath: 1.5 to 2.8 and 0.6 to 1 over 2.2 to 4 (C).
_BY_SUPPLY: Final[Mapping[str, float]] = MappingProxyType(
    {"bath": 1.0, "splash": 1.0, "circulating": 1.0, "jet": 1.0, "mist": 0.7, "grease": 0.26}
)
#: K_rs of a bath below the middle of the lowest roller, by SKF: starvation increases with it.
_K_RS_OF_LOW_BATH: Final = 3e-8
#: Kinds of supply that leave a roller less oil than a bath to its middle -> SKF's K_rs.
_K_RS: Final[Mapping[str, float]] = MappingProxyType(
    {"splash": 3e-8, "circulating": 3e-8, "jet": 3e-8, "mist": 6e-8, "grease": 6e-8}
)
#: Diameter series and the smallest (D - d)/d^0.9 [mm^0.1] of its bearings; fitted to the catalogue, see
#: `dimension_series`.
_SMALLEST_OF_SERIES = (("4", 2.15), ("3", 1.62), ("2", 1.03), ("10", 0.0))
#: Smallest ratio of B to half of D - d of wide bearings; fitted to the catalogue, see `dimension_series`.
_WIDE_RATIO = 1.03
#: Millimetres in a metre: the formulas of catalogues are in mm, N mm and mm2/s.
_MM: Final = 1e3
#: Newton metres in a newton millimetre.
_PER_NMM: Final = 1e-3
#: Square millimetres per second in a square metre per second.
_CST: Final = 1e6
#: Smallest nu n [mm2/s/min] of Palmgren's term of oil; below it the term is constant (Palmgren).
_MIN_NU_N: Final = 2000.0


def dimension_series(duty: Duty) -> str:
    """Return the dimension series of a bearing, estimated from its boundary dimensions if its designation has none.

    Compared with the 185 sizes of the catalogue, estimated from their rollers: narrow and wide ones are distinguished
    without an error, five of six get their own diameter series, the others the next one.
    """
    if duty.series:
        return duty.series
    d = _MM * duty.bore
    D = _MM * duty.outside_diameter
    B = _MM * (duty.width or 0.0)
    ratio = (D - d) / d**0.9
    series = next(name for name, smallest in _SMALLEST_OF_SERIES if ratio >= smallest)
    if series == "10" or 2.0 * B / (D - d) <= _WIDE_RATIO:
        return series
    return "22" if series == "2" else "23"


def _of_series(table: Mapping[str, Any], series: str, source: str) -> Any:
    """Return the factors of a dimension series; `DomainError` if the source has none."""
    if series not in table:
        raise DomainError(
            f"has no factors of dimension series {series!r} by {source}: there are {', '.join(table)}"
        )
    return table[series]


@attrs.frozen(kw_only=True)
class Skf(TorqueFormula):
    """SKF's model of the friction torque of a bearing with a cage under radial load, without seals.

    M = phi_ish phi_rs R_1 d_m^2.41 F_r^0.31 (nu n)^0.6 + (S_1 d_m^0.9 F_a + S_2 d_m F_r) mu_sl + M_drag,
    phi_ish = 1/[1 + 1.84e-9 (n d_m)^1.28 nu^0.64], phi_rs = exp(-K_rs nu n (d + D) sqrt(K_Z/(2 (D - d)))),
    mu_sl = phi_bl 0.15 + (1 - phi_bl) 0.02, phi_bl = exp(-2.6e-8 (n nu)^1.4 d_m),
    M_drag = 4 V_M K_roll C_w B d_m^4 n^2 + 1.093e-7 n^2 d_m^3 (n d_m^2 f_t/nu)^-1.379 R_s  (``drag = "later"``)
    or 10 V_M K_roll B d_m^4 n^2  (``"2006"``),
    K_roll = K_L K_Z (d + D)/(D - d) 1e-12, C_w = 2.789e-10 a^3 - 2.786e-4 a^2 + 0.0195 a + 0.6439, a = 5 K_L B/d_m,
    f_t = sin(t/2) (1 for t > pi), R_s = 0.36 d_m^2 (t - sin t) 0.05 K_Z (d + D)/(D - d), cos(t/2) = 1 - H/(0.6 d_m).

    The catalogue has it in N mm with lengths in mm, nu in mm2/s and n in 1/min; here it comes out in N m.

    Symbols:

    - M, M_drag: friction torque, and what the oil of a bath resists [N m]
    - R_1, S_2: constants of rolling by the series, and of sliding, table 3c [1]
    - S_1, F_a: constant of sliding by axial load, 0.16 (B) [1], and axial load [N]
    - d, D, B: bore, outside diameter, width; d_m = (d + D)/2 [m]
    - F_r: radial load [N]
    - nu: kinematic viscosity at the oil's temperature [m2/s]
    - n: speed of the rings, relative to each other [1/s]
    - phi_ish, phi_rs, phi_bl: heat of the inlet, starvation by the supply, and fraction of mixed friction [1]
    - mu_sl: friction of sliding [1]
    - K_rs: 0 of a bath to the middle of the lowest roller; 3e-8 of a lower bath, of splash, circulating oil and a jet;
      6e-8 of mist and grease [1]
    - K_Z, K_L: 5.1 and 0.65 of these bearings with a cage [1]
    - H: level of the bath above the lowest point of the outer raceway, by default the middle of the lowest roller, and
      half of that where oil splashes (D) [m]
    - V_M: losses by the level, 7.3e-4 H/d_m up to H of 0.3 d_m (C): the catalogue has a diagram, of which one point was
      read, 0.3e-4 at 0.041 (A) [1]

    Circulating oil and a jet have twice the M_drag of a bath to the middle of the lowest roller (A), mist and grease
    none. The 2006 form is printed (A), that of later catalogues recalled (C). The older one gives up to 3.6 times as
    much, which the same maker's reference speeds leave no room for.

    Range: loads above the minimum load of SKF, constant in size and direction, usual clearance, aligned.

    Raises
    ------
    DomainError
        If the width is not known, the series has no constants, or the bath is deeper than the diagram.

    Examples
    --------
    NU 210 at 3000 1/min with 2 kN in a bath of 10 mm2/s.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, width=0.02, series="2", oil_level=0.005,
    ...             radial_load=2e3, speed=314.159265, viscosity=9e-3, density=900.0)
    >>> {term: round(1e3 * torque, 2) for term, torque in Skf().terms(duty).items()}
    {'rolling': 148.47, 'sliding': 5.14, 'oil drag': 7.63}
    """

    name: ClassVar[str] = "skf"
    equation: ClassVar[str] = (
        "M = phi_ish phi_rs R_1 d_m^2.41 F_r^0.31 (nu n)^0.6 + (S_1 d_m^0.9 F_a + S_2 d_m F_r) mu_sl + M_drag"
    )
    references: ClassVar[tuple[Reference, ...]] = (_SKF_CATALOGUE, _SKF_LATER)
    basis: ClassVar[str] = "a maker's regression of its tests"

    series: str = parameter(
        default="",
        validator=choice_of("", *_ROLLING),
        doc="dimension series, by which R_1 goes; empty for that of the designation",
    )
    drag: str = parameter(
        default="later",
        validator=choice_of("later", "2006", "none"),
        doc="which catalogue's drag of the oil is added",
    )

    def terms(self, duty: Duty) -> dict[str, float]:
        """Return the torque of rolling, of sliding and of the oil [N m]."""
        d = _MM * duty.bore
        D = _MM * duty.outside_diameter
        d_m = _MM * duty.mean_diameter
        nu = _CST * duty.kinematic_viscosity
        n = duty.revolutions
        load = duty.radial_load
        constant = _of_series(_ROLLING, self.series or dimension_series(duty), "SKF")
        phi_ish = 1.0 / (1.0 + 1.84e-9 * (n * d_m) ** 1.28 * nu**0.64)
        phi_rs = math.exp(
            -_replenishment(duty) * nu * n * (d + D) * math.sqrt(_K_Z / (2.0 * (D - d)))
        )
        rolling = phi_ish * phi_rs * constant * d_m**2.41 * load**0.31 * (nu * n) ** 0.6
        phi_bl = math.exp(-2.6e-8 * (n * nu) ** 1.4 * d_m)
        mu_sl = phi_bl * _MIXED_FRICTION + (1.0 - phi_bl) * _FULL_FILM_FRICTION
        ribs = _S1 * d_m**0.9 * duty.axial_load
        terms = {"rolling": rolling, "sliding": (ribs + _S2 * d_m * load) * mu_sl}
        if self.drag != "none":
            terms["oil drag"] = self._drag(duty, nu, n)
        return {term: _PER_NMM * torque for term, torque in terms.items()}

    def _drag(self, duty: Duty, nu: float, n: float) -> float:
        """Return the torque M_drag of the oil [N mm]."""
        if duty.supply in ("mist", "grease"):
            return 0.0
        if duty.width is None:
            raise DomainError(
                "needs the width of the bearing: give bearing.catalogue, such as { width = '20 mm' }"
            )
        d = _MM * duty.bore
        D = _MM * duty.outside_diameter
        d_m = _MM * duty.mean_diameter
        B = _MM * duty.width
        flows = duty.supply in ("circulating", "jet")
        middle = _MM * _lowest_middle(duty)
        level = middle if flows or duty.oil_level is None else _MM * duty.oil_level
        if duty.supply == "splash" and duty.oil_level is None:
            level *= 0.5
        if level > _MAX_OIL_LEVEL * d_m:
            largest = format_quantity(_MAX_OIL_LEVEL * d_m / _MM, "m", 4)
            raise DomainError(
                f"knows the drag of a bath up to {_MAX_OIL_LEVEL:g} of the mean diameter, {largest} above the lowest "
                f"point of the outer raceway, not {format_quantity(level / _MM, 'm', 4)}; its parameter drag = 'none' "
                "leaves the drag out"
            )
        z = _K_Z * (d + D) / (D - d)
        churning = _V_M_SLOPE * level / d_m * _K_L * z * 1e-12 * B * d_m**4 * n**2
        if self.drag == "2006":
            return 10.0 * churning * (2.0 if flows else 1.0)
        a = 5.0 * _K_L * B / d_m
        drag = 4.0 * churning * (((2.789e-10 * a - 2.786e-4) * a + 0.0195) * a + 0.6439)
        t = 2.0 * math.acos(1.0 - level / (0.6 * d_m))
        if level > 0.0 < n:
            R_s = 0.36 * d_m**2 * (t - math.sin(t)) * 0.05 * z
            f_t = math.sin(0.5 * t)
            drag += 1.093e-7 * n**2 * d_m**3 * (n * d_m**2 * f_t / nu) ** -1.379 * R_s
        return drag * (2.0 if flows else 1.0)


def _lowest_middle(duty: Duty) -> float:
    """Return the level of a bath to the middle of the lowest roller [m]."""
    if duty.roller_diameter is None:
        return 0.125 * (duty.outside_diameter - duty.bore)
    return 0.5 * duty.roller_diameter


def _replenishment(duty: Duty) -> float:
    """Return K_rs of the supply [1]."""
    if duty.supply == "bath":
        low = duty.oil_level is not None and duty.oil_level < _lowest_middle(duty)
        return _K_RS_OF_LOW_BATH if low else 0.0
    return _of_kind(_K_RS, duty)


def _of_kind(table: Mapping[str, float], duty: Duty) -> float:
    """Return the factor of the kind of supply; `DomainError` if the table has none."""
    if duty.supply not in table:
        raise DomainError(
            f"has nothing for a supply of {duty.supply!r}: there are bath, {', '.join(_K_RS)}"
        )
    return table[duty.supply]


@attrs.frozen(kw_only=True)
class Palmgren(TorqueFormula):
    """Palmgren's friction torque, one term by oil and one by load, with the factors of ISO 15312.

    M = f_0 1e-7 (nu n)^(2/3) d_m^3 + f_1 F_r d_m, the first with nu n of 2000 where it is less.

    It is published in N mm with d_m in mm, nu in mm2/s and n in 1/min; here it comes out in N m. ISO 15312 has f_0r and
    f_1r by the dimension series, for a bath to the middle of the lowest roller: 2 and 0.0002 of series 10, 2 and 0.0003
    of series 2, 2 and 0.00035 of 3, 2 and 0.0004 of 4, 3 and 0.0004 of 22, 4 and 0.0004 of 23. The thermal reference
    speeds that makers print are computed with them: 119 of one maker's are met to -3.1 to +2.8 % (B).

    Symbols:

    - M: friction torque [N m]
    - f_0: factor of oil and its supply (``oil_factor``), by default f_0r times 0.7 for mist and 0.26 for grease, the
      middle of Palmgren's ranges over those of a bath (C); others double it for a jet [1]
    - f_1: factor of load (``load_factor``), by default f_1r [1]
    - nu: kinematic viscosity at the oil's temperature, of grease that of its base oil [m2/s]
    - n: speed of the rings, relative to each other [1/s]
    - d_m: mean of bore and outside diameter [m]
    - F_r: radial load [N]

    Range: bearings with a cage; ISO's factors are for one state, 0.05 C0r, 12 mm2/s and some 4e5 mm/min of n d_m.

    Raises
    ------
    DomainError
        If ISO 15312 has no factors of the series, or none are recalled of the supply.

    Examples
    --------
    NU 210 in a bath: 1e-7 2 (3e4)^(2/3) 70^3 = 1e-7 2 965.5 70^3 = 66.2 N mm, and 0.0003 2000 70 = 42 N mm.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, width=0.02, series="2", radial_load=2e3,
    ...             speed=314.159265, viscosity=9e-3, density=900.0)
    >>> {term: round(1e3 * torque, 1) for term, torque in Palmgren().terms(duty).items()}
    {'oil': 66.2, 'load': 42.0}
    """

    name: ClassVar[str] = "palmgren-torque"
    equation: ClassVar[str] = "M = f_0 1e-7 (nu n)^(2/3) d_m^3 + f_1 F_r d_m"
    references: ClassVar[tuple[Reference, ...]] = (PALMGREN_1959, HARRIS_2007, ISO_15312)
    basis: ClassVar[str] = (
        "the formula of ISO 15312, Palmgren's tests of baths at one speed and load"
    )

    oil_factor: float | None = parameter(
        default=None,
        unit="1",
        validator=attrs.validators.optional(non_negative),
        doc="factor f_0 of oil; by default that of ISO 15312 and of the supply",
        usual=(0.5, 10),
        possible=(0, 100),
    )
    load_factor: float | None = parameter(
        default=None,
        unit="1",
        validator=attrs.validators.optional(non_negative),
        doc="factor f_1 of load; by default that of ISO 15312",
        usual=(1e-4, 1e-3),
        possible=(0, 0.1),
    )

    def terms(self, duty: Duty) -> dict[str, float]:
        """Return the torque of the oil and that of the load [N m]."""
        d_m = _MM * duty.mean_diameter
        nu_n = max(_CST * duty.kinematic_viscosity * duty.revolutions, _MIN_NU_N)
        f0 = self.oil_factor
        f1 = self.load_factor
        if f0 is None or f1 is None:
            of_oil, of_load = _of_series(_ISO, dimension_series(duty), "ISO 15312")
            if f0 is None:
                f0 = _of_kind(_BY_SUPPLY, duty) * of_oil
            if f1 is None:
                f1 = of_load
        oil = f0 * 1e-7 * nu_n ** (2.0 / 3.0) * d_m**3
        return {"oil": _PER_NMM * oil, "load": _PER_NMM * f1 * duty.radial_load * d_m}


@attrs.frozen(kw_only=True)
class ConstantCoefficient(TorqueFormula):
    """One coefficient of friction at the bore, SKF's estimate for a load of a tenth of the rating.

    M = mu F_r d/2.

    Symbols:

    - M: friction torque [N m]
    - mu: coefficient of friction (``coefficient``) [1]
    - F_r: radial load [N]
    - d: bore [m]

    Range: F_r of about 0.1 C, good lubrication, usual conditions. It knows neither oil nor speed.

    Examples
    --------
    0.0011 2000 0.05/2 = 0.055 N m.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, radial_load=2e3, speed=100.0, viscosity=1e-2)
    >>> ConstantCoefficient().terms(duty)
    {'all': 0.055}
    """

    name: ClassVar[str] = "constant-coefficient"
    equation: ClassVar[str] = "M = mu F_r d/2"
    references: ClassVar[tuple[Reference, ...]] = (_SKF_CATALOGUE,)
    basis: ClassVar[str] = "one coefficient for all speeds and oils"

    coefficient: float = parameter(
        default=0.0011,
        unit="1",
        validator=non_negative,
        doc="coefficient of friction mu",
        usual=(5e-4, 5e-3),
        possible=(0, 1),
    )

    def terms(self, duty: Duty) -> dict[str, float]:
        """Return the torque [N m]."""
        return {"all": 0.5 * self.coefficient * duty.radial_load * duty.bore}
