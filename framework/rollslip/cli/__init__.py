"""The command line: one module for a group of commands."""

from rollslip.cli.main import main as main
