"""What keeps the rollers of a bearing apart: a cage, or nothing, so that they push and rub against each other."""

import abc
import math
from typing import ClassVar, Final

from rollslip.catalogue.kinds import Kind
from rollslip.catalogue.registry import structure_model
from rollslip.datasets import Bearing
from rollslip.errors import SceneError
from rollslip.references import Citation
from rollslip.scene.values import Scene
from rollslip.structure import Location


class Separator(abc.ABC):
    """What keeps rollers apart; its parameters are its attrs fields."""

    name: ClassVar[str]
    equation: ClassVar[str]
    references: ClassVar[tuple[Citation, ...]]
    #: Coefficient of friction of a roller against its neighbours [1]; None where a cage is between them.
    coefficient: float | None = None


SEPARATOR: Final = Kind(name="separator", hook="separators", base=Separator)


def separator(scene: Scene) -> Separator:
    """Return what keeps the rollers of a scene apart."""
    problems, choice = list[str](), scene.models.separator
    raw = {"model": "cage"} if choice is None else {"model": choice.name, **choice.parameters}
    made: Separator = structure_model("separator", raw, Location(scene.origins, ("models", "separator")), problems)
    if problems:
        raise SceneError(problems)
    return made


def train_play(bearing: Bearing) -> float:
    """Return the play that all rollers have together along their orbit where no cage is between them [m]."""
    orbit = (bearing.inner_raceway_diameter + bearing.outer_raceway_diameter) / 4
    return 2 * orbit * (math.pi - bearing.rollers * math.asin(bearing.roller_diameter / (2 * orbit)))
