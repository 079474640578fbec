"""Random scenes over all that friction of a raceway depends on, and whether a run says where it is off.

For docs/scripts/promise.py and tests/planning/test_promise.py. Unlike the scenes of plan_scenes.py, which stand near
one bearing, these are bearings of any size, speed, load, oil, film, law, closure, profile, tilt and clearance. Scene k
depends on k alone, so that any slice of them can be run by itself.

A result is held against one on other slices (Gauss and Legendre), other instants and other slips, each at least four
times as many, and twice that where the verdict is close. It is *silent* if it errs by more than the tolerance and no
warning says so.
"""

import json
import math

import attrs
import numpy as np

from loading_branch_scenes import CONSTANT_ALPHA
from plan_scenes import Verdict
from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble
from rollslip.errors import RollslipError
from rollslip.planning.execution import execute
from rollslip.planning.plan import plan
from rollslip.studies.bounds import errors_between

STUDY = "effective-friction"
BASE = load_scene("1032930-70C")
CLOSURES = ("epicyclic", "outer-rolling", "free-roller")
CONTACTS = ("palmgren", "iso16281", "lundberg")
FILMS = (
    "moes", "regime", "dowson-1968", "dowson-higginson", "dowson-toyoda", "pan-hamrock", "martin", "herrebrugh", "blok",
    {"model": "inlet-correction", "film": "moes"},
)  # fmt: skip
LAWS = (
    "muraki", "eyring", "maxwell-eyring", "eyring-thermal", "newtonian-thermal", "carreau", "limiting-shear",
    "zhou-hoeprich", "gupta",
)  # fmt: skip
BLENDS = ("lambda-blend", "lambda-blend", "linear-blend", "greenwood-tripp", "")
OILS = (
    "mil-prf-7808", "mil-prf-23699", "sae-30", "santotrac-50", "iso-vg-32", "iso-vg-100", "iso-vg-320", "ipm-10",
    "b-3v", "fva-3", "pao-68",
)  # fmt: skip
#: Close verdicts are looked at twice as finely.
CLOSE = (0.5, 2.0)
#: Slices evaluated for a reference, beyond which a scene asks for four times the error: a second or two.
MOST = 1e7


def scene(k, seed=16):
    """The k-th scene."""
    rng = np.random.default_rng([seed, k])

    def of(options):
        return options[int(rng.integers(len(options)))]

    def even(low, high):
        return float(rng.uniform(low, high))

    def decades(low, high):
        return 10.0 ** even(math.log10(low), math.log10(high))

    diameter = decades(5e-3, 0.35)
    rollers = round(decades(7, 60))
    pitch = diameter / math.sin(math.pi / rollers) / even(0.6, 0.93)
    inner = pitch - diameter
    length = diameter * even(0.6, 2.0)
    clearance = of((0.0, 1.0, 1.0, -0.2)) * diameter * decades(1e-5, 3e-3)
    speed = decades(3e3, 1.5e6) / (1e3 * pitch)  # rpm, from n dm of 3e3 to 1.5e6 mm/min
    load = (
        rollers
        / 4.6
        * length
        * 2.0
        * math.pi
        * (0.5 * diameter)
        * decades(0.3e9, 2.5e9) ** 2
        / 2.3e11
    )
    law = of(LAWS)
    blend = of(BLENDS)
    rough = {
        part: f"{decades(0.02, 0.8)} um" for part in ("inner_raceway", "outer_raceway", "roller")
    }
    crown = {"shape": "circular", "radius": length**2 / diameter * even(20, 2e3)}
    profile = of(("none", "iso16281", "iso16281", crown))
    changes = {
        "bearing": {
            "rollers": rollers,
            "roller_diameter": diameter,
            "roller_length": length,
            "inner_raceway_diameter": inner,
            "outer_raceway_diameter": inner + 2.0 * diameter,
            "radial_clearance": clearance,
            "profile": profile,
        },
        "surface": {f"{part}_roughness": of_part for part, of_part in rough.items()},
        "lubricant": {
            "name": of(OILS),
            "conductivity": 0.14,
            "eyring_stress": f"{decades(1, 12)} MPa",
            "shear_modulus": f"{decades(0.03, 1)} GPa",
        },
        "operation": {
            "inner_speed": f"{speed} rpm",
            "outer_speed": f"{of((0.0, 0.0, 0.0, -0.1, 0.3)) * speed} rpm",
            "radial_load": load,
            "temperature": f"{even(20.0, 118.0)} degC",
            "misalignment": f"{of((0.0, 0.0, 1.0)) * decades(0.05, 3)} mrad",
        },
        "models": {
            "contact": of(CONTACTS),
            "film": of(FILMS),
            "traction": {"model": blend, "hydrodynamic": law} if blend else law,
        },
        f"study.{STUDY}": {
            "closure": of(CLOSURES),
            "max_cage_slip": of((0.05, 0.4, 0.6, 0.95)),
            "points": 26,
            "map_points": 0,
            "skidding_range": 0.0,
        },
        "accuracy": {"tolerance": 10.0 ** even(-5.0, -2.0), "slices": "auto"},
    }
    own = CONSTANT_ALPHA.get(changes["lubricant"]["name"], {})
    return evolve(BASE, changes | own, si=True)


def described(one):
    """What a scene is, in one line."""
    b = one.bearing
    o = one.operation
    m = one.models
    s = one.study[STUDY]
    law = m.traction.parameters.get("hydrodynamic")
    law = (
        m.traction.name
        if law is None
        else f"{m.traction.name} of {law['model'] if hasattr(law, 'keys') else law}"
    )
    return (
        f"{b.rollers} rollers of {b.roller_diameter * 1e3:.0f} mm; {o.inner_speed * 30 / np.pi:.3g} rpm; "
        f"{o.radial_load:.3g} N; {o.temperature - 273.15:.0f} degC; clearance {b.radial_clearance * 1e6:.0f} um; "
        f"tilt {o.misalignment * 1e3:.2f} mrad; {b.profile.shape}; {one.lubricant.name}; {m.contact.name}; "
        f"{m.film.name}; {law}; {s['closure']} to {s['max_cage_slip']:g}"
    )


@attrs.frozen
class Promise(Verdict):
    """What came of a scene: errors found beside those claimed; ``refused`` is why there are none.

    ``planned`` is the resolution that the run began with.
    """

    planned: dict = attrs.Factory(dict)
    compare_with: dict = attrs.Factory(dict)
    warned: tuple = ()

    @property
    def silent(self):
        """Whether it is off and says nothing."""
        return not self.kept and not self.warned


def finer(study, one, own, times):
    """The same on other slices, instants and slips, at least `times` as many of each."""
    straight = one.bearing.profile.shape == "none" and one.operation.misalignment == 0.0
    resolution = attrs.evolve(
        own,
        slices=1 if straight else min(max(times * own.slices, 96) + 1, 4001),
        quadrature="gauss",
        n_positions=min(max(times * (own.n_positions or 1), 24) + 1, 2047),
        traction="named",
        boundary=True,
    )
    every = 4 if study.closure == "free-roller" else 1
    dense = study.with_settings(points=every * (study.points - 1) + 1)
    return dense.run(assemble(one, resolution)).isel(cage_slip=slice(None, None, every))


def work(made):
    """About how many slices are evaluated for the reference of a plan."""
    study = made.studies[STUDY]
    own = made.choices[STUDY].resolution
    spins = 12 * 4 if study.closure == "free-roller" else 1
    slices = 1 if made.assembly.slices == 1 else own.slices
    return 16 * slices * (own.n_positions or 1) * made.scene.bearing.rollers * study.points * spins


def judge(one):
    """Run a scene as planned, and much finer."""
    try:
        made = plan(one, STUDY)
        while work(made) > MOST and one.accuracy.tolerance < 2e-3:
            one = evolve(one, {"accuracy.tolerance": 4.0 * one.accuracy.tolerance})
            made = plan(one, STUDY)
        if made.choices[STUDY].failed:
            return Promise(one, refused=made.choices[STUDY].failed)
        result = execute(made, STUDY)
        study = made.studies[STUDY]
        planned = made.choices[STUDY].resolution
        taken = json.loads(result.attrs["resolution"])
        own = attrs.evolve(planned, slices=taken["slices"], n_positions=taken["n_positions"])
        for times in (4, 8):
            actual = errors_between(study.controlled_outputs, result, finer(study, one, own, times))
            if not CLOSE[0] <= max(actual.values()) / one.accuracy.tolerance <= CLOSE[1]:
                break
    except RollslipError as error:
        return Promise(one, refused=str(error))
    rows = json.loads(result.attrs["accuracy"])
    return Promise(
        one,
        resolution=taken,
        planned=attrs.asdict(planned),
        estimated={row["result"]: row["estimated"] for row in rows},
        compare_with={row["result"]: row["found"] for row in rows},
        actual=actual,
        warned=tuple(
            w for w in json.loads(result.attrs["warnings"]) if " is off " in w and "accuracy." in w
        ),
    )
