"""Compute the first samples as a whole, and emulate the others from torques of their rollers at a few cage slips."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final

import attrs
import numpy as np

from rollslip.results.dataset import about, xr
from rollslip.results.verdict import SKIDDING_SLIP
from rollslip.search import Array
from rollslip_campaigns.uncertainty.emulator import Basis, scales
from rollslip_campaigns.uncertainty.estimators import Estimate, estimate_variables, fraction
from rollslip_campaigns.uncertainty.findings import RESERVE, SKIDDING, STEADY
from rollslip_campaigns.uncertainty.samples import (
    basis_of,
    classify_reserves,
    emulated_samples,
    friction_samples,
)

__all__ = [
    "TORQUES",
    "WHOLE_SAMPLES",
    "EmulatedSamples",
    "emulate_samples",
    "equivalent_samples",
    "is_worthwhile",
    "probability_variables",
]

#: Numbers of samples that are computed as a whole before the others are emulated; a larger one follows where the error
#: is too large. Twice as many cost as much as 200 more samples. Chosen: 32 leave errors of 2 % of the deviation.
WHOLE_SAMPLES: Final = (32, 64)
#: Smallest number of samples, relative to those that are computed as a whole, which is worth emulating. Chosen: of
#: 128 samples of gearbox with 64 minimum loads it saves 14 % of the time, and the intervals contain one more error.
_MIN_RATIO: Final = 16
#: Time of an emulated sample, relative to one that is computed as a whole; 0.1 to 0.2 of five bearings
#: (docs/tables/sample_emulator.csv).
_EMULATED_TIME: Final = 0.15
#: Variables of study effective-friction from which samples are emulated.
TORQUES: Final = ("driving_torque", "drag_torque")


def is_worthwhile(samples: int | None) -> bool:
    """Return whether a requested number of samples is large enough to emulate most of them; None is not."""
    return samples is not None and samples >= _MIN_RATIO * WHOLE_SAMPLES[0]


def equivalent_samples(samples: int) -> float:
    """Return the number of samples computed as a whole that takes as long as a number of mostly emulated ones."""
    return WHOLE_SAMPLES[0] + _EMULATED_TIME * (samples - WHOLE_SAMPLES[0])


@attrs.frozen(eq=False, kw_only=True)
class EmulatedSamples:
    """Samples of which most are emulated.

    Attributes
    ----------
    critical : Dataset
        Points that are computed as a whole, the first samples.
    torques : Dataset
        Points of the other samples.
    basis : Basis
        Basis of the loading branches.
    values : dict of str to ndarray
        Slips and reserves of all samples, (N,), of rollers set in the cage.
    """

    critical: "xr.Dataset"
    torques: "xr.Dataset"
    basis: Basis
    values: dict[str, Array]

    @property
    def description(self) -> str:
        """How many samples are computed as a whole, and the error of the others."""
        return (
            f"{self.critical.sizes['sample']} of {self.values[STEADY].size} samples computed as a whole, the others by "
            f"torques at {self.basis.torque_slips.size} slips (error "
            f"{100.0 * self.basis.relative_error:.2g} % of the deviation; --plain: all)"
        )

    def widen(self, name: str, estimate: Estimate) -> Estimate:
        """Return a quantile of a quantity, whose interval includes the error of emulated samples.

        Parameters
        ----------
        name : str
            Name of the quantity.
        estimate : Estimate
            The quantile with its interval by the number of samples.
        """
        if name not in self.values or math.isnan(estimate.value):
            return estimate
        k = (STEADY, RESERVE).index(name)
        return scales()[k].widen(estimate, self.basis.errors[k])


def emulate_samples(
    total: int,
    compute_whole: Callable[[int], "xr.Dataset"],
    compute_torques: Callable[[Array, range], "xr.Dataset"],
) -> EmulatedSamples | None:
    """Return all samples, most of them emulated; None if that is not accurate.

    Parameters
    ----------
    total : int
        Number of samples.
    compute_whole : callable
        Computes a number of samples as a whole.
    compute_torques : callable
        Computes the torques at cage slips of samples with some numbers.
    """
    for whole in WHOLE_SAMPLES:
        if total < _MIN_RATIO * whole:
            break
        critical = compute_whole(whole)
        if (basis := basis_of(critical)) is None:
            continue
        torques = compute_torques(basis.torque_slips, range(whole, total))
        if "driving_torque" not in torques:  # all of them failed
            break
        known = friction_samples(critical)
        others = emulated_samples(basis, torques)
        return EmulatedSamples(
            critical=critical,
            torques=torques,
            basis=basis,
            values={name: np.concatenate([known[name], others[name]]) for name in others},
        )
    return None


def probability_variables(
    critical: "xr.Dataset",
    values: Mapping[str, Array],
    emulated: EmulatedSamples | None,
    confidence: float,
) -> dict[str, Any]:
    """Return the margin, the probability of skidding, and the number of reserves that are lower bounds, as variables.

    Parameters
    ----------
    critical : Dataset
        Points of the n samples that are computed as a whole.
    values : mapping of str to ndarray
        Their slips, (n,) each, with play in the pockets.
    emulated : EmulatedSamples or None
        All samples, if most are emulated; they count for the probability of skidding.
    confidence : float
        Confidence of the intervals.
    """
    slip = values[STEADY]
    skidding_slip = values[SKIDDING]
    n = slip.size
    counts = {name: int(mask.sum()) for name, mask in classify_reserves(critical).items()}
    total = n
    if emulated is not None:
        others = {name: samples[n:] for name, samples in emulated.values.items()}
        skids = (others[RESERVE] < 1.0) | (others[STEADY] > SKIDDING_SLIP)
        counts["skids"] += int(skids.sum())
        counts["bound"] += int(np.isinf(others[RESERVE]).sum())
        counts["unknown"] += int(np.isnan(others[RESERVE]).sum())
        total = emulated.values[STEADY].size
    known = ~np.isnan(slip) & ~np.isnan(skidding_slip)
    return {
        **estimate_variables(
            "margin",
            fraction(int((slip < skidding_slip)[known].sum()), int((~known).sum()), n, confidence),
            "probability that the steady slip is below that at which skidding begins",
        ),
        **estimate_variables(
            "skidding",
            fraction(counts["skids"], counts["unknown"], total, confidence),
            "probability that the cage has no balance of torques",
        ),
        "bounded": (
            (),
            counts["bound"],
            about("1", "samples of which the reserve is a lower bound"),
        ),
    }
