"""The account of what both raceways do over all speeds of a motion."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import next_of_others

if TYPE_CHECKING:
    import xarray as xr

_SPANS = {"rolling_speed": "m/s", "cage_ratio": "1", "slide_roll": "1"}


class RacewayFrictionAccount(Account):
    """How friction of both raceways over a grid of speeds is told: what it goes over, and its largest value."""

    units: ClassVar[Mapping[str, str]] = {
        "largest_friction": "1",
        "ring_force": "N",
        "ring_resistance": "N",
    } | _SPANS

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return the largest friction of each ring, and that another study knows the slip of the cage."""
        rows = [Row(key=f"largest_friction_{ring}", label=f"{ring} ring", value=most, text=f"{most:.4g}",
                    note="largest effective friction") for ring, most in _largest(dataset).items()]  # fmt: skip
        return Answer(rows=tuple(rows), commands=next_of_others(dataset))

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what the grid goes over, and the largest friction, forces and resistances of each ring."""
        spans = []
        for name, unit in _SPANS.items():
            ends = dict.fromkeys(format_quantity(end, unit, 4) for end in _ends(dataset, name))
            spans.append(f"{name.replace('_', ' ')} {' to '.join(ends)}")
        found = {"speeds": [f"over {', '.join(spans)}"]}
        for ring, most in _largest(dataset).items():
            forces = (
                float(dataset[name].sel(ring=ring).max())
                for name in ("ring_force", "ring_resistance")
            )
            force, resists = (format_quantity(one, "N", 4) for one in forces)
            found[ring] = [
                f"{ring} ring: largest effective friction {most:.4g}, forces up to {force}, resistance up to {resists}"
            ]
        return found

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the ends of the grid, and the largest values of each ring."""
        largest = {name: {str(ring): float(dataset[name].sel(ring=ring).max()) for ring in dataset["ring"].values}
                   for name in ("largest_friction", "ring_force", "ring_resistance")}  # fmt: skip
        return {name: [*_ends(dataset, name)] for name in _SPANS} | largest


def _ends(dataset: "xr.Dataset", name: str) -> tuple[float, float]:
    return float(dataset[name].min()), float(dataset[name].max())


def _largest(dataset: "xr.Dataset") -> dict[str, float]:
    return {
        str(ring): float(dataset["largest_friction"].sel(ring=ring).max())
        for ring in dataset["ring"].values
    }


ACCOUNT: Final = RacewayFrictionAccount("raceway-friction")
