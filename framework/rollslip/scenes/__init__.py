"""The shipped scenes; ``rollslip run NAME`` finds them by name."""
