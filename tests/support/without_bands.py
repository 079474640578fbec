"""Run a study as `rollslip.run` does, but for the bands of its slip, which take longer than many a study does."""

from rollslip.planning.execution import execute
from rollslip.planning.plan import plan


def run(scene, study):
    """Return the dataset of one study of a scene."""
    return execute(plan(scene, study), study)
