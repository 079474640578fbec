"""Rating life of a cylindrical or tapered roller bearing by ISO 281 and by ISO/TS 16281."""

from functools import cache
from typing import ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import DomainError
from rollslip.fields import parameter
from rollslip.references import Reference
from rollslip.search import Array
from rollslip.studies.rating_life.model import (
    RATIO_EXPONENT,
    REDUCTION,
    REVOLUTIONS,
    WEIBULL_SLOPE,
    LifeDuty,
    LifeModel,
    RatedLife,
)
from rollslip_plugins.bibliography import ISO_281, ISO_16281, LUNDBERG_1952

#: Exponent of the life of a roller bearing in its load, by ISO 281.
_LIFE_EXPONENT: Final = 10.0 / 3.0
#: Exponent of the damage of a slice in its load, by Lundberg and Palmgren: Weibull slope times life exponent 4.
_DAMAGE_EXPONENT: Final = 4.5
#: Exponent of the mean load of a ring that turns relative to the load: each of its points meets all loads.
_TURNING_EXPONENT: Final = 4.0
#: Ratio of the mean loads of a ring at rest and of one that turns, with half of the rollers loaded (ISO/TS 16281).
_REST_RATIO: Final = 1.038
#: Constant of the edge factor (ISO/TS 16281): larger ones raise it at the ends, from 2.014 on to infinity.
_EDGE_CONSTANT: Final = 1.985
#: Points of the table of the integral of the edge factor, with an error of 2e-6 against an adaptive quadrature. With
#: twice as many the error is a quarter of that.
_EDGE_POINTS: Final = 4001
#: F_r/(Z Q) of the mean load Q of the inner and of the outer ring, with half of the rollers loaded (ISO/TS 16281).
_MEAN_LOADS: Final = (0.378, 0.364)
#: F_r/(Z Q_i) in the load that modifies a life (ISO 16281:2025, (31)), which is proportional to it. Where the largest
#: load of a roller is 5 F_r/Z, as for the static rating, a quadrature gives 0.331.
_MODIFYING_LOAD: Final = 0.323


@attrs.frozen(kw_only=True)
class Iso281(LifeModel):
    """Basic rating life of ISO 281: the life that nine of ten bearings reach, by radial load and dynamic rating.

    L10 = (C/P)^(10/3), P = F_r; of tapered rollers P = 0.4 F_r + 0.4 F_a cot(a) where F_a/F_r > e = 1.5 tan(a).

    Symbols:

    - L10: basic rating life [1e6 revolutions of the rings relative to each other]
    - C: basic dynamic radial load rating, of the catalogue or by geometry [N]
    - P: dynamic equivalent load [N]; F_r, F_a: radial and axial load [N]
    - a: contact angle of the outer raceway of tapered rollers [rad]

    Range: a radial load up to C0/2, aligned rings, usual clearance, fatigue of the raceways as the only failure, no
    slip. Clearance, tilt, profile and flexible rings have no effect.

    Examples
    --------
    With a rating of 100 kN and a load of 10 kN: 10^(10/3) = 2154 million revolutions.

    >>> duty = LifeDuty(rollers=14, roller_diameter=0.015, roller_length=0.016, pitch_diameter=0.09, radial_load=1e4,
    ...                 dynamic_rating=1e5, load=np.ones((2, 1, 14, 1)), widths=np.array([0.016]))
    >>> round(Iso281().rate(duty).revolutions / 1e6)
    2154
    """

    name: ClassVar[str] = "iso281"
    equation: ClassVar[str] = "L10 = (C/P)^(10/3)"
    references: ClassVar[tuple[Reference, ...]] = (ISO_281, LUNDBERG_1952)
    basis: ClassVar[str] = "ISO 281"

    def rate(self, duty: LifeDuty) -> RatedLife:
        """Return the basic rating life."""
        load = duty.equivalent_load
        if not load > 0.0:
            raise DomainError("has no finite life: there is no radial load")
        life = REVOLUTIONS * (duty.dynamic_rating / load) ** _LIFE_EXPONENT
        return RatedLife(revolutions=life, equivalent_load=load)


@attrs.frozen(kw_only=True)
class Iso16281(LifeModel):
    """Basic reference rating life of ISO/TS 16281, from the loads of all slices of the rollers.

    L10r = [sum_k (q_kei/q_kci)^(9/2) + (q_kee/q_kce)^(9/2)]^(-8/9),
    q_ke = f (mean_j q_jk^e)^(1/e), e = 4 of a ring that turns relative to the load and 9/2 of one at rest,
    q_kc = Q_c (x_k/L)^(7/9), r = ((1 - gamma)/(1 + gamma))^(143/108),
    Q_ci = C/(0.83 0.378 Z cos a) {1 + [1.038 r]^(9/2)}^(2/9),
    Q_ce = C/(0.83 0.364 Z cos a) {1 + [1.038 r]^(-9/2)}^(2/9),
    f = 1 - 0.01/ln(1.985 |x|/L).

    With slices of unequal widths the sum is a quadrature along the roller,
    sum_k (x_k/L) [(w_kei L/Q_ci)^(9/2) + (w_kee L/Q_ce)^(9/2)], so that it does not depend on their number. The edge
    factor enters as the mean of f^(9/2) over each slice.

    Symbols:

    - L10r: basic reference rating life [1e6 revolutions of the rings relative to each other]
    - q_jk: load of slice k of roller j, of all positions within a pitch [N]; w: load per length [N/m]
    - q_kei, q_kee; q_kci, q_kce: equivalent loads and ratings of a slice on inner and outer ring [N]
    - Q_ci, Q_ce: ratings of a roller on inner and outer ring [N]
    - C: basic dynamic radial load rating [N]
    - Z, gamma: number of rollers; their diameter times cos a over the pitch diameter [1]
    - a: contact angle of the outer raceway of tapered rollers [rad]
    - x, x_k, L: place from the middle of the roller, width of a slice, effective length of a roller [m]
    - f: factor of edge stress [1], left out with ``edge_stress = false``

    The life is modified slice by slice, with the load of ISO 16281:2025, (31),
    P_k = 0.323 Z cos a Q_ci {[D_ki + 1.038^(9/2) D_ke]/[1 + (1.038 Q_ci/Q_ce)^(9/2)]}^(2/9), where D_k is
    (w_ke L/Q_c)^(9/2).

    Range: as `Iso281`, but with clearance, preload, tilt, profile, flexible rings and form errors, which act by the
    loads. The edge factor approximates the logarithmic profile of ISO/TS 16281 at medium loads and tilts up to 4'.
    Slices do not know of each other, so that the edge stress of straight rollers is larger than this.

    Examples
    --------
    The same load of 3.2 kN on all rollers and along them, without edge stress. With the ratings Q_ci = 23.53 kN and
    Q_ce = 36.75 kN, [(3.2/23.53)^(9/2) + (3.2/36.75)^(9/2)]^(-8/9) = 2612.

    >>> duty = LifeDuty(rollers=14, roller_diameter=0.015, roller_length=0.016, pitch_diameter=0.09, radial_load=1e4,
    ...                 dynamic_rating=1e5, load=np.full((2, 1, 14, 1), 2e5), widths=np.array([0.016]))
    >>> round(Iso16281(edge_stress=False).rate(duty).revolutions / 1e6)
    2612
    """

    name: ClassVar[str] = "iso16281"
    equation: ClassVar[str] = (
        "L10r = [sum_k (q_kei/q_kci)^(9/2) + (q_kee/q_kce)^(9/2)]^(-8/9), q_ke = f (mean_j q_jk^e)^(1/e)"
    )
    references: ClassVar[tuple[Reference, ...]] = (ISO_16281, ISO_281, LUNDBERG_1952)
    basis: ClassVar[str] = "ISO/TS 16281"

    edge_stress: bool = parameter(
        default=True,
        doc="whether the factor of edge stress of the standard acts at the ends of the rollers",
    )

    def rate(self, duty: LifeDuty) -> RatedLife:
        """Return the basic reference rating life."""
        ratings = roller_ratings(duty)
        exponents = [_TURNING_EXPONENT if turns else _DAMAGE_EXPONENT for turns in duty.turning]
        means = [
            np.mean(load**exponent, axis=(0, 1)) ** (1.0 / exponent)
            for load, exponent in zip(duty.load, exponents, strict=True)
        ]
        density = (np.array(means) * duty.roller_length / ratings[:, None]) ** _DAMAGE_EXPONENT
        if self.edge_stress:
            density *= edge_damage(duty.widths)
        damage = density * duty.widths / duty.roller_length
        total = float(damage.sum())
        if not total > 0.0:
            raise DomainError("has no finite life: no roller is loaded")
        life = total ** (-1.0 / WEIBULL_SLOPE)
        rest = _REST_RATIO**_DAMAGE_EXPONENT
        mean = (density[0] + rest * density[1]) / (
            1.0 + rest * (ratings[0] / ratings[1]) ** _DAMAGE_EXPONENT
        )
        return RatedLife(
            revolutions=REVOLUTIONS * life,
            equivalent_load=duty.dynamic_rating * life ** (-1.0 / _LIFE_EXPONENT),
            damage=damage / total,
            slice_load=_MODIFYING_LOAD
            * duty.rollers
            * np.cos(duty.contact_angle)
            * ratings[0]
            * mean ** (1.0 / _DAMAGE_EXPONENT),
        )


def roller_ratings(duty: LifeDuty) -> Array:
    """Return the dynamic ratings of a roller on the inner and the outer ring [N], (2,)."""
    cosine = np.cos(duty.contact_angle)
    gamma = duty.roller_diameter * cosine / duty.pitch_diameter
    ratio = (_REST_RATIO * ((1.0 - gamma) / (1.0 + gamma)) ** RATIO_EXPONENT) ** _DAMAGE_EXPONENT
    sums = (1.0 + np.array([ratio, 1.0 / ratio])) ** (1.0 / _DAMAGE_EXPONENT)
    rollers = REDUCTION * duty.rollers * cosine * np.array(_MEAN_LOADS)
    return np.asarray(duty.dynamic_rating * sums / rollers)


def edge_damage(widths: Array) -> Array:
    """Return the mean of f^(9/2) over each slice of a roller [1], (n,), with the edge factor f of `Iso16281`.

    Parameters
    ----------
    widths : ndarray
        Widths of the slices [m], (n,), from one end of the roller to the other.
    """
    ends = np.concatenate(([0.0], np.cumsum(widths)))
    x = ends / ends[-1] - 0.5
    place, integral = _edge_table()
    return np.asarray(np.diff(np.sign(x) * np.interp(np.abs(x), place, integral)) / np.diff(x))


@cache
def _edge_table() -> tuple[Array, Array]:
    """Return places x/L from the middle of a roller to its end, and the integral of f^(9/2) up to them."""
    # uniform in the logarithm of t = -ln(1.985 x/L), in which f is 1 + 0.01/t
    t = np.geomspace(30.0, -np.log(0.5 * _EDGE_CONSTANT), _EDGE_POINTS)
    place = np.exp(-t) / _EDGE_CONSTANT
    steps = (
        0.5 * np.diff(place) * np.convolve((1.0 + 0.01 / t) ** _DAMAGE_EXPONENT, [1, 1], "valid")
    )
    return place, place[0] + np.concatenate(([0.0], np.cumsum(steps)))
