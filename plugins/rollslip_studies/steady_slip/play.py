"""Answers of study steady-slip for rollers with play in their pockets, beside those of rollers set in the cage.

A roller with play crosses its pocket before it drives the cage (`motion.pockets`), so that rollers carry a drag at a
larger slip. Forces and losses are those of rollers set in the cage at the slip at which these carry the drag: the mean
torque of a roller is the same there.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.dataset import about
from rollslip.results.text import Status
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip_studies.motion.pockets import (
    NEGLIGIBLE_PLAY,
    NO_CHANGE,
    BalanceWithPlay,
    SlipWithPlay,
    balance_with_play,
    reason_without_play,
    relative_play,
    steady_slip_with_play,
)
from rollslip_studies.motion.torque_balance import TorqueBalance, acceptable_reserve, largest_ratio
from rollslip_studies.steady_slip.minimum_load import load_from_known
from rollslip_studies.steady_slip.outputs import OUTPUTS
from rollslip_studies.steady_slip.play_findings import WITHOUT_PLAY

if TYPE_CHECKING:
    import xarray as xr

#: Slips at which the limit drag torque with play is sought, over that without play: the play takes the maximum to
#: larger slips, by a factor of 1.4 where it lowers it by 5 %. Twice as many slips change it by up to 2.5e-3; chosen.
_NEAR_MAXIMUM: Final = np.geomspace(1.0, 2.5, 12)
#: Relative error of torques by tables of friction, which may be above those without play. It is 1e-3 at the largest
#: slips of `gearbox`. Twice as much takes a slip or two more into the search of a reserve; chosen.
_TABLE_ERROR: Final = 0.01
#: Steps of a turn of a roller to a stored one: 400 are enough for a figure. Half as many store twice the numbers; the
#: steps of the march are a multiple. Chosen.
_STORED: Final = 5
#: Largest minimum load, relative to the load of the bearing, at which the tables of friction of that serve: they reach
#: to 1.5 times the largest force of its rollers, and with play a minimum load is up to a fifth larger. A smaller one
#: builds tables anew for more bearings, which takes as long as all else that the play takes. Chosen.
_SHARED_LOAD: Final = 1.2


class Play:
    """Play in the pockets of a bearing, and the answers that depend on it.

    Parameters
    ----------
    balance : TorqueBalance
        Of the bearing, its rollers set in the cage.
    slip : float
        Its smallest steady cage slip; NaN without one.
    acceptable : float or None
        Acceptable cage slip.
    max_slip : float
        Largest cage slip of a search.
    """

    def __init__(
        self, balance: TorqueBalance, slip: float, acceptable: float | None, max_slip: float
    ) -> None:
        self.set_balance = balance
        self._slip = slip
        self._acceptable = acceptable
        self._max_slip = max_slip
        self._balance: BalanceWithPlay | None = None
        self._reason = reason_without_play(balance)
        slips = [value for value in (slip, acceptable) if value is not None]
        if not self._reason and slips and all(map(self._is_negligible, slips)):
            self._reason = NO_CHANGE
        if not self._reason:
            self._balance, self._reason = balance_with_play(balance)

    def _is_negligible(self, slip: float) -> bool:
        """Whether the play changes a slip by less than 1 %."""
        return slip > 0.0 and relative_play(self.set_balance, slip) < NEGLIGIBLE_PLAY

    @cached_property
    def found(self) -> SlipWithPlay:
        """The smallest steady slip with play, or why there is none."""
        if self._balance is None:
            return SlipWithPlay(self._reason)
        if self._is_negligible(self._slip):
            return SlipWithPlay(NO_CHANGE)
        found = steady_slip_with_play(self._balance, self._slip, self._max_slip)
        # where rollers never leave the bar that they drive, only tables of friction change the slip
        return (
            SlipWithPlay("the play does not add to the slip")
            if abs(found.slip) <= abs(self._slip)
            else found
        )

    @property
    def _skids(self) -> bool:
        """Whether the cage has no steady slip because of the play."""
        return Status.of(self.found.status) is Status.NO_STEADY_SLIP

    @property
    def status(self) -> str:
        """Why there is no steady slip because of the play; empty if there is one, or if there is none without play."""
        return f"{self.found.status} with play in the pockets: {Status.SKIDS}" * self._skids

    def slips(self, without: list[float]) -> list[float]:
        """Return the steady slips with play, as far as it is known, from those without; larger ones do not change.

        Parameters
        ----------
        without : list of float
            Steady slips of rollers set in the cage, ascending.
        """
        if self._skids:
            return [math.nan] * len(without)
        is_found = self.found.status == Status.FOUND
        return [self.found.slip, *without[1:]] if is_found else without

    def completed(
        self,
        dataset: "xr.Dataset",
        at_load: Callable[[float], TorqueBalance],
        has_curve: bool = True,
    ) -> "xr.Dataset":
        """Return a result with the answers with play, and with those without it under names of their own.

        Parameters
        ----------
        dataset : Dataset
            Result of rollers set in the cage.
        at_load : callable
            Torque balance of these at a radial load [N].
        has_curve : bool
            Whether the driving torque with play is computed at all slips; otherwise the result has none.
        """
        found = self.found
        values = {
            "driving_fraction": found.driving,
            "crossing_fraction": found.crossing,
            "pushed_fraction": found.pushed,
            "play_status": found.status,
            "slip_without_play": self._slip,
        }
        for name in ("driving_torque", "limit_drag", "acceptable_reserve", "minimum_load"):
            if name in dataset:
                values[f"{name}_without_play"] = dataset[name].to_numpy()
        variables = {name: OUTPUTS[name].variable(value) for name, value in values.items()}
        if self._balance is None:
            return dataset.assign(variables)
        torques = None
        values = {}
        if has_curve:
            torques = self._balance.torques(
                dataset["cage_slip"].to_numpy(), dataset["driving_torque"].to_numpy()
            )
            values["driving_torque"] = torques
        coords: dict[str, Any] = {}
        if self._skids or found.status == Status.FOUND:
            values |= self._steady(dataset)
        if has_curve and found.status == Status.FOUND:
            orbit = self._balance.pockets.orbit(found.slip)
            force = orbit.torque / self.set_balance.assembly.kinematics.orbit_radius
            values["pocket_position"] = orbit.position[_STORED - 1 :: _STORED]
            values["pocket_force"] = force.reshape(-1, _STORED).mean(axis=1)
            coords["pocket_angle"] = (
                "pocket_angle",
                orbit.angle[_STORED - 1 :: _STORED],
                about("rad", "position from the line of load, in the sense of the orbit"),
            )
        if math.isfinite(float(dataset["skidding_slip"])):
            dataset = dataset.assign(self._limit_drag(self._balance, dataset))
        values |= self._reserve(self._balance, dataset, torques)
        if self._acceptable is not None:
            factor, status = acceptable_reserve(self._balance, self._acceptable)
            values |= {"acceptable_reserve": factor, "acceptable_reserve_status": status}
            load = dataset["minimum_load"]
            load_status = str(dataset["minimum_load_status"].item())
            variables |= self.minimum_load(float(load), load_status, load.attrs, at_load)
        if not has_curve:
            dataset = dataset.drop_vars("driving_torque")
        return dataset.assign_coords(coords).assign(
            variables | {name: OUTPUTS[name].variable(value) for name, value in values.items()}
        )

    def _steady(self, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the values of the steady slips; NaN where the cage skids."""
        values: dict[str, Any] = {}
        if self._skids:
            values = {
                str(name): np.full_like(variable.to_numpy(), np.nan)
                for name, variable in dataset.items()
                if "steady" in variable.dims and variable.dtype.kind == "f"
            }
            steady = dataset["stability"].to_numpy()
            values["stable"] = np.zeros(steady.size, np.int8)
            values["stability"] = np.full(steady.size, "no steady slip")
            values["status"] = self.status
            return values
        slips = self.slips(dataset["steady_slip"].to_numpy().tolist())
        speed = self.set_balance.assembly.kinematics.direction
        return {
            "steady_slip": np.array(slips),
            "cage_speed": np.array([speed * self.set_balance.cage_speed(slip) for slip in slips]),
            "torque": np.array([0.0 - self.set_balance.drag(slip) for slip in slips]),
        }

    def _limit_drag(self, balance: BalanceWithPlay, dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the limit drag torque, its slip and the slip after the jump, of a cage that skids in the range."""
        without_slip = float(dataset["skidding_slip"])
        without = float(self.set_balance.torques(np.array([without_slip]))[0])
        largest = -1
        slips = np.array([without_slip])
        while slips[largest] == slips[-1] < self._max_slip:  # the torque still rises
            slips = np.minimum(slips[-1] * _NEAR_MAXIMUM, self._max_slip)
            torques = balance.torques(slips)
            largest = int(np.nanargmax(torques))
        shift = float(slips[largest]) / without_slip
        factors = {
            "limit_drag": min(float(torques[largest]) / without, 1.0),
            "skidding_slip": shift,
            "limit_drag_low": shift,
            "limit_drag_high": shift,
            "jump_slip": 1.0 if float(dataset["jump_slip"]) > slips[largest] else math.nan,
        }
        return {
            name: dataset[name].copy(data=factor * dataset[name])
            for name, factor in factors.items()
        }

    def _reserve(
        self, balance: BalanceWithPlay, dataset: "xr.Dataset", torques: Array | None
    ) -> dict[str, Any]:
        """Return the drag reserve to skidding, and its status where the cage skids because of the play.

        Without torques with play at all slips they are computed near the largest ratio.
        """
        factor = float(dataset["drag_reserve"])
        if not math.isfinite(factor):
            return {"drag_reserve": factor}
        onset = float(dataset["skidding_slip"])
        limit = SKIDDING_SLIP if math.isnan(onset) else min(SKIDDING_SLIP, onset)
        slips = dataset["cage_slip"].to_numpy()
        if torques is None:
            slips, torques = self._near_largest_ratio(
                balance, slips, dataset["driving_torque"].to_numpy(), limit
            )
        largest, _ = largest_ratio(balance, slips, torques, limit)
        if self._skids:
            status = f"{Status.SKIDS}: its drags, or the rolling resistance, are more than the rollers carry"
            return {"drag_reserve": min(largest, 1.0), "reserve_status": status}
        return {"drag_reserve": max(largest, 1.0) if factor >= 1.0 else min(largest, 1.0)}

    def _near_largest_ratio(
        self, balance: BalanceWithPlay, slips: Array, without: Array, limit: float
    ) -> tuple[Array, Array]:
        """Return slips and torques with play of the part of a curve in which the ratio of torque and drags is largest.

        The play does not raise a torque that drives the cage, beyond the error of tables of friction. So the ratio
        with play is nowhere larger than without, and the largest one is among the slips at which the ratio without
        play is at least that with play at the slip where the former is largest. The neighbours and the last slip,
        which `largest_ratio` takes, are added.
        """
        drags = np.array([-self.set_balance.drag(slip) for slip in slips.tolist()])
        is_inside = (slips > 0.0) & (slips < limit) & (without > 0.0) & (drags > 0.0)
        if not is_inside.any():
            return slips[-1:], np.full(1, np.nan)
        ratios = np.where(is_inside, without, 0.0) / np.where(is_inside, drags, 1.0)
        first = [int(ratios.argmax())]
        known = balance.torques(slips[first], without[first])[0] / drags[first[0]]
        smallest = (1.0 - _TABLE_ERROR) * min(known, ratios[first[0]])
        chosen = np.flatnonzero(is_inside & ~(ratios < smallest))
        near = slice(max(int(chosen[0]) - 1, 0), int(chosen[-1]) + 2)
        torques = balance.torques(slips[near], without[near])
        return np.append(slips[near], slips[-1]), np.append(torques, np.nan)

    def minimum_load(
        self,
        known: float,
        status: str,
        attributes: Mapping[str, Any],
        at_load: Callable[[float], TorqueBalance],
    ) -> dict[str, Any]:
        """Return the variable of the minimum load with play, or its status where it is not known; empty without play.

        Parameters
        ----------
        known : float
            Minimum load of rollers set in the cage [N].
        status : str
            Its status.
        attributes : mapping
            Attributes of its variable, with the slips at which it was evaluated.
        at_load : callable
            Torque balance of rollers set in the cage at a radial load [N].
        """
        if self._balance is None or self._acceptable is None or not known > 0.0:
            return {}
        bearing = self.set_balance.assembly
        if known > _SHARED_LOAD * bearing.scene.operation.radial_load:
            bearing = at_load(known).assembly

        @lru_cache(maxsize=1)
        def with_play(load: float) -> BalanceWithPlay:
            balance, reason = balance_with_play(at_load(load), bearing)
            if balance is None:
                raise ConvergenceError(reason)
            return balance

        slips = np.atleast_1d(attributes["slips"]).tolist()
        with suppress(ConvergenceError, DomainError):
            load = load_from_known(with_play, known, slips, self._acceptable)
            if load > 0.0:
                dims, load, own = OUTPUTS["minimum_load"].variable(load)
                return {"minimum_load": (dims, load, {**attributes, **own})}
        output = OUTPUTS["minimum_load_status"]
        return {"minimum_load_status": output.variable(f"{status}, {WITHOUT_PLAY}")}
