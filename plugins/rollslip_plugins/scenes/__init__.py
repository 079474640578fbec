"""Built-in scenes, which ``rollslip run NAME`` finds: the bearing of the paper, a gearbox and a turbine."""

from rollslip.datasets import SceneData
from rollslip.hookspecs import hookimpl

__all__ = ["scenes"]

_NAMES = ("1032930-30C", "1032930-50C", "1032930-70C", "gearbox", "turbine")


@hookimpl
def scenes() -> list[SceneData]:
    """Scenes."""
    return [SceneData(name, __name__) for name in _NAMES]
