"""Row and sentences on an axial load that ribs carry, from the dataset alone."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.answer import Row
from rollslip.results.text import force_unit, format_force, format_power, percent, two_digits
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

#: Rule of the axial load of a tapered bearing: the smallest, below which its rings part.
PARTING: Final = "rings part below"
#: End of the names of losses by ribs.
_RIB: Final = " rib"


def axial_load_of(dataset: "xr.Dataset") -> tuple[float, float]:
    """Return the axial load of a result [N], 0 without one, and its ratio to the radial load, infinite without that.

    The axial load of a tapered bearing is not judged by this ratio, and has 0.
    """
    if "rib_force" not in dataset:
        return 0.0, 0.0
    operation = json.loads(dataset.attrs.get("scene_resolved", "{}")).get("operation", {})
    axial = abs(float(operation.get("axial_load", 0.0)))
    if PARTING in dataset["axial_rule"]:
        return axial, 0.0
    radial = float(operation.get("radial_load", math.nan))
    return axial, axial / radial if radial > 0.0 else math.inf


def rib_heat(state: "xr.Dataset") -> float:
    """Return the power that ribs turn into heat at a steady slip [W]; NaN where it is not known."""
    if "loss" not in state:
        return math.nan
    is_rib = [str(source).endswith(_RIB) for source in state["source"].to_numpy()]
    return float(state["loss"].to_numpy()[np.array(is_rib)].sum())


def _touches_edge(state: "xr.Dataset") -> bool:
    """Whether the contact circle of a rib is larger than the distance of its middle from the edge of the rib."""
    return float(state["rib_contact_radius"]) > float(state["rib_height"])


def describe_load(scene: Mapping[str, Any], *, is_unlimited: bool) -> str:
    """Return which load of a resolved scene with an axial one is its minimum load, as the end of a sentence.

    Parameters
    ----------
    scene : mapping
        The resolved scene.
    is_unlimited : bool
        Whether the minimum load is none.
    """
    if not scene["operation"]["radial_load"]:
        return ", axial"
    # with little load the centrifugal forces of tapered rollers part the rings
    may_part = is_unlimited and "contact_angle" in scene["bearing"]
    return ", radial, at this F_a/F_r" + ", if they hold the rings together" * may_part


def axial_row(dataset: "xr.Dataset", state: "xr.Dataset") -> Row | None:
    """Return the row of the axial load with its limits and the heat of the ribs; None without such a load.

    Parameters
    ----------
    dataset : Dataset
        The result.
    state : Dataset
        The same at one steady slip.
    """
    load, _ = axial_load_of(dataset)
    if not load > 0.0:
        return None
    limits = dict(
        zip(
            map(str, dataset["axial_rule"].to_numpy()),
            dataset["axial_limit"].to_numpy().tolist(),
            strict=True,
        )
    )
    exceeded = [rule for rule, limit in limits.items() if load > limit and rule != PARTING]
    largest = max(limits.values())
    sizes = ", ".join(
        f"{rule} {format_force(limit, largest, unit=False)}" for rule, limit in limits.items()
    )
    notes = [f"{sizes} {force_unit(largest)[0]}"]
    if PARTING in limits:
        force = float(state["rib_force"].max())
        notes.insert(0, f"up to {format_force(force, force)} on each")
    if exceeded:
        notes.insert(0, f"above {' and '.join(exceeded)}")
    if _touches_edge(state):
        notes.insert(0, "edge contact of ribs")
    if math.isfinite(heat := rib_heat(state)):
        notes.insert(0, f"ribs {format_power(heat)}")
    return Row(
        key="axial_load",
        label="axial load",
        value=load,
        unit="N",
        text=format_force(load, load),
        note="; ".join(notes),
        is_alarm=bool(exceeded) or _touches_edge(state),
    )


def describe_ribs(dataset: "xr.Dataset") -> list[str]:
    """Return sentences on the ribs at each steady slip; empty without axial load.

    Parameters
    ----------
    dataset : Dataset
        The result.
    """
    load, ratio = axial_load_of(dataset)
    sentences = []
    for k in range(dataset.sizes["steady"] if load > 0.0 else 0):
        state = dataset.isel(steady=k)
        force = float(state["rib_force"].max())
        if not math.isfinite(force):
            continue
        radius = format_quantity(float(state["rib_contact_radius"]), "m", 2)
        pressure = format_quantity(float(state["rib_pressure"]), "Pa", 2)
        text = (
            f"at a cage slip of {percent(float(state['steady_slip']))} a rib bears up to "
            f"{format_quantity(force, 'N', 3)}, with {pressure} on a circle of {radius}, and all turn "
            f"{format_power(rib_heat(state))} into heat"
        )
        if _touches_edge(state):
            height = format_quantity(float(state["rib_height"]), "m", 2)
            text += (
                f"; the circle reaches beyond the edge of the rib, {height} from its middle, where neither pressure "
                "nor film are those of a circle"
            )
        sentences.append(text)
    if ratio > 0.5:
        size = (
            "there is no radial load"
            if math.isinf(ratio)
            else f"it is {two_digits(ratio)} times the radial load"
        )
        sentences.append(
            f"makers require an axial load of at most half the radial load, and {size}: rollers that ribs alone press "
            "resist slip little, and whether the cage lags or runs ahead depends on the friction of the ribs"
        )
    return sentences
