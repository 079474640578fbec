"""Run one study at many points."""
