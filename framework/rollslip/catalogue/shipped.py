"""Watches over the import of a package: that it changes no law that results name as ours, and how long it takes.

A method that another package puts in place of one of ours changes numbers, and a result names rollslip alone for them.
So what our modules hold is compared before and after the import of a package: names, members of classes, code. A module
of ours that is imported meanwhile has no before; a function of strangers in one of its classes tells.
"""

import os
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from types import FunctionType, ModuleType
from typing import Any, Final

__all__ = ["altered", "held", "is_ours", "warn_if_slow"]

#: Seconds that an import may take without a word.
_SLOW: Final = 10.0
_ROOTS = frozenset(
    {"rollslip", "rollslip_campaigns", "rollslip_kernels", "rollslip_plugins", "rollslip_studies"}
)


def is_ours(module: str) -> bool:
    """Return whether a module, by its dotted name, is one of rollslip's distribution."""
    return module.partition(".")[0] in _ROOTS


def held() -> Mapping[str, Any]:
    """Return what the modules of rollslip hold that are imported: dotted name -> thing."""
    return dict(_held())


def _held() -> Iterator[tuple[str, Any]]:
    for module in [name for name in sys.modules if is_ours(name)]:
        for name, thing in list(vars(sys.modules[module]).items()):
            if name.startswith("__") or isinstance(thing, ModuleType):
                continue
            yield f"{module}.{name}", thing
            if isinstance(thing, FunctionType):
                yield f"{module}.{name}()", thing.__code__
            if isinstance(thing, type) and thing.__module__ == module:
                for member, value in list(vars(thing).items()):
                    yield f"{module}.{name}.{member}", value
                    if isinstance(value, FunctionType):
                        yield f"{module}.{name}.{member}()", value.__code__


def altered(before: Mapping[str, Any]) -> list[str]:
    """Return the names of rollslip that hold something else than before, or are put into classes anew."""
    after = held()
    found = [name for name, thing in before.items() if after.get(name) is not thing]
    for name in after.keys() - before.keys():
        place, _, last = name.rpartition(".")
        if isinstance(after.get(place), type) and not last.startswith(
            "_"
        ):  # attrs writes some of those
            stranger = isinstance(after[name], FunctionType) and not is_ours(after[name].__module__)
            found += [name] if place in before or stranger else []
    return sorted({name.removesuffix("()") for name in found})


@contextmanager
def warn_if_slow(what: str, module: str, package: str) -> Iterator[None]:
    """Say on the standard error what is being imported, once it has taken longer than anybody is patient."""
    told = threading.Timer(_SLOW, _warn_slow, (what, module, package))
    told.daemon = True
    told.start()
    try:
        yield
    finally:
        told.cancel()


def _warn_slow(what: str, module: str, package: str) -> None:
    disabled = ",".join(filter(None, (os.environ.get("ROLLSLIP_DISABLED_PLUGINS"), package)))
    with suppress(OSError, ValueError, AttributeError):  # there may be nobody to tell
        sys.stderr.write(
            f"{what}: importing {module} has taken {_SLOW:g} s and goes on; if it hangs, interrupt (Ctrl-C) and do "
            f"without the package: ROLLSLIP_DISABLED_PLUGINS={disabled}\n"
        )
        sys.stderr.flush()
