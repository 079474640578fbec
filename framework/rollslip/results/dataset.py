"""Results: what a dataset and its variables say of themselves, and files that hold it without loss.

- A result is an xarray Dataset; its attributes make it reproducible (`rollslip.planning.provenance`).
- A file ends with a checksum of all before it, which netCDF does not read, and which is checked when it is opened.
- A file appears whole or not at all (`rollslip.files`). It is made in memory: where a disk is full, HDF5 leaves a
  file that cannot be closed and takes the process down.
"""

import io
import json
import os
import re
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from rollslip.errors import OutputError
from rollslip.files import readable, whole_file
from rollslip.references import Citation, from_dict, once

if TYPE_CHECKING:
    import xarray as xr

#: Attributes that may differ between two runs of the same scene.
VOLATILE = ("created", "cost", "plan", "wall_time", "integration_time", "real_time_factor")
#: Attributes that say what to cite: as it reads, and as data.
CITED = ("citations", "bibliography")


#: Version of what stands in a file of a result, and what its last line says.
FORMAT: Final = 1
_SEAL: Final = b"\nrollslip result %d sha256 %s\n"
_SEALED: Final = re.compile(rb"\nrollslip result (\d+) sha256 ([0-9a-f]{64})\n\Z")


def about(unit: str, long_name: str) -> dict[str, Any]:
    """Return the attributes that every variable of a result has."""
    return {"units": unit, "long_name": long_name}


def save(dataset: "xr.Dataset", path: Path) -> None:
    """Write a dataset as netCDF-4; the file appears whole or not at all.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    told = {key: readable(value) if isinstance(value, str) else value for key, value in dataset.attrs.items()}
    content = bytes(dataset.assign_attrs(told).to_netcdf(engine="h5netcdf"))
    with whole_file(path) as partial:
        partial.write_bytes(content + _SEAL % (FORMAT, sha256(content).hexdigest().encode()))


def open_result(path: str | os.PathLike[str]) -> "xr.Dataset":
    """Return a stored result; it is read whole, and the file is closed.

    Raises
    ------
    OutputError
        If the file does not exist, is not a result of rollslip, is not what was written, or was written by a newer
        version.
    """
    import xarray as xr

    path = Path(path)
    if not path.is_file():
        raise OutputError(f"{path}: there is no such file")
    try:
        content = path.read_bytes()
        _check_seal(content, path)
        with xr.open_dataset(io.BytesIO(content), engine="h5netcdf") as stored:
            dataset = stored.load()
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise OutputError(f"{path}: is not a netCDF file that can be read ({error})") from error
    if "study" not in dataset.attrs or "scene_hash" not in dataset.attrs:
        raise OutputError(f"{path}: is a netCDF file but not a result of rollslip; it names no study and no scene")
    return dataset


def _check_seal(content: bytes, path: Path) -> None:
    """Refuse what is not what was written; a file without a checksum, of an older version, is taken as it is."""
    seal = _SEALED.search(content, max(0, len(content) - 200))
    if seal is None:
        return
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


def citations_of(*datasets: "xr.Dataset") -> list[Citation]:
    """Return what results say is to be cited, each once; texts only, where a result is older than the data."""
    texts, data = CITED
    return once(
        from_dict(one) if isinstance(one, dict) else one
        for dataset in datasets
        for one in json.loads(dataset.attrs.get(data, dataset.attrs.get(texts, "[]")))
    )
