"""The rules of data sets: each says what it is and whence, and each row of a bearing can be computed."""

from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.scene.changes import evolve
from rollslip.studies.study import settings
from rollslip.testing.rules import (
    CITATIONS_WANTED,
    Inapplicable,
    Nonconformance,
    is_citation,
    refuse_unless,
    rule,
)
from rollslip_campaigns.measurement import Measurement


@rule(Measurement)
def check_a_data_set_says_what_it_is_and_whence(measurement: Measurement) -> None:
    """Reports, `rollslip cite` and whoever doubts a number ask for it."""
    refuse_unless(
        measurement.description.strip() and "\n" not in measurement.description,
        f"its description is {measurement.description!r}; say in one line what was measured on what",
    )
    refuse_unless(
        measurement.references and all(map(is_citation, measurement.references)),
        f"its references are {measurement.references!r}; {CITATIONS_WANTED}",
    )
    refuse_unless(
        measurement.licence.strip(),
        "it names no licence; say 'facts' where it holds single numbers only",
    )


@rule(Measurement)
def check_every_row_makes_a_bearing(measurement: Measurement) -> None:
    """An oil, a model or a cage that cannot be put together is found by its author and not by its users."""
    of_bearings = [
        (series, series.scene) for series in measurement.series if series.scene is not None
    ]
    if not any(series.rows for series, _ in of_bearings):
        raise Inapplicable("it has no numbers of a bearing")
    for series, scene in of_bearings:
        study = series.quantity.partition("/")[0] if "/" in series.quantity else None
        for row in series.rows:
            try:
                changed = evolve(scene, row.changes)
                assemble(changed)
                settings(changed, study)
            except RollslipError as error:
                raise Nonconformance(f"series {series.name!r}, {row.label}: {error}") from error
