"""People are told of slip and skidding in the words of the field, not in those that grew inside of the program."""

import re
from pathlib import Path

import pytest

import sentences

pytestmark = pytest.mark.quick

#: What is not said -> what is said instead.
WORDS = {
    r"\b(the|a|no) cage (runs|run|ran) away|\brunning away\b|\bnothing runs away\b": "skidding",
    r"could carry .* times the drag": "drag reserve",
    r"\bleast (radial )?loads?\b": "minimum load",
    r"\bmakers? (of bearings )?asks? for": "catalogue minimum load",
    r"both rings pull alike|at their epicyclic spin": "balance of moments; pure rolling",
    r"\bcritical (cage )?slips?\b": "slip at largest traction",
    r"how far to trust|\bnot told here\b": "confidence",
    r"\b(was|were|are) made for\b": "valid for",
    r"100 % of the contact force": "all loaded contacts",
    r"\bheld against\b": "checked against",
    r"\bgrades? [A-D]\b": "data quality",
    r"\binstants (of a|within a roller) pitch\b": "roller positions",
    r"\blaminae?\b": "slices",
    r"\bcannot be told\b|\bpoints (were )?judged\b": "determined; checked",
    r"\bgoes one way\b|\bspeaks? for\b": "is monotonic; suggests",
}
#: Names in results and keys, which stay, and what authors of packages read; as they do kernels' errors.
STAYS = {"critical slip", "critical slip{label}", "closure: what the rollers spin at"}
#: Pages that engineers read; in theory and trust a word of the paper, or of the kernels, may be what it is about.
PAGES = ("start", "howto", "questions")
#: Words that a page may use, as it says what they mean: the paper's.
OF_THE_PAPER = r"\bcritical (cage )?slips?\b"


def dialect(text, words=WORDS):
    """What a text should not say, without its gaps, its comments and names as they are typed."""
    bare = re.sub(r"\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}|``[^`]*``", " ", " ".join(text.split()))
    return [found[0] for word in words for found in re.finditer(word, bare, re.IGNORECASE)]


def test_no_sentence_of_the_program_says_what_only_its_authors_would():
    every = [one for one in sentences.sentences() if not one.module.startswith("rollslip_kernels")]
    told = [one for one in every if one.kind != "source" and one.text not in STAYS]
    assert [(one.module, one.text, wrong) for one in told if (wrong := dialect(one.text))] == []
    assert len(told) > 3000


@pytest.mark.parametrize("page", [page for name in PAGES for page in sorted((sentences.ROOT / "docs" / name).rglob("*"))
                                  if page.suffix in (".rst", ".py")], ids=lambda page: page.stem)  # fmt: skip
def test_no_page_says_it_either(page: Path):
    assert dialect(page.read_text(encoding="utf-8"), WORDS.keys() - {OF_THE_PAPER}) == []


def test_no_figure_of_the_pages_says_it_either():
    figures = sorted((sentences.ROOT / "docs" / "figures").glob("*.svg"))
    texts = {
        path.name: re.findall(
            r">([^<>]+)</(?:text|tspan)>",
            path.read_text(encoding="utf-8"),
        )
        for path in figures
    }
    assert sum(map(bool, texts.values())) > 5
    wrong = {
        name: found
        for name, said in texts.items()
        if (found := dialect(" ".join(said), WORDS.keys() - {OF_THE_PAPER}))
    }
    assert wrong == {}


def test_dialect_is_found_and_keys_are_not():
    assert dialect("The cage runs away at 5 %") == ["The cage runs away"]
    assert dialect("100 % of the contact force is outside, what it was made for") == [
        "was made for", "100 % of the contact force"
    ]  # fmt: skip
    assert (
        dialect("``skidding_slip`` of {least load} in the runaway of the bulk; {a:.{b}f} slices")
        == []
    )
