"""Rosenbrock integrator for stiff problems, compiled: see rollslip_kernels.motion.rosenbrock."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar

import attrs

from rollslip.models import IntegratorModel
from rollslip.references import Reference
from rollslip_plugins.bibliography import HAIRER_1996, STEINEBACH_2023


@attrs.frozen
class Rodas5p(IntegratorModel):
    """Rosenbrock-Wanner method of order 5(4) by Steinebach, for stiff problems, with linear algebra of arrow shape.

    A step solves eight linear systems with one matrix and iterates nothing, so that a stiff problem costs what its
    accuracy asks for. L-stable and stiffly accurate; continuous output of order 4.

    Range: stiff problems and others; relative tolerances from 2.3e-14.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Rodas5p().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "rodas5p"
    order: ClassVar[int] = 5
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType(
        {
            "check_converges_with_its_order": "the check's problem is linear with constant coefficients, on which this "
            "method has order 6"
        }
    )
    equation: ClassVar[str] = (
        "dy/dt = f(t, y); linearly implicit, L-stable, order 5, error estimate of order 4"
    )
    references: ClassVar[tuple[Reference, ...]] = (STEINEBACH_2023, HAIRER_1996)

    def solver(self) -> type[Any]:
        """Return the OdeSolver class."""
        from rollslip_plugins.integrators.solvers import Rodas5pSolver

        return Rodas5pSolver

    def compiled(self) -> type[Any]:
        """Return the kernel."""
        from rollslip_kernels.motion.rosenbrock import Rosenbrock

        return Rosenbrock
