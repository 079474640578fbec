"""What is published on the slip of cages in steady operation, from the data set of the box; also for the docs."""

from rollslip import evolve, get_model
from rollslip.bearing.assembly import assemble
from rollslip_studies.steady_slip.study import SteadySlip

PUBLISHED = get_model("measurement", "published-slip")


def steady(changes, **settings):
    """Return the result of study steady-slip on the scene of the statements."""
    scene = evolve(PUBLISHED.statements[0].scene, changes, si=True)
    study = SteadySlip(**{"points": 13, "acceptable_slip": None} | settings)
    return study.run(assemble(scene))


def slip(changes):
    """Return the one steady slip that lasts."""
    result = steady(changes)
    lasting = result.steady_slip.to_numpy()[result.stability.to_numpy() == "stable"]
    assert lasting.size == 1, (changes, result.steady_slip.to_numpy(), result.status.item())
    return float(lasting[0])
