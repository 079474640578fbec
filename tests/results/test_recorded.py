"""What is said and drawn of stored results is what was read."""

import pytest

import recorded
from rollslip.catalogue.registry import available


@pytest.mark.parametrize("name", [*recorded.RESULTS, *recorded.TEXTS])
def test_a_stored_result_is_told_and_drawn_as_recorded(name):
    """Read the difference; then write the text anew by: python tests/support/recorded.py NAME."""
    text = (recorded.STORED / f"{name}.txt").read_text(encoding="utf-8")
    assert recorded.text_of(name).splitlines() == text.splitlines()


def test_every_account_of_the_box_has_a_stored_result():
    told = {recorded.stored(name).attrs["study"] for name in recorded.RESULTS}
    assert told == {*available("account")}
