"""The command line: one module for a group of commands."""

try:
    from rollslip.cli.main import main as main
except KeyboardInterrupt:  # nothing has begun, so there is nothing to say
    raise SystemExit(130) from None
