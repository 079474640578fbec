"""What a campaign is, and which there are: many runs that answer one question, by a command and by a function.

- Found through the entry points ``rollslip.campaign``, ours like a stranger's; command line and `rollslip` know none by
  name. What they show of it stands in its value, so that ``rollslip --help`` imports neither commands nor functions.
- Ours are read past `rollslip.catalogue.discovery`, whose imports take as long as all of ``--help`` may. A name that a
  stranger offers, or ours and a stranger, is found there, with every fault in a sentence.
"""

import importlib.metadata
import pkgutil
from collections.abc import Mapping
from functools import cache
from typing import Any

import attrs

from rollslip.catalogue.kinds import entry_points
from rollslip.errors import PluginError, in_words

__all__ = ["Campaign", "campaign", "campaigns"]


@attrs.frozen(kw_only=True)
class Campaign:
    """Many runs that answer one question.

    Attributes
    ----------
    name : str
        Name of its command, ``rollslip NAME``, and of its function, ``rollslip.NAME`` with ``_`` for a hyphen.
    summary : str
        What the command does, as its help begins.
    command : str
        Where the command is, a `click.Command`: ``module:name``. What it needs it imports when it runs.
    function : str
        Where the function is, likewise; empty if there is none.
    """

    name: str
    summary: str
    command: str
    function: str = ""

    def load_command(self) -> Any:
        """Return the command."""
        try:
            return pkgutil.resolve_name(self.command)
        except (Exception, SystemExit) as error:
            blame = f"campaign {self.name!r}: its command {self.command} cannot be imported ({in_words(error)})"
            raise PluginError(f"{blame}; repair or uninstall its package") from error


@cache
def _points() -> Mapping[str, Mapping[str, importlib.metadata.EntryPoint]]:
    """Entry points by name, each by package."""
    found = dict[str, dict[str, importlib.metadata.EntryPoint]]()
    for package, point in entry_points("rollslip.campaign"):
        found.setdefault(point.name, {})[package] = point
    return found


def campaigns() -> tuple[str, ...]:
    """Return the names of all campaigns, usable or not, without importing any."""
    return tuple(sorted(_points()))


def campaign(name: str) -> Campaign:
    """Return a campaign by name."""
    points = _points().get(name, {})
    if [*points] == ["rollslip"]:
        found: Campaign = next(one for one in points["rollslip"].load().campaigns() if one.name == name)
    else:
        from rollslip.catalogue.discovery import get_class

        found = get_class("campaign", name)
    return found
