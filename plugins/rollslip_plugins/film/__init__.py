"""Thickness of the oil film of a line contact: formulas, corrections of the inlet, and a numerical reference."""
