"""Interface of the kind ``loss``: power that is lost beside the rollers and the cage, by seals, grease or gears.

Such a loss brakes the rings against each other and heats the bearing. It acts neither on rollers nor on the cage, so
that a slip at given temperatures does not depend on it. A scene names losses under ``models.loss``, by default none.
They are part of losses, friction torque and heat at a steady slip, and of the heat from which temperatures follow.
Makers' formulas do not cover them, and are compared with the friction torque without them.
"""

import abc
import math
from typing import Any, ClassVar, Final

from rollslip.catalogue.kinds import Kind, Template
from rollslip.catalogue.registry import structure_models
from rollslip.errors import DomainError
from rollslip.references import CitedModel
from rollslip.scene.values import Scene
from rollslip.structure import Location
from rollslip.studies.steady_slip.torque import Duty
from rollslip.studies.thermal_balance.model import PLACES

__all__ = ["LOSS", "LossModel", "loss_models", "lost_power"]


class LossModel(CitedModel):
    """Power that a seal, grease or a gear beside the bearing takes; its parameters are its attrs fields.

    The power is that at the relative speed of the rings: its torque is the power over that speed.
    """

    #: Where its heat arises, one of `PLACES`: "inner land" of a lip that rubs on the inner ring, for example.
    place: ClassVar[str] = "oil"

    @abc.abstractmethod
    def power(self, duty: Duty) -> float:
        """Return the lost power [W]: zero or more, and zero where the rings do not turn against each other.

        Parameters
        ----------
        duty : Duty
            Dimensions of the bearing, speed, load, oil and its temperature.

        Raises
        ------
        DomainError
            If the duty lacks a number that the model takes.
        """


def loss_models(scene: Scene) -> tuple[LossModel, ...]:
    """Return the losses of a scene, ``models.loss``, in its order."""
    return structure_models(
        "loss",
        [(choice.name, choice.parameters) for choice in scene.models.loss or ()],
        Location(scene.origins, ("models", "loss")),
    )


def lost_power(model: LossModel, duty: Duty) -> float:
    """Return the power of a loss that a scene names [W].

    Parameters
    ----------
    model : LossModel
        The loss.
    duty : Duty
        The bearing and its operating conditions.

    Raises
    ------
    DomainError
        If the power is not known, or is not a finite number of zero or more.
    """
    try:
        power = float(model.power(duty))
    except DomainError as error:
        raise DomainError(f"models.loss: {model.name!r} {error}") from error
    if not 0.0 <= power < math.inf:
        raise DomainError(
            f"models.loss: {model.name!r} gives {power:.4g} W at {duty.revolutions:.4g} rpm and "
            f"{duty.radial_load:.4g} N; a power is finite and not negative: repair the model or leave it out"
        )
    return power


def _place_fault(model: Any) -> str:
    """Return the fault of a class of losses whose heat arises nowhere in a bearing; empty if there is none."""
    if model.place in PLACES:
        return ""
    return f"class {model.__name__}: place is {model.place!r}; heat arises at one of {', '.join(PLACES)}"


LOSS: Final = Kind(
    name="loss",
    hook="loss_models",
    base=LossModel,
    template=Template(
        summary="A loss beside the rollers",
        contents="the power of a seal, its source and where its heat arises",
        use="rollslip run gearbox --study steady-slip --set models.loss=${model}",
        needs=("attrs>=24.2",),
    ),
    check=_place_fault,
)
