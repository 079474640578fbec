"""The compiled equations of motion of the bearing, and what integrates them."""
