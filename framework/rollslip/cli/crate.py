"""A folder of results as a research object: RO-Crate 1.1 metadata beside the netCDF, which repositories read.

- ``ro-crate-metadata.json`` says in JSON-LD, in the terms of schema.org, what lies in the folder: every file, the
  variables with their units, the programs and the models with their versions, and what to cite. It tells only what the
  results themselves say.
- It is written without the library rocrate, which requires requests, jinja2 and arcp to write one file of JSON; the
  tests read the file back by it.
- rollslip does not know who publishes results, nor under which licence: the place for it is there, and says so.

Source: Sefton P. et al. RO-Crate Metadata Specification 1.1, 2020, doi:10.5281/zenodo.4031327.
"""

import json
import mimetypes
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

from rollslip.files import whole_file
from rollslip.references import Citation, from_dict

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CRATE", "write_crate"]

#: Name that RO-Crate gives the file.
CRATE: Final = "ro-crate-metadata.json"
_CONTEXT: Final = "https://w3id.org/ro/crate/1.1/context"
_PROFILE: Final = "https://w3id.org/ro/crate/1.1"
_NETCDF: Final = "application/x-netcdf"
#: What publications are in schema.org, where they are not just something made.
_TYPES: Final = {
    "article": "ScholarlyArticle",
    "proceedings": "ScholarlyArticle",
    "thesis": "Thesis",
    "book": "Book",
    "report": "Report",
    "software": "SoftwareApplication",
}
_Entity = dict[str, Any]


def write_crate(datasets: Mapping[Path, "xr.Dataset"]) -> Path:
    """Write the metadata of a folder that holds results; files that appear in it later are not told of."""
    folder = next(iter(datasets)).parent
    path = folder / CRATE
    text = json.dumps({"@context": _CONTEXT, "@graph": _graph(folder, datasets)}, indent=1, ensure_ascii=False)
    with whole_file(path) as partial:
        partial.write_text(text + "\n", encoding="utf-8")
    return path


def _graph(folder: Path, datasets: Mapping[Path, "xr.Dataset"]) -> list[_Entity]:
    by_id: dict[str, _Entity] = {}

    def told(entity: _Entity) -> dict[str, str]:
        """Put an entity among the others, once, and return a link to it."""
        by_id.setdefault(entity["@id"], entity)
        return {"@id": entity["@id"]}

    first = next(iter(datasets.values())).attrs
    titles = list(dict.fromkeys(one.attrs["title"] for one in datasets.values() if one.attrs.get("title")))
    root: _Entity = {"@id": "./", "@type": "Dataset"}
    told({"@id": CRATE, "@type": "CreativeWork", "conformsTo": {"@id": _PROFILE}, "about": {"@id": "./"}})
    told(root)
    actions, variables, works = [], [], []
    for path, dataset in datasets.items():
        attrs = dataset.attrs
        result = told(_file(path) | {"description": f"Result of {attrs['study']}, netCDF-4"})
        variables += [told(_variable(path, name, one)) for name, one in dataset.variables.items()]
        packages: dict[str, str] = json.loads(attrs.get("packages", "{}"))
        programs = [told(_program(name, version)) for name, version in packages.items()]
        models = [told(_model(one)) for one in json.loads(attrs.get("models", "[]"))]
        cited = [told(_work(from_dict(one))) for one in json.loads(attrs.get("bibliography", "[]"))]
        works += [one for one in cited if one not in works]
        actions.append(
            told(
                {
                    "@id": f"#run-{quote(path.stem)}",
                    "@type": "CreateAction",
                    "name": f"{attrs['study']} by rollslip",
                    "endTime": attrs["created"],
                    "instrument": [*programs, *models],
                    "object": told(_scene(attrs)),
                    "result": result,
                }
            )
        )
    names = sorted(path for path in folder.iterdir() if path.is_file() and path.name[0] != "." and path.name != CRATE)
    root |= {
        "name": "; ".join(titles) or f"Results of {first['study']}",
        "description": first.get("description") or f"Computed by rollslip: {', '.join(p.name for p in datasets)}",
        "datePublished": first["created"],
        "identifier": first["scene_hash"],
        "license": told(
            {
                "@id": "#licence",
                "@type": "CreativeWork",
                "name": "No licence stated",
                "description": "Whoever publishes these results puts the licence here, and the authors beside it.",
            }
        ),
        "hasPart": [told(_file(path)) for path in names],
        "variableMeasured": variables,
        "citation": works,
        "mentions": actions,
    }
    return list(by_id.values())


def _file(path: Path) -> _Entity:
    kind = _NETCDF if path.suffix == ".nc" else mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    return {
        "@id": quote(path.name),
        "@type": "File",
        "name": path.name,
        "encodingFormat": kind,
        "contentSize": str(path.stat().st_size),
    }


def _variable(path: Path, name: object, variable: "xr.Variable") -> _Entity:
    unit = str(variable.attrs.get("units", ""))
    return {
        "@id": f"#{quote(path.name)}/{quote(str(name))}",
        "@type": "PropertyValue",
        "name": str(name),
        "description": str(variable.attrs.get("long_name", name)),
        **({"unitText": unit} if unit else {}),
        "subjectOf": {"@id": quote(path.name)},
    }


def _program(name: str, version: str) -> _Entity:
    return {"@id": f"#package-{quote(name)}", "@type": "SoftwareApplication", "name": name, "softwareVersion": version}


def _model(model: Mapping[str, Any]) -> _Entity:
    return {
        "@id": f"#model-{model['kind']}-{quote(model['name'])}",
        "@type": "SoftwareSourceCode",
        "name": f"{model['kind']} {model['name']}",
        "description": model["equation"] or f"{model['kind']} model",
        "isPartOf": {"@id": f"#package-{quote(model['package'])}"},
        "version": model["version"],
    }


def _scene(attrs: Mapping[Any, Any]) -> _Entity:
    return {
        "@id": f"#scene-{attrs['scene_hash']}",
        "@type": "CreativeWork",
        "name": attrs.get("source") or "scene",
        "encodingFormat": "application/toml",
        "text": attrs.get("scene", ""),
    }


def _work(citation: Citation) -> _Entity:
    text = str(citation)
    own = f"#work-{sha256(text.encode()).hexdigest()[:12]}"
    if isinstance(citation, str):
        return {"@id": own, "@type": "CreativeWork", "name": text}
    told: _Entity = {
        "@id": citation.link or own,
        "@type": _TYPES.get(citation.kind, "CreativeWork"),
        "name": citation.title or text,
        "creditText": text,
    }
    if citation.authors:
        told["author"] = "; ".join(citation.authors)
    if citation.year:
        told["datePublished"] = str(citation.year)
    return told
