"""Random scenes on which a plan has to keep its word, and how it is judged; also for docs/scripts/plan_proof.py.

They are points of a Sobol sequence (scrambled, seed 1) over all that moves accuracy. A few have no friction to average,
or films that no law holds for; what the study refuses is no scene for a plan.
"""

import json
import time

import attrs
import numpy as np
from scipy.stats import qmc

from loading_branch_scenes import CONSTANT_ALPHA, OILS
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import reference_resolution
from rollslip.errors import RollslipError
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
from rollslip.studies.bounds import errors_between

STUDY = "effective-friction"
BASE = evolve(
    load_scene("1032930-70C"),
    {
        f"study.{STUDY}": {"max_cage_slip": 0.6, "points": 21, "map_points": 0},
        "accuracy.slices": "auto",
    },
    si=True,
)
PROFILES = ("none", "iso16281", {"shape": "circular", "radius": "3 m"}, "iso16281")
#: 12 of 16 scenes draw the epicyclic closure, 3 a rolling outer ring, one a free roller.
CLOSURES = (*["epicyclic"] * 12, *["outer-rolling"] * 3, "free-roller")
FILMS = ("moes", "dowson-toyoda", "pan-hamrock", "dowson-1968")


def blend(name, law):
    """A blend with a law of the full film."""
    return {"model": name, "hydrodynamic": law}


TRACTIONS = (
    blend("lambda-blend", "muraki"), blend("linear-blend", "muraki"), blend("lambda-blend", "eyring"), "muraki",
    "maxwell-eyring", blend("lambda-blend", "maxwell-eyring"), blend("greenwood-tripp", "muraki"), "eyring",
)  # fmt: skip


def points(count, of=256):
    """First points of a sequence in the unit cube, (count, 13)."""
    return qmc.Sobol(13, seed=1).random(of)[:count]


def pick(options, x):
    """One of several, by a number from 0 to 1."""
    return options[int(x * len(options))]


def scene(x):
    """The scene of a point."""
    return evolve(
        BASE,
        {
            "operation.radial_load": 300.0 * 60.0 ** x[0],
            "operation.inner_speed": f"{800.0 * 12.0 ** x[1]} rpm",
            "operation.temperature": f"{30.0 + 70.0 * x[2]} degC",
            "bearing.radial_clearance": f"{-10.0 + 60.0 * x[3]} um",
            "operation.misalignment": f"{max(x[4] - 0.5, 0.0)} mrad",
            "bearing.profile": pick(PROFILES, x[5]),
            "lubricant.name": pick(OILS, x[6]),
            **CONSTANT_ALPHA.get(pick(OILS, x[6]), {}),
            "lubricant.conductivity": 0.14,  # that of oils at hand, where an oil gives none
            "lubricant.eyring_stress": f"{1.0 + 9.0 * x[7]} MPa",
            f"study.{STUDY}.closure": pick(CLOSURES, x[8]),
            "models.film": pick(FILMS, x[9]),
            "models.traction": pick(TRACTIONS, x[10]),
            **{
                f"surface.{part}_roughness": f"{0.02 * 20.0 ** x[11]} um"
                for part in ("inner_raceway", "roller")
            },
            "accuracy.tolerance": 10.0 ** (-2.0 - 3.0 * x[12]),
        },
        si=True,
    )


@attrs.frozen
class Verdict:
    """What came of a scene: its errors and costs against the finest; ``refused`` is why there are none."""

    scene: object
    refused: str = ""
    resolution: dict = attrs.Factory(dict)
    estimated: dict = attrs.Factory(dict)
    actual: dict = attrs.Factory(dict)
    reinstated: tuple = ()
    planning: float = np.nan
    seconds: float = np.nan
    finest_seconds: float = np.nan

    @property
    def tolerance(self):
        """What the scene asks for."""
        return self.scene.accuracy.tolerance

    @property
    def error(self):
        """Largest of the actual errors."""
        return max(self.actual.values())

    @property
    def kept(self):
        """Whether the plan kept its word."""
        return self.error <= self.tolerance


def judge(one, reference=None):
    """Run a scene as planned and at the finest, or at another resolution that it is held against."""
    try:
        made = plan(one, STUDY)
        if made.choices[STUDY].failed:
            return Verdict(one, refused=made.choices[STUDY].failed)
        result = execute(made, STUDY)
        begin = time.process_time()
        fine = made.studies[STUDY].run(assemble(one, reference or reference_resolution(one)))
        spent = time.process_time() - begin
    except RollslipError as error:
        return Verdict(one, refused=str(error))
    return Verdict(
        one,
        resolution=json.loads(result.attrs["resolution"]),
        estimated=dict(made.choices[STUDY].total),
        actual=errors_between(made.studies[STUDY].controlled_outputs, result, fine),
        reinstated=tuple(json.loads(result.attrs["reinstated"])),
        planning=made.planning,
        seconds=json.loads(result.attrs["cost"])["actual"],
        finest_seconds=spent,
    )
