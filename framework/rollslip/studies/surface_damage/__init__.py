"""Models of what slip does to surfaces."""
