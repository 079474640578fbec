"""A data set of traction by a built-in law with noise: what rankings of other laws are tried on."""

import hashlib
import itertools

import numpy as np

from rollslip.scene.values import LubricantTable, ModelChoice, Models
from rollslip.structure import FrozenTable
from rollslip_campaigns.fit.problem import rig_problem
from rollslip_campaigns.measurement import Measurement
from rollslip_campaigns.measurement.rig import Rig, RigContact, RigData
from rollslip_campaigns.measurement.values import ContactSeries, Row

OIL = FrozenTable({"eyring_stress": 4e6, "shear_modulus": 0.3e9, "pressure_viscosity_law": "barus"})
RIG = Rig(
    rig=RigContact(radius=0.01, roughness=(0.05e-6, 0.05e-6)),
    lubricant=LubricantTable(name="mil-prf-7808", data=OIL),
    models=Models(film=ModelChoice(name="moes"), traction=ModelChoice(name="muraki")),
)
#: Temperature [K], mean pressure [Pa], speed [m/s] of the conditions, and slide-roll ratios at each.
CONDITIONS = tuple(itertools.product((313.15, 333.15, 353.15), (0.4e9, 0.8e9), (2.0, 8.0, 20.0)))
SLIPS = np.array([0.001, 0.003, 0.006, 0.01, 0.02, 0.04, 0.07, 0.1])


def conditions_of(count=None):
    rows = np.array([(*one, slip) for one in CONDITIONS[:count] for slip in SLIPS])
    names = ("temperature", "mean_pressure", "rolling_speed", "slide_roll_ratio")
    return dict(zip(names, rows.T, strict=True))


def exact(law, count=None):
    """Friction of all rows by a law."""
    columns = conditions_of(count)
    n = columns["temperature"].size
    data = _data(columns | {"friction": np.full(n, 0.01)})
    problem = rig_problem(data, RIG, law)
    return problem.friction(problem.lubricant, problem.chain)


def _data(columns):
    n = columns["temperature"].size
    sha256 = hashlib.sha256(columns["friction"].tobytes()).hexdigest()
    return RigData(
        source="synthetic.csv",
        text="",
        sha256=sha256,
        columns=columns,
        lines=tuple(range(2, n + 2)),
    )


def synthetic(friction, noise, seed, count=None):
    """Return a data set of friction with normal noise, a share of the largest friction."""
    sigma = noise * float(np.abs(friction).max())
    measured = friction + np.random.default_rng(seed).normal(0.0, sigma, friction.size)
    columns = conditions_of(count)
    columns |= {"friction": measured, "friction_uncertainty": np.full(friction.size, sigma)}
    data = _data(columns)
    held = ("temperature", "mean_pressure", "rolling_speed", "slide_roll_ratio")
    rows = tuple(
        Row(
            changes=FrozenTable({name: float(columns[name][k]) for name in held}),
            measured=float(measured[k]),
            uncertainty=sigma,
            line=k + 2,
        )
        for k in range(friction.size)
    )
    series = ContactSeries(
        name="traction",
        quantity="friction",
        unit="1",
        rows=rows,
        about_uncertainty="made",
        rig=RIG,
        data=data,
    )
    return Measurement(
        name="synthetic", description="A law with noise", references=("Nobody N. Made for tests. 2000.",),
        read="computed", licence="CC0 1.0", series=(series,),
    )  # fmt: skip
