"""Instruction sets: the one asked for runs, one that is not there is refused in words.

All sets that fuse multiply-adds give the same bits; the baseline of x86-64 cannot fuse, and differs by rounding.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fuzz import stages
from rollslip import Chain, evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_kernels.motion import planar
from rollslip_kernels.stages import simd
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings

SUPPORT = Path(__file__).parents[1] / "support"


#: Largest relative difference of a result of the baseline from the other sets'. Compared are all laws with inputs over
#: four decades, where the condition of the thermal laws lifts rounding a hundredfold.
ROUNDING = 1e-13


def run(code, name, *arguments):
    """Run Python code with the instruction set forced."""
    path = os.pathsep.join(filter(None, [str(SUPPORT), os.environ.get("PYTHONPATH")]))
    environment = os.environ | {"ROLLSLIP_SIMD": name, "PYTHONPATH": path}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], env=environment, capture_output=True, text=True
    )


def test_the_widest_set_runs_by_default():
    code = "from rollslip_kernels.stages import simd; print(simd.active())"
    environment = {name: value for name, value in os.environ.items() if name != "ROLLSLIP_SIMD"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == simd.available()[-1]
    assert simd.available()[0] == "baseline"


@pytest.mark.parametrize("name", ["avx9", ""])
def test_a_set_that_is_not_there_is_refused_in_words(name):
    done = run("from rollslip_kernels import chain", name)
    assert done.returncode != 0
    assert f"ROLLSLIP_SIMD = {name!r} names no instruction set of this machine" in done.stderr
    assert f"it has {', '.join(simd.available())}" in done.stderr


#: What every compiled stage fills: typical slices, all lengths of an odd end, and then wide ones.
FILLED = """
import sys
import numpy as np
from fuzz import stages
from rollslip import Chain
from rollslip.errors import DomainError
from rollslip_kernels.stages import simd

single, *_ = stages.stages()
rng = np.random.default_rng(7)
filled = {}
for model in single:
    for n in (*range(1, 10), 15, 16, 17, 257):
        for wide in (0.0, 2.0):
            slices = stages.table(stages.typical(n))
            varied = {"load", "approach", "rolling_speed", "sliding_speed", "film_thickness"}
            for column in sorted(model.reads & varied):
                getattr(slices, column)[:] *= np.exp(wide * rng.normal(size=n))
            name = f"{type(model).__module__} {model.name} {len(filled)}"
            try:
                Chain(model)(slices)
            except DomainError:
                filled[name] = np.full(1, np.nan)  # refused
            else:
                filled[name] = np.array([getattr(slices, column) for column in sorted(model.writes)])
np.savez(sys.argv[1], **filled)
print(simd.active())
"""


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """Instruction set -> what its stages fill."""
    found = {}
    for name in simd.available():
        file = tmp_path_factory.mktemp("filled") / f"{name}.npz"
        done = run(FILLED, name, str(file))
        assert done.returncode == 0, done.stderr[-2000:]
        assert done.stdout.split() == [name]
        found[name] = dict(np.load(file))
    stages_seen = {key.rpartition(" ")[0] for key in found["baseline"]}
    assert len(stages_seen) > 30
    refused = sum(np.isnan(values).all() for values in found["baseline"].values())
    assert refused < 200 < len(found["baseline"])  # most are computed
    return found


@pytest.mark.slow
def test_all_sets_that_fuse_give_the_same_bits(filled):
    fused = [values for name, values in filled.items() if name != "baseline"]
    for values in fused[1:]:
        assert values.keys() == fused[0].keys()
        for key, value in values.items():
            assert value.tobytes() == fused[0][key].tobytes(), key


@pytest.mark.slow
def test_the_baseline_differs_by_rounding(filled):
    widest = filled[simd.available()[-1]]
    assert widest.keys() == filled["baseline"].keys()
    for key, value in filled["baseline"].items():
        np.testing.assert_allclose(value, widest[key], rtol=ROUNDING, atol=1e-290, err_msg=key)


def test_neighbours_change_no_bit_of_a_slice():
    """Each stage of a table, again one slice at a time."""
    n = 300
    for model in stages.stages()[0]:
        whole = stages.table(stages.typical(n))
        whole.load[:] *= np.linspace(0.1, 3.0, n)
        whole.sliding_speed[:] *= np.linspace(-2.0, 2.0, n)
        whole.film_thickness[:] *= np.linspace(0.1, 2.0, n)
        whole.approach[:] *= np.linspace(-1.0, 2.0, n)
        alone = stages.table(stages.typical(n))
        alone._table[:] = whole._table
        Chain(model)(whole)
        Chain(model, block=1)(alone)
        for name in model.writes:
            np.testing.assert_array_equal(
                getattr(whole, name), getattr(alone, name), err_msg=model.name
            )


@pytest.mark.slow
def test_the_command_line_says_which_runs_and_refuses_what_is_not_there():
    def info(name):
        code = "from rollslip.cli import main; main(['info'])"
        return subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"ROLLSLIP_SIMD": name},
            capture_output=True,
            text=True,
        )

    assert "instructions  baseline, of baseline" in info("baseline").stdout
    refused = info("v9")
    assert refused.returncode == 2
    assert refused.stderr.startswith(
        "ROLLSLIP_SIMD = 'v9' names no instruction set of this machine"
    )


#: Rates of motions at all levels: loops over rollers are compiled for sets too, and tables come from stages.
RATES = """
import sys
import numpy as np
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip_studies.dynamics.levels.cage_and_rollers import carried_motion
from rollslip_studies.dynamics.levels.planar import PlanarSettings, planar_motion
from rollslip_studies.dynamics.levels.raceway_friction import FrictionSettings
from rollslip_kernels.stages import simd

scene = evolve(load_scene("1032930-50C"), {"accuracy.slices": 15, "accuracy.tolerance": 2e-2})
assembly, rng, found = assemble(scene), np.random.default_rng(3), {}
for name in ("effective", "conventional"):
    friction = FrictionSettings(name=name)
    for level in ("cage-set", "pocket", "planar"):
        if level == "planar":
            moving = planar_motion(assembly, PlanarSettings(inner_ring_mass=5.0), friction)
        else:
            moving = carried_motion(assembly, friction, level=level)
        for k in range(3):
            y = moving.initial(0.02, 0.03) * (1.0 + 1e-3 * rng.normal(size=moving.system.n))
            at = moving.split(y).get("pocket_position")
            if at is not None:
                at[:4] = 0.5 * assembly.cage.pocket_clearance + 1e-7 * np.arange(4)
            found[f"{name} {level} {k}"] = moving.system.rates(0.0, y)
            if level != "cage-set":
                found[f"{name} {level} {k} held"] = moving.system.linearised_rates(
                    0.0, y, 1e-5, y, 2e-6, np.zeros(y.size)
                )
np.savez(sys.argv[1], **found)
print(simd.active())
"""


#: An outer ring that bends in four harmonics and is made with three lobes; the list gives its section [m].
BENT = {
    "models.outer_ring": {"model": "annulus", "outside": "230 mm", "harmonics": 4},
    "bearing.outer_raceway.form": [{"lobes": 3, "amplitude": "5 um", "angle": "30 deg"}],
    "bearing.catalogue": {"bore": 0.15, "outside_diameter": 0.21, "width": 0.028},
}


@pytest.mark.parametrize("rings", [{}, BENT], ids=["rigid", "bent"])
@pytest.mark.parametrize("friction", ["effective", "conventional"])
def test_loops_over_rollers_give_the_same_bits_on_every_set(friction, rings, monkeypatch):
    """From the same tables, which stages make: the baseline too, since these loops fuse nothing."""
    scene = evolve(
        load_scene("1032930-50C"),
        {"accuracy.slices": 15, "accuracy.tolerance": 2e-2} | rings,
        si=True,
    )
    assembly = assemble(scene)
    rates = []
    for name in ("baseline", "v3"):
        monkeypatch.setattr(planar, "active", lambda name=name: name)
        moving = planar_motion(
            assembly, PlanarSettings(inner_ring_mass=5.0), FrictionSettings(name=friction)
        )
        y = moving.initial(0.02, 0.03)
        at = moving.split(y)
        at["pocket_position"][:4] = 0.5 * assembly.cage.pocket_clearance + 1e-7 * np.arange(4)
        at["cage_x"][...] = 3e-5
        system = moving.system
        held = system.linearised_rates(0.0, y, 1e-5, y, 2e-6, np.zeros(y.size))
        rates.append(
            (
                system.rates(0.0, y),
                held,
                system.linearised_rates(0.0, y, 1e-5, y, separate_contacts=True),
                system.go(0.0, 4e-6, 2, y),
            )
        )
    for one, other in zip(*rates, strict=True):
        assert one.tobytes() == other.tobytes()


@pytest.mark.soak
def test_rates_of_motions_are_the_same_bits_on_sets_that_fuse_and_differ_by_rounding_on_others(
    tmp_path,
):
    found = {}
    for name in simd.available():
        done = run(RATES, name, str(tmp_path / f"{name}.npz"))
        assert done.returncode == 0, done.stderr[-2000:]
        assert done.stdout.split() == [name]
        found[name] = dict(np.load(tmp_path / f"{name}.npz"))
    widest = found[simd.available()[-1]]
    assert len(widest) == 30
    for name, rates in found.items():
        for key, value in rates.items():
            if (
                name == "baseline"
            ):  # whose tables of effective friction choose their nodes by other roundings
                off = (1e-3 if "effective" in key else 1e-13) * np.abs(widest[key]).max()
                np.testing.assert_allclose(value, widest[key], rtol=0, atol=off, err_msg=key)
            else:
                assert value.tobytes() == widest[key].tobytes(), (name, key)
