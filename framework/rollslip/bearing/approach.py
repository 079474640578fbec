"""Load of a contact over the approach of its bodies, with the oil film between them.

Two bodies that approach each other by a (negative: a gap) yield by delta and have a smallest gap h_0 between them::

    a = delta(w) - h_0(w),   h_0 = h/(1 + c^2 r),   r = (1 + delta/min(h_ff, layer))^-2

The deflection delta rises with the load per length w, and the gap does not, so that each approach has one load. So a
contact carries load before the bodies would touch, and a roller that hardly anything presses is carried along more of
its length than a dry one.

1. Take the film h_ff of a fully flooded inlet where dp/dx = 0, which is what flows through the contact.
2. Limit it by the layer of oil on the surfaces: h, as the film model does (`limited_by_layer`).
3. Between rigid bodies the gap is smaller than that by 1 + c^2, with the end x = c sqrt(2 R h_0) of the film. Without
   flow to the sides c depends on h_ff/layer alone (`squared_exit`): the less oil there is, the less pressure it
   builds up, and w ~ (layer - h_0)^2 where a contact begins to carry. Elastic bodies are parallel, r = 0: chosen, it
   meets numerical solutions for Moes's M up to 0.3 to 4 %, for M from 1 on and L = 10 to 9 %, and is up to 31 % low for
   M from 3 to 10 and L = 0. A model that gives the smallest film is taken back to h_ff by the same relation; a central
   film counts as h_ff.

The law is a table over the load. Its approach is measured from the gap at which the contact begins to carry, which is
the gap without load: the layer of oil on the surfaces, or `_THICKEST_LAYER` where there is oil in plenty. The
equilibrium then needs no change but a clearance that is smaller by these gaps (`Raceway.gap`). The film is that of a
bearing that rolls without slip.
"""

import math
from types import MappingProxyType
from typing import ClassVar

import attrs
import numpy as np

from rollslip.bearing.chain import Chain
from rollslip.errors import DomainError
from rollslip.models import FINITE, ContactModel, FilmModel, SliceModel
from rollslip.references import Reference
from rollslip.search import Array
from rollslip_kernels.slices import Conditions, Slices
from rollslip_kernels.stages import contact as compiled

#: Deflections of the bodies at the ends of the table [m]: 1e-6 N/m and 1e8 N/m of steel on steel. Below the smallest
#: one the load is proportional to the approach, above the largest one it rises along the tangent. Chosen: no film and
#: no bearing has loads beyond them.
_DEFLECTIONS = (1e-16, 2e-3)
#: Thickest layer of oil that counts [m]. Chosen: ten times the thickest films of unloaded rollers, 0.1 mm in
#: large and slow bearings full of oil.
_THICKEST_LAYER = 1e-3


@attrs.frozen(eq=False)
class FilmDeflection(SliceModel):
    """Load and stiffness of a contact with a film, from the approach beyond the gap at which it begins to carry."""

    name: ClassVar[str] = "film-deflection"
    equation: ClassVar[str] = "a = delta(w) - h_0(w)"
    references: ClassVar[tuple[Reference, ...]] = ()
    writes = frozenset({"load", "stiffness"})
    domain = MappingProxyType({"approach": FINITE})

    #: The approach, and the conditions that the table was made for.
    reads: frozenset[str]
    #: Approaches of the table [m], rising.
    approach: Array
    #: Logarithm of the load per length [N/m] at them.
    log_load: Array
    #: Its derivative with respect to the approach [1/m].
    slope: Array

    def evaluate(self, slices: Slices) -> None:
        """Fill load and stiffness from the approach."""
        knots = self.approach
        a = slices.approach
        low = np.clip(np.searchsorted(knots, a, "right") - 1, 0, knots.size - 2)
        width = knots[low + 1] - knots[low]
        x = np.clip((a - knots[low]) / width, 0.0, 1.0)
        rise = self.log_load[low + 1] - self.log_load[low]
        left = width * self.slope[low]
        right = width * self.slope[low + 1]
        second = 3.0 * rise - 2.0 * left - right
        third = left + right - 2.0 * rise
        load = np.exp(self.log_load[low] + x * (left + x * (second + x * third)))
        stiffness = load * (left + x * (2.0 * second + x * 3.0 * third)) / width
        first_stiffness = np.exp(self.log_load[0]) / knots[0]
        last_stiffness = np.exp(self.log_load[-1]) * self.slope[-1]
        ranges = [a <= 0.0, a <= knots[0], a < knots[-1]]
        beyond = load + last_stiffness * (a - knots[-1])
        slices.load[...] = np.select(ranges, [0.0, first_stiffness * a, load], beyond)
        slices.stiffness[...] = np.select(ranges, [0.0, first_stiffness, stiffness], last_stiffness)

    def kernel(self) -> object:
        """Return the compiled form."""
        return compiled.tabulated_deflection(self.approach, self.log_load, self.slope)


def limited_by_layer(flooded: Array, layer: float, exponent: float) -> Array:
    """Return the films (h^-g + layer^-g)^(-1/g) of contacts that a layer of oil starves.

    Parameters
    ----------
    flooded : ndarray
        Films h of a fully flooded inlet [m].
    layer : float
        Oil on both surfaces together before a contact [m].
    exponent : float
        The exponent g: the larger, the less oil flows to the sides.
    """
    powers = np.logaddexp(-exponent * np.log(flooded), -exponent * math.log(layer))
    return np.asarray(np.exp(-powers / exponent))


def squared_exit(starvation: Array) -> Array:
    """Return c^2 of rigid lines, whose film ends at x = c sqrt(2 R h_0), 1.4 % off at most.

    The flow h_ff that the contact takes with a flooded inlet, over the layer of oil, is the ``starvation``; below 1
    the contact is flooded. Both limits are exact: 1/c^2 is 4.43 at 1, and 3 sqrt(starvation) + 4/5 far beyond.
    """
    starved = np.maximum(starvation, 1.0)
    return np.asarray(1.0 / (3.0 * np.sqrt(starved) + 0.8 + 0.63 / starved))


def _smallest_gap(slices: Slices, film: FilmModel, layer: float) -> Array:
    """Return the smallest gap of slices that find a layer of oil, from the film of a flooded inlet."""
    h = slices.film_thickness
    rigid = (1.0 + slices.approach / np.minimum(h, layer)) ** -2.0
    if film.location == "minimum":
        h = h * (1.0 + squared_exit(np.ones(())) * rigid)
    narrowing = 1.0 + rigid * squared_exit(h / layer)
    return limited_by_layer(h, layer, film.layer_exponent) / narrowing


def film_deflection(
    contact: ContactModel,
    film: FilmModel,
    conditions: Conditions,
    speed: float,
    oil_layer: float,
    *,
    is_compiled: bool = True,
) -> tuple[FilmDeflection, float]:
    """Return the law of deflection of a contact with a film, and the gap at which it begins to carry [m].

    Parameters
    ----------
    contact : ContactModel
        Law of the bodies.
    film : FilmModel
        Law of the film, which must not rise with the load.
    conditions : Conditions
        Geometry, steel and oil of the contacts.
    speed : float
        Mean speed of the two surfaces [m/s], that of a bearing that rolls without slip.
    oil_layer : float
        Oil on both surfaces together before a contact [m]: no gap is wider. A thinner layer of the film model counts.
    is_compiled : bool
        Whether laws are evaluated compiled.

    Raises
    ------
    DomainError
        If the film rises with the load faster than the bodies yield.
    """
    deflections = np.geomspace(*_DEFLECTIONS, compiled.KNOTS)
    slices = Slices(compiled.KNOTS, conditions, approach=deflections, rolling_speed=speed)
    Chain(contact.deflection(), compiled=is_compiled)(slices)
    Chain(contact, film.flooded, compiled=is_compiled)(slices)
    layer = float(np.fmin.reduce([oil_layer, film.oil_layer, _THICKEST_LAYER]))
    h = _smallest_gap(slices, film, layer)
    log_load = np.log(slices.load)
    fall = np.gradient(h, log_load)
    approach = slices.approach - h + h[0]
    yielding = slices.load / slices.stiffness
    if not np.all(np.diff(approach) > 0.0):
        raise DomainError(
            f"film {film.name!r} gets thicker with the load faster than the contact yields, so that rollers have no "
            "equilibrium with it; choose models.approach = 'dry'"
        )
    slope = 1.0 / (yielding - np.minimum(fall, 0.0))
    laws = contact.deflection().reads | contact.reads | film.reads
    reads = {"approach", *laws.intersection(attrs.fields_dict(Conditions))}
    return FilmDeflection(frozenset(reads), approach, log_load, slope), float(h[0])
