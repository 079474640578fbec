"""Provenance of results: the attributes of every dataset by which a run can be reproduced.

They are the scene verbatim and resolved, its hash, the packages and models used, numbers of evaluations, wall time,
warnings and citations. Structures are JSON text, because netCDF has no other form that every reader preserves.
"""

import datetime
import importlib.metadata
import json
import math
import sys
from collections.abc import Collection, Iterable, Mapping
from functools import cache, reduce
from numbers import Number
from operator import getitem
from typing import Any

import attrs

from rollslip.bearing.assembly import Assembly
from rollslip.catalogue.discovery import load, named_data
from rollslip.catalogue.registry import Offer, find, get_class, packages_behind
from rollslip.datasets import SURFACES
from rollslip.fields import submodels
from rollslip.lubricant.oil import Lubricant
from rollslip.models import SliceModel
from rollslip.planning.lines import describe_own_cage
from rollslip.planning.plan import Plan
from rollslip.references import KLEBANOV, Citation, as_dict, rollslip_itself, unique_works
from rollslip.results.dataset import CITED
from rollslip.scene.changes import CHANGES, NOTED, assumed_keys
from rollslip.scene.named import surface_name
from rollslip.scene.values import ModelChoice, Scene, model_kind
from rollslip.structure import resolved, scene_hash
from rollslip.toml import as_list

__all__ = [
    "citations",
    "collect_citations",
    "combine_origins",
    "data_references",
    "describe_citations",
    "describe_lubricant",
    "describe_models",
    "describe_scene",
    "models_origin",
    "offers_of",
    "origin",
    "packages_of",
    "references_of",
    "run_origin",
]


def origin(**facts: Any) -> dict[str, Any]:
    """Return facts as attributes of a dataset, with the time of its creation and the package of its campaign."""
    if "packages" in facts:
        facts["packages"] = packages_behind(str(facts.get("study", ""))) | facts["packages"]
    return as_attributes(**facts) | {
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
    }


def as_attributes(**facts: Any) -> dict[str, Any]:
    """Return facts as attributes of a dataset; structures become JSON text."""
    return {
        name: fact if isinstance(fact, str | Number) else json.dumps(fact, default=dict)
        for name, fact in facts.items()
    }


def run_origin(plan: Plan, evaluations: int, wall_time: float) -> dict[str, Any]:
    """Return the attributes by which a result can be computed again: its scene, the packages, and the effort.

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    evaluations : int
        Number of evaluated slices.
    wall_time : float
        Time of the run [s].
    """
    scene = plan.scene
    return origin(
        **describe_scene(scene),
        description=scene.description,
        **({"note": scene.note} if scene.note else {}),
        packages=packages_of(()),
        evaluations=evaluations,
        wall_time=wall_time,
    )


def models_origin(plan: Plan, study: str) -> dict[str, Any]:
    """Return the attributes that describe the models and data of a result, and what to cite for them.

    Parameters
    ----------
    plan : Plan
        The plan by which the result was computed.
    study : str
        Name of the study.
    """
    scene = plan.scene
    assembly = plan.assemblies[study]
    raw: Mapping[str, Any] = scene.raw or {}
    own = describe_own_cage(scene, plan.studies)
    return as_attributes(
        packages=packages_of(offers_of(scene, study, plan.models)),
        models=describe_models(plan.models),
        lubricant=describe_lubricant(assembly.lubricant),
        **(
            {"bound_below": 1}
            if "cage" in assembly.cage_cache and assembly.cage.drags.bound_below
            else {}
        ),
        **({"own_cage": own} if own else {}),
        data=[describe_data(offer) for offer in named_data(raw) if offer.kind != "lubricant"]
        + describe_surfaces(raw),
        film_limits=describe_film_limits(assembly),
        conditions={
            raceway.ring: attrs.asdict(raceway.conditions) for raceway in assembly.raceways
        },
        **describe_citations(citations(plan)),
    )


def combine_origins(origins: Collection[Mapping[str, Any]], *lists: str) -> dict[str, Any]:
    """Return the packages of several results, and the items of their models, citations and other lists, each once.

    Parameters
    ----------
    origins : collection of mappings
        Attributes of the results.
    *lists : str
        Names of further attributes that are lists in JSON.
    """
    combined = dict[str, Any](packages={})
    for attributes in origins:
        combined["packages"] |= json.loads(attributes["packages"])
    for key in ("models", *lists, *CITED):
        items = {
            json.dumps(item): item for attributes in origins for item in json.loads(attributes[key])
        }
        combined[key] = list(items.values())
    return combined


# Descriptions of scene, models and data ------------------------------------------------------------------------------


def describe_scene(scene: Scene, given: Scene | None = None) -> dict[str, Any]:
    """Return title, text and hash of a scene.

    Parameters
    ----------
    scene : Scene
        The scene that was run.
    given : Scene, optional
        The scene as it was written, where a campaign changes it.
    """
    given = given or scene
    mounted = scene.bearing.mounted
    return {
        "title": _title(given),
        "source": given.source,
        "scene": given.text,
        # most scenes have no comment of this word, which `assumed_keys` looks for
        "assumed": json.dumps(assumed_keys(given) if "ASSUMED" in given.text else []),
        "scene_resolved": resolved(scene),
        "scene_hash": scene_hash(scene),
        **({"changed": 1} if CHANGES in given.origins.values() else {}),
        **(
            {} if mounted is None else {"clearance": {"text": str(mounted), "terms": mounted.terms}}
        ),
    }


def _title(scene: Scene) -> str:
    """Return the title of a scene, with the values that were changed since it was written."""
    paths = [
        path
        for path, place in scene.origins.items()
        if place == CHANGES and path and path[0] in NOTED
    ]
    last = [
        path for path in paths if not any(path == other[: len(path)] != other for other in paths)
    ]
    if not (scene.title and last) or scene.origins.get(("title",)) == CHANGES:
        return scene.title
    changes = (
        f"{'.'.join(map(str, path))} = {reduce(getitem, path, scene.raw)}"  # type: ignore[arg-type]
        for path in last
    )
    return f"{scene.title}; changed: {', '.join(changes)}"


#: Version of an installed package; reading its metadata takes a millisecond, and it does not change while we run.
_version = cache(importlib.metadata.version)


def packages_of(offers: Iterable[Offer]) -> dict[str, str]:
    """Return the packages behind offers and those that every result needs, each with its version."""
    used = {offer.package: offer.version for offer in offers}
    used |= {name: _version(name) for name in ("rollslip", "numpy", "scipy", "xarray")}
    return dict(sorted(used.items())) | {"python": sys.version.split()[0]}


def offers_of(scene: Scene, study: str, models: Iterable[tuple[str, Any]]) -> list[Offer]:
    """Return what offers the study, models and data of a run, those beside contacts too: rings, heat, damage, torque.

    Parameters
    ----------
    scene : Scene
        The scene.
    study : str
        Name of the study.
    models : iterable of (str, model)
        Models of contacts and study with their kinds.
    """
    stated = [
        (model_kind(field.name), choice)
        for field in attrs.fields(type(scene.models))
        for choice in as_list(getattr(scene.models, field.name))
        if isinstance(choice, ModelChoice)
    ]
    parts = [(kind, part) for pair in models for kind, part in (pair, *submodels(pair[1]))]
    named = {(kind, part.name) for kind, part in (*parts, *stated)}
    return [
        *(find(*key) for key in sorted({("study", study), *named})),
        *named_data(scene.raw or {}),
    ]


def describe_models(models: Iterable[tuple[str, Any]]) -> list[dict[str, Any]]:
    """Return descriptions of models, given with their kinds, for JSON."""
    return [
        _describe_model(kind, model)
        | {
            "equation": model.equation,
            "references": list(map(str, references_of(model))),
            "parameters": repr(model),
            "submodels": [_describe_model(*child) for child in submodels(model)],
        }
        for kind, model in models
    ]


def _describe_model(kind: str, model: SliceModel) -> dict[str, Any]:
    """Return kind and name of a model, and the package that has it."""
    offer = find(kind, model.name)
    return {
        "kind": kind,
        "name": model.name,
        "package": offer.package,
        "version": offer.version,
    }


def describe_film_limits(assembly: "Assembly") -> dict[str, float]:
    """Return the film parameters up to which a film is mixed or boundary, if the traction of the scene has them."""
    traction = assembly.at(attrs.evolve(assembly.resolution, boundary=True)).traction
    limits = {"mixed": traction.full_film_from or 0.0, "boundary": traction.boundary_up_to}
    return {film: limit for film, limit in limits.items() if 0.0 < limit < math.inf}


def describe_lubricant(oil: "Lubricant") -> dict[str, Any]:
    """Return the description of an oil, for JSON."""
    return {
        "name": oil.name,
        "source": oil.source,
        "grades": dict(oil.grades),
        "pressure_viscosity_law": repr(oil.pressure_viscosity_law),
        "caution": oil.pressure_viscosity_law.caution(),
    }


def describe_data(offer: Offer) -> dict[str, Any]:
    """Return the description of data that a scene takes by a name, for JSON."""
    named = load(offer)
    return {
        "kind": offer.kind,
        "name": named.name,
        "source": named.source,
        "validity": named.validity,
        "grades": dict(getattr(named, "grades", {})),
    }


def describe_surfaces(raw: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the description of surfaces that a scene takes by a name, for JSON; empty if it does not."""
    table = raw.get("surface", {})
    if "name" not in table:
        return []
    name = surface_name(table["name"])
    return [
        {
            "kind": "surface",
            "name": name,
            "source": f"Ra as recalled of measured cylindrical roller bearings (C): {SURFACES[name][1]}. Makers print "
            "none; measure yours.",
            "validity": "New, run-in raceways; the roughness that counts lies along the rolling direction.",
            "grades": {},
        }
    ]


def citations(plan: Plan) -> list[Citation]:
    """Return what to cite for the models, studies and data of a plan, the paper that rollslip follows first."""
    others = [citation for study in plan.studies.values() for citation in study.references]
    return collect_citations(
        [model for _, model in plan.models], others + data_references(plan.assembly)
    )


def collect_citations(models: Iterable[SliceModel], others: Iterable[Citation]) -> list[Citation]:
    """Return what to cite, each once: the paper that rollslip follows and rollslip first.

    Parameters
    ----------
    models : iterable of SliceModel
        Models that were used.
    others : iterable of Citation
        Citations of studies and data.
    """
    used = (citation for model in models for citation in references_of(model))
    return unique_works([KLEBANOV, rollslip_itself(), *used, *others])


def data_references(assembly: "Assembly") -> list[Citation]:
    """Return the citations of the oil and of all other data that a scene takes by a name."""
    oil = assembly.lubricant
    used = (
        citation
        for offer in named_data(assembly.scene.raw or {})
        for citation in get_class(offer.kind, offer.name).references
    )
    return [*used, *oil.references, *oil.pressure_viscosity_law.references]


def describe_citations(found: Iterable[Citation]) -> dict[str, list[Any]]:
    """Return citations as the attributes `CITED` of a dataset."""
    found = list(found)
    text, data = CITED
    return {text: [*map(str, found)], data: [*map(as_dict, found)]}


def references_of(model: SliceModel) -> list[Citation]:
    """Return the citations of a model and of its submodels, each once."""
    inner = (citation for _, child in submodels(model) for citation in child.references)
    return list(dict.fromkeys([*model.references, *inner]))
