"""Film thickness after Ertel and Grubin, found through the entry point in pyproject.toml."""
