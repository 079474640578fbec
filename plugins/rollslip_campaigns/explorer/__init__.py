"""Effective friction, loads and the slip of running away over a grid, to look at by moving sliders."""
