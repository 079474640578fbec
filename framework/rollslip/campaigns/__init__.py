"""Deprecated: the campaigns under their former path; they are a root of their own."""

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

#: What became part of the core; everything else kept its name.
_OF_THE_CORE: Final = {
    "sweep.distributions": "rollslip.scene.distributions",
    "uncertainty.band": "rollslip.planning.band",
    "uncertainty.scatter": "rollslip.planning.scatter",
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
        inside = fullname.removeprefix(f"{__name__}.")
        if inside == fullname:
            return None
        home = _OF_THE_CORE.get(inside, f"rollslip_campaigns.{inside}")
        return ModuleSpec(fullname, _Home(home)) if importlib.util.find_spec(home) is not None else None


sys.meta_path.insert(0, _Former())
