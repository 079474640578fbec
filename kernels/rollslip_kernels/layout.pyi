from collections.abc import Mapping
from typing import Final

CONDITIONS: Final[Mapping[str, tuple[str, str]]]
COLUMNS: Final[Mapping[str, tuple[str, str]]]
PLACES: Final[tuple[str, ...]]

def layout() -> tuple[int, dict[str, int]]: ...
