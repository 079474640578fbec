"""Shear-thinning traction after Cross, found through the entry point in pyproject.toml."""
