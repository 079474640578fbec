"""The answer to a user's question, as one value for terminal, report, notebook and JSON: verdict, rows and notes.

1. The account of each study gives rows, one for each quantity. Where several studies compute a quantity, the one with
   the highest rank is shown; two values that differ by more than their tolerances are a fault (`merge_answers`).
2. The verdict is the worst of those of the `RULES` which hold (`with_verdict`). Rules compare facts, as intervals:
   a reserve that is known to be 2 at least is from 2 to infinity, and a slip is as wide as its accuracy.
3. A cage that may skid, where data scatter or by a choice that nobody made, has the verdict UNKNOWN, which is worse
   than SLIPS and better than SKIDS.
4. Rows and assumptions that are not shown are counted.
5. Texts have two digits, percent, rpm, °C and kN, no exponents; values and bands are SI and not rounded.
"""

import json
import math
import shutil
import textwrap
from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from html import escape
from itertools import chain
from operator import delitem
from typing import Any, Final

import attrs

from rollslip.results.curves import or_none
from rollslip.results.dataset import xr
from rollslip.results.text import (
    align_columns,
    format_plain,
    html_table,
    in_brackets,
    message_rank,
    percent,
    python_call,
    two_digits,
    worst_messages,
)
from rollslip.results.verdict import Fact, Interval, Verdict, decide

__all__ = [
    "ACCEPTABLE",
    "COLOURS",
    "MAX_LINES",
    "MAX_ROWS",
    "NEGLIGIBLE_SLIP",
    "Answer",
    "Note",
    "Row",
    "collect_notes",
    "merge_answers",
    "summarise_notes",
    "with_verdict",
]


#: Colours of the letters and of the ground of each verdict, with the same contrast on dark and light terminals.
COLOURS: Final = {
    Verdict.OK: ("black", "green"),
    Verdict.SLIPS: ("black", "yellow"),
    Verdict.SKIDS: ("white", "red"),
    Verdict.UNKNOWN: ("white", "magenta"),
}
#: Cage slip that is acceptable where no result states another. Chosen, since no source states one: with a larger one
#: minimum loads are lower, and the rules V6 and V7 hold later.
ACCEPTABLE: Final = 0.05
#: Slip [-] below which neither an assumption nor a law outside its range matters. Chosen: a tenth of `ACCEPTABLE`.
NEGLIGIBLE_SLIP: Final = 0.005
#: Assumptions that are shown, at most; more do not fit into an answer.
_MAX_ASSUMPTIONS: Final = 3
#: Relative change of a result that counts as none. Chosen: it does not change the two digits that are shown.
_NO_CHANGE: Final = 0.01
#: Relative change of a result from which a note is shown on its own. Chosen.
_LARGE_CHANGE: Final = 0.1
#: Notes that are shown on their own, at most; the others are counted, so that an answer keeps its length.
_MAX_SHOWN_NOTES: Final = 2
#: Relative changes below which notes are counted: the smallest that holds for all is shown. Without others shown on
#: their own all changes are below `_LARGE_CHANGE`, so that one of them holds.
_CHANGE_LIMITS: Final = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0)
#: Difference of two cage slips [-] that is no disagreement of two studies, whatever they are relative to each other.
_SLIP_RESOLUTION: Final = 1e-3
#: Lines of an answer at most, so that it fits on a terminal with the command above it.
MAX_LINES: Final = 15
#: Rows of an answer at most; with more the lines below them would not fit.
MAX_ROWS: Final = 8
#: Head and rows of a table that stay where an answer is shortened. Chosen: fewer do not show how a result changes.
_MIN_TABLE: Final = 5
#: Letters of the note of a row at least, where lines are narrow. Chosen: one short word.
_MIN_NOTE: Final = 4
#: Width of lines where there is no terminal.
_WIDTH: Final = 100
#: Smallest width for which lines are wrapped.
_MIN_WIDTH: Final = 40
#: Letters of the longest heading below the rows.
_HEADING: Final = len("assumed")
#: Option that shows notes in full -> what shows all assumptions.
_ALL: Final = {"-v": "--all", ".notes": ".lines(whole=True)"}
#: Largest relative error of a slip that rules take into account: 10 %, also for studies that are less accurate, so that
#: their slips lead to a verdict. Chosen.
_MAX_ACCURACY: Final = 0.1

#: Quantity -> its value in the answer, and by another law.
_Changes = Mapping[str, tuple[float, float]]


@attrs.frozen(kw_only=True)
class Row:
    """One quantity of an answer."""

    key: str  #: Name that is the same in all results: "cage_slip".
    label: str  #: Name in texts.
    value: float = math.nan  #: SI value, NaN where there is none.
    unit: str = "1"  #: SI unit.
    text: str  #: The value as text.
    #: Quantiles of 5 and 95 %, or bounds; infinite where there is no bound.
    band: tuple[float, float] | None = None
    note: str = ""  #: Remark beside the value.
    rank: int = 0  #: How well the study knows the quantity: of several the one with the highest rank is shown.
    tolerance: float = (
        0.1  #: Relative difference from another study's value up to which both agree.
    )
    is_alarm: bool = False  #: Whether a limit is exceeded, so that the row is always shown.
    study: str = ""  #: The study that computed it.
    parts: tuple["Row", ...] = ()  #: Rows in its place in tables, where it combines quantities.


@attrs.frozen(kw_only=True)
class Note:
    """A law outside its range of validity, and what another law changes in the answer."""

    code: str  #: Code by which ``rollslip explain`` finds it.
    short: str  #: What is outside, in a few words.
    text: str  #: The whole sentence.
    severity: float  #: Relative error, see `rollslip.studies.validity.RangeExcess.severity`.
    alternative: str = ""  #: The law that was evaluated in its place.
    #: Quantity -> its value in the answer, and by the alternative; None where that was not evaluated, empty where the
    #: range is exceeded, but not at the operation of the answer.
    changes: _Changes | None = None
    where: str = ""  #: At which points of a campaign: "at all points".

    @property
    def largest_change(self) -> tuple[str, float]:
        """The quantity that changes most, and its relative change; infinite where the alternative has none.

        Negligible slips and quantities that are 0 do not count, and a large change of the slip comes before those of
        other quantities.
        """
        changes = {
            name: _relative_change(before, after)
            for name, (before, after) in (self.changes or {}).items()
            if (max(abs(before), abs(after)) >= NEGLIGIBLE_SLIP if name == "slip" else before > 0.0)
        }
        name = max(changes, key=changes.__getitem__, default="")
        if changes.get("slip", 0.0) > _LARGE_CHANGE:
            name = "slip"
        return name, changes.get(name, 0.0)

    @property
    def summary(self) -> str:
        """What the alternative makes of the quantity that changes most: "W11: slip 5.8 % with maxwell-eyring-local"."""
        name, _ = self.largest_change
        _, after = (self.changes or {})[name]
        return f"{self.code}: {_quantity_text(name, after)} with {self.alternative}"

    @property
    def consequence(self) -> str:
        """The changes by the alternative, in words, to be shown behind the sentence."""
        if self.changes is None:
            return "no other law was compared"
        if not self.changes:
            return "not at the steady slip"
        texts = [
            f"{_quantity_text(name, after)} in place of "
            + _quantity_text(name, before).removeprefix(f"{name} ")
            for name, (before, after) in self.changes.items()
            if _relative_change(before, after) >= _NO_CHANGE
        ]
        changes = ", ".join(texts) or "slip, reserve and torque move by less than 1 %"
        return f"with {self.alternative} {changes}"

    def as_dict(self) -> dict[str, Any]:
        """Return the note as plain values, for JSON, with changes in SI units."""
        changes = None
        if self.changes is not None:
            changes = {name: [*map(or_none, values)] for name, values in self.changes.items()}
        return attrs.asdict(self) | {"changes": changes}


def _relative_change(before: float, after: float) -> float:
    """Return the relative change of a value; infinite from 0, and where there is none after it."""
    if before == after:
        return 0.0
    return abs(after / before - 1.0) if math.isfinite(after) and before else math.inf


def _quantity_text(name: str, value: float) -> str:
    """Return name and value of a quantity that a law changes."""
    if name == "slip":
        return f"slip {percent(value)}" if math.isfinite(value) else "it skids"
    unit = " N m" if name == "friction torque" else ""
    return f"{name} {two_digits(value) if value > 0.0 else 'none'}{unit}"


@attrs.frozen(kw_only=True)
class Answer:
    """The answer to a user's question: verdict, rows of quantities, assumptions, notes, and the next commands.

    An account gives rows, the acceptable slip, assumptions and commands. Where the question is not one of slip, it
    gives a summary, and for many points a table. `merge_answers` makes one answer of several, with verdict and next
    commands.
    """

    #: The number that was asked for, in a few words: "minimum load 0.83 kN for 5 % slip".
    summary: str = ""
    rows: tuple[Row, ...] = ()
    table: tuple[tuple[str, ...], ...] = ()  #: Head and rows of a table of points or alternatives.
    omitted: int = 0  #: Number of rows that the whole table has besides those.
    acceptable: float = 0.0  #: Acceptable cage slip; 0 for the default.
    #: Assumptions that change the slip, the largest changes first, and others that a reader has to know.
    assumed: tuple[str, ...] = ()
    minor: tuple[str, ...] = ()  #: Assumptions that hardly change the slip.
    facts: Mapping[Fact, float] = attrs.field(factory=dict)  #: Facts that rows do not have.
    #: Verdict -> commands that help, with ``{scene}`` for the scene.
    commands: Mapping[str, tuple[str, ...]] = attrs.field(factory=dict)
    #: Commands for the verdict, and those that help whatever it is; FOLDER is that of the results.
    next: tuple[str, ...] = ()
    case: tuple[str, ...] = ()  #: Bearing, oil, speeds, load and temperature.
    notes: tuple[Note, ...] = ()
    faults: tuple[str, ...] = ()  #: Quantities on which studies disagree, and what is unusual.
    verdict: str = ""
    rule: str = ""  #: Code of the rule that decided.
    marked_row: str = ""  #: Key of the row that decided, if the verdict is not OK.

    def __getitem__(self, key: str) -> Row:
        """Return a row by its key."""
        rows = {row.key: row for row in self.rows}
        if key not in rows:
            raise KeyError(f"{key}; there are {', '.join(rows)}")
        return rows[key]

    def visible_rows(self, *, whole: bool = False) -> list[Row]:
        """Return the rows that are shown, `MAX_ROWS` at most: those with an alarm, and the first others."""
        if whole:
            return list(self.rows)
        visible = sorted(self.rows, key=lambda row: not row.is_alarm)[:MAX_ROWS]
        return sorted(visible, key=self.rows.index)

    def groups(self, more: str = "", *, whole: bool = False) -> list[tuple[str, list[str]]]:
        """Return the texts below the rows, by heading.

        Parameters
        ----------
        more : str
            Option that shows notes in full.
        whole : bool
            Whether all assumptions are shown, those that hardly change the slip too.
        """
        summary = summarise_notes(self.notes, more)
        assumed = [*self.assumed, *self.minor] if whole else [*self.assumed[:_MAX_ASSUMPTIONS]]
        return [
            ("assumed", assumed),
            ("notes", list(filter(None, (*self.faults, summary)))),
            ("next", list(self.next)),
        ]

    def lines(
        self, width: int = 0, more: str = "-v", *, max_lines: int = MAX_LINES, whole: bool = False
    ) -> list[str]:
        """Return the lines for a terminal; what matters least is left out, and counted.

        Commands are not wrapped, so that they can be pasted as one line.

        Parameters
        ----------
        width : int
            Width of lines; 0 for that of the terminal.
        more : str
            Option that shows notes in full.
        max_lines : int
            Number of lines at most.
        whole : bool
            Whether all rows and assumptions are shown, whatever the number of lines.
        """
        width = max(width or shutil.get_terminal_size((_WIDTH, 24)).columns, _MIN_WIDTH)
        case = ", ".join(self.case)
        first = "   ".join(filter(None, (self.verdict, self.summary or case)))
        head = textwrap.wrap(first, width, break_on_hyphens=False)
        if self.summary:
            head += textwrap.wrap(case, width, break_on_hyphens=False)
        rows = [(row.label, row.text, row.note) for row in self.visible_rows(whole=whole)]
        table = list(self.table if whole else self.table[: MAX_ROWS + 1])
        groups = self.groups(more, whole=whole)
        for shorten in (None, *_shortening_steps(rows, table, groups, width, f" ({more})")):
            if shorten is not None:
                shorten()
            below = list[str]()
            for name, texts in groups:
                shown = texts
                if name == "assumed":
                    hidden = len(self.rows) - len(rows)
                    hidden += len(self.assumed) + len(self.minor) - len(texts)
                    shown = _with_count(texts, hidden, _ALL.get(more, more), width)
                below += align_columns(_headed(name, shown), math.inf if name == "next" else width)
            omitted = self.omitted + len(self.table) - len(table)
            points = align_columns(table, width) + [f"  {omitted} more: --all"] * bool(omitted)
            parts = [part for part in (head, align_columns(rows, width), points, below) if part]
            lines = "\n\n".join("\n".join(part) for part in parts).split("\n")
            if whole or len(lines) <= max_lines:
                break
        return lines

    @property
    def needs_verdict(self) -> bool:
        """Whether the question is one of slip, so that the answer gets a verdict."""
        return bool(self.commands) or any(row.key == "cage_slip" for row in self.rows)

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as plain values, for JSON: SI value, unit, band and text of each row."""
        return {
            "verdict": self.verdict,
            "rule": self.rule,
            "summary": self.summary,
            "case": list(self.case),
            "rows": {
                row.key: {
                    "label": row.label,
                    "value": or_none(row.value),
                    "unit": row.unit,
                    "band": None if row.band is None else list(map(or_none, row.band)),
                    "text": row.text,
                    "note": row.note,
                    "study": row.study,
                }
                for row in self.rows
            },
            "assumed": [*self.assumed, *self.minor],
            "notes": [note.as_dict() for note in self.notes],
            "faults": list(self.faults),
            "next": list(self.next),
        }

    def html(self) -> str:
        """Return the answer as a part of a page, with the verdict as its class."""
        marked = ' class="marked"'
        rows = "".join(
            f'<tr{marked * (row.key == self.marked_row)}><th scope="row">{escape(row.label)}</th>'
            f"<td>{escape(row.text)}</td><td>{escape(row.note)}</td></tr>"
            for row in self.visible_rows()
        )
        groups = dict(self.groups())
        groups["assumed"] = [*self.assumed]
        groups["notes"] = [
            *self.faults,
            *dict.fromkeys(f"{note.code} {note.short}".strip() for note in self.notes),
        ]
        for name, minor in (("assumed", len(self.minor)), ("notes", 0)):
            hidden = max(len(groups[name]) - MAX_ROWS, 0) + minor
            groups[name] = groups[name][:MAX_ROWS] + [f"{hidden} more"] * bool(hidden)
        below = "".join(
            f"<p>{name}: {'<br/>'.join(map(escape, texts))}</p>"
            for name, texts in groups.items()
            if texts
        )
        points = html_table(self.table[0], self.table[1:]) if self.table else ""
        verdict = f"<strong>{self.verdict}</strong> " if self.verdict else ""
        head = "".join(
            f"<p>{verdict * (not k)}{escape(text)}</p>"
            for k, text in enumerate(filter(None, (self.summary, ", ".join(self.case))))
        )
        return (
            f'<div class="answer {self.verdict.lower()}">{head}<table><thead><tr><th scope="col">quantity</th>'
            '<th scope="col">value</th><th scope="col">band, remarks</th></tr></thead>'
            f"<tbody>{rows}</tbody></table>{points}{below}</div>"
        )

    _repr_html_ = html

    def __str__(self) -> str:
        return "\n".join(self.lines(more=".notes"))


def merge_answers(answers: Iterable[tuple[str, Answer]], scene: str = "") -> Answer:
    """Return one answer of those of several studies, with its verdict if one of them knows the cage slip.

    The summary is that of the study whose slip is judged, so that no other one stands beside the verdict.

    Parameters
    ----------
    answers : iterable of (str, Answer)
        Names of studies and their answers.
    scene : str
        What commands take; without it commands are those of Python, for a scene that is not in a file.
    """
    ranked = sorted(answers, key=lambda item: -max((row.rank for row in item[1].rows), default=-1))
    best, disagreements = _best_rows(ranked)
    ordered = [answer for _, answer in ranked]
    summarising = next((answer for answer in ordered if answer.summary), Answer())
    primary = next((answer for answer in ordered if answer.needs_verdict), summarising)
    merged = Answer(
        summary=primary.summary,
        rows=tuple(best.values()),
        table=summarising.table,
        omitted=summarising.omitted,
        acceptable=next((item.acceptable for item in ordered if item.acceptable > 0.0), ACCEPTABLE),
        assumed=_joined(answer.assumed for answer in ordered),
        minor=_joined(answer.minor for answer in ordered),
        facts=ChainMap(*(dict(answer.facts) for answer in ordered)),
        faults=(*_joined(answer.faults for answer in ordered), *disagreements),
    )
    commands = next((answer.commands for answer in ordered if answer.commands), {})
    steps = list(_joined(answer.next for answer in ordered))
    if commands or merged.needs_verdict:
        merged = with_verdict(merged)
        steps = [*commands.get(merged.verdict, ()), *steps]
    return attrs.evolve(merged, next=tuple(_command(text, scene) for text in steps))


def _headed(name: str, texts: Iterable[str]) -> list[tuple[str, str]]:
    """Return rows of texts, of which the first has a name before it."""
    return [(f"{'' if k else name:<{_HEADING}}", text) for k, text in enumerate(texts)]


def _command(text: str, scene: str) -> str:
    """Return a command with its scene, as a call in Python where that is not in a file."""
    if "{scene}" in text and not scene:
        return python_call(text)
    return text.replace("{scene}", scene)


def _joined(texts: Iterable[Iterable[str]]) -> tuple[str, ...]:
    """Return all texts, each once."""
    return tuple(dict.fromkeys(chain.from_iterable(texts)))


def _best_rows(answers: Iterable[tuple[str, Answer]]) -> tuple[dict[str, Row], list[str]]:
    """Return by key the rows with the highest rank, and sentences on those on which studies disagree."""
    best = dict[str, Row]()
    faults = list[str]()
    for study, answer in answers:
        for item in answer.rows:
            row = attrs.evolve(item, study=item.study or study)
            first = best.setdefault(row.key, row)
            better, other = (row, first) if row.rank > first.rank else (first, row)
            best[row.key] = better
            if _disagree(better, other):
                faults.append(
                    f"two studies disagree on the {row.label}: {better.text} by {better.study}, {other.text} by "
                    f"{other.study}"
                )
    return best, faults


def with_verdict(answer: Answer) -> Answer:
    """Return an answer with its verdict, and a remark beside the row that decided."""
    rule, verdict, remark = decide(answer_facts(answer))
    if remark:
        remark = f"{rule.code}: " + remark.format(
            acceptable=f"{format_plain(100.0 * answer.acceptable)} %",
            twice=f"{format_plain(200.0 * answer.acceptable)} %",
        )
    rows = answer.rows
    if not any(row.key == "cage_slip" for row in rows):
        rows = (Row(key="cage_slip", label="cage slip", text="not computed"), *rows)
    key = rule.row if any(row.key == rule.row for row in rows) else "cage_slip"
    return attrs.evolve(
        answer,
        rows=tuple(
            attrs.evolve(row, note="; ".join(filter(None, (remark, row.note))))
            if row.key == key
            else row
            for row in rows
        ),
        verdict=verdict,
        rule=rule.code,
        marked_row="" if verdict is Verdict.OK else key,
    )


def answer_facts(answer: Answer) -> dict[Fact, Interval]:
    """Return the facts that rules compare, as lower and upper bounds; facts that are not known are left out."""
    known = {row.key: row for row in answer.rows if not math.isnan(row.value)}
    values = dict(answer.facts)
    if film := known.get("film_parameter"):
        values[Fact.FILM_PARAMETER] = film.value
    values[Fact.ACCEPTABLE_SLIP] = answer.acceptable
    slip = known.get("cage_slip")
    if slip and slip.band:
        values[Fact.BAND_HIGH] = max(map(abs, slip.band))
    facts = {fact: (value, value) for fact, value in values.items()}
    if slip:
        size = abs(slip.value)  # a cage that runs ahead slides as much
        accuracy = min(slip.tolerance, _MAX_ACCURACY)
        facts[Fact.CAGE_SLIP] = ((1.0 - accuracy) * size, (1.0 + accuracy) * size)
    if reserve := known.get("drag_reserve"):
        facts[Fact.RESERVE] = reserve.band or (reserve.value, reserve.value)
    return facts


def _disagree(row: Row, other: Row) -> bool:
    """Whether two values of a quantity differ by more than both tolerances; small slips always agree."""
    if row is other or math.isnan(row.value) or math.isnan(other.value) or math.isinf(row.value):
        return False
    resolution = _SLIP_RESOLUTION if row.key == "cage_slip" else 0.0
    largest = max(abs(row.value), abs(other.value))
    return abs(row.value - other.value) > largest * (row.tolerance + other.tolerance) + resolution


# Notes ---------------------------------------------------------------------------------------------------------------


def summarise_notes(notes: Iterable[Note], more: str = "") -> str:
    """Return one text on what laws outside their ranges change, the largest changes first; empty without notes.

    Parameters
    ----------
    notes : iterable of Note
        The notes, in the order of `collect_notes`.
    more : str
        Option that shows all notes in full.
    """
    every = list(notes)
    if not every:
        return ""
    hint = in_brackets(more)
    if all(note.changes is None for note in every):
        return f"{_list_codes(every)}{hint}"
    changing = [note for note in every if note.largest_change[1] >= _NO_CHANGE]
    shown = [note for note in changing if note.largest_change[1] > _LARGE_CHANGE][:_MAX_SHOWN_NOTES]
    texts = [note.summary for note in shown]
    others = changing[len(shown) :]
    if others:
        texts.append(_count_notes(others, bool(shown)))
    unknown = [note.code or note.short for note in every if note.changes is None]
    if unknown:
        texts.append(f"{' '.join(unknown)} not compared")
    return f"{'; '.join(texts) or 'none moves slip or torque by 1 %'}{hint}"


def _list_codes(notes: Sequence[Note]) -> str:
    """Return the codes of notes whose consequences are not evaluated, those of a campaign by where they apply."""
    codes = dict[str, dict[str, None]]()
    for note in notes:
        codes.setdefault(note.where, {})[note.code or note.short] = None
    if "" in codes:
        return f"{len(codes[''])} on laws outside their range: {' '.join(codes[''])}"
    return "; ".join(f"{' '.join(names)} {where}" for where, names in codes.items())


def _count_notes(notes: Sequence[Note], has_others: bool) -> str:
    """Return the number of notes and a limit on what they change, after others that are shown on their own."""
    largest = max(note.largest_change[1] for note in notes)
    limit = next(
        (f"{100.0 * fraction:g} %" for fraction in _CHANGE_LIMITS if largest <= fraction), ""
    )
    if has_others:
        return f"{len(notes)} more{f' below {limit}' if limit else ', of more than 100 %'}"
    quantities = " or ".join(sorted({note.largest_change[0] for note in notes}))
    if len(notes) == 1:
        return f"{notes[0].code} moves the {quantities} by up to {limit}"
    return f"{len(notes)}, none of which moves the {quantities} by more than {limit}"


def collect_notes(datasets: "Iterable[xr.Dataset]") -> tuple[Note, ...]:
    """Return notes on the laws outside their ranges in some results, each once, the largest changes first."""
    results = list(datasets)
    consequences: dict[str, dict[str, Any]] = {
        row["code"]: row
        for result in results
        for row in json.loads(result.attrs.get("consequences", "[]"))
    }
    messages = worst_messages(
        results,
        lambda message: message.get("code", "") or f"{message['law']} {message['made_for']}",
    )
    notes = [(_note(message, consequences), message) for message in messages]
    notes.sort(key=lambda item: (_note_rank(item[0]), message_rank(item[1])), reverse=True)
    return tuple(note for note, _ in notes)


def _note(message: Mapping[str, Any], consequences: Mapping[str, Mapping[str, Any]]) -> Note:
    """Return the note of a message on a range, with the changes by another law, if these were evaluated."""
    code = message.get("code", "")
    row = consequences.get(code, {"changes": {}} if consequences else {})
    if changes := row.get("changes"):
        changes = {
            name: (before, math.inf if after is None else after)
            for name, (before, after) in changes.items()
        }
    return Note(
        code=code,
        short=message["short"],
        text=message["text"],
        severity=message["severity"],
        where=message.get("where", ""),
        alternative=row.get("instead", ""),
        changes=changes,
    )


def _note_rank(note: Note) -> float:
    """Return what orders notes: their largest change; those not evaluated come after all that change something."""
    _, change = note.largest_change
    if change >= _NO_CHANGE:
        return change
    return 0.5 * _NO_CHANGE if note.changes is None else 0.0


# Lines ---------------------------------------------------------------------------------------------------------------


def _shortening_steps(
    rows: list[tuple[str, str, str]],
    table: list[tuple[str, ...]],
    groups: Sequence[tuple[str, list[str]]],
    width: int,
    more: str,
) -> list[Callable[[], object]]:
    """Return functions that shorten the parts of an answer in place, what matters least first; rows go last."""
    (_, assumed), (_, notes), (_, commands) = groups
    room = max(
        width - sum(max((len(row[k]) for row in rows), default=0) + 2 for k in (0, 1)) - 2,
        _MIN_NOTE,
    )
    return [
        partial(delitem, commands, slice(1, None)),
        *[table.pop] * (len(table) - _MIN_TABLE),
        *[assumed.pop] * (len(assumed) - 2),
        partial(_cut_to_line, assumed, width, more),
        partial(_cut_to_line, notes, width, more),
        *(partial(_shorten_note, rows, k, room) for k in reversed(range(len(rows)))),
        partial(delitem, assumed, slice(1, None)),
        *[rows.pop] * len(rows),
    ]


def _shorten_note(rows: list[tuple[str, str, str]], k: int, room: int) -> None:
    """Shorten the note of a row to a number of letters."""
    label, text, note = rows[k]
    rows[k] = label, text, textwrap.shorten(note, room, placeholder=" ...")


def _cut_to_line(texts: list[str], width: int, more: str) -> None:
    """Replace texts by those of their parts that fit on one line."""
    texts[:] = [_line(text, width, more) for text in texts]


def _with_count(texts: Sequence[str], hidden: int, option: str, width: int) -> list[str]:
    """Return texts with the number of those not shown, behind the last one if it has room, and what shows them."""
    if not hidden:
        return [*texts]
    count = f"{hidden} more ({option})"
    last = "; ".join([*texts[-1:], count])
    if len(last) > width - _HEADING - 4:
        return [*texts, count]
    return [*texts[:-1], last]


def _line(text: str, width: int, more: str) -> str:
    """Return the first parts of a text that fit on one line, with the option that shows more."""
    if not text.endswith(more):
        more = ""
    room = width - _HEADING - 4 - len(more)
    parts = text.removesuffix(more).split("; ")
    while len("; ".join(parts)) > room and len(parts) > 1:
        parts.pop()
    return textwrap.shorten("; ".join(parts), room, placeholder=" ...") + more
