"""The command line: one module for a group of commands."""

try:
    from rollslip.cli.main import main as main
except KeyboardInterrupt:  # nothing has started, so that no message is needed
    raise SystemExit(130) from None
