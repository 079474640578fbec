"""Friction torque and losses at steady slips, as an answer reports and compares them with formulas of makers."""
