from collections.abc import Sequence

def power(
    boundary: object,
    hydrodynamic: object,
    boundary_limit: float,
    hydrodynamic_limit: float,
    exponent: float,
) -> object: ...
def exponential(boundary: object, hydrodynamic: object, reach: float, factor: float, exponent: float) -> object: ...
def greenwood_tripp(
    boundary: object, hydrodynamic: object, reach: float, coefficient: float, series: Sequence[float]
) -> object: ...
