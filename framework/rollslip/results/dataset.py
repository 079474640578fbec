"""Datasets of results: attributes of variables, and netCDF files that store them without loss.

- A result is an xarray Dataset; its attributes make it reproducible (`rollslip.planning.provenance`).
- A file ends with a checksum of all bytes before it, which netCDF does not read, and which is checked when the file is
  opened. A program that changes a file in place cuts the checksum off; an attribute says that there should be one.
- A file is written completely or not at all (`rollslip.files`). It is built in memory, because HDF5 on a full disk
  leaves a file that cannot be closed and ends the process.
- ``ro-crate-metadata.json`` describes a folder as a research object, in the terms of schema.org (JSON-LD): files with
  checksums, who publishes them under which licence, programs with versions and checksums, models, scenes and sources,
  and by which command on which platform they were computed. It is written without the library rocrate, which requires
  requests, jinja2 and arcp for one file of JSON.

Source: P. Sefton et al., RO-Crate Metadata Specification 1.1, 2020, doi:10.5281/zenodo.4031327.
"""

import importlib
import importlib.metadata
import io
import json
import math
import mimetypes
import os
import platform
import re
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from functools import reduce
from hashlib import sha256
from itertools import chain
from numbers import Real
from operator import or_
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import quote

import attrs
import numpy as np

from rollslip.catalogue.installed import digest_of_files, with_requirements
from rollslip.errors import OutputError, SceneError, nearest
from rollslip.files import readable, whole_file
from rollslip.references import Citation, from_dict, unique_works


class _Library(ModuleType):
    """Stands for a library that takes long to import, and imports it when a name in it is looked up."""

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module(self.__name__), name)


if TYPE_CHECKING:
    import xarray

    xr = xarray
else:
    # modules that take it from here name datasets, and cost nothing where none is made
    xr = _Library("xarray")

#: Attributes that may differ between two runs of the same scene.
VOLATILE = (
    "created",
    "cost",
    "plan",
    "wall_time",
    "integration_time",
    "integration_seconds",
    "real_time_factor",
)
#: Attributes with what to cite: as text, and as data.
CITED = ("citations", "bibliography")
#: Attributes of any result that are texts.
_TEXTS: Final = (
    "study",
    "scene_hash",
    "source",
    "created",
    "title",
    "description",
    "note",
    "scene",
)
#: Attributes of any result that are finite numbers, 0 or more.
_NUMBERS: Final = ("evaluations", "wall_time")
#: Attribute of any result that is a structure in JSON -> its type.
_STRUCTURES: Final = dict.fromkeys(
    ("accuracy", "bibliography", "citations", "models", "plan", "reinstated", "warnings"), list
) | dict.fromkeys(
    ("conditions", "cost", "curves", "film_limits", "lubricant", "packages", "resolution", "scene_resolved",
     "validity"), dict
)  # fmt: skip
#: Length [bytes] of a text up to which it is an attribute of fixed length. HDF5 stores attributes of up to 64 KiB; a
#: longer text has a variable length, which some netCDF tools do not show.
_MAX_FIXED: Final = 60_000
#: Size [bytes] of the values of a variable from which on it has a checksum of its own (Fletcher32), by which other
#: readers see damage. It needs an index of chunks of 2 kB: with checksums of all variables a result of study
#: steady-slip takes 195 instead of 130 kB.
_MIN_CHECKED: Final = 4096
#: Errors that readers raise where a file, or a value in it, has another shape than expected.
READ_ERRORS: Final = (
    ArithmeticError,
    AttributeError,
    LookupError,
    RuntimeError,
    TypeError,
    ValueError,
)

#: Characters of a value that a message shows, so that it stays a line.
_SHOWN: Final = 80
#: Largest ratio of compression by deflate; a file that claims more is damaged or malicious.
_MAX_COMPRESSION: Final = 1032
#: Bytes of values that any file may claim, whatever its size. Chosen: a few MB do no harm.
_MIN_CLAIM: Final = 1 << 24
#: Version of the format of a file. In files of format 1, and of those without a last line, some names are former ones.
FORMAT: Final = 2
#: Last line of a file: format and checksum.
_SEAL: Final = b"\nrollslip result %d sha256 %s\n"
#: Attribute of a file that has a checksum, and its value, for readers by other programs.
_MARK: Final = ("sealed", "a SHA-256 of all before it follows at the end of the file")
#: Pattern of the last line.
_SEALED: Final = re.compile(rb"\nrollslip result (\d+) sha256 ([0-9a-f]{64})\n\Z")


#: Attribute of a coordinate of names: JSON with the unit of each name, where these differ.
UNITS: Final = "units_by_name"
#: Attribute of a variable: the variable with its status, which says why a value is missing. The value is that of the
#: first results, which can be read so.
STATUS_VARIABLE: Final = "told_by"
#: Names of variables and attributes in files of format 1 -> present name.
FORMER_NAMES: Final[Mapping[str, str]] = {
    "bin_share": "bin_fraction",
    "error_asked": "error_requested",
    "fewest": "min_conditions",
    "fewest_samples": "min_samples",
    "indexed_asked": "indexed_requested",
    "instants": "n_positions",
    "instants_error": "positions_error",
    "largest_drag": "limit_drag",
    "largest_drag_error": "limit_drag_error",
    "largest_drag_high": "limit_drag_high",
    "largest_drag_low": "limit_drag_low",
    "largest_drag_slip": "skidding_slip",
    "largest_drag_status": "skidding_status",
    "least_cage_slip": "smallest_cage_slip",
    "least_cage_slip_time": "smallest_cage_slip_time",
    "least_load": "minimum_load",
    "least_load_status": "minimum_load_status",
    "least_margin_time": "smallest_margin_time",
    "least_margin_to_runaway": "smallest_margin_to_skidding",
    "look_further": "search_range_hint",
    "light_share": "light_fraction",
    "n_positions_error": "positions_error",
    "makers_least_load": "makers_minimum_load",
    "most_torque": "largest_torque",
    "most_torque_error": "largest_torque_error",
    "most_torque_slip": "largest_torque_slip",
    "regime_share": "regime_fraction",
    "runaway_drag": "limit_drag",
    "runaway_drag_along": "limit_drag_along",
    "runaway_slip": "skidding_slip",
    "runaway_slip_along": "skidding_slip_along",
    "runaway_status": "skidding_status",
    "settled_slip": "stationary_slip",
    "settled_status": "stationary_status",
    "settled_temperature": "stationary_temperature",
    "statement_says": "statement_text",
    "taken_back": "reinstated",
    "time_beyond_runaway": "time_beyond_skidding",
}
#: Attribute with JSON in files of format 1 -> former key in it -> present key.
_FORMER_KEYS: Final[Mapping[str, Mapping[str, str]]] = {
    "band": {"least_load": "minimum_load", "most": "dominant", "moved": "changes"},
    "consequences": {"moved": "changes"},
    "resolution": {"instants": "n_positions"},
    "resolutions": {"instants": "n_positions"},
    "scene_resolved": {
        "contact_share": "contact_fraction",
        "instants": "course_points",
        "least_ratio": "smallest_ratio",
        "most_ratio": "largest_ratio",
        "runaway_range": "skidding_range",
    },
    "validity": {
        "share_outside": "fraction_outside",
        "told": "messages",
        "warned": "is_warning",
        "weight": "severity",
    },
}


def about(unit: str, long_name: str) -> dict[str, Any]:
    """Return the attributes that every variable of a result has."""
    return {"units": unit, "long_name": long_name}


def rows_along(dataset: "xr.Dataset", dim: str) -> list[dict[str, Any]]:
    """Return the values of all variables of one dimension, as one mapping of names to values for each of its points."""
    columns = {
        str(name): variable.to_numpy().tolist()
        for name, variable in dataset.variables.items()
        if variable.dims == (dim,)
    }
    return [
        dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)
    ]


def save(
    dataset: "xr.Dataset",
    path: str | os.PathLike[str],
    *,
    crate: Mapping[str, Any] | None = None,
) -> None:
    """Write a dataset as netCDF-4; the file is written completely or not at all.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result.
    path : str or path
        The file; `open_result` reads it.
    crate : mapping, optional
        Who publishes the folder of the file: ``title``, ``authors`` (names, or tables of name, orcid and affiliation),
        ``licence`` and ``doi``, any of which may be missing. The folder then gets RO-Crate metadata of all its files,
        and of all results among them: ``ro-crate-metadata.json``, which repositories read.

    Raises
    ------
    OutputError
        If it cannot be written.
    SceneError
        If ``crate`` has an unknown or a wrong value.
    """
    published = None if crate is None else publication(crate, "crate")
    attributes = dict(dataset.attrs)  # those of a run are computed now
    stored = dataset.copy()
    stored.attrs = attributes | {_MARK[0]: _MARK[1]}
    items: list[Any] = [stored, *stored.variables.values()]
    for item in items:
        item.attrs |= {
            key: _fixed_length(readable(value))
            for key, value in item.attrs.items()
            if isinstance(value, str)
        }
    encoding = {
        name: {"fletcher32": True, "chunksizes": variable.shape}
        for name, variable in stored.variables.items()
        if variable.dtype.kind in "fiu" and variable.nbytes >= _MIN_CHECKED
    }
    content = bytes(stored.to_netcdf(engine="h5netcdf", encoding=encoding))
    with whole_file(Path(path)) as partial:
        partial.write_bytes(content + _SEAL % (FORMAT, sha256(content).hexdigest().encode()))
    if published is not None:
        folder = Path(path).parent
        results = {file.name: open_result(file).attrs for file in sorted(folder.glob("*.nc"))}
        write_crate(folder, published, results)


def _fixed_length(text: str) -> Any:
    """Return a text as an attribute of fixed length, which netCDF tools show; a long one as it is."""
    import h5py

    encoded = text.encode()
    if len(encoded) > _MAX_FIXED:
        return text
    # readers take an attribute of one byte for a character: it is padded
    return np.array(encoded, dtype=h5py.string_dtype("utf-8", max(2, len(encoded))))


def open_result(path: str | os.PathLike[str]) -> "xr.Dataset":
    """Return a stored result; the whole file is read and closed.

    Raises
    ------
    OutputError
        If the file does not exist, is not a result of rollslip, was changed, or was written by a newer version; or if
        an attribute has a wrong type.
    """
    import h5py

    path = Path(path)
    if not path.is_file():
        raise OutputError(f"{path}: there is no such file")
    try:
        content = path.read_bytes()
        file_format = _check_seal(content, path)
        with h5py.File(io.BytesIO(content)) as file:  # xarray would read dimensions at once
            claims = sum(
                variable.size * variable.dtype.itemsize
                for variable in file.values()
                if isinstance(variable, h5py.Dataset)
            )
        if claims > _MAX_COMPRESSION * len(content) + _MIN_CLAIM:
            raise ValueError(f"it claims {claims:.3g} bytes of values in {len(content)} bytes")
        with xr.open_dataset(io.BytesIO(content), engine="h5netcdf", phony_dims="access") as stored:
            dataset = stored.load()
    except (OSError, MemoryError, *READ_ERRORS) as error:
        raise OutputError(f"{path}: is not a netCDF file that can be read ({error})") from error
    if dataset.attrs.pop(_MARK[0], None) is not None and not file_format:
        raise OutputError(
            f"{path}: is not what rollslip wrote, its checksum is gone: another program has changed it, or cut it off; "
            "run the scene again, or take a copy"
        )
    if (
        "study" not in dataset.attrs or not {"scene_hash", "created"} & dataset.attrs.keys()
    ):  # validations have no scene
        raise OutputError(
            f"{path}: is a netCDF file but not a result of rollslip; it names no study and no scene"
        )
    if file_format < FORMAT:
        dataset = with_present_names(dataset)
    for name, value in dataset.attrs.items():
        if fault := _fault(str(name), value):
            raise OutputError(
                f"{path}: attribute {name!r}: {fault}; another program has changed the file: take a copy, or run the "
                "scene again"
            )
    return dataset


def with_present_names(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result of format 1 with the present names of its variables, its attributes, and keys in its JSON texts.

    A name stays where the present one is there already: the former names of two studies became one.
    """
    attributes: dict[str, Any] = {}
    for name, value in dataset.attrs.items():
        for former, present in _FORMER_KEYS.get(str(name), {}).items():
            value = re.sub(rf'"{former}"(?=\s*:)', f'"{present}"', str(value))
        if name == "output":
            value = FORMER_NAMES.get(value, value)
        attributes.setdefault(FORMER_NAMES.get(str(name), str(name)), value)
    former_of = {
        FORMER_NAMES[str(name)]: name for name in dataset.variables if name in FORMER_NAMES
    }
    renamed = dataset.rename(
        {former: name for name, former in former_of.items() if name not in dataset.variables}
    )
    renamed.attrs = attributes
    for variable in renamed.variables.values():
        if STATUS_VARIABLE in variable.attrs:
            status = variable.attrs[STATUS_VARIABLE]
            variable.attrs[STATUS_VARIABLE] = FORMER_NAMES.get(status, status)
    return renamed


def _fault(name: str, value: object) -> str:
    """Return what is wrong with an attribute of any result; empty for attributes that only some studies have."""
    if name in _TEXTS and not isinstance(value, str):
        return f"is {shown_short(value)}, and has to be a text"
    if name in _NUMBERS and not (isinstance(value, Real) and 0.0 <= float(value) < math.inf):
        return f"is {shown_short(value)}, and has to be a finite number from 0 on"
    if name not in _STRUCTURES:
        return ""
    expected = "a list" if _STRUCTURES[name] is list else "a table"
    try:
        structure = json.loads(value) if isinstance(value, str) else None
    except (ValueError, RecursionError) as error:
        return f"is {shown_short(value)}, and has to be {expected} in JSON ({error})"
    if isinstance(structure, _STRUCTURES[name]):
        return ""
    return f"is {shown_short(value)}, and has to be {expected} in JSON"


def shown_short(value: object) -> str:
    """Return a value as text for a message, cut to a few words."""
    shown = repr(value)
    return shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}... ({len(shown)} characters)"


def _check_seal(content: bytes, path: Path) -> int:
    """Raise an error for a file that was changed; return its format, 0 for older files, which have no checksum."""
    if (seal := _SEALED.search(content, max(0, len(content) - 200))) is None:
        return 0
    if int(seal[1]) > FORMAT:
        raise OutputError(
            f"{path}: was written by a newer version of rollslip (format {int(seal[1])}; this one reads up to "
            f"{FORMAT}); update rollslip"
        )
    if sha256(content[: seal.start()]).hexdigest().encode() != seal[2]:
        raise OutputError(
            f"{path}: is not what rollslip wrote, its checksum is another: it was damaged or changed; run the scene "
            "again, or take a copy"
        )
    return int(seal[1])


def citations_of(*datasets: "xr.Dataset") -> list[Citation]:
    """Return the citations of results, each once; as texts only, for results that were stored without data."""
    texts, data = CITED
    return unique_works(
        from_dict(item) if isinstance(item, dict) else item
        for dataset in datasets
        for item in json.loads(dataset.attrs.get(data, dataset.attrs.get(texts, "[]")))
    )


# Research objects ----------------------------------------------------------------------------------------------------

#: File with the metadata of a research object, named by the specification.
CRATE: Final = "ro-crate-metadata.json"
#: File with the versions of all packages, for pip, and digests of their files.
PACKAGES: Final = "rollslip-packages.txt"
#: Terms of the metadata, and the version of the specification that it conforms to.
_CONTEXT: Final = "https://w3id.org/ro/crate/1.1"
#: Type of netCDF files, which the standard library does not know.
_NETCDF: Final = "application/x-netcdf"
#: Name of what is not stated, such as a licence: whoever publishes the folder replaces it.
_NOT_STATED: Final = "not stated"
#: Identity of the computer.
_PLATFORM: Final = "#platform"


@attrs.frozen(kw_only=True)
class Author:
    """Somebody who publishes results."""

    name: str  #: As printed.
    orcid: str = ""  #: ORCID iD, such as 0000-0002-1825-0097.
    affiliation: str = ""  #: Institution.


@attrs.frozen(kw_only=True)
class Publication:
    """Who publishes a folder of results, and how."""

    title: str = ""  #: By default that of the scene.
    authors: tuple[Author, ...] = ()
    licence: str = ""  #: An address, or an SPDX name such as CC-BY-4.0.
    doi: str = ""  #: Once there is one.


def publication(stated: Mapping[str, Any], where: str) -> Publication:
    """Return who publishes results, from a table.

    Parameters
    ----------
    stated : mapping
        Values by the names of the fields of `Publication`; an author is a name, or a table of those of `Author`.
    where : str
        Name of the table, for messages.

    Raises
    ------
    SceneError
        If a key is unknown or a value is no text.
    """
    authors = stated.get("authors", ())
    if isinstance(authors, str) or not isinstance(authors, Sequence):
        raise SceneError([f"{where}.authors: a list of names, or of tables, is expected"])
    tables = [{"name": author} if isinstance(author, str) else author for author in authors]
    made = [
        Author(**_texts(Author, table, f"{where}.authors[{k}]")) for k, table in enumerate(tables)
    ]
    others = {key: value for key, value in stated.items() if key != "authors"}
    return Publication(**_texts(Publication, others, where), authors=tuple(made))


def _texts(cls: type, stated: Any, where: str) -> dict[str, Any]:
    """Return a table whose values are texts and whose keys are fields of a class; `SceneError` for any other."""
    known = [field.name for field in attrs.fields(cls)]
    if not isinstance(stated, Mapping):
        raise SceneError([f"{where}: a table with {', '.join(known)} is expected, not {stated!r}"])
    problems = []
    for key, value in stated.items():
        if key not in known:
            near = [f"did you mean {name!r}? " for name in nearest(str(key), known, 1)]
            problems.append(
                f"{where}.{key}: unknown key; {''.join(near)}there are {', '.join(known)}"
            )
        elif not isinstance(value, str):
            problems.append(f"{where}.{key}: a text is expected, not {value!r}")
    if cls is Author and "name" not in stated:
        problems.append(f"{where}: the name is missing")
    if problems:
        raise SceneError(problems)
    return dict(stated)


def write_crate(
    folder: Path, published: Publication, results: Mapping[str, Mapping[Any, Any]]
) -> Path:
    """Write the metadata of a folder as a research object, and return its path.

    Parameters
    ----------
    folder : Path
        The folder; all its files are described.
    published : Publication
        Who publishes it.
    results : mapping
        Name of the file of each result -> the attributes of its dataset.
    """
    authors = [_author(author) for author in published.authors]
    licence = {
        "@id": published.licence if published.licence.startswith("http") else "#licence",
        "@type": "CreativeWork",
        "name": published.licence or _NOT_STATED,
    }
    packages: dict[str, str] = reduce(
        or_, (json.loads(a.get("packages", "{}")) for a in results.values())
    )
    _write_packages(folder / PACKAGES, packages)
    files = [_file(folder, name) for name in _published_files(folder)]
    runs = [_run(name, attributes) for name, attributes in results.items()]
    values = [value for a in results.values() for value in json.loads(a.get("bibliography", "[]"))]
    sources = [_source(value) for value in values]
    root = _root(published, results) | {
        "license": {"@id": licence["@id"]},
        "author": _links(authors),
        "hasPart": _links(files),
        "citation": _links(sources),
        "mentions": [{"@id": run[0]["@id"]} for run in runs],
    }
    descriptor = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": _CONTEXT},
        "about": {"@id": "./"},
    }
    computer = {
        "@id": _PLATFORM,
        "@type": "OperatingSystem",
        "name": platform.platform(),
        "description": platform.processor() or platform.machine(),
    }
    programs = [_program(*package) for package in packages.items()]
    graph = [descriptor, root, licence, *authors, computer, *programs, *files, *sources]
    by_id = {entity["@id"]: entity for entity in chain(graph, *runs)}
    path = folder / CRATE
    with whole_file(path) as partial:
        document = {"@context": f"{_CONTEXT}/context", "@graph": [*by_id.values()]}
        text = json.dumps(document, indent=1, ensure_ascii=False)
        partial.write_text(f"{text}\n", encoding="utf-8")
    return path


def _write_packages(path: Path, packages: Iterable[str]) -> None:
    """Write the versions of packages and of all that they require, each with the digest of its files."""
    lines = [
        f"# Python {platform.python_version()}. pip install -r {path.name} installs these versions. After a version",
        "# stands the sha256 of the installed files, as in RECORD: where it is the same, the program is.",
    ]
    for name in with_requirements(packages):
        version = importlib.metadata.version(name)
        lines.append(f"{name}=={version}  # {digest_of_files(name)}")
    with whole_file(path) as partial:
        partial.write_text("\n".join([*lines, ""]), encoding="utf-8")


def _root(published: Publication, results: Mapping[str, Mapping[Any, Any]]) -> dict[str, Any]:
    """Return what a folder is, when it was computed, and its DOI."""
    first = next(iter(results.values()))
    return {
        "@id": "./",
        "@type": "Dataset",
        "name": published.title or first.get("title") or f"Results of {first['study']}",
        "description": first.get("description") or f"Computed by rollslip: {', '.join(results)}",
        "datePublished": first["created"],
        "identifier": f"https://doi.org/{published.doi}" if published.doi else f"DOI {_NOT_STATED}",
    }


def _published_files(folder: Path) -> list[str]:
    """Return the relative names of the files of a folder, without hidden ones and those that describe it."""
    return sorted(
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and path.name not in (CRATE, "manifest.json") and path.name[0] != "."
    )


def _run(name: str, attributes: Mapping[Any, Any]) -> list[dict[str, Any]]:
    """Return the entities of the run of a result: the run, its models and its scene."""
    models = [_model(model) for model in json.loads(attributes.get("models", "[]"))]
    scene = _scene(attributes)
    packages = json.loads(attributes.get("packages", "{}"))
    run = {
        "@id": f"#run-{quote(name)}",
        "@type": "CreateAction",
        "name": f"{attributes['study']} by rollslip",
        "description": shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]]),
        "endTime": attributes["created"],
        "instrument": [
            *({"@id": f"#package-{quote(package)}"} for package in packages),
            *_links(models),
            {"@id": _PLATFORM},
        ],
        "object": {"@id": scene["@id"]},
        "result": {"@id": quote(name)},
    }
    return [run, *models, scene]


def _links(entities: list[dict[str, Any]]) -> list[dict[str, str]]:
    """Return a link to each entity, once."""
    return [{"@id": identity} for identity in dict.fromkeys(entity["@id"] for entity in entities)]


def _author(author: Author) -> dict[str, Any]:
    """Return the entity of an author."""
    identity = (
        f"https://orcid.org/{author.orcid}" if author.orcid else f"#author-{quote(author.name)}"
    )
    about = {"affiliation": author.affiliation} if author.affiliation else {}
    return {"@id": identity, "@type": "Person", "name": author.name, **about}


def _file(folder: Path, name: str) -> dict[str, Any]:
    """Return the entity of a file, with its checksum."""
    kind = _NETCDF if name.endswith(".nc") else mimetypes.guess_type(name)[0]
    return {
        "@id": quote(name),
        "@type": "File",
        "name": name,
        "encodingFormat": kind or "application/octet-stream",
        "contentSize": str((folder / name).stat().st_size),
        "sha256": sha256((folder / name).read_bytes()).hexdigest(),
    }


def _program(name: str, version: str) -> dict[str, Any]:
    """Return the entity of a package, with a checksum of its files where it is installed."""
    about = {}
    with suppress(importlib.metadata.PackageNotFoundError):
        about["sha256"] = digest_of_files(name)
    return {
        "@id": f"#package-{quote(name)}",
        "@type": "SoftwareApplication",
        "name": name,
        "softwareVersion": version,
        **about,
    }


def _model(model: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entity of a model."""
    return {
        "@id": f"#model-{model['kind']}-{quote(model['name'])}",
        "@type": "SoftwareSourceCode",
        "name": f"{model['kind']} {model['name']}",
        "description": f"{model['equation']}; {model['parameters']}",
        "isPartOf": {"@id": f"#package-{quote(model['package'])}"},
        "version": model["version"],
    }


def _scene(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Return the entity of the scene of a result, with its text."""
    return {
        "@id": f"#scene-{attributes['scene_hash']}",
        "@type": "CreativeWork",
        "name": Path(str(attributes.get("source", ""))).name or "scene",
        "encodingFormat": "application/toml",
        "text": attributes.get("scene", ""),
    }


def _source(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entity of a publication that a result cites."""
    citation = from_dict(values)
    text = str(citation)
    link = "" if isinstance(citation, str) else citation.link
    return {
        "@id": link or f"#source-{sha256(text.encode()).hexdigest()[:12]}",
        "@type": "CreativeWork",
        "name": text,
    }
