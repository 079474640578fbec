"""The rings of a scene: how they yield, by their models, and how their raceways are out of round."""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.datasets import Bearing, FormPart
from rollslip.fields import FieldError, field
from rollslip.files import named_text, read_columns
from rollslip.rings import RingModel, Rings, RingShapes
from rollslip.structure import Location

__all__ = ["Yielding", "rings_of", "yielding"]

Floats = NDArray[np.float64]

#: Model by which it is told what rigid rings leave out.
_YIELDING: Final = "annulus"


@attrs.frozen(kw_only=True)
class _Row:
    angle: float = field(unit="rad", doc="angle from the line of load")
    height: float = field(unit="m", doc="height of the raceway, towards the rollers")


def _table(part: FormPart) -> tuple[Floats, Floats]:
    """Return angles and heights of a part of a form that is no wave."""
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
    """Return the rings of a scene; None where both are rigid and round. What is wrong is added to ``problems``.

    ``make`` gives the model of a choice, or adds to ``problems`` too.
    """
    b = scene.bearing
    o = scene.operation
    m = scene.models
    where = Location(scene.origins)
    raceways = [raceway for raceway in (b.inner_raceway, b.outer_raceway) if raceway is not None]
    if (
        m.inner_ring is None
        and m.outer_ring is None
        and not any(raceway.form for raceway in raceways)
    ):
        return None
    found = dict[str, RingShapes]()
    waves = list[tuple[int, float, float]]()
    tables = list[tuple[Floats, Floats]]()
    turns: tuple[list[tuple[int, int]], list[tuple[int, int]]] = [], []
    rings = ("inner", m.inner_ring, o.inner_speed), ("outer", m.outer_ring, o.outer_speed)
    for number, (ring, choice, speed) in enumerate(rings, 1):
        raceway = getattr(b, f"{ring}_raceway")
        at = where.at("bearing").at(f"{ring}_raceway").at("form")
        form = () if raceway is None else raceway.form
        periods = math.gcd(*(part.lobes or 1 for part in form)) if speed != 0.0 else 0
        for part in form:
            turns[part.lobes is None].append((periods, number))
        found[ring] = RingShapes()
        try:
            for k, part in enumerate(form):
                at = where.at("bearing").at(f"{ring}_raceway").at("form").at(k)
                if part.lobes is None:
                    tables.append(_table(part))
                else:
                    waves.append((part.lobes, part.amplitude, part.angle))
            at = where.at("models").at(f"{ring}_ring")
            model = None if choice is None else make(choice, at)
            if model is not None:
                found[ring] = model.shapes(b, ring, speed != 0.0)
        except FieldError as error:
            problems.append(at.at(error.field).message(error.reason))
        except ValueError as error:
            problems.append(at.message(str(error)))
    if problems or not (waves or tables or any(one.stiffness.size for one in found.values())):
        return None
    formed = range(b.rollers) if tables else {lobes for lobes, _, _ in waves}
    kept = {ring: _enough(b, one, formed, scene.accuracy.tolerance) for ring, one in found.items()}
    inner = kept["inner"][0]
    outer = kept["outer"][0]
    left = sum(error for _, error in kept.values())
    return Rings(inner, outer, tuple(waves), tuple(tables), left, (*turns[0], *turns[1]))


@attrs.frozen
class Yielding:
    """What rings do to the loads of rollers where they yield, estimated."""

    phi: Floats  #: Approach that rings take of a form of n waves, 0 a preload, over that which rollers take, (N + 1,).
    bending: float  #: w_2/delta: by how much rings become oval under the load, over the approach of the rollers.

    def fraction(self, lobes: int = 0) -> float:
        """Return which share of a preload, or of one by lobes, presses rollers."""
        return 1.0 / (1.0 + float(self.phi[lobes]))

    @property
    def change(self) -> float:
        """Change of the loads in round rings, of their root mean square; within a factor of two, three with play."""
        return 0.7 * self.bending / (1.5 + self.bending)

    def __str__(self) -> str:
        phi = ", ".join(f"{self.phi[n]:.2g}" for n in (0, 2, 3))
        return f"Phi_0, Phi_2, Phi_3 = {phi}, w_2/delta = {self.bending:.2g}"


def _contact(bearing: Bearing) -> tuple[float, float]:
    """Return c of Q = c d^(10/9) [N, mm] of a roller between both raceways (ISO/TS 16281), and its stiffness [N/m].

    That at an approach of 10 um, on which it hardly depends.
    """
    c = 35948 * (1e3 * bearing.roller_length) ** (8 / 9)
    return c, 1e3 * 10 / 9 * c * 0.01 ** (1 / 9)


def _softness(bearing: Bearing, shapes: RingShapes) -> tuple[NDArray[np.intp], Floats]:
    """Return waves and Phi of each shape: Z k a^2/K of the hoop, Z k a^2/(4 K) of others, a their largest amplitude."""
    size = np.abs(shapes.harmonics)
    waves = size.argmax(axis=1)
    held = np.maximum(shapes.stiffness, 1e-6)
    k = _contact(bearing)[1]
    return waves, bearing.rollers * k * size.max(axis=1) ** 2 / held / np.where(
        waves == 0, 1.0, 4.0
    )


def _enough(
    bearing: Bearing, shapes: RingShapes, formed: Collection[int], tolerance: float
) -> tuple[RingShapes, float]:
    """Return the shapes that friction needs, and by how much the others would change it.

    A shape of n waves changes it by at most Phi_n min(1, 60/n^4), seen at forms, loads, play and thicknesses of the
    1032930 (tests/plugins/test_rings.py); one of as many waves as a form by Phi_n. What teeth push, or stops, stays.
    """
    if shapes.stops is not None or shapes.pushes.any() or not shapes.stiffness.size:
        return shapes, 0.0
    waves, phi = _softness(bearing, shapes)
    effect = phi * np.where(
        np.isin(waves, [*formed]), 1.0, np.minimum(1.0, 60.0 / np.maximum(waves, 1) ** 4.0)
    )
    kept = waves <= waves[effect >= tolerance].max(initial=-1)
    columns = ("harmonics", "stiffness", "pushes", "mass")
    some = {name: own[kept] for name in columns if (own := getattr(shapes, name)) is not None}
    return attrs.evolve(shapes, **some), float(effect[~kept].max(initial=0.0))


def yielding(
    bearing: Bearing,
    load: float = 0.0,
    lobes: int = 3,
    stated: Mapping[str, RingShapes] | None = None,
) -> tuple[Yielding, Yielding]:
    """Return what bare rings do to loads of rollers, and such on what they sit on; ``stated`` ones are as they are.

    Phi is of both rings; w_2 = 0.42 F (1/K_2 + 1/K_2'), and delta the approach of a roller under 4.5 F/Z by
    ISO/TS 16281.
    """
    from rollslip.catalogue.discovery import get_class  # no other scene needs a plugin for it

    c, k = _contact(bearing)
    delta = 1e-3 * (4.5 * load / bearing.rollers / c) ** 0.9
    bore, outside = bearing.boundaries
    found = []
    for inner, outer in (({"bore": bore}, {"outside": outside}), ({}, {})):
        phi = np.zeros(max(lobes, 3) + 1)
        for ring, given in (("inner", inner), ("outer", outer)):
            shapes = (stated or {}).get(ring)
            if shapes is None or not shapes.stiffness.size:
                shapes = get_class("ring", _YIELDING)(harmonics=phi.size - 1, **given).shapes(
                    bearing, ring, False
                )
            waves, soft = _softness(bearing, shapes)
            for n in range(phi.size):
                phi[n] += soft[waves == n].max(initial=0.0)
        oval = 0.42 * load * 4.0 * float(phi[2]) / (bearing.rollers * k)
        found.append(Yielding(phi, oval / delta if load > 0.0 else 0.0))
    return found[0], found[1]
