"""Effective friction of the raceways: definition, closures, convergence, and what is known of its behaviour."""

import tracemalloc

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

import promise_scenes
from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import slip_grid
from rollslip.bearing.raceway import LoadedContacts
from rollslip.bearing.regimes import film_by_regime, groups, moes_groups, regime_limits
from rollslip.errors import SceneError
from rollslip.planning.execution import run
from rollslip.planning.plan import plan
from rollslip.results.accounts import account_of
from rollslip.results.curves import percent
from rollslip.scene.changes import evolve, parse_set
from rollslip.scene.reading import load_scene
from rollslip_kernels.slices import Slices
from rollslip_studies.effective_friction.raceways import LoadedRaceways, regime_fractions
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.friction_curve.study import FrictionCurve, balanced_load

STRAIGHT = evolve(load_scene("1032930-70C"), {"bearing.profile": "none"})


def curve(scene, **settings):
    defaults = {
        "closure": "epicyclic",
        "points": 21,
        "map_points": 0,
        "max_cage_slip": 0.9,
        "skidding_range": 0.0,
    }
    return EffectiveFriction(**{**defaults, **settings}).run(assemble(scene))


def contact_friction(assembly, ring, force, sliding, rolling):
    """Friction of one straight contact through the chain, by itself."""
    raceway = assembly.inner if ring == "inner" else assembly.outer
    load = np.array([force / assembly.scene.bearing.roller_length])
    return float(raceway.evaluate(load, rolling, sliding).friction[0])


@pytest.mark.parametrize("speed", [2700.0, 5000.0, -2600.0])
def test_curves_end_before_a_ring_turns_as_fast_as_the_cage(speed):
    """The slower ring of the same sense does: oil is drawn in up to the slip 1 - w_ring/w_cage, and not beyond."""
    speeds = {"operation.inner_speed": "3000 rpm", "operation.outer_speed": f"{speed} rpm"}
    scene = evolve(load_scene("gearbox"), speeds)
    k = assemble(scene).kinematics
    turning = [
        k.direction * ring / k.epicyclic_cage_speed for ring in (k.inner_speed, k.outer_speed)
    ]
    end = 1.0 - max(ring for ring in turning if ring < 1.0)
    largest = EffectiveFriction.from_scene(scene).max_cage_slip
    assert largest == pytest.approx(0.4 * min(end, 1.0), rel=1e-12)
    for slip, draws in ((largest, True), (1.001 * end, False)):
        # rollers that roll on the outer or on the inner ring: R S_c w_ce/(r w_re) is their slip
        scale = slip * k.epicyclic_cage_speed / (k.roller_radius * k.epicyclic_roller_speed)
        moving = [k.surface_speeds(slip, R * scale) for R in (k.outer_radius, -k.inner_radius)]
        rolling = [min(each.inner_rolling, each.outer_rolling) for each in moving]
        assert (min(rolling) > 0.0) == draws
    stated = evolve(scene, {"study.effective-friction.max_cage_slip": 0.3}, si=True)
    assert EffectiveFriction.from_scene(stated).max_cage_slip == 0.3


@pytest.mark.quick
@pytest.mark.parametrize("closure", ["epicyclic", "outer-rolling"])
def test_it_is_the_mean_by_force_over_loaded_rollers_and_instants(closure):
    assembly = assemble(STRAIGHT)
    result = curve(STRAIGHT, closure=closure)
    loads = assembly.load_distribution(result.attrs["n_positions"])
    k = assembly.kinematics
    slip = float(result.cage_slip[15])
    speeds = k.surface_speeds(
        slip, 0.0 if closure == "epicyclic" else k.roller_slip_outer_rolling(slip)
    )
    for ring, forces, sliding, rolling in (
        ("inner", loads.inner_force, speeds.inner_sliding, speeds.inner_rolling),
        ("outer", loads.outer_force, speeds.outer_sliding, speeds.outer_rolling),
    ):
        loaded = forces[forces > 0.0]
        pull = sum(q * contact_friction(assembly, ring, q, sliding, rolling) for q in loaded)
        got = float(result.effective_friction.sel(ring=ring)[15])
        # sums of 112 terms in another order; where the outer contact rolls its sliding speed here is rounding
        assert got == pytest.approx(pull / loaded.sum(), rel=1e-13, abs=1e-15)


@pytest.mark.quick
def test_unloaded_rollers_do_not_count():
    result = curve(STRAIGHT, per_roller=True)
    forces = result.normal_force.sel(ring="inner").to_numpy()
    friction = result.roller_friction.sel(ring="inner").to_numpy()
    assert 0 < (forces == 0.0).sum() < forces.size
    assert np.isnan(friction[forces == 0.0]).all()
    assert np.isfinite(friction[forces > 0.0]).all()


def test_a_free_roller_stays_on_its_balance_while_there_is_one():
    changes = {
        "operation.radial_load": "15.3 kN",
        "operation.inner_speed": "694 rad/s",
        "operation.temperature": "321.6 K",
        "operation.misalignment": "0.5 mrad",
        "bearing.radial_clearance": "42 um",
        "lubricant.eyring_stress": "7.07 MPa",
        "accuracy.slices": 21,
    }
    assembly = assemble(evolve(load_scene("1032930-70C"), changes, si=True))
    slips = slip_grid(0.9, 61)[1:]
    raceways = EffectiveFriction(closure="free-roller").loaded(assembly, 2)
    rolling = assembly.kinematics.roller_slip_outer_rolling(slips)
    found = (
        1.0 - raceways.speeds(slips).roller_speed / assembly.kinematics.epicyclic_roller_speed
    ) / rolling[:, None]
    # all balances of one roller at each slip, from where the difference of the pulls changes its sign on a fine grid
    roller = 2
    fractions = np.linspace(-0.85, 1.0, 1500)
    choices = 0
    inner = raceways.inner
    outer = raceways.outer
    for slip, lag, fraction in zip(slips, rolling, found[:, roller], strict=True):
        speeds = assembly.kinematics.surface_speeds(np.full(fractions.size, slip), lag * fractions)
        pulls = []
        for contacts, u, V in (
            (inner, speeds.inner_rolling, speeds.inner_sliding),
            (outer, speeds.outer_rolling, speeds.outer_sliding),
        ):
            mine = contacts.owner == roller
            slices = contacts.raceway.evaluate(
                np.tile(contacts.slices.load[mine], fractions.size),
                np.repeat(u, mine.sum()),
                np.repeat(V, mine.sum()),
            )
            pulls.append(slices.friction.reshape(fractions.size, -1) @ contacts.force[mine])
        off = pulls[0] - pulls[1]
        stable = fractions[:-1][(off[:-1] < 0.0) & (off[1:] >= 0.0)]
        choices += stable.size > 1
        assert np.abs(stable - fraction).min() < 2.0 * (fractions[1] - fractions[0])
    assert choices > 20  # else it could not have left one
    assert np.abs(np.diff(found[:, roller])).max() < 0.2


def test_a_free_roller_is_pulled_alike_by_both_rings():
    assembly = assemble(STRAIGHT)
    result = curve(STRAIGHT, closure="free-roller", per_roller=True)
    forces = result.normal_force.to_numpy()
    friction = result.roller_friction.to_numpy()
    loaded = forces[0] > 0.0
    pulls = forces[:, loaded, None] * friction[:, loaded]
    # the spin is found to 1e-12, and friction rises by its whole value over a slip of a few percent
    np.testing.assert_allclose(pulls[0], pulls[1], rtol=1e-9, atol=1e-12)
    # one roller at one slip, by another solver on the plain definition
    slip = 12
    roller = 0
    k = assembly.kinematics
    s = float(result.cage_slip[slip])

    def excess(roller_slip):
        v = k.surface_speeds(s, roller_slip)
        return forces[0, roller] * contact_friction(
            assembly, "inner", forces[0, roller], v.inner_sliding, v.inner_rolling
        ) - forces[1, roller] * contact_friction(
            assembly, "outer", forces[1, roller], v.outer_sliding, v.outer_rolling
        )

    outer = float(k.roller_slip_outer_rolling(s))
    root = brentq(excess, -outer * k.inner_radius / k.outer_radius, outer, xtol=1e-15)
    v = k.surface_speeds(s, root)
    want = contact_friction(assembly, "inner", forces[0, roller], v.inner_sliding, v.inner_rolling)
    assert friction[0, roller, slip] == pytest.approx(want, rel=1e-9)


@pytest.mark.quick
def test_outer_rolling_leaves_the_outer_ring_without_friction():
    result = curve(STRAIGHT, closure="outer-rolling")
    assert not result.effective_friction.sel(ring="outer").any()
    assert np.isnan(result.critical_cage_slip.sel(ring="outer"))
    assert (
        result.critical_status.sel(ring="outer")
        == "no slip at largest traction: there is no friction in the range"
    )


@pytest.mark.quick
def test_the_map_holds_the_curve_of_the_epicyclic_closure():
    result = curve(STRAIGHT, map_points=7)
    at_epicyclic = result.friction_map.sel(map_roller_slip=0.0)
    for j, slip in enumerate(result.map_cage_slip.to_numpy()):
        single = curve(STRAIGHT, points=5, max_cage_slip=max(slip, 0.01)).effective_friction[
            :, -1 if slip else 0
        ]
        # the tolerance of the instants, which the two runs may stop at differently
        np.testing.assert_allclose(at_epicyclic[:, j], single, rtol=2e-3, atol=1e-15)


@pytest.mark.quick
def test_the_instants_have_converged_and_the_estimate_is_honest():
    result = curve(STRAIGHT)
    fine = evolve(STRAIGHT, {"accuracy.tolerance": 1e-6})
    exact = curve(fine)
    assert exact.attrs["n_positions"] > result.attrs["n_positions"]
    scale = np.abs(exact.effective_friction).max("cage_slip")
    error = float((np.abs(result.effective_friction - exact.effective_friction) / scale).max())
    assert error <= result.attrs["positions_error"] <= 1e-3


@pytest.mark.quick
def test_the_critical_slip_is_the_maximum_of_the_continuous_curve():
    coarse = curve(STRAIGHT, points=11)
    fine = curve(STRAIGHT, points=2001)
    best = int(np.argmax(fine.effective_friction.sel(ring="inner").to_numpy()))
    spacing = float(fine.cage_slip[best + 1] - fine.cage_slip[best - 1])
    assert float(coarse.critical_cage_slip[0]) == pytest.approx(
        float(fine.cage_slip[best]), abs=spacing
    )
    assert float(coarse.critical_friction[0]) >= float(fine.effective_friction[0].max()) * (
        1 - 1e-12
    )
    assert coarse.critical_status[0] == "found"


@pytest.mark.quick
def test_a_critical_slip_outside_the_range_is_said_in_words():
    result = curve(STRAIGHT, max_cage_slip=0.3)
    assert np.isnan(result.critical_cage_slip).all()
    assert all(
        "still rises at the end of the range, 0.3" in str(text)
        for text in result.critical_status.to_numpy()
    )


@pytest.mark.quick
def test_what_a_status_tells_one_to_type_finds_what_was_not_found():
    scene = evolve(
        STRAIGHT,
        {"study.effective-friction": {"points": 21, "map_points": 0, "max_cage_slip": 0.3}},
    )
    short = run(scene, "effective-friction").critical_status.to_numpy()[0]
    key, value = parse_set(str(short).rpartition(" --set ")[2])
    assert np.isfinite(
        run(evolve(scene, {key: value}, si=True), "effective-friction").critical_cage_slip[0]
    )


@pytest.mark.quick
def test_the_first_of_two_maxima_is_told_where_the_critical_slip_is():
    """Rough surfaces at 90 degC: boundary friction has its maximum at 1 % of slip, the film one far beyond."""
    rough = dict.fromkeys(
        ("inner_raceway_roughness", "outer_raceway_roughness", "roller_roughness"), "0.5 um"
    )
    scene = evolve(
        STRAIGHT,
        {"operation.radial_load": 500.0, "operation.temperature": "90 degC", "surface": rough},
        si=True,
    )
    result = curve(scene, points=61, max_cage_slip=0.95)
    inner = result.sel(ring="inner")
    first = float(inner.first_maximum_slip)
    critical = float(inner.critical_cage_slip)
    assert first < 0.02 < 0.7 < critical
    fine = np.linspace(0.8 * first, 1.2 * first, 41)
    raceways = EffectiveFriction(closure=result.attrs["closure"]).loaded(
        assemble(scene), result.attrs["n_positions"]
    )
    friction = raceways.curve(fine)[0]
    assert fine[np.argmax(friction)] == pytest.approx(first, rel=0.01)
    assert float(inner.first_maximum_friction) == pytest.approx(friction.max(), rel=1e-5)
    dip = raceways.curve(np.linspace(first, critical, 50))[0].min()
    assert dip < 0.999 * friction.max() < float(inner.critical_friction)
    sentences = [text for text in account_of(result).sentences(result) if " ring: " in text]
    told = sentences[0]
    assert f"it falls with slip already from {percent(first)} on, a first maximum of" in told
    assert told in account_of(result).lines(result)
    assert account_of(result).record(result)["inner ring"]["first_maximum_slip"] == first
    outer = sentences[1]
    assert "no slip at largest traction" in outer
    assert "falls with slip already from" in outer, (
        "also where friction rises to the end of the range"
    )


@pytest.mark.quick
def test_a_single_maximum_is_told_once():
    result = curve(STRAIGHT)
    assert float(result.first_maximum_slip[0]) == float(result.critical_cage_slip[0])
    assert not any(
        "already" in text
        for text in account_of(result).sentences(result) + account_of(result).lines(result)
    )


@pytest.mark.quick
def test_nobody_is_told_to_look_beyond_the_end_of_the_range():
    words = str(curve(STRAIGHT, points=9, max_cage_slip=0.995).critical_status.to_numpy()[1])
    assert (
        words == "no slip at largest traction: friction still rises at the end of the range, 0.995"
    )


@given(load=st.floats(500.0, 5e3), factor=st.floats(1.2, 3.0))
@settings(max_examples=10)
def test_more_load_gives_less_slip(load, factor):
    """At a given drag torque the cage slips less under more load: the pull sum(mu Q) rises with it at every slip."""
    pulls = []
    for force in (load, load * factor):
        scene = evolve(
            STRAIGHT, {"operation.radial_load": force, "accuracy.tolerance": 1e-2}, si=True
        )
        result = curve(scene, points=7, max_cage_slip=0.1)
        forces = (
            assemble(scene)
            .load_distribution(result.attrs["n_positions"])
            .inner_force.sum(axis=1)
            .mean()
        )
        pulls.append(result.effective_friction.sel(ring="inner").to_numpy()[1:] * forces)
    assert (pulls[1] > pulls[0]).all()


@pytest.mark.quick
def test_mirrored_rotation_gives_the_same_curve():
    there = curve(STRAIGHT)
    back = curve(evolve(STRAIGHT, {"operation.inner_speed": "-6371 rpm"}))
    np.testing.assert_array_equal(there.effective_friction, back.effective_friction)


@pytest.mark.parametrize("closure", ["epicyclic", "outer-rolling", "free-roller"])
def test_friction_drives_the_cage_whichever_ring_turns(closure):
    """Both rings drive a cage that is slower than epicyclic, also where the outer ring turns or turns backwards."""
    driven = {"operation.inner_speed": "0 rpm", "operation.outer_speed": "6371 rpm"}
    for changes in (driven, driven | {"operation.outer_speed": "-6371 rpm"}):
        result = curve(
            evolve(STRAIGHT, changes, si=True),
            closure=closure,
            per_roller=True,
            map_points=3,
            max_cage_slip=0.5,
        )
        assert (result.effective_friction.sel(ring="inner")[1:] > 0.0).all()
        assert (result.effective_friction >= 0.0).all()
        # a roller without inner load rolls on the outer ring, up to the rounding of its spin
        assert np.nanmin(result.roller_friction) > -1e-15
        assert "no friction" not in str(result.critical_status.sel(ring="inner").item())


@pytest.mark.quick
def test_nothing_loaded_is_refused_in_words():
    scene = evolve(STRAIGHT, {"operation.radial_load": "0 N", "bearing.radial_clearance": "20 um"})
    with pytest.raises(
        SceneError,
        match=r"operation\.radial_load: no roller is loaded .* raise operation\.radial_load",
    ):
        curve(scene)
    preloaded = evolve(scene, {"bearing.radial_clearance": "-5 um"})
    assert np.isfinite(curve(preloaded).effective_friction).all()


@pytest.mark.quick
def test_a_contact_with_a_profile_carries_its_force():
    assembly = assemble(load_scene("1032930-30C"))
    result = FrictionCurve(normal_force=(300.0, 518.0), points=11).run(assembly)
    straight = FrictionCurve(normal_force=(300.0, 518.0), points=11).run(
        assemble(evolve(load_scene("1032930-30C"), {"bearing.profile": "none"}))
    )
    assert (result.pressure > straight.pressure).all()
    w = 300.0 / 0.015
    modulus = 208e9 / (1 - 0.3**2)
    radius = 1 / (1 / 0.0075 + 1 / 0.0825)
    half_width = np.sqrt(8 * w * radius / (np.pi * modulus))
    assert float(straight.half_width[0]) == pytest.approx(half_width, rel=1e-14)
    assert float(straight.pressure[0]) == pytest.approx(w / (2 * half_width), rel=1e-14)


@pytest.mark.quick
def test_friction_curve_has_the_thermal_branch_of_the_paper():
    """Fig. 1: at 30 degC friction falls with slip beyond a maximum, and earlier under the larger force."""
    result = FrictionCurve(normal_force=(300.0, 518.0), points=101).run(
        assemble(load_scene("1032930-30C"))
    )
    early = float(result.critical_slip[1])
    late = float(result.critical_slip[0])
    assert 0.0 < early < late < 0.3
    for k in range(2):
        falling = (
            result.friction[k].where(result.slip > result.critical_slip[k], drop=True).to_numpy()
        )
        assert (np.diff(falling) < 0.0).all()


@pytest.mark.quick
@pytest.mark.parametrize(
    "profile",
    [
        "none",
        "iso16281",
        {"shape": "circular", "radius": "5 m"},
        {
            "shape": "table",
            "position": ["-7.5 mm", "-5 mm", "5 mm", "7.5 mm"],
            "drop": ["8 um", "0 um", "0 um", "8 um"],
        },
    ],
    ids=["none", "iso16281", "circular", "table"],
)
def test_every_profile_of_a_scene_reaches_the_contacts(profile):
    assembly = assemble(
        evolve(
            STRAIGHT, {"bearing.profile": profile, "operation.misalignment": "0.1 mrad"}, si=True
        )
    )
    loads = assembly.load_distribution()
    assert loads.inner_force[0, 0] > 0.0
    assert loads.force_residual < 1e-10
    assert loads.moment_residual < 1e-10
    drop = assembly.drop - assembly.drop.min()
    assert (drop.max() > 1e-6) == (profile != "none")
    np.testing.assert_allclose(drop, drop[::-1], atol=1e-18)


@pytest.mark.quick
def test_a_profile_that_does_not_cover_the_roller_is_refused():
    table = {"shape": "table", "position": ["-5 mm", "5 mm"], "drop": ["0 um", "0 um"]}
    with pytest.raises(SceneError, match=r"bearing\.profile: "):
        assemble(evolve(STRAIGHT, {"bearing.profile": table}, si=True))


def plainly(assembly, loads, speeds, orbit=1.0):
    """Friction of every slice of every roller, unmerged, and its mean by force; for each ring."""
    for raceway, load, u, V in (
        (assembly.inner, loads.inner_load, speeds.inner_rolling, speeds.inner_sliding),
        (assembly.outer, loads.outer_load, speeds.outer_rolling, speeds.outer_sliding),
    ):
        slices = raceway.evaluate(load[load > 0.0], u, V)
        yield slices, float((slices.friction * slices.load).sum() / slices.load.sum())


@pytest.mark.quick
@pytest.mark.parametrize(
    "changes", [{}, {"operation.misalignment": "0.3 mrad"}, {"bearing.rollers": 27}], ids=str
)
@pytest.mark.parametrize("n_positions", [1, 2, 3])
def test_contacts_that_mirror_each_other_count_as_often_as_they_are_there(changes, n_positions):
    assembly = assemble(
        evolve(load_scene("1032930-70C"), {"accuracy.slices": 21} | changes, si=True)
    )
    loads = assembly.load_distribution(n_positions)
    raceways = LoadedRaceways(assembly, loads, "epicyclic")
    slip = np.array([0.02, 0.3])
    curve, film = raceways.evaluated(raceways.speeds(slip))
    fractions, largest, light = raceways.regimes(raceways.speeds(slip))
    wanted = np.zeros((2, 4)), np.zeros(2), np.zeros(2)
    for k, s in enumerate(slip):
        for i, (slices, mean) in enumerate(
            plainly(assembly, loads, assembly.kinematics.surface_speeds(s, 0.0))
        ):
            assert curve[i, k] == pytest.approx(mean, rel=1e-12)
            roughness = slices.conditions.roughness
            assert film[i, k] == pytest.approx(slices.film_thickness.min() / roughness, rel=1e-12)
            force = slices.load / slices.load.sum() / 2
            M = moes_groups(slices)[0]
            wanted[0][i] += np.bincount(film_by_regime(*groups(slices))[1].astype(int), force, 4)
            wanted[1][i], wanted[2][i] = (
                max(wanted[1][i], M.max()),
                wanted[2][i] + force[M < 2.0].sum(),
            )
    for found, plain in zip((fractions, largest, light), wanted, strict=True):
        np.testing.assert_allclose(found, plain, rtol=1e-11, atol=1e-13)
    whole = (np.count_nonzero(loads.inner_load) + np.count_nonzero(loads.outer_load)) / (
        1 if "misal" in str(changes) else 2
    )
    assert raceways.inner.force.size + raceways.outer.force.size < 0.56 * whole + 42


@pytest.mark.quick
def test_regimes_of_free_rollers_are_those_of_each_slice():
    assembly = assemble(evolve(load_scene("1032930-70C"), {"accuracy.slices": 5}))
    raceways = LoadedRaceways(assembly, assembly.load_distribution(1), "free-roller")
    speeds = raceways.speeds(np.array([0.0, 0.2]))
    assert speeds.inner_rolling.shape == (2, 15)
    contacts = raceways.inner
    want = np.zeros(4)
    for u in speeds.inner_rolling:
        table = Slices(contacts.force.size, contacts.raceway.conditions, load=contacts.slices.load)
        table.rolling_speed[:] = u[contacts.owner]
        want += np.bincount(film_by_regime(*groups(table))[1].astype(int), contacts.force, 4) / (
            2 * contacts.total
        )
    np.testing.assert_allclose(
        regime_fractions(contacts, speeds.inner_rolling)[0], want, atol=1e-14
    )


@pytest.mark.quick
@given(
    st.floats(-14, -8),
    st.one_of(st.just(0.0), st.floats(1e2, 1e5)),
    st.lists(st.floats(-8, -2), min_size=1, max_size=9),
)
def test_limits_of_the_film_regimes_are_where_the_codes_change(U, G, W):
    U = 10.0**U
    W = 10.0 ** np.array(W)
    elastic, piezoviscous, both = regime_limits(U, G)
    apart = np.min(
        [np.abs(W / limit - 1.0) for limit in (elastic, piezoviscous, both) if np.isfinite(limit)],
        axis=0,
    )
    W = W[apart > 1e-9]
    code = np.where(piezoviscous < W, np.where(both < W, 3.0, 1.0), np.where(elastic < W, 2.0, 0.0))
    np.testing.assert_array_equal(code, film_by_regime(U, G, W)[1])


@pytest.mark.quick
@pytest.mark.parametrize("film", ["moes", "regime"])
def test_the_map_is_that_of_all_slices(film):
    assembly = assemble(
        evolve(load_scene("1032930-70C"), {"accuracy.slices": 41, "models.film": film}, si=True)
    )
    loads = assembly.load_distribution(2)
    cage, roller, surface = LoadedRaceways(assembly, loads, "epicyclic").map(0.9, 5)
    scale = np.abs(surface).max(axis=(1, 2))
    for j, k in ((0, 0), (1, 3), (2, 8), (4, 5), (4, 0)):
        speeds = assembly.kinematics.surface_speeds(cage[j], roller[k])
        for ring, (_, mean) in enumerate(plainly(assembly, loads, speeds)):
            # held to 1e-6 at a dozen points; between them it may be somewhat more
            assert surface[ring, j, k] == pytest.approx(mean, abs=3e-6 * scale[ring])


@given(st.floats(-8, 7), st.sampled_from(["none", "iso16281"]))
def test_a_contact_carries_the_force_that_the_library_finds(exponent, profile):
    assembly = assemble(
        evolve(
            load_scene("1032930-30C"), {"bearing.profile": profile, "accuracy.slices": 31}, si=True
        )
    )
    force = 10.0**exponent
    row = balanced_load(assembly, assembly.inner, force)
    assert row @ assembly.widths == pytest.approx(force, rel=1e-13)
    if assembly.slices > 1:
        drop = assembly.drop - assembly.drop.min()
        approach = brentq(
            lambda d: assembly.deflect(d - drop, "inner")[0] @ assembly.widths / force - 1.0,
            0.0, 1.0, xtol=5e-324, rtol=1e-14, maxiter=2000,
        )  # fmt: skip
        want = assembly.deflect(approach - drop, "inner")[0]
        np.testing.assert_allclose(row, want, rtol=1e-10, atol=1e-12 * row.max())


# Growth -------------------------------------------------------------------------------------------------------------


def evaluated(**changes):
    """Slices per pass of a chain for a study of 21 points at two instants of a pitch."""
    small = {
        "bearing.roller_diameter": "1 mm",
        "bearing.inner_raceway_diameter": "165 mm",
        "bearing.outer_raceway_diameter": "167 mm",
        "accuracy.slices": 21,
    }
    scene = evolve(load_scene("1032930-70C"), small | changes, si=True)
    passes = []
    assembly = assemble(scene).with_bounds(lambda slices: passes.append(len(slices)))
    EffectiveFriction(
        closure="epicyclic", points=21, map_points=0, skidding_range=0.0
    ).at_positions(assembly, 2)
    # how many locating the maximum takes is up to the rounding of the loads, but for its bound on each ring
    assert len(passes) <= 2 * (21 + 60)
    return sum(passes) / len(passes)


def test_work_grows_as_rollers_and_slices_do():
    base = evaluated(**{"bearing.rollers": 20, "operation.radial_load": 2e3})
    many = evaluated(**{"bearing.rollers": 200, "operation.radial_load": 2e4})
    fine = evaluated(
        **{"bearing.rollers": 20, "operation.radial_load": 2e3, "accuracy.slices": 210}
    )
    assert 8.0 < many / base < 12.0
    assert 8.0 < fine / base < 12.0


def test_memory_is_that_of_the_loads():
    """Peak of the whole study below three times inner_load and outer_load, which it holds, and the tables of slices."""
    assembly = assemble(evolve(load_scene("1032930-70C"), {"accuracy.slices": 401}))
    study = EffectiveFriction(closure="epicyclic", points=11, map_points=5, skidding_range=0.0)
    study.at_positions(assembly, 2)  # xarray is loaded
    tracemalloc.start()
    try:
        study.at_positions(assembly, 16)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    loads = assembly.load_distribution(16)
    requested = loads.inner_load.nbytes + loads.outer_load.nbytes
    tables = sum(
        LoadedContacts(raceway, load.reshape(-1, 401), assembly.widths, 1.0).slices._table.nbytes
        / 2
        for raceway, load in (
            (assembly.inner, loads.inner_load),
            (assembly.outer, loads.outer_load),
        )
    )
    assert peak < 3 * (requested + tables)


@pytest.mark.parametrize(
    "k", [11, 250, *(pytest.param(k, marks=pytest.mark.soak) for k in (82, 99, 123))]
)
def test_the_curve_of_free_rollers_does_not_depend_on_the_slips_that_are_asked_for(k):
    """Rollers of random bearings that have several balances, or come to have them between two slips.

    Alone, among few slips and among many, and in any order.
    """
    one = promise_scenes.scene(k)
    study = plan(one, "effective-friction").studies["effective-friction"]
    assembly = assemble(one)
    slices = 16 if assembly.slices > 1 else 1
    assembly = assembly.at(
        attrs.evolve(assembly.resolution, slices=slices, quadrature="equal", n_positions=8)
    )
    few, many = (slip_grid(study.max_cage_slip, points) for points in (26, 201))
    expected = study.loaded(assembly, 8).curve(many)[:, ::8]
    largest = expected.max()
    np.testing.assert_allclose(
        study.loaded(assembly, 8).curve(few), expected, rtol=0, atol=1e-7 * largest
    )
    np.testing.assert_allclose(
        study.loaded(assembly, 8).curve(few[[9]]), expected[:, [9]], rtol=0, atol=1e-7 * largest
    )
    downwards = study.loaded(assembly, 8)
    for j in (20, 12, 5):
        np.testing.assert_allclose(
            downwards.curve(few[[j]]), expected[:, [j]], rtol=0, atol=1e-7 * largest
        )
