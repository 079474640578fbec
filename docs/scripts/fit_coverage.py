"""How often the intervals of a fit hold the truth: docs/tables/fit_coverage.csv.

Data are made by the very law that is fitted, with normal noise, so that the truth is known and nothing but the
statistics is tested.  Each case is fitted anew for each of REPEATS noises.  An interval without a limit on one side
holds everything on that side; the last column says how often the profile gave no limit.  A coverage has a binomial
standard error, printed beside it.  Takes a quarter of an hour on one core.
"""

import math
from concurrent.futures import ProcessPoolExecutor

import attrs
import numpy as np
from output import write_table

from rollslip.errors import ConvergenceError
from rollslip.scene import LubricantTable
from rollslip_campaigns.fit.fit import fit_parameters
from rollslip_campaigns.fit.least_squares import LEVELS
from rollslip_campaigns.fit.problem import parameters_named, rig_problem
from rollslip_campaigns.measurement.rig import Rig, RigContact, RigData

REPEATS = 500
SLIPS = (0.0005, 0.001, 0.002, 0.004, 0.006, 0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1)
OIL = LubricantTable(name="mil-prf-7808", data={"pressure_viscosity_law": "barus"})
RIG = Rig(rig=RigContact(radius=0.01), lubricant=OIL)


@attrs.frozen(kw_only=True)
class Case:
    """What is measured, how well, and what is fitted; the oil is MIL-L-7808 with other values of the parameters."""

    temperatures: tuple[float, ...]
    max_pressures: tuple[float, ...]
    truth: dict[str, float]
    noise: float
    given: bool = False


#: Noise is a share of the largest friction; where it is given, half of it is, and the other half goes with friction.
CASES = {
    "four curves, 2 % noise": Case(
        temperatures=(313.15, 343.15),
        max_pressures=(0.8e9, 1.2e9),
        truth={"eyring_stress": 6e6, "pressure_viscosity_factor": 1.15},
        noise=0.02,
    ),
    "four curves, known noise": Case(
        temperatures=(313.15, 343.15),
        max_pressures=(0.8e9, 1.2e9),
        truth={"eyring_stress": 6e6, "pressure_viscosity_factor": 1.15},
        noise=0.02,
        given=True,
    ),
    "one curve, 10 % noise": Case(
        temperatures=(343.15,),
        max_pressures=(1.2e9,),
        truth={"eyring_stress": 6e6, "pressure_viscosity_factor": 1.15},
        noise=0.1,
    ),
    "elastic film, 3 % noise": Case(
        temperatures=(313.15,),
        max_pressures=(1.2e9,),
        truth={"pressure_viscosity_factor": 1.15, "shear_modulus": 0.1e9},
        noise=0.03,
    ),
}


def data(case: Case, friction: np.ndarray, uncertainty: np.ndarray | None = None) -> RigData:
    """Data of a case as if they had been read."""
    T, p, s = (
        x.ravel() for x in np.meshgrid(case.temperatures, case.max_pressures, SLIPS, indexing="ij")
    )
    columns = {
        "temperature": T,
        "max_pressure": p,
        "slide_roll_ratio": s,
        "friction": np.broadcast_to(friction, s.shape),
    }
    columns["rolling_speed"] = np.full(s.size, 3.0)
    if uncertainty is not None:
        columns["friction_uncertainty"] = uncertainty
    return RigData(source="made", text="", sha256="", columns=columns, lines=tuple(range(s.size)))


def true_friction(case: Case) -> np.ndarray:
    """Friction without noise."""
    problem = rig_problem(data(case, np.array(0.01)), RIG, "muraki")
    return problem.friction(attrs.evolve(problem.lubricant, **case.truth), problem.chain)


def repeat(
    case: Case, friction: np.ndarray, seed: int, *, profiles: bool = True
) -> np.ndarray | None:
    """Whether covariance and profile hold the truth and whether the profile has both limits: (3, parameter, level)."""
    sigma = np.full(friction.size, case.noise * friction.max())
    if case.given:
        sigma = (sigma + case.noise * friction) / 2
    measured = friction + sigma * np.random.default_rng(seed).normal(size=friction.size)
    problem = rig_problem(data(case, measured, sigma if case.given else None), RIG, "muraki")
    parameters = parameters_named(problem, case.truth)
    try:
        found = fit_parameters(problem, parameters, profiles=profiles).estimate
    except ConvergenceError:
        return None
    made = np.zeros((3, len(parameters), len(LEVELS)), dtype=bool)
    for k, parameter in enumerate(parameters):
        truth = parameter.x(case.truth[parameter.name])
        error = math.sqrt(found.covariance[k, k])
        made[0, k] = ~(abs(truth - found.best.x[k]) > np.sqrt(found.quantiles) * error)
        if profiles:
            low, high = found.profiles[k].limits.T
            made[1, k] = ~(truth < low) & ~(truth > high)
            made[2, k] = np.isfinite(low) & np.isfinite(high)
    return made


def coverage(name: str, repeats: int, *, profiles: bool = True) -> tuple[np.ndarray, int]:
    """Shares of `repeat` over many noises, and how many fits converged."""
    friction = true_friction(CASES[name])
    done = [repeat(CASES[name], friction, seed, profiles=profiles) for seed in range(repeats)]
    found = [one for one in done if one is not None]
    return np.mean(found, axis=0), len(found)


def rows(name: str) -> list[tuple[str, ...]]:
    """Rows of the table for a case."""
    fractions, count = coverage(name, REPEATS)
    made = []
    for k, parameter in enumerate(CASES[name].truth):
        for j, level in enumerate(LEVELS):
            covariance, profile, limited = fractions[:, k, j]
            error = math.sqrt(level * (1 - level) / count)
            made.append(
                (
                    name,
                    parameter,
                    f"{100 * level:.1f}",
                    str(count),
                    f"{100 * covariance:.1f}",
                    f"{100 * profile:.1f}",
                    f"{100 * error:.1f}",
                    f"{100 * (1 - limited):.1f}",
                )
            )
    return made


if __name__ == "__main__":
    header = ("case", "parameter", "level_percent", "fits", "covariance_percent", "profile_percent",
              "binomial_error_percent", "without_limit_percent")  # fmt: skip
    with ProcessPoolExecutor(2) as pool:
        write_table("fit_coverage", header, [row for made in pool.map(rows, CASES) for row in made])
