"""The kit's rules for studies: the box's studies keep them, and each catches a study that breaks it."""

import pytest

from broken_studies import BROKEN, HeaviestForce
from rollslip.studies.dynamics.study import Dynamics
from rollslip.studies.effective_friction.study import EffectiveFriction
from rollslip.studies.friction_curve.study import FrictionCurve
from rollslip.studies.steady_slip.study import SteadySlip
from rollslip.studies.study import Study
from rollslip.testing import Conformance, checks_of, conformance
from rollslip.testing.findings import run_check
from rollslip.testing.rules import _RULES


class TestStudies(Conformance):
    models = (
        FrictionCurve(points=5),
        EffectiveFriction(points=5, map_points=3),
        SteadySlip(points=6, friction="effective", max_cage_slip=0.4),
        Dynamics(duration=1e-4, points=3),
    )


def test_the_study_that_the_broken_ones_are_made_from_breaks_nothing():
    assert {finding.status for finding in conformance(HeaviestForce())} <= {"ok", "skipped"}


@pytest.mark.parametrize("study", BROKEN, ids=lambda study: type(study).__name__)
def test_a_broken_study_is_caught(study):
    check = next(check for check in checks_of(study) if check.__name__ == BROKEN[study])
    finding, _ = run_check(study, check)
    assert finding.status == "failed"
    assert finding.message


def test_every_rule_for_studies_catches_a_broken_one():
    assert {check.__name__ for check in _RULES[Study]} == set(BROKEN.values())
