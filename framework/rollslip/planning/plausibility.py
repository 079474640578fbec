"""What is unusual in a scene, of all that it holds: its own tables, the oil, the cage, models and studies."""

import contextlib
from collections.abc import Iterator, Mapping
from typing import Any

from rollslip.bearing.cage import Cage
from rollslip.errors import RollslipError
from rollslip.lubricant.table import OilTable
from rollslip.scene.plausibility import unusual_model, unusual_relations, unusual_values
from rollslip.scene.values import Scene, resolved
from rollslip.structure import Location
from rollslip.studies.study import study_class

__all__ = ["implausible"]


def implausible(scene: Scene) -> list[str]:
    """Return what is unusual in a scene, with place, value and what was likely meant; most scenes have nothing."""
    raw: Mapping[str, Any] = scene.raw if scene.raw is not None else resolved(scene)
    where = Location(scene.origins)
    found = [*unusual_values(Scene, raw, where)]
    found += unusual_values(OilTable, raw.get("lubricant"), where.at("lubricant"))
    found += unusual_values(Cage, raw.get("cage"), where.at("cage"))
    found += _models(raw, where)
    studies = raw.get("study")
    for name, table in studies.items() if isinstance(studies, Mapping) else ():
        with contextlib.suppress(RollslipError):  # who runs it says so
            found += unusual_values(study_class(name, scene), table, where.at("study").at(name))
    return [*dict.fromkeys((*found, *unusual_relations(scene, raw, where)))]


def _models(raw: Mapping[str, Any], where: Location) -> Iterator[str]:
    models, cage = raw.get("models"), raw.get("cage")
    for kind, model in models.items() if isinstance(models, Mapping) else ():
        yield from unusual_model(kind, model, where.at("models").at(kind))
    drags = cage.get("drag", ()) if isinstance(cage, Mapping) else ()
    for k, drag in enumerate(drags if isinstance(drags, list | tuple) else ()):
        yield from unusual_model("drag", drag, where.at("cage").at("drag").at(k))
