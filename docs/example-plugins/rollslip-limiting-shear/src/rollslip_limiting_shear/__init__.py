"""Traction with a limiting shear stress, found through the entry point in pyproject.toml."""
