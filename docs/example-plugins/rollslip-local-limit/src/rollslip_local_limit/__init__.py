"""Traction at the local pressure, found through the entry point in pyproject.toml."""
