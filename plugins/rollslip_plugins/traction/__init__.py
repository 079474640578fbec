"""Friction of one contact: laws of the film, of the boundary, and blends of the two."""
