"""A REXS file as what it holds: components with their attributes, which belong together, and load cases.

REXS (Reusable Engineering EXchange Standard, https://www.rexs.info) is the exchange format of gearbox programs. The XML
of versions 1.0 to 2.0 is read: ``model`` with ``relations``, ``components`` and ``load_spectrum``.

A load spectrum is a main model, the components, with a ``load_case`` for each variation. A load case has the components
that vary by their ids, with the attributes that vary alone; both together are a model that can be computed
(https://spec.rexs.info/1.6/en/root-load-spectrum.html).
"""

import math
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator

import attrs
from rollslip.errors import SceneError
from rollslip.files import faults_of

VERSIONS = re.compile(r"1\.\d+|2\.0(\.\d+)?")
#: Unit of REXS -> unit of rollslip, and what a number in the first is to be multiplied by.
UNITS = {
    "mm": ("mm", 1.0),
    "mum": ("um", 1.0),
    "1 / min": ("rpm", 1.0),
    "rad / s": ("rad/s", 1.0),
    "C": ("degC", 1.0),
    "K": ("K", 1.0),
    "N": ("N", 1.0),
    "kN": ("kN", 1.0),
    "mm^2 / s": ("mm2/s", 1.0),
    "kg / dm^3": ("kg/m3", 1000.0),
    "N / mm^2": ("MPa", 1.0),
    "MPa": ("MPa", 1.0),
    "h": ("h", 1.0),
    "%": ("%", 1.0),
    "none": ("1", 1.0),
}


@attrs.frozen
class Component:
    """A component with its attributes: id -> (unit, text)."""

    id: str
    type: str
    name: str
    attributes: dict[str, tuple[str, str]]

    def __str__(self) -> str:
        return f"{self.type} {self.id}"

    def number(self, attribute: str, problems: list[str]) -> tuple[float, str] | None:
        """A number in a unit of rollslip; None if it is missing, or wrong, which `problems` then says."""
        if attribute not in self.attributes:
            return None
        unit, text = self.attributes[attribute]
        if unit not in UNITS:
            problems.append(f"{self}, {attribute}: unit {unit!r} is not read; there are: {', '.join(UNITS)}")
            return None
        ours, factor = UNITS[unit]
        try:
            value = float(text) * factor
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            problems.append(f"{self}, {attribute}: {text!r} is not a finite number")
            return None
        return value, ours


@attrs.frozen
class LoadCase:
    """A load case: the attributes of components that it states, by the id of the component."""

    id: str
    attributes: dict[str, dict[str, tuple[str, str]]]


@attrs.frozen
class Model:
    """What a file holds."""

    application: str
    components: dict[str, Component]
    relations: tuple[tuple[str, ...], ...]
    load_cases: tuple[LoadCase, ...]

    def at(self, case: LoadCase) -> "Model":
        """The model with the attributes of a load case in place of those of the components."""
        components = {
            id: attrs.evolve(self.components[id], attributes=self.components[id].attributes | own)
            for id, own in case.attributes.items()
        }
        return attrs.evolve(self, components=self.components | components)

    def first(self, wanted: str) -> Component | None:
        """The first component of a type."""
        return next((one for one in self.components.values() if one.type == wanted), None)

    def beside(self, component: Component, wanted: str) -> Iterator[Component]:
        """The components of a type that stand with one in a relation."""
        for ids in self.relations:
            if component.id in ids:
                yield from (
                    self.components[one]
                    for one in ids
                    if one in self.components and self.components[one].type == wanted
                )


def read(content: bytes, source: str) -> Model:
    """Read a file.

    Raises
    ------
    SceneError
        If it is no REXS file in XML, or of a version that is not read.
    """
    if b"<!DOCTYPE" in content:  # nothing of REXS needs one, and entities can be made to fill all memory
        raise SceneError([f"{source}: has a DOCTYPE, which REXS has not; take it out"])
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise SceneError([f"{source}: no XML ({error}); of REXS only XML is read, not JSON or an archive"]) from None
    if root.tag != "model":
        raise SceneError([f"{source}: no REXS file: its root is {root.tag!r}, and has to be 'model'"])
    version = root.get("version", "")
    if not VERSIONS.fullmatch(version):
        raise SceneError(
            [f"{source}: version {version!r} is not read, only 1.0 to 2.0; export the file in one of them"]
        )
    problems: list[str] = []
    components: dict[str, Component] = {}
    for element in root.iterfind("components/component"):
        one = Component(element.get("id", ""), element.get("type", ""), element.get("name", ""), _attributes(element))
        if not one.id or one.id in components:
            problems.append(f"{source}: component {one.id or 'without id'} of type {one.type!r}: its id is missing or "
                            "that of another")  # fmt: skip
        components[one.id] = one
    cases: dict[str, LoadCase] = {}
    for element in root.iterfind("load_spectrum/load_case"):
        case = _load_case(element, components, source, problems)
        if not case.id or case.id in cases:
            problems.append(f"{source}: load case {case.id or 'without id'}: its id is missing or that of another")
        cases[case.id] = case
    if problems:
        raise faults_of(source, problems)
    relations = tuple(
        tuple(ref.get("id", "") for ref in relation.iterfind("ref")) for relation in root.iterfind("relations/relation")
    )
    return Model(root.get("applicationId", "an unnamed program"), components, relations, tuple(cases.values()))


def _load_case(
    element: ElementTree.Element, components: dict[str, Component], source: str, problems: list[str]
) -> LoadCase:
    case = LoadCase(element.get("id", ""), {})
    for child in element.iterfind("component"):
        component = child.get("id", "")
        if component not in components:
            problems.append(f"{source}: load case {case.id} is of component {component!r}, which there is not")
        if component in case.attributes:
            problems.append(f"{source}: load case {case.id}: component {component} stands there twice")
        case.attributes[component] = _attributes(child)
    return case


def _attributes(element: ElementTree.Element) -> dict[str, tuple[str, str]]:
    attributes: dict[str, tuple[str, str]] = {}
    for one in element.iterfind("attribute"):
        name = one.get("id", "")
        value = (one.get("unit", "none"), (one.text or "").strip())
        if attributes.setdefault(name, value) != value:  # two values are no number for whoever needs it
            attributes[name] = (value[0], f"{attributes[name][1]} and {value[1]}")
    return attributes
