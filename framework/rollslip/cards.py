"""Cards: how scenes, plans and models show themselves in a notebook, a name and a small table in HTML."""

from collections.abc import Iterable
from html import escape
from typing import Any

import attrs

__all__ = ["Card"]


class Card:
    """Gives what derives from it a card in notebooks.

    It has no colours of its own, so that it is read on a light and on a dark ground.
    """

    __slots__ = ()

    def card(self) -> tuple[str, Iterable[tuple[str, str]]]:
        """Return what the card is called, and rows of name and text; of a model its law, parameters and sources."""
        rows = [("equation", getattr(self, "equation", ""))]
        own: Any = type(self)
        for one in attrs.fields(own) if attrs.has(own) else ():
            rows.append((one.name, _in_unit(getattr(self, one.name), one.metadata.get("unit"))))
        rows += [("source", str(one)) for one in getattr(self, "references", ())]
        return getattr(self, "name", own.__name__), [row for row in rows if row[1]]

    def _repr_html_(self) -> str:
        title, rows = self.card()
        cells = "".join(
            f'<tr><th style="text-align:left;vertical-align:top">{escape(name)}</th>'
            f'<td style="text-align:left">{escape(text)}</td></tr>'
            for name, text in rows
        )
        return f'<div><strong>{escape(title)}</strong><table style="color:inherit">{cells}</table></div>'


def _in_unit(value: Any, unit: str | None) -> str:
    if value is None:
        return ""
    if type(value) in (int, float):
        return f"{value:g}" if unit in (None, "1") else f"{value:g} {unit}"
    return str(getattr(value, "name", value))
