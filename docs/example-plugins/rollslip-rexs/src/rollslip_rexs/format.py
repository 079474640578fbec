"""REXS as a file format of scenes: one cylindrical roller bearing of a gearbox in, its results out.

- The names of components and attributes are those of the REXS database of version 2.0.0, each looked up there. Those of
  versions 1.0 to 1.6 were looked up where the table in README.md says so.
- A number comes in the unit that the file states. All that was missing or not used is told, attribute by attribute.
- Most files hold of a bearing its designation and its boundary dimensions. What is inside is that of this name in
  rollslip's catalogue, where the file does not say it.
- What REXS has no attribute for, roughness, cage, models and rheology of the oil, is estimated and told, or left out.
"""

import datetime
import math
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

import attrs
import xarray as xr
from rollslip.bearing.assembly import assemble
from rollslip.catalogue.discovery import get_class
from rollslip.errors import PluginError, SceneError
from rollslip.files import faults_of
from rollslip.hookspecs import hookimpl
from rollslip.scene import Bearing
from rollslip.scene.formats import Read, SceneFormat, Written
from rollslip.scene.interchange import FORMAT, VERSION, from_parameters

from rollslip_rexs.model import Component, LoadCase, Model, read

BEARINGS = ("rolling_bearing_with_detailed_geometry", "rolling_bearing_with_catalog_geometry")
#: Types of bearing that rollslip computes.
ROLLER_BEARINGS = ("radial_roller_bearing", "radial_needle_roller_bearing")
#: Attribute of either type of bearing that most files have, where they have nothing of what is inside.
DESIGNATION = "catalogue_designation"
#: ISO viscosity grades of the oils in the box, middles at 40 degC [mm2/s].
GRADES = (32, 46, 68, 100, 150, 220, 320)
#: Rollers of one bearing may differ by as much, as a share: digits of the program that wrote them.
ALIKE = 1e-9
#: Attributes of the time that a load case takes -> columns of a table of load cases.
TIMES = {"load_duration_fraction": "share", "load_duration": "time"}
#: What is written, and read by nobody here: it was calculated.
RESULTS = ("speed_rolling_element_set", "total_frictional_torque", "total_frictional_power_loss")

Quantity = dict[str, Any]


class _Reading:
    """What of a file was asked for, found, and missed."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.problems: list[str] = []
        self.notes: list[str] = []
        self.used: set[tuple[str, str]] = set()

    def number(self, component: Component | None, attribute: str) -> Quantity | None:
        """A number with its unit, which now counts as used."""
        if component is None:
            return None
        self.used.add((component.id, attribute))
        found = component.number(attribute, self.problems)
        return None if found is None else {"value": found[0], "unit": found[1]}

    def needed(self, component: Component | None, attribute: str, key: str, of: str) -> Quantity | None:
        """A number that a scene cannot do without."""
        before = len(self.problems)
        found = self.number(component, attribute)
        if found is None and len(self.problems) == before:
            where = str(component) if component is not None else f"no {of} belongs to the bearing, so"
            self.problems.append(f"{where}, {attribute}: missing, but needed for {key}; add it to the file")
        return found

    def unused(self, components: Iterable[Component]) -> None:
        """Tell every attribute that nobody has asked for."""
        for one in components:
            self.notes += [
                f"{one}, {attribute}: not used" for attribute in one.attributes if (one.id, attribute) not in self.used
            ]


@attrs.frozen
class Rexs(SceneFormat):
    """REXS in XML, versions 1.0 to 2.0; version 2.0.0 is written."""

    endings: ClassVar[tuple[str, ...]] = (".rexs",)

    def read(self, content: bytes, source: str) -> Read:
        """Read the one roller bearing of a file; see `SceneFormat.read`."""
        model = read(content, source)
        load_cases = model.load_cases
        if load_cases:
            model = model.at(load_cases[0])
        it = _Reading(source)
        bearing = _bearing_of(model, source)
        rows = _once(model.beside(bearing, "rolling_bearing_row"))
        row = rows[0] if rows else None
        elements = _once(model.beside(row, "rolling_element")) if row else []
        oil = next(model.beside(bearing, "lubricant"), None) or model.first("lubricant")
        steel = next((one for near in (bearing, *rows, *elements[:1]) for one in model.beside(near, "material")), None)
        _check_rows(bearing, rows, elements, it)
        parameters = {
            "title": f"{bearing.name or bearing.id} of {model.application}",
            "bearing": _geometry(bearing, row, elements, steel, it),
            "surface": {"name": "ground"},
            "lubricant": _oil(oil, it),
            "operation": _operation(model, bearing, it),
        }
        if it.problems:
            raise SceneError([f"{source}: {problem}" for problem in it.problems])
        it.notes += [
            "surface: REXS has no roughness of raceways and rollers; those of 'ground' are taken, an estimate",
            "cage: REXS has none; that of the designation is taken, or one of the bearing's size, an estimate; set "
            "cage.make, cage.mass and others where you know them",
            "models: REXS names none; rollslip's defaults are taken",
        ]
        if len(load_cases) > 1:
            of_all = f"load case {load_cases[0].id} of {len(load_cases)}"
            it.notes.append(f"load_spectrum: the scene is {of_all}; 'rollslip cases' takes all")
        near = [bearing, *rows, *elements[:1], *([oil] if oil else []), *([steel] if steel else [])]
        it.used |= {(bearing.id, name) for name in ("bearing_type", "number_of_bearing_rows", *RESULTS)}
        it.unused(near)
        it.notes += [f"{bearing}, {name}: a result, computed anew" for name in RESULTS if name in bearing.attributes]
        known = {one.id for one in (*near, *elements)}
        others = Counter(one.type for one in model.components.values() if one.id not in known)
        it.notes += [f"{kind}: {count} not used" for kind, count in sorted(others.items())]
        return Read({"format": FORMAT, "version": VERSION, "parameters": parameters}, tuple(it.notes))

    def load_cases(self, content: bytes, source: str) -> list[tuple[str, list[str]]]:
        """Read speeds, load, temperature and time of all load cases; see `SceneFormat.load_cases`."""
        model = read(content, source)
        bearing = _bearing_of(model, source).id
        table: dict[str, dict[str, Quantity]] = {}
        problems: list[str] = []
        for case in model.load_cases:
            place = f"{source}: load case {case.id}"
            it = _Reading(source)
            of_case = model.at(case)
            operation = _operation(of_case, of_case.components[bearing], it)
            table[place] = {key: one for key, one in operation.items() if one is not None} | _time(of_case, case, it)
            problems += [f"{place}: {problem}" for problem in it.problems]
        if not problems:
            problems = _differences(table)
        if problems:
            raise faults_of(source, problems)
        units = {key: one["unit"] for row in table.values() for key, one in row.items()}
        at_rest = {"value": 0.0}  # of a ring without a speed in this load case
        rows = [(place, [repr(float(row.get(key, at_rest)["value"])) for key in units]) for place, row in table.items()]
        return [(source, [f"{key} [{unit}]" for key, unit in units.items()]), *rows] if rows else []

    def write(self, document: Mapping[str, Any], result: xr.Dataset | None) -> Written:
        """Write the bearing with its oil and operation, and what was calculated; see `SceneFormat.write`."""
        scene = from_parameters(document)
        oil = assemble(scene).lubricant
        operation = scene.operation
        geometry = scene.bearing
        notes = [
            f"{key}: has no place in REXS"
            for key in document["parameters"]
            if key not in ("title", "bearing", "lubricant", "operation")
        ]
        notes.append("lubricant: of it REXS has viscosities, density and name; the rheology has no place")
        if geometry.profile is not None:
            notes.append("bearing.profile: not written")
        attributes: dict[str, list[tuple[str, str, float | int | str]]] = {
            BEARINGS[0]: [
                ("bearing_type", "none", ROLLER_BEARINGS[0]),
                ("number_of_bearing_rows", "none", 1),
                ("operating_radial_bearing_clearance", "mum", geometry.radial_clearance * 1e6),
                ("speed_inner_ring", "1 / min", operation.inner_speed * 30.0 / math.pi),
                ("speed_outer_ring", "1 / min", operation.outer_speed * 30.0 / math.pi),
                ("temperature_lubricant", "C", operation.temperature - 273.15),
                ("radial_force_in_v", "kN", 0.0),
                ("radial_force_in_w", "kN", operation.radial_load / 1e3),
            ],
            "rolling_bearing_row": [
                ("number_of_rolling_elements", "none", geometry.rollers),
                (
                    "reference_diameter_rolling_bearing",
                    "mm",
                    (geometry.inner_raceway_diameter + geometry.outer_raceway_diameter) * 500.0,
                ),
            ],
            "rolling_element": [
                ("diameter_of_rolling_element", "mm", geometry.roller_diameter * 1e3),
                ("length_of_rolling_element", "mm", geometry.roller_length * 1e3),
            ],
            "lubricant": [("name", "none", oil.name)],
            "material": [
                ("elastic_modulus", "N / mm^2", geometry.material.elastic_modulus / 1e6),
                ("poisson_ratio", "none", geometry.material.poisson_ratio),
                ("density", "kg / dm^3", geometry.material.density / 1e3),
            ],
        }
        if oil.density is None:
            notes.append("lubricant: its density is not known, so no kinematic viscosity can be written")
        else:
            attributes["lubricant"].append(("density_at_15_degree_celsius", "kg / dm^3", oil.density(288.15) / 1e3))
            for celsius in (40, 100):
                T = celsius + 273.15
                nu = oil.viscosity_factor * oil.viscosity(T) / oil.density(T)
                attributes["lubricant"].append((f"viscosity_at_{celsius}_degree_celsius", "mm^2 / s", nu * 1e6))
        if result is not None:
            found, missing = _calculated(result)
            attributes[BEARINGS[0]] += found
            notes += missing
        return Written(_xml(attributes, geometry.rollers, scene.title), tuple(notes))


# Reading ------------------------------------------------------------------------------------------------------------


def _once(components: Iterable[Component]) -> list[Component]:
    return list({one.id: one for one in components}.values())


def _text(component: Component, attribute: str) -> str:
    return component.attributes.get(attribute, ("", ""))[1]


def _catalogued(designation: str) -> tuple[Bearing | None, str]:
    """The bearing of a designation, and why there is none."""
    try:
        return (get_class("bearing", designation).bearing, "") if designation else (None, "")
    except PluginError as error:
        return None, str(error)


def _bearing_of(model: Model, source: str) -> Component:
    """The one bearing of a file that rollslip can compute."""
    bearings = [one for one in model.components.values() if one.type in BEARINGS]
    types = {one.id: _text(one, "bearing_type") for one in bearings}
    named = {one.id: _catalogued(_text(one, DESIGNATION)) for one in bearings}
    rollers = [
        one
        for one in bearings
        if types[one.id] in ROLLER_BEARINGS or (not types[one.id] and named[one.id][0] is not None)
    ]
    if len(rollers) == 1:
        return rollers[0]
    shown = ", ".join(
        f"{one.id} {one.name!r} ({types[one.id] or named[one.id][1] or 'without bearing_type'})" for one in bearings
    )
    wanted = f"one component with bearing_type {' or '.join(map(repr, ROLLER_BEARINGS))} is read"
    have = f"there are: {shown}" if bearings else "there is no bearing"
    remedy = "leave one in a copy of the file" if rollers else "only cylindrical roller bearings are computed"
    raise SceneError([f"{source}: {wanted}; {have}; {remedy}"])


def _check_rows(bearing: Component, rows: list[Component], elements: list[Component], it: _Reading) -> None:
    stated = it.number(bearing, "number_of_bearing_rows")
    if len(rows) > 1 or (stated is not None and stated["value"] > 1):
        count = len(rows) if stated is None else f"{stated['value']:g}"
        it.problems.append(f"{bearing}: has {count} rows of rollers, and only one is computed")
    for attribute in ("diameter_of_rolling_element", "length_of_rolling_element"):
        values = [one["value"] for element in elements if (one := it.number(element, attribute)) is not None]
        if values and max(values) - min(values) > ALIKE * max(values):
            it.problems.append(f"{attribute}: rollers differ, {min(values):g} to {max(values):g}; all have to be alike")


def _geometry(
    bearing: Component, row: Component | None, elements: list[Component], steel: Component | None, it: _Reading
) -> dict[str, Any]:
    element = elements[0] if elements else None
    designation = _text(bearing, DESIGNATION)
    it.used.add((bearing.id, DESIGNATION))
    known, why = _catalogued(designation)
    requested = it.needed if known is None else lambda of, attribute, key, component: it.number(of, attribute)
    before = len(it.problems)
    rollers = requested(row, "number_of_rolling_elements", "bearing.rollers", "rolling_bearing_row")
    diameter = requested(element, "diameter_of_rolling_element", "bearing.roller_diameter", "rolling_element")
    length = requested(element, "length_of_rolling_element", "bearing.roller_length", "rolling_element")
    if why and len(it.problems) > before:
        it.problems.append(f"{bearing}, {DESIGNATION}: {why}")
    contacts = [it.number(row, f"significant_contact_length_{ring}_ring") for ring in ("inner", "outer")]
    if lengths := [one for one in contacts if one is not None and (length is not None or known is not None)]:
        length = min(lengths, key=lambda one: float(one["value"]))
        it.notes.append("significant_contact_length: the shorter one is the effective length of the rollers")
    told: dict[str, Any] = {"rollers": None if rollers is None else _whole(rollers["value"], it)}
    told |= {"roller_diameter": diameter, "roller_length": length}
    if known is None or diameter is not None:
        told |= _raceways(_pitch(bearing, row, known, it), diameter, it)
    clearance = it.number(bearing, "operating_radial_bearing_clearance")
    if clearance is None and known is None:
        it.notes.append(f"{bearing}, operating_radial_bearing_clearance: missing; 0 is taken")
        clearance = {"value": 0.0, "unit": "um"}
    told["radial_clearance"] = clearance
    if known is not None:
        _check_size(bearing, designation, known, it)
        it.notes.append(
            f"{bearing}, {DESIGNATION}: of {designation!r} rollslip's catalogue gives "
            f"{', '.join(key for key in (*told, 'raceways') if told.get(key) is None and 'raceway_' not in key)} "
            "where the file does not say it, an estimate; its clearance is that in operation, with usual fits"
        )
        told = {"name": designation, **{key: value for key, value in told.items() if value is not None}}
    material = {
        key: one
        for key in ("elastic_modulus", "poisson_ratio", "density")
        if (one := it.number(steel, key)) is not None
    }
    missing = [key for key in ("elastic_modulus", "poisson_ratio", "density") if key not in material]
    it.notes += [f"{steel or 'material'}, {key}: missing; that of bearing steel is taken" for key in missing]
    return told | ({"material": material} if material else {})


def _pitch(bearing: Component, row: Component | None, known: Bearing | None, it: _Reading) -> Quantity | None:
    """Diameter of the pitch circle: as it is stated, of the catalogue, or the mean of bore and outside diameter."""
    pitch = it.number(row, "reference_diameter_rolling_bearing")
    if pitch is None and known is not None:
        return {"value": 500.0 * (known.inner_raceway_diameter + known.outer_raceway_diameter), "unit": "mm"}
    sides = ("inner", "outer") if pitch is None else ()
    bore, outside = [it.number(bearing, f"{side}_diameter") for side in sides] or (None, None)
    if pitch is None and bore is not None and outside is not None:
        pitch = {"value": (bore["value"] + outside["value"]) / 2.0, "unit": bore["unit"]}
        it.notes.append(
            "rolling_bearing_row, reference_diameter_rolling_bearing: missing; the mean of bore and outer diameter is "
            "taken, an estimate"
        )
    if pitch is None:
        it.problems.append(
            "rolling_bearing_row, reference_diameter_rolling_bearing: missing, and so are inner_diameter and "
            "outer_diameter of the bearing, to estimate it; add one of them to the file"
        )
    return pitch


def _raceways(pitch: Quantity | None, diameter: Quantity | None, it: _Reading) -> dict[str, Any]:
    if pitch is None or diameter is None:
        return {}
    if pitch["unit"] != diameter["unit"]:
        it.problems.append(f"diameters of one bearing in {pitch['unit']} and {diameter['unit']}; use one unit")
    return {
        f"{ring}_raceway_diameter": {"value": pitch["value"] + sign * diameter["value"], "unit": pitch["unit"]}
        for ring, sign in (("inner", -1.0), ("outer", 1.0))
    }


def _check_size(bearing: Component, designation: str, known: Bearing, it: _Reading) -> None:
    """Refuse a designation whose raceways do not fit between bore and outside diameter of the file."""
    bore, outside = (it.number(bearing, f"{side}_diameter") for side in ("inner", "outer"))
    for stated, raceway, sign in ((bore, known.inner_raceway_diameter, 1), (outside, known.outer_raceway_diameter, -1)):
        if stated is not None and stated["unit"] == "mm" and sign * (1e3 * raceway - stated["value"]) <= 0.0:
            it.problems.append(
                f"{bearing}, {DESIGNATION}: {designation!r} has a raceway of {1e3 * raceway:g} mm, and the file a "
                f"ring of {stated['value']:g} mm; one of them is of another bearing"
            )


def _whole(value: float, it: _Reading) -> int | None:
    if value != round(value):
        it.problems.append(f"number_of_rolling_elements: {value:g} is no whole number")
        return None
    return int(value)


def _time(model: Model, case: LoadCase, it: _Reading) -> dict[str, Quantity]:
    """The part of the time that a load case takes, or its hours, from the component of the load case that has it."""
    found: dict[str, Quantity] = {}
    for attribute, key in TIMES.items():
        components = [model.components[id] for id, own in case.attributes.items() if attribute in own]
        numbers = [one for component in components if (one := it.number(component, attribute)) is not None]
        if any(one != numbers[0] for one in numbers):
            it.problems.append(f"{attribute}: {len(numbers)} components have it, with several values; leave one")
        if numbers:
            found[key] = numbers[0]
    # both say the same, but for the hours of the whole
    return {"share": found["share"]} if "share" in found else found


def _differences(table: Mapping[str, Mapping[str, Quantity]]) -> list[str]:
    """What load cases have in another unit than the first one that has it, or lack."""
    problems: list[str] = []
    first: dict[str, tuple[str, str]] = {}
    for place, row in table.items():
        for key, one in row.items():
            other, unit = first.setdefault(key, (place, one["unit"]))
            if one["unit"] != unit:
                problems.append(f"{place}: {key} is in {one['unit']}, and in {unit} in load case "
                                f"{other.rpartition(' ')[2]}; use one unit")  # fmt: skip
    names = {key: name for name, key in TIMES.items()}
    problems += [
        f"{place}: has no {names[key]}, which others have; add it to the file"
        for key in names.keys() & first.keys()
        for place, row in table.items()
        if key not in row
    ]
    return problems


def _operation(model: Model, bearing: Component, it: _Reading) -> dict[str, Any]:
    told: dict[str, Any] = {"inner_speed": it.needed(bearing, "speed_inner_ring", "operation.inner_speed", "")}
    told["outer_speed"] = it.number(bearing, "speed_outer_ring")
    if told["outer_speed"] is None:
        it.notes.append(f"{bearing}, speed_outer_ring: missing; a ring at rest is taken")
        del told["outer_speed"]
    of_casing = None
    casing = model.first("gear_casing")
    if "temperature_lubricant" not in bearing.attributes:
        of_casing = it.number(casing, "temperature_lubricant")
    if of_casing is not None:
        it.notes.append(f"{bearing}, temperature_lubricant: missing; that of {casing} is taken")
    told["temperature"] = of_casing or it.needed(bearing, "temperature_lubricant", "operation.temperature", "")
    parts = [it.needed(bearing, f"radial_force_in_{axis}", "operation.radial_load", "") for axis in "vw"]
    forces = [one for one in parts if one is not None]
    if len(forces) == 2 and forces[0]["unit"] == forces[1]["unit"]:
        load = math.hypot(*(one["value"] for one in forces))
        told["radial_load"] = {"value": load, "unit": forces[0]["unit"]}
    elif len(forces) == 2:
        it.problems.append(f"{bearing}, radial_force_in_v and radial_force_in_w: in two units; use one")
    return told


def _oil(oil: Component | None, it: _Reading) -> dict[str, Any]:
    """The oil by its viscosities; the rest is that of the mineral oil of the nearest ISO grade in the box."""
    at_40 = it.needed(oil, "viscosity_at_40_degree_celsius", "lubricant", "lubricant")
    if oil is None or at_40 is None:
        return {}
    if at_40["value"] <= 0.0:
        it.problems.append(f"{oil}, viscosity_at_40_degree_celsius: {at_40['value']:g} is no viscosity")
        return {}
    grade = min(GRADES, key=lambda one: abs(math.log(one / at_40["value"])))
    told: dict[str, Any] = {"name": f"iso-vg-{grade}"}
    it.notes.append(
        f"{oil}: pressure viscosity, conductivity, Eyring stress and shear modulus are those of {told['name']}, an "
        "estimate; REXS has none of them that is read"
    )
    at_100 = it.number(oil, "viscosity_at_100_degree_celsius")
    if at_100 is None:
        it.notes.append(f"{oil}, viscosity_at_100_degree_celsius: missing; all viscosities are those of {told['name']}")
        return told
    density = it.number(oil, "density_at_15_degree_celsius")
    if density is None:
        it.notes.append(f"{oil}, density_at_15_degree_celsius: missing; 880 kg/m3 is taken")
        density = {"value": 880.0, "unit": "kg/m3"}
    else:
        it.notes.append(
            f"{oil}, density_at_15_degree_celsius: taken at all temperatures, about 5 % too large at 90 degC"
        )
    points = [
        {"temperature": {"value": celsius, "unit": "degC"}, "kinematic_viscosity": nu}
        for celsius, nu in ((40.0, at_40), (100.0, at_100))
    ]
    return told | {"viscosity_law": "walther", "points": points, "density": density}


# Writing ------------------------------------------------------------------------------------------------------------


def _calculated(result: xr.Dataset) -> tuple[list[tuple[str, str, float | int | str]], list[str]]:
    """Cage speed, friction torque and losses at the smallest slip that lasts; what is not there, in words."""
    if result.attrs.get("study") != "steady-slip":
        return [], [f"the result is of study {result.attrs.get('study')!r}: only that of steady-slip has a place"]
    lasting = [k for k, lasts in enumerate(result["stable"].to_numpy().tolist()) if lasts]
    if not lasting:
        return [], [f"the result has no slip that lasts ({result['status'].item()}): nothing of it is written"]
    at = result.isel(steady=lasting[0])
    found: list[tuple[str, str, float | int | str]] = []
    notes = []
    for attribute, unit, value in (
        ("speed_rolling_element_set", "1 / min", float(at["cage_speed"]) * 30.0 / math.pi),
        ("total_frictional_torque", "N m", float(at["friction_torque"])),
        ("total_frictional_power_loss", "W", float(at["loss"].sum(skipna=False))),
    ):
        if math.isfinite(value):
            found.append((attribute, unit, value))
        else:
            notes.append(f"{attribute}: the result has no value; not written")
    return found, notes


def _xml(attributes: Mapping[str, list[tuple[str, str, float | int | str]]], rollers: int, title: str) -> str:
    """A file of one bearing: each roller is a component of its own, as the standard has it."""
    root = ElementTree.Element(
        "model",
        version="2.0.0",
        applicationId="rollslip",
        applicationVersion="0.1",
        date=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    )
    relations, components = (ElementTree.SubElement(root, name) for name in ("relations", "components"))
    types = [BEARINGS[0], "rolling_bearing_row", "lubricant", "material", *["rolling_element"] * rollers]
    for number, kind in enumerate(types, 1):
        name = title if number == 1 else ""
        component = ElementTree.SubElement(components, "component", id=str(number), name=name, type=kind)
        for attribute, unit, value in attributes[kind]:
            child = ElementTree.SubElement(component, "attribute", id=attribute, unit=unit)
            child.text = f"{value:.15g}" if isinstance(value, float) else str(value)
    pairs = [("ordered_assembly", 1, 2, 1), ("reference", 1, 3, None), ("reference", 1, 4, None)]
    pairs += [("ordered_assembly", 2, 5 + k, 1 + k) for k in range(rollers)]
    for number, (kind, one, other, order) in enumerate(pairs, 1):
        relation = ElementTree.SubElement(relations, "relation", id=str(number), type=kind)
        if order is not None:
            relation.set("order", str(order))
        roles = ("origin", "referenced") if kind == "reference" else ("assembly", "part")
        for component_id, role in zip((one, other), roles, strict=True):
            ElementTree.SubElement(relation, "ref", id=str(component_id), role=role, hint=types[component_id - 1])
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


@hookimpl
def scene_formats() -> list[SceneFormat]:
    """Offer the format."""
    return [Rexs("rexs")]
