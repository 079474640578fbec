"""A study: the power that a bearing loses by sliding, ring by ring, against cage slip."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import attrs
import numpy as np
from numpy.typing import NDArray
from rollslip.bearing.assembly import Assembly
from rollslip.bearing.critical import slip_grid
from rollslip.bearing.raceway import RINGS
from rollslip.fields import at_least, in_range, parameter
from rollslip.hookspecs import hookimpl
from rollslip.studies.answers import Output, RunContext
from rollslip.studies.study import CONTACT_CHOICES, Study

if TYPE_CHECKING:
    from xarray import Dataset

Array = NDArray[np.float64]


@attrs.frozen(kw_only=True)
class SlidingPower(Study):
    """Power lost by sliding in the contacts of each ring, mean over the roller positions of a pitch, against cage slip.

    P(S_c) = (1/M) sum(|mu_s V| Q_s) over the loaded slices s of all rollers at M positions [-], rollers at their
    epicyclic spin, with

    - mu_s friction coefficient of a slice [-], after the models of the scene,
    - V sliding speed of the ring's contacts [m/s],
    - Q_s normal force of a slice [N].

    The references below are those of the friction models; the sum is a definition.

    Range: any load that loads the inner ring; cage slips at which every contact draws oil in.
    """

    name: ClassVar[str] = "sliding-power"
    outputs: ClassVar[Mapping[str, Output]] = MappingProxyType(
        {
            "sliding_power": Output("ring cage_slip", "W", "power lost by sliding"),
            "largest_power": Output("ring", "W", "power lost by sliding at the largest cage slip", default=True),
        }
    )
    #: Its error is kept below accuracy.friction: slices and positions are doubled until it changes by less.
    controlled_outputs: ClassVar[Mapping[str, str]] = MappingProxyType({"friction": "sliding_power"})
    affected_by: ClassVar[frozenset[str]] = CONTACT_CHOICES | {"n_positions"}
    max_cage_slip: float = parameter(
        default=0.3, unit="1", doc="largest cage slip", validator=in_range(0.0, 1.0, open=True)
    )
    points: int = parameter(default=31, doc="cage slips, denser towards zero", validator=at_least(2))

    def run(self, assembly: Assembly, context: RunContext | None = None) -> "Dataset":
        """Return the power.

        Raises
        ------
        DomainError
            If a law has no value at a slip of the range.
        """
        from xarray import Dataset  # takes longer to import than most studies to run

        slip = slip_grid(self.max_cage_slip, self.points)
        n_positions = assembly.resolution.n_positions or 2
        loads = assembly.load_distribution(n_positions)
        power = np.zeros((len(RINGS), slip.size))
        speeds = assembly.kinematics.surface_speeds(slip, np.zeros_like(slip))
        rings = (
            (loads.inner_load, speeds.inner_rolling, speeds.inner_sliding),
            (loads.outer_load, speeds.outer_rolling, speeds.outer_sliding),
        )
        for k, (load, rolling, sliding) in enumerate(rings):
            # (positions, rollers, slices)
            force = load * assembly.widths
            loaded = load > 0.0
            for n in range(slip.size):
                slices = assembly.raceways[k].evaluate(load[loaded], rolling[n], sliding[n])
                power[k, n] = float(np.abs(slices.friction * sliding[n]) @ force[loaded]) / n_positions
        coords = {
            "ring": ("ring", np.array(RINGS), {"units": "1", "long_name": "ring"}),
            "cage_slip": ("cage_slip", slip, {"units": "1", "long_name": "cage slip"}),
        }
        variables = self.variables(sliding_power=power, largest_power=power[:, -1])
        return Dataset(
            variables, coords, attrs=self.attributes | {"n_positions": n_positions, "slices": assembly.slices}
        )


@hookimpl
def studies() -> list[type[Study]]:
    """Offer the study."""
    return [SlidingPower]
