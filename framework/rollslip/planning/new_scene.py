"""The text of a new scene: complete, commented, each value with where it is from, and known to run.

What is not named is assumed, and the scene says so beside it. Values of a bearing's estimate stand as comments: so they
scatter in ``rollslip uncertainty`` until somebody knows better and writes them.
"""

import importlib.metadata
import importlib.resources
import math
import re
import string
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final

from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import CAGE_DESIGNS, estimated_inertia
from rollslip.catalogue.discovery import find, load, own_cage
from rollslip.datasets import Bearing
from rollslip.errors import RollslipError, SceneError
from rollslip.scene.clearance import usual_fit
from rollslip.scene.reading import parse_scene
from rollslip.scene.relations import skf_minimum_load
from rollslip.scene.supply import SUPPLIES
from rollslip.scene.values import Scene
from rollslip.structure import Location
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
}
#: What is taken where nothing is said; of the load see `assumed_load`; a cage is the bearing's own if its name has one.
ASSUMED: Final = {
    "bearing": "NU2210",
    "oil": "iso-vg-68",
    "speed": "1500 rpm",
    "temperature": "70 degC",
    "cage": "brass",
    "supply": "bath",
}
_UNITS: Final = {"speed": "rad/s", "load": "N", "temperature": "K"}
#: How else people name the makes of cages.
_CAGES: Final = {
    **dict.fromkeys(("bronze", "machined brass", "machined"), "brass"),
    **dict.fromkeys(("sheet steel", "pressed steel", "pressed"), "steel"),
    **dict.fromkeys(("plastic", "nylon", "pa", "pa66", "pa46"), "polyamide"),
}
#: How else people name kinds of supply.
_SUPPLIES: Final = {
    **dict.fromkeys(("oil bath", "sump"), "bath"),
    **dict.fromkeys(("splash oil", "oil splash"), "splash"),
    **dict.fromkeys(("circulation", "circulating oil", "pumped"), "circulating"),
    **dict.fromkeys(("oil jet", "injection", "spray"), "jet"),
    **dict.fromkeys(("oil mist", "oil-air", "oil air", "drip"), "mist"),
}
#: What is written of a cage, and what stands there where there is none.
_CAGE_TABLE: Final = re.compile(r"\[cage\]\n.*?(?=# What drags)", re.DOTALL)
_NO_CAGE: Final = """[cage]
# None: rollers push each other, as the bearing's name says.
# Their friction coefficient is 0.1 (D); another one stands in [models.separator], as coefficient = 0.05
"""
#: A decimal comma that is no comma of thousands.
_COMMA: Final = re.compile(r"\s*[+-]?(\d*,(\d{1,2}|\d{4,})|0,\d+)(?![\d,.])")
#: Option of which there are few -> other names, what there is, and what these are.
_WORDS: Final[Mapping[str, tuple[Mapping[str, str], Collection[str], str]]] = {
    "cage": (_CAGES, CAGE_DESIGNS, "cages of"),
    "supply": (_SUPPLIES, SUPPLIES, "supplies by"),
}
_KINDS: Final = {"bearing": "bearing", "oil": "lubricant"}


def checked(option: str, value: str) -> str:
    """Return what is given for an option as a scene says it; a decimal comma that is clear becomes a point."""
    if option in _KINDS:
        offer = find(_KINDS[option], value.strip())
        as_stamped = (
            value.strip().upper()
        )  # what is written of a bearing of a family tells its cage
        stamped = (
            option == "bearing"
            and offer.is_family
            and find(_KINDS[option], as_stamped).name == offer.name
        )
        return as_stamped if stamped else offer.name
    if option in _UNITS:
        value = value.replace(",", ".") if _COMMA.match(value) else value
        try:
            if quantity(value, _UNITS[option]) <= 0.0 and option == "load":
                raise UnitError(f"{as_written(value)} loads no roller; give more, such as '2 kN'")
        except UnitError as error:
            raise SceneError([Location({}, (option,)).message(str(error))]) from None
    else:
        names, kinds, words = _WORDS[option]
        spelled = value.strip().casefold()
        spelled = names.get(spelled, spelled)
        if spelled not in kinds:
            raise SceneError(
                [
                    f"{option}: there are {words} {', '.join(kinds)}, not {words.split()[-1]} {value!r}"
                ]
            )
        return spelled
    return value.strip()


def assumed_load(bearing: str) -> str:
    """Return the load that is assumed for a bearing: twice what SKF's rule asks for at least, or 2 kN."""
    least = skf_minimum_load(load(find("bearing", bearing)).bearing, 0.0)
    return "2 kN" if math.isnan(least) else format_quantity(float(f"{2.0 * least:.2g}"), "N")


def completed(
    given: Mapping[str, str], ask: Callable[[str, str], str] | None = None
) -> tuple[dict[str, str], list[str]]:
    """Return a value for each option, and the options of which none is given: asked for with what is usual, or that."""
    values = dict[str, str]()
    errors = list[RollslipError]()
    for option, text in given.items():
        try:
            values[option] = checked(option, text)
        except RollslipError as error:
            errors.append(error)
    if errors:
        raise errors[0] if len(errors) == 1 else SceneError([str(error) for error in errors])
    if (own := own_cage(values.get("bearing"))) and not own.make:
        if "cage" in values:
            raise SceneError(
                [
                    f"cage: {values['bearing']} is a full complement bearing, which has none; leave it out"
                ]
            )
        values["cage"] = ""
    if (
        "cage" not in values
        and ask is None
        and (own := own_cage(values.get("bearing")))
        and own.letters
    ):
        values["cage"] = own.make
    missing = [option for option in MEANING if option not in values]
    for option in missing:
        usual = (
            assumed_load(values["bearing"])
            if option == "load"
            else checked(option, ASSUMED[option])
        )
        if option == "cage" and (own := own_cage(values["bearing"])):
            usual = own.make
        values[option] = usual if ask is None else ask(option, usual)
    return values, missing


def new(bearing: str, **given: str) -> Scene:
    """Return a complete scene of a bearing, as ``rollslip new`` writes one.

    Parameters
    ----------
    bearing : str
        Its name: "NU 2210", or "NJ 312 ECP/C3".
    **given : str
        oil, speed (of the inner ring), load (radial), temperature, cage (what it is of) and supply (how the oil gets
        there). What is left out is assumed: iso-vg-68, 1500 rpm, twice the least load of SKF's rule, 70 degC, the
        bearing's own cage or brass, and a bath. The `text` of the scene marks it.

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
    """Return the text of a scene."""
    values = _values(**given) | _marks(assumed)
    file = importlib.resources.files("rollslip.planning") / "new_scene.toml.in"
    template = string.Template(file.read_text(encoding="utf-8"))
    left = parse_scene(
        template.substitute(values, clearance="", radial_clearance=""), source
    ).bearing
    told = {"clearance": left.mounted or "of a bearing without clearance classes"}
    told["radial_clearance"] = format_quantity(left.radial_clearance, "m", 3)
    text = _aligned(template.substitute(values | told))
    if not values["make"]:  # a full complement
        text = _CAGE_TABLE.sub(_NO_CAGE, text)
    assemble(parse_scene(text, source)).load_distribution()
    return text


def _marks(assumed: frozenset[str]) -> dict[str, str]:
    """Return what stands behind the value of each option."""
    bare = ("speed", "load")  # they have no other comment
    return {
        f"assumed_{option}": f"{' #' if option in bare else ';'} ASSUMED, write yours"
        if option in assumed
        else ""
        for option in MEANING
    }


def _values(*, bearing: str, cage: str, supply: str, **given: str) -> dict[str, object]:
    """Return what the template takes."""
    named: Any = load(find("bearing", bearing))
    b = named.bearing
    own = own_cage(bearing)
    follows = own is not None and own.make == cage
    of = cage or "brass"  # of a full complement nothing of it is written
    make = CAGE_DESIGNS[of]
    guidance = own.guidance if own is not None and follows else CAGE_DESIGNS[of].guidance
    says = own.letters if own is not None and follows else ""
    mass, inertia = estimated_inertia(b, of)
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
        "rollers": b.rollers,
        **{name: format_quantity(getattr(b, name), "m") for name in lengths},
        "clearance_class": b.clearance_class or "CN",
        "mounted": "" if b.mounting else "# ",
        "shaft_fit": usual_fit(b.boundaries[0]),
        **_seats(b),
        "follows": "# " if follows else "",
        "make": cage,
        "why_make": f"{make.words}{f': {says} in the name' if says else ': most makers put it in' if follows else ''}",
        "mass": format_quantity(mass, "kg", 3),
        "inertia": f"{inertia:.3g} kg m2",
        "guidance": guidance,
        "pocket_clearance": format_quantity(make.pocket_clearance * b.roller_diameter, "m", 3),
        "pocket_stiffness": f"{make.pocket_stiffness / 1e6:g} MN/m",
        "supply": supply,
        "supply_words": SUPPLIES[supply].words,
        **given,
    }


def _seats(b: Bearing) -> dict[str, str]:
    """Return marks of the lines of fits, which are comments where a raceway has no ring that sits anywhere."""
    found = {}
    for seat, part, raceway in (
        ("on_shaft", "shaft", b.inner_raceway),
        ("in_housing", "housing", b.outer_raceway),
    ):
        bare = raceway is not None and raceway.without_ring
        found[seat] = "# " if bare or not b.mounting else ""
        found[f"no_{part}"] = f"; not here: rollers run on the {part} itself" if bare else ""
    return found


def _aligned(text: str) -> str:
    """Return a scene with the comments behind its values below one another."""
    lines = []
    for line in text.splitlines():
        value, sign, comment = (
            line.partition(" # ") if not line.startswith("# Written") else (line, "", "")
        )
        lines.append(f"{value:<40} # {comment}" if sign else line)
    return "\n".join(lines) + "\n"
