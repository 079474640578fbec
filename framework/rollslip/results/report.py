"""The report of a run: all results in one HTML file that any browser opens and that stays readable for years.

- The answer is first, in print on a page of its own: verdict, rows, inputs, one figure, notes. The other figures and
  the warnings with their consequences follow. All other sections are folded until a reader opens them, in print too.
- The figures follow the page: light, dark, or printed. Tables become lists on narrow screens.
- The file has no scripts and loads nothing; a content security policy in its head lets the browser enforce that.
  Figures are embedded as SVG, with unique ids, because ids are shared by the whole page.
- The report is written from the datasets alone, so that a stored result gives the same report years later. Attributes
  that are missing are left out; attributes that are the same for all datasets are shown once.
- Every text from a scene or a plugin is escaped where it is put into the page: in `_tag`, in cells of `html_table` and
  around the figures, nowhere else.
- The page is well-formed XML, which tests can check more strictly than HTML.
"""

import base64
import contextlib
import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape, unescape
from numbers import Integral, Real
from pathlib import Path
from string import Template
from typing import Any, Final, TypeAlias

import attrs

from rollslip.bearing.regimes import LIGHT, LONG_NAMES
from rollslip.catalogue.registry import get_class
from rollslip.errors import PluginError
from rollslip.files import whole_file
from rollslip.lubricant.table import OilTable
from rollslip.references import Citation, as_bibtex
from rollslip.results.account import Table
from rollslip.results.accounts import account_of, answer, describe_measured
from rollslip.results.answer import Answer, collect_notes
from rollslip.results.curves import percent
from rollslip.results.dataset import citations_of, xr
from rollslip.results.style import GROUND, INK, adapting
from rollslip.results.text import (
    capitalise,
    collect_warnings,
    describe_case,
    describe_law_outputs,
    describe_more_bounds,
    html_table,
    with_unit,
)
from rollslip.scene.schema import rows_of, schema
from rollslip_kernels.slices import CONDITIONS

__all__ = ["is_report", "write_report"]

#: Results by name.
Datasets: TypeAlias = "Mapping[str, xr.Dataset]"
#: Attribute of any study -> its name in the table of numbers, and its unit.
_NUMBERS: Final = {
    "positions_error": ("error by roller positions", "1"),
    "slices_error": ("error by slices", "1"),
    "evaluations": ("slices evaluated", ""),
}

#: Width of a figure [pt] from which it takes the whole width of the page: figures of one column have 255 pt.
_WIDE: Final = 300.0
#: Pixels for a point at which letters of 6.5 pt are readable, 9 pixels high; with fewer a page scrolls sideways.
_READABLE: Final = 1.4
#: Variable of the style sheet with the smallest width of a figure.
_MIN_WIDTH: Final = "--min-width"
#: Key of the scene that the first page shows -> its name; more would not fit on the page.
_FIRST_INPUTS: Final = {
    "bearing.rollers": "rollers", "bearing.roller_diameter": "their diameter", "bearing.roller_length": "their length",
    "operation.inner_speed": "inner speed", "operation.outer_speed": "outer speed", "operation.radial_load": "load",
    "operation.misalignment": "misalignment", "operation.temperature": "temperature", "lubricant.name": "oil",
    "lubrication.supply": "oil supply", "cage.make": "cage", "cage.guidance": "guided by",
}  # fmt: skip

#: Parts of a bearing whose temperature is that of the oil unless a scene gives it.
_PARTS: Final = ("inner_ring", "outer_ring", "roller")

#: Works that are cited on the page, the first ones: the paper of the equations and rollslip. A file has the others.
_FULL_CITATIONS: Final = 2

#: A temperature in a sentence, which people write with the sign of a degree; a value in a command has quotes.
_CELSIUS: Final = re.compile(r"(?<=\d) degC\b(?!['\"&])")

#: A command that writes a report, in a shell or in Python; a report proposes a study of uncertainty in its place, which
#: has no other study as an option.
_REPORT_COMMAND: Final = re.compile(
    r"^rollslip( run |\.report\(rollslip\.run\()(.*?)(?: --study \S+|, study=\"\S+\")?( --report|\)\))$"
)


def _uncertainty_command(report: re.Match[str]) -> str:
    """Return the command of a study of uncertainty in place of a command that writes a report."""
    if report[3].startswith(" "):
        return f"rollslip uncertainty {report[2]}"
    return f"rollslip.uncertainty({report[2]})"


def write_report(
    datasets: "Mapping[str, xr.Dataset]",
    figures: Mapping[str, Sequence[Path]],
    path: Path,
    scene: str = "",
) -> None:
    """Write one self-contained HTML file about the results of a run.

    Parameters
    ----------
    datasets : mapping of str to xarray.Dataset
        Results by name.
    figures : mapping of str to sequence of Path
        SVG files of each result.
    path : Path
        The file.
    scene : str
        Argument of the commands in the report.
    """
    cases = set(map(describe_case, datasets.values())) - {()}
    first = answer(*datasets.values(), scene=scene) if len(cases) < 2 else Answer()
    commands = (_REPORT_COMMAND.sub(_uncertainty_command, command) for command in first.next)
    first = attrs.evolve(first, next=tuple(commands))
    leading = next((row.study for row in first.rows if row.key == "cage_slip"), "")
    lead, drawings, colours = _figures(figures, leading)
    sections = [
        section
        for section in (
            _Section("Figures", "figures", drawings, folded=False),
            _Section("Warnings", "warnings", _warnings(datasets), folded=False),
            _Section("What was found", "findings", _findings(datasets), folded=bool(first.rows)),
            _Section("Modelled and left out", "plan", _plan(datasets)),
            _Section("Models", "models", _models(datasets)),
            _Section("Input", "input", _input(datasets, with_answer=bool(first.rows))),
            _Section("Oil and contacts", "oil", _oil(datasets, with_answer=bool(first.rows))),
            _Section("Film regimes", "regimes", _regimes(datasets)),
            _Section("Numbers", "numbers", _numbers(datasets)),
            _Section("Provenance", "provenance", _provenance(datasets)),
            _Section("To be cited", "citations", _citations(datasets)),
        )
        if section.body
    ]
    titles = [title for _, title in _distinct(datasets, "title") if title]
    with whole_file(path) as partial:
        page = _CELSIUS.sub(
            " °C",
            _PAGE.substitute(
                title=escape(titles[0] if len(titles) == 1 else "Results of rollslip"),
                style=_STYLE + colours,
                verdict=_first_page(first, lead, datasets) if first.rows or first.verdict else "",
                introduction="".join(
                    _tag("p", text) for _, text in _distinct(datasets, "description") if text
                ),
                sections="".join(section.html for section in sections),
            ),
        )
        partial.write_text(page, encoding="utf-8", errors="backslashreplace")


@attrs.frozen
class _Section:
    """A section of the page; a folded one opens where a link leads into it."""

    heading: str
    key: str
    body: str
    folded: bool = attrs.field(default=True, kw_only=True)

    @property
    def html(self) -> str:
        heading = f'<h2 id="{self.key}-h">{self.heading}</h2>'
        if not self.folded:
            return f'<section id="{self.key}" aria-labelledby="{self.key}-h">{heading}{self.body}</section>\n'
        return (
            f'<section aria-labelledby="{self.key}-h"><details><summary>{heading}</summary>'
            f'<div id="{self.key}">{self.body}</div></details></section>\n'
        )


def _first_page(first: Answer, lead: str, datasets: Datasets) -> str:
    """Return the first page: the answer with its notes, the leading figure, and the most important inputs."""
    scenes = [*_per_study(datasets, "scene_resolved"), ("", {})]
    inputs = dict(_flat(scenes[0][1]))
    units = _known_keys(())
    rows = [
        [name, _value(inputs[key], units.get(key, ("",))[0])]
        for key, name in _FIRST_INPUTS.items()
        if key in inputs
    ]
    return f'{first.html()}<div class="given">{lead}{html_table(("input", "value"), rows)}</div>'


# Sections: each returns its HTML, empty if the datasets have nothing for it -------------------------------------


def _warnings(datasets: Datasets) -> str:
    """Return the most severe warnings, with all others, each once, folded below.

    Of a note with a code the first page has the law and its range.
    """
    first, more = collect_warnings(datasets.values())
    notes = collect_notes(datasets.values())
    short = {
        note.text: f"{note.code}: {note.text.partition('; ')[2]}" for note in notes if note.code
    }
    body = _list(short.get(text, text) for text in first)
    if not more:
        return body
    summary = _tag("summary", describe_more_bounds(more).partition(":")[0])
    rest = [short.get(note.text, note.text) for note in notes if note.text not in first]
    return f"{body}<details>{summary}{_list(rest)}</details>"


def _findings(datasets: Datasets) -> str:
    """Return the findings of each dataset."""
    body = ""
    for name, dataset in datasets.items():
        parts = [
            *account_of(dataset).story(dataset),
            describe_law_outputs(dataset),
            describe_measured(dataset),
        ]
        if text := "".join(_finding(part) for part in parts if part):
            body += _tag("h3", name) + text
    return body


def _finding(part: str | list[str] | Table) -> str:
    """Return a part of the findings: a table, a paragraph or a list of sentences."""
    if isinstance(part, Table):
        return html_table(part.head, part.rows, capitalise(part.caption))
    if isinstance(part, str):
        return _tag("p", capitalise(part))
    return _list(f"{capitalise(text)}." for text in part)


def _figures(figures: Mapping[str, Sequence[Path]], leading: str) -> tuple[str, str, str]:
    """Return the first figure of the leading study, all others, narrow before wide, and the style of their colours."""
    first = [*figures.get(leading, ())][:1]
    files = [*first, *(file for group in figures.values() for file in group if file not in first)]
    named = [(file.stem, file.read_text(encoding="utf-8")) for file in files]
    named[len(first) :] = sorted(named[len(first) :], key=lambda item: _width(item[1]) > _WIDE)
    colours = adapting([svg for _, svg in named])
    parts = [_figure(svg, number, name) for number, (name, svg) in enumerate(named, 1)]
    others = "".join(parts[len(first) :])
    if others:
        others = f'<div class="figures">{others}</div>'
    return "".join(parts[: len(first)]), others, colours if named else ""


def _width(svg: str) -> float:
    """Return the printed width of a drawing [pt]; infinite where it has none."""
    size = re.search(r'<svg[^>]* width="([\d.]+)pt"', svg)
    return float(size[1]) if size else math.inf


def _figure(svg: str, number: int, name: str) -> str:
    """Return an SVG as a figure of the page: its metadata become caption and label, its ids unique."""

    def metadata(element: str, default: str) -> str:
        found = re.search(rf"<dc:{element}>(.*?)</dc:{element}>", svg, re.DOTALL)
        return escape(unescape(found[1]) if found else default)

    caption = metadata("title", name)
    findings = metadata("description", "")
    root, _, drawing = svg[svg.index("<svg") :].partition(">")
    drawing = re.sub(r"<metadata>.*?</metadata>|<title>.*?</title>", "", drawing, flags=re.DOTALL)
    drawing = re.sub(r'(\sid="|href="#|url\(#)', rf"\g<1>figure{number}-", drawing)
    width = _width(svg)
    kind = (
        f' class="wide-one" style="{_MIN_WIDTH}: {_READABLE * width:.0f}px"'
        if _WIDE < width < math.inf
        else ""
    )
    root = re.sub(r' (?:width|height)="[^"]*"', "", root)
    return (
        f'<figure{kind}><div class="sheet">{root} role="img" aria-label="{caption} {findings}">{drawing}</div>'
        f"<figcaption>Figure {number}. {caption}</figcaption></figure>\n"
    )


def _plan(datasets: Datasets) -> str:
    """Return the lines of the plan, and errors.

    Lines of several studies are shown once. Models are in a section of their own, and ``rollslip plan -v`` prints all
    of the reasons.
    """
    kinds = {model["kind"] for _, models in _per_study(datasets, "models") for model in models}
    body = ""
    for caption, included, last in (
        ("Modelled", True, "resolution"),
        ("Left out", False, "reason"),
    ):
        rows = dict[tuple[str, str], dict[str, list[str]]]()
        for name, dataset in datasets.items():
            for part in json.loads(dataset.attrs.get("plan", "[]")):
                key = part["part"], part["choice"]
                text = part[last] if included else part[last].partition("; ")[0]
                if part["included"] is included and part["part"] not in kinds and (key[1] or text):
                    rows.setdefault(key, {}).setdefault(text, []).append(name)
        table = [
            [
                *key,
                [
                    text if len(names) == len(datasets) else f"{text} ({', '.join(names)})"
                    for text, names in texts.items()
                ],
            ]
            for key, texts in rows.items()
        ]
        heads = ("part", "choice", {"reason": "why"}.get(last, last))
        body += html_table(heads, table, caption)
    return body + _accuracy(datasets)


def _accuracy(datasets: Datasets) -> str:
    """Return the errors against their tolerances."""
    errors = list[list[str]]()
    different = _distinct(datasets, "accuracy")
    for names, rows in different:
        if len(different) > 1:
            errors.append([", ".join(names), "", "", ""])
        for row in json.loads(rows):
            known = (
                "" if row[key] is None else f"{row[key]:.1e}" for key in ("estimated", "found")
            )
            errors.append([row["result"].replace("_", " "), f"{row['tolerance']:g}", *known])
    return html_table(("error", "tolerance", "estimated before", "found"), errors)


def _models(datasets: Datasets) -> str:
    """Return the models that were used."""
    return "".join(
        heading
        + html_table(
            ("kind", "model", "with parameters"),
            [
                [
                    m["kind"],
                    [m["name"], *_third_party(m)],
                    m["parameters"] if not m["parameters"].endswith("()") else "",
                ]
                for m in models
            ],
        )
        for heading, models in _per_study(datasets, "models")
    )


def _third_party(model: Mapping[str, str]) -> list[str]:
    """Return package and version of a model, which are those of rollslip for its own."""
    return [f"{model['package']} {model['version']}"] * (model["package"] != "rollslip")


def _input(datasets: Datasets, *, with_answer: bool) -> str:
    """Return the keys of the resolved scene that differ from their defaults, and the scene as files.

    The models are in a section of their own. Some keys stand on the first page, if there is one with an answer,
    where other parts have the temperature of the oil unless they are listed.
    """
    body = ""
    for heading, scene in _per_study(datasets, "scene_resolved"):
        known = _known_keys(scene.get("study", {}))
        operation = scene.get("operation", {})
        of_oil = [
            (f"operation.{part}_temperature", operation.get("temperature")) for part in _PARTS
        ]
        rows = [
            [key, text]
            for key, value in _flat(
                {k: v for k, v in scene.items() if k not in ("title", "description", "models")}
            )
            for unit, default in [known.get(key, ("", ""))]
            if (text := _value(value, unit)) != default
            and not (with_answer and (key in _FIRST_INPUTS or (key, value) in of_oil))
        ]
        body += heading + html_table(("key", "value"), rows)
        body += _download("all keys with their values", "scene.json", json.dumps(scene, indent=1))
    for heading, text in _per_study(datasets, "scene", str):
        if text:
            body += heading + _download("the scene as it was written", "scene.toml", text)
    return body


def _known_keys(studies: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Return unit and default of the keys of a scene, those of oil and studies included."""
    rows = [*schema(), *rows_of(OilTable, "lubricant.")]
    for name in studies:
        # keys of a study whose package is missing or broken are not known
        with contextlib.suppress(PluginError):
            rows += rows_of(get_class("study", name), f"study.{name}.")
    return {row.key: (row.unit, row.default) for row in rows}


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield full keys and values of a table; tables in a list are numbered from 1, empty lists are left out."""
    for key, value in table.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            value = {str(number): inner for number, inner in enumerate(value, 1)}
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        elif value != []:
            yield prefix + key, value


def _oil(datasets: Datasets, *, with_answer: bool) -> str:
    """Return oil, named data, clearance, and a file with the conditions of the contacts.

    The clearance stands on the first page, if there is one with an answer.
    """
    body = ""
    for heading, oil in _per_study(datasets, "lubricant"):
        body += heading + _tag("p", f"Oil {oil['name']}. {_first_sentence(oil['source'] or '')}")
        grades = oil.get("grades")  # older results do not have it
        if grades:
            each = ", ".join(f"{key.replace('_', ' ')} ({grade})" for key, grade in grades.items())
            body += _tag("p", f"Data quality, A printed to D estimated: {each}.")
    for heading, items in _per_study(datasets, "data"):
        for item in items:
            grades = ", ".join(sorted(set(item.get("grades", {}).values())))
            name = f"{item['kind'].capitalize()} {item['name']}" + (
                f" ({grades})" if grades else ""
            )
            body += heading + _tag("p", f"{name}. {_first_sentence(item['source'])}")
    for heading, clearance in [] if with_answer else _per_study(datasets, "clearance"):
        body += heading + _tag("p", f"Clearance in operation: {clearance['text']}.")
    for heading, rings in _per_study(datasets, "conditions"):
        lines = [", ".join(("quantity", *(f"{ring} ring" for ring in rings)))]
        for key, (unit, meaning) in CONDITIONS.items():
            values = [_value(conditions.get(key), unit) for conditions in rings.values()]
            lines.append(", ".join((meaning, *values)))
        body += heading + _download(
            "steel and oil in the contacts", "contacts.txt", "\n".join(lines)
        )
    return body


def _regimes(datasets: Datasets) -> str:
    """Return film regimes, film parameters and load parameters of the contacts."""
    rows = []
    for name, dataset in datasets.items():
        if "load_parameter" not in dataset:
            continue
        for position, contact in enumerate(account_of(dataset).contacts(dataset)):
            largest = float(dataset["load_parameter"][position])
            light = "the contact" if largest < LIGHT else "no"
            if "light_fraction" in dataset:
                fraction = float(dataset["light_fraction"][position])
                light = f"{percent(fraction)} of the force" if fraction > 0.0 else "none"
            regime = contact.regime or ", ".join(
                f"{LONG_NAMES[str(kind)]} {percent(fraction)}"
                for kind, fraction in zip(
                    dataset["regime"].values,
                    dataset["regime_fraction"].values[position],
                    strict=True,
                )
                if fraction > 0.0
            )
            rows.append(
                [
                    f"{name}, {contact.name}",
                    regime,
                    _value(contact.film_parameter, "1", digits=3),
                    f"{largest:.3g}",
                    light,
                ]
            )
    if not rows:
        return ""
    head = ("contact", "film regime", "smallest film parameter Λ", "largest M", f"at M < {LIGHT:g}")
    return html_table(head, rows)


def _numbers(datasets: Datasets) -> str:
    """Return the numbers of single studies, then those of any study."""
    numbers = {name: account_of(dataset).numbers for name, dataset in datasets.items()}
    own = dict.fromkeys(item for each in numbers.values() for item in each.items())
    rows = [
        [
            label,
            *(
                _value(dataset.attrs[key], unit, digits=3)
                if key in dataset.attrs and (key in _NUMBERS or key in numbers[name])
                else ""
                for name, dataset in datasets.items()
            ),
        ]
        for key, (label, unit) in (*own, *_NUMBERS.items())
        if any(key in dataset.attrs for dataset in datasets.values())
    ]
    return html_table(("", *datasets), rows)


def _provenance(datasets: Datasets) -> str:
    """Return scene, hash, time of creation and packages."""
    rows = [
        [
            label,
            [
                f"{value} ({', '.join(names)})" if len(found) > 1 else str(value)
                for names, value in found
            ],
        ]
        for key, label in (
            ("source", "scene"),
            ("scene_hash", "SHA-256 of the scene"),
            ("created", "created"),
        )
        if (found := _distinct(datasets, key))
    ]
    body = html_table(("", "value"), rows)
    for heading, packages in _per_study(datasets, "packages"):
        body += heading + _tag(
            "p", ", ".join(f"{name} {version}" for name, version in packages.items())
        )
    return body


def _citations(datasets: Datasets) -> str:
    """Return what is to be cited: the first works in full with a link, and files with all works."""
    works = citations_of(*datasets.values())
    if not works:
        return ""
    first = "".join(f"<li>{_full_citation(work)}</li>" for work in works[:_FULL_CITATIONS])
    return (
        f"<ul>{first}</ul>"
        + _download(f"all {len(works)} works", "references.txt", "\n".join(map(str, works)))
        + (_download("as BibTeX", "references.bib", as_bibtex(works)))
    )


def _full_citation(work: Citation) -> str:
    """Return a work in full, as a link where it has a DOI."""
    text = escape(str(work))
    if isinstance(work, str) or not work.doi:
        return text
    return f'<a href="{escape(work.link)}">{text}</a>'


# Shared by sections --------------------------------------------------------------------------------------------------


def _distinct(datasets: Datasets, attribute: str) -> list[tuple[list[str], Any]]:
    """Return the different values of an attribute, each with the names of its datasets."""
    names_of: dict[Any, list[str]] = {}
    for name, dataset in datasets.items():
        if attribute in dataset.attrs:
            names_of.setdefault(dataset.attrs[attribute], []).append(name)
    return [(names, value) for value, names in names_of.items()]


def _per_study(
    datasets: Datasets, attribute: str, read: Callable[[str], Any] = json.loads
) -> list[tuple[str, Any]]:
    """Return the different values of an attribute, with headings that name their datasets; without for one value."""
    values = _distinct(datasets, attribute)
    return [
        (_tag("h3", ", ".join(names)) if len(values) > 1 else "", read(value))
        for names, value in values
    ]


def _value(value: object, unit: str, digits: int = 6) -> str:
    """Return a value as text: numbers with their unit, lists item by item, texts as they are."""
    if isinstance(value, list):
        return ", ".join(_value(item, unit, digits) for item in value)
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Integral) and not unit:
        return f"{int(value):,}"
    if not isinstance(value, Real):
        return str(value)
    return with_unit(float(value), unit or "1", digits)


def _first_sentence(text: str) -> str:
    """Return the first sentence of the source of data; ``rollslip models`` prints all of it."""
    return re.split(r"(?<=[.;])\s", text, maxsplit=1)[0]


def _download(label: str, name: str, text: str) -> str:
    """Return a paragraph with a link that saves a text as a file; the text is part of the page."""
    content = base64.b64encode(text.encode()).decode()
    link = f"data:text/plain;charset=utf-8;base64,{content}"
    return f'<p><a download="{name}" href="{link}">{escape(label)}</a></p>'


def _tag(name: str, text: object) -> str:
    """Return an element of HTML with a text, which is escaped."""
    return f"<{name}>{escape(str(text))}</{name}>"


def _list(texts: Iterable[object]) -> str:
    """Return texts as a list of HTML; empty without texts."""
    items = "".join(_tag("li", text) for text in texts)
    return f"<ul>{items}</ul>" if items else ""


_STYLE: Final = (
    (
        """
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #fff; --quiet: #59636e; --rule: #d1d9e0; --tint: #f4f6f8;
  --alarm: #b45309; --alarm-tint: #fff7e6; --link: #0b5cad; }
@media (prefers-color-scheme: dark) { :root { --ink: INK; --paper: GROUND; --quiet: #9aa4af; --rule: #3a424b;
  --tint: #1e2329; --alarm: #f0b849; --alarm-tint: #2c2413; --link: #7ab7ff; } }
@media print { :root { color-scheme: light; --ink: #000; --paper: #fff; --quiet: #444; --rule: #bbb; --tint: #fff;
  --alarm: #8a4000; --alarm-tint: #fff; --link: #000; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 70rem; color: var(--ink); background: var(--paper);
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif; overflow-wrap: anywhere; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .75rem; }
h2 { font-size: 1.25rem; margin: 2.5rem 0 .75rem; padding-bottom: .25rem; border-bottom: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 1.25rem 0 .25rem; }
p, ul { margin: .5rem 0; max-width: 46rem; }
li { margin: .25rem 0; }
a { color: var(--link); }
.answer p:first-child { font-size: 1.15rem; font-weight: 600; } .answer td:nth-child(2) { white-space: nowrap; }
.answer strong { padding: .1em .5em; color: #000; background: #f0b849; }
.answer.ok strong { background: #7bc47f; } .answer.skids strong { color: #fff; background: #b42318; }
.answer.unknown strong { color: #fff; background: #86198f; } .answer .marked td { font-weight: 600; }
.given { display: grid; grid-template-columns: minmax(0, 30rem) minmax(0, 1fr); gap: 0 2.5rem; margin-top: 1rem; }
#warnings { margin-top: 2rem; padding: .75rem 1.25rem; border-left: .4rem solid var(--alarm);
  background: var(--alarm-tint); }
#warnings h2 { margin: 0; border: 0; color: var(--alarm); }
#warnings ul { padding-left: 1.25rem; }
.figures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 2rem 2.5rem; align-items: start; }
figure { margin: 0; break-inside: avoid; }
figure.wide-one { grid-column: 1 / -1; }
figure:not(.wide-one) { max-width: 32rem; }
.sheet { overflow-x: auto; }
figure svg { display: block; width: 100%; height: auto; }
figcaption { margin-top: .5rem; color: var(--quiet); max-width: 46rem; }
details > summary { cursor: pointer; }
summary:has(h2) { list-style: none; }
summary:has(h2)::-webkit-details-marker { display: none; }
summary h2 { margin: .75rem 0 0; padding: .4rem 0; }
summary h2::before { content: "▸"; display: inline-block; width: 1.25rem; color: var(--link); }
[open] > summary h2::before { content: "▾"; }
summary:not(:has(h2)) { color: var(--link); }
[id] { scroll-margin-top: 4rem; }
.wide { overflow-x: auto; margin: .75rem 0; }
table { border-collapse: collapse; width: 100%; font-size: .875rem; line-height: 1.4; }
caption { text-align: left; font-weight: 600; padding: .25rem 0; }
th, td { text-align: left; vertical-align: top; padding: .3rem .75rem .3rem 0; border-bottom: 1px solid var(--rule);
  overflow-wrap: break-word; min-width: 5rem; }
thead th { color: var(--quiet); font-weight: 600; }
tbody th { font-weight: 400; min-width: 8rem; }
tr { break-inside: avoid; }
pre { overflow-x: auto; padding: 1rem; background: var(--tint); font-size: .8rem; line-height: 1.4;
  overflow-wrap: normal; }
@media screen and (max-width: 46rem) {
  body { padding: 1.25rem 1rem 3rem; }
  .figures, .given { grid-template-columns: minmax(0, 1fr); }
  .wide-one svg { width: var(--min-width); max-width: none; }
  .wide-one .sheet::before { content: "scroll sideways \\2192"; position: sticky; left: 0; color: var(--quiet); }
  table, caption, tbody, tr, tbody th, td { display: block; min-width: 0; overflow-wrap: anywhere; }
  thead { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
  tr { padding: .5rem 0; border-bottom: 1px solid var(--rule); }
  tbody th, td { padding: .1rem 0; border: 0; }
  tbody th { font-weight: 600; }
  td:empty { display: none; }
  td[data-of]:not([data-of=""])::before { content: attr(data-of) ": "; color: var(--quiet); }
}
@page { size: A4; margin: 12mm 15mm; }
@media print { body { padding: 0; max-width: none; font-size: 10pt; line-height: 1.35; }
  .first:has(.answer) { break-after: page; } section:has(> details:not([open])) { display: none; }
  .given { grid-template-columns: 92mm minmax(0, 1fr); gap: 0 8mm; }
  .first td, .first th { padding: .7mm 2mm .7mm 0; } .first figcaption { font-size: 8pt; }
  h1 { font-size: 15pt; margin: 0 0 2mm; } h2 { margin: 3mm 0; }
  .answer p { font-size: 9pt; margin: 1.5mm 0; } .answer p:first-child { font-size: 11pt; margin: 1.5mm 0; }
  summary:not(:has(h2)) { display: none; } summary h2::before { display: none; }
  .wide, .sheet { overflow: visible; } td { overflow-wrap: anywhere; } pre { white-space: pre-wrap; }
  h2, h3, caption { break-after: avoid; }
  .figures { display: block; } figure { margin: 4mm 0; } .wide-one svg { max-height: 54mm; width: auto; }
  td, th { font-size: 8pt; } figure:not(.wide-one) { display: inline-block; width: 49%;
  vertical-align: top; padding-right: 4mm; } .first figure:not(.wide-one) { width: 100%; } }
"""
    )
    .replace("INK", INK)
    .replace("GROUND", GROUND)
)

_PAGE: Final = Template(
    """<!DOCTYPE html>
<html lang="en" xmlns="http://www.w3.org/1999/xhtml">
<head>
<meta charset="utf-8"/>
<meta name="generator" content="rollslip"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'"/>
<title>$title</title>
<style>$style</style>
</head>
<body>
<header>
<div class="first">
<h1>$title</h1>
$verdict
</div>
$introduction
</header>
<main>
$sections</main>
</body>
</html>
"""
)


def is_report(path: Path) -> bool:
    """Whether a file is a report of rollslip, which another report may replace."""
    try:
        with path.open("rb") as file:
            return b'<meta name="generator" content="rollslip"' in file.read(1000)
    except OSError:
        return False
