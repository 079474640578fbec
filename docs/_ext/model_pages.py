"""A page for each model: what it is, its validity, its errors, what it was held against, and what it costs.

Pages are written into ``docs/reference/model/`` before Sphinx reads, and only where they have changed. What a model is
comes from the registry, its errors from the tables of ``docs/tables/``; the values beside measured ones are computed at
each build, by `rollslip_campaigns.validation` without samples: about 14 s of the processor for all.
"""

import csv

import facts
import numpy as np

from rollslip.catalogue.kinds import offered_kinds
from rollslip.catalogue.registry import available, get_class, get_model
from rollslip_campaigns.comparison.choices import KINDS
from rollslip_campaigns.validation import ValidationSettings, findings
from rollslip_campaigns.validation.validate import AS_STATED, run_validation

FOLDER = facts.ROOT / "docs" / "reference" / "model"
#: Table of docs/tables -> its column of models, what its numbers are, and the page that says how they were found.
ERRORS = {
    "film_error_ranges": (
        "formula",
        "Extremes of the error of the film thickness in percent, against a solved line contact, over all of the map of "
        "load and lubricant parameter and over parts of it",
        "../../trust/film_reference",
    ),
    "exact_law": (
        "law",
        "Worst error against the full law, and time of a slice",
        "../../theory/traction",
    ),
    "benchmark_laws": (
        "law",
        "Worst relative error of the compiled law against 50 digits and ns per slice, on three instruction sets; where "
        "it was found",
        "../../theory/kernels",
    ),
    "work_precision": ("integrator", "Error and work of a run", "../../trust/dynamics"),
}
#: Models that solve each contact numerically: a critical slip takes them minutes, so they are held against films alone.
SOLVED = ("maxwell-eyring-field", "reynolds-line")
#: Data sets that take seconds with each model, and are left to the command.
LONG = ("published-slip", "wingertszahn-2023")
#: Quantities that no model of `KINDS` changes: those of an oil, and of a drag on a contact.
UNCHANGED = {"pressure-viscosity", "contact-resistance"}


def page(kind, name):
    """The page of a model, as lines."""
    title = f"{kind} {name}"
    lines = [title, "=" * len(title), "", *facts.model(kind, name)]
    if cited := get_class(kind, name).references:
        lines += ["References:", "", *(f"- {facts.citation(one)}" for one in cited), ""]
    lines += ["Errors against references", "-" * 25, "", *errors(name)]
    return [*lines, "What it was checked against", "-" * 27, "", *held(kind, name)]


def errors(name):
    """Every row that a table of errors has of a model; the head of a column and its cell stand side by side."""
    lines = []
    for stem, (column, says, leads) in ERRORS.items():
        with (facts.ROOT / "docs" / "tables" / f"{stem}.csv").open(
            newline="", encoding="utf-8"
        ) as file:
            rows = [
                row
                for row in csv.DictReader(file)
                if row[column].partition(",")[0].partition(" ")[0] == name
            ]
        if rows:
            head = [key.replace("_", " ") for key in rows[0]]
            lines += [f"{facts.literal_markup(says)} (:doc:`{leads}`):", ""]
            lines += facts.table(head, [list(row.values()) for row in rows])
    return lines or ["No table of the documentation has errors of this model.", ""]


def held(kind, name):
    """What the models of each data set give with this one in its place, beside what was measured."""
    if kind not in KINDS:
        return [f"Only {', '.join(KINDS)} models are put in the place of those of a data set.", ""]
    sets = [one for one in available("measurement") if not get_model("measurement", one).is_form]
    sets = [one for one in sets if kind == "film" or not _of_films(one)]
    sets = [one for one in sets if not _is_unchanged(one)]
    left = [one for one in sets if one in LONG or (name in SOLVED and not _of_films(one))]
    command = [f"    rollslip validate {one} --{kind} {name}" for one in left]
    further = (
        ["Left to the command, since they take longer:", "", "::", "", *command, ""] if left else []
    )
    if not (sets := [one for one in sets if one not in left]):
        return further
    made = run_validation(ValidationSettings(sets, samples=0, **{kind: name}).plan())
    lines = [
        "Calculated with the models of the data set's scene, this one in its place, at this build. Only the measured "
        "values have a band here.",
        "",
    ]
    tables = [(caption, findings.ROWS, rows) for caption, rows in findings.row_tables(made)]
    tables += [
        (caption, findings.STATEMENTS, rows) for caption, rows in findings.statement_tables(made)
    ]
    for caption, head, cells in tables:
        of = head.index("models")
        own = [
            [cell for k, cell in enumerate(row) if k != of]
            for row in cells
            if row[of] != AS_STATED.label
        ]
        lines += [f".. rubric:: {facts.literal_markup(caption)}", ""]
        lines += facts.table([cell for k, cell in enumerate(head) if k != of], own)
    return [*lines, *further, *cost(made)]


def cost(made):
    """The time of a value of each quantity, beside that of the data set's own models."""
    own = made["row_models"].to_numpy() == AS_STATED.label
    rows = []
    for (quantity,) in findings.unique_texts(made, "quantity"):
        of = made["row_quantity"].to_numpy() == quantity
        every = [made["seconds"].to_numpy()[of & which] for which in (~own, own)]
        known = [times[np.isfinite(times)] for times in every]
        rows.append(
            (
                quantity,
                *(f"{1e3 * np.median(times):.2g}" if times.size else "none" for times in known),
            )
        )
    lines = [
        "Cost",
        "-" * 4,
        "",
        "Time of a value where these pages were built, in the median:",
        "",
    ]
    return [
        *lines,
        *facts.table(("quantity", "with it, ms", "with the data set's own models, ms"), rows),
    ]


def _of_films(name):
    """Whether a data set has films of single contacts alone, which nothing but the film model changes."""
    one = get_model("measurement", name)
    return not one.statements and all(series.quantity == "film-thickness" for series in one.series)


def _is_unchanged(name):
    """Whether a data set has nothing that a contact, film or traction model changes."""
    one = get_model("measurement", name)
    return not one.statements and all(series.quantity in UNCHANGED for series in one.series)


def write(app):
    """Write the pages that have changed, and remove those of models that are gone."""
    FOLDER.mkdir(exist_ok=True)
    kept = set()
    for kind in offered_kinds():
        for name in available(kind):
            if isinstance(get_class(kind, name), type):
                path = FOLDER / f"{kind}-{name}.rst"
                text = "\n".join(page(kind, name))
                kept.add(path)
                if not path.is_file() or path.read_text(encoding="utf-8") != text:
                    path.write_text(text, encoding="utf-8")
    for path in set(FOLDER.glob("*.rst")) - kept:
        path.unlink()


def setup(app):
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
