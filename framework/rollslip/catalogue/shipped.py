"""Check that the import of a third-party package does not change rollslip, and report slow imports.

A package that replaces a method of rollslip changes numbers for which results name rollslip alone. Therefore the
members of rollslip's modules are compared before and after the import of a package: names, members of classes, code. A
module of rollslip which is imported during that import cannot be compared; there a third-party function in a class is
reported.
"""

import os
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from types import FunctionType, ModuleType
from typing import Any, Final

__all__ = ["changed_names", "is_ours", "snapshot", "warn_if_slow"]

#: Duration of an import after which a message appears [s]. Doubling it leaves users without explanation for longer.
#: Chosen; usual imports take less than a second.
_SLOW: Final = 10.0
_ROOTS = frozenset(
    {"rollslip", "rollslip_campaigns", "rollslip_kernels", "rollslip_plugins", "rollslip_studies"}
)


def is_ours(module: str) -> bool:
    """Return whether a module, by its dotted name, is one of rollslip's distribution."""
    return module.partition(".")[0] in _ROOTS


def snapshot() -> Mapping[str, Any]:
    """Return the members of all imported modules of rollslip: dotted name -> object."""
    return dict(_members())


def _members() -> Iterator[tuple[str, Any]]:
    """Yield dotted name and object of all members of imported modules of rollslip and of their classes."""
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


def changed_names(before: Mapping[str, Any]) -> list[str]:
    """Return the names of rollslip that differ from a snapshot, and new members of its classes."""
    after = snapshot()
    changed = [name for name, thing in before.items() if after.get(name) is not thing]
    for name in after.keys() - before.keys():
        owner, _, last = name.rpartition(".")
        # attrs adds some members with an underscore
        if isinstance(after.get(owner), type) and not last.startswith("_"):
            is_foreign = isinstance(after[name], FunctionType) and not is_ours(
                after[name].__module__
            )
            if owner in before or is_foreign:
                changed.append(name)
    return sorted({name.removesuffix("()") for name in changed})


@contextmanager
def warn_if_slow(what: str, module: str, package: str) -> Iterator[None]:
    """Print a message on the standard error where the import in the block takes longer than ten seconds.

    Parameters
    ----------
    what : str
        The offer that is loaded, for the message.
    module : str
        Module that is imported.
    package : str
        Its package, which the message proposes to disable.
    """
    timer = threading.Timer(_SLOW, _warn_slow, (what, module, package))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _warn_slow(what: str, module: str, package: str) -> None:
    """Print the message on a slow import."""
    disabled = ",".join(filter(None, (os.environ.get("ROLLSLIP_DISABLED_PLUGINS"), package)))
    with suppress(OSError, ValueError, AttributeError):  # the standard error may be closed
        sys.stderr.write(
            f"{what}: importing {module} has taken {_SLOW:g} s and goes on; if it hangs, interrupt (Ctrl-C) and do "
            f"without the package: ROLLSLIP_DISABLED_PLUGINS={disabled}\n"
        )
        sys.stderr.flush()
