"""SciPy's integrators of ordinary differential equations, by name."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar

import attrs

from rollslip.models import IntegratorModel
from rollslip.references import Reference
from rollslip_plugins.bibliography import (
    BOGACKI_1989,
    DORMAND_1980,
    HAIRER_1993,
    HAIRER_1996,
    PETZOLD_1983,
    SHAMPINE_1997,
)


class _SciPy(IntegratorModel):
    """A solver of ``scipy.integrate``."""

    solver_name: ClassVar[str]

    def solver(self) -> type[Any]:
        """Return the OdeSolver class; SciPy is imported here, so that listing the integrators does not."""
        import scipy.integrate

        return getattr(scipy.integrate, self.solver_name)  # type: ignore[no-any-return]


@attrs.frozen
class Rk23(_SciPy):
    """Explicit Runge-Kutta method of order 3(2) by Bogacki and Shampine.

    Range: problems that are not stiff, at tolerances of 1e-3 or more.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Rk23().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "rk23"
    order: ClassVar[int] = 3
    explicit: ClassVar[bool] = True
    solver_name: ClassVar[str] = "RK23"
    equation: ClassVar[str] = "dy/dt = f(t, y); explicit, order 3, error estimate of order 2"
    references: ClassVar[tuple[Reference, ...]] = (BOGACKI_1989,)


@attrs.frozen
class Rk45(_SciPy):
    """Explicit Runge-Kutta method of order 5(4) by Dormand and Prince.

    Through the motion of a bearing, whose rates are compiled, it steps without Python and without SciPy: the same
    formulas, with the largest error of any unknown in its tolerance where SciPy's form takes their root mean square,
    and in contacts with steps of at most 0.4 over their frequency [rad/s], up to which it goes before.

    Range: problems that are not stiff, at usual tolerances.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Rk45().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "rk45"
    order: ClassVar[int] = 5
    explicit: ClassVar[bool] = True
    solver_name: ClassVar[str] = "RK45"
    equation: ClassVar[str] = "dy/dt = f(t, y); explicit, order 5, error estimate of order 4"
    references: ClassVar[tuple[Reference, ...]] = (DORMAND_1980,)

    def compiled(self) -> type[Any]:
        """Return the kernel."""
        from rollslip_kernels.motion.rosenbrock import DormandPrince

        return DormandPrince


@attrs.frozen
class Dop853(_SciPy):
    """Explicit Runge-Kutta method of order 8(5,3) by Dormand and Prince.

    Range: problems that are not stiff, at tolerances below 1e-6.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Dop853().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "dop853"
    order: ClassVar[int] = 8
    explicit: ClassVar[bool] = True
    solver_name: ClassVar[str] = "DOP853"
    equation: ClassVar[str] = "dy/dt = f(t, y); explicit, order 8, error estimates of order 5 and 3"
    references: ClassVar[tuple[Reference, ...]] = (HAIRER_1993,)


@attrs.frozen
class Radau(_SciPy):
    """Implicit Runge-Kutta method of the Radau IIA family of order 5, for stiff problems.

    Range: stiff problems, L-stable; a dense Jacobian of n unknowns costs work of n^3.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Radau().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "radau"
    order: ClassVar[int] = 5
    solver_name: ClassVar[str] = "Radau"
    equation: ClassVar[str] = "dy/dt = f(t, y); implicit, L-stable, order 5"
    references: ClassVar[tuple[Reference, ...]] = (HAIRER_1996,)


@attrs.frozen
class Bdf(_SciPy):
    """Backward differentiation formulas of variable order 1 to 5, for stiff problems.

    Range: stiff problems without undamped oscillation, for which orders above 2 are not stable.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Bdf().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "bdf"
    solver_name: ClassVar[str] = "BDF"
    equation: ClassVar[str] = "dy/dt = f(t, y); implicit, order 1 to 5"
    references: ClassVar[tuple[Reference, ...]] = (SHAMPINE_1997,)


@attrs.frozen
class Lsoda(_SciPy):
    """Adams and BDF methods with automatic switch between them (ODEPACK).

    Range: problems that are stiff at times; before a singularity it steps on the spot and reports no failure.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Lsoda().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "lsoda"
    solver_name: ClassVar[str] = "LSODA"
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "check_reports_a_failure": "SciPy's LSODA steps on the spot before a singularity and reports no failure"
        }
    )
    equation: ClassVar[str] = "dy/dt = f(t, y); Adams where it is not stiff, BDF where it is"
    references: ClassVar[tuple[Reference, ...]] = (PETZOLD_1983,)
