"""The kinds of models and data whose base classes are in packages that the catalogue may import."""

from types import MappingProxyType
from typing import Any, Final

from rollslip.catalogue.kinds import Kind, Template
from rollslip.datasets import BearingData, SceneData
from rollslip.lubricant.oil import Lubricant
from rollslip.lubricant.pressure import PressureViscosity
from rollslip.models import ContactModel, Drag, FilmModel, PressureModel, RibModel, TractionModel
from rollslip.rings import RingModel
from rollslip_kernels.slices import COLUMNS, CONDITIONS

_ATTRS: Final = ("attrs>=24.2",)
_SCENE: Final = "rollslip run 1032930-70C --set {}=${{model}}"
_PYTHON: Final = "python -c \"import rollslip; print(rollslip.get_model('{}', '${{model}}'))\""


def _columns_fault(law: Any) -> str:
    """Return the fault of a class of laws that reads, fills or adds a wrong column; empty if there is none."""
    known = {*COLUMNS, *CONDITIONS}
    for what in ("reads", "writes"):
        names = getattr(law, what, ())
        if isinstance(names, frozenset) and (unknown := sorted(names - known)):
            return (
                f"class {law.__name__}: {what} has {unknown[0]!r}, which is not a column of slices; what a law gives "
                "beside these stands in outputs, and quantities() returns it"
            )
    if taken := sorted(known & {*getattr(law, "outputs", ())}):
        return f"class {law.__name__}: outputs has {taken[0]!r}, which is a column of all slices; give it another name"
    return ""


def _law(name: str, base: Any, hook: str, template: Template | None = None) -> Kind:
    """Return a kind of laws with a compiled form."""
    return Kind(
        name=name,
        hook=hook,
        base=base,
        template=template,
        from_scene=base is not PressureViscosity,
        check=_columns_fault,
    )


def _law_template(summary: str, key: str) -> Template:
    """Return the template of a kind of laws that a scene names at a ``key``; ``summary`` describes it."""
    contents = "the law in NumPy, what it reads and where it is defined"
    return Template(summary=summary, contents=contents, use=_SCENE.format(key), compiled=True)


def _data(
    name: str, base: Any, hook: str, template: Template | None = None, listed: bool = True
) -> Kind:
    """Return a kind of named data."""
    return Kind(name=name, hook=hook, base=base, data=True, template=template, listed=listed)


CONTACT: Final = _law(
    "contact", ContactModel, "contact_models", _law_template("A contact model", "models.contact")
)
FILM: Final = _law("film", FilmModel, "film_models", _law_template("A film model", "models.film"))
PRESSURE: Final = _law("pressure", PressureModel, "pressure_models")
TRACTION: Final = _law(
    "traction",
    TractionModel,
    "traction_models",
    _law_template("A traction model", "models.traction.hydrodynamic"),
)
PRESSURE_VISCOSITY: Final = _law("pressure-viscosity", PressureViscosity, "pressure_viscosity_laws")
DRAG: Final = _law(
    "drag",
    Drag,
    "drag_models",
    Template(
        summary="A drag model",
        contents="the law",
        use=_PYTHON.format("drag"),
        needs=_ATTRS,
        compiled=True,
        variants=MappingProxyType(
            {
                "resistance": Template(
                    summary="A rolling resistance",
                    contents="the law",
                    use=_PYTHON.format("drag"),
                    file="resistance",
                )
            }
        ),
    ),
)
RIB: Final = Kind(name="rib", hook="rib_models", base=RibModel)
RING: Final = Kind(name="ring", hook="ring_models", base=RingModel)
LUBRICANT: Final = _data(
    "lubricant",
    Lubricant,
    "lubricants",
    Template(
        summary="A lubricant",
        contents="the oil and the sources of its data",
        use=_SCENE.format("lubricant.name"),
        needs=(),
    ),
)
BEARING: Final = _data("bearing", BearingData, "bearings")
SCENE: Final = _data("scene", SceneData, "scenes", listed=False)
