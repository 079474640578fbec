"""What is said and drawn of stored results is what was read."""

import pytest
from matplotlib import style
from matplotlib.backends.backend_agg import FigureCanvasAgg

import recorded
from drawn import overlapping
from rollslip.catalogue.registry import available
from rollslip.results.style import SINGLE_COLUMN, STYLE, TWO_COLUMNS, set_plainly


@pytest.mark.parametrize("name", [*recorded.RESULTS, *recorded.TEXTS])
def test_a_stored_result_is_told_and_drawn_as_recorded(name):
    """Read the difference; then write the text anew by: python tests/support/recorded.py NAME."""
    text = (recorded.STORED / f"{name}.txt").read_text(encoding="utf-8")
    assert recorded.text_of(name).splitlines() == text.splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("name", recorded.RESULTS)
def test_labels_of_ticks_do_not_overlap_and_texts_are_within_figures_of_one_or_two_columns(name):
    with style.context(["default", dict(STYLE)]):
        for figure in recorded.drawn(name).values():
            assert figure.get_figwidth() in (SINGLE_COLUMN[0], TWO_COLUMNS[0])
            set_plainly(figure)
            canvas = FigureCanvasAgg(figure)
            figure.draw_without_rendering()
            legends = [text for legend in figure.legends for text in legend.get_texts()]
            axes = [one for panel in figure.axes for one in (panel, *panel.child_axes)]
            titles = [text for one in axes for text in (one._left_title, one.xaxis.label)]
            for text in (*legends, *titles):
                assert text.get_window_extent(canvas.get_renderer()).x1 <= figure.bbox.x1 + 1.0, (
                    text
                )
            for axis in (axis for one in axes for axis in (one.xaxis, one.yaxis)):
                assert not overlapping(axis, canvas.get_renderer())


def test_every_account_of_the_box_has_a_stored_result():
    told = {recorded.stored(name).attrs["study"] for name in recorded.RESULTS}
    assert told == {*available("account")}
