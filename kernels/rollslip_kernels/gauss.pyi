import numpy as np
from numpy.typing import NDArray

def rules(
    load: NDArray[np.float64], weight: NDArray[np.float64], begin: NDArray[np.intp], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def row_rules(
    load: NDArray[np.float64], width: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def legendre(n: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
