"""What to cite, as data: publications with authors, title and place, how they read, and their BibTeX.

A model, an oil or a bearing names its sources in ``references``: values of `Reference`, or texts, which are told as
they are. Those of the framework's own laws stand in ``references.bib``; packages keep theirs in one place too, so that
no source is written twice. What could not be confirmed is named in the reference and told with it.
"""

import re
import unicodedata
from collections.abc import Iterable, Mapping
from functools import cache
from itertools import chain, count
from pathlib import Path
from string import ascii_lowercase
from types import MappingProxyType
from typing import Any, Final
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
    "once",
    "published",
    "rollslip_itself",
]

#: Kind of publication -> type of its BibTeX entry, and where that keeps who published it; a remark is none.
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
#: What a kind cannot do without: BibTeX and readers miss it.
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
#: What stands in BibTeX for a title that nobody could find out.
UNKNOWN_TITLE: Final = "[title not confirmed]"
#: What can be found out about a publication and may have stayed open.
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
        article, book, proceedings (a paper in them), thesis, report, standard, software; or remark, where a law has no
        publication behind it: the title then says what it rests on, and BibTeX leaves it out.
    authors : tuple of str
        "Family name, initials" each, as printed; a name without a comma is that of a body.
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
        What a reader has to know, such as through whom it is cited.
    place : str
        What part of it is meant, see `at`.
    unconfirmed : tuple of str
        Which of these could not be confirmed, or not be found out: it is told wherever the reference is.

    Raises
    ------
    ValueError
        If a value is of the wrong type, the kind is unknown, something that it cannot do without is missing and not
        named in ``unconfirmed``, or the DOI is none.

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
        for name, value in attrs.asdict(self, recurse=False).items():
            if name in ("authors", "unconfirmed"):
                fits = isinstance(value, tuple) and all(isinstance(one, str) for one in value)
                wanted = "a tuple of texts"
            elif name == "year":
                fits = value is None or (isinstance(value, int) and value > 999)
                wanted = "a year such as 1992"
            else:
                fits = isinstance(value, str)
                wanted = "a text"
            if not fits:
                raise self._fault(name, f"must be {wanted}, not {value!r}")
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
                f"{self.doi!r} is no DOI such as '10.3103/S1068366622010068', without a resolver",
            )

    def _fault(self, name: str, reason: str) -> ValueError:
        return ValueError(f"reference {self.title or self.authors!r}: {name}: {reason}")

    def at(self, place: str) -> "Reference":
        """Return the reference to a part of the publication, such as "section 2.9"."""
        return attrs.evolve(self, place=place)

    @property
    def work(self) -> "Reference":
        """The publication as a whole, which a bibliography lists."""
        return attrs.evolve(self, place="")

    @property
    def link(self) -> str:
        """Address under which it is found, empty without a DOI."""
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
        open_ = f"not confirmed: {', '.join(self.unconfirmed)}" if self.unconfirmed else ""
        notes = "; ".join(filter(None, (self.note, open_)))
        text = " ".join(f"{part.rstrip('.')}." for part in (authors, title, where) if part)
        return " ".join(
            filter(None, (text, self.doi and f"doi:{self.doi}", notes and f"({notes})"))
        )


#: What a package may name as a source; a text is told as it is.
Citation = Reference | str


def _short(author: str) -> str:
    family, _, given = author.partition(", ")
    return f"{family} {given.replace('. ', '.')}" if given else family


def once(citations: Iterable[Citation]) -> list[Citation]:
    """Return each work once, in the order of their first appearance; works are the same if they or their DOIs are."""
    works: dict[object, Citation] = {}
    for one in citations:
        work = one.work if isinstance(one, Reference) else one
        works.setdefault((isinstance(work, Reference) and work.doi.lower()) or work, work)
    return list(works.values())


# Plain values -------------------------------------------------------------------------------------------------------


def as_dict(citation: Citation) -> dict[str, Any]:
    """Return a citation as plain values: ``text`` as it reads, and what is known of a reference."""
    if isinstance(citation, str):
        return {"text": citation}
    return {"text": str(citation)} | attrs.asdict(
        citation, filter=lambda _, value: value not in ("", (), None)
    )


def from_dict(values: Mapping[str, Any]) -> Citation:
    """Return the citation that `as_dict` told; the text where there is no more, or more than this version knows."""
    known: dict[str, Any] = {
        k: tuple(value) if isinstance(value, list) else value for k, value in values.items()
    }
    text = known.pop("text", "")
    try:
        return Reference(**known)
    except (TypeError, ValueError):
        return str(text)


# BibTeX -------------------------------------------------------------------------------------------------------------

#: Characters that LaTeX reads as its own; a brace would end the value, escaped or not.
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
_NAMED: Final = frozenset(map(chr, _SPECIAL))
#: Combining accents -> command of LaTeX.
_ACCENTS: Final = dict(zip("\u0300\u0301\u0302\u0303\u0308\u030c\u0327", "`'^~\"vc", strict=True))


def as_bibtex(citations: Iterable[Citation]) -> str:
    """Return BibTeX entries of citations, each work once: a text as ``@misc`` with a note, a remark as a comment.

    Keys are the first author's family name with the year, and a letter where two have the same. All is ASCII that LaTeX
    can set, but for letters that have no command here.
    """
    entries = []
    keys = set[str]()
    for one in once(citations):
        if isinstance(one, Reference) and one.kind == "remark":
            entries.append(
                "% " + " ".join(str(one).replace("@", " at ").split())
            )  # "@" begins an entry anywhere
            continue
        stem = _key(one)
        others = chain(ascii_lowercase, map("-{}".format, count(2)))
        key = next(
            key for key in chain([stem], (stem + other for other in others)) if key not in keys
        )
        keys.add(key)
        entry, fields = _entry(one)
        body = "".join(f",\n  {name} = {{{value}}}" for name, value in fields.items() if value)
        entries.append(f"@{entry}{{{key}{body}\n}}")
    return "\n\n".join(entries)


def _entry(citation: Citation) -> tuple[str, dict[str, str]]:
    """Return type and fields of an entry."""
    if isinstance(citation, str):
        return "misc", {"key": _key(citation), "note": _latex(citation)}
    entry, publisher = _ENTRIES[citation.kind]
    open_ = f"not confirmed: {', '.join(citation.unconfirmed)}" if citation.unconfirmed else ""
    version = (
        f"version {citation.number}" if citation.kind == "software" and citation.number else ""
    )
    notes = "; ".join(filter(None, (version, citation.note, open_)))
    published = {publisher: _latex(citation.publisher)}
    if citation.kind == "standard":
        published = {"howpublished": _latex(citation.number)}
    return entry, {
        "key": ""
        if citation.authors
        else _key(citation),  # by which styles sort what has no author
        "author": " and ".join(
            _latex(a) if ", " in a else f"{{{_latex(a)}}}" for a in citation.authors
        ),
        # in braces its capitals stay; styles set no entry without one
        "title": f"{{{_latex(citation.title or UNKNOWN_TITLE)}}}",
        "booktitle" if citation.kind == "proceedings" else "journal": _latex(citation.journal),
        "volume": _latex(citation.volume),
        "number": _latex(citation.issue or (citation.number if citation.kind == "report" else "")),
        "pages": _latex(re.sub(r"(?<=\d)-(?=\d)", "--", citation.pages)),
        "year": str(citation.year or ""),
        "edition": _latex(citation.edition),
        **published,
        "doi": citation.doi,  # as it is: styles make a link of it
        "note": _latex(notes),
    }


def _key(citation: Citation) -> str:
    if isinstance(citation, str):
        who = citation
        years = re.findall(r"\b(1[89]\d\d|20\d\d)\b", citation)
        when = years[-1] if years else ""
    else:
        who = (citation.authors or (citation.number or citation.title,))[0].partition(",")[0]
        when = str(citation.year or "")
    plain = (
        unicodedata.normalize("NFD", who.replace("ø", "o").replace("The ", ""))
        .encode("ascii", "ignore")
        .decode()
    )
    words = re.findall("[a-z]+", plain.lower())
    return (words[0] if words else "source") + when


def _latex(text: str) -> str:
    """Return a text for a value in braces: on one line, with LaTeX's characters escaped, accents as its commands."""
    letters: list[str] = []
    for letter in unicodedata.normalize("NFC", " ".join(text.split())):
        plain, *accents = list(unicodedata.normalize("NFD", letter))
        if letter not in _NAMED and len(accents) == 1 and accents[0] in _ACCENTS:
            letters.append(f"{{\\{_ACCENTS[accents[0]]}{{{plain}}}}}")
        else:
            letters.append(letter.translate(_SPECIAL))
    return "".join(letters)


# What rollslip itself rests on --------------------------------------------------------------------------------------


@cache
def rollslip_itself() -> Reference:
    """Return how rollslip is cited, from the metadata of what is installed; ``CITATION.cff`` says the same."""
    import importlib.metadata

    about = importlib.metadata.metadata("rollslip")
    return Reference(
        kind="software",
        authors=(about["Author"],),
        title=f"rollslip: {about['Summary'][0].lower()}{about['Summary'][1:]}",
        number=about["Version"],
    )


def published(path: Path) -> dict[str, Reference]:
    """Return the publications of a file by their keys; the file has BibTeX's layout, `Reference` its kinds and fields.

    Texts are plain, without braces; "and" stands between authors, a comma between what is not confirmed.
    """
    found = {}
    entry = re.compile(r"@(\w+)\{(\w+)((?:,\s*\w+ = \{[^{}]*\})*)\}")
    for kind, key, fields in entry.findall(path.read_text(encoding="utf-8")):
        told: dict[str, Any] = {"kind": kind}
        for name, value in re.findall(r"(\w+) = \{([^{}]*)\}", fields):
            text = " ".join(value.split())
            told[name] = (
                int(text)
                if name == "year"
                else tuple(text.split(", "))
                if name == "unconfirmed"
                else text
            )
        if authors := told.pop("author", ""):
            told["authors"] = tuple(authors.split(" and "))
        found[key] = Reference(**told)
    return found


_OWN: Final = published(Path(__file__).with_suffix(".bib"))
#: The paper that rollslip follows.
KLEBANOV: Final = _OWN["KLEBANOV"]
BARUS: Final = _OWN["BARUS"]
ROELANDS: Final = _OWN["ROELANDS"]
YASUTOMI: Final = _OWN["YASUTOMI"]
EHRET: Final = _OWN["EHRET"]
