"""Account of study raceway-friction: largest friction and forces of both raceways over the grid of speeds."""

from collections.abc import Mapping
from typing import Any, ClassVar, Final

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import RUN_STEADY_SLIP

#: Name and unit of the axes of the grid.
_SPANS: Final = {"rolling_speed": "m/s", "cage_ratio": "1", "slide_roll": "1"}


class RacewayFrictionAccount(Account):
    """Account of study raceway-friction."""

    units: ClassVar[Mapping[str, str]] = {
        "largest_friction": "1",
        "ring_force": "N",
        "ring_resistance": "N",
    } | _SPANS

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the largest friction of each ring, and the range of speeds."""
        largest = _largest(dataset, "largest_friction")
        rows = [
            Row(
                key=f"largest_friction_{ring}",
                label=f"{ring} ring",
                value=friction,
                text=f"{friction:.4g}",
                note="largest effective friction",
            )
            for ring, friction in largest.items()
        ]
        values = ", ".join(
            f"{friction:.3g} at the {ring} ring" for ring, friction in largest.items()
        )
        return Answer(
            summary=f"effective friction up to {values}", rows=tuple(rows), next=(RUN_STEADY_SLIP,)
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the range of the grid, and the largest friction, forces and resistances of each ring, by topic."""
        spans = []
        for name, unit in _SPANS.items():
            ends = dict.fromkeys(format_quantity(end, unit, 4) for end in _ends(dataset, name))
            spans.append(f"{name.replace('_', ' ')} {' to '.join(ends)}")
        sentences = {"speeds": [f"over {', '.join(spans)}"]}
        for ring, friction in _largest(dataset, "largest_friction").items():
            force, resistance = (
                format_quantity(_largest(dataset, name)[ring], "N", 4)
                for name in ("ring_force", "ring_resistance")
            )
            sentences[ring] = [
                f"{ring} ring: largest effective friction {friction:.4g}, forces up to {force}, resistance up to "
                f"{resistance}"
            ]
        return sentences

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the ends of the axes, and the largest values of each ring."""
        ends = {name: [*_ends(dataset, name)] for name in _SPANS}
        return ends | {
            name: _largest(dataset, name)
            for name in ("largest_friction", "ring_force", "ring_resistance")
        }


def _ends(dataset: "xr.Dataset", name: str) -> tuple[float, float]:
    """Return the smallest and the largest value of an axis."""
    return float(dataset[name].min()), float(dataset[name].max())


def _largest(dataset: "xr.Dataset", name: str) -> dict[str, float]:
    """Return the largest value of a variable for each ring."""
    return {str(ring): float(dataset[name].sel(ring=ring).max()) for ring in dataset["ring"].values}


ACCOUNT: Final = RacewayFrictionAccount("raceway-friction")
