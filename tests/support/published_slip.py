"""What is published on the slip of cages in steady operation, as changes of a scene; also for the table of the docs.

Only abstracts and pages of makers were at hand, so that it is the direction that is held; numbers hold for the bearing
that was tested there. (C): recalled, not looked up.
"""

import attrs

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.studies.steady_slip.study import SteadySlip

NU215 = "Dawoud, Beitler, Schwarze, J. Tribol. 144 (2022), NU 215 under less than the makers' load"
TIGHT = "Dawoud et al., J. Tribol. 145(2), 021205 (2023), NU 215 in three classes of clearance"
TRACTION = "The effects of EHD traction on cage slip, J. Lubr. Technol. 96(3), 370 (1974), tests and a model"
MAKERS = "makers of bearings (LYC): a larger least load where it is cold or the oil viscous"
HARRIS = "Harris, ASLE Trans. 9 (1966) (C)"
SCENE = "1032930-50C"
LAND = {"model": "petroff-land"}


@attrs.frozen
class Published:
    """What was published, by whom, and steps of a change under which it is looked for."""

    says: str
    by: str
    steps: tuple[tuple[str, dict[str, object]], ...]
    rises: bool = True


def _steps(key, values):
    return tuple((value, {key: value}) for value in values)


def _oil(fraction):
    churning = {"model": "churning", "oil_fraction": fraction, "density": 930.0}
    return f"{fraction:.1%} oil", {"cage.drag": [LAND, churning]}


#: Each raises or lowers the slip at every step.
ORDERED = (
    Published("less load, more slip", NU215, _steps("operation.radial_load", ("4 kN", "2 kN", "1037 N", "850 N"))),
    Published(
        "more speed, more slip where the load is too small",
        NU215,
        _steps("operation.inner_speed", ("2000 rpm", "4000 rpm", "6371 rpm", "8000 rpm", "10000 rpm")),
    ),
    Published("more oil, more slip", NU215, (("no oil", {}), _oil(0.005), _oil(0.01), _oil(0.02))),
    Published(
        "preload of all rollers ends the slip",
        TIGHT,
        _steps("bearing.radial_clearance", ("0 um", "-5 um", "-10 um", "-20 um")),
        rises=False,
    ),
    Published(
        "colder oil, more slip under light load",
        MAKERS,
        _steps("operation.temperature", ("70 degC", "50 degC", "40 degC", "30 degC")),
    ),
    Published(
        "fewer rollers, less slip",
        HARRIS,
        tuple((f"{rollers} rollers", {"bearing.rollers": rollers}) for rollers in (28, 24, 20, 16)),
        rises=False,
    ),
)


def steady(changes, slices=15, **settings):
    """Return the result of study steady-slip."""
    scene = evolve(load_scene(SCENE), {"accuracy.slices": slices, **changes})
    return SteadySlip(points=13, **settings).run(assemble(scene))


def slip(changes):
    """Return the one steady slip that lasts."""
    result = steady(changes)
    lasting = result.steady_slip.to_numpy()[result.stability.to_numpy() == "stable"]
    assert lasting.size == 1, (changes, result.steady_slip.to_numpy(), result.status.item())
    return float(lasting[0])
