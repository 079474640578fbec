"""Shear-thinning traction after Carreau, found through the entry point in pyproject.toml."""
