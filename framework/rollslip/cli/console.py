"""How plans, results, scenes and models read on a terminal and in JSON."""

import importlib
import importlib.metadata
import json
import math
import platform
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs
import click

from rollslip.bearing.resolution import error_text
from rollslip.catalogue.discovery import Offer, available, catalogue, find, get_class
from rollslip.catalogue.kinds import get_kind, kinds
from rollslip.errors import PluginError
from rollslip.models import SliceModel, interval
from rollslip.scene.values import Scene, resolved, scene_hash
from rollslip.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr

    from rollslip.campaigns.comparison.comparison import Comparison
    from rollslip.campaigns.pareto.candidates import Family
    from rollslip.planning.plan import Plan
    from rollslip.studies.answers import Part

Sections = dict[str, list[tuple[str, str]]]


def headline(plan: "Plan") -> str:
    """Return the first line of every run: version, scene and hash, models with their packages."""
    return _headline(plan.scene, ((kind, model.name, model.name) for kind, model in plan.models))


def _headline(scene: Scene, models: Iterable[tuple[str, str, str]]) -> str:
    """First line for models by kind, name and what they are called here."""
    offers = ((kind, called, find(kind, name)) for kind, name, called in models)
    used = ", ".join(f"{kind} {called} ({offer.package} {offer.version})" for kind, called, offer in offers)
    version = importlib.metadata.version("rollslip")
    return f"rollslip {version} | {scene.source} {scene_hash(scene)[:12]} | {used}"


def findings(dataset: "xr.Dataset") -> str:
    """Return what a study found, in a few lines."""
    study = dataset.attrs["study"]
    if said := _spoken(study):
        return "\n  ".join((f"{study}:", *said.sentences(dataset)))
    lines = [f"{study}:"]
    for name, row in _critical_rows(dataset):
        found = (
            f"critical slip {row['critical_slip']:.2%}, largest friction {row['critical_friction']:.4g}"
            if row["critical_slip"] is not None
            else row["status"]
        )
        lines.append(f"  {name}: {found}")
    if "instants_error" in dataset.attrs:
        slices = dataset.attrs.get("slices_error", 0.0)  # one slice under an even load leaves none
        lines.append(
            f"  {dataset.attrs['instants']} instants of a pitch and {dataset.attrs['slices']} slices of a roller leave "
            f"relative errors of about {dataset.attrs['instants_error']:.1e} and {slices:.1e}; "
            f"residual of the forces {dataset.attrs['force_residual']:.1e}"
        )
    return "\n".join(lines)


def run_as_dict(plan: "Plan", datasets: "Mapping[str, xr.Dataset]", target: Path, files: list[str]) -> dict[str, Any]:
    """Return what a run did, as plain values; a value without meaning is null, with its status beside it."""
    return {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": plan.scene.source,
        "scene_hash": scene_hash(plan.scene),
        "models": _by_kind(plan.models),
        "studies": {
            name: {
                "results": _results(dataset),
                "warnings": json.loads(dataset.attrs["warnings"]),
                "evaluations": int(dataset.attrs["evaluations"]),
                "wall_time": float(dataset.attrs["wall_time"]),
                "accuracy": json.loads(dataset.attrs["accuracy"]),
                "cost": json.loads(dataset.attrs["cost"]),
            }
            for name, dataset in datasets.items()
        },
        "folder": str(target),
        "files": files,
    }


def _results(dataset: "xr.Dataset") -> dict[str, Any]:
    """What a study found, as plain values."""
    if said := _spoken(dataset.attrs["study"]):
        found: dict[str, Any] = said.record(dataset)
        return found
    return dict(_critical_rows(dataset))


def _spoken(study: str) -> Any:
    """Return the module that has the words of a study in which there is more than friction curves, or None."""
    names = {
        "dynamics": "motion_findings",
        "steady-slip": "steady_findings",
        "pareto": "front_findings",
        "sweep": "sweep_findings",
        "uncertainty": "uncertainty_findings",
    }
    return importlib.import_module(f"rollslip.{names[study]}") if study in names else None


def _by_kind(models: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Names of models by kind; a list where a kind has several."""
    names: dict[str, list[str]] = {}
    for kind, model in models:
        names.setdefault(kind, []).append(model.name)
    return {kind: of[0] if len(of) == 1 and kind != "drag" else of for kind, of in names.items()}


def _critical_rows(dataset: "xr.Dataset") -> Iterable[tuple[str, dict[str, Any]]]:
    """Critical slip, its friction and its status of each ring or normal force."""
    if dataset.attrs["study"] == "comparison":
        from rollslip.campaigns.comparison.findings import members

        for label, one in members(dataset):
            yield from ((f"{label}, {name}", row) for name, row in _critical_rows(one))
        return
    if dataset.attrs["study"] == "effective-friction":
        names, slip = [f"{ring} ring" for ring in dataset["ring"].to_numpy()], dataset["critical_cage_slip"]
    else:
        names, slip = [format_quantity(float(q), "N") for q in dataset["normal_force"]], dataset["critical_slip"]
    for k, name in enumerate(names):
        yield (
            name,
            {
                "critical_slip": _or_none(slip[k]),
                "critical_friction": _or_none(dataset["critical_friction"][k]),
                "status": str(dataset["critical_status"].to_numpy()[k]),
            },
        )


def _or_none(value: Any) -> float | None:
    number = float(value)
    return None if math.isnan(number) else number


def print_plan(plan: "Plan") -> None:
    """Print the plan as a table, with its size and cost."""
    print_table(
        ("part", "", "choice", "resolution", "error", "cost", "reason"),
        [
            (
                p.part + (f" of {p.study}" if p.study and len(plan.studies) > 1 else ""),
                "in" if p.included else "out",
                p.choice,
                p.resolution,
                error_text(p.errors),
                "" if p.seconds is None else format_quantity(p.seconds, "s", 2),
                p.reason,
            )
            for p in plan.parts
        ],
    )
    click.echo(
        f"studies: {', '.join(plan.studies)}; {plan.degrees_of_freedom} degrees of freedom per instant; "
        f"about {plan.evaluations} slices to evaluate in {plan.seconds:.2g} s; planned in {plan.planning:.2g} s"
    )


def print_changed(pairs: "Sequence[tuple[Part | None, Part | None]]", this: str, other: str) -> None:
    """Print the parts in which two plans differ."""
    if not pairs:
        click.echo(f"{this} and {other} are planned alike")
        return

    def said(part: "Part | None") -> str:
        if part is None:
            return "-"
        texts = ["in" if part.included else "out", part.choice, part.resolution, error_text(part.errors)]
        return "; ".join(filter(None, texts))

    rows = []
    for one, two in pairs:
        part = one or two
        assert part is not None
        rows.append((part.part, said(one), said(two), part.reason))
    other = f"{other} (as it is)" if other == this else other
    print_table(("part", this, other, "reason"), rows)


def kept(dataset: "xr.Dataset") -> str:
    """Return what errors and time were estimated and found, in one line."""
    texts = []
    for row in json.loads(dataset.attrs["accuracy"]):
        name = row["result"].replace("_", " ")
        errors = [
            f"{row[which]:.0e} {word}"
            for which, word in (("estimated", "estimated"), ("found", row["how"]))
            if row[which] is not None
        ]
        texts.append(f"{name} {' and '.join(errors) or 'unknown'} of {row['tolerance']:g}")
    cost = json.loads(dataset.attrs["cost"])
    times = f"{format_quantity(cost['actual'], 's', 2)}, estimated {format_quantity(cost['estimated'], 's', 2)}"
    return f"  relative errors: {'; '.join(texts) or 'not estimated'}; time of the processor {times}"


def comparison_headline(comparison: "Comparison") -> str:
    """Return the first line of a comparison, with the models of all combinations."""
    chosen = [one.choices for one in comparison.combinations.values()]
    models = dict.fromkeys((kind, c[kind].name, c[kind].full) for kind in chosen[0] for c in chosen)
    return _headline(comparison.scene, models)


def print_comparison_plan(comparison: "Comparison") -> None:
    """Print what a comparison will run, with its size and cost as far as they can be told."""
    plans = comparison.plans.values()
    click.echo(
        f"{comparison.study} of {len(comparison.combinations)} combinations: {', '.join(comparison.combinations)}"
    )
    if comparison.exchanged:
        click.echo(comparison.exchanged)
    slices, seconds = sum(plan.evaluations for plan in plans), sum(plan.seconds for plan in plans)
    click.echo(f"about {slices} slices to evaluate, {seconds:.2g} s")


def print_found(dataset: "xr.Dataset") -> None:
    """Print what a comparison or a family of choices found: a table for each curve or study, and what they say."""
    said = importlib.import_module(
        f"rollslip.{'comparison' if dataset.attrs['study'] == 'comparison' else 'front'}_findings"
    )
    for name, head, rows in said.tables(dataset):
        click.echo(f"{name}:")
        print_table(head, rows)
    click.echo("\n".join(said.findings(dataset)))


def comparison_as_dict(dataset: "xr.Dataset", target: Path, files: list[str]) -> dict[str, Any]:
    """Return what a comparison found, as plain values; a value without meaning is null, with its status beside it."""
    from rollslip.campaigns.comparison.findings import findings, records

    a = dataset.attrs
    return {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": a["source"],
        "scene_hash": a["scene_hash"],
        "study": a["compared"],
        "reference": a["reference"],
        "reference_named": bool(a["reference_named"]),
        "exchanged": a["exchanged"],
        "results": records(dataset),
        "findings": findings(dataset),
        "warnings": json.loads(a["warnings"]),
        "evaluations": int(a["evaluations"]),
        "wall_time": float(a["wall_time"]),
        "folder": str(target),
        "files": files,
    }


def print_family(family: "Family") -> None:
    """Print what will be run: the number of choices of each study by kind, rounds and references."""
    for study in family.studies:
        of = {kind: len(family.of(study, kind)) for kind in ("numerical", "modelling", "film", "reference")}
        finest = family.of(study, "reference")[0].resolution
        instants = f" and {finest.instants} instants" if (finest.instants or 1) > 1 else ""
        click.echo(
            f"{study}: {of['numerical']} numerical and {of['modelling']} modelling choices and {of['film']} films, "
            f"{family.rounds} round{'s' * (family.rounds != 1)} each, against {of['reference']} references, the finest "
            f"with {finest.slices} slices{instants}"
        )
    for note in family.notes:
        click.echo(note)


def fronts_as_dict(dataset: "xr.Dataset", target: Path, files: list[str]) -> dict[str, Any]:
    """Return what a family of choices found, as plain values; an error that there is not is null, with its status."""
    from rollslip.campaigns.pareto.findings import findings, floors, records

    a = dataset.attrs
    return {
        "rollslip": importlib.metadata.version("rollslip"),
        "scene": a["source"],
        "scene_hash": a["scene_hash"],
        "studies": json.loads(a["studies"]),
        "rounds": int(a["rounds"]),
        "floors": floors(dataset),
        "choices": records(dataset),
        "findings": findings(dataset),
        "warnings": json.loads(a["warnings"]),
        "evaluations": int(a["evaluations"]),
        "wall_time": float(a["wall_time"]),
        "folder": str(target),
        "files": files,
    }


def print_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table as wide as the terminal, or 120 columns where there is none; cells wrap, but no word is cut."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    rows = list(rows)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for head, *cells in zip(header, *rows, strict=True):
        words = [word for cell in (head, *cells) for word in cell.split()]
        table.add_column(head, min_width=max(map(len, words), default=0))
    for row in rows:
        table.add_row(*(cell.replace("[", "\\[") for cell in row))
    Console(width=shutil.get_terminal_size((120, 24)).columns, highlight=False).print(table)


def print_sections(sections: Sections) -> None:
    """Print named groups of name and value."""
    for title, rows in sections.items():
        click.echo(title)
        width = max((len(name) for name, _ in rows), default=0)
        for name, value in rows:
            click.echo(f"  {name:<{width}}  {value}")


# Models -------------------------------------------------------------------------------------------------------------


def print_models(what: str | None) -> None:
    """Print all names, the models of a kind, or all about one name.

    Raises
    ------
    PluginError
        If nothing is called so.
    """
    if what is None:
        for kind in kinds():
            names = ", ".join(available(kind)) or "none installed"
            click.echo(f"{kind:<11} {names}")
        unusable = [offer for offer in catalogue() if offer.state != "ok"]
        for offer in unusable:
            click.echo(
                f"{offer.kind} {offer.name!r} of package {offer.package}: {offer.state}: {offer.cause}", err=True
            )
        click.echo("'rollslip models NAME' shows equation, parameters, domain and references of one")
    elif what in kinds():
        print_table(("name", "package", "what it is"), [_summary(offer) for offer in available(what).values()])
    else:
        for kind in kinds_of(what):
            _print_model(kind, what)


def models_as_dict(what: str | None) -> Any:
    """Return what ``print_models`` prints, as plain values."""
    if what is None:
        return [attrs.asdict(offer) for offer in catalogue()]
    if what in kinds():
        return {name: _model_as_dict(what, name) for name in available(what)}
    return {kind: _model_as_dict(kind, what) for kind in kinds_of(what)}


def kinds_of(name: str) -> list[str]:
    """Return the kinds in which something of this name is offered.

    Raises
    ------
    PluginError
        If there is none; the message gives the nearest names.
    """
    offering = [kind for kind in kinds() if name in available(kind)]
    if not offering:
        from rollslip.scene.reading import nearest

        near = nearest(name, [*kinds(), *(offer.name for offer in catalogue())], cutoff=0.4)
        hint = f"did you mean {' or '.join(map(repr, near))}?" if near else "'rollslip models' lists them"
        raise PluginError(f"no model and no kind is called {name!r}; {hint}")
    return offering


def _summary(offer: Offer) -> tuple[str, str, str]:
    try:
        thing = get_class(offer.kind, offer.name)
    except PluginError as error:
        return offer.name, offer.package, f"broken: {error}"
    text = thing.description if get_kind(offer.kind).data else _doc(thing)[0]
    return offer.name, f"{offer.package} {offer.version}", text


def _doc(cls: type) -> list[str]:
    import inspect

    return (inspect.getdoc(cls) or "").splitlines() or [""]


def _model_as_dict(kind: str, name: str) -> dict[str, Any]:
    from rollslip_kernels.slices import COLUMNS, CONDITIONS

    offer, thing = find(kind, name), get_class(kind, name)
    about: dict[str, Any] = {"kind": kind, "name": name, "package": offer.package, "version": offer.version}
    if get_kind(kind).data:
        about |= {
            "description": thing.description,
            "source": thing.source,
            "references": list(thing.references),
        }
        if kind == "lubricant":
            limits = (thing.minimum_temperature, thing.maximum_temperature)
            return about | {"range": [format_quantity(T, "K") for T in limits]}
        return about | {"validity": thing.validity, "values": resolved(thing.data)}
    members = {**CONDITIONS, **COLUMNS}
    parameters = [
        {
            "name": a.name,
            "unit": a.metadata.get("unit") or "",
            "default": _default(a),
            "meaning": a.metadata.get("doc", ""),
        }
        for a in attrs.fields(thing)
        if a.metadata.get("key", a.name) is not None  # else nobody can set it
    ]
    about |= {
        "description": "\n".join(_doc(thing)),
        "equation": getattr(thing, "equation", ""),  # an engine has none
        "parameters": parameters,
        "references": list(thing.references),
    }
    if not issubclass(thing, SliceModel):
        return about
    model = thing() if all(a.default is not attrs.NOTHING for a in attrs.fields(thing)) else thing
    if kind == "film":
        about |= {"returns": f"{model.location} film thickness", "regime": model.regime}
    return about | {
        "reads": [
            {"name": m, "unit": members[m][0], "meaning": members[m][1], "domain": interval(model.domain.get(m))}
            for m in sorted(model.reads)
        ],
        "writes": sorted(model.writes),
        "compiled": model.kernel() is not None,
    }


def _default(attribute: "attrs.Attribute[Any]") -> str:
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
    return format_quantity(default, unit) if isinstance(default, float) and unit not in (None, "1") else str(default)


def _print_model(kind: str, name: str) -> None:
    about = _model_as_dict(kind, name)
    click.echo(f"{name} ({kind}, {about['package']} {about['version']})\n")
    click.echo(about["description"] + "\n")
    if about.get("equation"):
        click.echo(f"equation    {about['equation']}\n")
    for key in ("returns", "regime", "range", "validity", "source"):
        if key in about:
            value = about[key] if isinstance(about[key], str) else " to ".join(about[key])
            click.echo(f"{key:<11} {value}")
    if about.get("parameters"):
        click.echo("parameters")
        print_table(
            ("name", "unit", "default", "meaning"),
            [(p["name"], p["unit"], p["default"], p["meaning"]) for p in about["parameters"]],
        )
    elif "parameters" in about:
        click.echo("parameters  none of its own")
    if "reads" in about:
        click.echo("reads from scene, lubricant and the stages before it; its domain")
        print_table(
            ("name", "unit", "domain", "meaning"),
            [(r["name"], r["unit"], r["domain"], r["meaning"]) for r in about["reads"]],
        )
    if about["references"]:
        click.echo("references")
    for text in about["references"]:
        click.echo(f"  {text}")


# Info ---------------------------------------------------------------------------------------------------------------


def installation() -> Sections:
    """Return versions, and which instruction set of the machine the kernels use."""
    from rollslip.cli import doctor

    return {
        "installation": [
            *doctor.versions().items(),
            ("python", sys.version.split()[0]),
            ("machine", f"{platform.system()} {platform.machine()}"),
            ("instructions", doctor.instructions()),
            ("models", ", ".join(f"{len(available(kind))} {kind}" for kind in kinds())),
        ]
    }


def result_info(path: Path) -> Sections:
    """Return what a stored result holds and where it comes from.

    Raises
    ------
    OutputError
        If the file is not a result.
    """
    from rollslip.results.dataset import open_result

    dataset = open_result(path)
    a = dataset.attrs
    return {
        "result": [
            ("study", a["study"]),
            ("scene", f"{a['source']} {a['scene_hash'][:12]}"),
            ("created", a["created"]),
            ("dimensions", ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())),
            ("variables", ", ".join(map(str, dataset.data_vars))),
            *([("evaluations", f"{a['evaluations']} slices in {a['wall_time']:.2g} s")] if "evaluations" in a else []),
            *_found(dataset),
        ],
        "packages": list(json.loads(a["packages"]).items()),
        "warnings": [("", text) for text in json.loads(a["warnings"])],
    }


def _found(dataset: "xr.Dataset") -> Iterable[tuple[str, str]]:
    """Name and what was found, of each parameter of a fit, of a motion, or of the critical slip of each curve."""
    if said := _spoken(dataset.attrs["study"]):
        return [(about, "; ".join(texts)) for about, texts in said.topics(dataset).items()]
    if dataset.attrs["study"] == "fit":
        from rollslip.campaigns.fit.findings import parameter_rows

        return [
            (name, f"{value}, 95 %: {widest}; {status}")
            for name, value, _, _, widest, status in parameter_rows(dataset)
        ]
    return [
        (name, f"critical slip {row['critical_slip']:.2%}" if row["critical_slip"] else row["status"])
        for name, row in _critical_rows(dataset)
    ]


def scene_info(scene: Scene) -> Sections:
    """Return what follows from a scene: kinematics, oil at temperature, load distribution, the heaviest contact's film.

    Raises
    ------
    SceneError, PluginError
        If the scene or a model it names cannot be used.
    """
    import numpy as np

    from rollslip.bearing.assembly import assemble
    from rollslip.bearing.regimes import LONG_NAMES, NAMES, film_by_regime, groups, moes_groups

    assembly = assemble(scene)
    k, loads = assembly.kinematics, assembly.load_distribution()
    speeds = k.surface_speeds(0.0, 0.0)
    sections: Sections = {
        "bearing": [
            ("radial clearance", format_quantity(scene.bearing.radial_clearance, "m")),
            ("roller mass", format_quantity(assembly.roller_mass, "kg")),
            ("epicyclic cage speed", format_quantity(k.epicyclic_cage_speed, "rad/s")),
            ("epicyclic roller spin", format_quantity(k.epicyclic_roller_speed, "rad/s")),
            ("centrifugal force of a roller", format_quantity(assembly.centrifugal_force, "N", 4)),
        ],
        "load distribution": [
            ("rollers loaded by the inner ring", str(int(np.count_nonzero(loads.inner_force[0])))),
            ("largest force, inner ring", format_quantity(float(loads.inner_force.max()), "N", 4)),
            ("largest force, outer ring", format_quantity(float(loads.outer_force.max()), "N", 4)),
            ("relative residual", f"{loads.force_residual:.1e} force, {loads.moment_residual:.1e} moment"),
        ],
    }
    for raceway, u, load in zip(
        assembly.raceways,
        (speeds.inner_rolling, speeds.outer_rolling),
        (loads.inner_load, loads.outer_load),
        strict=True,
    ):
        c = raceway.conditions
        rows = [
            ("equivalent radius", format_quantity(c.radius, "m")),
            ("rolling speed without slip", format_quantity(float(u), "m/s", 4)),
            ("oil", f"{assembly.lubricant.name} at {format_quantity(c.temperature, 'K')}"),
            ("viscosity", f"{1e3 * c.viscosity:.4g} mPa s"),
            ("pressure-viscosity coefficient", f"{1e9 * c.pressure_viscosity:.4g} 1/GPa"),
            ("composite roughness", format_quantity(c.roughness, "m", 4)),
        ]
        if load.max() > 0.0:
            slices = raceway.evaluate(np.array([load.max()]), u, 0.0)
            M, L = moes_groups(slices)
            code = int(film_by_regime(*groups(slices))[1][0])
            rows += [
                ("heaviest contact: mean pressure", format_quantity(float(slices.pressure[0]), "Pa", 4)),
                ("  half width", format_quantity(float(slices.half_width[0]), "m", 4)),
                (f"  film ({assembly.film.location})", format_quantity(float(slices.film_thickness[0]), "m", 4)),
                ("  film parameter", f"{slices.film_thickness[0] / c.roughness:.3g}"),
                ("  Moes M, L", f"{M[0]:.3g}, {L[0]:.3g}"),
                ("  film regime", LONG_NAMES[NAMES[code]]),
            ]
        sections[f"{raceway.ring} raceway"] = rows
    return sections
