"""Axial load on ribs in study steady-slip: variables, makers' limits, and what an answer has of them."""
