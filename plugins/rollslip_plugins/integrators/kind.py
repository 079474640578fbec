"""The kind of integrators. The framework does not have it, since it integrates nothing over time."""

from typing import Final

from rollslip.catalogue.kinds import Kind, Template
from rollslip.models import IntegratorModel

__all__ = ["INTEGRATOR"]

INTEGRATOR: Final = Kind(
    name="integrator",
    hook="integrator_models",
    base=IntegratorModel,
    template=Template(
        summary="An integrator",
        contents="the method with its source; `heun.py` beside it: the method as SciPy's `OdeSolver`",
        use="python -c \"import rollslip; print(rollslip.get_model('integrator', '${model}'))\"",
        needs=("attrs>=24.2", "numpy>=2.0", "scipy>=1.15"),
        further_modules=("heun",),
        package="rollslip_plugins.integrators",
    ),
    rules="rollslip_plugins.integrators.rules",
)
