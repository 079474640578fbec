"""The kinds of models and data, whose base classes stand left of this folder."""

from typing import Any, Final

from rollslip.catalogue.kinds import Kind, Template
from rollslip.datasets import BearingData, FitData, SceneData, SurfaceData
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import ContactModel, Drag, FilmModel, PressureModel, TractionModel
from rollslip.rings import RingModel
from rollslip_kernels.slices import COLUMNS, CONDITIONS

_ATTRS: Final = ("attrs>=24.2",)
_SCENE: Final = "rollslip run 1032930-70C --set {}=${{model}}"
_PYTHON: Final = "python -c \"import rollslip; print(rollslip.get_model('{}', '${{model}}'))\""


def _columns_fault(law: Any) -> str:
    """Say which column a class of laws reads, fills or adds that it cannot; an empty string if there is none."""
    known = {*COLUMNS, *CONDITIONS}
    for what in ("reads", "writes"):
        names = getattr(law, what, ())
        if isinstance(names, frozenset) and (unknown := sorted(names - known)):
            return (
                f"class {law.__name__}: {what} has {unknown[0]!r}, which is no column of slices; what a law gives "
                "beside these stands in outputs, and quantities() returns it"
            )
    if taken := sorted(known & {*getattr(law, "outputs", ())}):
        return f"class {law.__name__}: outputs has {taken[0]!r}, which is a column of all slices; give it another name"
    return ""


def _law(name: str, base: Any, hook: str, summary: str, key: str, *classes: str) -> Kind:
    """Return a kind of laws with a compiled form, which a scene names by a key."""
    contents, use = "the law in NumPy, what it reads and where it is defined", _SCENE.format(key)
    template = Template(summary=summary, contents=contents, use=use, classes=(base.__name__, *classes), compiled=True)
    return Kind(
        name=name,
        hook=hook,
        base=base,
        template=template,
        from_scene=base is not PressureViscosity,
        check=_columns_fault,
    )


def _data(name: str, base: Any, summary: str, contents: str, use: str, whose: str = "its data") -> Kind:
    """Return a kind of named values, which need nothing but rollslip."""
    template = Template(summary=summary, contents=f"{contents} and the sources of {whose}", use=use, needs=())
    return Kind(name=name, hook=f"{name}s", base=base, data=True, template=template)


CONTACT: Final = _law("contact", ContactModel, "contact_models", "A contact model", "models.contact", "SliceModel")
FILM: Final = _law("film", FilmModel, "film_models", "A film model", "models.film")
PRESSURE: Final = _law(
    "pressure", PressureModel, "pressure_models", "A model of the pressure in a film", "models.pressure"
)
TRACTION: Final = _law("traction", TractionModel, "traction_models", "A traction model", "models.traction.hydrodynamic")
PRESSURE_VISCOSITY: Final = _law(
    "pressure-viscosity", PressureViscosity, "pressure_viscosity_laws", "A law of viscosity under pressure",
    "lubricant.pressure_viscosity_law",
)  # fmt: skip
DRAG: Final = Kind(
    name="drag", hook="drag_models", base=Drag, from_scene=True, check=_columns_fault,
    template=Template(
        summary="A drag model", contents="the law", use=_PYTHON.format("drag"), classes=("DragModel",), needs=_ATTRS,
        compiled=True,
    ),
)  # fmt: skip
RING: Final = Kind(
    name="ring", hook="ring_models", base=RingModel,
    template=Template(
        summary="A model of rings that yield",
        contents="the shapes in which a ring yields, with their stiffness",
        use="rollslip run 1032930-70C --set models.outer_ring=${model}",
        classes=("RingModel", "RingShapes"),
    ),
)  # fmt: skip
LUBRICANT: Final = _data("lubricant", Lubricant, "A lubricant", "the oil", _SCENE.format("lubricant.name"))
BEARING: Final = _data("bearing", BearingData, "A bearing", "the bearing", _PYTHON.format("bearing"))
SURFACE: Final = _data("surface", SurfaceData, "Surfaces", "their roughness", _PYTHON.format("surface"), whose="it")
FIT: Final = Kind(name="fit", hook="fits", base=FitData, data=True)
SCENE: Final = Kind(name="scene", hook="scenes", base=SceneData, data=True)
