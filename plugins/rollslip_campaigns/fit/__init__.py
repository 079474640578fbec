"""Fit parameters of a law to measured friction."""
