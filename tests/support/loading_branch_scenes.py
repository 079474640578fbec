"""Random scenes on which the way up of the rollers is held against finer ones, and against motion in time.

Free bearings are a paper's with another size, oil, load and speed; bearings of the catalogue are as ``rollslip new``
writes them, with rolling resistance and hysteresis, or without. Each number gives the same scene always.
"""

import tempfile
from pathlib import Path
from unittest import mock

import attrs
import numpy as np
from click.testing import CliRunner

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli
from rollslip_studies.motion import loading_branch
from rollslip_studies.motion.torque_balance import RANGE, TorqueBalance

#: Seeds of the three kinds: the same number of a scene gives other random values in each.
FREE = 7
#: Seed of bearings of the catalogue.
CATALOGUE = 11
#: Seed of wide scenes.
WIDE = 13
OILS = ("mil-prf-7808", "mil-prf-23699", "sae-30", "santotrac-50")
#: What was recorded of these scenes was computed with the coefficient of the oil's source, which is constant.
CONSTANT_ALPHA = {
    "sae-30": {
        "lubricant.pressure_viscosity": "19 1/GPa",
        "lubricant.pressure_thermoviscosity": "0 1/(GPa K)",
    }
}
#: ISO VG grades of the oils in bearings of the catalogue [mm2/s at 40 degC].
GRADES = (32, 46, 68, 100, 150, 220)
SERIES = {
    "NU2": ("05", "08", "10", "14", "18", "20", "24", "32"),
    "N10": ("08", "10", "12", "14", "16", "18", "20", "22", "24"),
    "NJ3": ("05", "07", "09", "12", "16", "20"),
    "NU3": ("06", "08", "10", "14", "18", "22"),
    "NU22": ("05", "08", "10", "12", "16", "20"),
}
RESISTING = ["rolling-resistance", "hysteresis", "churning"]
#: Diameter of a raceway times speed that no bearing exceeds [mm rpm].
FASTEST = 1.5e6


def free(number, *, even=False):
    """A free bearing; ``even`` without profile and tilt, so that one slice stands for all."""
    u = np.random.default_rng([FREE, number]).uniform(size=16)
    base = load_scene("1032930-70C")
    size = 0.4 * 3.5 ** u[0]
    roughness = f"{0.02 * 20.0 ** u[11]} um"
    sizes = ("roller_diameter", "roller_length", "inner_raceway_diameter", "outer_raceway_diameter")
    return evolve(
        base,
        {
            **{f"bearing.{name}": size * getattr(base.bearing, name) for name in sizes},
            "bearing.profile": "none" if even or u[15] < 0.5 else "iso16281",
            "bearing.radial_clearance": f"{-5.0 + 50.0 * u[5]} um",
            "operation.radial_load": 300.0 * 60.0 ** u[2] * size**2,
            "operation.inner_speed": f"{50.0 * 120.0 ** u[3]} rpm",
            "operation.temperature": f"{30.0 + 70.0 * u[4]} degC",
            "operation.misalignment": f"{0.0 if even else max(u[6] - 0.5, 0.0)} mrad",
            "lubricant.name": OILS[int(4.0 * u[7])],
            **CONSTANT_ALPHA.get(OILS[int(4.0 * u[7])], {}),
            "lubricant.conductivity": 0.14,
            "lubricant.eyring_stress": f"{1.0 + 9.0 * u[8]} MPa",
            "lubricant.pressure_viscosity_law": ("barus", "roelands")[int(2.0 * u[9])],
            "models.traction": {
                "model": "lambda-blend",
                "hydrodynamic": ("muraki", "maxwell-eyring", "eyring")[int(3.0 * u[10])],
            },
            "surface.inner_raceway_roughness": roughness,
            "surface.roller_roughness": roughness,
        },
        si=True,
    )


def catalogue(number, *, resists=True, even=False):
    """A bearing of the catalogue, 500 to 14,000 rpm as its size allows, lightly loaded.

    It names its law: numbers of scenes were looked for with it, and what is recorded of them was computed with it.
    """
    u = np.random.default_rng([CATALOGUE, number]).uniform(size=8)
    series = list(SERIES)[int(len(SERIES) * u[0])]
    bore = SERIES[series][int(len(SERIES[series]) * u[1])]
    diameter = 5.0 * int(bore)
    speed = min(500.0 * 28.0 ** u[3], 6e5 / (1.4 * diameter))
    requested = {
        "--bearing": series + bore,
        "--oil": f"iso-vg-{GRADES[int(6.0 * u[2])]}",
        "--speed": f"{speed:.0f} rpm",
        "--load": f"{0.02 * diameter**2 * 100.0 ** u[4]:.0f} N",
        "--temperature": f"{40.0 + 60.0 * u[5]:.0f} degC",
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        made = CliRunner().invoke(
            cli, ["new", str(path), *(part for pair in requested.items() for part in pair)]
        )
        assert made.exit_code == 0, made.output
        scene = load_scene(path)
    changes = {
        "cage.drag": RESISTING if resists else ["churning"],
        "models.traction.hydrodynamic": "maxwell-eyring",
    }
    return evolve(scene, changes | ({"bearing.profile": "none"} if even else {}), si=True)


def wide(number):
    """One of both at 0.5 to 15,000 rpm, lightly loaded, also with outer rings that turn and friction in pockets."""
    u = np.random.default_rng([WIDE, number]).uniform(size=9)
    scene = free(number) if u[0] < 0.4 else catalogue(number, resists=u[1] < 0.6)
    raceway = 1e3 * scene.bearing.inner_raceway_diameter
    speed = min(0.5 * 30_000.0 ** u[2], FASTEST / raceway)
    drags = [*(RESISTING if u[0] >= 0.4 and u[1] < 0.6 else ["churning"])]
    if u[3] < 0.35:
        drags.append({"model": "pocket-friction", "coefficient": 0.01 * 15.0 ** u[4]})
    return evolve(
        scene,
        {
            "operation.inner_speed": f"{speed} rpm",
            "operation.outer_speed": f"{speed * (-0.5 + 1.2 * u[5]) if u[6] < 0.3 else 0.0} rpm",
            "operation.radial_load": 0.0
            if u[7] < 0.1
            else scene.operation.radial_load * 100.0 ** -u[7],
            "bearing.radial_clearance": f"{-6.0 + 20.0 * u[8]} um",
            "cage.drag": drags,
        },
        si=True,
    )


def balance(scene, *, slices=12, positions=56, inertia=True):
    """Its balance of torques, at the fewest instants with so many positions."""
    made = assemble(scene)
    n_positions = -(-positions // scene.bearing.rollers)
    few = made.at(
        attrs.evolve(made.resolution, slices=min(slices, made.slices), n_positions=n_positions)
    )
    resisting = few.with_resistance()
    return TorqueBalance(resisting, resisting.cage.drags, n_positions=n_positions, inertia=inertia)


def doubling_jump(branch):
    """The first jump of a branch that at least doubles the slip, or leads nowhere; None without one."""
    return next((jump for jump in branch.jumps if not jump.slip_after < 2.0 * jump.slip), None)


def finer(one, times):
    """The same with so many times the positions."""
    return TorqueBalance(
        one.assembly, one.drags, n_positions=times * one.n_positions, inertia=one.inertia
    )


def dense_branch(one):
    """Its loading branch, found on five times as many slips."""
    denser = attrs.evolve(loading_branch.SEARCH, grid_step=0.2 * loading_branch.SEARCH.grid_step)
    with mock.patch.object(loading_branch, "SEARCH", denser):
        return loading_branch.find_loading_branch(one._reduced_motions, RANGE, one.motions)
