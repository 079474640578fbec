"""The studies by name, and their settings as a scene gives them."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Protocol

import attrs

from rollslip.errors import SceneError
from rollslip.scene.reading import Where, nearest, structure
from rollslip.scene.values import Scene
from rollslip.studies.dynamics.study import Dynamics
from rollslip.studies.effective_friction.study import EffectiveFriction
from rollslip.studies.friction_curve.study import FrictionCurve
from rollslip.studies.steady_slip.study import SteadySlip

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.bearing.assembly import Assembly


class Study(attrs.AttrsInstance, Protocol):
    """Settings of a study, which can run it."""

    def run(self, assembly: "Assembly") -> "xr.Dataset":
        """Return the result."""
        ...

    def evaluations(self, assembly: "Assembly") -> int:
        """Return about how many slices the study will evaluate."""
        ...

    def models(self, assembly: "Assembly") -> "tuple[tuple[str, Any], ...]":
        """Return kind and model of what it uses beyond the models of a contact."""
        ...


STUDIES: Final[Mapping[str, type[Study]]] = MappingProxyType(
    {
        "effective-friction": EffectiveFriction,
        "friction-curve": FrictionCurve,
        "dynamics": Dynamics,
        "steady-slip": SteadySlip,
    }
)


def settings(scene: Scene, study: str | None = None) -> dict[str, Study]:
    """Return the studies to run, with their settings: the scene's own, in its order, or the one asked for.

    A study that the scene does not mention runs with its defaults; a scene without studies runs effective-friction.

    Raises
    ------
    SceneError
        If a study does not exist or its settings are wrong; all faults at once.
    """
    where, problems = Where(scene.origins, ("study",)), list[str]()
    names = [study] if study is not None else list(scene.study) or ["effective-friction"]
    found: dict[str, Study] = {}
    for name in names:
        if name not in STUDIES:
            near = nearest(name, STUDIES)
            hint = f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(STUDIES)}"
            problems.append(where.at(name).says(f"no study is called {name!r}; {hint}"))
            continue
        made = structure(STUDIES[name], scene.study.get(name, {}), where.at(name), problems)
        if made is not None:
            found[name] = made
    if problems:
        raise SceneError(problems)
    return found
