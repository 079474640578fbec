"""Results: what a dataset and its variables say of themselves, and files that hold it without loss.

- A result is an xarray Dataset; its attributes make it reproducible (`rollslip.planning.provenance`).
- A file appears whole or not at all (`rollslip.files`). It is made in memory: where a disk is full, HDF5 leaves a
  file that cannot be closed and takes the process down.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rollslip.errors import OutputError
from rollslip.files import whole_file

if TYPE_CHECKING:
    import xarray as xr

#: Attributes that may differ between two runs of the same scene.
VOLATILE = ("created", "cost", "plan", "wall_time", "integration_time", "real_time_factor")


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
