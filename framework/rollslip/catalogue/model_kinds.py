"""The kinds of models and data, whose base classes stand left of this folder, and of campaigns."""

from typing import Final

from rollslip.catalogue.campaign import Campaign
from rollslip.catalogue.kinds import Kind, Template
from rollslip.datasets import BearingData, FitData, SurfaceData
from rollslip.engine import Engine
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import ContactModel, Drag, FilmModel, IntegratorModel, PressureModel, TractionModel

_LAW: Final = "the law in NumPy, what it reads and where it is defined"
_SCENE: Final = "rollslip run 1032930-70C --set {key}=${{model}}"
_PYTHON: Final = "python -c \"import rollslip; print(rollslip.get_model('{kind}', '${{model}}'))\""

CONTACT: Final = Kind(
    name="contact",
    hook="contact_models",
    base=ContactModel,
    template=Template(
        summary="A contact model",
        contents=_LAW,
        use=_SCENE.format(key="models.contact"),
        classes=("ContactModel", "SliceModel"),
        compiled=True,
    ),
)
FILM: Final = Kind(
    name="film",
    hook="film_models",
    base=FilmModel,
    template=Template(
        summary="A film model",
        contents=_LAW,
        use=_SCENE.format(key="models.film"),
        classes=("FilmModel",),
        compiled=True,
    ),
)
PRESSURE: Final = Kind(
    name="pressure",
    hook="pressure_models",
    base=PressureModel,
    template=Template(
        summary="A model of the pressure in a film",
        contents=_LAW,
        use=_SCENE.format(key="models.pressure"),
        classes=("PressureModel",),
        compiled=True,
    ),
)
TRACTION: Final = Kind(
    name="traction",
    hook="traction_models",
    base=TractionModel,
    template=Template(
        summary="A traction model",
        contents=_LAW,
        use=_SCENE.format(key="models.traction.hydrodynamic"),
        classes=("TractionModel",),
        compiled=True,
    ),
)
PRESSURE_VISCOSITY: Final = Kind(
    name="pressure-viscosity",
    hook="pressure_viscosity_laws",
    base=PressureViscosity,
    template=Template(
        summary="A law of viscosity under pressure",
        contents=_LAW,
        use=_SCENE.format(key="lubricant.pressure_viscosity_law"),
        classes=("PressureViscosity",),
        compiled=True,
    ),
)
DRAG: Final = Kind(
    name="drag",
    hook="drag_models",
    base=Drag,
    template=Template(
        summary="A drag model",
        contents="the law",
        use=_PYTHON.format(kind="drag"),
        classes=("DragModel",),
        needs=("attrs>=24.2",),
        compiled=True,
    ),
)
INTEGRATOR: Final = Kind(
    name="integrator",
    hook="integrator_models",
    base=IntegratorModel,
    template=Template(
        summary="An integrator",
        contents="the method with its source; `heun.py` beside it: the method as SciPy's `OdeSolver`",
        use=_PYTHON.format(kind="integrator"),
        classes=("IntegratorModel", "HeunSolver", "Any"),
        needs=("attrs>=24.2", "numpy>=2.0", "scipy>=1.15"),
        beside=("heun",),
    ),
)
ENGINE: Final = Kind(
    name="engine",
    hook="engines",
    base=Engine,
    template=Template(
        summary="An engine of sweeps",
        contents="the executor that computes the points",
        use="rollslip sweep run 1032930-70C --over operation.radial_load=500N:5000N:5 --engine ${model}",
        classes=("Engine", "Executor"),
        needs=("attrs>=24.2",),
    ),
)
LUBRICANT: Final = Kind(
    name="lubricant",
    hook="lubricants",
    base=Lubricant,
    data=True,
    template=Template(
        summary="A lubricant",
        contents="the oil and the sources of its data",
        use=_SCENE.format(key="lubricant.name"),
        needs=(),
    ),
)
BEARING: Final = Kind(
    name="bearing",
    hook="bearings",
    base=BearingData,
    data=True,
    template=Template(
        summary="A bearing",
        contents="the bearing and the sources of its data",
        use=_PYTHON.format(kind="bearing"),
        needs=(),
    ),
)
SURFACE: Final = Kind(
    name="surface",
    hook="surfaces",
    base=SurfaceData,
    data=True,
    template=Template(
        summary="Surfaces",
        contents="their roughness and the sources of it",
        use=_PYTHON.format(kind="surface"),
        needs=(),
    ),
)
FIT: Final = Kind(name="fit", hook="fits", base=FitData, data=True)
CAMPAIGN: Final = Kind(name="campaign", hook="campaigns", base=Campaign, data=True)
