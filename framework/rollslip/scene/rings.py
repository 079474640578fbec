"""Construct the rings of a scene from their models and the forms of their raceways, and estimate their flexibility.

1. Collect the form errors of both raceways: waves, and tables of heights (`_Forms`).
2. Let the model of each flexible ring compute the shapes in which it deforms, with their stiffness
   (`rollslip.rings.RingShapes`).
3. Drop the shapes of high order, whose effect on friction is below the tolerance of the scene (`_relevant_shapes`).

`ring_flexibility` estimates, without solving for the loads, how much flexible rings would change them.
"""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.fields import FieldError, field
from rollslip.files import named_text, read_columns
from rollslip.geometry.bearing import Bearing
from rollslip.geometry.surfaces import FormPart
from rollslip.rings import RingModel, Rings, RingShapes
from rollslip.search import Array
from rollslip.structure import Location

__all__ = ["RingFlexibility", "ring_flexibility", "rings_of"]


#: Model of a ring by which the effect of flexible rings is estimated where a scene has rigid rings.
_REFERENCE_MODEL: Final = "annulus"
#: Smallest stiffness of a shape in the estimate of its effect [N/m], so that a free shape does not divide by zero.
#: Doubling it changes nothing: real stiffnesses exceed it by many orders of magnitude. Chosen.
_MIN_STIFFNESS: Final = 1e-6
#: Effect of a shape of n waves on loads and friction, over Phi_n: 60/n^4 [1]. Doubling it takes 1.2 times as many
#: shapes into account. An upper bound of what was seen for forms, loads, play and ring thicknesses of the 1032930
#: (tests/plugins/test_rings.py).
_WAVE_DECAY: Final = 60.0


@attrs.frozen(kw_only=True)
class _Row:
    angle: float = field(unit="rad", doc="angle from the line of load")
    height: float = field(unit="m", doc="height of the raceway, towards the rollers")


def _form_table(part: FormPart) -> tuple[Array, Array]:
    """Return angles [rad] and heights [m] of a part of a form that is a table."""
    if part.file is not None:
        text = named_text(part.file)
        faults = list[str]()
        columns, _ = read_columns(text, part.file, _Row, faults)
        if faults:
            raise FieldError("file", faults[0])
        part = FormPart(angles=tuple(columns["angle"]), heights=tuple(columns["height"]))
    return np.array(part.angles), np.array(part.heights)


def rings_of(
    scene: Any, make: Callable[[Any, Location], RingModel | None], problems: list[str]
) -> Rings | None:
    """Return the flexible or out-of-round rings of a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    make : callable
        Returns the model of a choice at a location; None, with a message in ``problems``, where it is wrong.
    problems : list of str
        Faults are added.

    Returns
    -------
    Rings or None
        None where both rings are rigid and round, or something is wrong.
    """
    b = scene.bearing
    m = scene.models
    rings = ("inner", m.inner_ring), ("outer", m.outer_ring)
    forms = _Forms()
    shapes = dict[str, RingShapes]()
    for number, (ring, choice) in enumerate(rings, 1):
        speed = getattr(scene.operation, f"{ring}_speed")
        at = Location(scene.origins).at("models").at(f"{ring}_ring")
        shapes[ring] = RingShapes()
        if not forms.add(scene, ring, speed, number, problems):
            continue
        try:
            model = None if choice is None else make(choice, at)
            if model is not None:
                shapes[ring] = model.shapes(b, ring, speed != 0.0)
        except FieldError as error:
            problems.append(at.at(error.field).message(error.reason))
        except ValueError as error:
            problems.append(at.message(str(error)))
    is_flexible = any(own.stiffness.size for own in shapes.values())
    if problems or not (forms.waves or forms.tables or is_flexible):
        return None
    form_waves = range(b.rollers) if forms.tables else {lobes for lobes, _, _ in forms.waves}
    tolerance = scene.accuracy.tolerance
    inner, inner_error = _relevant_shapes(b, shapes["inner"], form_waves, tolerance)
    outer, outer_error = _relevant_shapes(b, shapes["outer"], form_waves, tolerance)
    return Rings(
        inner,
        outer,
        tuple(forms.waves),
        tuple(forms.tables),
        sum((inner_error, outer_error)),
        (*forms.wave_turns, *forms.table_turns),
    )


@attrs.define
class _Forms:
    """Form errors of both raceways."""

    #: Lobes, amplitude [m] and angle [rad] of each wave.
    waves: list[tuple[int, float, float]] = attrs.field(factory=list)
    #: Angles [rad] and heights [m] of each table.
    tables: list[tuple[Array, Array]] = attrs.field(factory=list)
    #: Periods per turn of the form, 0 where its ring is at rest, and number of the ring, of each wave.
    wave_turns: list[tuple[int, int]] = attrs.field(factory=list)
    #: The same of each table.
    table_turns: list[tuple[int, int]] = attrs.field(factory=list)

    def add(self, scene: Any, ring: str, speed: float, number: int, problems: list[str]) -> bool:
        """Add the form of a ring; return False, with a message in ``problems``, where it is wrong."""
        raceway = getattr(scene.bearing, f"{ring}_raceway")
        form = () if raceway is None else raceway.form
        periods = math.gcd(*(part.lobes or 1 for part in form)) if speed != 0.0 else 0
        for k, part in enumerate(form):
            at = Location(scene.origins).at("bearing").at(f"{ring}_raceway").at("form").at(k)
            try:
                if part.lobes is None:
                    self.table_turns.append((periods, number))
                    self.tables.append(_form_table(part))
                else:
                    self.wave_turns.append((periods, number))
                    self.waves.append((part.lobes, part.amplitude, part.angle))
            except FieldError as error:
                problems.append(at.at(error.field).message(error.reason))
                return False
            except ValueError as error:
                problems.append(at.message(str(error)))
                return False
        return True


@attrs.frozen
class RingFlexibility:
    """Estimated effect of flexible rings on the loads of the rollers."""

    #: Deflection of the rings over that of the rollers under a form of n waves [1], (N + 1,); n = 0 is a preload.
    phi: Array
    #: Ovality w_2 of the rings under the load over the deflection of the rollers [1].
    bending: float

    def fraction(self, lobes: int = 0) -> float:
        """Return the fraction of a preload, or of a form with lobes, which deflects rollers and not rings [1]."""
        return 1.0 / (1.0 + float(self.phi[lobes]))

    @property
    def change(self) -> float:
        """Relative change of the loads in round rings, of their RMS; within a factor of two, of three with play."""
        return 0.7 * self.bending / (1.5 + self.bending)

    def __str__(self) -> str:
        phi = ", ".join(f"{self.phi[n]:.2g}" for n in (0, 2, 3))
        return f"Phi_0, Phi_2, Phi_3 = {phi}, w_2/delta = {self.bending:.2g}"


def _contact(bearing: Bearing) -> tuple[float, float]:
    """Return c of Q = c d^(10/9) [N, mm] of a roller between both raceways (ISO/TS 16281), and its stiffness [N/m].

    The stiffness is that at an approach of 10 um, on which it hardly depends.
    """
    c = 35948 * (1e3 * bearing.roller_length) ** (8 / 9)
    return c, 1e3 * 10 / 9 * c * 0.01 ** (1 / 9)


def _relative_flexibility(bearing: Bearing, shapes: RingShapes) -> tuple[NDArray[np.intp], Array]:
    """Return waves and Phi of each shape: Z k a^2/K of the hoop, Z k a^2/(4 K) of others, a their largest amplitude."""
    size = np.abs(shapes.harmonics)
    waves = size.argmax(axis=1)
    stiffness = np.maximum(shapes.stiffness, _MIN_STIFFNESS)
    k = _contact(bearing)[1]
    return waves, bearing.rollers * k * size.max(axis=1) ** 2 / stiffness / np.where(
        waves == 0, 1.0, 4.0
    )


def _relevant_shapes(
    bearing: Bearing, shapes: RingShapes, form_waves: Collection[int], tolerance: float
) -> tuple[RingShapes, float]:
    """Return the shapes that matter for friction, and an estimate of the relative effect of the others.

    A shape of n waves changes friction by at most Phi_n min(1, 60/n^4), and one with as many waves as a form by Phi_n.
    Shapes with stops, or with forces of gear teeth, are all retained.
    """
    if shapes.stops is not None or shapes.pushes.any() or not shapes.stiffness.size:
        return shapes, 0.0
    waves, phi = _relative_flexibility(bearing, shapes)
    decay = np.minimum(1.0, _WAVE_DECAY / np.maximum(waves, 1) ** 4.0)
    effect = phi * np.where(np.isin(waves, [*form_waves]), 1.0, decay)
    relevant = waves <= waves[effect >= tolerance].max(initial=-1)
    names = ("harmonics", "stiffness", "pushes", "mass")
    columns = {name: own[relevant] for name in names if (own := getattr(shapes, name)) is not None}
    return attrs.evolve(shapes, **columns), float(effect[~relevant].max(initial=0.0))


def ring_flexibility(
    bearing: Bearing,
    load: float = 0.0,
    lobes: int = 3,
    stated: Mapping[str, RingShapes] | None = None,
) -> tuple[RingFlexibility, RingFlexibility]:
    """Return the flexibility of free rings, and that of rings on their shaft and in their housing.

    Phi is the sum of both rings; w_2 = 0.42 F (1/K_2 + 1/K_2'), and delta is the approach of a roller under 4.5 F/Z by
    ISO/TS 16281.

    Parameters
    ----------
    bearing : Bearing
        The bearing.
    load : float
        Radial load F [N].
    lobes : int
        Largest number of waves of a form.
    stated : mapping of str to RingShapes, optional
        Shapes of a ring, "inner" or "outer", that the scene has a model of; they count in both results.
    """
    from rollslip.catalogue.discovery import get_class  # no other scene needs a plugin for it

    c, k = _contact(bearing)
    delta = 1e-3 * (4.5 * load / bearing.rollers / c) ** 0.9
    bore, outside = bearing.boundaries
    results = []
    for inner, outer in (({"bore": bore}, {"outside": outside}), ({}, {})):
        phi = np.zeros(max(lobes, 3) + 1)
        for ring, free_diameter in (("inner", inner), ("outer", outer)):
            shapes = (stated or {}).get(ring)
            if shapes is None or not shapes.stiffness.size:
                annulus = get_class("ring", _REFERENCE_MODEL)(
                    harmonics=phi.size - 1, **free_diameter
                )
                shapes = annulus.shapes(bearing, ring, False)
            waves, flexibility = _relative_flexibility(bearing, shapes)
            for n in range(phi.size):
                phi[n] += flexibility[waves == n].max(initial=0.0)
        oval = 0.42 * load * 4.0 * float(phi[2]) / (bearing.rollers * k)
        results.append(RingFlexibility(phi, oval / delta if load > 0.0 else 0.0))
    return results[0], results[1]
