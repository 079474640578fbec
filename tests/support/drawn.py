"""What stands on a figure that was written as SVG."""

import re
from html import unescape
from pathlib import Path


def words(path: Path) -> list[str]:
    """Return the texts, mathematical ones as they were given: matplotlib leaves them beside their letters."""
    found = re.findall(
        r"<!--(.*?)-->|<text style[^>]*>(.*?)</text>", path.read_text(encoding="utf-8"), re.DOTALL
    )
    return [unescape(given or plain).strip() for given, plain in found]
