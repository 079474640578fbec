"""Slip of rollers and cage in cylindrical roller bearings under hydrodynamic contact friction.

Names are imported at their first use, so that ``rollslip --help`` imports neither SciPy nor xarray.
"""

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rollslip.bearing.chain import Chain as Chain
    from rollslip.catalogue.registry import available as available
    from rollslip.catalogue.registry import get_model as get_model
    from rollslip.catalogue.session import model as model
    from rollslip.catalogue.session import register as register
    from rollslip.cli.console import info as info
    from rollslip.errors import RollslipDeprecationWarning as RollslipDeprecationWarning
    from rollslip.planning.campaign import function_of
    from rollslip.planning.execution import run as run
    from rollslip.planning.loads import load_distribution as load_distribution
    from rollslip.planning.new_scene import new as new
    from rollslip.planning.plan import plan as plan
    from rollslip.results.accounts import answer as answer
    from rollslip.results.accounts import findings as findings
    from rollslip.results.dataset import open_result as open_result
    from rollslip.results.dataset import save as save
    from rollslip.results.figures import plot as plot
    from rollslip.results.figures import report as report
    from rollslip.results.table import table as table
    from rollslip.scene.changes import evolve as evolve
    from rollslip.scene.reading import load_scene as load_scene
    from rollslip_campaigns.comparison import ComparisonSettings
    from rollslip_campaigns.explorer import ExplorerSettings
    from rollslip_campaigns.fit import FitSettings
    from rollslip_campaigns.limit import LimitSettings
    from rollslip_campaigns.pareto import ParetoSettings
    from rollslip_campaigns.sweep import SweepSettings
    from rollslip_campaigns.uncertainty import UncertaintySettings
    from rollslip_kernels import get_include as get_include
    from rollslip_kernels.slices import Conditions as Conditions
    from rollslip_kernels.slices import Slices as Slices

    compare = function_of(ComparisonSettings)
    explore = function_of(ExplorerSettings)
    fit = function_of(FitSettings)
    limit = function_of(LimitSettings)
    pareto = function_of(ParetoSettings)
    sweep = function_of(SweepSettings)
    uncertainty = function_of(UncertaintySettings)

#: Public name -> module that defines it.
_MODULES = {
    "Chain": "rollslip.bearing.chain",
    "Conditions": "rollslip_kernels.slices",
    "RollslipDeprecationWarning": "rollslip.errors",
    "Slices": "rollslip_kernels.slices",
    "answer": "rollslip.results.accounts",
    "available": "rollslip.catalogue.registry",
    "evolve": "rollslip.scene.changes",
    "findings": "rollslip.results.accounts",
    "get_include": "rollslip_kernels",
    "get_model": "rollslip.catalogue.registry",
    "info": "rollslip.cli.console",
    "load_distribution": "rollslip.planning.loads",
    "load_scene": "rollslip.scene.reading",
    "model": "rollslip.catalogue.session",
    "new": "rollslip.planning.new_scene",
    "open_result": "rollslip.results.dataset",
    "plan": "rollslip.planning.plan",
    "plot": "rollslip.results.figures",
    "register": "rollslip.catalogue.session",
    "report": "rollslip.results.figures",
    "run": "rollslip.planning.execution",
    "save": "rollslip.results.dataset",
    "table": "rollslip.results.table",
}
#: Functions with types of libraries that are imported at their first use.
_DATASET_FUNCTIONS = {
    *("answer", "findings", "info", "load_distribution", "open_result", "run", "save", "table")
}
#: Public functions of campaigns; they are found like those of third-party packages.
_CAMPAIGNS = ("compare", "explore", "fit", "limit", "pareto", "sweep", "uncertainty")
__all__ = sorted((*_MODULES, *_CAMPAIGNS))

# the application decides where its log goes
logging.getLogger(__name__).addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("rollslip")
    value = (
        getattr(importlib.import_module(_MODULES[name]), name)
        if name in _MODULES
        else _campaign_function(name)
    )
    if value is None:
        commands = importlib.import_module("rollslip.cli.main").cli.commands
        hint = f"; 'rollslip {name}' is a command of the shell" if name in commands else ""
        raise AttributeError(f"module 'rollslip' has no attribute {name!r}{hint}")
    if name in _DATASET_FUNCTIONS:
        pandas, xarray, figures = map(
            importlib.import_module, ("pandas", "xarray", "rollslip.results.figures")
        )
        types = {"pd": pandas, "xr": xarray, "Result": figures.Result}
        value.__annotations__ = importlib.import_module("typing").get_type_hints(value, None, types)
    globals()[name] = value
    return value


def _campaign_function(name: str) -> Any:
    """Return the function of a campaign; None where there is no such campaign, or it has no function."""
    if name.startswith("_"):  # Python looks up many of these
        return None
    module = importlib.import_module("rollslip.planning.campaign")
    campaign = name.replace("_", "-")
    return module.function_of(module.campaign(campaign)) if campaign in module.campaigns() else None


def __dir__() -> list[str]:
    return __all__
