"""Built-in data sets: each folder has one, with its values, uncertainties and sources."""

from functools import cache
from pathlib import Path

from rollslip.hookspecs import hookimpl
from rollslip_campaigns.measurement import Measurement, load_measurements


@hookimpl
def measurements() -> list[Measurement]:
    """Offer the data sets of this folder; each of its entry points asks for all."""
    return _built_in()


@cache
def _built_in() -> list[Measurement]:
    return load_measurements(Path(__file__).parent)
