"""Interface of models of kind ``life``: the rating life of a bearing by fatigue of its raceways.

- A model takes the bearing, its dynamic rating and the loads of the slices of its rollers, and no slip. It returns the
  life that nine of ten bearings reach, and where along the rollers the damage arises, if it knows that.
- The modification of a life by lubrication and contamination (ISO 281) is the same for all models (`modified_factor`).
- A scene names models under ``models.life``.

References: ISO 281:2007; ISO/TS 16281:2008 and ISO 16281:2025. The standards themselves were not at hand. Formulas and
constants agree in two independent open programs, or follow from the theory of Lundberg and Palmgren by a quadrature
(``tools/references/rating_life.py``).
"""

import abc
import math
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_models
from rollslip.errors import DomainError
from rollslip.geometry.bearing import Bearing
from rollslip.references import CitedModel
from rollslip.scene.values import Scene
from rollslip.search import Array
from rollslip.structure import Location
from rollslip.studies.rating_life.equivalent_load import equivalent_load

__all__ = [
    "LIFE",
    "REVOLUTIONS",
    "LifeDuty",
    "LifeModel",
    "RatedLife",
    "dynamic_rating",
    "fatigue_load_limit",
    "life_models",
    "modification_factor",
    "modified_factor",
]

#: Revolutions of the unit in which the formulas of the standards have lives.
REVOLUTIONS: Final = 1e6
#: Weibull slope of the fatigue of line contacts: lives of slices add up by it (ISO 281).
WEIBULL_SLOPE: Final = 9.0 / 8.0
#: Rating factor b_m of cylindrical and of tapered roller bearings (ISO 281): the rating is proportional to it. Ratings
#: that a maker prints for reinforced types are 5 to 9 % larger in the mean of a series; for 27 tapered bearings they
#: are 6 % smaller in the mean.
_RATING_FACTOR: Final = 1.1
#: Source of a rating by this factor.
_COMPUTED: Final = "ISO 281; makers print 5 to 9 % more for reinforced types"
#: Reduction for edge stress and uneven loads lambda nu of radial roller bearings (ISO 281).
REDUCTION: Final = 0.83
#: Exponent of (1 - gamma)/(1 + gamma) in the ratio of the ratings of both raceways (Lundberg and Palmgren).
RATIO_EXPONENT: Final = 143.0 / 108.0
#: Ratio of the static rating to the fatigue load limit of a roller bearing (ISO 281, annex B).
_STATIC_OVER_FATIGUE: Final = 8.2
#: Pitch diameter [m] above which the fatigue load limit decreases with size (ISO 281, annex B).
_LARGE_PITCH: Final = 0.1
#: Viscosity ratio below which the standard has no modification factor (ISO 281).
_MIN_KAPPA: Final = 0.1
#: Viscosity ratio above which a thicker film does not lengthen a life (ISO 281).
_MAX_KAPPA: Final = 4.0
#: Largest modification factor (ISO 281).
_MAX_FACTOR: Final = 50.0
#: Viscosity ratio below which they hold -> factor and exponent of it in the modification factor (ISO 281).
_KAPPA_BANDS: Final = (
    (0.4, 1.3993, 0.054381),
    (1.0, 1.2348, 0.19087),
    (math.inf, 1.2348, 0.071739),
)


def dynamic_rating(bearing: Bearing) -> tuple[float, str]:
    """Return the basic dynamic radial load rating C of one row of rollers [N], and its source.

    It is that of the catalogue, or after ISO 281, with lengths in mm and N,
    C = 1.1 f_c (L cos a)^(7/9) Z^(3/4) D^(29/27), gamma = D cos a/d_pw,
    f_c = 207.9 0.83 gamma^(2/9) (1 - gamma)^(29/27) (1 + gamma)^(-1/4)
    {1 + [1.04 ((1 - gamma)/(1 + gamma))^(143/108)]^(9/2)}^(-2/9), with the contact angle a of the outer raceway of
    tapered rollers.
    """
    if bearing.catalogue is not None and bearing.catalogue.dynamic_rating is not None:
        return bearing.catalogue.dynamic_rating, "the catalogue"
    cosine = math.cos(bearing.angles.outer)
    gamma = bearing.roller_diameter * cosine / bearing.pitch_diameter
    ratio = 1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** RATIO_EXPONENT
    geometry = gamma ** (2.0 / 9.0) * (1.0 - gamma) ** (29.0 / 27.0) * (1.0 + gamma) ** -0.25
    factor = 207.9 * REDUCTION * geometry * (1.0 + ratio**4.5) ** (-2.0 / 9.0)
    length = (1e3 * bearing.roller_length * cosine) ** (7.0 / 9.0)
    diameter = (1e3 * bearing.roller_diameter) ** (29.0 / 27.0)
    size = length * float(bearing.rollers) ** 0.75 * diameter
    return _RATING_FACTOR * factor * size, _COMPUTED


def fatigue_load_limit(bearing: Bearing) -> float:
    """Return the fatigue load limit C_u [N]: C0/8.2, times (100 mm/d_pw)^0.3 for pitch diameters above 100 mm."""
    size = max(bearing.pitch_diameter / _LARGE_PITCH, 1.0)
    return float(bearing.static_rating / _STATIC_OVER_FATIGUE * size**-0.3)


def modification_factor(viscosity_ratio: float, load_ratio: Any) -> Any:
    """Return the life modification factor a_ISO of radial roller bearings [1], of the shape of the load ratio.

    a_ISO = 0.1 [1 - (1.5859 - b/kappa^c) (e_C C_u/P)^0.4]^-9.185, at most 50 (ISO 281).

    Parameters
    ----------
    viscosity_ratio : float
        Viscosity ratio kappa [1]; above 4 the factor is that at 4.
    load_ratio : float or ndarray
        e_C C_u/P, the contamination factor times the fatigue load limit over the load [1].

    Raises
    ------
    DomainError
        If kappa is below 0.1, where the standard has no factor.
    """
    if not viscosity_ratio >= _MIN_KAPPA:
        raise DomainError(
            f"has no modification factor: the viscosity ratio kappa of {viscosity_ratio:.2g} is below {_MIN_KAPPA}"
        )
    kappa = min(viscosity_ratio, _MAX_KAPPA)
    _, factor, exponent = next(band for band in _KAPPA_BANDS if kappa < band[0])
    inside = 1.0 - (1.5859 - factor / kappa**exponent) * np.asarray(load_ratio) ** 0.4
    # a positive bound in place of 0, at which the factor is above its maximum
    return np.minimum(0.1 * np.maximum(inside, 0.1) ** -9.185, _MAX_FACTOR)


@attrs.frozen(eq=False, kw_only=True)
class LifeDuty:
    """What a rating life follows from: a bearing with its rating, and the loads of the slices of its rollers."""

    rollers: int  #: Number of rollers Z.
    roller_diameter: float  #: D [m].
    roller_length: float  #: Effective length L [m].
    pitch_diameter: float  #: d_pw [m].
    radial_load: float  #: F_r [N].
    dynamic_rating: float  #: C [N].
    #: Loads per length of the contacts with the inner and the outer ring [N/m], (2, positions, Z, n).
    load: Array
    widths: Array  #: Widths of the slices [m], (n,), in their order along the roller.
    #: Whether the inner and the outer ring turn relative to the load.
    turning: tuple[bool, bool] = (True, False)
    contact_angle: float = 0.0  #: Contact angle of the outer raceway of tapered rollers [rad].
    axial_load: float = 0.0  #: F_a [N], which adds to the equivalent load of tapered rollers alone.

    @property
    def equivalent_load(self) -> float:
        """Dynamic equivalent load P of ISO 281 [N]."""
        return equivalent_load(self.contact_angle, self.radial_load, self.axial_load)

    @classmethod
    def of(cls, assembly: Assembly) -> "LifeDuty":
        """Return the duty of an assembled bearing at its resolution."""
        bearing = assembly.scene.bearing
        operation = assembly.scene.operation
        loads = assembly.load_distribution(assembly.resolution.n_positions or 1)
        return cls(
            rollers=bearing.rollers,
            roller_diameter=bearing.roller_diameter,
            roller_length=bearing.roller_length,
            pitch_diameter=bearing.pitch_diameter,
            radial_load=operation.radial_load,
            dynamic_rating=dynamic_rating(bearing)[0],
            load=np.stack((loads.inner_load, loads.outer_load)),
            widths=assembly.widths,
            turning=(operation.inner_speed != 0.0, operation.outer_speed != 0.0),
            contact_angle=bearing.contact_angle or 0.0,
            axial_load=operation.axial_load or 0.0,
        )


@attrs.frozen(eq=False, kw_only=True)
class RatedLife:
    """The life that a model finds, and where the damage arises."""

    revolutions: (
        float  #: Revolutions of the rings relative to each other that nine of ten bearings reach.
    )
    equivalent_load: float  #: Dynamic equivalent load P [N], which gives this life by ISO 281.
    #: Fraction of the damage in each slice of the inner and the outer ring [1], (2, n), with the sum 1; None where the
    #: model does not know it.
    damage: Array | None = None
    #: Load of the bearing [N] by which each slice is modified, (n,); None for the equivalent load.
    slice_load: Array | None = None


class LifeModel(CitedModel):
    """Rating life of a bearing by one standard or theory; its parameters are its attrs fields."""

    #: The standard or theory in a few words, for texts: "ISO 281".
    basis: ClassVar[str]

    @abc.abstractmethod
    def rate(self, duty: LifeDuty) -> RatedLife:
        """Return the life of a bearing.

        Raises
        ------
        DomainError
            If nothing is loaded, so that there is no finite life.
        """


def modified_factor(life: RatedLife, viscosity_ratio: float, fatigue_load: float) -> float:
    """Return the modification factor of a life as a whole, modified life over life [1].

    With fractions s_k of the damage and the modification factor a_k of each slice it is
    [sum_k s_k a_k^(-9/8)]^(-8/9) (ISO 16281).

    Parameters
    ----------
    life : RatedLife
        The life to modify.
    viscosity_ratio : float
        Viscosity ratio kappa [1].
    fatigue_load : float
        e_C C_u, the fatigue load limit times the contamination factor [N].
    """
    if life.damage is None or life.slice_load is None:
        return float(modification_factor(viscosity_ratio, fatigue_load / life.equivalent_load))
    # an unloaded slice has no damage, whatever its factor is
    load = np.maximum(life.slice_load, 1e-9 * life.equivalent_load)
    weakened = modification_factor(viscosity_ratio, fatigue_load / load) ** -WEIBULL_SLOPE
    return float((life.damage.sum(axis=0) @ weakened) ** (-1.0 / WEIBULL_SLOPE))


def life_models(scene: Scene) -> tuple[LifeModel, ...]:
    """Return the models that a scene names under ``models.life``, in its order."""
    return structure_models(
        "life",
        [(choice.name, choice.parameters) for choice in scene.models.life],
        Location(scene.origins, ("models", "life")),
    )


LIFE: Final = Kind(
    name="life",
    hook="life_models",
    base=LifeModel,
)
