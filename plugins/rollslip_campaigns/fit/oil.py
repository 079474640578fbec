"""Write the fitted oil as a file for scenes: the ``[lubricant]`` table of the rig file with the fitted values."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rollslip.files import whole_file
from rollslip.results.dataset import xr
from rollslip_campaigns.fit.findings import parameter_rows

__all__ = ["write_oil"]


def write_oil(dataset: "xr.Dataset", path: str | os.PathLike[str]) -> None:
    """Write the fitted oil as a TOML file with a table ``[lubricant]``, ready for a scene.

    If parameters of the traction model were fitted, the file has a table ``[models.traction]`` too.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result of `rollslip.fit`.
    path : str or path
        The file; it appears whole or not at all.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    lines = [f"# Fitted to {dataset.attrs['source']}; copy into a scene."]
    lines += [
        f"# {name}: {value}, 95 %: {limits}; {status}"
        for name, value, _, _, limits, status in parameter_rows(dataset)
    ]
    for key, attribute in (("lubricant", "lubricant_table"), ("models.traction", "traction_table")):
        if attribute in dataset.attrs:
            lines += ["", f"[{key}]"]
            lines += [
                f"{name} = {_toml(value)}"
                for name, value in json.loads(dataset.attrs[attribute]).items()
            ]
    with whole_file(Path(path)) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8", errors="backslashreplace")


def _toml(value: Any) -> str:
    """Return a value as TOML; numbers with all their digits."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)  # texts and numbers are the same in TOML
