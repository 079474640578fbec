"""Row and sentences on friction torque and losses, from the dataset alone, compared with formulas of makers."""

import json
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rollslip.results.answer import Row
from rollslip.results.text import format_power, two_digits
from rollslip.results.text import precise_percent as _percent
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

#: Factor from the formulas of makers beyond which a friction torque is reported as doubtful. Thermal reference speeds
#: of makers correspond to torques that differ by 1.7 to 2.4 among each other, so that half of it would doubt every
#: result.
_DOUBTFUL_FACTOR: Final = 2.0
#: Mean diameter times revolutions, n d_m [m/s], below which a torque is not compared with the formulas: 300,000 mm/min.
#: Twice as much leaves out medium speeds, too. Chosen: below, the weight of the rollers and mixed friction, which
#: losses leave out, are no longer small.
_MIN_COMPARED_SPEED: Final = 5.0
#: Sources of loss in a sentence, at most, the largest first; chosen for its length.
_MAX_SOURCES: Final = 4


def torque_row(dataset: "xr.Dataset", state: "xr.Dataset", rank: int) -> Row | None:
    """Return the row of the friction torque at a steady slip, with its band; None where it is not known."""
    if "loss" not in state or not math.isfinite(torque := float(state["friction_torque"])):
        return None
    factor, unit = (1e3, "mN m") if torque < 0.1 else (1.0, "N m")
    sizes = [torque]
    rings = ""
    if "ring_torque" in state and state["ring_power"].all():  # both rings turn
        sizes = np.abs(state["ring_torque"].to_numpy()).tolist()
        rings = "of inner and outer ring"
    stored = json.loads(dataset.attrs.get("band", "{}")).get("friction_torque")
    band = None if stored is None else (stored["low"], stored["high"])
    bounds = ""
    if band and not rings:
        bounds = " to ".join(two_digits(factor * bound) for bound in band)
    notes = [
        bounds,
        rings,
        _describe_doubt(dataset),
        f"{format_power(float(state['loss'].sum()))} of heat",
    ]
    return Row(
        key="friction_torque",
        label="friction torque",
        value=torque,
        unit="N m",
        text=f"{' and '.join(two_digits(factor * size) for size in sizes)} {unit}",
        band=band,
        note="; ".join(filter(None, notes)),
        rank=rank,
    )


def losses_record(state: "xr.Dataset") -> dict[str, Any]:
    """Return losses by source and friction torque of one steady slip; empty for a result without losses."""
    if "loss" not in state:
        return {}
    sources = map(str, state["source"].to_numpy())
    losses = dict(zip(sources, state["loss"].to_numpy().tolist(), strict=True))
    return {"friction_torque": float(state["friction_torque"]), "losses": losses}


def describe_losses(dataset: "xr.Dataset") -> list[str]:
    """Return the losses at each stable steady slip, the largest sources first, and a comparison with formulas."""
    sentences = []
    for k in np.flatnonzero(dataset["stable"].to_numpy() == 1):
        state = dataset.isel(steady=int(k))
        losses = state["loss"].to_numpy()
        total = float(losses.sum())
        if not total > 0.0:
            continue
        order = np.argsort(-losses, kind="stable")[:_MAX_SOURCES]
        fractions = ", ".join(
            f"{_percent(losses[n] / total)} {state['source'].to_numpy()[n]}"
            for n in order
            if losses[n] > 0
        )
        sentences.append(
            f"at a cage slip of {_percent(float(state['steady_slip']))} the bearing turns "
            f"{format_quantity(total, 'W', 3)} into heat, a friction torque of "
            f"{format_quantity(float(state['friction_torque']), 'N m', 3)}"
            f"{_describe_ratio(dataset, state)}: {fractions}"
        )
    return sentences + _explain_doubt(dataset) + _describe_formulas(dataset)


def _ratio_to_formulas(dataset: "xr.Dataset", state: "xr.Dataset | None" = None) -> float:
    """Return the friction torque at a steady slip, by default the smallest stable one, over the formulas' mean.

    The mean is the geometric one of the formulas that have a torque. The ratio is NaN without them. The torque is that
    without losses beside the rollers, which formulas do not cover.
    """
    if "formula_torque" not in dataset:
        return math.nan
    lasting = np.flatnonzero(dataset["stable"].to_numpy() == 1)
    if state is None and lasting.size:
        state = dataset.isel(steady=int(lasting[0]))
    known = dataset["formula_torque"].to_numpy()
    known = known[np.isfinite(known) & (known > 0.0)]
    own = math.nan if state is None else float(state["friction_torque"])
    if state is not None and "external_torque" in state:
        own -= float(state["external_torque"])
    return own / float(np.exp(np.log(known).mean())) if known.size and own > 0.0 else math.nan


def _describe_ratio(dataset: "xr.Dataset", state: "xr.Dataset") -> str:
    """Return the ratio of the friction torque at a steady slip to the formulas of makers; empty without them."""
    if math.isnan(ratio := _ratio_to_formulas(dataset, state)):
        return ""
    covered = "without the losses of models.loss " * ("external_torque" in state)
    return f", {covered}{ratio:.2g} times what makers' formulas give"


def _is_slow(dataset: "xr.Dataset") -> bool:
    """Whether the bearing is too slow for a comparison with formulas."""
    return "formula_speed" in dataset and float(dataset["formula_speed"]) < _MIN_COMPARED_SPEED


def _is_far(ratio: float) -> bool:
    """Whether a ratio to the formulas of makers is far from 1; one that is not known is not."""
    return ratio < 1.0 / _DOUBTFUL_FACTOR or ratio > _DOUBTFUL_FACTOR


def _describe_doubt(dataset: "xr.Dataset") -> str:
    """Return the ratio of the friction torque to the formulas of makers; empty where it is not doubtful.

    It has a mark where the bearing is so slow that losses leave out what is not small there.
    """
    ratio = _ratio_to_formulas(dataset)
    mark = ", outside the model's range" * _is_slow(dataset)
    return f"{ratio:.2g} x makers' formulas{mark}" * _is_far(ratio)


def _explain_doubt(dataset: "xr.Dataset") -> list[str]:
    """Return likely causes of a doubtful friction torque and the sources of the formulas, or why none is compared."""
    ratio = _ratio_to_formulas(dataset)
    if math.isnan(ratio) or "formula_basis" not in dataset:
        return []
    if _is_slow(dataset):
        n_dm = format_quantity(float(dataset["formula_speed"]), "m/s", 3, "mm/min")
        return [
            f"at n d_m of {n_dm}, below {6e4 * _MIN_COMPARED_SPEED:.0f}, the torque is not comparable with makers' "
            "formulas: it lacks the weight of the rollers and most of the mixed friction"
        ]
    if not _is_far(ratio):
        return []
    why = (
        "a drag is missing or too small, and slip and torque are lower bounds: see cage.drag"
        if ratio < 1.0
        else "a drag may stand twice in the scene, or viscosity, level or supply of the oil are not the bearing's"
    )
    what = "; ".join(
        f"{name!s} is {basis}"
        for name, basis in zip(
            dataset["formula"].to_numpy(), dataset["formula_basis"].to_numpy(), strict=True
        )
        if basis
    )
    return [
        f"so far from makers' formulas {why} ({what}; thermal reference "
        "speeds that makers print stand for torques that differ by a factor of 1.7 to 2.4, and none of these is a "
        "measured torque of one bearing)"
    ]


def _describe_formulas(dataset: "xr.Dataset") -> list[str]:
    """Return the torque by each formula of the scene with its terms, or what the formula lacks."""
    if "formula_torque" not in dataset:
        return []
    parts = [str(part).partition(": ") for part in dataset["formula_part"].to_numpy()]
    sentences = []
    for name, torque, status in zip(
        dataset["formula"].to_numpy(),
        dataset["formula_torque"].to_numpy(),
        dataset["formula_status"].to_numpy(),
        strict=True,
    ):
        if math.isnan(torque):
            sentences.append(f"no friction torque by formula {str(name)!r}: it {status}")
            continue
        fractions = ", ".join(
            f"{_percent(value / torque if torque else 0.0)} {term}"
            for (formula, _, term), value in zip(
                parts, dataset["formula_term"].to_numpy(), strict=True
            )
            if formula == name
        )
        sentences.append(
            f"by formula {str(name)!r} the friction torque is "
            f"{format_quantity(float(torque), 'N m', 3)}: {fractions}; it "
            f"includes no slip and no other drag{', nor models.loss' * ('external_torque' in dataset)}"
        )
    if "formula_estimated" in dataset and (names := str(dataset["formula_estimated"].item())):
        sentences.append(
            f"for these formulas {names} of the bearing are estimated from its rollers: name the bearing, or "
            "give bearing.catalogue"
        )
    return sentences
