"""Where cages run away in time, against the way up: loading_branch_in_time.csv; half an hour of one processor.

Cage and rollers, each with its own spin, are integrated against a drag that is raised from none, by SciPy's LSODA over
the angle of the cage: steps and order as its error asks, no positions, no rule of few loads, no search for motions.
Laws are evaluated, and loads solved, as the framework does, loads at 720 angles and 33 squares of the cage speed.

A drag is held where the slip comes to rest, and lets the cage run away where the slip goes far beyond the maximum. It
is raised to 99 % of the one that is predicted, then to a thousandth above it and what is told as its error.
Then the interval between the largest that is held and the least that runs away is halved, from the motion of the
former. Where none is predicted, 50, 90 and 98 % of the most stand against what the way carries at the slips there.
"""

import csv
import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import ode
from scipy.interpolate import CubicSpline

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "support"))

import loading_branch_scenes as scenes
from rollslip.bearing.equilibrium import angular_positions
from rollslip_kernels.slices import Slices
from rollslip_studies.motion.orbit_loads import orbit_loads
from rollslip_studies.motion.spins import MIN_FILM_SPEED, logit_slip, slip_from_logit

TABLE = Path(__file__).with_name("loading_branch_in_time.csv")
RANGE = 0.95
TURN = 2.0 * math.pi
#: Slices of a roller; angles and squares of the cage speed at which loads are solved.
SLICES = 12
ANGLES = 720
SPEEDS = 33
#: Exactness of a step; sliding speed over which the friction of a pocket changes its sign [m/s].
EXACT = 1e-3
POCKET = 1e-2
#: Change of the slip over an orbit that is rest, relative, of rollers without inertia, and what its decay may leave;
#: least and most orbits of a drag.
REST = 3e-4
LEFT = 3e-3
LEAST = 4
MOST = 20_000
#: Slip at which the cage all but stands.
STANDS = 0.975
#: Interval of drags that is narrow enough; processor time of a scene [s], beyond which its interval stays as it is.
NARROW = 1.5e-3
LIMIT = 60.0
#: Drags that have to be held and to run away, over the predicted one and its error; parts of what the end carries.
BELOW = 0.99
ABOVE = 1e-3
PARTS = (0.5, 0.9, 0.98)
#: How many times as heavy the cage is, once it has slipped, in turn, until time agrees; what does not is off by more.
CAGES = (1.0, 5.0)
MISSED = 0.02


#: Kind, numbers and whether rolling is resisted, hard ones first: of the 3,000 of loading_branch_many.csv
#: those of which only
#: one of both ways has a drag, those that are off most, and some with several maxima; then two whose slip just doubles;
#: then any speed, light loads, pockets, and rings that both turn.
SCENES = (
    ("free", (10053,), 0),
    ("catalogue", (10098, 10684, 10751), 0),
    ("catalogue", (10055, 10548, 10695, 10873), 1),
    ("catalogue", (10194, 10102, 10584, 10783, 10858, 10370, 10927, 10472, 10267, 10446), 0),
    ("catalogue", (10841, 10012, 10926, 10765, 10123, 10323, 10320, 10191, 10423), 1),
    ("free", (10242, 10026, 10059, 10120, 10247, 10071, 10525, 10571, 10040, 10110), 0),
    ("catalogue", (10018, 10014, 10466), 1),
    (
        "wide",
        (
            1,
            3,
            5,
            7,
            8,
            9,
            10,
            12,
            14,
            15,
            18,
            21,
            22,
            24,
            30,
            33,
            35,
            36,
            37,
            42,
            45,
            49,
            50,
            54,
            59,
        ),
        "",
    ),
    ("wide", (13, 19, 23, 31, 34, 40, 41, 44, 51, 53, 57, 48, 55, 38), ""),
)


class InTime:
    """Cage and rollers of a bearing over the angle of the cage, against a drag; ``maximum`` only sets the cage's pace.

    It follows within a sixth of an orbit: the ripple of a pitch hardly moves it, and it keeps up with the drag.
    The state is the roller slips (Z,), the cage slip, and the integral of the latter over the angle.
    """

    def __init__(self, one, maximum):
        self.one = one
        self.k = one.assembly.kinematics
        self.Z = one.assembly.scene.bearing.rollers
        slip, torque = maximum
        k = self.k
        Z = self.Z
        self.spin = 0.5 * one.assembly.roller_mass * k.roller_radius**2 * k.epicyclic_roller_speed
        self.cage = TURN / 6.0 * torque / slip / (1.0 - slip)
        reach = k.outer_radius / k.roller_radius * k.epicyclic_cage_speed
        rollers = Z * self.spin / k.epicyclic_roller_speed * reach**2
        self.rest = REST / (
            1.0 + rollers / self.cage
        )  # those that roll on the outer ring slow down with the cage
        self.pocket = (
            0.0 if one.drags.pocket_friction is None else one.drags.pocket_friction.coefficient
        )
        self.pitch = TURN / Z * np.arange(Z)
        self.tables = {}
        self.drag = lambda _: 0.0
        n_positions = -(-ANGLES // Z)
        psi = angular_positions(Z, n_positions).ravel()
        order = np.argsort(psi)
        speeds = k.epicyclic_cage_speed * np.sqrt(np.linspace(0.0, 1.0, SPEEDS))
        inner, outer = orbit_loads(one.assembly, n_positions, speeds)
        loads = (
            np.stack((inner[0], outer[0]))
            .reshape(2, SPEEDS, psi.size, -1)[:, :, order]
            .transpose(2, 0, 1, 3)
        )
        self.width, self.least = inner[1], 1e-9 * loads.max()
        ends = np.append(psi[order], psi[order][0] + TURN)
        loads = np.concatenate((loads, loads[:1]))
        self.load = [
            CubicSpline(ends, loads[:, :, k : k + 2], bc_type="periodic") for k in range(SPEEDS - 1)
        ]
        lag = abs(float(k.roller_slip_outer_rolling(np.array([slip]))[0]))
        self.small = EXACT * np.array([*(0.1 * lag for _ in range(Z)), 0.1 * slip, 1.0])

    def start(self):
        """Rolling without slip."""
        return np.array([0.0] * self.Z + [1e-6, 0.0])

    def _loads(self, angle, slip):
        """Loads per length of both rings (2, Z, slices): linear in the square of the cage speed."""
        square = (1.0 - slip) ** 2 * (SPEEDS - 1)
        k = min(int(square), SPEEDS - 2)
        at = self.load[k]((angle + self.pitch) % TURN)
        return ((k + 1 - square) * at[:, :, 0] + (square - k) * at[:, :, 1]).transpose(1, 0, 2)

    def _friction(self, ring, load, rolling, sliding):
        """Traction and rolling resistance [N], (n,), of rollers on a ring."""
        raceway = self.one.assembly.raceways[ring]
        n = load.shape[1]
        if (ring, load.size) not in self.tables:
            table = Slices(load.size, raceway.conditions, load=np.ones(load.size))
            self.tables[ring, load.size] = table, raceway.chain.bind(table)
        table, evaluate = self.tables[ring, load.size]
        film = np.hypot(rolling, MIN_FILM_SPEED)
        table.load[:] = np.maximum(load, self.least).ravel()
        table.rolling_speed[:] = np.repeat(film, n)
        table.sliding_speed[:] = np.repeat(sliding, n)
        evaluate()
        on = np.where(load > self.least, self.width, 0.0)
        traction = (table.friction.reshape(load.shape) * load * on).sum(axis=1)
        if not raceway.chain.resists:
            return traction, 0.0
        return traction, (table.resistance.reshape(load.shape) * on).sum(axis=1) * rolling / film

    def _torques(self, load, x, slip):
        """Torques of rollers on their spins and on the cage [N m], (n,), at roller slips and cage slips (n,)."""
        k = self.k
        r = self.k.roller_radius
        s = k.surface_speeds(slip, x)
        Fi, Ri = self._friction(0, load[0], s.inner_rolling, s.inner_sliding)
        Fo, Ro = self._friction(1, load[1], s.outer_rolling, s.outer_sliding)
        spin = r * (Fi - Ri - Fo - Ro)
        along = k.inner_radius * (Fi + Ri) + k.outer_radius * (Fo - Ro)
        slides = r * s.roller_speed
        spin = spin - self.pocket * r / k.orbit_radius * np.abs(spin + along) * slides / np.hypot(
            slides, POCKET
        )
        return spin, spin + along

    def rates(self, angle, y):
        """Derivatives of the state by the angle."""
        Z = self.Z
        slip = min(y[self.Z], 0.99)
        spin, cage = self._torques(self._loads(angle, slip), y[:Z], np.full(Z, slip))
        pace = self.k.epicyclic_cage_speed * (1.0 - slip)
        return np.array(
            [
                *(-spin / self.spin / pace),
                (self.drag(angle) - cage.sum()) / self.cage / (1.0 - slip),
                slip,
            ]
        )

    def jacobian(self, angle, y):
        """Its derivatives by the state, by differences: each spin is its own, but for the cage."""
        Z = self.Z
        slip = min(y[self.Z], 0.99)
        d = np.arange(self.Z)
        nudges = 1e-2 * self.small[0] + 1e-7 * np.abs(y[:Z]), 1e-2 * self.small[Z]
        x = np.tile(y[:Z], (3, 1))
        slips = np.full((3, Z), slip)
        x[1] += nudges[0]
        slips[2] += nudges[1]
        found = self._torques(
            np.tile(self._loads(angle, slip), (1, 3, 1)), x.ravel(), slips.ravel()
        )
        spin, cage = (-of.reshape(3, Z) for of in found)
        pace = self.k.epicyclic_cage_speed * (1.0 - slip)
        out = np.zeros((Z + 2, Z + 2))
        out[d, d] = (spin[1] - spin[0]) / nudges[0] / self.spin / pace
        out[:Z, Z] = (spin[2] - spin[0]) / nudges[1] / self.spin / pace
        out[Z, :Z] = (cage[1] - cage[0]) / nudges[0] / self.cage / (1.0 - slip)
        out[Z, Z] = (cage[2] - cage[0]).sum() / nudges[1] / self.cage / (1.0 - slip)
        out[Z + 1, Z] = 1.0
        return out

    def held(self, y, drag, beyond, *, begin=None, orbits=MOST, end=math.inf):
        """What the cage comes to at a drag, raised from ``begin`` in eight orbits if that is given.

        Whether it is held, None if it is not known after so many orbits or at a time ``end``; its state at the end of
        an orbit, its mean slip there, and the orbits. Over a mean slip ``beyond`` it has run away.
        """
        self.drag = lambda angle: (
            drag if begin is None else begin + (drag - begin) * min(angle / (8.0 * TURN), 1.0)
        )
        solver = ode(self.rates, self.jacobian).set_integrator(
            "lsoda",
            rtol=EXACT,
            atol=self.small,
            with_jacobian=True,
            nsteps=5_000,
            max_step=TURN / 36.0,
        )
        solver.set_initial_value(np.append(y[:-1], 0.0), 0.0)
        Z = self.Z
        along = [0.0]
        least = LEAST + (0 if begin is None else 8)
        for pitch in range(1, orbits * Z + 1):
            for part in range(1, 9):
                y = solver.integrate(TURN * (pitch - 1 + part / 8) / Z)
                if not solver.successful():
                    raise ArithmeticError("LSODA gives up")
                if y[Z] > STANDS:
                    return False, y, y[Z], pitch / Z
                if time.process_time() > end:
                    return None, y, y[Z], pitch / Z
            along.append(y[-1])
            mean = (y[-1] - along[max(pitch - Z, 0)]) / (TURN * min(pitch / Z, 1.0))
            if mean > beyond:
                return False, y, mean, pitch / Z
            if pitch % Z == 0 and pitch >= least * Z:
                at = np.diff(along[-1::-Z][:4][::-1]) / TURN
                before, now = np.abs(np.diff(at))
                if now < self.rest * mean and now**2 < LEFT * mean * (
                    before - now
                ):  # a bottleneck has no decay
                    return True, y, mean, pitch / Z
        return None, y, mean, pitch / Z


def beyond_of(away):
    """Mean slip over which the cage has run away: midway to where it jumps to, or three times that of the maximum."""
    to = away.slip_after if away.slip_after == away.slip_after else RANGE
    _, high = away.slips_within(1e-3)
    return min(slip_from_logit(0.5 * (logit_slip(high) + logit_slip(to))), 3.0 * high)


def above(away):
    """The drag over the one that is predicted which has to run away."""
    return 1.0 + ABOVE + min(away.error, 0.2)


def bracket(one, away, heavy):
    """The largest drag that is held and the least that runs away, over the predicted one, and where that goes."""
    told = InTime(one, (away.slip, away.drag))
    end = time.process_time() + LIMIT * heavy**0.5
    low = 0.0
    high = math.inf
    reached = None
    y = told.start()
    total = 0
    levels = [
        *([0.9] if heavy > 1.0 else []),
        BELOW,
        *(above(away) + more for more in (0.0, 0.002, 0.01, 0.04, 0.2)),
    ]
    while high - low >= NARROW and (high >= 0.6 or low) and (levels or high < math.inf):
        level = levels.pop(0) if levels else 0.5 * (low + high) if low else high - 0.03
        begin = None if low else 0.0
        held, at, _, orbits = told.held(y, level * away.drag, beyond_of(away), begin=begin, end=end)
        total += orbits
        if held is None:  # it swings, or creeps, or time is up
            break
        if held:
            told.cage *= 1.0 if low else heavy
            low = level
            y = at
        else:
            high = level
            levels = []
            if reached is None and away.slip_after == away.slip_after:
                _, _, reached, _ = told.held(at, level * away.drag, RANGE, orbits=12, end=end + 5.0)
    return {
        "held [N m]": low * away.drag, "runs away [N m]": high * away.drag, "to in time": reached,
        "orbits": round(total),
    }  # fmt: skip


def carried(one, way, heavy):
    """Over what the way carries at the slips at which the cage comes to rest: parts of the most at the end of it."""
    slip, most = way.maximum
    told = InTime(one, (slip, most))
    end = time.process_time() + LIMIT * heavy**0.5
    total = 0
    off = []
    y = told.start()
    for part in PARTS:
        held, y, at, orbits = told.held(y, part * most, RANGE, begin=None if off else 0.0, end=end)
        total += orbits
        if held is None:
            break
        told.cage *= 1.0 if off else heavy
        off.append(part * most / way.interpolate([at])[0].torque - 1.0 if held else math.inf)
    return {f"off at {100 * part:.0f} %": one for part, one in zip(PARTS, off, strict=False)} | {
        "orbits": round(total)
    }


def of(kind, number, resists):
    """The balance of a scene."""
    options = {"resists": bool(int(resists))} if kind == "catalogue" else {}
    return scenes.balance(getattr(scenes, kind)(number, **options), slices=SLICES)


def row(kind, number, resists):
    """What is told of a scene."""
    begin = time.process_time()
    one = of(kind, number, resists)
    o = one.assembly.scene.operation
    way = one.loading_branch(RANGE)
    out = {
        "kind": kind, "number": number, "resists": int(one.assembly.inner.chain.resists),
        "pocket": 0.0 if one.drags.pocket_friction is None else one.drags.pocket_friction.coefficient,
        "inner [rpm]": 60.0 * o.inner_speed / TURN, "outer [rpm]": 60.0 * o.outer_speed / TURN,
        "load [N]": o.radial_load, "maxima": len(way.jumps), "most [N m]": way.maximum[1],
    }  # fmt: skip
    away = scenes.doubling_jump(way)
    dense = scenes.doubling_jump(scenes.dense_branch(scenes.finer(one, 4)))
    out["finer way [N m]"] = math.nan if dense is None else dense.drag
    if away is not None:
        out |= {
            "slip": away.slip,
            "to": away.slip_after,
            "predicted [N m]": away.drag,
            "error told": away.error,
        }
    told = {}
    for heavy in CAGES:
        try:
            found = carried(one, way, heavy) if away is None else bracket(one, away, heavy)
        except ArithmeticError:  # LSODA gives up
            continue
        before = told
        told = judged(out | found | {"cage": heavy}, away)
        if before and told["agrees"] == "":  # nothing is known of the heavier one
            told = before
        if told["agrees"] != 0:
            break
    return out | told | {"seconds": round(time.process_time() - begin, 1)}


def judged(out, away):
    """The same with what the prediction is off by, and whether that was told: 1, 0, empty if time does not tell."""
    if away is None:
        off = [abs(one) for key, one in out.items() if key.startswith("off at")]
        return out | {"agrees": "" if len(off) < len(PARTS) else int(max(off) < MISSED)}
    low = out["held [N m]"]
    high = out["runs away [N m]"]
    if not low or high == math.inf:
        return out | {"agrees": ""}
    middle = 0.5 * (low + high)
    off = away.drag / middle - 1.0
    interval = (high - low) / middle
    return out | {
        "off": off,
        "interval": interval,
        "agrees": int(abs(off) <= away.error + ABOVE + 0.5 * interval),
    }


def main():
    """Write the table, scene by scene."""
    rows = []
    for kind, numbers, resists in SCENES:
        for number in numbers:
            rows.append(row(kind, number, resists))
            print(rows[-1], flush=True)
            keys = list(dict.fromkeys(key for one in rows for key in one))
            with TABLE.open("w", newline="", encoding="utf-8") as file:
                table = csv.DictWriter(file, keys, lineterminator="\n")
                table.writeheader()
                table.writerows(
                    {k: f"{v:.8g}" if isinstance(v, float) else v for k, v in one.items()}
                    for one in rows
                )


if __name__ == "__main__":
    main()
