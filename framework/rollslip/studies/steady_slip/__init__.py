"""Formulas of the friction torque, which the study of steady slips asks."""
