"""The studies of the box keep the rules for studies; `test_conformance_catches` holds that each catches a fault."""

from broken_studies import HeaviestForce
from rollslip.testing import Conformance, conformance
from rollslip_studies.dynamics.study import Dynamics
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.friction_curve.study import FrictionCurve
from rollslip_studies.steady_slip.study import SteadySlip


class TestStudies(Conformance):
    models = (
        FrictionCurve(points=5),
        EffectiveFriction(points=5, map_points=3),
        SteadySlip(points=6, max_cage_slip=0.4),
        Dynamics(duration=1e-4, points=3),
    )


def test_the_study_that_the_broken_ones_are_made_from_breaks_nothing():
    assert {finding.status for finding in conformance(HeaviestForce())} <= {"ok", "skipped"}
