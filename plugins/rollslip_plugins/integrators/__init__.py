"""Integrators of the motion: those of SciPy and SUNDIALS, and a compiled Rosenbrock method."""
