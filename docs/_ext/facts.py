"""What the program itself knows of its documentation, as lines of reStructuredText; needs no Sphinx."""

import ast
import csv
import math
import re
import tomllib
from collections import Counter
from html import escape
from pathlib import Path

import attrs
import click

import architecture
from rollslip.bearing.cage import Cage
from rollslip.catalogue.kinds import built_in_module, get_kind, offered_kinds
from rollslip.catalogue.kinds import kinds as all_kinds
from rollslip.catalogue.registry import available, get_class
from rollslip.cli.main import cli
from rollslip.cli.models import models_as_dict
from rollslip.lubricant import GRADES, OilPoint, OilTable, OverTemperature
from rollslip.results.verdict import RULES
from rollslip.scene.relations import RELATIONS
from rollslip.scene.schema import schema, shown_default, shown_range
from rollslip.studies.study import study_class
from rollslip.units import format_quantity
from rollslip_campaigns.cases.table import CasesOfScene
from rollslip_campaigns.measurement import QUANTITIES
from rollslip_campaigns.sweep.definition import SweepTable
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_studies.variation.distributions import DISTRIBUTIONS, Correlation

ROOT = Path(__file__).parents[2]
#: Head of a table of keys.
KEYS = ("key", "unit", "default", "meaning", "usual", "possible")
#: Columns from which on a table is set in small letters, to stand on a laptop whole.
DENSE = ((12, "densest"), (8, "dense"))


def scene_keys():
    """All keys of a scene but those of oil and studies, which have their own tables."""
    rows = [row for row in schema() if row.key not in ("lubricant.*", "study.*")]
    return table(
        KEYS, [(f"``{r.key}``", r.unit, r.default, r.doc, r.usual, r.possible) for r in rows]
    )


def relations():
    """What values of a scene have to fit each other, with what that rests on."""
    rows = [
        (
            f"``{one.table}.{one.field}``",
            one.meaning,
            one.format_range(one.usual) if any(map(math.isfinite, one.usual)) else "",
            one.format_range(one.possible) if any(map(math.isfinite, one.possible)) else "",
            one.source,
        )
        for one in RELATIONS
    ]
    return table(("key", "what it amounts to", "usual", "possible", "rests on"), rows)


def oil_keys():
    """Keys of the table ``[lubricant]`` and of its points."""
    rows = [*fields(OilTable, "lubricant."), *fields(OilPoint, "lubricant.points[].")]
    rows += [
        (key, unit or "that of the property", *others)
        for key, unit, *others in fields(OverTemperature, "lubricant.PROPERTY.")
    ]
    return table(KEYS, rows)


def cage_keys():
    """Keys of the table ``[cage]``; what is estimated from the bearing says so in its meaning."""
    rows = [
        (key, unit, "derived" if "by default" in doc else default, doc, *ranges)
        for key, unit, default, doc, *ranges in fields(Cage, "cage.")
    ]
    return table(KEYS, rows)


def cases_keys():
    """Keys of the table ``[cases]``."""
    return table(KEYS[:4], [row[:4] for row in fields(CasesOfScene, "cases.")])


def sweep_keys():
    """Keys of the tables ``[sweep]`` and ``[uncertainty]``."""
    lines = table(KEYS[:4], [row[:4] for row in fields(SweepTable, "sweep.")])
    for name, distribution in DISTRIBUTIONS.items():
        lines += [
            "",
            f'.. rubric:: distribution = "{name}"',
            "",
            literal_markup(distribution.__doc__),
            "",
        ]
        rows = [
            (key, "that of the value" if key.strip("`") in OWN[name] else unit, default, doc)
            for key, unit, default, doc, *_ in fields(distribution, "")
        ]
        lines += table(KEYS[:4], rows)
    lines += ["", ".. rubric:: ``[[uncertainty.correlation]]``", ""]
    return lines + table(KEYS[:4], [row[:4] for row in fields(Correlation, "")])


#: Distribution -> its values in the unit of what is uncertain.
OWN = {
    name: {a.name for a in attrs.fields(cls) if a.metadata.get("own_unit")}
    for name, cls in DISTRIBUTIONS.items()
}


def study_keys():
    """Settings of all studies."""
    lines = []
    for name in available("study"):
        study = study_class(name)
        lines += ["", f".. rubric:: ``[study.{name}]``", ""]
        lines += table(KEYS, fields(study, ""))
    return lines


def models():
    """What a scene can name, a section for each kind: all about data, of models what they are, and their pages."""
    lines = []
    for kind in offered_kinds():
        lines += [kind.capitalize(), "-" * len(kind), ""]
        for name in available(kind):
            thing = get_class(kind, name)
            lines += ["", f".. rubric:: {name}", ""]
            if isinstance(thing, type):
                summary = models_as_dict(name)[kind]["description"].partition("\n")[0]
                lines += [f"{literal_markup(summary)} :doc:`Its page <model/{kind}-{name}>`.", ""]
                continue
            lines += data(thing)
            if thing.references:
                lines += [
                    "",
                    "References:",
                    "",
                    *(f"- {citation(one)}" for one in thing.references),
                ]
            lines.append("")
        if not available(kind):
            lines += ["None is in the box; a plugin can offer them.", ""]
    return lines


def citation(one):
    """How a citation reads, its DOI as a link."""
    text = literal_markup(str(one))
    link = getattr(one, "link", "")
    return (
        text.replace(literal_markup(f"doi:{one.doi}"), f"`doi:{one.doi} <{link}>`__")
        if link
        else text
    )


def model(kind, name):
    """Everything about one model but its references."""
    about = models_as_dict(name)[kind]
    prose = re.split(r"\n\w+\n---", about["description"])[0]  # without sections such as Raises
    lines = [literal_markup(prose), ""]
    if about["equation"]:
        lines += ["::", "", f"    {about['equation']}", ""]
    if "returns" in about:
        lines += [f"Returns the film thickness: {about['returns']}; regime: {about['regime']}.", ""]
    if about["parameters"]:
        rows = [(f"``{p['name']}``", *(p[key] for key in KEYS[1:])) for p in about["parameters"]]
        lines += table(("parameter", *KEYS[1:]), rows)
    else:
        lines += ["No parameters of its own.", ""]
    if "reads" in about:
        reads = [f"``{r['name']}`` {r['domain']}".strip() for r in about["reads"]]
        compiled = "compiled and in NumPy" if about["compiled"] else "in NumPy"
        lines += [f"Reads, with domain: {', '.join(reads)}.", ""]
        lines += [
            f"Writes {', '.join(f'``{member}``' for member in about['writes'])}; {compiled}.",
            "",
        ]
    if about.get("made_for"):
        rows = [(v["bound"], v["outside"], v["remedy"], v["source"]) for v in about["made_for"]]
        lines += table(("valid for", "outside", "remedy", "rests on"), rows)
    return lines


def validity():
    """What the laws in the box were made for: a row for each bound, with all laws that state it."""
    rows = {}
    for kind in offered_kinds():
        for name in available(kind):
            if isinstance(get_class(kind, name), type):
                for one in models_as_dict(name)[kind].get("made_for", ()):
                    rows.setdefault(tuple(one.values()), []).append(f"``{name}``")
    lines = table(
        ("laws", "code", "valid for", "outside", "remedy", "rests on"),
        [(", ".join(names), *row) for row, names in sorted(rows.items())],
    )
    return [lines[0], "   :class: wrapping", *lines[1:]]


def grades():
    """What the letters of grades stand for."""
    return table(
        ("grade", "the datum is"), [(f"({grade})", meaning) for grade, meaning in GRADES.items()]
    )


def data(thing):
    """Everything about one named set of data but its references."""
    lines = [literal_markup(thing.description), "", literal_markup(thing.source), ""]
    if own := getattr(thing, "grades", None):
        lines += [
            literal_markup(
                f"Data quality: {', '.join(f'{key} ({grade})' for key, grade in own.items())}."
            ),
            "",
        ]
    if hasattr(thing, "minimum_temperature"):
        low, high = (
            format_quantity(T, "K") for T in (thing.minimum_temperature, thing.maximum_temperature)
        )
        lines += [f"Range: {low} to {high}.", ""]
    if hasattr(thing, "validity"):
        lines += [literal_markup(thing.validity), ""]
    return lines


def kinds():
    """The kinds of models with their hooks and entry-point groups, and what to start from."""
    rows = []
    for kind in all_kinds():
        of = get_kind(kind)
        start = (
            f"``{built_in_module(kind)}``"
            if of.template is None
            else f"``rollslip plugins new --kind {kind}``"
        )
        rows.append(
            (f"``{kind}``", f"``{of.hook}``", f"``rollslip.{kind.replace('-', '_')}``", start)
        )
    return table(("kind", "hook", "entry-point group", "start from"), rows)


def measured_quantities():
    """What data sets can hold, with units."""
    rows = [(f"``{name}``", one.unit, one.doc, one.of) for name, one in QUANTITIES.items()]
    return table(("quantity", "unit", "meaning", "of a"), rows)


def every_command():
    """All commands by name, those of campaigns among them."""
    context = click.Context(cli)
    return {name: cli.get_command(context, name) for name in cli.list_commands(context)}


def commands():
    """The commands with their options."""
    lines = []
    every = every_command()
    for name, group in dict(every).items():
        every |= {
            f"{name} {inner}": command for inner, command in getattr(group, "commands", {}).items()
        }
    for name, command in sorted(every.items()):
        context = click.Context(command, info_name=f"rollslip {name}")
        usage = " ".join(command.collect_usage_pieces(context))
        lines += ["", f".. rubric:: rollslip {name}", "", literal_markup(command.help or ""), ""]
        lines += ["::", "", f"    rollslip {name} {usage}", ""]
        records = [
            p.get_help_record(context) for p in command.params if isinstance(p, click.Option)
        ]
        rows = [(f"``{option}``", text) for option, text in filter(None, records)]
        if rows:
            lines += table(("option", "meaning"), rows)
    return lines


def contract():
    """The members of ``rs_slices``, in their order."""
    lines = [".. rubric:: Shared by all slices of a table", ""]
    lines += table(
        ("member", "unit", "meaning"), [(f"``{n}``", u, d) for n, (u, d) in CONDITIONS.items()]
    )
    lines += [".. rubric:: One value a slice", ""]
    lines += table(
        ("column", "unit", "meaning"), [(f"``{n}``", u, d) for n, (u, d) in COLUMNS.items()]
    )
    return lines


def vector_math():
    """The elementary functions of rollslip_math.h with the worst errors that stand beside them."""
    header = (ROOT / "kernels/rollslip_kernels/include/rollslip_math.h").read_text(encoding="utf-8")
    found = re.findall(
        r"/\* (?:[^*;]* )?([\d.]+) ulp[^*]*\*/\nRS_INLINE double rs_([a-z0-9]+)\w*\(", header
    )
    return table(("function", "worst error, ulp"), [(f"``{name}``", ulp) for ulp, name in found])


def example_packages():
    """The packages of docs/example-plugins with what they offer."""
    rows = []
    for file in sorted((ROOT / "docs" / "example-plugins").glob("*/pyproject.toml")):
        project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        offers = [
            f"{group.removeprefix('rollslip.')} ``{name}``"
            for group in project["entry-points"]
            for name in project["entry-points"][group]
        ]
        rows.append((f"``{project['name']}``", ", ".join(offers), project["description"]))
    return table(("package", "offers", "what it is"), rows)


def changelog():
    """CHANGELOG.md; of its Markdown only headings, lists, code, links and bare paragraphs are understood."""
    lines = []
    for line in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").splitlines()[1:]:
        line = re.sub(
            r"\[([^\]]+)\]\(([^)]+)\)", r"`\1 <\2>`__", re.sub(r"`([^`]+)`", r"``\1``", line)
        )
        if heading := re.match(r"(##+) (.+)", line):
            lines += [f".. rubric:: {heading[2]}", f"   :heading-level: {len(heading[1])}"]
        else:
            lines.append(line)
    return lines


#: The roots, each of which may import those before it.
ROOTS = {
    "kernels/rollslip_kernels": "compiled loops and laws",
    "framework/rollslip": "interfaces, bearing, commands",
    "plugins/rollslip_plugins": "the models in the box",
    "plugins/rollslip_studies": "questions to one bearing",
    "plugins/rollslip_campaigns": "questions to many points",
}


def purpose(folder):
    """The first sentence of a folder's __init__."""
    return ast.get_docstring(
        ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
    ).partition("\n\n")[0]


def folders():
    """The folders of each root with their purposes, those of the framework in the order of imports."""
    lines = []
    for root in ROOTS:
        base = ROOT / root
        inner = {path.parent.relative_to(base) for path in base.rglob("*/__init__.py")} - {Path()}
        ranks = {
            path: architecture.ORDER.index(architecture.folder(f"{base.name}.{path.parts[0]}"))
            for path in inner
        }
        packages = sorted(inner, key=lambda path: (ranks[path], path))
        rows = [(f"``{path.as_posix()}/``", purpose(base / path)) for path in packages]
        lines += [
            "",
            f".. rubric:: {root}",
            "",
            literal_markup(purpose(base)),
            "",
            *table(("folder", "purpose"), rows),
        ]
    return lines


def imports_picture():
    """The roots and the folders of the framework as a picture: a dot for each folder that a folder imports."""
    known = architecture.modules(ROOT)
    count = Counter()
    for module, path in known.items():
        if module != architecture.FACE:
            used = architecture.imports(path, known) & known.keys()
            count.update(
                (architecture.folder(module), architecture.folder(other)) for other in used
            )
    step = 20
    top = 102
    order = architecture.ORDER
    pitch = 486 / len(ROOTS)
    wide = pitch - 14
    height = top + step * len(order) + 8
    drawn = [
        f'<svg xmlns="http://www.w3.org/2000/svg" class="architecture" viewBox="0 0 480 {height}" role="img" '
        'aria-labelledby="architecture-says">',
        f'<title id="architecture-says">{escape(_picture_in_words(count))}</title>',
    ]
    for k, (root, about) in enumerate(ROOTS.items()):
        left = 4 + pitch * k
        drawn.append(
            f'<rect x="{left:.1f}" y="4" width="{wide:.1f}" height="52" rx="6" class="box"/>'
        )
        name = root.removesuffix("/rollslip").rpartition("_")[2]
        drawn.append(f'<text x="{left + wide / 2:.1f}" y="24" class="head">{name}</text>')
        drawn += [
            f'<text x="{left + wide / 2:.1f}" y="{38 + 11 * row}" class="small">{escape(text)}</text>'
            for row, text in enumerate(_halves(about))
        ]
        if k:
            drawn.append(f'<path d="M{left - 2:.1f} 30h-10m4 -4l-4 4l4 4" class="line"/>')
    drawn.append(
        f'<text x="4" y="{top - 16}" class="left strong">folders of the framework, studies, campaigns</text>'
    )
    for row, name in enumerate(order):
        y = top + step * row
        for column, other in enumerate(order[: row + 1]):
            x = 14 + step * column
            if column == row:
                drawn.append(
                    f'<rect x="{x - 7}" y="{y - 7}" width="14" height="14" rx="3" class="own"/>'
                )
            elif number := count[name, other]:
                radius = min(2.0 + 0.7 * number**0.5, 6.5)
                says = f"<title>{name} imports {other}: {number}</title>"
                drawn.append(f'<circle cx="{x}" cy="{y}" r="{radius:.1f}">{says}</circle>')
        drawn.append(f'<text x="{26 + step * row}" y="{y + 4}" class="left">{name}</text>')
    return [".. raw:: html", "", *(f"   {line}" for line in (*drawn, "</svg>"))]


def _picture_in_words(count):
    told = []
    for name in architecture.ORDER:
        used = [other for other in architecture.ORDER if other != name and count[name, other]]
        told.append(f"{name} imports {', '.join(used) or 'no other folder'}")
    roots = "campaigns, studies and plugins import framework and kernels, framework imports kernels"
    return f"{roots}. In the framework, of studies and of campaigns: {'; '.join(told)}."


def _halves(text):
    """A text in two lines of about one length."""
    words = text.split()
    cut = min(
        range(1, len(words)), key=lambda k: abs(len(" ".join(words[:k])) - len(" ".join(words[k:])))
    )
    return " ".join(words[:cut]), " ".join(words[cut:])


def from_table(name):
    """docs/tables/NAME.csv, with spaces for underscores in its header, so that it can wrap."""
    with (ROOT / "docs" / "tables" / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    header = [column.replace("_", " ") for column in header]
    if (
        len(rows) < len(header) >= DENSE[0][0]
    ):  # few things of which much is told: one of them a column
        header, *rows = zip(header, *rows, strict=True)
    return table(header, rows)


def sentences():
    """How many sentences of each kind each root can say."""
    with (ROOT / "docs" / "tables" / "sentences.csv").open(newline="", encoding="utf-8") as file:
        count = Counter(
            (row["module"].partition("/")[0], row["kind"]) for row in csv.DictReader(file)
        )
    kinds_ = ("told", "error", "meaning", "source")
    roots = sorted({root for root, _ in count})
    return table(
        ("root", *kinds_),
        [(f"``{root}``", *(str(count[root, kind]) for kind in kinds_)) for root in roots],
    )


def verdicts():
    """The rules of the verdict, in the order in which they are asked."""
    return table(
        ("rule", "verdict", "where", "rests on"),
        [(one.code, one.verdict, one.condition, one.source) for one in RULES],
    )


PARTS = {
    "scene-keys": scene_keys,
    "relations": relations,
    "oil-keys": oil_keys,
    "cage-keys": cage_keys,
    "study-keys": study_keys,
    "sweep-keys": sweep_keys,
    "cases-keys": cases_keys,
    "grades": grades,
    "models": models,
    "validity": validity,
    "kinds": kinds,
    "measured-quantities": measured_quantities,
    "commands": commands,
    "contract": contract,
    "vector-math": vector_math,
    "changelog": changelog,
    "example-packages": example_packages,
    "folders": folders,
    "imports-picture": imports_picture,
    "sentences": sentences,
    "verdicts": verdicts,
    "table": from_table,
}


def fields(cls, prefix):
    """Rows of `KEYS`, with the choices, for the fields of an attrs class."""
    rows = []
    for a in attrs.fields(cls):
        if a.metadata.get("key", a.name) is None:
            continue
        validator = getattr(a.validator, "validator", a.validator)  # that of an optional value
        choices = ", ".join(f"``{choice}``" for choice in getattr(validator, "options", ()))
        meaning = a.metadata.get("doc", "") + (f": {choices}" if choices else "")
        ranges = (shown_range(a, which) for which in ("usual", "possible"))
        rows.append(
            (
                f"``{prefix}{a.name}``",
                a.metadata.get("unit") or "",
                shown_default(a),
                meaning,
                *ranges,
            )
        )
    return rows


def table(header, rows):
    """Return a table as lines."""
    lines = [
        ".. list-table::",
        "   :header-rows: 1",
        *[f"   :class: {name}" for least, name in DENSE if len(header) >= least][:1],
        "",
    ]
    for row in (header, *rows):
        for k, cell in enumerate(row):
            lines.append(f"   {'  -' if k else '* -'} {literal_markup(cell)}".rstrip())
    return [*lines, ""]


def literal_markup(text):
    """Keep ``code``, and escape what reStructuredText would read as markup in formulas and names."""
    parts = re.split(r"(``[^`]+``)", text)
    return "".join(p if p.startswith("``") else re.sub(r"([\\*|`_])", r"\\\1", p) for p in parts)
