"""A sheet grows by the rows of its legend and by nothing else, so that panels do not shrink."""

import pytest

from rollslip.results.style import ROW, SINGLE_COLUMN, TWO_COLUMNS, Sheet, styled

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(
    ("columns", "rows", "title"), [(1, 3, ""), (2, 2, ""), (3, 1, ""), (3, 2, "what they are")]
)
def test_a_sheet_grows_by_a_row_for_each_of_its_legend(columns, rows, title):
    sheet = Sheet()
    sheet.line([0, 1], [0, 1], "a line", color="red")
    sheet.mark([0.5], [0.5], "a point", marker="o")
    sheet.key("drawn otherwise", color="blue")
    figure = sheet.done("slip", "friction", columns=columns, title=title)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "a line",
        "a point",
        "drawn otherwise",
    ]
    assert legend.get_title().get_text() == title
    assert figure.get_figheight() == pytest.approx(SINGLE_COLUMN[1] + rows * ROW)
    assert (sheet.axes.get_xlabel(), sheet.axes.get_ylabel()) == ("slip", "friction")
    assert [line.get_color() for line in sheet.axes.lines] == ["red", "black"]


def test_a_sheet_without_a_legend_keeps_its_size_and_one_of_panels_has_no_labels():
    sheet = Sheet(TWO_COLUMNS, 1, 2)
    figure = sheet.done()
    assert not figure.legends
    assert tuple(figure.get_size_inches()) == pytest.approx(TWO_COLUMNS)
    assert sheet.axes.shape == (2,)
    sheet.key("one", color="0.3")
    assert sheet.done(height=1.0).get_figheight() == pytest.approx(1.0 + ROW)


@pytest.mark.parametrize("columns", [1, 2])
def test_a_label_that_is_longer_than_its_column_is_wrapped_and_not_cut(columns):
    sheet = Sheet()
    sheet.key(
        "slip of largest drag: all 1024 samples beyond the range or without an end", color="blue"
    )
    sheet.key("allowable", color="red")
    with styled():
        figure = sheet.done("slip", "friction", columns=columns)
        (legend,) = figure.legends
        figure.draw_without_rendering()
        box = legend.get_window_extent()
        whole = figure.bbox
    lines = [text.get_text().count("\n") + 1 for text in legend.get_texts()]
    assert lines[0] > 1 == lines[1]
    assert figure.get_figheight() == pytest.approx(
        SINGLE_COLUMN[1] + (sum(lines) if columns == 1 else max(lines)) * ROW
    )
    assert whole.x0 <= box.x0 < box.x1 <= whole.x1
