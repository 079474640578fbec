"""Discretisation of a study: choice of its resolution before a run, and estimate of its error after it."""
