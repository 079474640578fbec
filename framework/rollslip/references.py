"""References as data: publications with authors, title and place, as text and as BibTeX.

A model, an oil or a bearing names its sources in ``references``: values of `Reference`, or texts, which are printed as
they are. Publications of the framework's own laws are in ``references.bib``; a package has its own file, so that no
source is written twice. Data that could not be confirmed are named in the reference and printed with it.
"""

import abc
import re
import unicodedata
from collections.abc import Iterable, Mapping
from functools import cache
from itertools import chain, count
from pathlib import Path
from string import ascii_lowercase
from types import MappingProxyType
from typing import Any, ClassVar, Final
from urllib.parse import quote

import attrs

__all__ = [
    "BARUS",
    "EHRET",
    "KLEBANOV",
    "ROELANDS",
    "YASUTOMI",
    "Citation",
    "Reference",
    "as_bibtex",
    "as_dict",
    "from_dict",
    "read_bibliography",
    "rollslip_itself",
    "unique_works",
]

#: Kind of publication -> type of its BibTeX entry, and its field for the publisher; a remark has no entry.
_ENTRIES: Final = MappingProxyType(
    {
        "article": ("article", "publisher"),
        "book": ("book", "publisher"),
        "proceedings": ("inproceedings", "publisher"),
        "thesis": ("phdthesis", "school"),
        "report": ("techreport", "institution"),
        "standard": ("misc", "howpublished"),
        "software": ("misc", "howpublished"),
        "remark": ("", ""),
    }
)
#: Kind of publication -> required fields.
_REQUIRED: Final = MappingProxyType(
    {
        "article": ("authors", "journal", "year"),
        "book": ("authors", "publisher", "year"),
        "proceedings": ("authors", "journal", "year"),
        "thesis": ("authors", "publisher", "year"),
        "report": ("authors", "publisher", "year"),
        "standard": ("number",),
        "software": ("authors",),
        "remark": (),
    }
)
#: Title in BibTeX of a publication with an unknown title.
UNKNOWN_TITLE: Final = "[title not confirmed]"
#: Fields that may be named as not confirmed.
_CHECKABLE: Final = (
    "authors",
    "title",
    "journal",
    "volume",
    "issue",
    "pages",
    "year",
    "publisher",
    "doi",
)


@attrs.frozen(kw_only=True)
class Reference:
    """A publication.

    Parameters
    ----------
    kind : str
        article, book, proceedings (a paper in them), thesis, report, standard, software; or remark for a law without a
        publication: its title then states the basis of the law, and BibTeX does not have it.
    authors : tuple of str
        "Family name, initials" each, as printed; a name without a comma is that of an institution.
    title : str
        As printed.
    journal : str
        Journal, or the proceedings.
    volume, issue, pages : str
        Pages as "first-last", or the number of the article.
    year : int
        Of publication.
    edition, publisher, number : str
        The edition as "2nd"; publisher, university or institution; number of a report or standard, version of software.
    doi : str
        Without a resolver, as "10.3103/S1068366622010068".
    note : str
        Note for readers, such as the work through which it is cited.
    place : str
        Part of the publication, see `at`.
    unconfirmed : tuple of str
        Fields that could not be confirmed, or are unknown; they are printed with the reference.

    Raises
    ------
    ValueError
        If a value is of the wrong type, the kind is unknown, a required field is missing and not named in
        ``unconfirmed``, or the DOI is not valid.

    Examples
    --------
    >>> roelands = Reference(
    ...     kind="thesis",
    ...     authors=("Roelands, C. J. A.",),
    ...     title="Correlational aspects of the viscosity-temperature-pressure relationship of lubricating oils",
    ...     publisher="Technical University of Delft",
    ...     year=1966,
    ... )
    >>> print(roelands.at("chapter 4"))  # doctest: +NORMALIZE_WHITESPACE
    Roelands C.J.A. Correlational aspects of the viscosity-temperature-pressure relationship of lubricating oils.
    Thesis, Technical University of Delft, 1966, chapter 4.
    """

    kind: str = "article"
    authors: tuple[str, ...] = ()
    title: str = ""
    journal: str = ""
    volume: str = ""
    issue: str = ""
    pages: str = ""
    year: int | None = None
    edition: str = ""
    publisher: str = ""
    number: str = ""
    doi: str = ""
    note: str = ""
    place: str = ""
    unconfirmed: tuple[str, ...] = ()

    def __attrs_post_init__(self) -> None:
        self._check_types()
        if self.kind not in _ENTRIES:
            raise self._fault("kind", f"{self.kind!r} is not one of {', '.join(_ENTRIES)}")
        if unknown := [name for name in self.unconfirmed if name not in _CHECKABLE]:
            raise self._fault(
                "unconfirmed", f"{unknown[0]!r} is not one of {', '.join(_CHECKABLE)}"
            )
        if not self.title and "title" not in self.unconfirmed:
            raise self._fault("title", "missing; name it in unconfirmed if it cannot be found out")
        for name in _REQUIRED[self.kind]:
            if not getattr(self, name) and name not in self.unconfirmed:
                raise self._fault(
                    name,
                    f"missing, but required for kind = {self.kind!r}, or to be named in unconfirmed",
                )
        if self.doi and not re.fullmatch(r"10\.\d{4,9}/[^\s{}\\%#]+", self.doi):
            raise self._fault(
                "doi",
                f"{self.doi!r} is not a DOI such as '10.3103/S1068366622010068', without a resolver",
            )

    def _check_types(self) -> None:
        """Raise `ValueError` for a value of a wrong type."""
        for name, value in attrs.asdict(self, recurse=False).items():
            is_valid = isinstance(value, str)
            expected = "a text"
            if name in ("authors", "unconfirmed"):
                is_valid = isinstance(value, tuple) and all(isinstance(x, str) for x in value)
                expected = "a tuple of texts"
            elif name == "year":
                is_valid = value is None or (isinstance(value, int) and value > 999)
                expected = "a year such as 1992"
            if not is_valid:
                raise self._fault(name, f"must be {expected}, not {value!r}")

    def _fault(self, name: str, reason: str) -> ValueError:
        """Return the error of a field."""
        return ValueError(f"reference {self.title or self.authors!r}: {name}: {reason}")

    def at(self, place: str) -> "Reference":
        """Return the reference to a part of the publication, such as "section 2.9"."""
        return attrs.evolve(self, place=place)

    @property
    def work(self) -> "Reference":
        """The publication without the place in it, as a bibliography lists it."""
        return attrs.evolve(self, place="")

    @property
    def link(self) -> str:
        """Address of the publication, empty without a DOI."""
        return f"https://doi.org/{quote(self.doi, safe='/();:')}" if self.doi else ""

    def __str__(self) -> str:
        authors = ", ".join(map(_short, self.authors))
        title = ", ".join(filter(None, (self.title, self.edition and f"{self.edition} ed")))
        issue = f"({self.issue})" if self.issue else ""
        thesis = "Thesis" if self.kind == "thesis" else ""
        number = (
            f"Version {self.number}" if self.kind == "software" and self.number else self.number
        )
        if self.kind == "standard":
            title = ". ".join(filter(None, (self.number, title)))
            number = ""
        where = ", ".join(
            filter(
                None,
                (
                    " ".join(filter(None, (self.journal, self.volume, issue))),
                    thesis,
                    " ".join(filter(None, (self.publisher, number))),
                    str(self.year or ""),
                    self.pages,
                    self.place,
                ),
            )
        )
        notes = "; ".join(filter(None, (self.note, self._unconfirmed_text)))
        text = " ".join(f"{part.rstrip('.')}." for part in (authors, title, where) if part)
        return " ".join(
            filter(None, (text, self.doi and f"doi:{self.doi}", notes and f"({notes})"))
        )

    @property
    def _unconfirmed_text(self) -> str:
        """The fields that are not confirmed, as text; empty where all are."""
        return f"not confirmed: {', '.join(self.unconfirmed)}" if self.unconfirmed else ""


#: A source of a model, an oil or a bearing; a text is printed as it is.
Citation = Reference | str


def _read_only(values: Mapping[str, Any]) -> Mapping[str, Any]:
    return MappingProxyType(dict(values))


@attrs.frozen(kw_only=True)
class ReferenceValue:
    """A number that somebody else has printed, measured or computed, and that a model has to reproduce."""

    #: What goes in, in SI units: members of a slice, speeds of a drag or fields of a bearing's duty, by name.
    inputs: Mapping[str, Any] = attrs.field(converter=_read_only)
    #: The number, in SI units.
    value: float
    #: Relative difference that the digits of the source, or its accuracy, allow.
    rtol: float
    #: Where the number stands: citation with page, table or equation, or how it was worked out.
    source: str
    #: Column that holds the number, for laws that fill several.
    column: str = ""
    #: Parameters of the model, where they are not its defaults.
    parameters: Mapping[str, Any] = attrs.field(factory=dict, converter=_read_only)


class CitedModel(abc.ABC):
    """What each model says of itself, of whatever kind it is."""

    #: Name in scenes.
    name: ClassVar[str]
    #: The law in one line, in the symbols of its docstring.
    equation: ClassVar[str]
    #: Sources: values of `rollslip.references.Reference`, or texts, one citation each.
    references: ClassVar[tuple[Citation, ...]]
    #: Rule of the conformance kit that the model breaks for a reason -> that reason.
    expected_failures: ClassVar[Mapping[str, str]] = MappingProxyType({})
    #: Numbers of others that the conformance kit compares with those of the model.
    reference_values: ClassVar[tuple[ReferenceValue, ...]] = ()


def _short(author: str) -> str:
    """Return an author as "Family A.B."."""
    family, _, given = author.partition(", ")
    return f"{family} {given.replace('. ', '.')}" if given else family


def unique_works(citations: Iterable[Citation]) -> list[Citation]:
    """Return each work once, in the order of the first citations; works with equal DOIs are the same work."""
    works: dict[object, Citation] = {}
    for citation in citations:
        work = citation.work if isinstance(citation, Reference) else citation
        works.setdefault((isinstance(work, Reference) and work.doi.lower()) or work, work)
    return list(works.values())


# Plain values -------------------------------------------------------------------------------------------------------


def as_dict(citation: Citation) -> dict[str, Any]:
    """Return a citation as plain values: its ``text``, and the fields of a reference that are not empty."""
    if isinstance(citation, str):
        return {"text": citation}
    return {"text": str(citation)} | attrs.asdict(
        citation, filter=lambda _, value: value not in ("", (), None)
    )


def from_dict(values: Mapping[str, Any]) -> Citation:
    """Return the citation of the values of `as_dict`; its text where fields are missing or unknown to this version."""
    fields: dict[str, Any] = {
        k: tuple(value) if isinstance(value, list) else value for k, value in values.items()
    }
    text = fields.pop("text", "")
    try:
        return Reference(**fields)
    except (TypeError, ValueError):
        return str(text)


# BibTeX -------------------------------------------------------------------------------------------------------------

#: Special characters of LaTeX -> their commands; a brace would end the value of a field even if it were escaped.
_SPECIAL: Final = str.maketrans(
    {c: f"\\{c}" for c in "&%$#_"}
    | {"\\": r"{\textbackslash}", "{": r"{\textbraceleft}", "}": r"{\textbraceright}"}
    | {"~": r"{\textasciitilde}", "^": r"{\textasciicircum}"}
    | {
        "ø": r"{\o}",
        "Ø": r"{\O}",
        "ß": r"{\ss}",
        "ł": r"{\l}",
        "Ł": r"{\L}",
        "æ": r"{\ae}",
        "å": r"{\aa}",
    }
    | {"\u2013": "--", "\u2014": "---", "\u2019": "'"}  # dashes and the apostrophe of typography
)
_SPECIAL_CHARACTERS: Final = frozenset(map(chr, _SPECIAL))
#: Combining accent -> command of LaTeX.
_ACCENTS: Final = dict(zip("\u0300\u0301\u0302\u0303\u0308\u030c\u0327", "`'^~\"vc", strict=True))


def as_bibtex(citations: Iterable[Citation]) -> str:
    """Return BibTeX entries of citations, each work once: a text as ``@misc`` with a note, a remark as a comment.

    Keys are the family name of the first author and the year, with a letter where two are equal. The text is ASCII for
    LaTeX, except for letters without a command here.
    """
    entries = []
    keys = set[str]()
    for work in unique_works(citations):
        if isinstance(work, Reference) and work.kind == "remark":
            # "@" starts an entry, even in a comment
            entries.append("% " + " ".join(str(work).replace("@", " at ").split()))
            continue
        stem = _key(work)
        suffixes = chain(ascii_lowercase, map("-{}".format, count(2)))
        key = next(
            key for key in chain([stem], (stem + suffix for suffix in suffixes)) if key not in keys
        )
        keys.add(key)
        entry, fields = _entry(work)
        body = "".join(f",\n  {name} = {{{value}}}" for name, value in fields.items() if value)
        entries.append(f"@{entry}{{{key}{body}\n}}")
    return "\n\n".join(entries)


def _entry(citation: Citation) -> tuple[str, dict[str, str]]:
    """Return type and fields of the BibTeX entry of a citation."""
    if isinstance(citation, str):
        return "misc", {"key": _key(citation), "note": _latex(citation)}
    entry, publisher = _ENTRIES[citation.kind]
    version = (
        f"version {citation.number}" if citation.kind == "software" and citation.number else ""
    )
    notes = "; ".join(filter(None, (version, citation.note, citation._unconfirmed_text)))
    published = {publisher: _latex(citation.publisher)}
    if citation.kind == "standard":
        published = {"howpublished": _latex(citation.number)}
    return entry, {
        # styles sort entries without an author by their key
        "key": "" if citation.authors else _key(citation),
        "author": " and ".join(
            _latex(a) if ", " in a else f"{{{_latex(a)}}}" for a in citation.authors
        ),
        # braces preserve capitals; styles require a title
        "title": f"{{{_latex(citation.title or UNKNOWN_TITLE)}}}",
        "booktitle" if citation.kind == "proceedings" else "journal": _latex(citation.journal),
        "volume": _latex(citation.volume),
        "number": _latex(citation.issue or (citation.number if citation.kind == "report" else "")),
        "pages": _latex(re.sub(r"(?<=\d)-(?=\d)", "--", citation.pages)),
        "year": str(citation.year or ""),
        "edition": _latex(citation.edition),
        **published,
        "doi": citation.doi,  # not escaped, because styles make it a link
        "note": _latex(notes),
    }


def _key(citation: Citation) -> str:
    """Return the key of a BibTeX entry: first author, or first word, and year."""
    if isinstance(citation, str):
        who = citation
        years = re.findall(r"\b(1[89]\d\d|20\d\d)\b", citation)
        when = years[-1] if years else ""
    else:
        who = (citation.authors or (citation.number or citation.title,))[0].partition(",")[0]
        when = str(citation.year or "")
    ascii_name = (
        unicodedata.normalize("NFD", who.replace("ø", "o").replace("The ", ""))
        .encode("ascii", "ignore")
        .decode()
    )
    name_parts = re.findall("[a-z]+", ascii_name.lower())
    return (name_parts[0] if name_parts else "source") + when


def _latex(text: str) -> str:
    """Return a text for a value in braces: on one line, with escaped special characters and accents as commands."""
    letters: list[str] = []
    for letter in unicodedata.normalize("NFC", " ".join(text.split())):
        plain, *accents = list(unicodedata.normalize("NFD", letter))
        if letter not in _SPECIAL_CHARACTERS and len(accents) == 1 and accents[0] in _ACCENTS:
            letters.append(f"{{\\{_ACCENTS[accents[0]]}{{{plain}}}}}")
        else:
            letters.append(letter.translate(_SPECIAL))
    return "".join(letters)


# References of rollslip itself --------------------------------------------------------------------------------------


@cache
def rollslip_itself() -> Reference:
    """Return the reference of rollslip by the metadata of the installed package, as in ``CITATION.cff``."""
    import importlib.metadata

    about = importlib.metadata.metadata("rollslip")
    return Reference(
        kind="software",
        authors=(about["Author"],),
        title=f"rollslip: {about['Summary'][0].lower()}{about['Summary'][1:]}",
        number=about["Version"],
    )


def read_bibliography(path: Path) -> dict[str, Reference]:
    """Return the publications of a file by their keys; it has the layout of BibTeX, and the fields of `Reference`.

    Texts are plain, without braces. Authors are separated by "and", fields that are not confirmed by commas.
    """
    works = {}
    entry = re.compile(r"@(\w+)\{(\w+)((?:,\s*\w+ = \{[^{}]*\})*)\}")
    for kind, key, fields in entry.findall(path.read_text(encoding="utf-8")):
        values: dict[str, Any] = {"kind": kind}
        for name, value in re.findall(r"(\w+) = \{([^{}]*)\}", fields):
            values[name] = " ".join(value.split())
        if "year" in values:
            values["year"] = int(values["year"])
        if "unconfirmed" in values:
            values["unconfirmed"] = tuple(values["unconfirmed"].split(", "))
        if authors := values.pop("author", ""):
            values["authors"] = tuple(authors.split(" and "))
        works[key] = Reference(**values)
    return works


_OWN: Final = read_bibliography(Path(__file__).with_suffix(".bib"))
#: The paper that rollslip follows.
KLEBANOV: Final = _OWN["KLEBANOV"]
BARUS: Final = _OWN["BARUS"]
ROELANDS: Final = _OWN["ROELANDS"]
YASUTOMI: Final = _OWN["YASUTOMI"]
EHRET: Final = _OWN["EHRET"]
