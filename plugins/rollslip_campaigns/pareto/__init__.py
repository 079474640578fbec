"""Hold the error of numerical and modelling choices against their cost."""
