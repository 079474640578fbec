"""Modules under their former paths, with a warning: what was part of the framework and is a root of its own, or moved.

The old path gives the same module object as the new one, so that what is pickled, patched or reloaded stays one thing.
"""

import importlib
import importlib.util
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Final

from rollslip.errors import RollslipDeprecationWarning

#: What changed its name.
_RENAMED: Final = {
    "rollslip.campaigns.sweep.distributions": "rollslip_studies.variation.distributions",
    "rollslip.campaigns.uncertainty.band": "rollslip_studies.steady_slip.band",
    "rollslip.campaigns.uncertainty.scatter": "rollslip_studies.variation.scatter",
    "rollslip.planning.quantities": "rollslip_studies.variation.quantities",
    "rollslip.planning.scatter": "rollslip_studies.variation.scatter",
    "rollslip.scene.distributions": "rollslip_studies.variation.distributions",
    "rollslip.bearing.profile": "rollslip.profile",
    "rollslip.bearing.search": "rollslip.search",
    "rollslip.validity": "rollslip.models.validity",
    "rollslip.results.sheet": "rollslip.results.style",
    "rollslip.bearing.load_map": "rollslip_studies.dynamics.levels.load_map",
    "rollslip.motion.continuation": "rollslip_studies.steady_slip.branches",
    **{
        f"rollslip.motion.{name}": f"rollslip_studies.dynamics.levels.{name}"
        for name in ("moving_bearing", "planar", "raceway_friction")
    },
    "rollslip.motion.carried": "rollslip_studies.dynamics.levels.cage_and_rollers",
    "rollslip.motion.history.courses": "rollslip_studies.dynamics.history.time_functions",
    "rollslip.motion.history.path": "rollslip_studies.dynamics.history.temperature_path",
    "rollslip.motion.history.stations": "rollslip_studies.dynamics.history.interpolated_rates",
    "rollslip.studies.dynamics.along": "rollslip_studies.dynamics.over_time",
    "rollslip.studies.dynamics.ending": "rollslip_studies.dynamics.termination",
    "rollslip.studies.steady_slip.shared": "rollslip_studies.steady_slip.evaluated",
    "rollslip.campaigns.validation.judging": "rollslip_campaigns.validation.residuals",
    "rollslip.pressure_viscosity": "rollslip.lubricant.pressure",
    "rollslip.studies.raceways": "rollslip_studies.effective_friction.raceways",
}
#: Folders that became roots; all in them kept its name.
_ROOTS: Final = {
    "rollslip.campaigns": "rollslip_campaigns",
    "rollslip.motion.history": "rollslip_studies.dynamics.history",
    "rollslip.motion": "rollslip_studies.motion",
    "rollslip.measurement": "rollslip_campaigns.measurement",
    "rollslip.studies": "rollslip_studies",
}
#: What they left behind: the interface of studies, and folders of models that one of them asks.
_STAYED: Final = {
    "rollslip.studies",
    *("rollslip.studies.steady_slip", "rollslip.studies.surface_damage", "rollslip.studies.thermal_balance"),
    *("rollslip.studies.steady_slip.torque", "rollslip.studies.surface_damage.model"),
    "rollslip.studies.thermal_balance.model",
}


class _Home(Loader):
    """Gives the module where it is now, the same object under both paths."""

    def __init__(self, home: str) -> None:
        self.home = home
        self.spec: ModuleSpec | None = None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        said = f"{spec.name} is deprecated: import {self.home}"
        warnings.warn(said, RollslipDeprecationWarning, stacklevel=2)
        module = importlib.import_module(self.home)
        self.spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = self.spec  # importlib has put that of the former path in its place


class _Former(MetaPathFinder):
    """Finds modules by their former path, before Python looks into the folders of what it gave."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if not fullname.startswith("rollslip."):  # most of what a process imports
            return None
        home = _RENAMED.get(fullname, "")
        if not home and fullname not in _STAYED:
            former, root = next((pair for pair in _ROOTS.items() if f"{fullname}.".startswith(f"{pair[0]}.")), ("", ""))
            home = root + fullname.removeprefix(former) if root else ""
        return ModuleSpec(fullname, _Home(home)) if home and importlib.util.find_spec(home) is not None else None


def find_former_paths() -> None:
    """Let Python find modules by their former paths from now on."""
    sys.meta_path.insert(0, _Former())
