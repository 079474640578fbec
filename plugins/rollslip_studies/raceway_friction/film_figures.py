"""Film regimes in figures of friction over slip: film parameters in legends, and shades where films are not full."""

import json
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from rollslip.results.curves import Curve, digits
from rollslip.results.dataset import xr

__all__ = ["film_limits", "film_text", "shade_film"]

#: Grey of the background where the smallest film is mixed or boundary.
FILM_TINTS: Final = {"mixed": "0.93", "boundary": "0.84"}


def film_limits(dataset: "xr.Dataset") -> dict[str, float]:
    """Return the film parameters up to which a film is mixed or boundary, as the traction law states them."""
    return dict(json.loads(dataset.attrs.get("film_limits", "{}")))


def film_text(curve: Curve, limits: Mapping[str, float]) -> str:
    """Return the film parameters of a curve and, if there is one kind only, the kind of film.

    Parameters
    ----------
    curve : Curve
        The curve.
    limits : mapping
        Film parameter [-] below which a film is of a kind, by the kind.
    """
    finite = curve.film_parameter[np.isfinite(curve.film_parameter)]
    if not finite.size:
        return "Λ unknown"
    ends = (finite.min(), finite.max())
    low, high = (digits(end, 2) for end in ends)
    kinds = {_kind(end, limits) for end in ends}
    kind = f" ({kinds.pop()})" if limits and len(kinds) == 1 else ""
    return f"Λ = {low if low == high else f'{low} to {high}'}{kind}"


def _kind(film_parameter: float, limits: Mapping[str, float]) -> str:
    """Return the kind of a film with a film parameter."""
    below = [film for film, limit in limits.items() if film_parameter < limit]
    return f"{min(below, key=limits.__getitem__)} film" if below else "full film"


def shade_film(axes: "Axes", shown: Sequence[Curve], limits: Mapping[str, float]) -> "list[Artist]":
    """Shade the slips at which the smallest film is not full; return the entries of the legend.

    Parameters
    ----------
    axes : Axes
        Axes with slip in percent.
    shown : sequence of Curve
        The curves.
    limits : mapping
        Film parameter [-] below which a film is of a kind, by the kind.
    """
    from matplotlib.patches import Patch

    thinnest = np.min([curve.film_parameter for curve in shown], axis=0)
    handles: list[Artist] = []
    for film, limit in sorted(limits.items(), key=lambda item: -item[1]):
        below = thinnest < limit
        if np.any(below):
            axes.fill_between(
                100 * shown[0].slip,
                0.0,
                1.0,
                where=below.tolist(),
                transform=axes.get_xaxis_transform(),
                color=FILM_TINTS[film],
                linewidth=0.0,
                zorder=0,
            )
            handles.append(
                Patch(facecolor=FILM_TINTS[film], label=f"{film} film: smallest Λ < {limit:.3g}")
            )
    return handles
