"""Bearing elements of ROSS: stiffness over speed, one element for each load and temperature of the tables."""

import json
from typing import TYPE_CHECKING, Any, ClassVar, Final

import attrs
import numpy as np
from rollslip.errors import SceneError
from rollslip.hookspecs import hookimpl
from rollslip.scene.formats import SceneFormat, Written
from rollslip_campaigns.surrogate.exports import TablesFormat

if TYPE_CHECKING:
    import xarray as xr

#: What the elements leave out, as their file says.
NOT_MODELLED: Final = (
    "damping: cxx and the others are 0; state your own",
    "films: stiffness is that of the dry contacts between rigid rings",
    "friction: kxy is that of the load zone, which is symmetric, and has no part that drives whirl",
    "the passage of the rollers: stiffness is the mean over a roller pitch",
    "loads that change: a rotor that loads the bearing otherwise needs the element of that load",
)


@attrs.frozen
class Ross(TablesFormat):
    """Bearing elements of ROSS, that of the load and temperature of the scene first."""

    endings: ClassVar[tuple[str, ...]] = (".ross.json",)

    def render(self, result: "xr.Dataset") -> Written:
        """Return what ``ross.BearingElement.load`` reads: x along the load, y across it; friction torques beside."""
        speeds = result["inner_speed"].to_numpy()
        used = np.flatnonzero(speeds >= 0.0) if (speeds > 0.0).any() else np.arange(speeds.size)
        used = used[np.argsort(np.abs(speeds[used]))]

        def row(name: str, at: dict[str, int]) -> list[float | None]:
            values = result[name].isel(at).to_numpy()[used].tolist()
            return [None if np.isnan(value) else value for value in values]

        far_in_temperature = np.abs(np.log(result["temperature"].to_numpy() / float(result["first_temperature"])))
        far_in_load = np.abs(np.log(result["radial_load"].to_numpy() / float(result["first_load"])))
        far = np.add.outer(far_in_temperature, far_in_load)
        elements: dict[str, Any] = {}
        beside: dict[str, Any] = {}
        for place in sorted(np.ndindex(far.shape), key=far.__getitem__):
            at = dict(zip(("temperature", "radial_load"), place, strict=True))
            temperature = float(result["temperature"][at["temperature"]])
            load = float(result["radial_load"][at["radial_load"]])
            tag = f"{load:.5g} N {temperature:.5g} K"
            along, across, oblique = (row(f"stiffness_{name}", at) for name in ("along", "across", "oblique"))
            if None in along:
                raise SceneError([f"format {self.name}: rings that yield have no stiffness here; take rigid ones"])
            elements[f"BearingElement_{tag}"] = {
                "n": 0,
                "tag": tag,
                "frequency": np.abs(speeds[used]).tolist(),
                "kxx": along,
                "kyy": across,
                "kxy": oblique,
                "kyx": oblique,
                "cxx": [0.0] * used.size,
            }
            beside[tag] = {
                "radial_load": load,
                "temperature": temperature,
                "friction_torque": row("friction_torque", at),
                "steady_cage_slip": row("steady_cage_slip", at),
            }
        told = {"x": "along the load", "y": "across it", "units": "SI", "not_modelled": [*NOT_MODELLED]}
        text = json.dumps(elements | {"rollslip": told | {"beside": beside}}, indent=1)
        return Written(text + "\n", tuple(f"not in it: {one}" for one in NOT_MODELLED))


@hookimpl
def scene_formats() -> list[SceneFormat]:
    """Offer the format."""
    return [Ross("ross")]
