"""The data sets in the box: a folder each, with what was measured, on what, how well, and where it stands."""

from pathlib import Path

from rollslip.hookspecs import hookimpl
from rollslip_campaigns.measurement import Measurement, load_measurements


@hookimpl
def measurements() -> list[Measurement]:
    """Offer the data sets of this folder."""
    return load_measurements(Path(__file__).parent)
