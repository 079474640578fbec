"""Names of the product are terms of the field, not words that only this project uses."""

import keyword
import tokenize

import pytest

import legibility

pytestmark = pytest.mark.quick

#: Names of Python, of libraries and of methods that contain a private word by accident; an option of `rollslip limit`.
ALLOWED = {
    "LeastSquaresEstimate", "break_long_words", "keep", "least_squares", "one_of", "ones", "ones_like",
}  # fmt: skip


def private_names(path):
    """Yield the private identifiers of a module with their lines."""
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            name = token.string
            is_name = token.type == tokenize.NAME and not keyword.iskeyword(name)
            if is_name and name not in ALLOWED and legibility.is_private(name):
                yield f"{path.name}:{token.start[0]}: {name}"


def test_a_private_word_is_found_in_a_name(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("told = 1\nones = [told]\nslip = 2\n")
    assert [*private_names(path)] == ["module.py:1: told", "module.py:2: told"]


def test_no_name_of_the_product_has_a_private_word():
    root = legibility.REPOSITORY
    paths = [
        path
        for place in legibility.PRODUCT
        for path in sorted((root / legibility.ROOTS[place]).rglob("*.py"))
    ]
    found = [name for path in paths for name in private_names(path)]
    assert found == []
    assert len(paths) > 300
