"""The answer: what has to be known first of some results, as one value that terminal, report, notebook and JSON show.

- Each account gives rows, one a quantity. Of several results the one tells a quantity that knows it best; two that
  differ by more than both allow are a fault, which is told.
- The verdict is the first of the `RULES` that holds, on facts that are intervals: a reserve that is known to be 2 at
  least is from 2 to infinity. A rule for something worse that the facts cannot decide makes the verdict UNKNOWN.
- People read two digits, percent, rpm, °C and kN, no exponents; values and bands beside them are SI and whole.
"""

import json
import math
import re
import shutil
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, Final

import attrs

from rollslip.results.curves import or_none
from rollslip.results.text import force_unit, format_plain, percent, python_call, two_digits
from rollslip.units import converted, shown_unit

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ACCEPTABLE", "RULES", "Answer", "Note", "Row", "Rule", "aligned", "assumed_of", "case_of",
           "counted_notes", "merged", "notes_of"]  # fmt: skip

#: Verdicts, what is worse later; UNKNOWN is none of them.
VERDICTS: Final = ("OK", "SLIPS", "SKIDS")
UNKNOWN: Final = "UNKNOWN"
#: Letters and ground of each, with the same contrast on a dark and on a light terminal.
COLOURS: Final = {"OK": ("black", "green"), "SLIPS": ("black", "yellow"), "SKIDS": ("white", "red"),
                  UNKNOWN: ("white", "magenta")}  # fmt: skip
#: Cage slip that is acceptable where no result says another.
ACCEPTABLE: Final = 0.05
#: Slip [1] below which an assumption moves nothing that matters, and the factor on it from which one is told.
_SMALL = 0.005
_MOVES = 1.2
#: Change of a result that is none, and one that is told on its own.
_UNMOVED = 0.01
_MUCH = 0.1
#: Most notes that are told on their own, and changes below which the others are told.
_FEW = 2
_STEPS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0)
_Moved = Mapping[str, tuple[float, float]]
#: Lines of an answer and rows of it, at most; width where there is no terminal, and between which it is kept.
MAX_LINES = 15
MAX_ROWS = 8
_WIDTH: Final = 100
#: Letters of the longest heading below the rows.
_HEADING: Final = len("assumed")
#: A line of a new scene whose value nobody gave, or that begins a table; and what names are of, by table.
_ASSUMED: Final = re.compile(r"^\s*(?:\[(\w+)\]|(\w+)\s*=.*#.*\bASSUMED\b)", re.MULTILINE)
_NAMED: Final = {"lubricant": "oil"}


@attrs.frozen(kw_only=True)
class Row:
    """One quantity of an answer."""

    key: str  #: What it is, alike in all results: "cage_slip".
    label: str  #: What people call it.
    value: float = math.nan  #: SI value, NaN where there is none.
    unit: str = "1"  #: SI unit.
    text: str  #: How it is printed.
    #: Between what it lies, 5 to 95 % or bounds; infinite where there is no end.
    band: tuple[float, float] | None = None
    note: str = ""  #: What is said beside it.
    known: int = 0  #: How well its study knows it: of several the best known is told.
    within: float = 0.1  #: Relative difference from another study's value that is no fault.
    alarm: bool = False  #: Whether a limit is passed, for which another row makes room.
    by: str = ""  #: The study that it is of.


@attrs.frozen(kw_only=True)
class Note:
    """A law that was left: its code, what is outside in a few words, the whole sentence, and its weight.

    ``moved`` has by quantity what the answer says and what it would be by the law ``instead``; None where that was not
    evaluated, empty where the bound is left, but not at the operation that the answer is of.
    """

    code: str
    short: str
    text: str
    weight: float
    instead: str = ""
    moved: _Moved | None = None

    @property
    def most(self) -> tuple[str, float]:
        """What moves most, slips that nobody minds aside, and by which share; infinite where there is none left."""
        found = {
            name: _change(*ends)
            for name, ends in (self.moved or {}).items()
            if _matters(name, *ends)
        }
        name = (
            "slip"
            if found.get("slip", 0.0) > _MUCH
            else max(found, key=lambda one: found[one], default="")
        )
        return name, found.get(name, 0.0)

    @property
    def told(self) -> str:
        """What the law instead makes of what moves most: "W11: slip 5.8 % with maxwell-eyring-field"."""
        name, _ = self.most
        return f"{self.code}: {_shown(name, (self.moved or {})[name][1])} with {self.instead}"

    @property
    def consequence(self) -> str:
        """What is said of it behind its sentence."""
        if self.moved is None:
            return "not evaluated"
        if not self.moved:
            return "not at the steady slip"
        ends = [f"{_shown(name, after)} in place of {_shown(name, before).removeprefix(f'{name} ')}"
                for name, (before, after) in self.moved.items() if _change(before, after) >= _UNMOVED]  # fmt: skip
        return f"with {self.instead} {', '.join(ends) or 'slip, reserve and torque move by less than 1 %'}"

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON has it, what it moves in SI units."""
        moved = (
            None
            if self.moved is None
            else {name: [*map(or_none, ends)] for name, ends in self.moved.items()}
        )
        return {"code": self.code, "short": self.short, "text": self.text, "weight": self.weight,
                "instead": self.instead, "moved": moved}  # fmt: skip


def _change(before: float, after: float) -> float:
    return abs(after / before - 1.0) if math.isfinite(after) else math.inf


def _matters(name: str, before: float, after: float) -> bool:
    return max(before, after) >= _SMALL if name == "slip" else before > 0.0


def _shown(name: str, value: float) -> str:
    if name == "slip":
        return f"slip {percent(value)}" if math.isfinite(value) else "it skids"
    return f"{name} {two_digits(value) if value > 0.0 else 'none'}" + " N m" * (
        name == "friction torque"
    )


@attrs.frozen(kw_only=True)
class Rule:
    """One rule of the verdict: its code, what it says if all conditions hold, words beside the row, and its source.

    A condition is a fact, a sign and a limit: a number, or another fact times a factor.
    """

    code: str
    verdict: str
    row: str
    when: tuple[tuple[str, str, float | tuple[float, str]], ...]
    words: str
    source: str

    @property
    def condition(self) -> str:
        """All conditions in words; "else" where there is none."""
        said = []
        for fact, sign, limit in self.when:
            factor, other = limit if isinstance(limit, tuple) else (limit, "")
            number = " x ".join(
                filter(None, (f"{factor:g}" if factor != 1.0 or not other else "", other))
            )
            said.append(f"{fact} is not known" if sign == "none" else f"{fact} {sign} {number}")
        return " and ".join(said) or "else"


_CHOICE: Final = "a choice"
RULES: Final = (
    Rule(code="V1", verdict="SKIDS", row="drag_reserve", when=(("reserve to skidding", "<", 1.0),),
         words="the drags are larger than what the rollers carry", source="balance of torques"),
    Rule(code="V2", verdict=UNKNOWN, row="cage_slip", when=(("cage slip", "none", 0.0),), words="",
         source="nothing can be said"),
    Rule(code="V3", verdict="SKIDS", row="cage_slip", when=(("cage slip", ">", 0.2),), words="above 20 %",
         source=_CHOICE),
    Rule(code="V4", verdict="SKIDS", row="drag_reserve", when=(("reserve to skidding", "<", 1.5),), words="below 1.5",
         source=_CHOICE),
    Rule(code="V5", verdict=UNKNOWN, row="cage_slip",
         when=(("low end of the band", "<", (1.0, "acceptable slip")), ("high end of the band", ">", 0.2),
               ("high end of the band", ">", (40.0, "low end of the band"))),
         words="from OK to SKIDS where data scatter", source=_CHOICE),
    Rule(code="V6", verdict="SLIPS", row="cage_slip", when=(("cage slip", ">", (1.0, "acceptable slip")),),
         words="above the acceptable {acceptable}", source="what a scene calls acceptable, by default a choice"),
    Rule(code="V7", verdict="SLIPS", row="cage_slip", when=(("high end of the band", ">", (2.0, "acceptable slip")),),
         words="may be above {twice}", source=_CHOICE),
    Rule(code="V8", verdict="SLIPS", row="drag_reserve", when=(("reserve to skidding", "<", 2.0),), words="below 2",
         source=_CHOICE),
    Rule(code="V9", verdict="OK", row="cage_slip", when=(), words="", source="else"),
)  # fmt: skip
_Interval = tuple[float, float]
_NOTHING: Final[_Interval] = (math.nan, math.nan)


def holds(rule: Rule, facts: Mapping[str, _Interval]) -> bool | None:
    """Return whether all conditions of a rule hold; None where facts do not decide that."""
    each = [
        _holds(facts.get(fact, _NOTHING), sign, limit, facts) for fact, sign, limit in rule.when
    ]
    return False if False in each else None if None in each else True


def _holds(
    fact: _Interval, sign: str, limit: float | tuple[float, str], facts: Mapping[str, _Interval]
) -> bool | None:
    if sign == "none":
        return math.isnan(fact[0])
    factor, other = limit if isinstance(limit, tuple) else (limit, "")
    low, high = (factor * end for end in facts.get(other, _NOTHING if other else (1.0, 1.0)))
    below = sign == "<"
    (least, most), (low, high) = (fact, (low, high)) if below else ((low, high), fact)
    if most < low:
        return True
    return False if least >= high else None


@attrs.frozen(kw_only=True)
class Answer:
    """What has to be known first: `rows` of quantities, what is assumed, what was left, and what to do next.

    An account gives rows, ``acceptable`` slip, ``assumed``, and ``commands`` that help by verdict, with ``{scene}`` in
    them; `merged` makes one answer of several, with ``verdict``, ``rule`` behind it, and ``case``.
    """

    rows: tuple[Row, ...] = ()
    acceptable: float = math.nan
    assumed: tuple[str, ...] = ()
    commands: Mapping[str, tuple[str, ...]] = attrs.field(factory=dict)
    next: tuple[str, ...] = ()
    case: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
    faults: tuple[str, ...] = ()
    verdict: str = ""
    rule: str = ""
    marked: str = ""

    def __getitem__(self, key: str) -> Row:
        """Return a row by its key."""
        found = next((row for row in self.rows if row.key == key), None)
        if found is None:
            raise KeyError(f"{key}; there are {', '.join(row.key for row in self.rows)}")
        return found

    def shown(self) -> list[Row]:
        """Return the rows that people see, `MAX_ROWS` at most: those with an alarm, and the first others."""
        kept = sorted(self.rows, key=lambda row: not row.alarm)[:MAX_ROWS]
        return [row for row in self.rows if row in kept]

    def groups(self, more: str = "") -> list[tuple[str, list[str]]]:
        """Return what stands below the rows, by its heading; ``more`` is where notes are told in full."""
        return [
            ("assumed", list(self.assumed)),
            ("notes", [*self.faults, *filter(None, [counted_notes(self.notes, more)])]),
            ("next", list(self.next)),
        ]

    def lines(self, width: int = 0, more: str = "-v") -> list[str]:
        """Return the lines of a terminal: no wider than it, `MAX_LINES` at most, what matters least left out.

        Commands are not wrapped: as one line they can be pasted. ``more`` is where notes are told in full.
        """
        width = max(width or shutil.get_terminal_size((_WIDTH, 24)).columns, 40)
        head = _wrapped(["   ".join(filter(None, (self.verdict, ", ".join(self.case))))], width)
        rows = [(row.label, row.text, row.note) for row in self.shown()]
        groups = self.groups(more)
        for _ in _shortened(rows, groups, width, f" ({more})"):
            below = [line for name, texts in groups for line in
                     aligned(list(_headed(name, texts)), math.inf if name == "next" else width)]  # fmt: skip
            parts = [part for part in (head, aligned(rows, width), below) if part]
            lines = [line for k, part in enumerate(parts) for line in ([""] * (k > 0) + part)]
            if len(lines) <= MAX_LINES:
                break
        return lines

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON has it: of each row SI value, unit, band and the text that is printed."""
        return {
            "verdict": self.verdict,
            "rule": self.rule,
            "case": list(self.case),
            "rows": {
                row.key: {
                    "label": row.label,
                    "value": or_none(row.value),
                    "unit": row.unit,
                    "band": None if row.band is None else [or_none(end) for end in row.band],
                    "text": row.text,
                    "note": row.note,
                    "study": row.by,
                }
                for row in self.rows
            },
            "assumed": list(self.assumed),
            "notes": [note.as_dict() for note in self.notes],
            "faults": list(self.faults),
            "next": list(self.next),
        }

    def html(self) -> str:
        """Return it as a part of a page, by the verdict as its class."""
        marked = ' class="marked"'
        rows = "".join(
            f'<tr{marked * (row.key == self.marked)}><th scope="row">{escape(row.label)}</th>'
            f"<td>{escape(row.text)}</td><td>{escape(row.note)}</td></tr>"
            for row in self.shown()
        )
        groups = dict(self.groups())
        groups["notes"] = [
            *self.faults,
            *dict.fromkeys(f"{one.code} {one.short}".strip() for one in self.notes),
        ]
        below = "".join(
            f"<p>{name}: {'<br/>'.join(map(escape, texts[:MAX_ROWS]))}</p>"
            for name, texts in groups.items()
            if texts
        )
        verdict = f"<strong>{self.verdict}</strong> " if self.verdict else ""
        head = f"<p>{verdict}{escape(', '.join(self.case))}</p>"
        titles = "".join(
            f'<th scope="col">{title}</th>' for title in ("quantity", "value", "band, remarks")
        )
        table = f"<table><thead><tr>{titles}</tr></thead><tbody>{rows}</tbody></table>"
        return f'<div class="answer {self.verdict.lower()}">{head}{table}{below}</div>'

    _repr_html_ = html

    def __str__(self) -> str:
        return "\n".join(self.lines(more=".notes"))


def merged(answers: Iterable[tuple[str, Answer]], scene: str = "") -> Answer:
    """Return one answer of those of several studies, each with its name; ``scene`` is what commands are to take.

    Without one commands are those of Python, for a scene that stands in no file.
    """
    given = sorted(answers, key=lambda each: -max((row.known for row in each[1].rows), default=-1))
    best = dict[str, Row]()
    faults = [fault for _, one in given for fault in one.faults]
    for study, one in given:
        for row in (attrs.evolve(row, by=row.by or study) for row in one.rows):
            known = best.setdefault(row.key, row)
            better, other = (row, known) if row.known > known.known else (known, row)
            best[row.key] = better
            if _differ(better, other):
                faults.append(
                    f"two studies disagree on the {row.label}: {better.text} by {better.by}, {other.text} by {other.by}"
                )
    acceptable = next((one.acceptable for _, one in given if one.acceptable > 0.0), ACCEPTABLE)
    answer = Answer(
        rows=tuple(best.values()),
        acceptable=acceptable,
        assumed=tuple(dict.fromkeys(text for _, one in given for text in one.assumed)),
        faults=tuple(faults),
    )
    commands = next((one.commands for _, one in given if one.commands), None)
    if "cage_slip" not in best and commands is None:
        return answer
    answer = judged(answer)
    texts = (commands or {}).get(answer.verdict, ())
    told = [text.replace("{scene}", scene) if scene else python_call(text) for text in texts]
    return attrs.evolve(answer, next=tuple(told))


def judged(answer: Answer) -> Answer:
    """Return an answer with its verdict, and words beside the row that decided."""
    facts = facts_of(answer)
    states = [(rule, holds(rule, facts)) for rule in RULES]
    rule = next(one for one, state in states if state)
    verdict = rule.verdict
    words = rule.words
    rank = {name: k for k, name in enumerate((*VERDICTS, UNKNOWN))}
    open_ = [
        one
        for one, state in states
        if state is None and rank[verdict] < rank[one.verdict] < rank[UNKNOWN]
    ]
    if open_:
        rule = open_[0]
        verdict = UNKNOWN
        lacks = " and ".join(
            dict.fromkeys(fact for fact, *_ in rule.when if not _known(facts.get(fact)))
        )
        words = f"whether it {rule.verdict.lower()} is not known: no {lacks}"
        words = words if lacks else f"whether it is {rule.words} is not known"
    per_cent = {"acceptable": 100.0 * answer.acceptable, "twice": 200.0 * answer.acceptable}
    words = words.format(**{name: f"{format_plain(value)} %" for name, value in per_cent.items()})
    rows = answer.rows
    if not any(row.key == "cage_slip" for row in rows):
        rows = (Row(key="cage_slip", label="cage slip", text="not computed"), *rows)
    key = rule.row if any(row.key == rule.row for row in rows) else "cage_slip"
    rows = tuple(
        attrs.evolve(row, note="; ".join(filter(None, (row.note, words))))
        if row.key == key
        else row
        for row in rows
    )
    marked = key if verdict != "OK" else ""
    return attrs.evolve(answer, rows=rows, verdict=verdict, rule=rule.code, marked=marked)


def facts_of(answer: Answer) -> dict[str, _Interval]:
    """Return what rules are about, each between its ends; what is not known is left out."""
    rows = {row.key: row for row in answer.rows}
    facts = {"acceptable slip": (answer.acceptable, answer.acceptable)}
    if (slip := rows.get("cage_slip")) is not None and not math.isnan(slip.value):
        facts["cage slip"] = (
            abs(slip.value),
            abs(slip.value),
        )  # a cage that runs ahead slides as much
        if slip.band is not None:
            facts |= {
                name: (end, end)
                for name, end in zip(
                    ("low end of the band", "high end of the band"), slip.band, strict=True
                )
            }
    if (reserve := rows.get("drag_reserve")) is not None and not math.isnan(reserve.value):
        facts["reserve to skidding"] = reserve.band or (reserve.value, reserve.value)
    return facts


def _known(fact: _Interval | None) -> bool:
    return fact is not None and not math.isnan(fact[0])


def _differ(one: Row, other: Row) -> bool:
    """Whether two values of a quantity are further from each other than both allow; none that is small is."""
    if one is other or math.isnan(one.value) or math.isnan(other.value) or math.isinf(one.value):
        return False
    least = 1e-3 if one.key == "cage_slip" else 0.0
    return (
        abs(one.value - other.value)
        > max(abs(one.value), abs(other.value)) * (one.within + other.within) + least
    )


# What a result says of itself -----------------------------------------------------------------------------------------


def case_of(dataset: "xr.Dataset") -> tuple[str, ...]:
    """Return bearing, oil, speeds, load and temperature of a result in people's units; empty if it does not say."""
    a = dataset.attrs
    scene = json.loads(a.get("scene_resolved", "{}"))
    if not (operation := scene.get("operation")):
        return ()
    named = [one["name"] for one in json.loads(a.get("data", "[]")) if one["kind"] == "bearing"]
    oil = json.loads(a.get("lubricant", "{}")).get("name", "")
    oil = re.sub(r"^iso-vg-(\d+)$", r"ISO VG \1", oil)
    oil = oil.upper() if oil.startswith("mil-") else oil
    inner, outer = (
        operation.get(f"{ring}_speed", 0.0) * 30.0 / math.pi for ring in ("inner", "outer")
    )
    speed = f"{inner:.0f} rpm" + (f" (outer ring {outer:.0f} rpm)" if outer else "")
    (unit, size) = force_unit(operation["radial_load"])
    load = operation["radial_load"]
    last = (
        f"{format_plain(load * size)} {unit}",
        f"{format_plain(operation['temperature'] - 273.15)} °C",
    )
    return tuple(filter(None, (named[0] if named else a.get("source", ""), oil, speed, *last)))


def assumed_of(dataset: "xr.Dataset") -> tuple[str, ...]:
    """Return what nobody gave: marks of a new scene, and what scatters, with the slips that it leads to."""
    a = dataset.attrs
    marked = list[str]()
    table = ""
    for begins, key in _ASSUMED.findall(a.get("scene", "")):
        table = begins or table
        marked += filter(None, [_NAMED.get(table, table) if key == "name" else key])
    given = [", ".join(dict.fromkeys(marked)).replace("_", " ")]
    given = [f"{names} as rollslip new has it" for names in filter(None, given)]
    if own := a.get("own_cage"):
        given.append(f"cage {own.partition(', ')[2].partition(';')[0]}")
    said = list[str]()
    for one in json.loads(a.get("band", "{}")).get("steady_slip", {}).get("moved", ()):
        low, high = (math.inf if end is None else end for end in one["values"])
        if len(said) < 2 and max(low, high) > _SMALL and max(low, high) >= _MOVES * min(low, high):
            said.append(f"{_quantity(one)}: slip {_ends(low, high)}")
    return (*said, *filter(None, ["; ".join(given)]))


def _quantity(one: Mapping[str, Any]) -> str:
    """A quantity that was moved and where to: "Eyring stress 1.1 to 8.9 MPa", "petroff-land x 0.32 to 3.2"."""
    *_, table, name = one["key"].split(".")
    ends = one["ends"]
    if name.endswith("factor"):
        called = (
            f"drag {table}" if name == "factor" else name.removesuffix("_factor").replace("_", " ")
        )
        return f"{called} x {two_digits(ends[0])} to {two_digits(ends[1])}"
    called = name.replace("_", " ")
    unit = shown_unit(max(map(abs, ends)), one["unit"] or "1")
    low, high = (converted(end, one["unit"], unit) for end in ends)
    if low > 0.0 and high < 1e-3:  # a number that nobody reads: by what it is multiplied
        return (
            f"{called} x {two_digits(math.sqrt(low / high))} to {two_digits(math.sqrt(high / low))}"
        )
    return (
        f"{called} {two_digits(low)} to {two_digits(high)} {unit}".rstrip()
        if max(abs(low), abs(high)) > 1e-3
        else called
    )


def _ends(low: float, high: float) -> str:
    """Two slips, in the order of what leads to them."""
    texts = [percent(end) if math.isfinite(end) else "skidding" for end in (low, high)]
    return (
        f"{texts[0].removesuffix(' %')} to {texts[1]}"
        if texts[0][-1] == texts[1][-1] == "%"
        else " to ".join(texts)
    )


# Notes ---------------------------------------------------------------------------------------------------------------


def counted_notes(notes: Iterable[Note], more: str = "") -> str:
    """Say what the laws outside their range do to the result, the worst first; ``more`` is where all are told."""
    every = list(notes)
    where = f" ({more})" if more else ""
    if all(note.moved is None for note in every):
        codes = list(dict.fromkeys(note.code or note.short for note in every))
        return (
            f"{len(codes)} on laws outside their range: {' '.join(codes)}{where}" if codes else ""
        )
    moving = [note for note in every if note.most[1] >= _UNMOVED]
    first = [note for note in moving if note.most[1] > _MUCH][:_FEW]
    rest = moving[len(first) :]
    said = [note.told for note in first]
    if rest:
        most = max(note.most[1] for note in rest)
        limit = next((f"{100.0 * step:g} %" for step in _STEPS if most <= step), "a factor of 2")
        of = " or ".join(sorted({note.most[0] for note in rest}))
        alone = f"{rest[0].code} moves the {of} by up to {limit}"
        none = (
            alone
            if len(rest) == 1
            else f"{len(rest)}, none of which moves the {of} by more than {limit}"
        )
        said.append(f"{len(rest)} more below {limit}" if first else none)
    unknown = [note.code or note.short for note in every if note.moved is None]
    said += [f"{' '.join(unknown)} not evaluated"] if unknown else []
    return f"{'; '.join(said) or 'none moves slip or torque by 1 %'}{where}" if every else ""


def notes_of(datasets: "Iterable[xr.Dataset]") -> tuple[Note, ...]:
    """Return the laws that results left, each once and where its consequence is largest, the worst first."""
    found = dict[str, tuple[tuple[bool, float], Note]]()
    every = list(datasets)
    at: dict[str, dict[str, Any]] = {
        row["code"]: row for one in every for row in json.loads(one.attrs.get("consequences", "[]"))
    }
    for dataset in every:
        for one in json.loads(dataset.attrs.get("validity") or "{}").get("messages", []):
            code = one.get("code", "")
            row = at.get(code, {"moved": {}} if at else {})
            moved = row.get("moved")
            if moved is not None:
                moved = {
                    name: (first, math.inf if last is None else last)
                    for name, (first, last) in moved.items()
                }
            note = Note(code=code, short=one["short"], text=one["text"], weight=one["severity"],
                        instead=row.get("instead", ""), moved=moved)  # fmt: skip
            key = code or f"{one['law']} {one['made_for']}"
            rank = (one["is_warning"], one["severity"])
            if key not in found or rank > found[key][0]:
                found[key] = rank, note
    ranked = sorted(found.values(), key=lambda each: (_rank(each[1]), each[0]), reverse=True)
    return tuple(note for _, note in ranked)


def _rank(note: Note) -> float:
    """By what a note stands: what it moves, those that were not evaluated behind those that move something."""
    most = note.most[1]
    return most if most >= _UNMOVED else 0.5 * _UNMOVED if note.moved is None else 0.0


# Lines ---------------------------------------------------------------------------------------------------------------


def _headed(name: str, texts: Sequence[str]) -> Iterator[tuple[str, str]]:
    for k, text in enumerate(texts):
        yield f"{'' if k else name:<{_HEADING}}", text


def _shortened(rows: list[tuple[str, str, str]], groups: Sequence[tuple[str, list[str]]], width: int,
               more: str) -> Iterator[None]:  # fmt: skip
    """Shorten an answer step by step, what matters least first; all rows stay as long as that can be."""
    (_, assumed), (_, notes), (_, after) = groups
    yield
    del after[1:]
    while len(assumed) > 2:
        yield
        assumed.pop()
    yield
    assumed[:] = [_line(text, width, more) for text in assumed]
    yield
    notes[:] = [_line(text, width, more) for text in notes]
    yield
    del assumed[1:]
    yield
    room = max(
        width - sum(max((len(row[k]) for row in rows), default=0) + 2 for k in (0, 1)) - 2, 4
    )
    for k in reversed(range(len(rows))):
        label, text, note = rows[k]
        if len(note) > room:
            rows[k] = label, text, textwrap.shorten(note, room, placeholder=" ...")
            yield
    while rows:
        yield
        rows.pop()
    yield


def _line(text: str, width: int, more: str) -> str:
    """What of a text below the rows stands on one line: its first parts, and where more is told."""
    more = more if text.endswith(more) else ""
    room = width - _HEADING - 4 - len(more)
    parts = text.removesuffix(more).split("; ")
    while len("; ".join(parts)) > room and len(parts) > 1:
        parts.pop()
    return textwrap.shorten("; ".join(parts), room, placeholder=" ...") + more


def _wrapped(lines: Iterable[str], width: int) -> list[str]:
    return [line for text in lines for line in textwrap.wrap(text, width, break_on_hyphens=False)]


def aligned(rows: Sequence[tuple[str, ...]], width: float) -> list[str]:
    """Return lines with the texts of rows below one another; the last text wraps in its column."""
    if not rows:
        return []
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]) - 1)]
    lines = []
    for row in rows:
        before = "  " + "".join(
            f"{text:<{size}}  " for text, size in zip(row, widths, strict=False)
        )
        room = int(min(max(width - len(before), 16), 1000))
        parts = textwrap.wrap(row[-1], room, break_on_hyphens=False, break_long_words=False) or [""]
        lines += [(before if not k else " " * len(before)) + part for k, part in enumerate(parts)]
    return [line.rstrip() for line in lines]
