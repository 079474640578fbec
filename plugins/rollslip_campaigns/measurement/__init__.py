"""What was measured: data sets to hold models against, and the rows of rigs, read strictly from their files."""

from rollslip_campaigns.measurement.reading import load_measurement, load_measurements
from rollslip_campaigns.measurement.values import QUANTITIES, Measurement

__all__ = ["QUANTITIES", "Measurement", "load_measurement", "load_measurements"]
