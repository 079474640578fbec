"""Slip of rollers and cage in cylindrical roller bearings under hydrodynamic contact friction.

Names are loaded when they are first used, so that ``rollslip --help`` imports neither SciPy nor xarray.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rollslip.allowable import uncertainty as uncertainty
    from rollslip.chain import Chain as Chain
    from rollslip.comparison import compare as compare
    from rollslip.execution import load_distribution as load_distribution
    from rollslip.execution import run as run
    from rollslip.fitting import fit as fit
    from rollslip.fronts import pareto as pareto
    from rollslip.planning import plan as plan
    from rollslip.reading import evolve as evolve
    from rollslip.reading import load_scene as load_scene
    from rollslip.registry import available as available
    from rollslip.registry import get_model as get_model
    from rollslip.result import open_result as open_result
    from rollslip.sweep_folder import sweep as sweep
    from rollslip.unpackaged import model as model
    from rollslip.unpackaged import register as register
    from rollslip_kernels import get_include as get_include
    from rollslip_kernels.slices import Conditions as Conditions
    from rollslip_kernels.slices import Slices as Slices

_HOMES = {
    "Chain": "rollslip.chain",
    "Conditions": "rollslip_kernels.slices",
    "Slices": "rollslip_kernels.slices",
    "available": "rollslip.registry",
    "compare": "rollslip.comparison",
    "evolve": "rollslip.reading",
    "fit": "rollslip.fitting",
    "get_include": "rollslip_kernels",
    "get_model": "rollslip.registry",
    "load_distribution": "rollslip.execution",
    "load_scene": "rollslip.reading",
    "model": "rollslip.unpackaged",
    "open_result": "rollslip.result",
    "pareto": "rollslip.fronts",
    "plan": "rollslip.planning",
    "register": "rollslip.unpackaged",
    "run": "rollslip.execution",
    "sweep": "rollslip.sweep_folder",
    "uncertainty": "rollslip.allowable",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'rollslip' has no attribute {name!r}")
    value = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
