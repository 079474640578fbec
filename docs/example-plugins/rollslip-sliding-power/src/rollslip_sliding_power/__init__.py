"""A study for rollslip; the registry finds it through the entry point in pyproject.toml."""
