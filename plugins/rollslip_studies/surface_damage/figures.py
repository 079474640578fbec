"""Figures of damage: each measure over the orbit of the rollers, and across the contacts where it is worst."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.style import DASHES, RING_COLOURS, ROW, SINGLE_COLUMN, Sheet, unit_label
from rollslip.units import converted, shown_unit
from rollslip_studies.surface_damage.findings import beyond, measures, told

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["damage_figures", "over_time"]

#: Largest value that is shown where small ones are the worst, over that of the better ring.
_MOST: Final = 4.0


def damage_figures(dataset: "xr.Dataset") -> "Iterator[tuple[str, str, Figure]]":
    """Draw the figures; give name, caption and figure of each."""
    known = [one for one in measures(dataset) if np.isfinite(one["worst"]).any()]
    if known:
        slip = f"at a cage slip of {100.0 * float(dataset['slip']):.3g} %"
        yield (
            "damage-along",
            f"Worst value on a roller over its orbit {slip}; dashed are limits.",
            _along(known),
        )
    if inside := [one for one in known if np.isfinite(one["across"]).any()]:
        caption = "Values across the contacts where they are worst, from the inlet at -1 to the outlet at 1."
        yield "damage-across", caption, _across(inside)


def _along(known: "list[xr.Dataset]") -> "Figure":
    angle = np.degrees(known[0]["angle"].to_numpy())
    centred = np.argsort((angle + 180.0) % 360.0)
    shown = (angle[centred] + 180.0) % 360.0 - 180.0
    figure, panels = _panels(known)
    for one, axes in zip(known, panels, strict=True):
        _with_limit(axes, one, shown, one["along"].to_numpy()[:, centred])
        axes.set_xlim(-180.0, 180.0)
        axes.set_xticks(range(-180, 181, 90))
    panels[-1].set_xlabel("Position from the line of load [°]")
    return figure


def over_time(dataset: "xr.Dataset") -> "Figure":
    """Draw the worst value of each measure at the instants of a motion, by ring."""
    known = [one for one in measures(dataset) if np.isfinite(one["worst"]).any()]
    figure, panels = _panels(known)
    time = dataset["measured_time"].to_numpy()
    for one, axes in zip(known, panels, strict=True):
        _with_limit(axes, one, time, one["worst_over_time"].to_numpy())
        axes.set_xlim(time[0], time[-1] if time.size > 1 else time[0] + 1.0)
    panels[-1].set_xlabel("Time [s]")
    return figure


def _with_limit(
    axes: "Axes", one: "xr.Dataset", x: "np.ndarray[Any, Any]", rows: "np.ndarray[Any, Any]"
) -> None:
    drawn = _drawn(axes, one, x, rows)
    if np.isfinite(limit := float(one["limit"])) and (
        beyond(one) or abs(limit) < 3.0 * np.nanmax(np.abs(rows))
    ):
        axes.axhline(drawn(limit), color="black", linewidth=0.8, linestyle="dashed")


def _across(known: "list[xr.Dataset]") -> "Figure":
    figure, panels = _panels(known)
    for one, axes in zip(known, panels, strict=True):
        _drawn(axes, one, one["place"].to_numpy(), one["across"].to_numpy())
        axes.set_xlim(-1.0, 1.0)
    panels[-1].set_xlabel("Place across the contact $x/b$ [–]")
    return figure


def _drawn(
    axes: "Axes", one: "xr.Dataset", x: "np.ndarray[Any, Any]", rows: "np.ndarray[Any, Any]"
) -> Any:
    """Draw a row for each ring in the unit that people use; return what converts to that."""
    unit = str(one["unit"].item())
    rise = unit not in ("1", "K") and unit.startswith("K")
    largest = one["sense"].item() == "largest"
    shown = "K" if rise else shown_unit(float(np.nanmax(np.abs(rows))), unit)

    def read(values: Any) -> Any:
        return values if rise or not shown else converted(values, unit, shown)

    extreme = np.nanmax if largest else np.nanmin
    for ring, row in zip(map(str, one["ring"].to_numpy()), rows, strict=True):
        if np.isfinite(row).any():
            words = f"{ring} ring, {told(float(extreme(row)), unit)}".replace("degC", "°C").replace(
                "m2", "m²"
            )
            dashes = DASHES[0 if ring == "inner" else 1]
            axes.plot(x, read(row), color=RING_COLOURS[ring], linestyle=dashes, label=words)
    if not largest:  # large values, of contacts that hardly touch, would hide the worst
        axes.set_ylim(0.0, _MOST * read(float(np.nanmax(np.nanmin(rows, axis=1)))))
    meaning = str(one["meaning"].item())
    axes.set_ylabel(f"{meaning[:1].upper()}{meaning[1:]}\n[{unit_label(shown) if shown else '–'}]")
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=1.0
    )  # above a power of ten at the axis
    return read


def _panels(known: "list[xr.Dataset]") -> "tuple[Figure, list[Axes]]":
    sheet = Sheet(SINGLE_COLUMN, len(known), 1, sharex=True, squeeze=False)
    return sheet.done(height=len(known) * (0.75 * SINGLE_COLUMN[1] + 2 * ROW) + ROW), list(
        sheet.axes[:, 0]
    )
