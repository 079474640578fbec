"""People are told of slip and skidding in the words of the field, not in those that grew inside of the program."""

import re
from pathlib import Path

import pytest

import sentences
from dialect import OF_THE_PAPER, WORDS, dialect

pytestmark = pytest.mark.quick

#: Pages that engineers read; in theory and trust a word of the paper, or of the kernels, may be what it is about.
PAGES = ("start", "howto", "questions")


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
