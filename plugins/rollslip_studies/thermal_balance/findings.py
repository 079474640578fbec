"""The account of a thermal balance: answer, single values as a record, and sentences, from the dataset alone."""

import json
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.dataset import xr
from rollslip.results.text import Status, describe_estimated, format_power, percent
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import RUN_STEADY_SLIP
from rollslip_studies.steady_slip.play_findings import steady_play_note

#: Command for temperatures that follow from the losses.
_NEXT_OF_GIVEN: Final = "rollslip run {scene} --study thermal-balance --set models.thermal=network"
#: Command for the curve of excess heat, which shows why there is no balance.
_NEXT_WITHOUT_BALANCE: Final = "rollslip run {scene} --study thermal-balance --report"
#: Status of a course over time that reached its duration.
COURSE_COMPLETE: Final = "the time is over"
#: Text of the variable ``jumps`` where the excess heat has none.
NO_JUMPS: Final = "none"
#: Difference of the oil to the temperature of the scene from which the answer says that others warm or cool it [K].
#: Chosen: a viscosity changes by a third to a half over it. Twice as much leaves a factor of two unsaid.
_OTHERS: Final = 10.0
#: Part of a bearing -> the key of a scene with its temperature.
_KEYS = {
    "oil": "operation.temperature",
    "inner ring": "operation.inner_ring_temperature",
    "rollers": "operation.roller_temperature",
    "outer ring": "operation.outer_ring_temperature",
}


def solved(dataset: "xr.Dataset") -> bool:
    """Return whether temperatures follow from losses."""
    return "excess_heat" in dataset


def all_balances(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return all balances, the coldest first; one with NaN if there is none."""
    return [dataset.isel(balance=k) for k in range(dataset.sizes["balance"])]


def stable_balances(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return the stable balances, the coldest first."""
    return [dataset.isel(balance=int(k)) for k in np.flatnonzero(dataset["stable"].to_numpy() == 1)]


def celsius(kelvin: float) -> str:
    """Return a temperature [K] as text in degC."""
    return format_quantity(kelvin, "K", 4)


def _degrees(kelvin: float) -> str:
    """Return a temperature [K] in whole degrees, for an answer."""
    return f"{kelvin - 273.15:.0f} °C"


def _given_row(dataset: "xr.Dataset") -> Row:
    """Return the row of the heat at the temperatures of the scene."""
    loss = float(dataset["given_loss"])
    is_known = not math.isnan(loss)
    oil = float(dataset["given_temperature"].sel(part="oil"))
    return Row(
        key="given_loss",
        label=f"heat at {_degrees(oil)}",
        value=loss,
        unit="W",
        text=format_power(loss) if is_known else "not found",
        note="at the temperatures of the scene"
        if is_known
        else str(dataset["given_status"].item()),
    )


def _sinks(balance: "xr.Dataset") -> str:
    """Return how much heat each sink carries away or brings in, as text."""
    heats = zip(
        balance["sink"].to_numpy(), balance["carried_away"].to_numpy().tolist(), strict=True
    )
    return ", ".join(
        f"{format_power(abs(heat))} {'by' if heat > 0.0 else 'in with'} {sink}"
        for sink, heat in heats
        if heat
    )


def _margin_rows(dataset: "xr.Dataset", node: str) -> list[Row]:
    """Return the row of the heat beyond which there is no balance; none where no limit is known."""
    margin = float(dataset["heat_margin"])
    if math.isnan(margin):
        return []
    limit = _degrees(float(dataset["limit_temperature"]))
    return [
        Row(
            key="heat_margin",
            label="further heat",
            value=margin,
            unit="W",
            text=format_power(margin),
            note=f"at most, else no balance is left above {limit} of the {node}",
        )
    ]


def _temperatures(names: Any, values: Any) -> str:
    """Return the temperatures [K] of nodes as text."""
    return ", ".join(
        f"{name} {celsius(float(value))}" for name, value in zip(names, values, strict=True)
    )


def _watt(power: float) -> str:
    """Return a power [W] as text."""
    return format_quantity(power, "W", 3)


class ThermalBalanceAccount(Account):
    """The account of bulk temperatures."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "thermal": ("thermal model", ""),
        "evaluated_temperatures": ("temperatures at which a steady slip was sought", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"temperatures": "K"}
    figures_function = ".figures:thermal_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return temperatures, heat and slip in balance, or the heat to carry away at those given."""
        given = _given_row(dataset)
        if not solved(dataset):
            summary = f"{given.text} of heat at the temperatures of the scene"
            return Answer(summary=summary, rows=(given,), next=(_NEXT_OF_GIVEN,))
        if not (balances := stable_balances(dataset)):
            note = str(dataset["status"].item())
            known = [given] if math.isfinite(given.value) else []
            row = Row(
                key="temperature", label="bulk temperature", unit="K", text="no balance", note=note
            )
            return Answer(
                summary="no balance of heat lasts",
                rows=(row, *known),
                next=(_NEXT_WITHOUT_BALANCE,),
            )
        coldest = balances[0]
        names = coldest["node"].to_numpy()
        values = coldest["temperature"].to_numpy()
        shown = [_degrees(value) for value in values]
        slip = float(coldest["steady_slip"])
        loss = float(coldest["loss"].sum())
        return Answer(
            summary=f"{names[0]} {shown[0]} in balance, {format_power(loss)} of heat",
            rows=(
                Row(
                    key="temperature",
                    label=str(names[0]),
                    value=float(values[0]),
                    unit="K",
                    text=shown[0],
                    note=", ".join(
                        f"{name} {text}" for name, text in zip(names[1:], shown[1:], strict=True)
                    ),
                ),
                Row(
                    key="loss",
                    label="heat",
                    value=loss,
                    unit="W",
                    text=format_power(loss),
                    note=_sinks(coldest),
                ),
                Row(
                    key="cage_slip_in_balance",
                    label="cage slip at these temperatures",
                    value=slip,
                    text="none" if math.isnan(slip) else percent(slip),
                    note=steady_play_note(coldest, "steady_slip"),
                ),
                *_margin_rows(dataset, str(names[0])),
                attrs.evolve(given, note=_others(dataset, coldest) or given.note),
            ),
            assumed=tuple(filter(None, [describe_estimated(dataset)])),
            next=(f"{RUN_STEADY_SLIP} {_scene_options(coldest)}",),
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Return the findings as sentences without full stop by topic, the most important first."""
        if not solved(dataset):
            return {"heat": [_given(dataset)]}
        return {
            "bulk temperatures": _balances(dataset),
            "limit": [_limit(dataset)],
            **({"what they rest on": [estimates]} if (estimates := _estimates(dataset)) else {}),
            **({"course": [_course(dataset)]} if "course_temperature" in dataset else {}),
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values; None for those without a value."""
        names = ["given_slip", "given_loss", "heat_margin", "limit_temperature", "inlet_limit"]
        values = {name: float(dataset[name]) for name in names if name in dataset}
        balances = [
            {
                "temperatures": dict(
                    zip(
                        map(str, balance["node"].to_numpy()),
                        balance["temperature"].to_numpy().tolist(),
                        strict=True,
                    )
                ),
                "stable": bool(balance["stable"]),
                "stability": str(balance["stability"].item()),
                "steady_slip": float(balance["steady_slip"]),
                "loss": float(balance["loss"].sum()),
                "carried_away": dict(
                    zip(
                        map(str, balance["sink"].to_numpy()),
                        balance["carried_away"].to_numpy().tolist(),
                        strict=True,
                    )
                ),
            }
            for balance in all_balances(dataset)
            if math.isfinite(float(balance["temperature"][0]))
        ]
        return (
            {"balances": balances}
            | {name: None if math.isnan(value) else value for name, value in values.items()}
            | {
                name: str(dataset[name].item())
                for name in ("status", "given_status", "limit_status", "course_status")
                if name in dataset
            }
        )


def _given(dataset: "xr.Dataset") -> str:
    """Return the heat to carry away at the temperatures of the scene, as a sentence."""
    loss = float(dataset["given_loss"])
    if math.isnan(loss):
        return f"at the temperatures of the scene: {dataset['given_status'].item()}"
    return (
        f"to hold the temperatures of the scene {_watt(loss)} have to be carried away, at a cage slip of "
        f"{100.0 * float(dataset['given_slip']):.3g} %; with models.thermal = 'network' they follow from the losses"
    )


def _others(dataset: "xr.Dataset", balance: "xr.Dataset") -> str:
    """Return that others warm or cool the oil to the temperature of the scene; empty where both are near.

    It is empty where the thermal model has no node for the oil, too.

    Parameters
    ----------
    dataset : Dataset
        The result.
    balance : Dataset
        Its coldest stable balance.
    """
    if "oil" not in balance["node"].to_numpy():
        return ""
    given = float(dataset["given_temperature"].sel(part="oil"))
    alone = float(balance["temperature"].sel(node="oil"))
    if abs(given - alone) <= _OTHERS:
        return ""
    act = "warm" if given > alone else "cool"
    return f"others {act} it: by itself the bearing settles at {_degrees(alone)}"


def _clause(note: str) -> str:
    """Return a note as a further clause of a sentence; empty without one."""
    return f", {note}" if note else ""


def _balances(dataset: "xr.Dataset") -> list[str]:
    """Return the balances as sentences."""
    status = str(dataset["status"].item())
    if Status.of(status) is not Status.FOUND:
        return [status]
    sentences = []
    slip = float(dataset["given_slip"])
    given = ""
    if not math.isnan(slip):
        given = f", against {100.0 * slip:.3g} % at the temperatures of the scene"
    for balance in all_balances(dataset):
        loss = float(balance["loss"].sum())
        temperatures = _temperatures(balance["node"].to_numpy(), balance["temperature"].to_numpy())
        sentences.append(
            f"heat is in balance at {temperatures} "
            f"({balance['stability'].item()}): {_watt(loss)} are lost, {_sinks(balance)}; the cage slip is "
            f"{100.0 * float(balance['steady_slip']):.3g} %{given}{_clause(steady_play_note(balance, 'steady_slip'))}"
        )
    if (jumps := str(dataset["jumps"].item())) != NO_JUMPS:
        sentences.append(jumps)
    if len(stable_balances(dataset)) > 1:
        sentences.append(
            "which of the balances that last a bearing is in depends on how it came there: warm from the colder"
        )
    return sentences


def _limit(dataset: "xr.Dataset") -> str:
    """Return the limit of the coldest stable balance as a sentence."""
    at = float(dataset["limit_temperature"])
    status = str(dataset["limit_status"].item())
    if math.isnan(at):
        return status
    inlet = float(dataset["inlet_limit"])
    node = str(dataset["node"].to_numpy()[0])
    margin = _watt(float(dataset["heat_margin"]))
    beyond = f"with {margin} more"
    if not math.isnan(inlet):
        beyond = f"with {margin} more, or the {node} at its inlet above {celsius(inlet)},"
    return f"{beyond} no balance is left, at {celsius(at)} of the {node}; what ends it is {status}"


def _estimates(dataset: "xr.Dataset") -> str:
    """Return which parameters of the thermal model are estimated, as a sentence; empty if none are."""
    parameters: dict[str, str] = json.loads(dataset.attrs.get("taken_from_bearing", "{}"))
    if "course_temperature" not in dataset:  # heat capacities change the course over time alone
        parameters = {
            name: value for name, value in parameters.items() if not value.endswith("J/K")
        }
    if not parameters:
        return ""
    text = ", ".join(f"{name} {value}" for name, value in parameters.items())
    return (
        f"models.thermal does not give {text}: they are taken from the scene or estimated, "
        f"'rollslip models {dataset.attrs['thermal']}' says how, and how good that is"
    )


def _course(dataset: "xr.Dataset") -> str:
    """Return the temperatures at the end of the course over time, as a sentence."""
    last = dataset.isel(time=-1)
    at = _temperatures(dataset["node"].to_numpy(), last["course_temperature"].to_numpy())
    slip = float(last["course_slip"])
    shown = f", at a cage slip of {100.0 * slip:.3g} %" if math.isfinite(slip) else ""
    ended = str(dataset["course_status"].item())
    early = "" if ended == COURSE_COMPLETE else f"; it ends there: {ended}"
    return f"from the temperatures of the scene it is after {float(last['time']):.4g} s at {at}{shown}{early}"


def _scene_options(balance: "xr.Dataset") -> str:
    """Return the options with which another study takes the temperatures of a balance."""
    known = dict(zip(balance["node"].to_numpy(), balance["temperature"].to_numpy(), strict=True))
    return " ".join(
        f"--set {key}={value - 273.15:.4g}degC"
        for part, key in _KEYS.items()
        if (value := known.get(part))
    )


ACCOUNT: Final = ThermalBalanceAccount("thermal-balance")
