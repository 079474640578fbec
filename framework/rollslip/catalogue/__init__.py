"""Which models there are, and making one by its name."""
