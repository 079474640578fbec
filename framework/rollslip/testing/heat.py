"""The rules of thermal models: heat is conserved, and flows from warm to cold only."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.scene.reading import load_scene
from rollslip.studies.thermal_balance.model import PLACES, ROLES, ThermalModel
from rollslip.testing.rules import (
    CITATIONS_WANTED,
    Inapplicable,
    Nonconformance,
    is_citation,
    refuse_unless,
    rule,
)

Array = np.ndarray[Any, np.dtype[np.float64]]
#: What rounding may leave of a sum of flows, relative to the largest of them.
_ROUNDING = 1e-10
_DRAWN = 25


def _bound(model: ThermalModel) -> tuple[ThermalModel, Array]:
    """Return the model bound to a bearing, and where it starts."""
    scene = load_scene("1032930-70C")
    bound = model.of(assemble(scene))
    if not bound.nodes:
        raise Inapplicable("it has no nodes: temperatures do not follow from losses")
    return bound, np.asarray(bound.start(scene), dtype=float)


def _draws(start: Array) -> Iterator[tuple[Array, Mapping[str, float]]]:
    """Temperatures and losses of all sizes, the same each time."""
    random = np.random.default_rng(4)
    for _ in range(_DRAWN):
        yield (
            start + random.uniform(-60.0, 150.0, start.size),
            dict(zip(PLACES, 10.0 ** random.uniform(-2.0, 4.0, len(PLACES)), strict=True)),
        )


@rule(ThermalModel)
def check_has_an_equation_and_references(model: ThermalModel) -> None:
    """A name, an equation, and references."""
    refuse_unless(isinstance(model.equation, str) and model.equation.strip(), "it has no equation")
    refuse_unless(model.references and all(map(is_citation, model.references)), CITATIONS_WANTED)


@rule(ThermalModel)
def check_heat_is_conserved(model: ThermalModel) -> None:
    """What flows into all nodes is what is lost, less what is carried away."""
    bound, start = _bound(model)
    for T, losses in _draws(start):
        flows, away = np.asarray(bound.inflows(T, losses)), bound.carried_away(T)
        refuse_unless(flows.shape == T.shape, f"inflows have shape {flows.shape}, there are {T.size} nodes")
        missing = sum(losses.values()) - sum(away.values()) - float(flows.sum())
        size = max([sum(losses.values()), *np.abs(flows), *map(abs, away.values())])
        if not abs(missing) <= _ROUNDING * size:
            raise Nonconformance(
                f"{missing:.6g} W are lost on the way: losses {sum(losses.values()):.6g} W, into the nodes "
                f"{float(flows.sum()):.6g} W, carried away {sum(away.values()):.6g} W"
            )


@rule(ThermalModel)
def check_a_warmer_node_takes_less_heat_and_the_others_no_less(model: ThermalModel) -> None:
    """Heat flows from warm to cold."""
    bound, start = _bound(model)
    for T, losses in _draws(start):
        before = np.asarray(bound.inflows(T, losses))
        for k, node in enumerate(bound.nodes):
            warmer = T.copy()
            warmer[k] += 1.0
            moved = np.asarray(bound.inflows(warmer, losses)) - before
            slack = _ROUNDING * float(np.abs(before).max())
            refuse_unless(moved[k] <= slack, f"the {node} takes {moved[k]:.3g} W more where it is 1 K warmer")
            others = np.delete(moved, k)
            refuse_unless(np.all(others >= -slack), f"other nodes take less heat where the {node} is 1 K warmer")


@rule(ThermalModel)
def check_nodes_have_capacities_and_keys_of_the_scene(model: ThermalModel) -> None:
    """Capacities are above zero; the temperatures of the scene are among what changes."""
    bound, start = _bound(model)
    capacities = np.asarray(bound.capacities(), dtype=float)
    refuse_unless(
        capacities.shape == start.shape and np.all(capacities > 0.0) and np.all(np.isfinite(capacities)),
        f"capacities are {capacities}; give one above zero for each of {', '.join(bound.nodes)}",
    )
    changes = bound.changes(start, load_scene("1032930-70C"))
    missing = [key for key in ROLES if not math.isfinite(changes.get(key, math.nan))]
    refuse_unless(not missing, f"changes() gives no value for {', '.join(missing)}")
