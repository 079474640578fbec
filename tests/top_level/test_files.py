"""Text and columns of numbers, read strictly."""

import attrs
import pytest

from rollslip.errors import SceneError
from rollslip.fields import parameter, positive
from rollslip.files import decoded, read_columns

pytestmark = pytest.mark.quick


@attrs.frozen(kw_only=True)
class Row:
    speed: float = parameter(unit="m/s", doc="speed", validator=positive)
    fraction: float | None = parameter(default=None, unit="1", doc="fraction")


def read(text, **options):
    faults = []
    return *read_columns(text, "data.csv", Row, faults, **options), faults


def test_columns_are_read_in_si_in_the_order_of_the_file():
    columns, lines, faults = read('# rig\nfraction [%], "speed [km/h]"\n\n5, 36\r\n -1e1 ,"3.6"\n')
    assert columns == {"fraction": [0.05, -0.1], "speed": [10.0, 1.0]}
    assert (lines, faults) == ((4, 5), [])


def test_a_column_with_a_default_may_be_left_out():
    assert read("speed [m/s]\n1")[0] == {"speed": [1.0]}


def test_faults_of_the_header_come_before_those_of_the_rows():
    faults = read(
        "sped [m/s], fraction [m], fraction [1]\n1, 2\n0, x, 1",
        check=lambda names: f"{len(names)} columns",
    )[2]
    assert faults == [
        "data.csv:1: 'sped': unknown column; did you mean speed?",
        "data.csv:1: fraction: '1 m' is a length, here a plain number is expected, such as 0.1",
        "data.csv:1: fraction: stands there twice",
        "data.csv:1: speed: missing, but required (speed)",
        "data.csv:1: 3 columns",
        "data.csv:2: 2 values under 3 columns",
    ]


@pytest.mark.parametrize("text", ["", "# speed [m/s]\n", "speed [m/s]\n"])
def test_a_file_without_rows_says_what_one_looks_like(text):
    assert read(text)[2] == [
        "data.csv: no data; a header such as 'speed [m/s]' and rows of numbers are expected"
    ]


def test_a_validator_of_a_column_holds_for_every_cell():
    assert read("speed [m/s]\n1\n-2")[2] == ["data.csv:3: speed: must be above 0, not -2 m/s"]


def test_text_that_is_not_utf8_is_refused_with_its_line():
    assert decoded(b"\xef\xbb\xbfa", "a.txt") == "a"
    with pytest.raises(SceneError, match=r"a\.txt:2: not UTF-8 text"):
        decoded(b"a\n\xe4", "a.txt")
