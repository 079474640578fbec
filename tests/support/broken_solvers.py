"""The solvers of the integrators in `broken_models`, apart from them since SciPy takes its time to import."""

import numpy as np
from scipy.integrate import DOP853, RK23, RK45, solve_ivp

__all__ = [
    "RK23",
    "RK45",
    "Careful",
    "Careless",
    "FixedStep",
    "Forwards",
    "Hides",
    "Straight",
    "WithinATurn",
    "solve_ivp",
]


class Careful(DOP853):
    """As exact as numbers of 16 digits allow, at any tolerance."""

    def __init__(self, fun, t0, y0, t_bound, rtol=1e-3, atol=1e-6, **options):
        super().__init__(
            fun, t0, y0, t_bound, rtol=1e-13, atol=1e-13, **{"max_step": 0.02, **options}
        )


class Careless(RK45):
    def __init__(self, fun, t0, y0, t_bound, rtol=1e-3, atol=1e-6, **options):
        super().__init__(
            fun, t0, y0, t_bound, rtol=max(rtol, 1e-2), atol=max(atol, 1e-2), **options
        )


class Straight(RK45):
    def _dense_output_impl(self):
        step = super()._dense_output_impl()
        start = self.y_old
        end = self.y

        def line(t):
            fraction = (t - step.t_old) / step.h
            return (
                start + (end - start) * fraction
                if np.ndim(t) == 0
                else start[:, None] + np.outer(end - start, fraction)
            )

        step._call_impl = line
        return step


class Forwards(RK45):
    def __init__(self, fun, t0, y0, t_bound, **options):
        if t_bound < t0:
            raise ValueError("t_bound must be above t0")
        super().__init__(fun, t0, y0, t_bound, **options)


class FixedStep(RK45):
    def __init__(self, fun, t0, y0, t_bound, rtol=1e-3, atol=1e-6, **options):
        super().__init__(
            fun,
            t0,
            y0,
            t_bound,
            rtol=1.0,
            atol=1.0,
            **{"first_step": 2e-3, "max_step": 2e-3, **options},
        )


class Hides(RK45):
    def step(self):
        message = super().step()
        if self.status == "failed":
            self.status = "finished"
        return message


class WithinATurn(RK45):
    def step(self):
        message = super().step()
        self.y = np.where(self.y > 2.0 * np.pi, self.y - 2.0 * np.pi, self.y)
        return message
