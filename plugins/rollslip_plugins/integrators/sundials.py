"""CVODE of SUNDIALS through scikit-sundae: an extra, which is imported when its solver is requested."""

from typing import Any, ClassVar

import attrs

from rollslip.errors import PluginError
from rollslip.models import IntegratorModel
from rollslip.references import Reference
from rollslip_plugins.bibliography import COHEN_1996, HINDMARSH_2005


@attrs.frozen
class Cvode(IntegratorModel):
    """Backward differentiation formulas of variable order 1 to 5 (SUNDIALS), for stiff problems.

    Needs scikit-sundae: ``pip install 'rollslip[sundials]'``.

    Range: as ``bdf``; relative tolerances are one number.

    Examples
    --------
    y' = -y over unit time: 1/e = 0.367879.

    >>> from scipy.integrate import solve_ivp
    >>> found = solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method=Cvode().solver(), rtol=1e-8, atol=1e-10)
    >>> f"{found.y[0, -1]:.6f}"
    '0.367879'
    """

    name: ClassVar[str] = "cvode"
    equation: ClassVar[str] = "dy/dt = f(t, y); implicit, order 1 to 5, variable coefficients"
    references: ClassVar[tuple[Reference, ...]] = (COHEN_1996, HINDMARSH_2005)

    def solver(self) -> type[Any]:
        """Return the OdeSolver class."""
        try:
            import sksundae.cvode  # noqa: F401
        except ImportError as error:
            raise PluginError(
                f"integrator 'cvode' needs scikit-sundae, which cannot be imported ({error}); install it with "
                "pip install 'rollslip[sundials]', or take 'rodas5p', 'bdf' or 'radau'"
            ) from error
        from rollslip_plugins.integrators.solvers import CvodeSolver

        return CvodeSolver
