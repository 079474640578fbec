"""The frame of a figure: panels, above them a legend for which it grows by a row each, labels of the axes."""

import textwrap
from typing import TYPE_CHECKING, Any, Final

from rollslip.results.style import ONE_COLUMN, ROW

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

__all__ = ["Sheet"]

#: Width of a letter of a legend and of the line before it [inch]: what is longer than its column is wrapped.
_LETTER: Final = 0.051
_HANDLE: Final = 0.35


class Sheet:
    """A figure that is being drawn: ``axes`` as Matplotlib gives them for panels, ``handles`` of its legend."""

    def __init__(self, size: tuple[float, float] = ONE_COLUMN, *panels: Any, **options: Any) -> None:
        from matplotlib.figure import Figure

        self.figure = Figure(figsize=size, layout="constrained")
        place: Any = self.figure.subplot_mosaic if isinstance(next(iter(panels), 1), list) else self.figure.subplots
        self.axes: Any = place(*panels, **options)
        self.handles: list[Artist] = []

    def line(self, x: Any, y: Any, label: str, axes: Any = None, **style: Any) -> None:
        """Draw a line, or points, that the legend shows."""
        self.handles += (axes or self.axes).plot(x, y, label=label, **style)

    def mark(self, x: Any, y: Any, label: str, **style: Any) -> None:
        """Draw black points that the legend shows."""
        self.line(x, y, label, linestyle="none", color="black", **style)

    def key(self, label: str, **style: Any) -> None:
        """Put into the legend what is drawn otherwise."""
        from matplotlib.lines import Line2D

        self.handles.append(Line2D([], [], label=label, **style))

    def done(
        self, x: str = "", y: str = "", *, columns: int = 1, height: float | None = None, title: str = "", **legend: Any
    ) -> "Figure":
        """Label the axes of a single panel, put the legend above and make room for it; ``height`` is that without."""
        if x:
            self.axes.set_xlabel(x)
            self.axes.set_ylabel(y)
        each = -(-len(self.handles) // columns) or 1  # Matplotlib fills columns
        of = [self.handles[k : k + each] for k in range(0, len(self.handles), each)]
        long = sum(max(len(str(one.get_label())) for one in column) for column in of)
        if (width := self.figure.get_figwidth()) < _LETTER * long + _HANDLE * len(of):
            for handle in self.handles:
                room = int((width / len(of) - _HANDLE) / _LETTER)
                handle.set_label(textwrap.fill(str(handle.get_label()), room, break_on_hyphens=False))
        rows = max((sum(str(one.get_label()).count("\n") + 1 for one in column) for column in of), default=0)
        if self.handles:
            about = {"title": title, "alignment": "left"} if title else {}
            self.figure.legend(handles=self.handles, ncols=columns, **{"loc": "outside upper left", **about, **legend})
        without = self.figure.get_figheight() if height is None else height
        self.figure.set_figheight(without + ROW * (rows + bool(title)))
        return self.figure
