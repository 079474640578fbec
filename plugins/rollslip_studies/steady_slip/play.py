"""Answers of study steady-slip for rollers with play in their pockets, beside those of rollers set in the cage.

A roller with play crosses its pocket before it drives the cage (`motion.pockets`), so that rollers carry a drag at a
larger slip. Forces and losses are still those of rollers set in the cage at the slip at which these carry the drag.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from typing import Any, Final

import attrs
import numpy as np

from rollslip.bearing.raceway import Array
from rollslip.errors import ConvergenceError, DomainError
from rollslip.results.text import Status
from rollslip_studies.motion.pockets import (
    BalanceWithPlay,
    SlipWithPlay,
    balance_with_play,
    reason_without_play,
    relative_play,
    steady_slip_with_play,
)
from rollslip_studies.motion.torque_balance import Running, SkiddingOnset, TorqueBalance
from rollslip_studies.steady_slip.losses import acceptable_reserve
from rollslip_studies.steady_slip.minimum_load import load_from_known
from rollslip_studies.steady_slip.outputs import OUTPUTS

#: Relative play below which a run leaves the play out. There it changes slips of four bearings by less than 0.5 %, at
#: twice the value by up to 1.5 %; chosen, below the tolerance of results.
_NEGLIGIBLE_PLAY: Final = 0.01
#: Slips at which the limit drag torque with play is sought, over that without play. With play the maximum lies at the
#: same or at a slightly larger slip; twice as many slips change it by less than 1e-3.
_NEAR_MAXIMUM: Final = np.geomspace(1.0, 1.6, 8)


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
        self._slip = slip
        self._max_slip = max_slip
        self.balance: BalanceWithPlay | None = None
        self.reason = reason_without_play(balance)
        slips = [value for value in (slip, acceptable) if value is not None and value > 0.0]
        if not self.reason and slips and relative_play(balance, min(slips)) < _NEGLIGIBLE_PLAY:
            self.reason = "the play changes the slip by less than 1 %"
        if not self.reason:
            self.balance, self.reason = balance_with_play(balance)

    @cached_property
    def found(self) -> SlipWithPlay:
        """The smallest steady slip with play, or why there is none."""
        if self.balance is None:
            return SlipWithPlay(self.reason)
        return steady_slip_with_play(self.balance, self._slip, self._max_slip)

    @property
    def is_found(self) -> bool:
        """Whether there is a slip with play."""
        return self.found.status == Status.FOUND

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
            return []
        return [self.found.slip, *without[1:]] if self.is_found else without

    def variables(self, cage_slip: Array, torque: Array) -> dict[str, Any]:
        """Return the variables of the motion with play, and of the slip-drag curve with and without it.

        Parameters
        ----------
        cage_slip : ndarray
            Cage slips of the curve, (n,).
        torque : ndarray
            Torques of rollers set in the cage there [N m], (n,).
        """
        found = self.found
        values = {
            "driving_fraction": found.driving,
            "crossing_fraction": found.crossing,
            "pushed_fraction": found.pushed,
            "play_status": found.status,
            "slip_without_play": self._slip if self.is_found else math.nan,
            "driving_torque_without_play": torque,
        }
        if self.balance is not None:
            values["driving_torque"] = self.balance.torques(cage_slip, torque)
        return _variables(values)

    def running(self, runs: Running) -> Running:
        """Return where the cage runs with play, from where it runs without.

        Parameters
        ----------
        runs : Running
            Where a cage runs in which rollers are set.
        """
        if self._skids:
            return Running(math.nan, math.nan, self.found.status)
        if self.balance is None or not self.is_found:
            return runs
        slip = self.found.slip
        return attrs.evolve(runs, slip=slip, drag=-self.balance.drag(slip))

    def skidding_onset(self, onset: SkiddingOnset) -> SkiddingOnset:
        """Return where skidding begins with play, from where it begins without.

        Parameters
        ----------
        onset : SkiddingOnset
            Of rollers set in the cage.
        """
        if self.balance is None or math.isnan(onset.slip):
            return onset
        slips = onset.slip * _NEAR_MAXIMUM
        slips = slips[slips < 1.0]
        torques = self.balance.torques(slips)
        without = float(self.balance.balance.torques(slips[:1])[0])
        largest = int(np.argmax(torques))
        return attrs.evolve(
            onset,
            slip=float(slips[largest]),
            drag=onset.drag * min(float(torques[largest]) / without, 1.0),
        )

    def acceptable_reserve(self, factor: float, status: str, slip: float) -> tuple[float, str]:
        """Return the reserve at an acceptable slip with play, and its status, from those without.

        Parameters
        ----------
        factor : float
            Reserve of rollers set in the cage.
        status : str
            Its status.
        slip : float
            Acceptable cage slip.
        """
        return (factor, status) if self.balance is None else acceptable_reserve(self.balance, slip)

    def minimum_load(
        self,
        balance: Callable[[float], TorqueBalance],
        known: float,
        slips: Sequence[float],
        slip: float,
    ) -> float:
        """Return the minimum load with play [N], from that without, which it is where that is not known.

        Parameters
        ----------
        balance : callable
            Torque balance of the bearing at a radial load [N], its rollers set in the cage.
        known : float
            Minimum load without play [N].
        slips : sequence of float
            Cage slips at which it was evaluated.
        slip : float
            Acceptable cage slip.
        """
        if self.balance is None or not known > 0.0:
            return known
        bearing = self.balance.balance.assembly
        if known > bearing.scene.operation.radial_load:
            bearing = balance(known).assembly

        def at_load(load: float) -> BalanceWithPlay:
            found, reason = balance_with_play(balance(load), bearing)
            if found is None:
                raise ConvergenceError(reason)
            return found

        found = math.nan
        with suppress(ConvergenceError, DomainError):
            found = load_from_known(at_load, known, slips, slip)
        return known if math.isnan(found) else found


def _variables(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return values as variables by the same names."""
    return {name: OUTPUTS[name].variable(value) for name, value in values.items()}
