"""Notes of an answer: laws outside their range, by what that does to the result.

What the law that a bound names instead makes of slip, reserve and torque stands in attribute ``consequences`` of a
result. Without it notes are ranked by what the bounds' own data say.
"""

import json
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import attrs

from rollslip.results.curves import or_none
from rollslip.results.words import percent, two

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Note", "counted_notes", "notes_of"]

#: Slip [1] below which a change of it matters to nobody, change that is none, and one that is told on its own.
_SMALL, _NOTHING, _MUCH = 0.005, 0.01, 0.1
#: Most notes that are told on their own, and changes below which the others are told.
_FEW, _STEPS = 2, (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0)
_Moved = Mapping[str, tuple[float, float]]


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
        found = {name: _change(*ends) for name, ends in (self.moved or {}).items() if _matters(name, *ends)}
        name = "slip" if found.get("slip", 0.0) > _MUCH else max(found, key=lambda one: found[one], default="")
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
                for name, (before, after) in self.moved.items() if _change(before, after) >= _NOTHING]  # fmt: skip
        return f"with {self.instead} {', '.join(ends) or 'slip, reserve and torque move by less than 1 %'}"

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON has it, what it moves in SI units."""
        moved = None if self.moved is None else {name: [*map(or_none, ends)] for name, ends in self.moved.items()}
        return {"code": self.code, "short": self.short, "text": self.text, "weight": self.weight,
                "instead": self.instead, "moved": moved}  # fmt: skip


def _change(before: float, after: float) -> float:
    return abs(after / before - 1.0) if math.isfinite(after) else math.inf


def _matters(name: str, before: float, after: float) -> bool:
    return max(before, after) >= _SMALL if name == "slip" else before > 0.0


def _shown(name: str, value: float) -> str:
    if name == "slip":
        return f"slip {percent(value)}" if math.isfinite(value) else "it skids"
    return f"{name} {two(value) if value > 0.0 else 'none'}" + " N m" * (name == "friction torque")


def counted_notes(notes: Iterable[Note], more: str = "-v") -> str:
    """Say what the laws outside their range do to the result, the worst first; ``more`` is where all are told."""
    every = list(notes)
    if all(note.moved is None for note in every):
        codes = list(dict.fromkeys(note.code or note.short for note in every))
        return f"{len(codes)} on laws outside their range: {' '.join(codes)} ({more})" if codes else ""
    moving = [note for note in every if note.most[1] >= _NOTHING]
    first = [note for note in moving if note.most[1] > _MUCH][:_FEW]
    rest = moving[len(first) :]
    said = [note.told for note in first]
    if rest:
        most = max(note.most[1] for note in rest)
        limit = next((f"{100.0 * step:g} %" for step in _STEPS if most <= step), "a factor of 2")
        of = " or ".join(sorted({note.most[0] for note in rest}))
        alone = f"{rest[0].code} moves the {of} by up to {limit}"
        none = alone if len(rest) == 1 else f"{len(rest)}, none of which moves the {of} by more than {limit}"
        said.append(f"{len(rest)} more below {limit}" if first else none)
    unknown = [note.code or note.short for note in every if note.moved is None]
    said += [f"{' '.join(unknown)} not evaluated"] if unknown else []
    return f"{'; '.join(said) or 'none moves slip or torque by 1 %'} ({more})" if every else ""


def notes_of(datasets: "Iterable[xr.Dataset]") -> tuple[Note, ...]:
    """Return the laws that results left, each once and where its consequence is largest, the worst first."""
    found, every = dict[str, tuple[tuple[bool, float], Note]](), list(datasets)
    at: dict[str, dict[str, Any]] = {
        row["code"]: row for one in every for row in json.loads(one.attrs.get("consequences", "[]"))
    }
    for dataset in every:
        judged = json.loads(dataset.attrs["validity"]) if dataset.attrs.get("validity") else {}
        for one in judged.get("told", []):
            code = one.get("code", "")
            row = at.get(code, {"moved": {}} if at else {})
            moved = row.get("moved")
            if moved is not None:
                moved = {name: (first, math.inf if last is None else last) for name, (first, last) in moved.items()}
            note = Note(code=code, short=one["short"], text=one["text"], weight=one["weight"],
                        instead=row.get("instead", ""), moved=moved)  # fmt: skip
            key, rank = code or f"{one['law']} {one['made_for']}", (one["warned"], one["weight"])
            if key not in found or rank > found[key][0]:
                found[key] = rank, note
    ranked = sorted(found.values(), key=lambda each: each[0], reverse=True)
    return tuple(note for _, note in sorted(ranked, key=lambda each: -_rank(each[1])))


def _rank(note: Note) -> float:
    """By what a note stands: what it moves, those that were not evaluated behind those that move something."""
    most = note.most[1]
    return most if most >= _NOTHING else 0.5 * _NOTHING if note.moved is None else 0.0
