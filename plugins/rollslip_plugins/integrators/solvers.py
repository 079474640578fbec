"""Solvers of SciPy's kind, for ``solve_ivp``: our Rosenbrock method, our leapfrog and CVODE.

- They are separate from the models that offer them, because a base class of SciPy has to be imported.
- For a `rollslip_kernels.motion.system.System` our methods solve linear systems of arrow shape, in work proportional to
  the number of rollers. For any other function they use a dense Jacobian: yours (``jac``) or one by differences.
- Here every step is a call from Python; a study lets the kernel itself take many.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from scipy.integrate import DenseOutput, OdeSolver

from rollslip.search import Array
from rollslip_kernels.motion.leapfrog import Leapfrog
from rollslip_kernels.motion.rosenbrock import Rosenbrock, Stepper
from rollslip_kernels.motion.system import System, python_system

#: Positions in a step at which the polynomial of CVODE is sampled: six Chebyshev points are exact up to degree 5.
_SAMPLES = 0.5 - 0.5 * np.cos(np.pi * np.arange(6) / 5)


class _Ours(OdeSolver):
    """A compiled method of `rollslip_kernels`, for ``scipy.integrate.solve_ivp``.

    Parameters
    ----------
    fun, t0, y0, t_bound
        As for SciPy's solvers; ``fun`` may be a `rollslip_kernels.motion.system.System`.
    max_step, rtol, atol, first_step
        As for SciPy's solvers; rtol >= 2.3e-14, and both tolerances one or for each unknown. Differences take atol/rtol
        for the typical magnitude of an unknown, unless a system gives its own.
    jac
        df/dy of a function: an array, or a function of t and y; None for differences.
    vectorized
        Not used.
    """

    kernel: ClassVar[type[Stepper]]

    def __init__(
        self,
        fun: Callable[[float, Array], Array],
        t0: float,
        y0: Array,
        t_bound: float,
        max_step: float = np.inf,
        rtol: float | Array = 1e-3,
        atol: float | Array = 1e-6,
        jac: Any = None,
        first_step: float | None = None,
        vectorized: bool = False,
    ) -> None:
        super().__init__(fun, t0, y0, t_bound, vectorized)
        if isinstance(fun, System):
            if jac is not None:
                raise ValueError("a System has its own Jacobian; leave jac out")
            capsule = fun.capsule
        else:
            capsule = python_system(
                self.fun_single, self.n, scale=self._scale(rtol, atol), jacobian=_function(jac)
            )
        self._inner = self.kernel(capsule, t0, self.y, t_bound, rtol, atol, max_step, first_step)

    def _scale(self, rtol: float | Array, atol: float | Array) -> Array:
        """Return the typical magnitudes of the unknowns of a function: atol/rtol, or the largest initial value."""
        magnitude = np.broadcast_to(np.divide(atol, rtol), (self.n,))
        return np.where(magnitude > 0, magnitude, np.max(np.abs(self.y), initial=0.0) or 1.0)

    def _step_impl(self) -> tuple[bool, str | None]:
        inner = self._inner
        reason = inner.step()
        self.t = inner.t
        self.y = inner.y
        self.nfev = inner.evaluations
        self.njev = inner.jacobians
        self.nlu = inner.factorisations
        return reason != "failed", inner.message or None

    def _dense_output_impl(self) -> "_Polynomial":
        return _Polynomial(self.t_old, self.t, *self._inner.continuous)


class Rodas5pSolver(_Ours):
    """Rosenbrock method Rodas5P."""

    kernel = Rosenbrock


class LeapfrogSolver(_Ours):
    """Leapfrog with extrapolated speeds, of a system that gives its positions and frequencies, or of any function."""

    kernel = Leapfrog


class CvodeSolver(OdeSolver):
    """CVODE with backward differentiation formulas and a dense Jacobian, for ``scipy.integrate.solve_ivp``.

    Parameters
    ----------
    fun, t0, y0, t_bound, max_step, rtol, atol, first_step
        As for SciPy's solvers; rtol is one number.
    jac
        df/dy: an array, or a function of t and y; None for differences.
    vectorized
        Not used.
    """

    def __init__(
        self,
        fun: Callable[[float, Array], Array],
        t0: float,
        y0: Array,
        t_bound: float,
        max_step: float = np.inf,
        rtol: float = 1e-3,
        atol: float | Array = 1e-6,
        jac: Any = None,
        first_step: float | None = None,
        vectorized: bool = False,
    ) -> None:
        from sksundae.cvode import CVODE

        super().__init__(fun, t0, y0, t_bound, vectorized)

        def rates(t: float, y: Array, into: Array) -> None:
            into[:] = self.fun(t, y.copy())

        self._inner = CVODE(
            rates,
            jacfn=_filling(jac),
            rtol=float(rtol),
            atol=atol if np.ndim(atol) == 0 else np.asarray(atol, dtype=float),
            first_step=first_step or 0.0,
            max_step=max_step if np.isfinite(max_step) else 0.0,
        )
        self._inner.init_step(t0, self.y)

    def _step_impl(self) -> tuple[bool, str | None]:
        done = self._inner.step(self.t_bound, method="onestep", tstop=self.t_bound)
        self.njev = self.nlu = done.njev
        if not done.success:
            return False, f"CVODE at t = {self.t:.9g}: {done.message}"
        self.t = done.t
        self.y = done.y
        return True, None

    def _dense_output_impl(self) -> "_Polynomial":
        # the last one is the current time of CVODE, from which it continues
        times = self.t_old + _SAMPLES * (self.t - self.t_old)
        times[-1] = self.t
        fractions = (times - self.t_old) / (self.t - self.t_old)
        coefficients = np.linalg.solve(
            np.vander(fractions, increasing=True), np.array([self._inner.step(t).y for t in times])
        )
        return _Polynomial(self.t_old, self.t, self.t_old, self.t - self.t_old, coefficients)


class _Polynomial(DenseOutput):
    """A polynomial by the coefficients of the powers of (t - start)/size."""

    def __init__(
        self, t_old: float, t: float, start: float, size: float, coefficients: Array
    ) -> None:
        super().__init__(t_old, t)
        self.start = start
        self.size = size
        self.coefficients = coefficients

    def _call_impl(self, t: Array) -> Array:
        return np.asarray(
            np.polynomial.polynomial.polyval((t - self.start) / self.size, self.coefficients)
        )


def _function(jac: Any) -> Callable[[float, Array], Any] | None:
    """Return a Jacobian as a function that returns a dense array; None for None."""
    if jac is None:
        return None

    def dense(t: float, y: Array) -> Any:
        matrix = jac(t, y) if callable(jac) else jac
        return matrix.toarray() if hasattr(matrix, "toarray") else matrix

    return dense


def _filling(jac: Any) -> Callable[[float, Array, Array, Array], None] | None:
    """Return a Jacobian as a function that fills an array, as CVODE calls it; None for None."""
    if (dense := _function(jac)) is None:
        return None

    def fill(t: float, y: Array, rates: Array, into: Array) -> None:
        into[:] = dense(t, y.copy())

    return fill
