"""The rings of a scene: how they yield, by their models, and how their raceways are out of round."""

from collections.abc import Callable
from typing import Any, Final

import attrs
import numpy as np
from numpy.typing import NDArray

from rollslip.datasets import FormPart
from rollslip.fields import FieldError, field
from rollslip.files import named_text, read_columns
from rollslip.rings import RingModel, Rings, RingShapes
from rollslip.structure import Location

__all__ = ["reaching", "rings_of"]

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
        text, faults = named_text(part.file), list[str]()
        columns, _ = read_columns(text, part.file, _Row, faults)
        if faults:
            raise FieldError("file", faults[0])
        part = FormPart(angles=tuple(columns["angle"]), heights=tuple(columns["height"]))
    return np.array(part.angles), np.array(part.heights)


def rings_of(scene: Any, make: Callable[[Any, Location], RingModel | None], problems: list[str]) -> Rings | None:
    """Return the rings of a scene; None where both are rigid and round. What is wrong is added to ``problems``.

    ``make`` gives the model of a choice, or adds to ``problems`` too.
    """
    b, o, m, where = scene.bearing, scene.operation, scene.models, Location(scene.origins)
    found, waves, tables = dict[str, RingShapes](), list[tuple[int, float, float]](), list[tuple[Floats, Floats]]()
    for ring, choice, speed in (("inner", m.inner_ring, o.inner_speed), ("outer", m.outer_ring, o.outer_speed)):
        raceway, at = getattr(b, f"{ring}_raceway"), where.at("bearing").at(f"{ring}_raceway").at("form")
        form = () if raceway is None else raceway.form
        if form and speed != 0.0:
            problems.append(
                at.says(
                    f"turns with its ring, at operation.{ring}_speed, and loads that follow a form which turns against "
                    "the load are not modelled; give the form to the ring that stands, or leave it out"
                )
            )
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
            problems.append(at.at(error.field).says(error.reason))
        except ValueError as error:
            problems.append(at.says(str(error)))
    if problems or not (waves or tables or any(one.stiffness.size for one in found.values())):
        return None
    return Rings(found["inner"], found["outer"], tuple(waves), tuple(tables))


def reaching(bearing: Any, lobes: int = 0) -> tuple[float, float]:
    """Return which share of a preload presses rollers of rings that yield: bare ones, and such on what they sit on.

    1/(1 + Phi), Phi = Z k/K of the hoop, Z k/(4 K) of lobes, over both rings, each with the stiffness K of its shape;
    k = 10/9 35948 l^(8/9) d^(1/9) of a roller [N, mm] (ISO/TS 16281) at an approach of d = 10 um, on which it hardly
    depends.
    """
    from rollslip.catalogue.discovery import get_class  # only a preload needs a plugin

    k = 1e3 * 10 / 9 * 35948 * (1e3 * bearing.roller_length) ** (8 / 9) * 0.01 ** (1 / 9)
    bore, outside = bearing.boundaries
    found = []
    for inner, outer in (({"bore": bore}, {"outside": outside}), ({}, {})):
        phi = 0.0
        for ring, given in (("inner", inner), ("outer", outer)):
            shapes = get_class("ring", _YIELDING)(harmonics=lobes, **given).shapes(bearing, ring, False)
            held = float(shapes.stiffness[np.argmax(shapes.harmonics[:, lobes] != 0.0)])
            phi += bearing.rollers * k / (4.0 * held if lobes else held)
        found.append(1.0 / (1.0 + phi))
    return found[0], found[1]
