"""Interface to formulas of the friction torque, which study steady-slip compares with computed losses."""
