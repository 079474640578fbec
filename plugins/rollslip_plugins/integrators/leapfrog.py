"""Leapfrog integrator for oscillations with hardly any damping, compiled: see rollslip_kernels.motion.leapfrog."""

from typing import Any, ClassVar

import attrs

from rollslip.models import IntegratorModel
from rollslip.references import Reference
from rollslip_plugins.bibliography import HAIRER_2003


@attrs.frozen
class Leapfrog(IntegratorModel):
    """Leapfrog (Störmer and Verlet) with extrapolated speeds, of order 2, one evaluation of the rates a step.

    Through the motion of a bearing its step is fixed at a relative tolerance of 1e-5 and above, below it goes with the
    square root of the tolerance. At level pocket it is 0.2 over the frequency of a roller on a bar of its pocket
    [rad/s], and longer while nothing touches; at level planar 1.4 over the frequency of a roller between the rings,
    while what touches is gone through in parts of 0.1 over its own. Friction is evaluated every 1 to 32 steps and held
    linear between them, so that it goes off by 1e-3 at usual tolerances. Where
    friction is damped by more than 0.3 in a step it is solved for; where it is by more than 4, or anything else by more
    than 0.3, the run ends with a message. For any other function, and at level cage-set, the step is held to tolerance
    by a tenth of the difference from Euler's method.

    Range: the levels pocket and planar without a film in the pockets, at usual tolerances.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.36788.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Leapfrog().solver(), rtol=1e-7, atol=1e-7)
    >>> f"{found.y[0, -1]:.5f}"
    '0.36788'
    """

    name: ClassVar[str] = "leapfrog"
    order: ClassVar[int] = 2
    explicit: ClassVar[bool] = True
    equation: ClassVar[str] = (
        "dy/dt = f(t, y); explicit, order 2, with the rates in the middle of a step"
    )
    references: ClassVar[tuple[Reference, ...]] = (HAIRER_2003,)

    def solver(self) -> type[Any]:
        """Return the OdeSolver class."""
        from rollslip_plugins.integrators.solvers import LeapfrogSolver

        return LeapfrogSolver

    def compiled(self) -> type[Any]:
        """Return the kernel."""
        from rollslip_kernels.motion.leapfrog import Leapfrog as Kernel

        return Kernel
