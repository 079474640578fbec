"""What stands on a figure that was written as SVG."""

import itertools
import re
import xml.etree.ElementTree as ET
from html import unescape
from pathlib import Path


def metadata(path: Path, name: str) -> str | None:
    """Return an entry of the metadata, by its name of the Dublin Core."""
    return next(
        e.text
        for e in ET.parse(path).iter()
        if e.tag == f"{{http://purl.org/dc/elements/1.1/}}{name}"
    )


def words(path: Path) -> list[str]:
    """Return the texts, mathematical ones as they were given: matplotlib leaves them beside their letters."""
    found = re.findall(
        r"<!--(.*?)-->|<text style[^>]*>(.*?)</text>", path.read_text(encoding="utf-8"), re.DOTALL
    )
    return [unescape(given or plain).strip() for given, plain in found]


def overlapping(axis, renderer):
    """Labels of ticks of an axis that overlap the next one; those outside of the axis are not drawn."""
    low, high = sorted(axis.get_view_interval())
    labels = [
        tick.label1
        for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
        if low <= tick.get_loc() <= high and tick.label1.get_text() and tick.label1.get_visible()
    ]
    boxes = sorted(
        (label.get_window_extent(renderer) for label in labels), key=lambda b: tuple(b.min)
    )
    return [pair for pair in itertools.pairwise(boxes) if pair[0].overlaps(pair[1])]
