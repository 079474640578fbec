"""What stands on a figure that was written as SVG."""

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
