"""Slip in steady operation against what is published of it: directions, since the bearings tested were others."""

import attrs
import numpy as np
import pytest

from published_slip import PUBLISHED, slip, steady
from rollslip import evolve
from rollslip_campaigns.validation.validate import AS_STATED, evaluate_statement


@pytest.mark.parametrize("pockets", ["set", pytest.param("play", marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    "said", PUBLISHED.statements, ids=[said.text for said in PUBLISHED.statements]
)
def test_slip_goes_the_way_that_is_published(said, pockets):
    scene = evolve(said.scene, {"study.steady-slip.pockets": pockets})
    judged = evaluate_statement(PUBLISHED, attrs.evolve(said, scene=scene), AS_STATED)
    assert judged["statement_verdict"] == "held", judged["statement_found"]


def test_there_are_twelve_statements_each_with_its_source():
    assert len(PUBLISHED.statements) == 12
    assert all(len(said.by_whom.split()) >= 4 for said in PUBLISHED.statements)


def test_under_more_load_colder_oil_slips_less():
    """Not published, but what limits the sentence on cold oil to light loads: at 2 kN its friction wins."""
    found = [
        slip({"operation.temperature": f"{at} degC", "operation.radial_load": "2 kN"})
        for at in (70, 50, 30)
    ]
    assert found == sorted(found, reverse=True)


def test_below_the_largest_drag_one_slip_lasts_and_one_does_not():
    """What the statement on traction with a peak rests on: a fold within the range parts the two."""
    largest = float(steady({}).limit_drag)
    result = steady({"cage.drag": [{"model": "constant-torque", "size": 0.97 * largest}]})
    low, high = result.steady_slip.to_numpy()
    assert [text.split(":")[0] for text in result.stability.to_numpy()] == ["stable", "unstable"]
    assert low < float(result.skidding_slip) < high
    beyond = steady({"cage.drag": [{"model": "constant-torque", "size": 1.02 * largest}]})
    assert np.isnan(beyond.steady_slip.to_numpy()).all()


@pytest.mark.slow
def test_statements_on_preload_hang_on_rigid_rings():
    """What the data set estimates and says: hoops of bare rings leave a slip, and more of it at 5 um than at none."""
    bare = {
        "bearing.catalogue": {"bore": "150 mm", "outside_diameter": "210 mm", "width": "28 mm"},
        "models.outer_ring": {"model": "annulus", "outside": "210 mm", "harmonics": 0},
        "models.inner_ring": {"model": "annulus", "bore": "150 mm", "harmonics": 0},
    }
    rigid, yielding = (
        [slip({"bearing.radial_clearance": f"{-tight} um"} | rings) for tight in (0, 5, 20)]
        for rings in ({}, bare)
    )
    assert rigid[0] > rigid[1] > rigid[2]
    assert rigid[2] < 1e-3 < yielding[2]  # the limit of the statement
    assert yielding[1] > yielding[0]
    # of a prototype in NumPy
    assert 100 * np.array([*rigid, *yielding]) == pytest.approx(
        [7.3, 3.4, 0.011, 6.2, 7.3, 0.68], rel=0.03
    )
    assert {"models.outer_ring", "models.inner_ring"} <= set(PUBLISHED.estimated)
