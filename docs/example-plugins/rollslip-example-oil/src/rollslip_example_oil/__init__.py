"""An example oil, found through the entry point in pyproject.toml."""
