"""Friction torque of a cylindrical roller bearing as makers' catalogues and Palmgren give it."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar, Final

import attrs

from rollslip.fields import non_negative, one_of, parameter
from rollslip.hookspecs import hookimpl
from rollslip.references import Reference
from rollslip.studies.steady_slip.torque import Duty, TorqueFormula
from rollslip_plugins.bibliography import HARRIS_2007, ISO_15312, PALMGREN_1959

_SKF_CATALOGUE: Final = Reference(
    kind="remark",
    title="SKF. General catalogue 6000 (2006), pages 88 to 101, tables 1, 2a, 3c and 5: model of the friction torque.",
)
#: Series of bearings with a cage -> R1 of table 3c.
_ROLLING: Final[Mapping[str, float]] = MappingProxyType(
    {
        "2": 1.09e-6, "3": 1.09e-6, "4": 1.00e-6, "10": 1.12e-6, "12": 1.23e-6, "20": 1.23e-6, "22": 1.40e-6,
        "23": 1.48e-6,
    }
)  # fmt: skip
#: How oil comes to the rollers -> K_rs.
_SUPPLY: Final[Mapping[str, float]] = MappingProxyType(
    {"plenty": 0.0, "low-bath or jet": 3e-8, "grease or oil-air": 6e-8}
)
#: S2 of table 3c, K_Z of table 5, and the friction of sliding in mixed and full film.
_SLIDING, _CROWDED, _MIXED, _FULL = 0.0015, 5.1, 0.15, 0.02
#: Of catalogues' formulas, in mm, N mm, mm2/s.
_MM: Final = 1e3
_PER_NMM: Final = 1e-3
_CST: Final = 1e6


@attrs.frozen(kw_only=True)
class Skf(TorqueFormula):
    """SKF's model of the friction torque of a bearing with a cage under radial load, without seals.

    M = phi_ish phi_rs R_1 d_m^2.41 F_r^0.31 (nu n)^0.6 + S_2 d_m F_r mu_sl,
    phi_ish = 1/[1 + 1.84e-9 (n d_m)^1.28 nu^0.64], phi_rs = exp(-K_rs nu n (d + D) sqrt(K_Z/(2 (D - d)))),
    mu_sl = phi_bl 0.15 + (1 - phi_bl) 0.02, phi_bl = exp(-2.6e-8 (n nu)^1.4 d_m).

    The catalogue has it in N mm with lengths in mm, nu in mm2/s and n in 1/min; here it comes out in N m. What the oil
    of a bath resists, M_drag, is not in it: the catalogue gives it by the oil's level, in a diagram.

    Symbols:

    - M: friction torque [N m]
    - R_1, S_2: constants of rolling and sliding, table 3c; R_1 by the ``series`` [1]
    - d_m: mean diameter, here that of the pitch circle, up to 1.3 % larger [m]
    - d, D: bore and outside diameter, estimated [m]
    - F_r: radial load [N]
    - nu: kinematic viscosity at the oil's temperature [m2/s]
    - n: speed of the rings, relative to each other [1/s]
    - phi_ish, phi_rs, phi_bl: heat of the inlet, starvation by ``supply``, and share of mixed friction [1]
    - mu_sl: friction of sliding [1]
    - K_rs, K_Z: constants of supply, and 5.1 for these bearings with a cage [1]

    Range: loads above the least load that SKF asks for, constant in size and direction, usual clearance, aligned.

    Examples
    --------
    Size 210 at 3000 1/min with 2 kN in an oil of 10 mm2/s.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, radial_load=2e3, speed=314.159265,
    ...             viscosity=9e-3, density=900.0)
    >>> {term: round(1e3 * torque, 2) for term, torque in Skf(series="2").terms(duty).items()}
    {'rolling': 148.47, 'sliding': 5.14}
    """

    name: ClassVar[str] = "skf"
    equation: ClassVar[str] = "M = phi_ish phi_rs R_1 d_m^2.41 F_r^0.31 (nu n)^0.6 + S_2 d_m F_r mu_sl"
    references: ClassVar[tuple[Reference, ...]] = (_SKF_CATALOGUE,)

    series: str = parameter(default="10", validator=one_of(*_ROLLING), doc="series of dimensions, by which R_1 goes")
    supply: str = parameter(
        default="plenty",
        validator=one_of(*_SUPPLY),
        doc="how oil comes to the rollers: a bath up to the lowest roller's middle has plenty",
    )

    def terms(self, duty: Duty) -> dict[str, float]:
        """Return the torque of rolling and that of sliding [N m]."""
        d, D, d_m = _MM * duty.bore, _MM * duty.outside_diameter, _MM * duty.pitch_diameter
        nu, n, load = _CST * duty.kinematic_viscosity, duty.revolutions, duty.radial_load
        heated = 1.0 / (1.0 + 1.84e-9 * (n * d_m) ** 1.28 * nu**0.64)
        starved = math.exp(-_SUPPLY[self.supply] * nu * n * (d + D) * math.sqrt(_CROWDED / (2.0 * (D - d))))
        rolling = heated * starved * _ROLLING[self.series] * d_m**2.41 * load**0.31 * (nu * n) ** 0.6
        mixed = math.exp(-2.6e-8 * (n * nu) ** 1.4 * d_m)
        sliding = _SLIDING * d_m * load * (mixed * _MIXED + (1.0 - mixed) * _FULL)
        return {"rolling": _PER_NMM * rolling, "sliding": _PER_NMM * sliding}


@attrs.frozen(kw_only=True)
class Palmgren(TorqueFormula):
    """Palmgren's friction torque, one term by oil and one by load, on which ISO 15312 rests.

    M = f_0 1e-7 (nu n)^(2/3) d_m^3 + f_1 F_r d_m, the first with nu n of 2000 where it is less.

    It is published in N mm with d_m in mm, nu in mm2/s and n in 1/min; here it comes out in N m.

    Symbols:

    - M: friction torque [N m]
    - f_0: factor of oil and its supply (``oil_factor``) [1]
    - f_1: factor of load (``load_factor``) [1]
    - nu: kinematic viscosity at the oil's temperature [m2/s]
    - n: speed of the rings, relative to each other [1/s]
    - d_m: mean diameter, here that of the pitch circle [m]
    - F_r: radial load [N]

    Range: bearings with a cage. f_0 is 2 for light and 4 for heavy series in a bath of oil, 1.5 to 2.8 in oil mist; f_1
    is 0.0002 to 0.0004. These are recalled (C).

    Examples
    --------
    200 (nu n)^(2/3) at 3e4 is 965.5: 1e-7 2 965.5 70^3 = 66.2 N mm, and 0.0003 2000 70 = 42 N mm.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, radial_load=2e3, speed=314.159265,
    ...             viscosity=9e-3, density=900.0)
    >>> {term: round(1e3 * torque, 1) for term, torque in Palmgren().terms(duty).items()}
    {'oil': 66.2, 'load': 42.0}
    """

    name: ClassVar[str] = "palmgren-torque"
    equation: ClassVar[str] = "M = f_0 1e-7 (nu n)^(2/3) d_m^3 + f_1 F_r d_m"
    references: ClassVar[tuple[Reference, ...]] = (PALMGREN_1959, HARRIS_2007, ISO_15312)

    oil_factor: float = parameter(
        default=2.0, unit="1", validator=non_negative, doc="factor f_0 of oil", usual=(0.5, 10), possible=(0, 100)
    )
    load_factor: float = parameter(
        default=3e-4, unit="1", validator=non_negative, doc="factor f_1 of load", usual=(1e-4, 1e-3), possible=(0, 0.1)
    )

    def terms(self, duty: Duty) -> dict[str, float]:
        """Return the torque of the oil and that of the load [N m]."""
        d_m, turned = _MM * duty.pitch_diameter, max(_CST * duty.kinematic_viscosity * duty.revolutions, 2000.0)
        oil = self.oil_factor * 1e-7 * turned ** (2.0 / 3.0) * d_m**3
        return {"oil": _PER_NMM * oil, "load": _PER_NMM * self.load_factor * duty.radial_load * d_m}


@attrs.frozen(kw_only=True)
class ConstantCoefficient(TorqueFormula):
    """One coefficient of friction at the bore, SKF's estimate for a load of a tenth of the rating.

    M = mu F_r d/2.

    Symbols:

    - M: friction torque [N m]
    - mu: coefficient of friction (``coefficient``) [1]
    - F_r: radial load [N]
    - d: bore, estimated [m]

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


@hookimpl
def torque_formulas() -> list[type[TorqueFormula]]:
    """Offer the formulas."""
    return [Skf, Palmgren, ConstantCoefficient]
