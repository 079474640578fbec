"""A mixed film whose load oil and asperities share, found through the entry point in pyproject.toml."""
