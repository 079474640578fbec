"""Where cages run away, against finer ways and against motion in time; about an hour on two cores.

- way_up.csv: random scenes (tests/support/way_up_scenes.py) against the same search on five times as many slips and
  four times the positions: what was found, and by how much it is off. It is not independent of the march.
- way_up_many.csv: the same of 3,000 other scenes, in numbers; some ten minutes on two cores.
- way_up_in_time.csv: cage and rollers, each with its own spin, integrated while a constant drag on the cage is raised
  slowly: backward differences of second order in steps of 1/168 of an orbit, laws as the framework evaluates them, one
  slice (no profile), loads from as many positions at the slip of the maximum. The cage follows within a sixth of an
  orbit. What its rollers give at most in the mean of an orbit, while the slip passes the maximum, stands beside the
  drag that is predicted.
"""

import csv
import math
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))

import way_up_scenes as scenes
from rollslip.errors import RollslipError

RANGE = 0.95
#: Kind, count, and what the scenes are made with.
KINDS = (("free", 24, {}), ("catalogue", 16, {"resists": False}), ("catalogue", 24, {"resists": True}))
STEPS, RAMP = 168, (0.985, 1.03)
#: Orbits of the ramp; the second, slower by far, where the first is more than SURE off: a slow roller lags behind it.
ORBITS, SURE = (90, 500), 3e-3
WANTED = 12


def of(kind, number, options):
    """The balance of a scene."""
    return scenes.balance(getattr(scenes, kind)(number, **options))


def held(given):
    """A scene as it is found, and against a finer way."""
    kind, number, options = given
    row = {"kind": kind, "number": number, "resists": int(options.get("resists", False))}
    try:
        one = of(*given)
        begin = time.process_time()
        way = one.way(RANGE)
        row["milliseconds"] = round(1e3 * (time.process_time() - begin), 1)
        dense = scenes.finer(one, 4).way(RANGE, steps=250)
    except RollslipError as error:
        return row | {"refused": str(error)[:80]}
    away, reference = way.runs_away, dense.runs_away
    row |= {"most [N m]": way.largest[1], "most, dense [N m]": dense.largest[1]}
    for name, jump in (("", away), (", dense", reference)):
        row[f"slip{name}"] = math.nan if jump is None else jump.slip
        row[f"drag{name} [N m]"] = math.nan if jump is None else jump.drag
    row["error told"] = math.nan if away is None else away.error
    return row


class InTime:
    """Cage and rollers of a bearing in time, against a drag that is raised."""

    def __init__(self, one, jump, steady):
        self.one, self.k, bearing = one, one.assembly.kinematics, one.assembly.scene.bearing
        self.Z, self.width = bearing.rollers, bearing.roller_length
        self.J = 0.5 * one.assembly.roller_mass * self.k.roller_radius**2
        # as slow as a sixth of an orbit: the ripple of one pitch hardly moves it, and a slow ramp carries it along
        self.I = np.pi / 3.0 * steady.torque / steady.slip / one.cage_speed(0.0) / one.cage_speed(steady.slip)
        loads = one.assembly.load_distribution(-(-STEPS // self.Z), one.cage_speed(jump.slip))
        psi = loads.psi.ravel()
        order = np.argsort(psi)
        ends = np.append(psi[order], psi[order][0] + 2.0 * np.pi)
        self.load = []
        for force in (loads.inner_force, loads.outer_force):
            own = force.ravel()[order] / self.width
            self.load.append(CubicSpline(ends, np.append(own, own[0]), bc_type="periodic"))

    def forces(self, angle, w_c, slip):
        """Torques of all rollers on their spins and on the cage, (Z,) each, at roller slips."""
        k = self.k
        s = k.surface_speeds(1.0 - w_c / k.epicyclic_cage_speed, slip)
        found = []
        for raceway, load, u, V in (
            (self.one.assembly.inner, self.load[0], s.inner_rolling, s.inner_sliding),
            (self.one.assembly.outer, self.load[1], s.outer_rolling, s.outer_sliding),
        ):
            w = np.maximum(load(angle % (2.0 * np.pi)), 0.0)
            on, traction, resistance = w > 1e-6, np.zeros(self.Z), np.zeros(self.Z)
            u = np.broadcast_to(u, (self.Z,))
            if on.any():
                film = np.hypot(u[on], 1e-3)
                table = raceway.evaluate(w[on], film, np.broadcast_to(V, (self.Z,))[on])
                traction[on] = table.friction * w[on] * self.width
                if raceway.chain.resists:
                    resistance[on] = table.resistance * self.width * u[on] / film
            found.append((traction, resistance))
        (Fi, Ri), (Fo, Ro) = found
        spin = k.roller_radius * (Fi - Ri - Fo - Ro)
        return spin, spin + k.inner_radius * (Fi + Ri) + k.outer_radius * (Fo - Ro)

    def run(self, drag, slip, roller_slip, orbits, ramp=RAMP):
        """Largest mean torque of an orbit, while the drag is raised from ramp[0] to ramp[1] times ``drag``.

        ``slip`` holds the slip to start from and the one that is beyond the maximum; ``roller_slip`` is over the orbit.
        NaN if the slip does not come there.
        """
        k, pitch = self.k, 2.0 * np.pi / self.Z * np.arange(self.Z)
        w_c, angle = k.epicyclic_cage_speed * (1.0 - slip[0]), 0.0
        orbit = CubicSpline(
            np.linspace(0.0, 2.0 * np.pi, roller_slip.size + 1), np.append(roller_slip, roller_slip[0]),
            bc_type="periodic",
        )  # fmt: skip
        x = orbit(pitch)
        before, rate_before, torques, most = x.copy(), 0.0, np.zeros(STEPS), 0.0
        for step in range(orbits * STEPS):
            now = drag * (ramp[0] + (ramp[1] - ramp[0]) * step / (orbits * STEPS))
            h = 2.0 * np.pi / STEPS / w_c
            angle += w_c * h
            c = self.J * k.epicyclic_roller_speed / h
            history = (4.0 * x - before) / 3.0 if step else x
            c *= 1.5 if step else 1.0
            guess, before = 2.0 * x - before, x
            x = self._implicit(angle + pitch, w_c, c, history, guess)
            torques[step % STEPS] = self.forces(angle + pitch, w_c, x)[1].sum()
            rate = (torques[step % STEPS] - now) / self.I
            most = max(most, float(torques.mean())) if step >= STEPS else 0.0
            w_c += h * (1.5 * rate - 0.5 * rate_before if step else rate)
            rate_before = rate
            if 1.0 - w_c / k.epicyclic_cage_speed > slip[1]:
                return most
        return math.nan

    def _implicit(self, angle, w_c, c, history, guess):
        """Solve c (x - history) + torque(x) = 0 for all rollers: Newton's method, halved where it gets worse."""
        x = guess
        rest = c * (x - history) + self.forces(angle, w_c, x)[0]
        for _ in range(40):
            nudged = c * (x + 1e-8 - history) + self.forces(angle, w_c, x + 1e-8)[0]
            slope = np.maximum((nudged - rest) / 1e-8, 0.2 * c)
            move = -rest / slope
            part = np.ones(self.Z)
            for _ in range(12):
                there = c * (x + part * move - history) + self.forces(angle, w_c, x + part * move)[0]
                worse = np.abs(there) > np.abs(rest)
                if not worse.any():
                    break
                part = np.where(worse, 0.5 * part, part)
            x, rest = x + part * move, there
            if np.abs(part * move).max() <= 1e-10 + 1e-8 * np.abs(x).max():
                break
        return x


def in_time(given):
    """The drag of running away as predicted, and as motion in time has it; None for a scene that does not tell it."""
    kind, number, options = given
    try:
        one = of(kind, number, {**options, "even": True})
        way = one.way(RANGE)
        away = way.runs_away
        if away is None or away.high > 0.8:
            return None
        steady = way.steady(lambda slip: -RAMP[0] * away.drag)
        if not steady or steady[0].slip >= away.slip:
            return None
        time_ = InTime(one, away, steady[0])
        for orbits in ORBITS:
            motion = steady[0].motion.roller_slip
            found = time_.run(away.drag, (steady[0].slip, 1.1 * away.high), motion, orbits)
            if abs(found / away.drag - 1.0) < SURE:
                break
    except RollslipError:
        return None
    return {
        "kind": kind, "number": number, "resists": int(options.get("resists", False)), "slip": away.slip,
        "to": away.to, "drag [N m]": away.drag, "error told": away.error, "drag in time [N m]": found, "orbits": orbits,
    }  # fmt: skip


def written(name, rows):
    """Write a table."""
    rows = list(rows)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    with Path(__file__).with_name(name).open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, keys, lineterminator="\n")
        table.writeheader()
        for row in rows:
            table.writerow({k: f"{v:.8g}" if isinstance(v, float) else v for k, v in row.items()})


def in_numbers(rows):
    """How many scenes run away, and by how much drags are off, of scenes with and without resistance to rolling."""
    for resists in (0, 1):
        every = [row for row in rows if row["resists"] == resists]
        found = [row for row in every if "refused" not in row]
        pairs = [(row["drag [N m]"], row["drag, dense [N m]"], row["error told"]) for row in found]
        both = [(abs(one / other - 1.0), error) for one, other, error in pairs if one == one and other == other]
        off = np.array([one for one, _ in both])
        yield {
            "rolling resistance": resists, "scenes": len(every), "refused": len(every) - len(found),
            "run away": len(both), "nowhere": sum(one != one and other != other for one, other, _ in pairs),
            "only one has it": sum((one == one) != (other == other) for one, other, _ in pairs),
            "off, median": float(np.median(off)), "off, 95 %": float(np.quantile(off, 0.95)), "off, most": off.max(),
            "off by more than 0.001": int((off > 1e-3).sum()),
            "by more than told": int(sum(one > error + 1e-6 for one, error in both)),
        }  # fmt: skip


def main():
    """Write both tables, or those that are named."""
    asked = sys.argv[1:] or ["dense", "time"]
    with ProcessPoolExecutor(1 if asked == ["time"] else 2) as pool:
        if "dense" in asked:
            written("way_up.csv", list(pool.map(held, [(k, n, o) for k, count, o in KINDS for n in range(count)])))
        if "many" in asked:
            every = [(kind, 10_000 + number, options) for number in range(1000) for kind, _, options in KINDS]
            written("way_up_many.csv", in_numbers(list(pool.map(held, every, chunksize=10))))
        if "time" in asked:
            every = [(kind, number, options) for number in range(40) for kind, _, options in KINDS]
            rows = []
            for row in pool.map(in_time, every):
                if row is not None:
                    rows.append(row)
                    print(row, flush=True)
                    written("way_up_in_time.csv", rows)
                if len(rows) == WANTED:
                    break
            pool.shutdown(cancel_futures=True)


if __name__ == "__main__":
    main()
