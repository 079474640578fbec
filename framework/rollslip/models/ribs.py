"""Base class of the friction of ribs: roller ends that slide on the ribs which carry an axial load."""

import abc
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.references import CitedModel
from rollslip_kernels.slices import Conditions

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["RibContact", "RibModel"]


@attrs.frozen(kw_only=True, eq=False)
class RibContact:
    """Contacts of roller ends with a rib: a sphere on a plane, at n loads and speeds."""

    #: Oil and steel; ``radius`` is that of the roller's end, ``length`` the height of the contact above the raceway.
    conditions: Conditions
    load: "NDArray[Any]"  #: Normal force Q [N], above 0, (n,).
    rolling_speed: "NDArray[Any]"  #: Mean surface speed u [m/s], above 0, (n,).
    sliding_speed: "NDArray[Any]"  #: Difference of the surface speeds V [m/s], signed, (n,).


class RibModel(CitedModel):
    """Friction of a roller's end on a rib; its parameters are its attrs fields.

    The friction is odd in the sliding speed at the same rolling speed, takes power, and rises with the load. Where the
    sliding speed passes zero it has no jump: a roller whose ribs do not slide would find no balance of its torques.
    """

    @abc.abstractmethod
    def friction(self, contact: RibContact) -> "NDArray[Any]":
        """Return the friction force [N], (n,), with the sign of the sliding speed.

        Parameters
        ----------
        contact : RibContact
            Loads, speeds, oil and geometry.
        """
