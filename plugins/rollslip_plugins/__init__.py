"""The models in the box; they use the same entry points and the same interfaces as anybody's."""
