"""REXS files as scenes, found through the entry point in pyproject.toml."""
