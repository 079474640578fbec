"""Results: what a dataset must say about its origin, and files that hold it without loss.

- A result is an xarray Dataset; its attributes make it reproducible: the scene verbatim and resolved, its hash, the
  packages and models used, numbers of evaluations, wall time, warnings and citations.
- Attributes that are structures are JSON text, because netCDF has no other form that every reader keeps.
- A file appears whole or not at all (`rollslip.files`). It is made in memory: where a disk is full, HDF5 leaves a
  file that cannot be closed and takes the process down.
"""

import datetime
import importlib.metadata
import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.catalogue.discovery import named_data
from rollslip.catalogue.registry import find
from rollslip.errors import OutputError
from rollslip.files import whole_file
from rollslip.models import SliceModel
from rollslip.references import KLEBANOV
from rollslip.scene.values import resolved, scene_hash

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.planning.plan import Plan

#: Attributes that may differ between two runs of the same scene.
VOLATILE = ("created", "cost", "plan", "wall_time", "integration_time", "real_time_factor")


def about(unit: str, long_name: str) -> dict[str, Any]:
    """Return the attributes that every variable of a result has."""
    return {"units": unit, "long_name": long_name}


def provenance(plan: "Plan", study: str, warnings: list[str], evaluations: int, wall_time: float) -> dict[str, Any]:
    """Return the attributes that say where a result comes from.

    Parameters
    ----------
    plan : Plan
        What was run.
    study : str
        The study whose result it is.
    warnings : list of str
        What a reader of the result has to know.
    evaluations : int
        Slices evaluated.
    wall_time : float
        [s].
    """
    from rollslip.planning.plan import part_as_dict

    scene = plan.scene
    models = [(kind, model, find(kind, model.name)) for kind, model in plan.models]
    assembly = plan.assemblies[study]
    lubricant = assembly.lubricant
    offers = [offer for *_, offer in models]
    used = {offer.package: offer.version for offer in (*offers, *named_data(scene.raw or {}))}
    used |= {name: importlib.metadata.version(name) for name in ("rollslip", "numpy", "scipy", "xarray")}
    return {
        "title": scene.title,
        "description": scene.description,
        "source": scene.source,
        "scene": scene.text,
        "scene_resolved": json.dumps(resolved(scene)),
        "scene_hash": scene_hash(scene),
        "packages": json.dumps(dict(sorted(used.items())) | {"python": sys.version.split()[0]}),
        "models": json.dumps(
            [
                {
                    "kind": kind,
                    "name": model.name,
                    "package": offer.package,
                    "version": offer.version,
                    "equation": model.equation,
                    "references": references_of(model),
                    "parameters": repr(model),
                }
                for kind, model, offer in models
            ]
        ),
        "lubricant": json.dumps(
            {
                "name": lubricant.name,
                "source": lubricant.source,
                "pressure_viscosity_law": repr(lubricant.pressure_viscosity_law),
            }
        ),
        "conditions": json.dumps({r.ring: attrs.asdict(r.conditions) for r in assembly.raceways}),
        "plan": json.dumps([part_as_dict(part) for part in plan.parts if part.study in ("", study)]),
        "warnings": json.dumps(warnings),
        "citations": json.dumps(citations(plan)),
        "evaluations": evaluations,
        "wall_time": wall_time,
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    }


def citations(plan: "Plan") -> list[str]:
    """Return what to cite for the models and the oil of a plan, the paper that rollslip follows first."""
    oil = plan.assembly.lubricant
    used = [text for _, model in plan.models for text in references_of(model)]
    return list(dict.fromkeys([KLEBANOV, *used, *oil.references, *oil.pressure_viscosity_law.references]))


def references_of(model: SliceModel) -> list[str]:
    """Citations of a model and of the models it is composed of."""
    children = [getattr(model, a.name) for a in getattr(model, "__attrs_attrs__", ()) if "kind" in a.metadata]
    return list(dict.fromkeys([*model.references, *(text for child in children for text in references_of(child))]))


def save(dataset: "xr.Dataset", path: Path) -> None:
    """Write a dataset as netCDF-4; the file appears whole or not at all.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    content = dataset.to_netcdf(engine="h5netcdf")
    with whole_file(path) as partial:
        partial.write_bytes(content)


def open_result(path: str | os.PathLike[str]) -> "xr.Dataset":
    """Return a stored result; it is read whole, and the file is closed.

    Raises
    ------
    OutputError
        If the file does not exist or is not a result of rollslip.
    """
    import xarray as xr

    path = Path(path)
    if not path.is_file():
        raise OutputError(f"{path}: there is no such file")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as stored:
            dataset = stored.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise OutputError(f"{path}: is not a netCDF file that can be read ({error})") from error
    if "study" not in dataset.attrs or "scene_hash" not in dataset.attrs:
        raise OutputError(f"{path}: is a netCDF file but not a result of rollslip; it names no study and no scene")
    return dataset
