"""The studies of the box keep the rules for studies; `test_conformance_catches` holds that each catches a fault."""

import pytest

import rollslip
from broken_models import CAMPAIGNS
from broken_studies import HeaviestForce
from registrations import registrations_rolled_back
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


def _fail(*given):
    raise KeyError("load")


def test_an_error_of_a_study_of_others_names_it():
    class Failing(HeaviestForce):
        """It fails."""

        name = "failing"
        run = _fail

    with registrations_rolled_back():
        rollslip.register(Failing)
        with pytest.raises(KeyError) as caught:
            rollslip.run("1032930-70C", "failing")
    note = "raised by study 'failing'; it was registered in this process"
    assert caught.value.__notes__ == [note]


def test_an_error_of_a_campaign_of_others_names_it(monkeypatch):
    _, counting = CAMPAIGNS["a result that counts its runs"]
    monkeypatch.setattr(counting, "run", _fail)
    with pytest.raises(KeyError) as caught:
        counting("1032930-70C").execute()
    (note,) = caught.value.__notes__
    assert note.startswith("raised by campaign 'counting'; it comes from module broken_models")
