"""Power that seals of a bearing and of its shaft lose to friction, by formulas of a maker and of a standard."""

from typing import Any, ClassVar, Final

import attrs

from rollslip.errors import DomainError
from rollslip.fields import at_least, parameter, positive
from rollslip.references import Reference, ReferenceValue
from rollslip.studies.steady_slip.loss import LossModel
from rollslip.studies.steady_slip.torque import Duty
from rollslip_plugins.bibliography import ISO_14179
from rollslip_plugins.drag.factor import scattering_factor

#: Millimetres in a metre: both formulas take diameters in mm.
_MM: Final = 1e3
#: Newton metres in a newton millimetre.
_PER_NMM: Final = 1e-3
#: K_S1 of SKF's table of seals [N/mm], of seals LS of cylindrical roller bearings: friction rises with it (C).
_K_S1: Final = 0.032
#: K_S2 of that table [N mm], of the same seals: the part that does not depend on the diameter (C).
_K_S2: Final = 50.0
#: Exponent of the diameter in that table [1], of the same seals (C).
_EXPONENT: Final = 2.0
#: Power of a radial lip seal over the square of its diameter in mm and its speed in 1/min [W], ISO/TR 14179-2 (C).
_LIP: Final = 7.69e-6
#: Standard deviation of the logarithm of both powers (D): seals of nitrile rubber lose 0.65 of those of fluorinated
#: rubber by ISO/TR 14179-1, a logarithm of -0.43, and neither source states the scatter of one seal.
_DEVIATION: Final = 0.4
#: What that scatter rests on.
_SCATTER: Final = "0.65 of the power with another rubber, ISO/TR 14179-1 (C); the scatter of one seal is not stated"


def _diameter(doc: str) -> Any:
    """Return a parameter for the diameter on which a lip rubs."""
    return parameter(
        default=None,
        unit="m",
        validator=attrs.validators.optional(positive),
        doc=f"diameter on which the lip rubs; by default {doc}",
        usual=(5e-3, 1),
        possible=(1e-3, 10),
    )


@attrs.frozen(kw_only=True)
class SkfSeals(LossModel):
    """Friction of the two seals of a sealed cylindrical roller bearing, by the table of SKF's catalogue.

    P = f M w, M = K_S1 d_s^2 + K_S2.

    The catalogue has M of both seals in N mm with d_s in mm; of one seal it is half. It does not depend on speed, load,
    temperature or grease.

    Symbols:

    - P: lost power [W]
    - f: factor (``factor``) [1]
    - M: friction torque of both seals [N m]
    - w: speed of the rings, relative to each other [rad/s]
    - d_s: diameter on which the lip rubs (``diameter``), by default that of the outer raceway, E of the catalogue [m]
    - K_S1, K_S2: 0.032 N/mm and 50 N mm of seals LS, recalled (C)

    Range: seals LS that rub, both sides, outside diameters of 42 to 360 mm, run in.

    Raises
    ------
    DomainError
        If neither the diameter of the lip nor that of the rollers is known.

    Examples
    --------
    Lips on 100 mm at 1000 1/min: 0.032 100^2 + 50 = 370 N mm, times 104.72 rad/s.

    >>> duty = Duty(bore=0.07, outside_diameter=0.11, pitch_diameter=0.09, roller_diameter=0.01, radial_load=1e3,
    ...             speed=104.719755, viscosity=1e-2)
    >>> round(SkfSeals().power(duty), 2)
    38.75
    """

    name: ClassVar[str] = "skf-seals"
    equation: ClassVar[str] = "P = f (K_S1 d_s^2 + K_S2) w"
    references: ClassVar[tuple[Reference, ...]] = (
        Reference(
            kind="remark",
            title="SKF. General catalogue 6000 (2006), friction of bearings, table 4: exponent and constants of the "
            "friction of seals, recalled (C).",
        ),
    )
    place: ClassVar[str] = "inner land"

    factor: float = scattering_factor(_DEVIATION, _SCATTER)
    diameter: float | None = _diameter("that of the outer raceway, from pitch circle and rollers")

    def power(self, duty: Duty) -> float:
        """Return the power of both seals [W]."""
        diameter = self.diameter
        if diameter is None:
            if duty.roller_diameter is None:
                raise DomainError("needs the diameter on which the lip rubs: give its diameter")
            diameter = duty.pitch_diameter + duty.roller_diameter
        torque: float = _K_S1 * (_MM * diameter) ** _EXPONENT + _K_S2
        return self.factor * _PER_NMM * torque * duty.speed


@attrs.frozen(kw_only=True)
class RadialLipSeal(LossModel):
    """Friction of radial lip seals on the shaft beside the bearing, by ISO/TR 14179-2.

    P = f z 7.69e-6 d^2 n.

    The report has P in W with d in mm and n in 1/min. It does not depend on oil or temperature.

    Symbols:

    - P: lost power [W]
    - f: factor (``factor``) [1]
    - z: number of seals (``number``) [1]
    - d: diameter of the shaft (``diameter``), by default the bore of the bearing [m]
    - n: speed of the rings, relative to each other [1/min]

    Range: seals with one lip and a garter spring in gear units, run in and wet. ISO/TR 14179-1 gives 2 % more of
    fluorinated rubber on 50 mm and 0.66 of it of nitrile rubber, in proportion to d, and so less on larger shafts (C).

    Examples
    --------
    A shaft of 50 mm at 3000 1/min: 7.69e-6 2500 3000 W.

    >>> duty = Duty(bore=0.05, outside_diameter=0.09, pitch_diameter=0.07, radial_load=1e3, speed=314.159265,
    ...             viscosity=1e-2)
    >>> round(RadialLipSeal().power(duty), 1)
    57.7
    """

    name: ClassVar[str] = "radial-lip-seal"
    equation: ClassVar[str] = "P = f z 7.69e-6 d^2 n"
    references: ClassVar[tuple[Reference, ...]] = (ISO_14179,)
    reference_values: ClassVar[tuple[ReferenceValue, ...]] = (
        ReferenceValue(
            inputs={
                "bore": 0.05,
                "outside_diameter": 0.09,
                "pitch_diameter": 0.07,
                "radial_load": 1e3,
                "speed": 314.159265,
                "viscosity": 1e-2,
            },
            parameters={"factor": 1.0, "diameter": None, "number": 1},
            value=58.7,
            rtol=0.05,
            source="ISO/TR 14179-1:2001, fluorinated rubber: 3.737e-3 N m/mm times 50 mm at 3000 1/min (C)",
        ),
    )
    place: ClassVar[str] = "inner land"

    factor: float = scattering_factor(_DEVIATION, _SCATTER)
    diameter: float | None = _diameter("the bore of the bearing")
    number: int = parameter(default=1, doc="number of seals", validator=at_least(1))

    def power(self, duty: Duty) -> float:
        """Return the power of all seals [W]."""
        diameter = duty.bore if self.diameter is None else self.diameter
        return self.factor * self.number * _LIP * (_MM * diameter) ** 2 * duty.revolutions
