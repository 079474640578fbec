"""Conformance rules of data sets: description and sources, and rows that make valid bearings."""

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
def check_data_set_states_contents_and_source(measurement: Measurement) -> None:
    """A data set states in one line what was measured, cites its source and names a licence, for reports and users."""
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
        "it names no licence; write 'facts' if it has single numbers only",
    )


@rule(Measurement)
def check_rows_make_valid_bearings(measurement: Measurement) -> None:
    """All rows of bearings can be assembled, so that the author finds faults of oils, models and cages, not a user."""
    of_bearings = [
        (series, series.scene) for series in measurement.series if series.scene is not None
    ]
    if not any(series.rows for series, _ in of_bearings):
        raise Inapplicable("it has no numbers of a bearing")
    for series, scene in of_bearings:
        study = series.quantity.partition("/")[0] if "/" in series.quantity else None
        for row in series.rows:
            try:
                changed = evolve(scene, row.changes, si=True)
                assemble(changed)
                settings(changed, study)
            except RollslipError as error:
                raise Nonconformance(f"series {series.name!r}, {row.label}: {error}") from error
