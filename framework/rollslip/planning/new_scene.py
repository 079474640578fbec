"""Write the text of a new scene: complete, with comments on the source of each value, and checked to run.

Values that are not given are assumed, and marked so by a comment. Estimated values of a bearing are comments, so that
they scatter in ``rollslip uncertainty`` until a user replaces them by known ones.
"""

import importlib.metadata
import importlib.resources
import math
import re
import string
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final

import attrs

from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import CAGE_DESIGNS, estimated_inertia
from rollslip.catalogue.discovery import find, load, own_cage
from rollslip.errors import RollslipError, SceneError
from rollslip.geometry.bearing import Bearing
from rollslip.geometry.surfaces import PROFILES
from rollslip.scene.clearance import usual_fit
from rollslip.scene.reading import parse_scene
from rollslip.scene.relations import required_axial_load, skf_minimum_load
from rollslip.scene.supply import SUPPLIES
from rollslip.scene.values import Scene
from rollslip.structure import Location, raise_problem_if
from rollslip.units import UnitError, as_written, format_quantity, quantity

__all__ = ["ASSUMED", "MEANING", "assumed_load", "checked", "completed", "new", "new_scene"]

#: Option of ``rollslip new`` -> what it is.
MEANING: Final = {
    "bearing": "bearing, such as NU2210 or NJ 312 ECP/C3",
    "oil": "oil, such as iso-vg-68",
    "speed": "speed of the inner ring",
    "load": "radial load",
    "temperature": "temperature of the bearing",
    "cage": f"cage: {', '.join(CAGE_DESIGNS)}",
    "supply": f"supply of oil: {', '.join(SUPPLIES)}",
    "profile": "profile of the rollers: logarithmic or none",
}
#: Option -> its value where it is not given. For the load see `assumed_load`; cage and profile are the bearing's own if
#: its name has one.
ASSUMED: Final = {
    "bearing": "NU2210",
    "oil": "iso-vg-68",
    "speed": "1500 rpm",
    "temperature": "70 degC",
    "cage": "brass",
    "supply": "bath",
    "profile": "iso16281",
}
#: Option that is a quantity -> its SI unit.
_UNITS: Final = {"speed": "rad/s", "load": "N", "temperature": "K"}
#: Other name of a make of cages -> its name.
_CAGES: Final = {
    **dict.fromkeys(("bronze", "machined brass", "machined"), "brass"),
    **dict.fromkeys(("sheet steel", "pressed steel", "pressed"), "steel"),
    **dict.fromkeys(("plastic", "nylon", "pa", "pa66", "pa46"), "polyamide"),
}
#: Other name of a kind of supply -> its name.
_SUPPLIES: Final = {
    **dict.fromkeys(("oil bath", "sump"), "bath"),
    **dict.fromkeys(("splash oil", "oil splash"), "splash"),
    **dict.fromkeys(("circulation", "circulating oil", "pumped"), "circulating"),
    **dict.fromkeys(("oil jet", "injection", "spray"), "jet"),
    **dict.fromkeys(("oil mist", "oil-air", "oil air", "drip"), "mist"),
}
#: The table of the cage in the template.
_CAGE_TABLE: Final = re.compile(r"\[cage\]\n.*?(?=# What drags)", re.DOTALL)
#: The table in its place for a full complement bearing.
_NO_CAGE: Final = """[cage]
# None: rollers push each other, as the bearing's name says.
# Their friction coefficient is 0.1 (D); another one stands in [models.separator], as coefficient = 0.05
"""
#: Lines of raceways and clearance, in which a tapered bearing differs.
_RACEWAY_LINES: Final = re.compile(r"# inner_raceway_diameter.*?(?=\[surface\])", re.DOTALL)
#: The lines in their place for a tapered bearing.
_TAPERED_LINES: Final = """# pitch_diameter = "{pitch}" # at the middle of the rollers
# contact_angle = "{angle}" # of the outer raceway: e = 1.5 tan(angle)

"""
#: Axial load of a tapered bearing over F_r tan(alpha) at which half of its rollers are loaded, after NSK, catalogue
#: E728g, section 5.1: what an opposed bearing without preload exerts.
_HALF_LOADED: Final = 1.26
#: Axial load with which a tapered bearing is read before that load is known.
_ENOUGH: Final = "100 MN"
#: A number with a decimal comma that cannot be a separator of thousands.
_COMMA: Final = re.compile(r"\s*[+-]?(\d*,(\d{1,2}|\d{4,})|0,\d+)(?![\d,.])")
#: Option with a few choices -> other names, the choices, and what messages call them.
_CHOICES: Final[Mapping[str, tuple[Mapping[str, str], Collection[str], str]]] = {
    "cage": (_CAGES, CAGE_DESIGNS, "cages of"),
    "supply": (_SUPPLIES, SUPPLIES, "supplies by"),
    "profile": (PROFILES, ("iso16281", "none"), "profiles called"),
}
#: Option that is a name of data -> the kind of plugin.
_KINDS: Final = {"bearing": "bearing", "oil": "lubricant"}


def checked(option: str, value: str) -> str:
    """Return the value of an option as a scene has it; an unambiguous decimal comma becomes a point.

    Parameters
    ----------
    option : str
        One of `MEANING`.
    value : str
        What the user gave.

    Raises
    ------
    RollslipError
        If there is no such name or choice, or the quantity is wrong.
    """
    if option in _KINDS:
        offer = find(_KINDS[option], value.strip())
        if option == "bearing" and offer.is_family:
            # the full designation of a bearing of a family names its cage
            designation = value.strip().upper()
            if find(_KINDS[option], designation).name == offer.name:
                return designation
        return offer.name
    if option in _UNITS:
        if _COMMA.match(value):
            value = value.replace(",", ".")
        try:
            if quantity(value, _UNITS[option]) <= 0.0 and option == "load":
                raise UnitError(f"{as_written(value)} loads no roller; give more, such as '2 kN'")
        except UnitError as error:
            raise SceneError([Location({}, (option,)).message(str(error))]) from None
    else:
        names, kinds, description = _CHOICES[option]
        spelled = value.strip().casefold()
        spelled = names.get(spelled, spelled)
        raise_problem_if(
            spelled not in kinds,
            f"{option}: there are {description} {', '.join(kinds)}, not {description.split()[-1]} {value!r}",
        )
        return spelled
    return value.strip()


def assumed_load(bearing: str) -> str:
    """Return the load that is assumed for a bearing: twice the minimum load by SKF's rule, or 2 kN without one."""
    minimum = skf_minimum_load(load(find("bearing", bearing)).bearing, 0.0)
    if math.isnan(minimum):
        return "2 kN"
    return format_quantity(float(f"{2.0 * minimum:.2g}"), "N")


def completed(
    given: Mapping[str, str], ask: Callable[[str, str], str] | None = None
) -> tuple[dict[str, str], list[str]]:
    """Return a value for each option, and the options that were not given.

    Parameters
    ----------
    given : mapping of str to str
        Option -> value.
    ask : callable, optional
        Takes an option and its usual value, and returns the user's; by default the usual value is taken.

    Raises
    ------
    RollslipError
        If a value is wrong; all faults at once.
    """
    values = dict[str, str]()
    errors = list[RollslipError]()
    for option, text in given.items():
        try:
            values[option] = checked(option, text)
        except RollslipError as error:
            errors.append(error)
    if len(errors) == 1:
        raise errors[0]
    if errors:
        raise SceneError(list(map(str, errors)))
    own = own_cage(values.get("bearing"))
    if own and not own.make:
        if "cage" in values:
            raise SceneError(
                [
                    f"cage: {values['bearing']} is a full complement bearing, which has none; leave it out"
                ]
            )
        values["cage"] = ""
    elif own and own.letters and ask is None and "cage" not in values:
        values["cage"] = own.make
    if "bearing" in values and "profile" not in values and _known_profile(values["bearing"]):
        values["profile"] = ""
    missing = [option for option in MEANING if option not in values]
    for option in missing:
        usual = _usual_value(option, values)
        values[option] = usual if ask is None else ask(option, usual)
    return values, missing


def _known_profile(bearing: str) -> bool:
    """Whether the profile of the rollers of a bearing is known, or takes more than a name."""
    data: Any = load(find("bearing", bearing))
    is_named = data.bearing.profile.shape in _CHOICES["profile"][1]
    return not (is_named and data.grades.get("profile") == "D")


def _usual_value(option: str, values: Mapping[str, str]) -> str:
    """Return the usual value of an option, for the bearing among the values of others."""
    if option == "load":
        return assumed_load(values["bearing"])
    if option == "cage" and (own := own_cage(values["bearing"])):
        return str(own.make)
    if option == "profile":
        return str(load(find("bearing", values["bearing"])).bearing.profile.shape)
    return checked(option, ASSUMED[option])


def new(bearing: str, **given: str) -> Scene:
    """Return a complete scene of a bearing, as ``rollslip new`` writes one.

    Parameters
    ----------
    bearing : str
        Its name: "NU 2210", or "NJ 312 ECP/C3".
    **given : str
        oil, speed (of the inner ring), load (radial), temperature, cage (what it is of), supply (how the oil gets
        there) and profile (of the rollers). What is left out is assumed: iso-vg-68, 1500 rpm, twice the minimum load
        by SKF's rule, 70 degC, the bearing's own cage or brass, a bath, and the bearing's own profile. The `text` of
        the scene marks it.

    Raises
    ------
    SceneError
        If there is no such option or oil, a quantity is wrong, or the bearing has no room for its rings.
    PluginError
        If there is no such bearing.

    Examples
    --------
    >>> import rollslip
    >>> rollslip.new("NU 2210", speed="1500 rpm", load="2 kN").bearing.rollers
    16
    """
    if unknown := given.keys() - MEANING.keys():
        raise SceneError(
            [f"new: there is no {', '.join(sorted(unknown))}; there are {', '.join(MEANING)}"]
        )
    if wrong := [
        name for name, text in {"bearing": bearing, **given}.items() if not isinstance(text, str)
    ]:
        raise SceneError(
            [
                f"new: {name}: a text is expected, with a unit where it has one: '2 kN'"
                for name in wrong
            ]
        )
    values, missing = completed({"bearing": bearing, **given})
    return parse_scene(new_scene("new scene", frozenset(missing), **values), "new scene")


def new_scene(source: str, assumed: frozenset[str] = frozenset(), **given: str) -> str:
    """Return the text of a scene.

    Parameters
    ----------
    source : str
        Name of the scene in messages.
    assumed : frozenset of str
        Options whose values are marked as assumed.
    **given : str
        Option -> value, all of `MEANING`.
    """
    marks = {"speed": " #", "load": " #"}
    values = _values(**given) | {
        f"assumed_{option}": f"{marks.get(option, ';')} ASSUMED, write yours"
        if option in assumed
        else ""
        for option in MEANING
    }
    file = importlib.resources.files("rollslip.planning") / "new_scene.toml.in"
    template = string.Template(file.read_text(encoding="utf-8"))
    enough = f'\naxial_load = "{_ENOUGH}"' if values["is_tapered"] else ""
    first = parse_scene(
        template.substitute(values, clearance="", radial_clearance="", axial_load=enough), source
    )
    bearing = first.bearing
    text = template.substitute(
        values,
        clearance=bearing.mounted or "of a bearing without clearance classes",
        radial_clearance=format_quantity(bearing.radial_clearance, "m", 3),
        axial_load=_assumed_axial_load(first),
    )
    if bearing.contact_angle is not None:
        pitch = format_quantity(bearing.pitch_diameter, "m", 4)
        angle = f"{math.degrees(bearing.contact_angle):.2f} deg"
        text = _RACEWAY_LINES.sub(_TAPERED_LINES.format(pitch=pitch, angle=angle), text)
    text = _aligned(text)
    if not values["make"]:  # a full complement
        text = _CAGE_TABLE.sub(_NO_CAGE, text)
    assemble(parse_scene(text, f"{source} (not written)")).load_distribution()
    return text


def _assumed_axial_load(scene: Scene) -> str:
    """Return the line with the axial load of a tapered bearing at which half of its rollers are loaded, or nothing."""
    if scene.bearing.contact_angle is None:
        return ""
    operation = scene.operation
    unloaded = attrs.evolve(scene, operation=attrs.evolve(operation, radial_load=0.0))
    radial = operation.radial_load * math.tan(scene.bearing.contact_angle)
    load = format_quantity(_HALF_LOADED * radial + required_axial_load(unloaded), "N", 3)
    return f'\naxial_load = "{load}" # ASSUMED, half of the rollers are loaded; write yours'


def _values(
    *, bearing: str, cage: str, supply: str, profile: str, **given: str
) -> dict[str, object]:
    """Return the values of the template."""
    named: Any = load(find("bearing", bearing))
    b = named.bearing
    own = own_cage(bearing)
    follows = own is not None and own.make == cage
    material = cage or "brass"  # a full complement has no table of the cage
    make = CAGE_DESIGNS[material]
    guidance = make.guidance
    reason = ""
    if own is not None and follows:
        guidance = own.guidance
        reason = f": {own.letters} in the name" if own.letters else ": most makers put it in"
    mass, inertia = estimated_inertia(b, material)
    lengths = (
        "roller_diameter",
        "roller_length",
        "inner_raceway_diameter",
        "outer_raceway_diameter",
    )
    return {
        "version": importlib.metadata.version("rollslip"),
        "bearing": bearing,
        "estimated": "estimated (D)" if "D" in named.grades.values() else "known",
        "own_profile": "" if profile else "# ",
        "profile": profile or b.profile.shape,
        "rollers": b.rollers,
        **{name: format_quantity(getattr(b, name), "m") for name in lengths},
        "clearance_class": b.clearance_class or "CN",
        "mounted": "" if b.mounting else "# ",
        "shaft_fit": usual_fit(b.boundaries[0]),
        **_seats(b),
        "is_tapered": b.contact_angle is not None,
        "follows": "# " if follows else "",
        "make": cage,
        "why_make": f"{make.description}{reason}",
        "mass": format_quantity(mass, "kg", 3),
        "inertia": f"{inertia:.3g} kg m2",
        "guidance": guidance,
        "pocket_clearance": format_quantity(make.pocket_clearance * b.roller_diameter, "m", 3),
        "pocket_stiffness": f"{make.pocket_stiffness / 1e6:g} MN/m",
        "supply": supply,
        "supply_words": SUPPLIES[supply].description,
        **given,
    }


def _seats(b: Bearing) -> dict[str, str]:
    """Return remarks on the lines of fits, where a raceway has no ring with a seat."""
    return {
        f"no_{part}": f"; not here: rollers run on the {part} itself"
        * (raceway is not None and raceway.without_ring)
        for part, raceway in (("shaft", b.inner_raceway), ("housing", b.outer_raceway))
    }


def _aligned(text: str) -> str:
    """Return a scene with the comments behind its values below one another."""
    lines = []
    for line in text.splitlines():
        value, sign, comment = line.partition(" # ")
        if sign and not line.startswith("# Written"):
            line = f"{value:<40} # {comment}"
        lines.append(line)
    return "\n".join(lines) + "\n"
