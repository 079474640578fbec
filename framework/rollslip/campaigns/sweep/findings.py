"""A sweep in words and plain values: what is going to be computed, how it stands, and what it has found."""

import importlib.metadata
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rollslip.campaigns.sweep.distributions import shown
from rollslip.campaigns.sweep.folder import Status
from rollslip.campaigns.sweep.run import Progress
from rollslip.scene.values import scene_hash

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.campaigns.sweep.sweep import Sweep

__all__ = ["headline", "pieces_line", "planned", "progress", "record", "sentences", "status_lines", "topics"]


def headline(sweep: "Sweep") -> str:
    """Return the first line of a run: version, scene and hash, study and packages."""
    packages = ", ".join(f"{name} {version}" for name, version in sweep.facts["packages"].items())
    version = importlib.metadata.version("rollslip")
    scene = f"{sweep.given.source} {scene_hash(sweep.scene)[:12]}"
    return f"rollslip {version} | {scene} | sweep of {sweep.study} | {packages}"


def planned(sweep: "Sweep") -> list[str]:
    """Say what is swept, before anything runs."""
    lines = []
    for axis in sweep.design.axes:
        count, ends = len(axis.values), [axis.shown(value) for value in axis.values]
        values = ", ".join(ends) if count <= 5 else f"{ends[0]}, {ends[1]} ... {ends[-1]}"
        lines.append(f"{axis.key}: {count} value{'s' * (count != 1)}, {values}")
        if axis.key == "models.traction" and "hydrodynamic" in dict(sweep.scene.models.traction.parameters):
            whole = sweep.scene.models.traction.name
            lines.append(
                f"  in place of the whole {whole}; to change the law in it, sweep models.traction.hydrodynamic"
            )
    for of in sweep.design.sampled:
        lines.append(f"{of.key}: {shown(sweep.uncertainty.distributions[of.key], of.unit or '1')}")
    if sweep.design.has_samples:
        n = len(sweep.design.samples)
        balance = (
            "; a Sobol sequence is balanced at powers of two"
            if sweep.table.sampling.endswith("sobol") and n & (n - 1)
            else ""
        )
        lines.append(f"{n} samples, {sweep.table.sampling}, seed {sweep.table.seed}{balance}")
    elif sweep.given.uncertainty:
        lines.append("the table [uncertainty] of the scene is not used: no samples are asked for")
    for name, resolution in sweep.resolutions.chosen.items():
        laws = f"{', '.join(map(str, json.loads(name)))}: " if json.loads(name) else ""
        lines.append(
            f"{laws}computed at {resolution.slices} slices ({resolution.quadrature}) and {resolution.instants} "
            "instants of a pitch, what scene and points far apart need for the error of "
            f"{sweep.scene.accuracy.tolerance:g} it states"
        )
    own = len(sweep.numbers)
    piece = f" of {sweep.design.size}, piece {sweep.shard[0]} of {sweep.shard[1]}" if sweep.shard[1] > 1 else ""
    lines.append(f"{own} points{piece}; of each {', '.join(sweep.outputs)}")
    return lines


def duration(seconds: float) -> str:
    """Return a time in words: "12 s", "3 min 20 s", "2 h 5 min"."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def progress(of: Progress) -> str:
    """Return how far a sweep is, in one line."""
    failed = f", {of.failed} failed" if of.failed else ""
    left = f", {duration(of.left)} left" if of.left is not None else ""
    return f"{of.done} of {of.total} points{failed}{left}"


def pieces_line(folder: Path, pieces: Sequence[Status]) -> str:
    """Return how the pieces of a sweep that are not put together yet stand."""
    done, total, all_ = sum(piece.done for piece in pieces), sum(piece.total for piece in pieces), pieces[0].shard[1]
    return (
        f"{len(pieces)} of {all_} pieces in {folder}: {done} of {total} of their points done, "
        f"{sum(piece.running for piece in pieces)} running; put together by: rollslip sweep merge {folder}"
    )


def status_lines(of: Status) -> list[str]:
    """Return how a sweep stands, line by line."""
    piece = f", piece {of.shard[0]} of {of.shard[1]}" if of.shard[1] > 1 else ""
    lines = [f"sweep of {of.study}{piece} in {of.folder}: {of.done} of {of.total} points done"]
    lines += [f"  {name}: {count}" for name, count in of.counts.items()]
    if of.done < of.total:
        lines.append(f"  not yet: {of.total - of.done}")
        if of.left is not None and of.quiet is not None:
            lines.append(f"  at the last pace {duration(of.left)} left; the last point came {duration(of.quiet)} ago")
    for writer in of.writers:
        ended = writer["ended"] or ("runs" if of.running and writer is of.writers[-1] else "was killed")
        who = f"{writer['host']} process {writer['process']}, {writer['engine']}"
        lines.append(f"  {who}: {writer['points']} points, {ended}")
    lines += [f"  point {number} {status}: {message}" for number, status, message in of.errors]
    return lines


def sentences(dataset: "xr.Dataset") -> list[str]:
    """Return what a sweep found, line by line: every output with the range of its values."""
    counts = json.loads(dataset.attrs["counts"])
    lines = [", ".join(f"{count} {name}" for name, count in counts.items() if count) or "no points"]
    for name, row in _ranges(dataset).items():
        unit = "" if row["unit"] == "1" else f" {row['unit']}"
        where = (
            f"{row['least']:.4g} to {row['largest']:.4g}{unit}, median {row['median']:.4g}" if row["values"] else "none"
        )
        lines.append(
            f"{name}: {where}; {row['values']} value{'s' * (row['values'] != 1)}, {row['missing']} without one"
        )
    return lines


def _ranges(dataset: "xr.Dataset") -> dict[str, dict[str, Any]]:
    """Range of every output that is a number; what has no value is counted."""
    ranges = {}
    sampled = set(json.loads(dataset.attrs["axes"])) | {"sample"}
    for name, variable in dataset.data_vars.items():
        if name == "seconds" or variable.dtype.kind != "f":
            continue
        inner = [str(dim) for dim in variable.dims if dim not in sampled]
        pieces = {str(name): variable}
        if inner == ["ring"]:
            pieces = {f"{name}, {ring} ring": variable.sel(ring=ring) for ring in dataset["ring"].to_numpy()}
        for called, piece in pieces.items():
            values = piece.to_numpy()
            known = values[np.isfinite(values)]
            ranges[called] = {
                "unit": variable.attrs["units"],
                "values": int(known.size),
                "missing": int(values.size - known.size),
                "least": float(known.min()) if known.size else None,
                "median": float(np.median(known)) if known.size else None,
                "largest": float(known.max()) if known.size else None,
            }
    return ranges


def record(dataset: "xr.Dataset") -> dict[str, Any]:
    """Return what a sweep found, as plain values."""
    return {"counts": json.loads(dataset.attrs["counts"]), "outputs": _ranges(dataset)}


def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
    """Return what a sweep found, by what it is about."""
    first, *others = sentences(dataset)
    return {"points": [first]} | {line.partition(":")[0]: [line.partition(": ")[2]] for line in others}
