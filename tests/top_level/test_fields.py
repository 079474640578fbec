"""Validators of fields."""

import math
import pickle
from typing import Any

import attrs
import pytest

from rollslip.fields import (
    FieldError,
    at_least,
    choice_of,
    in_range,
    non_negative,
    parameter,
    positive,
)

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("validator", "value", "message"),
    [
        (positive, 0.0, "x: must be above 0, not 0 Pa"),
        (non_negative, -1e6, "x: must be at least 0, not -1 MPa"),
        (at_least(1e6), 0.0, "x: must be at least 1 MPa, not 0 Pa"),
        (in_range(0, 1e6), 2e6, "x: must be from 0 to 1 MPa, not 2 MPa"),
        (
            in_range(0, 1e6, open=True),
            1e6,
            "x: must be between 0 and 1 MPa, without the ends, not 1 MPa",
        ),
        (in_range(0, 1e6), math.nan, "x: must be from 0 to 1 MPa, not nan Pa"),
        (choice_of(1, "two"), 3.0, "x: must be one of 1, 'two', not 3 Pa"),
    ],
)
def test_a_validator_says_what_came_and_what_is_allowed(
    validator: Any, value: float, message: str
) -> None:
    cls = attrs.make_class(
        "Any", {"x": parameter(doc="x", unit="Pa", validator=validator)}, frozen=True
    )
    with pytest.raises(FieldError) as caught:
        cls(value)
    assert str(caught.value) == message
    assert (caught.value.field, str(pickle.loads(pickle.dumps(caught.value)))) == ("x", message)
