"""Random scenes of everything that a scene may describe, for tools/references/varied_scenes.py.

`promise_scenes` and `loading_branch_scenes` have cages on rigid, round rings. These are of all families of bearings
that `rollslip.new` knows, with rings that bend and are not round, planets on carriers, backward turning, axial load,
tilt, preload, every supply of oil, catalogue oils and own ones, and pockets with play and without. Scene k depends on k
alone.
"""

import math

import numpy as np

import rollslip
from rollslip import evolve

#: Seed that no other set of scenes has.
SEED = 61
NAMES = {
    "cage": ("NU", "NU", "NJ", "NUP"),
    "full complement": ("NCF3008V", "NCF2210V", "SL192310", "NCF2224V", "NCF3034V", "NJG2316VH"),
    "needle": ("HK1516", "HK3520", "NK20/16", "NK45/30", "NK90/35", "NKI20/16", "NKI50/25"),
    "tapered": ("30203", "30212", "32209", "32216", "32224"),
}
SIZES = ("205", "210", "216", "230", "306", "312", "316", "2210", "2216", "2312", "1012", "1020")
OILS = (
    "b-3v", "fva-3", "ipm-10", "iso-vg-32", "iso-vg-68", "iso-vg-150", "iso-vg-320", "mil-prf-23699", "mil-prf-7808",
    "pao-68", "sae-30", "santotrac-50", "tp-22s",
)  # fmt: skip
SUPPLIES = ("bath", "splash", "circulating", "jet", "mist", "grease")
#: Mean diameter times speed that no bearing exceeds [m rpm].
FASTEST = 1.2e3


class Draw:
    """Random values of one scene."""

    def __init__(self, k):
        self._rng = np.random.default_rng([SEED, k])

    def one(self, *options):
        """One of the options."""
        return options[int(self._rng.integers(len(options)))]

    def chance(self, probability):
        """Whether something is so."""
        return self._rng.uniform() < probability

    def even(self, low, high):
        """A number between both, evenly."""
        return float(self._rng.uniform(low, high))

    def decades(self, low, high):
        """A number between both, evenly in its logarithm."""
        return math.exp(self.even(math.log(low), math.log(high)))


def scene(k):
    """The k-th scene; `SceneError` where rollslip refuses it."""
    draw = Draw(k)
    family = draw.one("cage", "cage", "cage", *NAMES)
    name = draw.one(*NAMES[family]) + (draw.one(*SIZES) if family == "cage" else "")
    base = rollslip.new(name, oil=draw.one(*OILS), supply=draw.one(*SUPPLIES))
    tapered = base.bearing.contact_angle is not None
    mean = base.bearing.pitch_diameter
    speed = min(draw.decades(0.5, 15e3), FASTEST / mean)
    load = base.bearing.rollers / 4.6 * base.bearing.roller_length * 2.0 * math.pi
    load = load * (0.5 * base.bearing.roller_diameter) * draw.decades(0.15e9, 2e9) ** 2 / 2.3e11
    turns = draw.one(1.0, 1.0, -1.0)
    outer = draw.even(-0.6, 0.7) if draw.chance(0.25) else 0.0
    changes = {
        "operation.inner_speed": f"{turns * speed} rpm",
        "operation.outer_speed": f"{turns * outer * speed} rpm",
        "operation.radial_load": load,
        "operation.temperature": f"{draw.even(20.0, 110.0)} degC",
        "study.steady-slip.pockets": draw.one("play", "play", "set"),
    }
    if tapered or (base.bearing.ribs is not None and draw.chance(0.7)):
        share = math.tan(base.bearing.contact_angle) * draw.decades(0.8, 4.0) if tapered else 0.0
        changes["operation.axial_load"] = load * (share or draw.even(0.02, 0.6))
    if draw.chance(0.3) and not tapered:
        changes["operation.misalignment"] = f"{draw.decades(0.05, 2.0)} mrad"
    if draw.chance(0.3) and not tapered:
        changes["bearing.radial_clearance"] = mean * draw.even(-2e-4, 1e-3)
    changes |= ({} if tapered else _rings(draw, base)) | _surroundings(draw, base, speed, mean)
    return evolve(base, changes, si=True)


def _rings(draw, base):
    """Rings that bend, and raceways that are not round."""
    catalogue = base.bearing.catalogue
    changes = {}
    if draw.chance(0.3):
        changes["models.outer_ring"] = draw.one(
            {"model": "annulus", "outside": catalogue.outside_diameter * draw.even(1.05, 1.6)},
            {"model": "thin", "seat_stiffness": draw.one(0.0, 1e9, 1e11)},
            {"model": "thin", "seat_stiffness": 1e10, "fit_clearance": draw.decades(1e-6, 1e-4)},
        )
    if catalogue.bore is not None and draw.chance(0.15):
        changes["models.inner_ring"] = {
            "model": "annulus",
            "bore": catalogue.bore * draw.one(0.0, 0.5, 0.8),
        }
    if draw.chance(0.25):
        wave = {
            "lobes": draw.one(2, 3, 4, 5, 7, 9),
            "amplitude": draw.decades(5e-7, 3e-5),
            "angle": draw.even(0.0, math.pi),
        }
        ring = draw.one("inner", *7 * ("outer",))  # a form that turns against the load is refused
        changes[f"bearing.{ring}_raceway.form"] = [wave]
    return changes


def _surroundings(draw, base, speed, mean):
    """Carrier or gravity, own oil, cage and roughness."""
    changes = {}
    if draw.chance(0.15):
        changes["operation.carrier"] = {
            "speed": f"{speed * draw.one(-1.0, 1.0) * draw.decades(0.03, 0.4)} rpm",
            "radius": mean * draw.even(0.8, 2.0),
        }
    elif draw.chance(0.2):
        changes["operation.gravity_direction"] = draw.even(-math.pi, math.pi)
    if draw.chance(0.25):
        changes["lubricant"] = {
            "base_oil": draw.one("mineral", "pao", "ester", "pag"),
            "iso_grade": f"VG {draw.one(10, 22, 46, 100, 460)}",
        }
    if draw.chance(0.3):
        roughness = draw.decades(0.03e-6, 0.8e-6)
        changes |= {f"surface.{part}_roughness": roughness for part in ("roller", "inner_raceway")}
    if base.models.separator is None and draw.chance(0.3):
        changes["cage.guidance"] = draw.one("inner", "outer")
    return changes


def described(one):
    """What a scene is, in one line."""
    b = one.bearing
    o = one.operation
    rpm = 30.0 / math.pi
    rings = [
        f"{ring} ring {model.name}"
        for ring in ("inner", "outer")
        if (model := getattr(one.models, f"{ring}_ring")) is not None
    ]
    forms = [
        f"{wave.lobes} lobes of {wave.amplitude * 1e6:.2g} um, {ring}"
        for ring, raceway in (("inner", b.inner_raceway), ("outer", b.outer_raceway))
        if raceway is not None
        for wave in raceway.form or ()
    ]
    return "; ".join([
        one.title.partition(" in ")[0],
        f"{o.inner_speed * rpm:.3g} and {o.outer_speed * rpm:.3g} rpm",
        f"{o.radial_load:.3g} N",
        f"{o.axial_load or 0.0:.3g} N axial",
        f"{o.temperature - 273.15:.0f} degC",
        f"clearance {b.radial_clearance * 1e6:.0f} um",
        f"tilt {o.misalignment * 1e3:.2f} mrad",
        one.lubricant.name or "own oil",
        one.lubrication.supply,
        f"pockets {one.study['steady-slip'].get('pockets')}",
        *rings, *forms,
        *([f"carrier {o.carrier.speed * rpm:.3g} rpm"] if o.carrier else []),
        *["weight"] * (o.gravity_direction is not None),
    ])  # fmt: skip
