"""Measured data: data sets to compare models with, and rows of rigs, read from files with all faults reported."""

from rollslip_campaigns.measurement.reading import load_measurement, load_measurements
from rollslip_campaigns.measurement.values import QUANTITIES, Measurement

__all__ = ["QUANTITIES", "Measurement", "load_measurement", "load_measurements"]
