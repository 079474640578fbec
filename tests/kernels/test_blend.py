"""The compiled blend and what its compiled children refuse, and what a compiled stage refuses of many slices."""

import numpy as np
import pytest

from rollslip import Conditions, Slices
from rollslip_kernels.chain import Chain
from rollslip_kernels.stages import blend, contact, traction

pytestmark = pytest.mark.quick

#: Slices: fewer than a block of 256.
N = 64
FULL = np.arange(N) % 2 == 1  # a thick film, share 0; elsewhere none, share 1


def refused(at, needed):
    """What a blend refuses whose child refuses slice ``at``, asked for where ``needed``.

    The child is a stage that does refuse slices, Lundberg's deflection of a contact wider than long. It fills no
    friction: of that only the other child's is looked at.
    """
    conditions = Conditions(length=0.015, radius=0.006875, modulus=2.3e11, roughness=1e-7)
    slices = Slices(
        N,
        conditions,
        approach=2e-6,
        rolling_speed=20.0,
        sliding_speed=2.0,
        film_thickness=np.where(needed, 1e-6, 1e-12),
        friction=0.0,
    )
    slices.approach[at] = 1.0
    kragelsky = traction.kragelsky(0.1, 22.28, 181.46)
    stage = blend.power(kragelsky, contact.lundberg_deflection(), 0.01, 1.5, 6.0)
    found = Chain([(stage, {}, {"friction"})]).run(slices)
    s = 0.1
    expected = 0.1 + (22.28 * s - 0.1) * np.exp(-181.46 * s)
    if found is None:
        np.testing.assert_allclose(slices.friction[~needed], expected, rtol=1e-14)
    return found


@pytest.mark.parametrize("needed", [FULL, np.arange(N) < 4], ids=["half of a block", "a sixteenth"])
def test_a_refusal_of_a_slice_that_was_not_needed_is_not_heard(needed):
    assert refused(int(np.flatnonzero(~needed)[5]), needed) is None


@pytest.mark.parametrize(
    "needed", [FULL, np.arange(N) < 4, np.ones(N, bool)], ids=["half", "a sixteenth", "all"]
)
def test_a_refusal_of_a_slice_that_was_needed_names_it(needed):
    at = int(np.flatnonzero(needed)[2])
    assert refused(at, needed) == ("status", 0, "", at)


@pytest.mark.parametrize("at", [0, 255, 256, 300, 599])
def test_a_stage_that_is_called_with_many_slices_names_the_one_it_refuses(at):
    """It works in blocks of 256 of its own, whose numbers begin again at one."""
    slices = Slices(600, Conditions(length=0.015, radius=0.006875, modulus=2.3e11), approach=2e-6)
    slices.approach[at] = 1.0
    stages = [(contact.lundberg_deflection(), {}, {"load", "stiffness"})]
    assert Chain(stages, block=600).run(slices) == ("status", 0, "", at)
