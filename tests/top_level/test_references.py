"""What is cited: how it reads, what it refuses, BibTeX as another program reads it, and what the box says of itself."""

import codecs
import json
import re
import tomllib
from pathlib import Path

import attrs
import latexcodec  # noqa: F401 - of pybtex: registers the codec
import pybtex
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from pybtex.database import parse_string

import rollslip_plugins.bibliography as plugins_bibliography
from architecture import ROOT
from rollslip import references
from rollslip.catalogue.discovery import available, families, get_class
from rollslip.catalogue.kinds import kinds
from rollslip.references import (
    KLEBANOV,
    Citation,
    Reference,
    as_bibtex,
    as_dict,
    from_dict,
    read_bibliography,
    rollslip_itself,
    unique_works,
)
from rollslip.results.dataset import citations_of
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi

pytestmark = pytest.mark.quick

#: All that is written down, by its name.
FILES = [Path(module.__file__).with_suffix(".bib") for module in (references, plugins_bibliography)]
WRITTEN = {
    f"{path.stem}.{key}": one for path in FILES for key, one in read_bibliography(path).items()
}
#: What LaTeX would take for its own, and letters that it has commands for.
AWKWARD = Reference(
    authors=("Nørsett, S. P.", "Müller & Söhne", "Šá Ç, X."),
    title="50 % of {A_1} ~ \\alpha^2 $x$ #3 – Straße",
    journal='J. "Q" @ Łódź',
    year=1999,
    pages="1-2",
)
#: What the decoder leaves as it is.
COMMANDS = {
    r"\$": "$", r"\textbraceleft": "{", r"\textbraceright": "}", r"\textasciicircum": "^", r"\textbackslash": "\\",
    r"\textasciitilde": "~",
}  # fmt: skip


def read(text: str):
    """The entries of BibTeX as pybtex reads them; it raises where it would be in doubt."""
    return parse_string(text, "bibtex").entries


def plain(value: str) -> str:
    """What LaTeX makes of a value."""
    text = codecs.decode(value, "ulatex").replace("{", "").replace("}", "")
    for command, letter in COMMANDS.items():
        text = re.sub(
            re.escape(command) + " ?" * command[-1].isalpha(), letter.replace("\\", r"\\"), text
        )
    return text


# How it reads -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (
            {"authors": ("Abel, A. B.", "Cole, C."), "title": "On it", "journal": "J. It", "volume": "2", "issue": "3",
             "pages": "4-5", "year": 1999, "doi": "10.1234/x(1)"},
            "Abel A.B., Cole C. On it. J. It 2 (3), 1999, 4-5. doi:10.1234/x(1)",
        ),
        (
            {"kind": "book", "authors": ("Abel, A.",), "title": "It", "edition": "2nd", "publisher": "P", "year": 1999,
             "place": "section 3"},
            "Abel A. It, 2nd ed. P, 1999, section 3.",
        ),
        (
            {"kind": "proceedings", "authors": ("Abel, A.",), "title": "It", "journal": "Proc. Its", "year": 1999,
             "unconfirmed": ("pages", "publisher")},
            "Abel A. It. Proc. Its, 1999. (not confirmed: pages, publisher)",
        ),
        (
            {"kind": "thesis", "authors": ("Abel, A.",), "title": "It", "publisher": "Delft", "year": 1999},
            "Abel A. It. Thesis, Delft, 1999.",
        ),
        (
            {"kind": "report", "authors": ("Abel, A.",), "title": "It", "publisher": "NASA", "number": "7",
             "year": 1999, "note": "in two parts"},
            "Abel A. It. NASA 7, 1999. (in two parts)",
        ),
        ({"kind": "standard", "title": "Its", "number": "ISO 1:2000"}, "ISO 1:2000. Its."),
        ({"kind": "software", "authors": ("The it developers",), "title": "it", "number": "1.2"},
         "The it developers. it. Version 1.2."),
        ({"kind": "remark", "title": "No law."}, "No law."),
        (
            {"authors": ("Abel, A.",), "title": "", "journal": "J. It", "year": 1999, "note": "through Cole",
             "unconfirmed": ("title",)},
            "Abel A. J. It, 1999. (through Cole; not confirmed: title)",
        ),
    ],
    ids=lambda one: one.get("kind", "article") if isinstance(one, dict) else "",
)  # fmt: skip
def test_a_reference_reads_as_a_citation(values, text):
    assert str(Reference(**values)) == text


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"kind": "artcle"}, "kind: 'artcle' is not one of article,"),
        ({"kind": 3}, "kind: must be a text, not 3"),
        ({"authors": "Abel, A."}, "authors: must be a tuple of texts, not 'Abel, A.'"),
        ({"authors": ("Abel, A.", 2)}, "authors: must be a tuple of texts"),
        ({"authors": ()}, "authors: missing, but required for kind = 'article'"),
        ({"volume": 11}, "volume: must be a text, not 11"),
        ({"year": "1999"}, "year: must be a year such as 1992, not '1999'"),
        ({"year": 99}, "year: must be a year such as 1992, not 99"),
        ({"year": None}, "year: missing, but required .* or to be named in unconfirmed"),
        ({"title": ""}, "title: missing; name it in unconfirmed"),
        ({"journal": ""}, "journal: missing, but required"),
        ({"kind": "book", "publisher": ""}, "publisher: missing, but required for kind = 'book'"),
        ({"unconfirmed": ("page",)}, "unconfirmed: 'page' is not one of authors, title"),
        (
            {"doi": "https://doi.org/10.1234/x"},
            "doi: .* is not a DOI such as .* without a resolver",
        ),
        ({"doi": "10.1234/a}b"}, "doi: .* is not a DOI"),
    ],
)
def test_what_is_no_reference_is_refused(changes, says):
    values = {"authors": ("Abel, A.",), "title": "It", "journal": "J. It", "year": 1999}
    Reference(**values)
    with pytest.raises(ValueError, match=says):
        Reference(**values | changes)


def test_a_work_is_listed_once_whatever_its_place_and_whoever_wrote_it_down():
    book = plugins_bibliography.HAIRER_1996
    other = attrs.evolve(book, title="The same by another hand", doi=book.doi.upper())
    assert unique_works([book.at("section 1"), "a text", other, book, "a text", KLEBANOV]) == [
        book,
        "a text",
        KLEBANOV,
    ]
    assert str(book.at("section 1")).count("section 1") == 1


# Data ---------------------------------------------------------------------------------------------------------------


def test_plain_values_come_back_as_they_were():
    for one in (*WRITTEN.values(), AWKWARD, rollslip_itself(), "A text of a stranger, 2001."):
        values = json.loads(json.dumps(as_dict(one)))
        assert values["text"] == str(one)
        assert from_dict(values) == one


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_entry_of_a_file_is_read(path):
    text = path.read_text(encoding="utf-8")
    assert (
        len(read_bibliography(path))
        == len(re.findall(r"^@", text, re.MULTILINE))
        == text.count("@")
    )


def test_what_a_later_version_knows_is_told_as_text():
    later = as_dict(KLEBANOV) | {"arxiv": "1234.5678"}
    assert from_dict(later) == str(KLEBANOV)


def test_a_result_of_before_tells_its_texts():
    older = xr.Dataset(attrs={"citations": json.dumps(["A text.", "Another."])})
    newer = xr.Dataset(
        attrs={"citations": json.dumps(["x"]), "bibliography": json.dumps([as_dict(KLEBANOV)])}
    )
    assert citations_of(older, newer, older) == ["A text.", "Another.", KLEBANOV]
    assert citations_of(xr.Dataset()) == []


# BibTeX -------------------------------------------------------------------------------------------------------------


def unlike(one):
    """Return the fields that another program reads otherwise than they were written."""
    ((_, entry),) = read(as_bibtex([one])).items()
    f = {name: plain(value) for name, value in entry.fields.items()}
    people = [
        " ".join(map(plain, (*p.prelast_names, *p.last_names)))
        + (", " + " ".join(map(plain, (*p.first_names, *p.middle_names))) if p.first_names else "")
        for p in entry.persons.get("author", ())
    ]
    said = " ".join(f.values())
    alike = {
        "authors": people == list(one.authors),
        "title": f["title"] == (one.title or "[title not confirmed]"),
        "journal": f.get("journal", f.get("booktitle", "")) == one.journal,
        "year": f.get("year", "") == str(one.year or ""),
        "pages": f.get("pages", "").replace("–", "-") == one.pages,
        "doi": entry.fields.get("doi", "") == one.doi,
        "unconfirmed": all(open_ in f["note"] for open_ in one.unconfirmed),
        "ascii": as_bibtex([one]).isascii(),
    }
    others = ("volume", "issue", "edition", "publisher", "number", "note")
    return [name for name in alike if not alike[name]] + [
        name for name in others if getattr(one, name) not in said
    ]


def test_another_program_reads_of_an_entry_what_was_written():
    assert {
        str(one): unlike(one)
        for one in (*WRITTEN.values(), AWKWARD, rollslip_itself())
        if unlike(one)
    } == {}


@pytest.mark.parametrize("style", ["plain", "alpha"])
def test_styles_set_every_entry(style):
    """They refuse an entry that lacks what its kind needs."""
    texts = ["A text of a stranger, 2001.", "Another"]
    found = as_bibtex([*WRITTEN.values(), AWKWARD, rollslip_itself(), *texts])
    page = pybtex.format_from_string(found, style=style, output_backend="plaintext")
    assert len(page.strip().splitlines()) == len(WRITTEN) + 4
    assert "Slip in roller bearings under hydrodynamic contact friction" in page


def test_keys_are_names_with_years_and_differ():
    other = attrs.evolve(KLEBANOV, doi="10.1234/other")
    entries = read(as_bibtex([KLEBANOV, other, "Klebanov and nobody, 2022.", "?", "?!", KLEBANOV]))
    assert list(entries) == ["klebanov2022", "klebanov2022a", "klebanov2022b", "source", "sourcea"]
    many = [attrs.evolve(KLEBANOV, doi=f"10.1234/{n}") for n in range(60)]
    assert len(read(as_bibtex(many))) == 60


def test_a_remark_is_no_entry_and_a_text_is_one():
    remark = Reference(kind="remark", title="No law: a number @misc{x, given}")
    found = as_bibtex([remark, "Abel A. & Cole C. On 50 % of it. 2001."])
    assert found.startswith("% No law")
    ((key, entry),) = read(found).items()
    assert (key, entry.type) == ("abel2001", "misc")
    assert plain(entry.fields["note"]) == "Abel A. & Cole C. On 50 % of it. 2001."


@given(st.lists(st.text(min_size=1), max_size=4, unique=True))
def test_any_texts_make_as_many_entries(texts):
    assert len(read(as_bibtex([*texts, KLEBANOV]))) == len(texts) + 1


# What the box says --------------------------------------------------------------------------------------------------


def cited_in_the_box() -> dict[str, tuple[Citation, ...]]:
    """What everything that comes with rollslip names, by its kind and name."""
    laws = {law.name: law.references for law in (Barus, Roelands, Yasutomi)}
    offered = {
        f"{kind} {name}": get_class(kind, name).references
        for kind in kinds()
        if kind != "measurement"  # a data set is a folder that is handed on, and cites by itself
        for name, offer in available(kind).items()
        if offer.package == "rollslip" and getattr(get_class(kind, name), "references", ())
    }
    members = {
        f"{kind} {family.names[0]}": family[family.names[0]].references
        for kind in kinds()
        for _, family in families(kind)
    }
    return laws | offered | members


def test_all_in_the_box_cite_from_the_bibliographies():
    found = cited_in_the_box()
    assert len(found) > 40
    known = set(WRITTEN.values())
    loose = {
        what: [str(one) for one in named if not isinstance(one, Reference) or one.work not in known]
        for what, named in found.items()
    }
    loose = {what: [text for text in texts if text not in REMARKS] for what, texts in loose.items()}
    assert {what: texts for what, texts in loose.items() if texts} == {}
    used = {one.work for named in found.values() for one in named if isinstance(one, Reference)}
    assert [str(one) for one in known - used] == []  # nothing is written down for nobody


#: What stands for a source where there is no publication.
REMARKS = {
    "No law: the ring keeps its shape.",
    "The finite-element model that gave the matrix.",
    "Derived from the momentum of each roller: docs/theory/motion.rst. Friction is that of the boundary law of "
    "raceways where nothing but sliding is left.",
    "No law: a number that is given, made smooth where the cage stands.",
    "No law: a number that is given, made smooth where the rib does not slide. Default 0.05 (D): between SKF's 0.02 of "
    "full films (B) and boundary friction, 0.1 (B).",
    "Coulomb friction, regularised by a linear ramp.",
    "No law: the temperatures of the scene.",
    "The measurement that the file holds, as its own comments cite it.",
    "SKF. General catalogue 6000 (2006), pages 88 to 101, tables 1, 2a, 3c and 5: model of the friction torque.",
    "SKF. General catalogue 6000 (2006), friction of bearings, table 4: exponent and constants of the friction of "
    "seals, recalled (C).",
    "SKF. Rolling bearings, catalogues from 2012 on: drag losses of the model of the friction torque, recalled "
    "(C) and found alike in two open programs, but for the diagram of the losses by the level of oil.",
}


def test_no_publication_is_written_down_twice():
    assert len(unique_works(WRITTEN.values())) == len(WRITTEN)
    titles = [one.title.lower() for one in WRITTEN.values() if one.title]
    assert len(set(titles)) == len(titles)


def test_data_name_a_publication_as_the_bibliographies_do():
    known = {
        (one.authors[0].partition(",")[0], str(one.year)): str(one)
        for one in WRITTEN.values()
        if one.authors
    }
    for file in Path(plugins_bibliography.__file__).parent.glob(
        "data/measurements/*/measurement.toml"
    ):
        for text in tomllib.loads(file.read_text(encoding="utf-8"))["source"]["references"]:
            same = [
                one
                for (who, year), one in known.items()
                if str(text).startswith(f"{who} ") and f" {year}," in text
            ]
            assert same in ([], [text])


def test_what_an_article_lacks_is_said():
    expected = {"article": ("volume", "pages"), "proceedings": ("pages",)}
    lacking = [
        (str(one), name)
        for one in WRITTEN.values()
        for name in expected.get(one.kind, ())
        if not getattr(one, name) and name not in one.unconfirmed
    ]
    assert lacking == []


#: As the paper prints itself and its list of references; the last as its publisher does, under the address beside it.
AS_PRINTED = {
    "KLEBANOV": ("Klebanov, I. M.; Polyakov, K. A.; Petrov, V. R.; Pankratova, N. A.", "J. Frict. Wear", "43", "", ""),
    "MURAKI_1987": ("Muraki, M.", "Tribol. Int.", "20", "6", "347-354"),
    "MURAKI_1992": ("Muraki, M.", "J. Synth. Lubr.", "9", "1", "29-43"),
    "SAKAGUCHI_2003": ("Sakaguchi, T.; Ueno, K.", "NTN Tech. Rev.", "71", "", "8-17"),
    # https://doi.org/10.3390/lubricants11090369
    "WINGERTSZAHN_2023": (
        "Wingertszahn, P.; Koch, O.; Maccioni, L.; Concli, F.; Sauer, B.", "Lubricants", "11", "9", "369",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", AS_PRINTED)
def test_sources_that_were_wrong_or_short_are_as_printed(name):
    one = next(one for known, one in WRITTEN.items() if known.endswith(f".{name}"))
    assert ("; ".join(one.authors), one.journal, one.volume, one.issue, one.pages) == AS_PRINTED[
        name
    ]
    assert not {"authors", "journal", "volume", "year"} & set(one.unconfirmed)


def test_rollslip_is_cited_as_its_citation_file_says():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    own, paper = text.split("\nreferences:")
    itself = rollslip_itself()
    assert re.findall(r'^title: "(.*)"', own, re.MULTILINE) == [itself.title]
    assert re.findall(r"^version: (\S+)", own, re.MULTILINE) == [itself.number]
    assert re.findall(r"- name: (.*)", own) == list(itself.authors)
    names = zip(
        re.findall(r"family-names: (.*)", paper),
        re.findall(r"given-names: (.*)", paper),
        strict=True,
    )
    assert tuple(", ".join(pair) for pair in names) == KLEBANOV.authors
    assert re.findall(r" title: (.*)", paper)[0].lower() == KLEBANOV.title.lower()
    assert re.findall(r"doi: (\S+)", paper) == [KLEBANOV.doi]
    assert re.findall(r"year: (\d+)", paper) == [str(KLEBANOV.year)]
