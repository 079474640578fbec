"""Load distribution: published check, independent solutions, balance and symmetry, hard cases."""

import tracemalloc
from types import SimpleNamespace
from typing import ClassVar

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq, root

from rollslip.bearing.chain import Chain
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium, solve_pitch
from rollslip.errors import ConvergenceError, DomainError
from rollslip.models import SliceModel
from rollslip.models.profile import profile_drop, slice_positions
from rollslip_kernels.slices import Conditions, Slices
from rollslip_plugins.contact import Lundberg, Palmgren
from rollslip_studies.motion.orbit_loads import over_pitch, solve_orbits

#: Length of a roller of the paper's bearing [m].
LENGTH = 0.015


@attrs.frozen
class PowerLaw(SliceModel):
    """w = coefficient approach^exponent."""

    name = "power law"
    equation = "w = k d^p"
    references = ()
    reads = frozenset({"approach"})
    writes = frozenset({"load", "stiffness"})
    domain: ClassVar = {}
    coefficient: float
    exponent: float

    def evaluate(self, slices):
        d = slices.approach
        slices.load[:] = self.coefficient * d**self.exponent
        slices.stiffness[:] = self.coefficient * self.exponent * d ** (self.exponent - 1.0)


def rings(model):
    """Contacts of both rings by the same law."""
    ring = SimpleNamespace(conditions=Conditions(length=LENGTH), deflection=Chain(model))
    return ring, ring


def power_law(coefficient, exponent):
    return rings(PowerLaw(coefficient, exponent))


def loads_of(law, approach):
    """Load per length and stiffness after a law of `power_law`."""
    (model,) = law[0].deflection.models
    d = np.maximum(approach, 0.0)
    slices = Slices.of_columns(
        Conditions(), {"approach": d, "load": np.empty_like(d), "stiffness": np.empty_like(d)}
    )
    model.evaluate(slices)
    return slices.load, slices.stiffness


def iso16281(length=LENGTH):
    """One of two equal contacts that make Q = 35948 l^(8/9) delta^(10/9) in series [N, mm]."""
    return power_law(
        35948 * 2 ** (10 / 9) * (length * 1e3) ** (-1 / 9) * 1e3 * 1e3 ** (10 / 9), 10 / 9
    )


def palmgren(length=LENGTH):
    """delta = 3.84e-5 Q^0.9 / l^0.8 [N, mm]."""
    l = length * 1e3  # noqa: E741
    return power_law((l**0.8 / 3.84e-5) ** (1 / 0.9) / length * 1e3 ** (1 / 0.9), 1 / 0.9)


def case(Z=28, n_positions=4, slices=1, shape="none", drop=None, psi=None, **changes):
    if drop is None:
        drop = profile_drop(shape, slice_positions(LENGTH, slices), LENGTH, 0.015)
    psi = angular_positions(Z, n_positions) if psi is None else np.atleast_2d(psi)
    values = {"radial_clearance": 2e-5, "radial_load": 3415.0} | changes
    return LoadCase(psi, LENGTH, drop, **values)


def check(case, solved, law=None, tolerance=2e-12):
    """Balance of forces and moments, and loads that belong to the position reported."""
    law = law or iso16281()
    s = solved
    width = LENGTH / case.drop.size
    scale = max(
        case.radial_load, case.centrifugal_force, s.outer_force.max(), s.inner_force.max(), 1e-300
    )
    for load, force in ((s.inner_load, s.inner_force), (s.outer_load, s.outer_force)):
        assert np.all(load >= 0.0)
        assert load.sum(axis=-1) * width == pytest.approx(force, abs=1e-13 * scale)
    assert np.sum(s.inner_force * np.cos(s.psi), axis=1) == pytest.approx(
        case.radial_load, abs=tolerance * scale
    )
    assert np.sum(s.inner_force * np.sin(s.psi), axis=1) == pytest.approx(
        0.0, abs=tolerance * scale
    )
    assert s.outer_force == pytest.approx(
        s.inner_force + case.centrifugal_force, abs=tolerance * scale
    )
    moments = (s.inner_load @ s.position, s.outer_load @ s.position)
    assert moments[0] * width == pytest.approx(moments[1] * width, abs=tolerance * scale * LENGTH)
    held = np.sum(moments[0] * width * np.cos(s.psi), axis=1)
    assert s.moment == pytest.approx(held, abs=1e-13 * scale * LENGTH)
    assert max(s.force_residual, s.moment_residual) < tolerance
    assert s.iterations < 60

    cos = np.cos(s.psi)[..., None]
    sin = np.sin(s.psi)[..., None]
    roller = s.roller_shift[..., None] + s.roller_tilt[..., None] * s.position
    dx = s.displacement[:, 0, None, None]
    dy = s.displacement[:, 1, None, None]
    ring = dx * cos + dy * sin - case.radial_clearance / 2 + case.misalignment * s.position * cos
    size = (
        np.abs(s.displacement).max() + abs(case.radial_clearance) + abs(case.misalignment) * LENGTH
    )
    size += np.abs(s.roller_shift).max() + case.drop.max()
    for approach, load in (
        (ring - roller - case.drop, s.inner_load),
        (roller - case.drop, s.outer_load),
    ):
        stiffness = loads_of(law, np.array([size + 1e-12]))[1][0]
        assert load == pytest.approx(
            loads_of(law, approach)[0], abs=1e-13 * size * stiffness + 1e-12 * load.max()
        )


def test_values_two_independent_programs_agree_on():
    law = iso16281(0.014)
    s = solve_equilibrium(LoadCase(angular_positions(14, 1), 0.014, [0.0], 2e-5, 5000.0), law)
    expected = np.zeros(14)
    expected[[0, 1, -1, 2, -2]] = 1936.5, 1485.3, 1485.3, 310.4, 310.4
    assert s.inner_force[0] == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("clearance", [0.0, 2e-5, 5e-4])
@pytest.mark.parametrize("load", [1e-2, 3415.0, 1e6])
def test_straight_rollers_follow_the_series_law(clearance, load):
    """Without centrifugal force two equal contacts share the approach: one unknown is left for a symmetric bearing."""
    psi = angular_positions(28, 1)[0]
    law = palmgren()

    def forces(dx):
        return loads_of(law, (dx * np.cos(psi) - clearance / 2) / 2)[0] * LENGTH

    dx = brentq(
        lambda dx: np.sum(forces(dx) * np.cos(psi)) / load - 1.0, 0.0, 1.0, xtol=1e-25, rtol=1e-15
    )
    s = solve_equilibrium(case(psi=psi, radial_clearance=clearance, radial_load=load), law)
    assert s.inner_force[0] == pytest.approx(forces(dx), abs=1e-8 * load)
    assert s.displacement[0] == pytest.approx([dx, 0.0], abs=1e-10 * dx)


@pytest.mark.parametrize("exponent", [10 / 9, 1.5])
@pytest.mark.parametrize("misalignment", [0.0, 5e-4, -2e-3])
@pytest.mark.parametrize("clearance", [-1e-5, 1e-5])
def test_plain_equations_solved_otherwise_give_the_same(exponent, misalignment, clearance):
    """All unknowns at once, in micrometres, by MINPACK, from a start of its own."""
    x = slice_positions(LENGTH, 4)
    drop = profile_drop("iso16281", x, LENGTH, 0.015)
    law = power_law(5e10 * 1e-5 ** (1 - exponent), exponent)
    c = case(
        psi=angular_positions(5, 1) + 0.3,
        drop=drop,
        radial_clearance=clearance,
        misalignment=misalignment,
        centrifugal_force=100.0,
    )
    psi = c.psi[0]
    width = LENGTH / 4

    def loads(u):
        dx = u[0] * 1e-6
        dy = u[1] * 1e-6
        y = u[2:7] * 1e-6
        tilt = u[7:] * 1e-6 / LENGTH
        ring = dx * np.cos(psi) + dy * np.sin(psi) - clearance / 2
        ring = ring[:, None] + misalignment * np.cos(psi)[:, None] * x
        roller = y[:, None] + tilt[:, None] * x
        return loads_of(law, ring - roller - drop)[0] * width, loads_of(law, roller - drop)[
            0
        ] * width

    def unbalanced(u):
        inner, outer = loads(u)
        Q = inner.sum(axis=1)
        ring = np.sum(Q * np.cos(psi)) - c.radial_load, np.sum(Q * np.sin(psi))
        return (
            np.concatenate((ring, Q + 100.0 - outer.sum(axis=1), (inner - outer) @ x / LENGTH))
            / c.radial_load
        )

    start = np.concatenate(([40.0, 0.0], np.full(5, 10.0), np.full(5, 1.0)))
    found = root(
        unbalanced, start, method="lm", options={"xtol": 1e-15, "ftol": 1e-15, "maxiter": 20000}
    ).x
    found = root(unbalanced, found, method="hybr", options={"xtol": 1e-15}).x
    assert np.abs(unbalanced(found)).max() < 1e-10
    s = solve_equilibrium(c, law)
    check(c, s, law)
    inner, outer = loads(found)
    assert s.inner_load[0] * width == pytest.approx(inner, abs=1e-8 * c.radial_load)
    assert s.outer_load[0] * width == pytest.approx(outer, abs=1e-8 * c.radial_load)
    assert s.displacement[0] * 1e6 == pytest.approx(found[:2], rel=1e-8)


HARD = {
    "one roller loaded": {"radial_clearance": 2e-3, "n_positions": 1},
    "large clearance": {"radial_clearance": 1e-3},
    "preload": {"radial_clearance": -3e-5},
    "preload, profile and tilt": {
        "radial_clearance": -3e-5, "slices": 41, "shape": "iso16281", "misalignment": 1e-3
    },
    "three rollers": {"Z": 3, "n_positions": 5},
    "three rollers, tilt": {"Z": 3, "n_positions": 5, "slices": 21, "misalignment": 1e-3, "centrifugal_force": 10.0},
    "roller at the edge of the loaded zone": {"Z": 4, "radial_clearance": 0.0},
    "tiny load": {"radial_load": 1e-6},
    "tiny load, profile": {"radial_load": 1e-6, "slices": 40, "shape": "iso16281"},
    "tiny load, centrifugal force": {"radial_load": 1e-6, "centrifugal_force": 174.0},
    "tiny load, large clearance": {"radial_load": 1e-6, "radial_clearance": 1e-3},
    "huge load": {"radial_load": 1e6},
    "huge load, tilt": {"radial_load": 1e6, "slices": 41, "misalignment": 5e-3},
    "half the roller unloaded": {"slices": 41, "misalignment": 5e-3},
    "tilt, centrifugal force": {"slices": 41, "misalignment": 2e-2, "centrifugal_force": 174.0},
    "tilt, slow": {
        "slices": 41, "shape": "iso16281", "misalignment": -4e-5, "centrifugal_force": 0.014, "radial_clearance": 7e-4
    },
    "1001 slices": {"slices": 1001, "shape": "iso16281", "misalignment": 1e-3, "centrifugal_force": 174.0},
    "centrifugal force rules": {"radial_load": 1.0, "centrifugal_force": 1e5},
    "centrifugal force rules, tilt": {
        "radial_load": 1.0, "centrifugal_force": 1e5, "slices": 41, "shape": "iso16281", "misalignment": 1e-3
    },
    "preload only": {"radial_load": 0.0, "radial_clearance": -1e-5},
    "preload and tilt only": {
        "radial_load": 0.0, "radial_clearance": -1e-5, "slices": 21, "misalignment": 1e-3, "centrifugal_force": 9.0
    },
    "no load, no clearance": {"radial_load": 0.0, "radial_clearance": 0.0},
    "raised profile": {"drop": np.full(5, 3e-6)},
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("law", [iso16281(), power_law(1e12, 1.5)], ids=["iso16281", "3/2"])
@pytest.mark.parametrize("name", HARD)
def test_hard_cases_balance(name, law):
    c = case(**HARD[name])
    check(c, solve_equilibrium(c, law), law)


def test_one_roller_carries_all_with_large_clearance():
    s = solve_equilibrium(case(radial_clearance=2e-3, n_positions=1), iso16281())
    assert s.inner_force[0, 0] == pytest.approx(3415.0, rel=1e-12)
    assert np.all(s.inner_force[0, 1:] == 0.0)


def test_tilt_unloads_half_of_the_roller():
    s = solve_equilibrium(case(slices=41, misalignment=5e-3, n_positions=1), iso16281())
    assert np.all(s.inner_load[0, 0, :20] == 0.0)
    assert s.inner_load[0, 0, -1] == s.inner_load.max()
    assert s.roller_tilt[0, 0] == pytest.approx(2.5e-3, rel=1e-6)
    assert s.moment[0] > 0.0


@pytest.mark.parametrize("centrifugal_force", [0.0, 174.0])
def test_without_load_nothing_rests_on_the_inner_ring(centrifugal_force):
    c = case(radial_load=0.0, slices=41, shape="iso16281", centrifugal_force=centrifugal_force)
    s = solve_equilibrium(c, iso16281())
    check(c, s)
    assert np.all(s.inner_force == 0.0)
    assert s.outer_force == pytest.approx(centrifugal_force, rel=1e-12)


def test_interference_that_rollers_can_evade_leaves_no_load():
    c = case(
        Z=6,
        radial_load=0.0,
        radial_clearance=1.5e-8,
        slices=3,
        shape="iso16281",
        misalignment=3.2e-5,
    )
    s = solve_equilibrium(c, iso16281())
    assert s.inner_force.max() < 1e-8


@pytest.mark.parametrize("changes", [{}, {"centrifugal_force": 174.0}, {"radial_clearance": -2e-5}])
def test_one_slice_does_for_straight_rollers(changes):
    one, many = (solve_equilibrium(case(slices=n, **changes), iso16281()) for n in (1, 40))
    assert np.broadcast_to(one.inner_load, many.inner_load.shape) == pytest.approx(
        many.inner_load, rel=1e-11
    )
    assert np.broadcast_to(one.outer_load, many.outer_load.shape) == pytest.approx(
        many.outer_load, rel=1e-11
    )
    assert np.abs(many.roller_tilt).max() < 1e-15


mechanics = st.fixed_dictionaries(
    {
        "Z": st.integers(3, 30),
        "slices": st.sampled_from([2, 5, 12]),
        "shape": st.sampled_from(["none", "iso16281"]),
        "radial_clearance": st.floats(-5e-5, 2e-4),
        "radial_load": st.floats(1, 5).map(lambda e: 10**e),
        "centrifugal_force": st.one_of(st.just(0.0), st.floats(0, 4).map(lambda e: 10**e)),
        "misalignment": st.floats(-3e-3, 3e-3),
    }
)


@given(mechanics, st.floats(0.0, 1.0))
def test_any_bearing_balances(values, turn):
    c = case(psi=angular_positions(values["Z"], 3) + turn, **values)
    check(c, solve_equilibrium(c, iso16281()))


@given(mechanics)
def test_mirrored_misalignment_mirrors_the_loads(values):
    values |= {"n_positions": 2}
    c = case(**values)
    s = solve_equilibrium(c, iso16281())
    mirrored = solve_equilibrium(attrs.evolve(c, misalignment=-c.misalignment), iso16281())
    scale = max(s.inner_load.max(), s.outer_load.max())
    assert mirrored.inner_load[..., ::-1] == pytest.approx(s.inner_load, abs=1e-9 * scale)
    assert mirrored.outer_load[..., ::-1] == pytest.approx(s.outer_load, abs=1e-9 * scale)
    assert mirrored.moment == pytest.approx(-s.moment, abs=1e-9 * scale * LENGTH**2)


@given(mechanics)
def test_symmetric_instants_load_both_sides_alike(values):
    """psi and -psi are the same bearing seen from its other side; so are the instants a share before and after."""
    c = case(**values, n_positions=4)
    s = solve_equilibrium(c, iso16281())
    scale = max(s.inner_force.max(), s.outer_force.max())
    assert s.inner_force[0, 1:] == pytest.approx(s.inner_force[0, :0:-1], abs=1e-9 * scale)
    assert s.inner_force[1] == pytest.approx(s.inner_force[3, ::-1], abs=1e-9 * scale)


def test_instants_do_not_know_of_each_other():
    c = case(slices=5, shape="iso16281", misalignment=1e-3, centrifugal_force=50.0, n_positions=6)
    together = solve_equilibrium(c, iso16281())
    for m in range(6):
        alone = solve_equilibrium(attrs.evolve(c, psi=c.psi[m : m + 1]), iso16281())
        assert alone.inner_load[0] == pytest.approx(
            together.inner_load[m], abs=1e-10 * together.inner_load.max()
        )


def test_tighter_bearings_load_more_rollers():
    solved = [
        solve_equilibrium(case(radial_clearance=g), iso16281()) for g in (1e-4, 2e-5, 0.0, -2e-5)
    ]
    loaded = [np.count_nonzero(s.inner_force) for s in solved]
    assert loaded == sorted(loaded)
    assert loaded[0] < loaded[-1] == 4 * 28


@given(st.integers(1, 60), st.integers(1, 20))
def test_instants_spread_over_one_pitch(rollers, n_positions):
    psi = angular_positions(rollers, n_positions)
    assert psi.shape == (n_positions, rollers)
    assert psi[0, 0] == 0.0
    steps = np.diff(np.sort(psi.ravel()))
    assert steps == pytest.approx(2 * np.pi / rollers / n_positions, rel=1e-9)


def alike(found, full, tolerance=2e-12):
    """Two distributions of the same bearing, to the residual they were solved to."""
    np.testing.assert_array_equal(found.psi, full.psi)
    scale = full.outer_force.max()
    for name in ("inner_force", "outer_force", "inner_load", "outer_load"):
        one = getattr(found, name)
        other = getattr(full, name)
        np.testing.assert_allclose(
            one,
            other,
            rtol=0,
            atol=tolerance * (scale if "force" in name else full.outer_load.max()),
        )
    for name in ("displacement", "roller_shift"):
        size = np.abs(full.displacement).max()
        np.testing.assert_allclose(
            getattr(found, name), getattr(full, name), rtol=0, atol=10 * tolerance * size
        )
    np.testing.assert_allclose(found.roller_tilt, full.roller_tilt, rtol=0, atol=1e-13)
    np.testing.assert_allclose(found.moment, full.moment, rtol=0, atol=tolerance * scale * LENGTH)


#: A profile that no half of the roller shares with the other.
LOPSIDED = profile_drop("iso16281", slice_positions(LENGTH, 20), LENGTH, 0.015) + np.linspace(
    0.0, 2e-6, 20
)


@pytest.mark.parametrize("known", [False, True], ids=["at once", "by doubling"])
@pytest.mark.parametrize(
    "changes",
    [{}, {"misalignment": 5e-4}, {"drop": LOPSIDED, "misalignment": -3e-4}],
    ids=["aligned", "tilted", "lopsided"],
)
@pytest.mark.parametrize(
    ("Z", "n_positions"), [(28, 1), (28, 2), (27, 3), (13, 8), (28, 16), (5, 6)]
)
def test_half_of_a_pitch_mirrors_the_other(Z, n_positions, changes, known):
    changes = {"centrifugal_force": 170.0, "slices": 21, "shape": "iso16281"} | changes
    whole = case(Z=Z, n_positions=n_positions, **changes)
    before = (
        solve_pitch(case(Z=Z, n_positions=n_positions // 2, **changes), palmgren())
        if known and n_positions % 2 == 0
        else None
    )
    found = solve_pitch(whole, palmgren(), before)
    alike(found, solve_equilibrium(whole, palmgren()))
    check(whole, found, palmgren())


@pytest.mark.parametrize(
    "changes", [{}, {"misalignment": 3e-4, "slices": 12}, {"radial_clearance": -2e-5}]
)
@pytest.mark.parametrize(("Z", "n_positions"), [(28, 1), (13, 4), (14, 5)])
def test_orbits_at_many_speeds_are_those_of_each(Z, n_positions, changes):
    """Each goes on from the one before; where rollers lift off, and without centrifugal force, too."""
    forces = 174.0 * np.array([1.0, 0.99, 0.5, 0.1, 1e-6, 0.0, 3.0, 3.0])
    given = case(Z=Z, n_positions=n_positions, **changes)
    law = iso16281()
    for name, part in zip(
        ("inner_load", "outer_load", "rib_force"), solve_orbits(given, law, forces), strict=True
    ):
        every = over_pitch(part, n_positions)
        for force, found in zip(forces, every, strict=True):
            want = getattr(solve_pitch(attrs.evolve(given, centrifugal_force=force), law), name)
            np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * want.max())


def test_what_is_known_must_be_every_second_instant():
    known = solve_pitch(case(n_positions=2), palmgren())
    with pytest.raises(ValueError, match="known are 2 positions: of 6 it must be half"):
        solve_pitch(case(n_positions=6), palmgren(), known)


def test_half_of_a_roller_mirrors_the_other():
    """The same bearing with a profile that differs at one end by what no load can tell."""
    symmetric = case(slices=20, shape="iso16281", centrifugal_force=170.0)
    other = symmetric.drop.copy()
    other[0] += 1e-21
    found = solve_equilibrium(symmetric, palmgren())
    np.testing.assert_array_equal(found.inner_load, found.inner_load[..., ::-1])
    alike(found, solve_equilibrium(attrs.evolve(symmetric, drop=other), palmgren()))


class Counted(PowerLaw):
    """A contact law that counts how often it is asked, and for how many contacts."""

    requested: ClassVar = []

    def evaluate(self, slices):
        self.requested.append(slices.approach.size)
        super().evaluate(slices)


@pytest.mark.parametrize("Z", [5, 50, 500])
@pytest.mark.parametrize("n_positions", [1, 8])
def test_passes_do_not_grow_with_the_bearing(Z, n_positions):
    Counted.requested.clear()
    some = case(Z=Z, n_positions=n_positions, slices=11, shape="iso16281", radial_load=100.0 * Z)
    found = solve_pitch(some, rings(Counted(1e10, 10 / 9)))
    assert found.iterations <= 12
    # passes, both rings; half the instants and half of a roller, and 45 to estimate with
    solved = n_positions // 2 + 1
    assert sum(Counted.requested) <= 2 * found.iterations * solved * Z * 6 + 45
    assert len(Counted.requested) <= 2 * found.iterations * solved + 3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("Z", "slices", "n_positions", "misalignment"),
    [
        pytest.param(28, 101, 32, 0.0, marks=pytest.mark.soak),
        (28, 101, 32, 3e-4),
        pytest.param(500, 41, 16, 3e-4, marks=pytest.mark.soak),
        pytest.param(500, 21, 256, 3e-4, marks=pytest.mark.soak),
    ],
)
def test_memory_is_that_of_the_result(Z, slices, n_positions, misalignment):
    """Peak below three times inner_load and outer_load, where these are more than one part of the iteration."""
    some = case(
        Z=Z,
        n_positions=n_positions,
        slices=slices,
        shape="iso16281",
        misalignment=misalignment,
        radial_load=100.0 * Z,
    )
    tracemalloc.start()
    try:
        found = solve_pitch(some, palmgren())
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert found.iterations <= 30
    assert peak < 3 * (found.inner_load.nbytes + found.outer_load.nbytes)
    check(some, found, palmgren())


@pytest.mark.parametrize("broken", ["inner", "outer"])
def test_what_a_contact_law_refuses_is_said_of_whom_and_where(broken):
    """Lundberg's law ends where a contact is as wide as long; a NaN is refused of any law, compiled or not."""
    good = rings(Palmgren().deflection())[0]
    short = SimpleNamespace(
        conditions=Conditions(length=1e-5, radius=0.01, modulus=2.3e11),
        deflection=Chain(Lundberg().deflection()),
    )
    nan = rings(PowerLaw(np.nan, 1.0))[0]
    for bad, says in (
        (short, r"^lundberg-deflection: slice \d+ is outside its domain"),
        (nan, r"^power law: slice 0 gives a load that is not finite"),
    ):
        pair = (bad, good) if broken == "inner" else (good, bad)
        with pytest.raises(DomainError, match=says) as caught:
            solve_equilibrium(case(slices=5), pair)
        assert f"in a contact with the {broken} ring" in caught.value.__notes__


def test_an_error_of_a_contact_law_in_python_passes_through():
    class Faulty(PowerLaw):
        def evaluate(self, slices):
            raise ZeroDivisionError("of the law's own")

    with pytest.raises(ZeroDivisionError, match="of the law's own"):
        solve_equilibrium(case(), rings(Faulty(1e10, 1.0)))


@pytest.mark.slow
def test_tilted_rollers_of_many_slices_come_to_their_balance():
    """Edges touch and part while the ring moves: a twentieth of these ended short of it by ever smaller steps."""
    rng = np.random.default_rng(5)
    for _ in range(60):
        n = int(rng.choice([60, 200, 600]))
        length = 10.0 ** rng.uniform(-2.2, -1.0)
        x, w = np.polynomial.legendre.leggauss(n)
        found = solve_equilibrium(
            LoadCase(
                angular_positions(int(rng.integers(8, 32)), 1), length, np.zeros(n),
                radial_clearance=rng.uniform(-20e-6, 60e-6), radial_load=10.0 ** rng.uniform(-3.0, 5.0),
                misalignment=10.0 ** rng.uniform(-6.0, -2.7), centrifugal_force=[10.0 ** rng.uniform(-5.0, 3.0)],
                position=0.5 * length * x, widths=0.5 * length * w,
            ),
            iso16281(length),
        )  # fmt: skip
        assert max(found.force_residual, found.moment_residual) <= 1e-10


def test_load_no_roller_can_carry_is_reported_with_how_far_it_came():
    with pytest.raises(
        ConvergenceError, match=r"no equilibrium .* at 1 of 1 positions: relative residual of"
    ):
        solve_equilibrium(case(psi=[np.pi]), iso16281())


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"radial_load": -1.0}, "radial_load is -1.0 N"),
        ({"centrifugal_force": np.nan}, "centrifugal_force is nan N"),
        ({"radial_clearance": np.inf}, "radial_clearance is inf"),
        ({"misalignment": 1e-3}, "more than one slice"),
        ({"drop": np.array([0.0, np.inf])}, "drop must be finite"),
        ({"psi": np.zeros((0, 3))}, "psi must be finite and of shape"),
    ],
)
def test_unfit_load_cases_are_refused(changes, says):
    with pytest.raises(ValueError, match=says):
        case(**changes)
    with pytest.raises(ValueError, match="roller_length"):
        LoadCase(angular_positions(3, 1), 0.0, [0.0], 0.0, 1.0)
    with pytest.raises(ValueError, match="at least one of each"):
        angular_positions(0, 1)
