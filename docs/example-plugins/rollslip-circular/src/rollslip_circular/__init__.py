"""Traction of the circular fluid, found through the entry point in pyproject.toml."""
