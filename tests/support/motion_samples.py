"""Results of the study dynamics made from closed expressions, in its exact schema, for tests of what reads them.

The bearing is the 1032930 (Klebanov et al. 2022): raceways of 165 and 195 mm, rollers of 15 mm, inner ring at 6371 rpm,
outer ring at rest. Cage slip relaxes from one value to another or runs away; rollers lose spin in the unloaded zone and
win it back in the loaded one. Energies and works belong together: the rings give what is stored and dissipated.
"""

import json

import numpy as np
import xarray as xr

from rollslip.results.dataset import about
from rollslip_studies.dynamics.findings import DynamicsAccount, describe_differences

#: Radius of the inner raceway [m], of the paper as the next two.
INNER = 82.5e-3
#: Radius of a roller [m].
ROLLER = 7.5e-3
#: Radius of the orbit of rollers [m].
ORBIT = 90e-3
#: 6371 1/min [rad/s].
INNER_SPEED = 667.17
CAGE_SPEED = INNER_SPEED * INNER / (2.0 * ORBIT)
ROLLER_SPEED = INNER * (INNER_SPEED - CAGE_SPEED) / ROLLER
#: Mass of a roller [kg].
ROLLER_MASS = 20e-3
#: Moment of inertia of the cage [kg m2].
CAGE_INERTIA = 3e-3
#: Torque that brakes the cage [N m].
DRAG = 0.3
#: Coefficient that tractions approach when the rollers slide.
FRICTION = 0.01
WORKS = ("work_rings", "lost_inner", "lost_outer", "work_drag")


def relaxing(begin=0.0, end=0.03, after=0.1):
    """Cage slip that goes exponentially from one value to another."""
    return lambda t: end + (begin - end) * np.exp(-t / after)


def skidding_sentences(begin=0.02, within=0.15):
    """Cage slip that grows exponentially until the cage stands."""
    return lambda t: np.minimum(begin * np.exp(t / within), 1.0)


def motion(
    slip=None,
    *,
    duration=0.5,
    points=801,
    rollers=28,
    load=1000.0,
    critical=0.11,
    level="cage-set",
    friction="conventional",
    film="known",
    roller_lag=0.02,
    events=(),
    residual=1e-9,
    drag=True,
    works=WORKS,
    **attributes,
):
    """Return a motion with a given course of cage slip.

    film is "known", or why it is not; events are tuples of time, text and whether rising, besides the passages of the
    critical slip, which are found from the course; residual is that of the ledger [J]; the rest is what its name says.
    """
    slip = slip or relaxing()
    time = np.linspace(0.0, duration, points)
    cage_slip = np.asarray(slip(time), dtype=float)
    cage_speed = CAGE_SPEED * (1.0 - cage_slip)
    fine = np.linspace(0.0, duration, 20001)
    course = CAGE_SPEED * (1.0 - np.asarray(slip(fine), dtype=float))
    turned = np.concatenate(([0.0], np.cumsum(0.5 * (course[1:] + course[:-1]) * np.diff(fine))))
    angle = np.interp(time, fine, turned)[:, None] + 2.0 * np.pi * np.arange(rollers) / rollers
    angle %= 2.0 * np.pi
    inner_force = load * np.maximum(np.cos(angle), 0.0) ** 1.5
    force = np.stack((inner_force, inner_force + ROLLER_MASS * ORBIT * cage_speed[:, None] ** 2))
    roller_slip = cage_slip[:, None] + roller_lag * (1.0 - np.cos(angle - 0.7))
    roller_speed = ROLLER_SPEED * (1.0 - roller_slip)
    sliding = np.stack(
        (
            INNER * (INNER_SPEED - cage_speed[:, None]) - ROLLER * roller_speed,
            ROLLER * roller_speed - (INNER + 2 * ROLLER) * cage_speed[:, None],
        )
    )
    traction = FRICTION * np.tanh(sliding) * force
    known = film == "known"
    film_parameter = (
        np.where(force > 0.0, 3.0 / (1.0 + force) ** 0.1, np.nan)
        if known
        else np.full(force.shape, np.nan)
    )

    def since_start(power):
        return np.concatenate(([0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(time))))

    inertia = 0.5 * ROLLER_MASS * ROLLER**2
    moving = (CAGE_INERTIA + rollers * ROLLER_MASS * ORBIT**2) * cage_speed
    energy = 0.5 * moving * cage_speed + 0.5 * inertia * (roller_speed**2).sum(axis=1)
    lost = [since_start(power) for power in (traction * sliding).sum(axis=2)]
    braked = since_start(DRAG * cage_speed if drag else 0.0 * time)
    gap = residual * np.sin(40.0 * time) ** 2
    done = np.stack(
        (energy - energy[0] + lost[0] + lost[1] + braked - gap, -lost[0], -lost[1], -braked)
    )
    excess = np.asarray(slip(fine), dtype=float) - critical
    found = [
        (float(fine[k]), "cage slip passes that of skidding", bool(excess[k + 1] > 0.0))
        for k in np.flatnonzero(excess[:-1] * excess[1:] < 0.0)
    ]
    happened = sorted([*found, *events])
    over = ("time",)
    each = ("time", "roller")
    contacts = ("ring", "time", "roller")
    status = {"film_status": "of the loaded slices" if known else film}
    dataset = xr.Dataset(
        {
            "cage_speed": (over, cage_speed, about("rad/s", "cage speed")),
            "cage_slip": (over, cage_slip, about("1", "cage slip")),
            "roller_speed": (
                each,
                roller_speed,
                about("rad/s", "roller spin relative to the cage"),
            ),
            "roller_slip": (each, roller_slip, about("1", "roller slip")),
            "orbit_angle": (each, angle, about("rad", "position from the line of load")),
            "normal_force": (contacts, force, about("N", "normal force")),
            "traction_force": (contacts, traction, about("N", "traction force")),
            "sliding_speed": (contacts, sliding, about("m/s", "sliding speed")),
            "film_parameter": (
                contacts,
                film_parameter,
                about("1", "smallest film parameter") | status,
            ),
            "energy": (over, energy, about("J", "kinetic and elastic energy")),
            "work_done": (("work", "time"), done[: len(works)], about("J", "work since the start")),
            "energy_residual": (
                over,
                energy - energy[0] - done.sum(axis=0),
                about("J", "residual of the energy"),
            ),
            "angular_momentum": (over, moving, about("N m s", "angular momentum")),
            "momentum_residual": (
                over,
                1e-12 * moving * np.sin(time),
                about("N m s", "residual of the momentum"),
            ),
            "event_time": (
                ("event",),
                np.array([e[0] for e in happened], dtype=float),
                about("s", "when it happened"),
            ),
            "event_what": (
                ("event",),
                np.array([e[1] for e in happened], dtype=str),
                about("1", "what happened"),
            ),
            "event_rising": (
                ("event",),
                np.array([e[2] for e in happened], dtype=np.int8),
                about("1", "rising"),
            ),
            "regime_fraction": (
                ("ring", "regime"),
                np.array([[0.25, 0, 0, 0.75], [0, 0, 0, 1]]),
                about("1", "share of a regime"),
            ),
            "load_parameter": (
                ("ring",),
                np.array([40.0, 50.0]),
                about("1", "largest Moes load parameter M"),
            ),
            "light_fraction": (
                ("ring",),
                np.array([0.125, 0.0]),
                about("1", "share of the forces at light load"),
            ),
        },
        coords={
            "time": (over, time, about("s", "time")),
            "roller": np.arange(1, rollers + 1),
            "ring": ["inner", "outer"],
            "regime": ["IR", "VR", "IE", "VE"],
            "work": list(works),
            "event": np.arange(len(happened)),
        },
        attrs={
            "study": "dynamics",
            "level": level,
            "friction": friction,
            "integrator": "rodas5p",
            "outcome": "finished",
            "outcome_message": "",
            "steps": 1234,
            "rejected": 12,
            "rate_evaluations": 98765,
            "jacobians": 1234,
            "contacts_evaluated": 5600000,
            "real_time_factor": 2.5,
            "skidding_slip": critical,
            "limit_drag": float("nan") if np.isnan(critical) else 4.0,
            "skidding_status": "found",
            "critical_cage_slip": 0.2,
            "critical_status": "found",
            "curves_with": "with rollers in pure rolling",
            "steady_cage_slip": float(cage_slip[-1]),
            "steady_status": "steady",
            "drag": json.dumps([{"name": "constant", "equation": "T = T0"}] if drag else []),
            "cage": json.dumps({"mass": 0.3, "inertia": CAGE_INERTIA}),
            "warnings": "[]",
        },
    )
    if level != "cage-set":
        dataset["pocket_force"] = (
            each,
            30.0 * np.sin(angle),
            about("N", "force of a roller on the cage"),
        )
        dataset["pocket_displacement"] = (
            each,
            1e-4 * np.sin(angle),
            about("m", "displacement in the pocket"),
        )
    if level == "planar":
        swing = np.stack((np.cos(300.0 * time), np.sin(300.0 * time)))
        way = ("direction", "time")
        fading = np.exp(-time / 0.1)
        ring = np.stack((20e-6 - 5e-6 * fading * swing[0], 5e-6 * fading * swing[1]))
        dataset = dataset.assign_coords(direction=["along", "across"])
        dataset["ring_displacement"] = (way, ring, about("m", "displacement of the inner ring"))
        dataset["cage_displacement"] = (
            way,
            60e-6 * (1 - fading) * swing,
            about("m", "displacement of the cage"),
        )
        dataset["land_eccentricity"] = (
            over,
            0.6 * (1 - fading),
            about("1", "eccentricity of the cage on its lands"),
        )
    return dataset.assign_attrs(attributes)


SKIDDING = {"steady_status": "not steady: it grows", "steady_cage_slip": float("nan")}


def hard_cases():
    """Motions of the least, the most and the strangest that a result can hold, by name."""
    contacts = [
        (1e-3 * k, "contact of roller 3 with the inner ring opens", bool(k % 2)) for k in range(400)
    ]
    return {
        "one instant": motion(
            points=1,
            duration=0.0,
            outcome="interrupted",
            outcome_message="interrupted at t = 0 s",
            real_time_factor=0.0,
        ),
        "two instants": motion(points=2, duration=1e-9),
        "no roller loaded": motion(load=0.0, film="no roller was loaded", points=61),
        "film unknown": motion(
            film="effective friction does not know the film", friction="effective", points=61
        ),
        "one roller": motion(rollers=1, points=201),
        "1000 rollers": motion(rollers=1000, points=21, level="planar"),
        "skidding": motion(skidding_sentences(), points=201, events=contacts, **SKIDDING),
        "nothing moves": motion(
            lambda t: 1.0 + 0.0 * t, roller_lag=0.0, load=0.0, drag=False, residual=0.0, points=5
        ),
        "no drag, no slip": motion(lambda t: 0.0 * t, drag=False, residual=0.0, points=61),
        "cage backwards": motion(relaxing(2.0, 0.03), points=61, rejected=-1),
        "critical unknown": motion(
            critical=float("nan"), skidding_status="friction still rises", points=61
        ),
        "ledger of one entry": motion(works=("work_rings",), points=5),
    }


def situations():
    """Motions of which different things are said, by name."""
    away = motion(skidding_sentences(), **SKIDDING)
    unknown = {"critical_cage_slip": float("nan"), "critical_status": "rises"}
    opens = [
        (0.01 * k, "contact of roller 3 with the inner ring opens", False) for k in range(1, 31)
    ]
    others = [(0.1, f"event {k}", True) for k in range(9)]
    older = motion(points=61)
    for name in ("skidding_slip", "limit_drag", "skidding_status"):
        del older.attrs[name]
    return hard_cases() | {
        "runs away": away,
        "runs away and is stopped": away.assign_attrs(
            outcome="stopped", outcome_message="stop_at = critical."
        ),
        "slip falls again": motion(lambda t: 0.3 * np.sin(4.0 * t), **SKIDDING),
        "settles beyond": motion(relaxing(0.0, 0.2)),
        "there and back": motion(lambda t: 0.2 * np.sin(6.0 * t)),
        "swings": motion(lambda t: 0.11 + 0.05 * np.sin(100.0 * t + 0.1)),
        "from rest": motion(relaxing(1.0, 0.03)),
        "beyond all the time": motion(lambda t: 0.5 + 0.0 * t),
        "effective friction near skidding": motion(lambda t: 0.056 + 0.0 * t, friction="effective"),
        "two maxima": motion(first_maximum_slip=0.04),
        "one maximum twice": motion(first_maximum_slip=0.2),
        "two maxima of an unknown curve": motion(first_maximum_slip=0.04).assign_attrs(unknown),
        "of an older version": older,
        "slower than real time": motion(real_time_factor=0.25),
        "opening contacts": motion(events=opens),
        "events of many kinds": motion(events=others),
        "planar": motion(level="planar", points=2001),
    }


def told_motions():
    """Return what is said of these motions, topic by topic; after the first one what is not said of it."""
    usual = list[str]()
    lines = list[str]()
    for name, dataset in ({"settles": motion()} | situations()).items():
        topics = DynamicsAccount.topics(dataset)
        if usual:
            topics.pop("ledger")  # residuals of rounding, which machines have their own of
        said = [f"{topic}: {text}" for topic, texts in topics.items() for text in texts]
        usual = usual or said
        lines += [f"== {name}", *(line for line in said if said is usual or line not in usual)]
    return "\n".join(lines) + "\n"


def told_together():
    """Return all that is said of two motions together."""
    slow = motion(
        relaxing(0.0, 0.033, 0.1), points=501, friction="effective", real_time_factor=75.0
    )
    return (
        "\n".join(
            describe_differences(
                {"conventional": motion(relaxing(0.0, 0.03, 0.1)), "effective": slow}
            )
        )
        + "\n"
    )
