"""Oils and bearings by name, each with source and range."""
