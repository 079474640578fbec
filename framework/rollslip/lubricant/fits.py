"""Fit viscosity laws to measured points: linear least squares for Walther's law, separable ones for Vogel's."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from rollslip.lubricant.temperature import Vogel, Walther
from rollslip.units import format_quantity

__all__ = ["fit_vogel", "fit_walther"]

#: Smallest pole C of Vogel's law [K]. With a smaller one the law is an exponential of T, and rounding spoils A and B.
#: Doubling its size accepts points whose slope hardly flattens. Chosen: C of measured oils is above 100 K.
_LOWEST_POLE = -1000.0


def fit_walther(
    temperatures: Sequence[float],
    viscosities: Sequence[float],
    density: float,
    constant: float = 0.7,
) -> Walther:
    """Return Walther's law through measured kinematic viscosities.

    It is exact for two points; for more, it is the least-squares line on the axes of ASTM D341, log10 log10(nu + c)
    against log10 T.

    Parameters
    ----------
    temperatures : sequence of float
        T [K], two or more, all different.
    viscosities : sequence of float
        Kinematic viscosity [m2/s] at each.
    density : float
        From kinematic to dynamic viscosity [kg/m3], taken as constant.
    constant : float
        c [mm2/s], 0.7 in ASTM D341.

    Returns
    -------
    Walther

    Raises
    ------
    ValueError
        Too few points, equal temperatures, a viscosity that is not positive, too small for the law (nu + c must exceed
        1 mm2/s) or does not fall with temperature.

    Examples
    --------
    >>> oil = fit_walther([313.15, 373.15], [32e-6, 5.4e-6], density=870.0)
    >>> round(oil(313.15) / 870.0 * 1e6, 9)
    32.0
    """
    T, nu = _ordered("walther", 2, temperatures, viscosities)
    if 1e6 * nu[-1] + constant <= 1.0:
        raise ValueError(
            f"Walther's law with the constant {constant:g} has no value for viscosities down to "
            f"{1e6 * nu[-1]:g} mm2/s, only above {1.0 - constant:g} mm2/s"
        )
    slope, intercept, _ = _line(
        [math.log10(t) for t in T], [math.log10(math.log10(1e6 * v + constant)) for v in nu]
    )
    return Walther(intercept, -slope, constant, 1e-6 * density)


def fit_vogel(temperatures: Sequence[float], viscosities: Sequence[float]) -> Vogel:
    """Return Vogel's law through measured dynamic viscosities.

    It is exact for three points; for more, it has the least squares in ln(eta), that is, in relative error.

    Parameters
    ----------
    temperatures : sequence of float
        T [K], three or more, all different.
    viscosities : sequence of float
        Dynamic viscosity [Pa s] at each.

    Returns
    -------
    Vogel

    Raises
    ------
    ValueError
        Too few points, equal temperatures, a viscosity that is not positive or does not fall with temperature, or
        points on a curve that flattens less than that of any liquid: its C would be below -1000 K.

    Examples
    --------
    >>> oil = fit_vogel([313.15, 343.15, 373.15], [0.030, 0.0095, 0.0045])
    >>> round(oil(343.15), 9)
    0.0095
    """
    T, eta = _ordered("vogel", 3, temperatures, viscosities)
    log_eta = list(map(math.log, eta))
    pole = _pole(T, log_eta)
    if len(T) > 3:
        from scipy.optimize import least_squares

        # For a given C the law is a line in 1/(T - C), so C is the only unknown, as ln(T_min - C) to be below T_min.
        def residuals(log_distance: Any) -> list[float]:
            return _line(_reciprocal(T, T[0] - math.exp(log_distance[0])), log_eta)[2]

        start = math.log(T[0] - min(max(pole, _LOWEST_POLE), T[0] - 2.0))
        # C remains at least 1 K below the lowest temperature
        bounds = (0.0, math.log(T[0] - 2.0 * _LOWEST_POLE))
        fit = least_squares(residuals, [start], bounds=bounds, xtol=1e-12, ftol=1e-12, gtol=1e-12)
        pole = T[0] - math.exp(fit.x[0])
    if pole < _LOWEST_POLE:
        raise ValueError(
            "no Vogel law: the slope of ln(viscosity) hardly flattens with temperature; check the points"
        )
    slope, intercept, _ = _line(_reciprocal(T, pole), log_eta)
    return Vogel(math.exp(intercept), slope, pole)


def _pole(T: list[float], log_eta: list[float]) -> float:
    """Return C of the Vogel law through the first, the middle and the last point; -inf if there is no such law."""
    (T1, T2, T3), (y1, y2, y3) = ((v[0], v[len(v) // 2], v[-1]) for v in (T, log_eta))
    bend = (y1 - y2) * (T3 - T2) / ((y2 - y3) * (T2 - T1))  # = (T3 - C)/(T1 - C)
    return T1 - (T3 - T1) / (bend - 1.0) if bend > 1.0 else -math.inf


def _reciprocal(T: list[float], pole: float) -> list[float]:
    return [1.0 / (t - pole) for t in T]


def _line(x: list[float], y: list[float]) -> tuple[float, float, list[float]]:
    """Return slope, intercept and residuals of the least-squares line."""
    x_mean = math.fsum(x) / len(x)
    y_mean = math.fsum(y) / len(y)
    slope = math.fsum((a - x_mean) * (b - y_mean) for a, b in zip(x, y, strict=True)) / math.fsum(
        (a - x_mean) ** 2 for a in x
    )
    return (
        slope,
        y_mean - slope * x_mean,
        [b - y_mean - slope * (a - x_mean) for a, b in zip(x, y, strict=True)],
    )


def _ordered(
    law: str, minimum: int, temperatures: Sequence[float], viscosities: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return temperatures and viscosities of a fit in ascending order of temperature; refuse invalid ones."""
    if len(temperatures) != len(viscosities):
        raise ValueError(f"{len(temperatures)} temperatures but {len(viscosities)} viscosities")
    if len(temperatures) < minimum:
        raise ValueError(f"the {law} law needs {minimum} or more points, got {len(temperatures)}")
    points = sorted((float(T), float(v)) for T, v in zip(temperatures, viscosities, strict=True))
    for T, v in points:
        if not (0.0 < T < math.inf and 0.0 < v < math.inf):
            raise ValueError(f"temperature and viscosity must be positive, got {v:g} at {T:g} K")
    for (T1, v1), (T2, v2) in pairwise(points):
        if T1 == T2:
            raise ValueError(
                f"two points at {format_quantity(T1, 'K')}: give each temperature once"
            )
        if v1 <= v2:
            raise ValueError(
                f"the viscosity does not fall from {format_quantity(T1, 'K')} to {format_quantity(T2, 'K')}"
            )
    return [T for T, _ in points], [v for _, v in points]
