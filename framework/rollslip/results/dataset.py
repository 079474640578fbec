"""Results: what a dataset and its variables say of themselves, and files that hold it without loss.

- A result is an xarray Dataset; its attributes make it reproducible (`rollslip.planning.provenance`).
- A file ends with a checksum of all before it, which netCDF does not read, and which is checked when it is opened. A
  program that changes a file in place cuts it off; the file has a mark inside that it ought to be there.
- A file appears whole or not at all (`rollslip.files`). It is made in memory: where a disk is full, HDF5 leaves a
  file that cannot be closed and takes the process down.
"""

import io
import json
import math
import os
import re
from collections.abc import Mapping
from hashlib import sha256
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rollslip.errors import OutputError
from rollslip.files import readable, whole_file
from rollslip.references import Citation, from_dict, unique_works

if TYPE_CHECKING:
    import xarray as xr

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
#: Attributes that say what to cite: as it reads, and as data.
CITED = ("citations", "bibliography")
#: What attributes are that any result may have: texts, finite numbers from 0 on, and structures as JSON.
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
_NUMBERS: Final = ("evaluations", "wall_time")
_STRUCTURES: Final = dict.fromkeys(
    ("accuracy", "bibliography", "citations", "models", "plan", "reinstated", "warnings"), list
) | dict.fromkeys(
    ("conditions", "cost", "curves", "film_limits", "lubricant", "packages", "resolution", "scene_resolved",
     "validity"), dict
)  # fmt: skip
#: What readers raise where a file, or what it holds, is of another shape than they take for granted.
READ_ERRORS: Final = (
    ArithmeticError,
    AttributeError,
    LookupError,
    RuntimeError,
    TypeError,
    ValueError,
)

#: Characters of a value that a message shows.
_SHOWN: Final = 80
#: By how much deflate packs at most, and bytes of values that any file may claim.
_MAX_PACKED: Final = 1032
_FREELY: Final = 1 << 24
#: Version of what stands in a file of a result, and what its last line says.
FORMAT: Final = 1
_SEAL: Final = b"\nrollslip result %d sha256 %s\n"
#: Attribute of a file that has a checksum, and what it says to whoever reads it elsewhere.
_MARK: Final = ("sealed", "a SHA-256 of all before it follows at the end of the file")
_SEALED: Final = re.compile(rb"\nrollslip result (\d+) sha256 ([0-9a-f]{64})\n\Z")


#: Attribute of a coordinate of names: the unit of what has each, where they differ, as JSON.
UNITS: Final = "units_by_name"
#: Attribute of a variable: which other one says in words why it has no value.
STATUS_VARIABLE: Final = "told_by"
#: Names of variables, attributes and keys in results that were stored before these were renamed -> present name.
#: A name is added when a variable is renamed, and stays while results with it may exist.
FORMER_NAMES: Final[Mapping[str, str]] = {
    "bin_share": "bin_fraction",
    "contact_share": "contact_fraction",
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
    "least_ratio": "smallest_ratio",
    "light_share": "light_fraction",
    "makers_least_load": "makers_minimum_load",
    "moved": "changes",
    "most_ratio": "largest_ratio",
    "most_torque": "largest_torque",
    "most_torque_error": "largest_torque_error",
    "most_torque_slip": "largest_torque_slip",
    "regime_share": "regime_fraction",
    "runaway_drag": "limit_drag",
    "runaway_drag_along": "limit_drag_along",
    "runaway_range": "skidding_range",
    "runaway_slip": "skidding_slip",
    "runaway_slip_along": "skidding_slip_along",
    "runaway_status": "skidding_status",
    "settled_slip": "stationary_slip",
    "settled_status": "stationary_status",
    "settled_temperature": "stationary_temperature",
    "share_outside": "fraction_outside",
    "statement_says": "statement_text",
    "taken_back": "reinstated",
    "time_beyond_runaway": "time_beyond_skidding",
    "told": "messages",
    "warned": "is_warning",
    "weight": "severity",
}
#: A former name in the JSON text of an attribute.
_QUOTED: Final = re.compile(f'"({"|".join(FORMER_NAMES)})"')
#: A scene has one key that was called so: the number of points of the course of temperatures over time.
_KEYS_OF_SCENES: Final = {"instants": "course_points"}


def about(unit: str, long_name: str) -> dict[str, Any]:
    """Return the attributes that every variable of a result has."""
    return {"units": unit, "long_name": long_name}


def rows_along(dataset: "xr.Dataset", dim: str) -> list[dict[str, Any]]:
    """Return the values of all variables that have one dimension alone, by name, for each place along it."""
    columns = {
        str(name): one.to_numpy().tolist()
        for name, one in dataset.variables.items()
        if one.dims == (dim,)
    }
    return [
        dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)
    ]


def save(dataset: "xr.Dataset", path: Path) -> None:
    """Write a dataset as netCDF-4; the file appears whole or not at all.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    told = {
        key: readable(value) if isinstance(value, str) else value
        for key, value in dataset.attrs.items()
    }
    content = bytes(dataset.assign_attrs({**told, _MARK[0]: _MARK[1]}).to_netcdf(engine="h5netcdf"))
    with whole_file(path) as partial:
        partial.write_bytes(content + _SEAL % (FORMAT, sha256(content).hexdigest().encode()))


def open_result(path: str | os.PathLike[str]) -> "xr.Dataset":
    """Return a stored result; it is read whole, and the file is closed.

    Raises
    ------
    OutputError
        If the file does not exist, is not a result of rollslip, is not what was written, or was written by a newer
        version; or if an attribute that any result may have is not what it has to be.
    """
    import h5py
    import xarray as xr

    path = Path(path)
    if not path.is_file():
        raise OutputError(f"{path}: there is no such file")
    try:
        content = path.read_bytes()
        sealed = _check_seal(content, path)
        with h5py.File(io.BytesIO(content)) as file:  # xarray would read dimensions at once
            claims = sum(
                one.size * one.dtype.itemsize
                for one in file.values()
                if isinstance(one, h5py.Dataset)
            )
        if claims > _MAX_PACKED * len(content) + _FREELY:
            raise ValueError(f"it claims {claims:.3g} bytes of values in {len(content)} bytes")
        with xr.open_dataset(io.BytesIO(content), engine="h5netcdf", phony_dims="access") as stored:
            dataset = stored.load()
    except (OSError, MemoryError, *READ_ERRORS) as error:
        raise OutputError(f"{path}: is not a netCDF file that can be read ({error})") from error
    if dataset.attrs.pop(_MARK[0], None) is not None and not sealed:
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
    dataset = with_present_names(dataset)
    for name, value in dataset.attrs.items():
        if fault := _fault(str(name), value):
            raise OutputError(
                f"{path}: attribute {name!r}: {fault}; another program has changed the file: take a copy, or run the "
                "scene again"
            )
    return dataset


def _with_present_keys(value: Any, names: Mapping[str, str]) -> Any:
    """Return a text with the present names of its keys, and any other value as it is."""
    if not isinstance(value, str):
        return value
    return _QUOTED.sub(lambda key: f'"{names[key[1]]}"', value)


def with_present_names(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a result with the present names of its variables, its attributes, and the keys in its JSON texts."""
    attributes: dict[str, Any] = {}
    for name, value in dataset.attrs.items():
        names = {**FORMER_NAMES, **_KEYS_OF_SCENES} if name == "scene_resolved" else FORMER_NAMES
        attributes[FORMER_NAMES.get(str(name), str(name))] = _with_present_keys(value, names)
    renamed = dataset.rename(
        {name: FORMER_NAMES[str(name)] for name in dataset.variables if name in FORMER_NAMES}
    )
    renamed.attrs = attributes
    return renamed


def _fault(name: str, value: object) -> str:
    """Say what is wrong with an attribute that any result may have; nothing of others, which their studies know."""
    if name in _TEXTS and not isinstance(value, str):
        return f"is {shown_short(value)}, and has to be a text"
    if name in _NUMBERS and not (isinstance(value, Real) and 0.0 <= float(value) < math.inf):
        return f"is {shown_short(value)}, and has to be a finite number from 0 on"
    if name not in _STRUCTURES:
        return ""
    expected = "a list" if _STRUCTURES[name] is list else "a table"
    try:
        held = json.loads(value) if isinstance(value, str) else None
    except (ValueError, RecursionError) as error:
        return f"is {shown_short(value)}, and has to be {expected} in JSON ({error})"
    return (
        ""
        if isinstance(held, _STRUCTURES[name])
        else f"is {shown_short(value)}, and has to be {expected} in JSON"
    )


def shown_short(value: object) -> str:
    """Return a value of any length as a message shows it."""
    shown = repr(value)
    return shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}... ({len(shown)} characters)"


def _check_seal(content: bytes, path: Path) -> bool:
    """Refuse what is not what was written; return whether there is a checksum, which older files have not."""
    seal = _SEALED.search(content, max(0, len(content) - 200))
    if seal is None:
        return False
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
    return True


def citations_of(*datasets: "xr.Dataset") -> list[Citation]:
    """Return what results say is to be cited, each once; texts only, where a result is older than the data."""
    texts, data = CITED
    return unique_works(
        from_dict(one) if isinstance(one, dict) else one
        for dataset in datasets
        for one in json.loads(dataset.attrs.get(data, dataset.attrs.get(texts, "[]")))
    )
