"""Named data of bearings and surfaces that plugins ship, each with its source and what it holds for."""

import attrs

from rollslip.scene.values import Bearing, Surface

__all__ = ["BearingData", "SurfaceData"]


@attrs.frozen(kw_only=True)
class BearingData:
    """A bearing that a scene can name: ``[bearing] name = "1032930"``; the other keys of the table change its values.

    Parameters
    ----------
    name : str
        What a scene calls it.
    description : str
        What it is, in one line.
    source : str
        Where the values come from, and which are assumed.
    validity : str
        What they hold for: whether the clearance is one in operation, for example.
    references : tuple of str
        One citation each.
    bearing : Bearing
        The values.
    """

    name: str
    description: str
    source: str
    validity: str
    references: tuple[str, ...] = ()
    bearing: Bearing

    @property
    def data(self) -> Bearing:
        """The values."""
        return self.bearing


@attrs.frozen(kw_only=True)
class SurfaceData:
    """Surfaces that a scene can name: ``[surface] name = "ground"``; the other keys of the table change their values.

    Parameters
    ----------
    name, description, source, validity, references
        As in `BearingData`.
    surface : Surface
        The values.
    """

    name: str
    description: str
    source: str
    validity: str
    references: tuple[str, ...] = ()
    surface: Surface

    @property
    def data(self) -> Surface:
        """The values."""
        return self.surface
