"""What a thermal balance says: its single values as a record, and sentences, from the dataset alone."""

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from rollslip.results.account import Account
from rollslip.results.answer import Answer, Row
from rollslip.results.words import describe_estimated, format_power, percent
from rollslip.units import format_quantity
from rollslip_studies.steady_slip.findings import next_of_others

if TYPE_CHECKING:
    import xarray as xr

#: Part of a bearing -> the key of a scene with its temperature.
_KEYS = {
    "oil": "operation.temperature",
    "inner ring": "operation.inner_ring_temperature",
    "rollers": "operation.roller_temperature",
    "outer ring": "operation.outer_ring_temperature",
}


def solved(dataset: "xr.Dataset") -> bool:
    """Whether temperatures follow from losses."""
    return "excess_heat" in dataset


def lasting(dataset: "xr.Dataset") -> "list[xr.Dataset]":
    """Return the balances that last, the coldest first."""
    return [dataset.isel(balance=int(k)) for k in np.flatnonzero(dataset["stable"].to_numpy() == 1)]


def celsius(kelvin: float) -> str:
    """Return a temperature as people read it."""
    return format_quantity(kelvin, "K", 4)


def _temperatures(names: Any, values: Any) -> str:
    return ", ".join(
        f"{name} {celsius(float(value))}" for name, value in zip(names, values, strict=True)
    )


def _watt(format_power: float) -> str:
    return format_quantity(format_power, "W", 3)


class ThermalBalanceAccount(Account):
    """How bulk temperatures are told."""

    numbers: ClassVar[Mapping[str, tuple[str, str]]] = {
        "thermal": ("thermal model", ""),
        "evaluated_temperatures": ("temperatures at which a steady slip was sought", ""),
    }
    units: ClassVar[Mapping[str, str]] = {"temperatures": "K"}
    drawn = ".figures:thermal_figures"

    @staticmethod
    def answer(dataset: "xr.Dataset") -> Answer:
        """Return temperatures and slip in balance, or the heat that has to be carried away to hold those given."""
        commands = next_of_others(
            dataset
        )  # of the slip at the temperatures of the scene another study knows
        if not solved(dataset):
            loss = float(dataset["given_loss"])
            text = format_power(loss)
            note = "at the temperatures of the scene"
            if math.isnan(loss):
                text = "not found"
                note = str(dataset["given_status"].item())
            row = Row(
                key="given_loss",
                label="heat to carry away",
                value=loss,
                unit="W",
                text=text,
                note=note,
            )
            return Answer(rows=(row,), commands=commands)
        if not (balances := lasting(dataset)):
            note = str(dataset["status"].item())
            row = Row(
                key="temperature", label="bulk temperature", unit="K", text="no balance", note=note
            )
            return Answer(rows=(row,), commands=commands)
        one = balances[0]
        names = one["node"].to_numpy()
        values = one["temperature"].to_numpy()
        slip = float(one["steady_slip"])
        shown = [f"{value - 273.15:.0f} °C" for value in values]
        rows = (
            Row(key="temperature", label=f"temperature, {names[0]}", value=float(values[0]), unit="K", text=shown[0],
                note=", ".join(f"{name} {text}" for name, text in zip(names[1:], shown[1:], strict=True))),
            Row(key="cage_slip_in_balance", label="cage slip there", value=slip, text=percent(slip)),
        )  # fmt: skip
        return Answer(
            rows=rows, assumed=tuple(filter(None, [describe_estimated(dataset)])), commands=commands
        )

    @staticmethod
    def topics(dataset: "xr.Dataset") -> dict[str, list[str]]:
        """Say what was found, by what it is about, the most important first; no sentence has its full stop."""
        if not solved(dataset):
            return {"heat": [_given(dataset)]}
        return {
            "bulk temperatures": _balances(dataset),
            "limit": [_limit(dataset)],
            **({"what they rest on": [taken]} if (taken := _taken(dataset)) else {}),
            **({"course": [_course(dataset)]} if "course_temperature" in dataset else {}),
            **({"other studies": [_settings(dataset)]} if lasting(dataset) else {}),
        }

    @staticmethod
    def record(dataset: "xr.Dataset") -> dict[str, Any]:
        """Return the single values; what has no value is None."""
        names = ["given_slip", "given_loss", "heat_margin", "limit_temperature", "inlet_limit"]
        values = {name: float(dataset[name]) for name in names if name in dataset}
        balances = [
            {
                "temperatures": dict(
                    zip(
                        map(str, one["node"].to_numpy()),
                        one["temperature"].to_numpy().tolist(),
                        strict=True,
                    )
                ),
                "stable": bool(one["stable"]),
                "stability": str(one["stability"].item()),
                "steady_slip": float(one["steady_slip"]),
                "loss": float(one["loss"].sum()),
                "carried_away": dict(
                    zip(
                        map(str, one["sink"].to_numpy()),
                        one["carried_away"].to_numpy().tolist(),
                        strict=True,
                    )
                ),
            }
            for one in (dataset.isel(balance=k) for k in range(dataset.sizes["balance"]))
            if math.isfinite(float(one["steady_slip"]))
        ]
        texts = [
            name
            for name in ("status", "given_status", "limit_status", "course_status")
            if name in dataset
        ]
        return (
            {"balances": balances}
            | {name: None if math.isnan(value) else value for name, value in values.items()}
            | {name: str(dataset[name].item()) for name in texts}
        )


def _given(dataset: "xr.Dataset") -> str:
    loss = float(dataset["given_loss"])
    if math.isnan(loss):
        return f"at the temperatures of the scene: {dataset['given_status'].item()}"
    return (
        f"to hold the temperatures of the scene {_watt(loss)} have to be carried away, at a cage slip of "
        f"{100.0 * float(dataset['given_slip']):.3g} %; with models.thermal = 'network' they follow from the losses"
    )


def _balances(dataset: "xr.Dataset") -> list[str]:
    if str(dataset["status"].item()) != "found":
        return [str(dataset["status"].item())]
    said = []
    slip = float(dataset["given_slip"])
    for one in (dataset.isel(balance=k) for k in range(dataset.sizes["balance"])):
        made = float(one["loss"].sum())
        heats = list(
            zip(one["sink"].to_numpy(), one["carried_away"].to_numpy().tolist(), strict=True)
        )
        away = " and ".join(f"{_watt(heat)} leave by {sink}" for sink, heat in heats if heat > 0.0)
        brought = "".join(
            f", {_watt(-heat)} come in with {sink}" for sink, heat in heats if heat < 0.0
        )
        given = (
            ""
            if math.isnan(slip)
            else f", against {100.0 * slip:.3g} % at the temperatures of the scene"
        )
        said.append(
            f"heat is in balance at {_temperatures(one['node'].to_numpy(), one['temperature'].to_numpy())} "
            f"({one['stability'].item()}): {_watt(made)} are lost{brought}, {away}; the cage slip is "
            f"{100.0 * float(one['steady_slip']):.3g} %{given}"
        )
    if guessed := describe_estimated(dataset):
        said[-1] += f"; {guessed}"
    if (jumps := str(dataset["jumps"].item())) != "none":
        said.append(jumps)
    if len(lasting(dataset)) > 1:
        said.append(
            "which of the balances that last a bearing is in depends on how it came there: warm from the colder"
        )
    return said


def _limit(dataset: "xr.Dataset") -> str:
    at = float(dataset["limit_temperature"])
    status = str(dataset["limit_status"].item())
    if math.isnan(at):
        return status
    inlet = float(dataset["inlet_limit"])
    node = str(dataset["node"].to_numpy()[0])
    margin = _watt(float(dataset["heat_margin"]))
    beyond = (
        f"with {margin} more, or the {node} at its inlet above {celsius(inlet)},"
        if inlet == inlet
        else (f"with {margin} more")
    )
    return f"{beyond} no balance is left, at {celsius(at)} of the {node}; what ends it is {status}"


def _taken(dataset: "xr.Dataset") -> str:
    taken: dict[str, str] = json.loads(dataset.attrs.get("taken_from_bearing", "{}"))
    if "course_temperature" not in dataset:  # what stores heat sets the pace alone
        taken = {name: value for name, value in taken.items() if not value.endswith("J/K")}
    said = ", ".join(f"{name} {value}" for name, value in taken.items())
    how = f"'rollslip models {dataset.attrs['thermal']}' says how, and how good that is"
    return (
        f"models.thermal does not give {said}: they are taken from the scene or estimated, {how}"
        if taken
        else ""
    )


def _course(dataset: "xr.Dataset") -> str:
    last = dataset.isel(time=-1)
    at = _temperatures(dataset["node"].to_numpy(), last["course_temperature"].to_numpy())
    slip = float(last["course_slip"])
    shown = f", at a cage slip of {100.0 * slip:.3g} %" if math.isfinite(slip) else ""
    ended = str(dataset["course_status"].item())
    early = "" if ended == "the time is over" else f"; it ends there: {ended}"
    return f"from the temperatures of the scene it is after {float(last['time']):.4g} s at {at}{shown}{early}"


def _settings(dataset: "xr.Dataset") -> str:
    one = lasting(dataset)[0]
    known = dict(zip(one["node"].to_numpy(), one["temperature"].to_numpy(), strict=True))
    keys = [
        f"--set '{key}={value - 273.15:.6g} degC'"
        for part, key in _KEYS.items()
        if (value := known.get(part))
    ]
    return f"other studies take the temperatures of the scene; these are {' '.join(keys)}"


ACCOUNT: Final = ThermalBalanceAccount("thermal-balance")
