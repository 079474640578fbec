"""Bearing elements of ROSS, found through the entry point in pyproject.toml."""
