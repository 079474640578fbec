"""Print models, data and kinds on a terminal, and convert them to plain values for JSON."""

import inspect
import re
from contextlib import suppress
from typing import Any, Final

import attrs
import click

from rollslip.catalogue.discovery import (
    available,
    catalogue,
    describe_other_product,
    families,
    find,
    get_class,
    load,
)
from rollslip.catalogue.installed import Offer
from rollslip.catalogue.kinds import get_kind, offered_kinds, usable_kinds
from rollslip.cli.console import print_table
from rollslip.errors import PluginError, UnknownNameError, did_you_mean, nearest
from rollslip.lubricant.oil import GRADES, legend
from rollslip.models import SliceModel, interval
from rollslip.references import ReferenceValue
from rollslip.results.verdict import RULES
from rollslip.scene.schema import shown_range
from rollslip.structure import fields_of, resolved
from rollslip.studies.validity import APPROXIMATION, describe_bound
from rollslip.toml import as_list
from rollslip.units import format_quantity

__all__ = ["explained", "kinds_of", "models_as_dict", "print_models"]

#: Other name of a kind -> the kind.
_KINDS = {
    "oil": "lubricant",
    "oils": "lubricant",
    "lubricants": "lubricant",
    "bearings": "bearing",
}
#: Names of a kind that are listed without -v; kinds with no more of them share a line. Doubling it fills more than 15
#: lines. Chosen.
_MAX_LISTED: Final = 4
#: Keys of the scatter of a datum other than the parameters of its distribution.
_SCATTER_KEYS = ("quantity", "distribution", "grade", "source")


def print_models(what: str | None, *, verbose: bool = False) -> None:
    """Print what there is, the models of a kind, or the description of one model.

    Parameters
    ----------
    what : str or None
        Name of a kind or model; None for all kinds.
    verbose : bool, optional
        Whether all names of all kinds are printed.
    """
    if what is not None:
        what = _KINDS.get(what, what)
    if what is None:
        _print_kinds(verbose)
    elif what in offered_kinds():
        print_table(("name", "package", "what it is"), list(map(_summary, _all_offers(what))))
    else:
        for kind in kinds_of(what):
            _print_model(kind, what)


def _print_kinds(verbose: bool) -> None:
    """Print the names of each kind, some of them or all; kinds with few names share a line."""
    names = {kind: _names(kind) for kind in offered_kinds()}
    small = {} if verbose else {kind: n for kind, n in names.items() if len(n) <= _MAX_LISTED}
    click.echo(f"{sum(map(len, names.values()))} models and data sets of {len(names)} kinds")
    for kind, every in names.items():
        if kind in small:
            continue
        shown = every if verbose else every[:_MAX_LISTED]
        more = f" and {len(every) - len(shown)} more" if len(every) > len(shown) else ""
        click.echo(f"  {kind:<11} {', '.join(shown) or 'none installed'}{more}")
    if small:
        others = ", ".join(f"{len(every)} {kind}" for kind, every in small.items())
        click.echo(f"  others      {others}")
    for offer in _offers():
        if offer.state != "ok":
            text = f"{offer.kind} {offer.name!r} of package {offer.package}: {offer.state}: {offer.cause}"
            click.echo(text, err=True)
    click.echo(
        "rollslip models KIND lists a kind, rollslip models NAME describes a model, -v lists all"
    )


def _names(kind: str) -> list[str]:
    """Return the names of a kind, those of families as one text each."""
    families_of_kind = [
        offer.name
        for offer in _offers()
        if offer.kind == kind and offer.state == "ok" and offer.is_family
    ]
    return [*available(kind), *(f"many of {name}" for name in families_of_kind)]


def models_as_dict(what: str | None) -> Any:
    """Return the content of `print_models` as plain values."""
    if what is None:
        return list(map(attrs.asdict, _offers()))
    what = _KINDS.get(what, what)
    if what in offered_kinds():
        return {offer.name: _model_as_dict(what, offer.name) for offer in _all_offers(what)}
    return {kind: _model_as_dict(kind, what) for kind in kinds_of(what)}


def explained(code: str) -> dict[str, str]:
    """Return the explanation of the code of a note, or of a rule of the verdict: title -> text."""
    found = {
        rule.code: {"verdict": rule.verdict, "where": rule.condition, "rests on": rule.source}
        | ({"remedy": rule.remedy} if rule.remedy else {})
        for rule in RULES
    } | {APPROXIMATION: {"note": "a law that approximates another is off it by as much as the note says",
                         "remedy": "the law that it approximates, which the note names"}}  # fmt: skip
    own = dict[tuple[str, str], dict[str, list[str]]]()
    for kind in offered_kinds() if code not in found else ():
        for name, offer in available(kind).items():
            if offer.state != "ok" or get_kind(kind).data:
                continue
            for bound in _model_as_dict(kind, name).get("made_for", ()):
                row = found.setdefault(bound["code"], {"laws": "", "valid for": "", "outside": ""})
                law = f"{kind} {name}"
                row["laws"] = ", ".join(filter(None, (row["laws"], law)))
                row |= {"remedy": bound["remedy"], "rests on": bound["source"]}
                for key, text in (("valid for", bound["bound"]), ("outside", bound["outside"])):
                    own.setdefault((bound["code"], key), {}).setdefault(text, []).append(law)
    # where bounds or numbers differ, each text names its laws
    for (known_code, key), texts in own.items():
        found[known_code][key] = "; ".join(
            f"{', '.join(laws)}: {text}" if len(texts) > 1 else text for text, laws in texts.items()
        )
    if code not in found:
        hint = "notes are W01, W02 ..., rules of a verdict V1, V2 ..."
        with suppress(PluginError):
            hint = f"it is a {kinds_of(code.lower())[0]}: rollslip models '{code.lower()}'"
        if re.fullmatch(r"[WV]\d+", code):
            hint = f"did you mean {' or '.join(nearest(code, found, cutoff=0.4))}?"
        raise UnknownNameError(f"no note and no rule has the code {code!r}; {hint}")
    return found[code]


def kinds_of(name: str) -> list[str]:
    """Return the kinds in which a name is offered; raise `UnknownNameError` where there is none."""
    named = [kind.name for kind in usable_kinds() if kind.listed]
    offering = [kind for kind in named if name in available(kind)] or [
        kind for kind in offered_kinds() if get_kind(kind).data and _is_called(kind, name)
    ]
    if not offering:
        if other := describe_other_product("bearing", name):
            raise UnknownNameError(f"nothing is called {name!r}: {other}")
        names = [offer.name for kind in offered_kinds() for offer in _all_offers(kind)]
        hint = did_you_mean(
            nearest(name, [*offered_kinds(), *names], cutoff=0.4), "'rollslip models' lists them"
        )
        raise UnknownNameError(f"no model and no kind is called {name!r}; {hint}")
    return offering


def _is_called(kind: str, name: str) -> bool:
    """Whether a kind of data has a name, in any spelling."""
    try:
        find(kind, name)
    except PluginError:
        return False
    return True


def _all_offers(kind: str) -> list[Offer]:
    """Return the offers of all names of a kind, those of families last."""
    of_families = [
        attrs.evolve(offer, name=name) for offer, family in families(kind) for name in family.names
    ]
    return [*available(kind).values(), *of_families]


def _offers() -> list[Offer]:
    """Return the offers of all kinds that are listed."""
    return [offer for offer in catalogue() if offer.kind in offered_kinds()]


def _summary(offer: Offer) -> tuple[str, str, str]:
    """Return name, package and first line of the description of an offer."""
    try:
        thing = load(offer)
    except PluginError as error:
        return offer.name, offer.package, f"broken: {error}"
    text = (
        thing.description
        if get_kind(offer.kind).data
        else (inspect.getdoc(thing) or "").partition("\n")[0]
    )
    if synonyms := getattr(thing, "synonyms", ()):
        text += f"; also {', '.join(synonyms)}"
    return offer.name, f"{offer.package} {offer.version}", text


def _model_as_dict(kind: str, name: str) -> dict[str, Any]:
    """Return the description of a model or a data set as plain values."""
    offer = find(kind, name)
    thing = get_class(kind, name)
    about: dict[str, Any] = {
        "kind": kind,
        "name": offer.name,  # the exact name, for any spelling
        "package": offer.package,
        "version": offer.version,
    }
    if get_kind(kind).data:
        return about | _data_as_dict(kind, thing)
    parameters = [
        {
            "name": a.name,
            "unit": a.metadata.get("unit") or "",
            "default": _default(a),
            "meaning": a.metadata.get("doc", ""),
            "usual": shown_range(a, "usual"),
            "possible": shown_range(a, "possible"),
        }
        for _, a in fields_of(thing)
    ]
    about |= {
        "description": inspect.getdoc(thing) or "",
        "equation": getattr(thing, "equation", ""),  # an engine has none
        "parameters": parameters,
        "references": list(map(str, getattr(thing, "references", ()))),
        "reference_values": list(
            map(_describe_reference_value, getattr(thing, "reference_values", ()))
        ),
    }
    if outputs := getattr(thing, "outputs", None):  # of a study
        about["outputs"] = [
            {"name": key, "dimensions": output.dims, "unit": output.unit, "meaning": output.meaning}
            for key, output in outputs.items()
        ]
    return about | _law_as_dict(kind, thing) if issubclass(thing, SliceModel) else about


def _describe_reference_value(reference: ReferenceValue) -> str:
    """Return a number of others with what it belongs to, in SI units, its source and the allowed difference."""
    given = ", ".join(
        f"{name} = {value:g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in {**reference.parameters, **reference.inputs}.items()
    )
    allowed = f"{100.0 * reference.rtol:.2g} % allowed"
    return f"{reference.value:.7g} at {given}; {reference.source}, {allowed}"


def _data_as_dict(kind: str, thing: Any) -> dict[str, Any]:
    """Return the description of a data set."""
    about: dict[str, Any] = {
        "description": thing.description,
        "source": thing.source,
        "references": list(map(str, thing.references)),
    }
    if hasattr(thing, "grades"):
        about |= {
            "grades": dict(thing.grades),
            "legend": {grade: GRADES[grade] for grade in sorted(set(thing.grades.values()))},
            "scatter": [
                {key: getattr(scatter, key) for key in _SCATTER_KEYS} | dict(scatter.parameters)
                for scatter in thing.scatter
            ],
        }
    if kind == "lubricant":
        limits = (thing.minimum_temperature, thing.maximum_temperature)
        return about | {
            "range": [format_quantity(T, "K") for T in limits],
            "synonyms": list(thing.synonyms),
        }
    return about | {"validity": thing.validity, "values": resolved(thing.data)}


def _law_as_dict(kind: str, thing: Any) -> dict[str, Any]:
    """Return the members, the validity and the form of a law; of a law with required parameters by its class."""
    from rollslip_kernels.slices import COLUMNS, CONDITIONS

    members = {**CONDITIONS, **COLUMNS}
    has_defaults = all(a.default is not attrs.NOTHING for a in attrs.fields(thing))
    model = thing() if has_defaults else thing
    about = dict[str, Any]()
    if kind == "film":
        about = {"returns": f"{model.location} film thickness", "regime": model.regime}
    return about | {
        "reads": [
            {
                "name": m,
                "unit": members[m][0],
                "meaning": members[m][1],
                "domain": interval(model.domain.get(m)),
            }
            for m in sorted(model.reads)
        ],
        "writes": sorted(model.writes),
        "made_for": [
            {
                "code": bound.code,
                "bound": describe_bound(bound),
                "outside": bound.consequence_range,
                "remedy": bound.remedy,
                "source": bound.source,
            }
            for bound in (model.validity if has_defaults else ())
        ],
        "compiled": model.kernel() is not None
        if has_defaults
        else thing.kernel is not SliceModel.kernel,
    }


def _values(prefix: str, data: Any) -> list[tuple[str, str]]:
    """Return the values of a data set by the keys of a scene, as a scene may have them."""
    rows = []
    for attribute in attrs.fields(type(data)):
        key = f"{prefix}.{attribute.name}"
        value = getattr(data, attribute.name)
        unit = attribute.metadata.get("unit")
        if attrs.has(type(value)):
            rows += _values(key, value)
        elif value not in (None, ()):
            rows.append(
                (key, format_quantity(value, unit) if unit not in (None, "1") else str(value))
            )
    return rows


def _default(attribute: "attrs.Attribute[Any]") -> str:
    """Return the default of a parameter as text."""
    default: Any = attribute.default
    if default is attrs.NOTHING:
        return "required"
    if "from_scene" in attribute.metadata:
        return "the scene's"
    if "kind" in attribute.metadata:
        return str(default.factory().name)
    unit = attribute.metadata.get("unit")
    if isinstance(default, tuple):
        return ", ".join(format_quantity(value, unit or "1") for value in default) or "none"
    return (
        format_quantity(default, unit)
        if isinstance(default, float) and unit not in (None, "1")
        else str(default)
    )


def _print_model(kind: str, name: str) -> None:
    """Print the description of a model or a data set."""
    about = _model_as_dict(kind, name)
    click.echo(f"{about['name']} ({kind}, {about['package']} {about['version']})\n")
    click.echo(about["description"] + "\n")
    if about.get("equation"):
        click.echo(f"equation    {about['equation']}\n")
    for key in ("returns", "regime", "range", "validity", "source"):
        if key in about:
            click.echo(f"{key:<11} {' to '.join(as_list(about[key]))}")
    _print_data(kind, name, about)
    _print_law(about)
    for text in about.get("reference_values", ()):
        click.echo(f"value       {text}")
    if about["references"]:
        click.echo("\n  ".join(["references", *about["references"]]))


def _print_data(kind: str, name: str, about: dict[str, Any]) -> None:
    """Print the parts of a description that only data sets have."""
    if about.get("synonyms"):
        click.echo(f"also called {', '.join(about['synonyms'])}")
    if about.get("values"):
        click.echo("values")
        print_table(("key", "value"), _values(kind, load(find(kind, name)).data))
    if about.get("grades"):
        click.echo(
            f"quality     {', '.join(f'{key} ({grade})' for key, grade in about['grades'].items())}"
        )
        click.echo(f"            {legend(about['legend'])}")
    for scatter in about.get("scatter", ()):
        parameters = ", ".join(
            f"{key} {value}" for key, value in scatter.items() if key not in _SCATTER_KEYS
        )
        click.echo(
            f"scatter     {scatter['quantity']} {scatter['distribution']}, {parameters} {scatter['grade']}: "
            f"{scatter['source']}"
        )


def _print_law(about: dict[str, Any]) -> None:
    """Print the parts of a description that only models have."""
    if about.get("parameters"):
        click.echo("parameters")
        print_table(
            ("name", "unit", "default", "meaning"),
            [
                (
                    p["name"],
                    p["unit"],
                    p["default"],
                    p["meaning"] + (f"; usually {p['usual']}" if p["usual"] else ""),
                )
                for p in about["parameters"]
            ],
        )
    elif "parameters" in about:
        click.echo("parameters  none of its own")
    if "reads" in about:
        click.echo("reads from scene, lubricant and the stages before it; its domain")
        print_table(
            ("name", "unit", "domain", "meaning"),
            [(r["name"], r["unit"], r["domain"], r["meaning"]) for r in about["reads"]],
        )
    if about.get("made_for"):
        click.echo("valid for; outside of it a result warns")
        for v in about["made_for"]:
            code = f"{v['code']} " if v["code"] else ""
            click.echo(
                f"  {code}{v['bound']}; outside, {v['outside']}; remedy: {v['remedy']}; rests on: {v['source']}"
            )
    if "outputs" in about:
        click.echo("outputs")
        print_table(
            ("name", "over", "unit", "meaning"),
            [(o["name"], o["dimensions"], o["unit"], o["meaning"]) for o in about["outputs"]],
        )
