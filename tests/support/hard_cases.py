"""The hard cases of the whole project: one list, each over every model, study and part of the mechanics it is about.

- A case judges one subject at a time. It comes out "right", with the largest relative error against an independent
  reference; "within bounds" where a law has none (finite, odd, of the right sign, below a Newtonian film or 1, both
  forms alike); or with a refusal or a status, whose words are matched. Anything else is an AssertionError.
- References are the published laws with 50 digits (fifty_digits.py), taken at the very floats that the program got, or
  an exact limit, symmetry or balance; never an earlier answer of the program.
- Models come from ``available``: a new one is taken up without a line here.
- Nothing is skipped in silence: `why_not` has a reason for every pair of case and subject that is not run.
- Errors are relative. Below the smallest normal float numbers have few digits; there they are relative to that float.
"""

import contextlib
import math
import re
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from types import SimpleNamespace

import attrs
import numpy as np
from mpmath import mp, mpf

from fifty_digits import DEFLECTIONS, DIGITS, exact, hertz, load_of, solve
from fifty_digits import eyring_stress as exact_eyring
from fifty_digits import maxwell_eyring_stress as exact_maxwell_eyring
from fifty_digits import muraki_stress as exact_muraki
from rollslip import Chain, Conditions, Slices, available, evolve, get_model, load_scene, run
from rollslip.bearing.assembly import assemble
from rollslip.bearing.critical import find_critical_slip
from rollslip.bearing.equilibrium import LoadCase, angular_positions, solve_equilibrium
from rollslip.bearing.kinematics import Kinematics
from rollslip.errors import ConvergenceError, DomainError, SceneError
from rollslip.models.profile import profile_drop, slice_positions
from rollslip.scene.schema import schema
from rollslip.testing.samples import NumpyForm, table
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_kernels.stages import stress as compiled_stress
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from rollslip_plugins.traction import stress as readable_stress

EPS = sys.float_info.epsilon
TINY = sys.float_info.min
HUGE = sys.float_info.max
#: The smallest number above zero.
DENORMAL = 5e-324

#: What the program raises where it refuses.
REFUSALS = (SceneError, DomainError, ConvergenceError)

#: A contact of the paper's bearing (inner ring, 70 degC, 518 N), rounded: what a case does not change.
BASE = {
    "length": 0.015, "radius": 0.006875, "modulus": 2.2857e11, "roughness": 2.0**-22, "effusivity": 1.2986e4,
    "temperature": 343.15, "viscosity": 5.17e-3, "pressure_viscosity": 9.18e-9, "thermoviscosity": 0.0227,
    "pressure_thermoviscosity": 6.6e-11, "conductivity": 0.1386, "eyring_stress": 4e6, "shear_modulus": 3e8,
    "approach": 2e-6, "rolling_speed": 29.8, "sliding_speed": 3.0, "load": 3.4533e4, "stiffness": 3e10,
    "half_width": 5.14e-5, "pressure": 3.36e8, "film_thickness": 6e-7, "regime": 3.0, "friction": 0.01,
    "film_viscosity": 0.113, "film_thermoviscosity": 0.0449,
}  # fmt: skip

#: Error allowed to a law known in 50 digits; a stage is some twenty roundings of 1.1e-16 and a few library functions.
ALLOWED = {
    "contact": 1e-15,
    "deflection": 1e-14,
    "film": 1e-14,
    "traction": 2e-13,
    "stress law": 1e-13,
}
#: What two forms of one law may differ by, and what a result may differ by where only its sum's order changes.
ALIKE = 1e-12

#: Model -> the parameters without which it cannot be made, or is not known in 50 digits.
MADE = {
    "lambda-blend": {"hydrodynamic": "maxwell-eyring"},
    "yasutomi": {
        "glass_temperature": 244.95, "a1": 134.2, "a2": 1.929e-9, "b1": 4.815, "b2": 1.6e-10, "c1": 16.01, "c2": 20.69
    },
}  # fmt: skip


#: Model -> why it is slow: its pairs are run by name, but for those of QUICK cases, and without large tables.
SLOW_MODELS = {
    "maxwell-eyring-field": "integrates a field in NumPy, some 50 ms a slice",
    "reynolds-line": "solves Reynolds's equation in NumPy",
}
QUICK = (
    "slip 0",
    "zero speed",
    "reversed speed",
    "both surfaces at rest",
    "counter-rotation, u = 0 and V > 0",
    "NaN or infinity in any member",
)


# Subjects ------------------------------------------------------------------------------------------------------------


@attrs.frozen
class Subject:
    """What a case is run on: a stage, a stress law, a study, or a part of the mechanics."""

    kind: str
    name: str
    model: object = attrs.field(default=None, eq=False, repr=False)

    @property
    def reads(self):
        return getattr(self.model, "reads", frozenset())

    @property
    def forms(self):
        """The forms of a stage, each a bound chain: as it comes, and in NumPy."""
        return _forms(self.model)


@cache
def _forms(model):
    return (
        (Chain(model), Chain(NumpyForm(model))) if model.kernel() is not None else (Chain(model),)
    )


STRESS_LAWS = {
    "muraki stress": (compiled_stress.muraki, readable_stress.muraki_stress, exact_muraki),
    "maxwell-eyring stress": (
        compiled_stress.maxwell_eyring,
        readable_stress.maxwell_eyring_stress,
        exact_maxwell_eyring,
    ),
    "eyring stress": (
        compiled_stress.eyring,
        readable_stress.eyring_stress,
        lambda sigma, _, heating: exact_eyring(sigma, heating),
    ),
}
STUDIES = (
    "friction-curve inner",
    "friction-curve outer",
    "effective-friction epicyclic",
    "effective-friction outer-rolling",
    "effective-friction free-roller",
)
MECHANICS = ("kinematics", "roller profile", "load case", "critical slip")


@cache
def subjects():
    """Everything that cases are run on."""
    found = []
    for kind in ("contact", "film", "traction"):
        for name, offer in available(kind).items():
            if offer.package == "rollslip":
                model = get_model(kind, name, **MADE.get(name, {}))
                found.append(Subject(kind, name, model))
                if kind == "contact":
                    found.append(Subject("deflection", f"{name} deflection", model.deflection()))
    for law in (Barus, Roelands, Yasutomi):
        found.append(Subject("viscosity", law.name, law(**MADE.get(law.name, {}))))
    found += [Subject("stress law", name) for name in STRESS_LAWS]
    found += [Subject("study", name) for name in STUDIES]
    found += [Subject(name, name) for name in MECHANICS]
    return tuple(found)


# Outcomes ------------------------------------------------------------------------------------------------------------


class Verdict:
    """What one case finds of one subject."""

    def __init__(self):
        self.error = None
        self.words = {}  # kept in order, each once

    def right(self, got, expected, allowed, where=""):
        """Compare with an exact value."""
        self.off(
            abs(mpf(got) - expected) / max(abs(expected), TINY),
            allowed,
            f"{where}: {got!r} for {expected}",
        )

    def off(self, error, allowed, where=""):
        """Note an error, which must not be larger than allowed."""
        error = float(error)
        assert error <= allowed, f"error {error:.3g}, allowed {allowed:.3g}; {where}"
        self.error = max(self.error or 0.0, error)

    def bounded(self):
        self.words["within bounds"] = None

    def refused(self, words):
        self.words[f"refused: {words}"] = None

    def status(self, words):
        self.words[f"status: {words}"] = None

    @property
    def outcome(self):
        """The outcome in words."""
        assert self.words or self.error is not None, "nothing was found"
        right = ["right"] if self.error is not None and "within bounds" not in self.words else []
        return "; ".join(right + list(self.words))


@attrs.frozen(kw_only=True)
class Case:
    """One hard case: what it is run on, and how it judges a subject."""

    name: str
    kinds: tuple[str, ...]
    judge: Callable[[Subject, Verdict], None]
    #: members of a slice that a stage must read to be concerned
    needs: frozenset = frozenset()
    #: subject -> why it is left out
    left_out: dict = attrs.field(factory=dict)
    #: subject -> what is known to be wrong; the case must fail until it is mended
    faults: dict = attrs.field(factory=dict)
    #: whether it is run by name only: on all subjects, or on those listed
    slow: bool | tuple[str, ...] = False
    #: whether it takes more slices than a slow model can do in minutes
    large: bool = False

    def run(self, subject):
        """Judge a subject."""
        verdict = Verdict()
        self.judge(subject, verdict)
        return verdict


def is_slow(case, subject):
    """Tell whether a pair takes so long that it is run by name only."""
    if (subject.name in SLOW_MODELS or subject.kind == "study") and case.name not in QUICK:
        return True
    return subject.name in case.slow if isinstance(case.slow, tuple) else case.slow


def why_not(case, subject):
    """Return the reason for which a case is not run on a subject; empty if it is."""
    if subject.kind not in case.kinds:
        return f"is about {', '.join(case.kinds)}"
    if case.large and subject.name in SLOW_MODELS:
        return SLOW_MODELS[subject.name]
    if missing := case.needs - subject.reads if subject.model is not None else ():
        return f"does not read {', '.join(sorted(missing))}"
    return case.left_out.get(subject.name, "")


# Judging stages ------------------------------------------------------------------------------------------------------


def answer(chain, members):
    """Return what a chain of one stage fills for one slice."""
    (model,) = chain.models
    conditions = {name: members[name] for name in model.reads & CONDITIONS.keys()}
    columns = {name: members[name] for name in model.reads & COLUMNS.keys()}
    slices = Slices(1, Conditions(**conditions), **columns)
    # a second form is for reading; overflow in it is the chain's to report. What a user runs must not warn.
    with np.errstate(all="ignore") if isinstance(model, NumpyForm) else contextlib.nullcontext():
        chain(slices)
    return {name: float(getattr(slices, name)[0]) for name in model.writes}


def attempt(call, *args, kinds=REFUSALS, **kwargs):
    """Return what a call gives and None, or None and the refusal in which it ends."""
    try:
        return call(*args, **kwargs), None
    except kinds as refusal:
        return None, refusal


def plain(model, error):
    """The words of a refusal without the model's name, which the table gives beside them."""
    return str(error).removeprefix(f"{model.name}: ")


def judge_rows(subject, verdict, rows, refused=None, must=False, allowed=None):
    """Judge a stage on slices, each by itself and in both forms.

    ``refused`` is what the words of a refusal must match; without it none is allowed, and with ``must`` it is demanded.
    A model that iterates over a field may always say that it did not settle.
    """
    if subject.name in SLOW_MODELS and not must:
        refused = "|".join(filter(None, (refused, UNSETTLED)))
    for row in rows:
        answers = []
        for chain in subject.forms:
            got, refusal = attempt(answer, chain, row)
            if refusal is None:
                answers.append((chain, got))
                continue
            assert refused, (row, refusal)
            assert re.search(refused, str(refusal)), (row, refusal)
            assert "\n" not in str(refusal)
            verdict.refused(plain(subject.model, refusal))
        if answers:
            assert not must, (row, answers)
            judge_answers(subject, verdict, row, answers, allowed)


def judge_answers(subject, verdict, row, answers, allowed):
    expected = exact(subject.name, subject.model, {name: row[name] for name in subject.reads})
    for chain, got in answers:
        assert all(math.isfinite(value) for value in got.values()), (row, got)
        if subject.kind == "traction":
            judge_friction(chain, row, got["friction"])
        if expected is not None:
            for column, value in got.items():
                limit = (
                    allowed
                    or ALLOWED.get(subject.kind)
                    or 20 * EPS * (1 + condition(subject, row, column))
                )
                verdict.right(value, expected[column], limit, f"{column} at {row}")
    if expected is None:
        verdict.bounded()
        for column, value in answers[0][1].items():
            assert subject.kind != "film" or value > 0, (row, answers)
            for _, got in answers[1:]:
                limit = max(ALIKE, subject.model.tolerance)
                verdict.off(
                    abs(got[column] - value) / max(abs(value), TINY),
                    limit,
                    f"{column} at {row}: {answers}",
                )


def judge_friction(chain, row, friction):
    """Friction is odd to the last bit, takes power out of sliding, and is below Newton's or 1."""
    speed = row["sliding_speed"]
    assert answer(chain, row | {"sliding_speed": -speed})["friction"] == -friction
    assert friction * math.copysign(1.0, speed) >= 0
    assert speed != 0 or friction == 0
    bound = 1.0
    reads = chain.models[0].reads
    if "film_viscosity" in reads or "viscosity" in reads:
        eta = row["film_viscosity"]
        if "viscosity" in reads:  # its own, at the largest pressure of the contact
            eta = row["viscosity"] * math.exp(
                min(row["pressure_viscosity"] * row["pressure"] * 4 / math.pi, 700.0)
            )
        bound = max(bound, eta * abs(speed) / row["film_thickness"] / row["pressure"])
    assert abs(friction) <= bound * (1 + ALIKE)


def condition(subject, row, column):
    """Condition number of a law in 50 digits: the sum over what it reads of |x/f df/dx|."""
    members = {name: row[name] for name in subject.reads}
    return condition_of(lambda m: exact(subject.name, subject.model, m)[column], members)


def condition_of(law, members):
    with mp.workdps(DIGITS):
        members = {name: mpf(value) for name, value in members.items()}
        middle = law(members)
        step = mpf(10) ** -15
        total = mpf(0)
        for name, value in members.items():
            if value and mp.isfinite(value) and middle:
                ends = (law(members | {name: value * (1 + sign * step)}) for sign in (1, -1))
                total += abs((next(ends) - next(ends)) / (2 * step * middle))
        return float(total)


def rows(*changes):
    """Slices that differ from the usual one by these changes."""
    return [BASE | change for change in changes]


def film(sigma=1.0, deborah=1e-3, heating=0.1, **changes):
    """The usual slice with other members, such that an Eyring fluid has these groups."""
    row = BASE | changes
    eta = row["film_viscosity"]
    h = row["film_thickness"]
    zeta = (
        0.97 * math.sqrt(row["half_width"] / (math.pi * row["rolling_speed"])) / row["effusivity"]
    )
    zeta += h / (12 * row["conductivity"])
    return row | {
        "sliding_speed": sigma * row["eyring_stress"] * h / eta,
        "shear_modulus": eta * row["rolling_speed"] / (max(deborah, 1e-250) * row["half_width"]),
        "film_thermoviscosity": heating * eta / (zeta * row["eyring_stress"] ** 2 * h),
    }


def loaded(force, viscosity_ratio=None):
    """The usual slice under a normal force, with the pressure, half width and viscosity that go with it."""
    load = force / BASE["length"]
    half_width = math.sqrt(8 * load * BASE["radius"] / (math.pi * BASE["modulus"]))
    pressure = load / (2 * half_width)
    return BASE | {
        "load": load,
        "half_width": half_width,
        "pressure": pressure,
        "approach": 1e-9 * force**0.9,
        "film_viscosity": BASE["viscosity"] * math.exp(BASE["pressure_viscosity"] * pressure),
        "film_thermoviscosity": BASE["thermoviscosity"]
        + BASE["pressure_thermoviscosity"] * pressure,
    }


#: Force at which the largest Hertz pressure of the usual contact is 4 GPa, the static capacity of ISO 76.
YIELD = 2 * math.pi * BASE["radius"] * 4e9**2 / BASE["modulus"] * BASE["length"]

OUTSIDE = r"= .+ is outside its domain \("
NOT_FINITE = r"slice \d+ gives a \w+ that is not finite; its inputs are too large or too small"
UNSETTLED = r"slice \d+ (has no solution|did not settle): .*; (take|ask)"
BEYOND = rf"{OUTSIDE}|{NOT_FINITE}|{UNSETTLED}|slice \d+ is outside its domain"
STAGES = ("contact", "deflection", "film", "viscosity", "traction")
#: Reduced strain rates [1], from all but zero to far above those of bearings.
SIGMAS = [1e-300, 1e-150, 1e-8, 1e-2, 0.5, 1.0, 1e3, 1e6, 1e12]
#: Deborah numbers [1]: no elasticity, products that vanish, and up far above those of bearings.
DEBORAHS = [0.0, 1e-300, 1e-6, 1e-2, 1.0, 1e3, 1e8]
#: Heating groups [1]: none, products that vanish, and up to a film whose stress heating decides.
HEATINGS = [0.0, 1e-300, 1e-6, 0.1, 1.0, 1e3, 1e6]


def stage_case(name, kinds, slices, *needs, faults=None, **how):
    return Case(
        name=name,
        kinds=(kinds,) if isinstance(kinds, str) else kinds,
        judge=partial(judge_rows, rows=slices, **how),
        needs=frozenset(needs),
        faults=faults or {},
    )


def not_a_number(subject, verdict):
    """Each member in turn NaN or infinite: refused with the member's name and what is allowed."""
    for name in sorted(subject.reads):
        for value in (math.nan, math.inf, -math.inf):
            for chain in subject.forms:
                got, refusal = attempt(answer, chain, BASE | {name: value})
                words = rf"(needs {name} \(|slice 0 has no {name} \(|{name} = -?inf .*is outside its domain \()"
                assert refusal is not None, f"{name} = {value} gives {got}"
                assert re.match(f"{subject.model.name}: {words}", str(refusal)), refusal
    verdict.refused("the member, what came and what is allowed or to be given")


def at_thresholds(subject, verdict):
    """Film parameters exactly at each limit of a blend, and a rounding error beside it."""
    limits = [
        getattr(subject.model, field.name)
        for field in attrs.fields(type(subject.model))
        if field.name.endswith("limit") and field.metadata.get("unit") == "1"
    ]
    limits += [limit for limit in [subject.model.full_film_from] if limit is not None]
    assert limits, "where does it change its law?"
    for limit in sorted(set(limits)):
        at = (
            limit * BASE["roughness"]
        )  # the roughness is a power of two: the ratio is the limit exactly
        beside = [math.nextafter(at, 0.0), at, math.nextafter(at, math.inf)]
        for speed in (1e-6, 0.3, 3.0, 29.8):
            slices = rows(*({"film_thickness": h, "sliding_speed": speed} for h in beside))
            judge_rows(subject, verdict, slices)
            for chain in subject.forms:
                low, middle, high = (answer(chain, row)["friction"] for row in slices)
                # a part of rough surfaces that vanishes is cut off where it is a rounding of its whole
                rough = (
                    Chain(subject.model.boundary) if hasattr(subject.model, "boundary") else chain
                )
                scale = max(abs(middle), abs(answer(rough, slices[1])["friction"]))
                assert max(abs(low - middle), abs(high - middle)) <= ALIKE * scale, (
                    limit,
                    low,
                    middle,
                    high,
                )


def piezoviscous_blow_up(subject, verdict):
    """Contacts at and beyond g_V = W^1.5 G/U^0.5 = 17.602, where a Barus oil between rigid surfaces has no film."""
    for g in (17.602, math.nextafter(17.602, 18.0), 100.0, 1e6):
        u = 1e-3
        speed_group = BASE["viscosity"] * u / (BASE["modulus"] * BASE["radius"])
        W = (g * math.sqrt(speed_group) / (BASE["pressure_viscosity"] * BASE["modulus"])) ** (2 / 3)
        row = loaded(W * BASE["modulus"] * BASE["radius"] * BASE["length"])
        judge_rows(subject, verdict, [row | {"rolling_speed": u}], refused=r"[a-z]{4,}")


def regime_boundaries(subject, verdict):
    """Where two formulas of the regimes meet, and a rounding error beside it."""
    G = BASE["pressure_viscosity"] * BASE["modulus"]
    # g_V = W^1.5 G/U^0.5 and g_E = W/U^0.5 of a point on each boundary -> U, W
    for g_v, g_e in (
        (5.035, 0.5),
        (1.0, 1.770),
        (38.97 * 5**0.4737, 5.0),
        (1.337 * 5**1.3704, 5.0),
    ):
        W = (g_v / g_e / G) ** 2
        U = (W / g_e) ** 2
        load = W * BASE["modulus"] * BASE["radius"]
        speed = U * BASE["modulus"] * BASE["radius"] / BASE["viscosity"]
        for each in (load, math.nextafter(load, 0), math.nextafter(load, math.inf)):
            row = BASE | {"load": each, "rolling_speed": speed}
            (got, *others) = [answer(chain, row) for chain in subject.forms]
            expected = exact(
                subject.name, subject.model, {name: row[name] for name in subject.reads}
            )
            for form in (got, *others):
                if expected is None:
                    verdict.bounded()
                    h = got["film_thickness"]
                    verdict.off(
                        abs(form["film_thickness"] - h) / h, max(ALIKE, subject.model.tolerance)
                    )
                else:
                    verdict.right(
                        form["film_thickness"],
                        expected["film_thickness"],
                        ALLOWED["film"],
                        f"{row}",
                    )


def coarse_slices(subject, verdict):
    """Tables of no, one and two slices, and of those beside a block's size: each slice is what it is alone.

    To the last bit where it is compiled; in NumPy an iteration may go on for the sake of another slice.
    """
    compiled = len(subject.forms) == 2
    whole = table(subject.model, 258 if compiled else 9)
    chain = subject.forms[0]
    singles = [whole.taken([i]) for i in range(len(whole))]
    for one in singles:
        chain(one)
    for n in (0, 1, 2, 255, 256, 257):
        part = whole.taken(slice(0, n))
        chain(part)
        for name in subject.model.writes:
            for got, one in zip(getattr(part, name), singles, strict=False):
                alone = getattr(one, name)[0]
                verdict.off(
                    abs(got - alone) / max(abs(alone), TINY), 0.0 if compiled else ALIKE, name
                )


def split_over_threads(subject, verdict):
    """The same table, cut into parts that run on 1, 2 and 8 threads at once: the same bits."""
    whole = table(subject.model, 4096 if len(subject.forms) == 2 else 16)
    chain = subject.forms[0]

    def parts():
        return [
            whole.taken(slice(k * len(whole) // 8, (k + 1) * len(whole) // 8)) for k in range(8)
        ]

    expected = parts()
    for part in expected:
        chain(part)
    for threads in (1, 2, 8):
        got = parts()
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(chain, got))
        for part, reference in zip(got, expected, strict=True):
            for name in subject.model.writes:
                np.testing.assert_array_equal(getattr(part, name), getattr(reference, name))
    verdict.off(0.0, 0.0)


#: Slices that are repeated: more than a block.
PATTERN = 1000
#: Slices in all: ten thousand repetitions of the pattern.
MILLIONS = 10_000_000


def ten_million_slices(subject, verdict):
    """10 million slices have the bits of the thousand they repeat, at any block, and leave no memory behind."""
    resource = __import__("resource")  # not on every system, and only here
    small = table(subject.model, 2 * PATTERN)
    small = small.taken(slice(0, PATTERN))
    assert len(small) == PATTERN
    large = Slices(MILLIONS, small.conditions)
    for name in subject.reads & COLUMNS.keys():
        getattr(large, name).reshape(-1, PATTERN)[:] = getattr(small, name)
    chain = subject.forms[0]
    chain(small)
    peaks = []
    for _ in range(3):
        for name in subject.model.writes:
            getattr(large, name)[:] = np.nan
        chain(large)
        peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert peaks[-1] - peaks[0] < 16 * 1024, f"memory grows: {peaks} KiB"
    for name in subject.model.writes:
        for block in getattr(large, name).reshape(-1, PATTERN):
            assert np.array_equal(block, getattr(small, name))
    verdict.off(0.0, 0.0)


# Judging stress laws -------------------------------------------------------------------------------------------------


def judge_stress(subject, verdict, points):
    """A stress law at groups (sigma, D, Phi), in both forms and mirrored."""
    *forms, reference = STRESS_LAWS[subject.name]
    for point in points:
        with mp.workdps(DIGITS):
            expected = reference(*map(mpf, point))
        for law in forms:
            got = float(law(*point))
            verdict.right(got, expected, ALLOWED["stress law"], f"{law.__name__}{point}")
            assert float(law(-point[0], *point[1:])) == -got


def stress_of_no_number(subject, verdict):
    """NaN is handed on, never turned into a number."""
    groups = (
        (1, 2) if subject.name == "eyring stress" else (0, 1, 2)
    )  # Eyring's law has no Deborah number
    for law in STRESS_LAWS[subject.name][:2]:
        for k in groups:
            point = [1.0, 1.0, 1.0]
            point[0 if subject.name == "eyring stress" and k == 1 else k] = math.nan
            assert math.isnan(float(law(*point)))
    verdict.status("NaN in, NaN out; a stage refuses it before")


# Judging the load distribution ---------------------------------------------------------------------------------------

# equivalent radii of the paper's bearing [m]
INNER = 0.006875
#: The outer contact is concave.
OUTER = 0.008125
LENGTH = BASE["length"]
#: Rollers of that bearing.
ROLLERS = 28
#: Radial load of the paper, Fig. 2 [N].
FORCE = 3415.0
LARGE = 0.014  # clearance that leaves one roller even at yield [m]


def bearing_law(subject, radii=(INNER, OUTER)):
    """Contacts of a bearing with both rings, after a stage of deflection."""
    return tuple(
        SimpleNamespace(
            conditions=Conditions(length=LENGTH, radius=radius, modulus=BASE["modulus"]),
            deflection=subject.forms[0],
        )
        for radius in radii
    )


def exact_law(subject, radius):
    """Approach [m] as a function of the load per length, in 50 digits."""
    m = {"length": LENGTH, "radius": radius, "modulus": BASE["modulus"]}
    return DEFLECTIONS[subject.name.removesuffix(" deflection")](
        {name: mpf(value) for name, value in m.items()}
    )


def load_case(slices=1, n_positions=1, **changes):
    given = {"radial_clearance": 0.0, "radial_load": FORCE} | changes
    return LoadCase(angular_positions(ROLLERS, n_positions), LENGTH, np.zeros(slices), **given)


def one_roller(subject, verdict):
    """A clearance so large that the roller in the line of load carries all, and the ring comes to rest on it."""
    for force in (1.0, FORCE, YIELD):
        solved = solve_equilibrium(
            load_case(radial_clearance=LARGE, radial_load=force), bearing_law(subject)
        )
        with mp.workdps(DIGITS):
            approach = sum(
                exact_law(subject, radius)(mpf(force) / mpf(LENGTH)) for radius in (INNER, OUTER)
            )
            verdict.right(solved.inner_force[0, 0], mpf(force), 1e-12, f"{force} N")
            verdict.right(solved.displacement[0, 0], mpf(LARGE) / 2 + approach, 1e-12, f"{force} N")
        assert not np.any(solved.inner_force[0, 1:])


def exact_straight(subject, case):
    """Normal forces of straight rollers by the law of two contacts in series, in 50 digits; psi = 0 is loaded."""
    inner, outer = (exact_law(subject, radius) for radius in (INNER, OUTER))
    l = mpf(LENGTH)  # noqa: E741
    centrifugal = mpf(case.centrifugal_force)
    seat = outer(centrifugal / l) if centrifugal else mpf(0)
    half = case.psi.shape[1] // 2 + 1
    cos = [mp.cos(mpf(psi)) for psi in case.psi[0, :half]]
    fractions = [1] + [2] * (half - 2) + [1]

    def force(gap):
        if gap <= seat:
            return mpf(0)

        def excess(x):
            return mp.log(
                (inner(mp.exp(x) / l) + outer((mp.exp(x) + centrifugal) / l) - seat) / (gap - seat)
            )

        return mp.exp(solve(excess, mp.log((gap - seat) * mpf(10) ** 8)))

    def forces(dx):
        return [force(dx * c - mpf(case.radial_clearance) / 2) for c in cos]

    def unbalanced(dx):
        return (
            sum(k * c * q for k, c, q in zip(fractions, cos, forces(dx), strict=True))
            / mpf(case.radial_load)
            - 1
        )

    start = mpf(float(solve_equilibrium(case, bearing_law(subject)).displacement[0, 0]))
    return forces(solve(unbalanced, start, -start / 1000))


def straight(subject, verdict, cases, allowed):
    """All loads of straight rollers, relative to the largest."""
    for changes in cases:
        case = load_case(**changes)
        solved = solve_equilibrium(case, bearing_law(subject))
        with mp.workdps(DIGITS):
            expected = exact_straight(subject, case)
            for got, force in zip(solved.inner_force[0], expected, strict=False):
                verdict.off(
                    abs(mpf(got) - force) / max(expected),
                    allowed,
                    f"{changes}: {got} N for {force} N",
                )
        if case.radial_clearance < 0:
            assert np.all(solved.inner_force > 0), "preload presses all rollers"


def unloaded(subject, verdict):
    """Without load the inner ring carries nothing to the last bit; rollers press outwards with what turns them."""
    for clearance in (0.0, 2e-5):
        for centrifugal in (0.0, 174.0):
            case = load_case(
                radial_load=0.0, radial_clearance=clearance, centrifugal_force=centrifugal, slices=5
            )
            solved = solve_equilibrium(case, bearing_law(subject))
            assert not np.any(solved.inner_load)
            for force in solved.outer_force[0]:
                verdict.right(force, mpf(centrifugal), 1e-12)


def tilted(subject, verdict, tilts, least):
    """One straight roller between a ring and a tilted one: it takes half of the tilt, and edges carry most."""
    law = bearing_law(subject, (INNER, INNER))
    slices = 21
    for tilt in tilts:
        case = load_case(radial_clearance=LARGE, misalignment=tilt, slices=slices)
        solved = solve_equilibrium(case, law)
        with mp.workdps(DIGITS):
            approach_of = exact_law(subject, INNER)
            x = [mpf(position) for position in slice_positions(LENGTH, slices)]
            width = mpf(LENGTH) / slices

            def loads(approach, tilt=tilt, x=x, approach_of=approach_of):
                return [load_of(approach_of, approach + mpf(tilt) * at / 2)[0] for at in x]

            def excess(approach, loads=loads, width=width):
                return sum(loads(approach)) * width / mpf(FORCE) - 1

            start = mpf(float(solved.displacement[0, 0]) - LARGE / 2) / 2
            expected = loads(solve(excess, start, -start / 1000))
            for ring in (solved.inner_load, solved.outer_load):
                for got, load in zip(ring[0, 0], expected, strict=True):
                    verdict.off(
                        abs(mpf(got) - load) / max(expected),
                        1e-10,
                        f"tilt {tilt}: {got} for {load}",
                    )
        assert (
            np.count_nonzero(solved.inner_load[0, 0] == 0.0)
            == sum(load == 0 for load in expected)
            >= least
        )
        assert np.argmax(solved.inner_load[0, 0]) == (slices - 1 if tilt > 0 else 0)


def crushed(subject, verdict):
    """Loads that no contact bears: an answer that balances, or words, and no overflow on the way."""
    for changes in (
        {"radial_load": 1e12},
        {"radial_load": 1e300},
        {"radial_load": 1.0, "centrifugal_force": 1e300},
        {"radial_clearance": -1e300},
        {"radial_clearance": 1e300},
        {"misalignment": 1e300, "slices": 5},
    ):
        solved, refusal = attempt(solve_equilibrium, load_case(**changes), bearing_law(subject))
        if refusal is None:
            verdict.off(max(solved.force_residual, solved.moment_residual), 1e-10, str(changes))
        else:
            assert re.search(
                "no equilibrium .*; check|is outside its domain|that is not finite", str(refusal)
            )
            verdict.refused(
                re.sub(r"\d+ iterations|residual of.*required 1e-10", "...", str(refusal))
            )


def unfit_load_case(subject, verdict):
    """NaN or infinity in any part of a load case: a ValueError that names it."""
    for name in ("radial_clearance", "radial_load", "misalignment", "centrifugal_force"):
        for value in (math.nan, math.inf, -math.inf):
            _raises(ValueError, f"{name} is {value}.*: it must be", load_case, **{name: value})
    for psi, drop, length, says in (
        ([[math.nan]], [0.0], LENGTH, "psi must be finite"),
        ([[0.0]], [math.inf], LENGTH, "drop must be finite"),
        ([[0.0]], [0.0], math.nan, "roller_length is nan"),
        ([[0.0]], [0.0], math.inf, "roller_length is inf"),
    ):
        _raises(
            ValueError, says, LoadCase, psi, length, drop, radial_clearance=0.0, radial_load=1.0
        )
    _raises(ValueError, "at least one of each", angular_positions, 0, 1)
    verdict.refused("ValueError: NAME is nan N: it must be zero or positive, or finite")


def _raises(kind, says, call, *args, **kwargs):
    """Return the words in which a call is refused."""
    got, refusal = attempt(call, *args, kinds=kind, **kwargs)
    assert refusal is not None, f"{args} {kwargs} gives {got!r}; expected {says}"
    assert re.search(says, str(refusal)), (says, str(refusal))
    return str(refusal)


# Judging kinematics, profile, critical slip --------------------------------------------------------------------------

W = 667.2  # rad/s
#: Radii of the paper's bearing [m].
BEARING = {"inner_radius": 0.0825, "outer_radius": 0.0975, "roller_radius": 0.0075}


def kinematics(inner=W, outer=0.0):
    return Kinematics(**BEARING, inner_speed=inner, outer_speed=outer)


def exact_speeds(k, cage_slip, roller_slip):
    """Sliding and rolling speeds as differences of the surfaces' speeds, in 50 digits."""
    Ri, Ro, r = (mpf(BEARING[name]) for name in ("inner_radius", "outer_radius", "roller_radius"))
    wi = k.direction * mpf(k.inner_speed)
    wo = k.direction * mpf(k.outer_speed)
    cage = (Ri * wi + Ro * wo) / (Ri + Ro)
    wc = cage * (1 - mpf(cage_slip))
    wr = Ri * (wi - cage) / r * (1 - mpf(roller_slip))
    inner = Ri * (wi - wc)
    outer = Ro * (wc - wo)
    spin = r * wr
    return {
        "inner_sliding": inner - spin,
        "outer_sliding": spin - outer,
        "inner_rolling": (inner + spin) / 2,
        "outer_rolling": (outer + spin) / 2,
    }


def speeds(subject, verdict, pairs, slips):
    """All speeds at slips that vanish, are denormal, negative or large; sliding keeps its digits however small."""
    for pair in pairs:
        k = kinematics(*pair)
        for cage_slip, roller_slip in slips:
            got = k.surface_speeds(cage_slip, roller_slip)
            with mp.workdps(400):  # the differences of a denormal slip
                exact = exact_speeds(k, cage_slip, roller_slip)
                # of two slips the larger: where both meet, one surface rolls and its sliding speed is their rounding
                scale = max(
                    abs(mpf(k.epicyclic_cage_speed) * mpf(cage_slip)) * mpf("0.09"),
                    abs(exact["inner_sliding"]),
                )
                for name, expected in exact.items():
                    size = scale if "sliding" in name else abs(expected)
                    error = abs(mpf(float(getattr(got, name))) - expected) / max(size, TINY)
                    verdict.off(error, 1e-14, f"{name} of {pair} at {cage_slip}")


def counter_rotation(subject, verdict):
    """Rings against each other at an epicyclic cage speed of zero: cage slip has no meaning, but zero slip has."""
    for outer in (-W * 0.0825 / 0.0975, math.nextafter(-W * 0.0825 / 0.0975, 0.0)):
        k = kinematics(W, outer)
        u = float(k.surface_speeds(0.0, 0.0).inner_rolling)
        with mp.workdps(DIGITS):
            verdict.right(u, exact_speeds(k, 0.0, 0.0)["inner_rolling"], 1e-14)
        for call in (
            lambda k=k: k.surface_speeds(0.1, 0.0),
            lambda k=k: k.roller_slip_outer_rolling(0.1),
        ):
            verdict.refused(
                _raises(DomainError, "cage slip, which is relative to it, has no meaning", call)
            )


def mirrored_rotation(subject, verdict):
    """All rings the other way round: the same bits."""
    for pair in ((W, 0.0), (0.0, W), (W, -W), (W, 0.9 * W)):
        there, back = (
            kinematics(sign * pair[0], sign * pair[1]).surface_speeds(0.1, -0.03)
            for sign in (1, -1)
        )
        for field in attrs.fields(type(there)):
            np.testing.assert_array_equal(getattr(there, field.name), getattr(back, field.name))
    verdict.off(0.0, 0.0)


def unfit_kinematics(subject, verdict):
    for outer in (0.0, W):
        verdict.refused(
            _raises(DomainError, "nothing rolls: both rings turn at", kinematics, outer, outer)
        )
    for value in (math.nan, math.inf, -math.inf):
        _raises(ValueError, "inner_speed", kinematics, value)
        _raises(
            ValueError,
            "inner_radius|outer raceway",
            Kinematics,
            **BEARING | {"inner_radius": value},
            inner_speed=1.0,
            outer_speed=0.0,
        )
    verdict.refused("ValueError: the field, the limit and what came")


def profile_of(shape, x, **how):
    return profile_drop(shape, x, LENGTH, 0.015, **how)


def profiles(subject, verdict):
    """The logarithm beside the end of the roller, a crown as flat as a cylinder, up to ten million slices."""
    with mp.workdps(DIGITS):
        half = mpf(LENGTH) / 2
        for n in (1, 2, 101, 100_001, 10_000_001):
            x = float(slice_positions(LENGTH, n)[-1])
            distance = -mpf("0.00035") * mpf("0.015") * mp.log(1 - (mpf(x) / half) ** 2)
            verdict.right(
                float(profile_of("iso16281", x)),
                distance,
                1e-8 if n > 1e6 else 1e-10,
                f"{n} slices",
            )
        for radius in (0.5 * LENGTH, 5.0, 1e6, 1e100):
            expected = (
                mpf(radius) - mp.sqrt(mpf(radius) ** 2 - mpf(0.007) ** 2)
                if radius < 1e9
                else mpf(0.007) ** 2 / (2 * mpf(radius))
            )
            verdict.right(
                float(profile_of("circular", 0.007, radius=radius)),
                expected,
                1e-14,
                f"radius {radius}",
            )
    verdict.refused(
        _raises(
            DomainError, "infinite at the ends of the roller", profile_of, "iso16281", LENGTH / 2
        )
    )
    for x in (math.nan, math.inf, 0.5000001 * LENGTH):
        _raises(ValueError, "positions must lie on the roller", profile_of, "iso16281", x)
    for radius in (math.nan, math.inf, 0.1 * LENGTH):
        _raises(ValueError, "does not span the roller", profile_of, "circular", 0.0, radius=radius)
    for column in ([math.nan, 1.0], [0.0, math.inf]):
        _raises(ValueError, "must be finite", profile_of, "table", 0.0, table=([-1.0, 1.0], column))
    verdict.refused("ValueError: what is unfit, and what is allowed")


def maxima(subject, verdict):
    """Curves with a known maximum: two equal ones, a plateau, one beside the end, denormal friction, a tiny range."""
    for curve, grid, slip, friction in (
        (lambda s: math.sin(2 * math.pi * s) ** 2, np.linspace(0, 1, 101), 0.25, 1.0),
        (lambda s: math.sin(2 * math.pi * s) ** 2, np.linspace(0, 1, 24), 0.25, 1.0),
        (lambda s: s * math.exp(1 - s), np.linspace(0, 1.0005, 41), 1.0, 1.0),
        (lambda s: 1e-310 * s * math.exp(1 - s), np.linspace(0, 4, 41), 1.0, 1e-310),
        (lambda s: s / 1e-12 * math.exp(1 - s / 1e-12), np.linspace(0, 4e-12, 41), 1e-12, 1.0),
        (lambda s: s * 1e-300 * math.exp(1 - s * 1e-300), np.linspace(0, 4e300, 41), 1e300, 1.0),
    ):
        found = find_critical_slip(
            curve, grid, np.array([curve(float(s)) for s in grid]), "max_slip"
        )
        assert found.status == "found"
        verdict.off(abs(found.slip / slip - 1), 3e-7, f"{found} for {slip}")
        verdict.off(
            abs(found.friction / friction - 1) if friction > TINY else 0.0,
            1e-12,
            f"{found} for {friction}",
        )
    plateau = np.array([0.0, 1.0, 1.0, 0.5])
    found = find_critical_slip(
        lambda s: float(np.interp(s, range(4), plateau)), np.arange(4.0), plateau, "max_slip"
    )
    assert found.status == "found"
    assert 1.0 <= found.slip <= 2.0


def no_maximum(subject, verdict, values):
    """What there is in place of a maximum, in words, and NaN for its place."""
    slip = np.linspace(0.0, 0.3, len(values))
    found = find_critical_slip(
        lambda s: float(np.interp(s, slip, values)), slip, np.array(values), "max_slip"
    )
    assert math.isnan(found.slip)
    assert math.isnan(found.friction)
    verdict.status(found.status)


def curve_of_no_number(subject, verdict):
    """NaN or infinity in a curve is refused, not taken for the largest or for no friction."""
    slip = np.linspace(0.0, 0.3, 5)
    for value in (math.nan, math.inf, -math.inf):
        for place in range(5):
            friction = np.linspace(0.0, 1.0, 5)
            friction[place] = value
            call = partial(find_critical_slip, lambda s: s, slip, friction, "max_slip")
            words = _raises(DomainError, r"friction is (nan|inf|-inf) at a slip of", call)
    verdict.refused(
        re.sub(r"is -inf at a slip of \S+", "is nan, inf or -inf at a slip of ...", words)
    )


# Judging studies -----------------------------------------------------------------------------------------------------


@cache
def paper():
    return evolve(
        load_scene("1032930-70C"),
        {
            "bearing.profile": "none",
            "accuracy.slices": 11,
            "study.effective-friction.points": 5,
            "study.effective-friction.map_points": 0,
            "study.effective-friction.max_cage_slip": 0.4,
            "study.friction-curve.points": 5,
        },
    )


def scene_for(subject, changes):
    study, variant = subject.name.split()
    return evolve(
        paper(),
        {f"study.{study}.{'ring' if study == 'friction-curve' else 'closure'}": variant, **changes},
        si=True,
    )


def force_on(subject, force):
    """The change that loads a study's contacts."""
    if subject.name.startswith("friction-curve"):
        return {"study.friction-curve.normal_force": [force]}
    return {"operation.radial_load": force}


def judge_result(subject, verdict, changes, refused=None, must=False, check=True):
    """Run a study; judge its result, or the words in which it refuses."""
    scene, refusal = attempt(scene_for, subject, changes)
    if refusal is None:
        result, refusal = attempt(run, scene, subject.name.split()[0])
    if refusal is not None:
        assert refused, f"{changes}: {refusal}"
        # a scene has no values beyond what is possible
        assert re.search(f"{refused}|must be from", str(refusal)), f"{changes}: {refusal}"
        assert "\n" not in str(refusal)
        verdict.refused(re.sub(r"^(changes|[\w-]+:\d+): ", "", str(refusal)))
        return
    assert not must, f"{changes} ran"
    for name, values in result.variables.items():
        # a status says why a value is missing
        has_status = name in (
            "steady_cage_slip",
            "steady_drag",
            "limit_drag",
            "skidding_slip",
            "drag_reserve",
            "critical_slip",
            "critical_cage_slip",
            "critical_friction",
            "first_maximum_slip",
            "first_maximum_friction",
            "roller_friction",
        )
        if values.dtype.kind == "f" and not has_status:
            assert np.all(np.isfinite(values.to_numpy())), (changes, name)
    friction = result["friction" if "friction" in result else "effective_friction"].to_numpy()
    assert np.all(friction >= 0), changes
    assert not np.any(friction[:, 0]), "no friction without slip"
    if check:
        judge_numbers(subject, verdict, result, assemble(scene))
    else:
        verdict.words["within bounds"] = None
    for status in np.unique(result.critical_status.to_numpy()):
        if status != "found":
            verdict.status(str(status))


def exact_contact(assembly, ring, load, rolling, sliding):
    """Friction of one contact through all stages in 50 digits, without rounding in between."""
    raceway = assembly.inner if ring == "inner" else assembly.outer
    members = attrs.asdict(raceway.conditions) | {
        "load": load,
        "rolling_speed": rolling,
        "sliding_speed": sliding,
    }
    with mp.workdps(DIGITS):
        members = {name: mpf(value) for name, value in members.items()}
        for model in raceway.chain.models:
            members |= exact(model.name, model, members)
    return members["friction"]


def judge_numbers(subject, verdict, result, assembly):
    """The numbers of a study on straight rollers against the laws in 50 digits."""
    variant = subject.name.split()[1]
    with mp.workdps(DIGITS):
        if "friction" in result:
            u = exact_speeds_of(assembly, 0.0, mpf(0))["inner_rolling"]
            for i, force in enumerate(result.normal_force.to_numpy()):
                for j, slip in enumerate(result.slip.to_numpy()):
                    expected = exact_contact(
                        assembly, variant, mpf(force) / mpf(LENGTH), u, mpf(slip) * u
                    )
                    verdict.right(
                        float(result.friction[i, j]), expected, ALIKE, f"{force} N at {slip}"
                    )
            return
        loads = assembly.load_distribution(result.attrs["n_positions"])
        for j in (1, result.cage_slip.size - 1):
            slip = mpf(float(result.cage_slip[j]))
            speeds = exact_speeds_of(assembly, slip, mpf(0) if variant == "epicyclic" else None)
            for i, (ring, forces) in enumerate(
                (("inner", loads.inner_force), ("outer", loads.outer_force))
            ):
                if variant == "free-roller":
                    break
                pull = total = mpf(0)
                for force, count in zip(
                    *np.unique(forces[forces > 0], return_counts=True), strict=True
                ):
                    u = speeds[f"{ring}_rolling"]
                    V = speeds[f"{ring}_sliding"]
                    pull += (
                        count
                        * mpf(force)
                        * exact_contact(assembly, ring, mpf(force) / mpf(LENGTH), u, V)
                    )
                    total += count * mpf(force)
                expected = mp.sign(assembly.kinematics.epicyclic_cage_speed) * pull / total
                verdict.right(
                    float(result.effective_friction[i, j]), expected, ALIKE, f"{ring} at {slip}"
                )
            else:
                continue
            free_roller(verdict, assembly, loads, result, j)


def free_roller(verdict, assembly, loads, result, j):
    """Both rings pull alike in sum; the spin is found to 1e-12, which friction multiplies by its steepness."""
    pulls = [
        float(result.effective_friction[i, j]) * forces.sum()
        for i, forces in enumerate((loads.inner_force, loads.outer_force))
    ]
    sliding, spin = (float(abs(result[name][1, j])) for name in ("sliding_speed", "roller_slip"))
    steepness = spin * float(result.rolling_speed[1, j]) / sliding
    verdict.off(abs(pulls[0] - pulls[1]) / pulls[0], 1e-11 * steepness, f"{pulls} {steepness}")


def exact_speeds_of(assembly, cage_slip, roller_slip):
    """Speeds of a study's contacts at a cage slip; without a roller slip the outer contact rolls."""
    k = assembly.kinematics
    Ri = mpf(k.inner_radius)
    Ro = mpf(k.outer_radius)
    wi = k.direction * mpf(k.inner_speed)
    wo = k.direction * mpf(k.outer_speed)
    epicyclic = (Ri * wi + Ro * wo) / (Ri + Ro)
    wc = epicyclic * (1 - cage_slip)
    spin = Ri * (wi - epicyclic) * (1 - roller_slip) if roller_slip is not None else Ro * (wc - wo)
    inner = Ri * (wi - wc)
    outer = Ro * (wc - wo)
    return {
        "inner_sliding": inner - spin,
        "outer_sliding": spin - outer,
        "inner_rolling": (inner + spin) / 2,
        "outer_rolling": (outer + spin) / 2,
    }


def any_key(subject, verdict, values, refused, must=False):
    """Each number of a scene, and of the study's settings, in turn at such a value."""
    study, _ = subject.name.split()
    keys = [row.key for row in schema() if row.unit and "*" not in row.key and "[]" not in row.key]
    own = {
        "friction-curve": ("max_slip", "normal_force"),
        "effective-friction": ("max_cage_slip",),
    }[study]
    keys += [f"study.{study}.{name}" for name in own]
    for key in keys:
        crown = {} if key.startswith("bearing.profile") else {"bearing.profile": "iso16281"}
        for value in values:
            listed = key.endswith(("normal_force", "position", "drop"))
            changes = crown | {key: [value] if listed else value}
            judge_result(subject, verdict, changes, refused=refused, must=must, check=False)
    verdict.words.clear()
    if not must:
        verdict.bounded()
    verdict.refused("the key or the model, what came, and what is allowed or to be done")


def crowned(subject, verdict):
    """The load of the most loaded slice of a crowned contact, down to forces that barely dent it."""
    inner = subject.name.endswith("inner")
    for slices in (10, 11):  # without and with a slice in the middle, where the crown begins
        for force in (1e-9, 1e-3, 518.0):
            scene = scene_for(
                subject,
                {
                    "bearing.profile": "iso16281",
                    "accuracy.slices": slices,
                    "study.friction-curve.normal_force": [force],
                },
            )
            result = run(scene, "friction-curve")
            assembly = assemble(scene)
            conditions = (assembly.inner if inner else assembly.outer).conditions
            with mp.workdps(DIGITS):
                m = {
                    name: mpf(getattr(conditions, name)) for name in ("length", "radius", "modulus")
                }
                approach_of = DEFLECTIONS["palmgren"](m)
                drop = [mpf(x) for x in assembly.drop]

                def loads(log_depth, approach_of=approach_of, drop=drop):
                    touch = mp.exp(log_depth) + min(drop)
                    return [load_of(approach_of, touch - x)[0] for x in drop]

                def excess(log_depth, loads=loads, slices=slices, force=force):
                    return mp.log(sum(loads(log_depth)) * mpf(LENGTH) / slices / mpf(force))

                most = max(loads(solve(excess, mp.log(mpf("1e-9") * mpf(force) ** mpf("0.9")))))
                expected = hertz(None, m | {"load": most})
                for name in ("pressure", "half_width"):
                    verdict.right(
                        float(result[name][0]),
                        expected[name],
                        1e-12,
                        f"{name} at {force} N, {slices} slices",
                    )


def mirrored_study(subject, verdict):
    """Rings the other way round: the same bits."""
    there, back = (
        run(scene_for(subject, {"operation.inner_speed": speed}), subject.name.split()[0])
        for speed in (W, -W)
    )
    name = "friction" if "friction" in there else "effective_friction"
    np.testing.assert_array_equal(there[name], back[name])
    verdict.off(0.0, 0.0)


def study_in_threads(subject, verdict):
    """The same study at once in 1, 2 and 8 threads: the same bits in each."""
    scene = scene_for(subject, {})
    name = subject.name.split()[0]
    expected = run(scene, name)
    for threads in (1, 2, 8):
        with ThreadPoolExecutor(threads) as pool:
            for got in pool.map(lambda _: run(scene, name), range(threads)):
                assert got.equals(expected)  # NaN equals NaN, all else to the bit
    verdict.off(0.0, 0.0)


def several(judge, cases, **how):
    """Judge a study at several changes of its scene."""

    def run_all(subject, verdict):
        for changes in cases:
            given = force_on(subject, changes["force"]) if "force" in changes else {}
            judge(
                subject, verdict, given | {k: v for k, v in changes.items() if k != "force"}, **how
            )

    return run_all


def model_in_study(subject, verdict, study, forces):
    """A study with one model changed, from light to heavy load."""
    if study == "friction-curve":
        where = Subject("study", f"{study} inner")
        loads = [{"study.friction-curve.normal_force": list(forces)}]
    else:
        where = Subject("study", f"{study} epicyclic")
        loads = [{"operation.radial_load": force} for force in forces]
    for load in loads:
        chosen = {f"models.{subject.kind}": {"model": subject.name, **MADE.get(subject.name, {})}}
        judge_result(where, verdict, load | chosen, refused=BEYOND, check=False)


# The list ------------------------------------------------------------------------------------------------------------

FREE_ROLLER = STUDIES[-1:]  # finds the spin of every roller at every slip
NO_FORCE = dict.fromkeys(STUDIES[:2], "takes the normal force of its contact as given")
#: Error allowed 100 decades from one: the rounding of an exponent, 1.1e-16, times ln(1e100) = 230, some times over.
FAR = 2e-13
ENDS = (DENORMAL, 1e-310, 1e-300, 1e300, HUGE)
FILMS = (
    "blok",
    "dowson-1968",
    "dowson-higginson",
    "dowson-toyoda",
    "herrebrugh",
    "martin",
    "moes",
    "pan-hamrock",
)
#: How a key of a scene, or what comes of it, is refused.
UNFIT = (
    "must (be|have)|do not fit|only read for|below absolute zero|its data hold|has no meaning|no roller is loaded|"
    "is lost along|infinite at the ends|centrifugal force|no equilibrium|found no spin .*; take|raise accuracy"
)
#: Subject -> what is wrong where a product of inputs is a denormal on its way to a result that is none.
FAULTS = {
    "load": dict.fromkeys(
        ("iso16281", "lundberg", "palmgren"),
        "loads below 1e-293 N/m lose digits in w R/E', which is denormal",
    )
    | dict.fromkeys(
        set(FILMS) - {"blok", "martin", "moes"},
        "loads below 1e-298 N/m lose digits in W, which is denormal",
    ),
    "speed": dict.fromkeys(
        (*FILMS, "regime", "inlet-correction"),
        "speeds below 1e-296 m/s lose digits in U, which is denormal or zero",
    )
    | {"tabulated": "a slide-roll ratio past overflow warns before it is refused"},
}
CASES = [
    # slip 0, denormal, 1e300 and negative
    stage_case(
        "slip 0", "traction", rows({"sliding_speed": 0.0}, {"sliding_speed": -0.0}), "sliding_speed"
    ),
    stage_case(
        "slip denormal",
        "traction",
        rows(*({"sliding_speed": v} for v in (DENORMAL, 1e-320, -1e-310, TINY, 1e-300))),
        "sliding_speed",
    ),
    stage_case(
        "slip 1e300",
        "traction",
        rows({"sliding_speed": 1e300 * 29.8}, {"sliding_speed": -1e300}, {"sliding_speed": HUGE}),
        "sliding_speed",
        refused=f"{BEYOND}|is outside the table",
    ),
    stage_case(
        "slip negative",
        "traction",
        rows(*({"sliding_speed": -v} for v in (1e-6, 0.3, 3.0, 30.0))),
        "sliding_speed",
    ),
    # loads
    stage_case(
        "zero load",
        ("contact", "film", "viscosity", "traction"),
        rows(
            {"load": 0.0, "pressure": -0.0, "half_width": 0.0},
            {"load": -1.0, "pressure": -1.0, "half_width": -1.0},
        ),
        refused=OUTSIDE,
    ),
    stage_case(
        "surfaces apart",
        "deflection",
        rows({"approach": 0.0}, {"approach": -0.0}, {"approach": -1e-3}),
        "approach",
    ),
    stage_case("load of one newton", STAGES, [loaded(1.0)], refused=BEYOND),
    stage_case(
        "yield load, 4 GPa",
        STAGES,
        [loaded(YIELD)],
        refused="the oil is a glass|slice 0 is outside its domain$",
    ),
    stage_case(
        "load, pressure, approach and half width of 1e-100 and 1e100",
        STAGES,
        rows(
            *({"load": w, "approach": w, "pressure": w, "half_width": w} for w in (1e-100, 1e100))
        ),
        refused=BEYOND,
        allowed=FAR,
    ),
    stage_case(
        "load at the ends of floats",
        STAGES,
        rows(*({"load": w, "approach": w, "pressure": w, "half_width": w} for w in ENDS)),
        refused=BEYOND,
        faults=FAULTS["load"],
    ),
    # speeds
    stage_case(
        "zero speed",
        ("film", "traction"),
        rows({"rolling_speed": 0.0}),
        "rolling_speed",
        refused=OUTSIDE,
        must=True,
    ),
    stage_case(
        "reversed speed",
        ("film", "traction"),
        rows({"rolling_speed": -29.8}),
        "rolling_speed",
        refused=OUTSIDE,
        must=True,
    ),
    stage_case(
        "both surfaces at rest",
        ("film", "traction"),
        rows({"rolling_speed": 0.0, "sliding_speed": 0.0}),
        "rolling_speed",
        refused=OUTSIDE,
        must=True,
    ),
    stage_case(
        "counter-rotation, u = 0 and V > 0",
        "traction",
        rows(
            {"rolling_speed": 0.0, "sliding_speed": 5.0},
            {"rolling_speed": -0.0, "sliding_speed": 5.0},
        ),
        "rolling_speed",
        refused=OUTSIDE,
        must=True,
    ),
    stage_case(
        "speed of 1e-100 and 1e100 m/s",
        ("film", "traction"),
        rows({"rolling_speed": 1e-100}, {"rolling_speed": 1e100}),
        "rolling_speed",
        refused=f"{BEYOND}|is outside the table",
        allowed=FAR,
    ),
    stage_case(
        "speed at the ends of floats",
        ("film", "traction"),
        rows(*({"rolling_speed": u} for u in ENDS)),
        "rolling_speed",
        refused=f"{BEYOND}|is outside the table",
        faults=FAULTS["speed"],
    ),
    # groups
    stage_case(
        "sigma from 1e-300 to 1e12",
        "traction",
        [film(sigma) for sigma in SIGMAS],
        "sliding_speed",
        refused="is outside the table",
    ),
    stage_case(
        "D from 0 to 1e8",
        "traction",
        [film(sigma, deborah=d) for d in DEBORAHS for sigma in (1e-3, 10.0)],
        "shear_modulus",
    ),
    stage_case(
        "Phi from 0 to 1e6",
        "traction",
        [film(sigma, heating=phi) for phi in HEATINGS for sigma in (1e-3, 10.0)],
        "film_thermoviscosity",
    ),
    Case(
        name="sigma from 1e-300 to 1e12 with D from 0 to 1e8 and Phi from 0 to 1e6",
        kinds=("stress law",),
        judge=partial(
            judge_stress,
            points=[(s, d, p) for s in SIGMAS[::2] for d in DEBORAHS[::2] for p in HEATINGS[::2]],
        ),
    ),
    Case(
        name="the same on a finer grid",
        kinds=("stress law",),
        judge=partial(
            judge_stress, points=[(s, d, p) for s in SIGMAS for d in DEBORAHS for p in HEATINGS]
        ),
        slow=True,
    ),
    Case(
        name="sigma 0, denormal and 1e300",
        kinds=("stress law",),
        judge=partial(
            judge_stress,
            points=[
                (s, d, p)
                for s in (0.0, DENORMAL, 1e-310, 1e300)
                for d in (0.0, 1.0, 1e8)
                for p in (0.0, 1.0, 1e6)
            ],
        ),
    ),
    Case(name="NaN in a stress law", kinds=("stress law",), judge=stress_of_no_number),
    # pressure
    stage_case(
        "alpha p from 0 to 60",
        "viscosity",
        rows(*({"pressure": x / 9.18e-9} for x in (0.0, 1e-300, 1e-9, 1.0, 3.0, 31.0, 60.0))),
        refused="the oil is a glass|outside its domain$",
    ),
    stage_case(
        "alpha p past overflow",
        "viscosity",
        rows(*({"pressure": x / 9.18e-9} for x in (709.0, 715.0, 1e4, 1e300))),
        refused=f"{NOT_FINITE}|the oil is a glass|outside its domain$",
    ),
    stage_case(
        "film viscosity of alpha p = 60 and 600",
        "traction",
        rows(*({"film_viscosity": 5.17e-3 * math.exp(x)} for x in (60, 600))),
        "film_viscosity",
        refused=BEYOND,
    ),
    stage_case(
        "film viscosity of alpha p = 709",
        "traction",
        rows({"film_viscosity": 5.17e-3 * math.exp(709)}),
        "film_viscosity",
        refused=BEYOND,
    ),
    stage_case(
        "oil beside and below the pole of Roelands's law",
        "viscosity",
        rows({"viscosity": 6.4e-5}, {"viscosity": 6.32e-5}, {"viscosity": 6.3e-5}),
        "pressure_viscosity",
        refused=BEYOND,
    ),
    # film
    Case(
        name="film at the Barus blow-up, g_V = 17.602, and beyond",
        kinds=("film",),
        judge=piezoviscous_blow_up,
    ),
    Case(name="film at the boundaries of the regimes", kinds=("film",), judge=regime_boundaries),
    stage_case(
        "oil without pressure viscosity",
        ("film", "viscosity"),
        rows({"pressure_viscosity": 0.0}),
        "pressure_viscosity",
        refused=OUTSIDE,
    ),
    # Lambda
    Case(
        name="Lambda at a limit of the blend and a rounding error beside it",
        kinds=("traction",),
        judge=at_thresholds,
        needs=frozenset({"roughness"}),
    ),
    stage_case(
        "Lambda 1e-300 and 1e300",
        "traction",
        rows({"roughness": 6e293}, {"roughness": 6e-307}),
        "roughness",
    ),
    # NaN and infinity
    Case(name="NaN or infinity in any member", kinds=STAGES, judge=not_a_number),
    # tables
    Case(name="0, 1, 2 slices, and a block's size", kinds=STAGES, judge=coarse_slices),
    Case(name="1, 2 and 8 threads", kinds=STAGES, judge=split_over_threads),
    Case(
        name="10 million slices, and memory over calls",
        kinds=STAGES,
        judge=ten_million_slices,
        slow=True,
        large=True,
    ),
    # the bearing
    Case(name="clearance that leaves one roller", kinds=("deflection",), judge=one_roller),
    Case(
        name="zero load, and clearance that leaves no roller", kinds=("deflection",), judge=unloaded
    ),
    Case(
        name="preload that loads all rollers",
        kinds=("deflection",),
        judge=partial(straight, cases=[{"radial_clearance": -3e-5}], allowed=1e-11),
    ),
    Case(
        name="straight rollers cut into 1, 2 and 2001 slices",
        kinds=("deflection",),
        judge=partial(
            straight, cases=[{"slices": 1}, {"slices": 2}, {"slices": 2001}], allowed=1e-11
        ),
    ),
    Case(
        name="bearing under one newton and at yield",
        kinds=("deflection",),
        judge=partial(
            straight, cases=[{"radial_load": 1.0}, {"radial_load": YIELD * 6}], allowed=1e-11
        ),
    ),
    Case(
        name="one newton beside a centrifugal force of 174 N",
        kinds=("deflection",),
        judge=partial(
            straight, cases=[{"radial_load": 1.0, "centrifugal_force": 174.0}], allowed=1e-9
        ),
    ),
    Case(
        name="edge loading with no crown",
        kinds=("deflection",),
        judge=partial(tilted, tilts=(1e-5, -1e-5), least=0),
    ),
    Case(
        name="tilt that unloads half a roller",
        kinds=("deflection",),
        judge=partial(tilted, tilts=(7e-3, -1e-2), least=10),
    ),
    Case(name="loads that no contact bears", kinds=("deflection",), judge=crushed),
    Case(name="NaN or infinity in a load case", kinds=("load case",), judge=unfit_load_case),
    Case(
        name="slips 0, denormal, negative, 1",
        kinds=("kinematics",),
        judge=partial(
            speeds,
            pairs=[(W, 0.0), (0.0, W), (W, -W), (-W, 0.5 * W)],
            slips=[
                (0.0, 0.0),
                (DENORMAL, 0.0),
                (1e-300, 1e-300),
                (1e-9, 3e-9),
                (0.1, -0.05),
                (1.0, 0.0),
            ],
        ),
    ),
    Case(
        name="rings that turn almost together",
        kinds=("kinematics",),
        judge=partial(
            speeds,
            pairs=[(W, math.nextafter(W, 0.0)), (W, 0.999 * W)],
            slips=[(0.0, 0.0), (1e-20, 0.0), (1e-9, 1e-9)],
        ),
    ),
    Case(
        name="counter-rotation, no epicyclic cage speed",
        kinds=("kinematics",),
        judge=counter_rotation,
    ),
    Case(name="reversed rotation", kinds=("kinematics",), judge=mirrored_rotation),
    Case(
        name="both rings at rest, or at NaN or infinity",
        kinds=("kinematics",),
        judge=unfit_kinematics,
    ),
    Case(
        name="profile at the end of the roller, up to 10 million slices",
        kinds=("roller profile",),
        judge=profiles,
    ),
    # the curve
    Case(
        name="two equal maxima, denormal friction, tiny and huge range",
        kinds=("critical slip",),
        judge=maxima,
    ),
    Case(
        name="no maximum: no friction",
        kinds=("critical slip",),
        judge=partial(no_maximum, values=[0.0] * 6),
    ),
    Case(
        name="no maximum: a curve that only rises",
        kinds=("critical slip",),
        judge=partial(no_maximum, values=[0.0, 1.0, 2.0, 3.0, 4.0]),
    ),
    Case(
        name="no maximum: a flat curve",
        kinds=("critical slip",),
        judge=partial(no_maximum, values=[1.0] * 6),
    ),
    Case(
        name="no maximum: flat from somewhere on",
        kinds=("critical slip",),
        judge=partial(no_maximum, values=[0.0, 1.0, 1.0, 1.0]),
    ),
    Case(name="NaN or infinity in a curve", kinds=("critical slip",), judge=curve_of_no_number),
    # studies
    Case(
        name="study at zero load",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"force": 0.0}],
            refused="no roller is loaded on the inner ring .* raise operation.radial_load|must be above 0",
            must=True,
        ),
    ),
    Case(
        name="study at one newton",
        kinds=("study",),
        slow=FREE_ROLLER,
        judge=several(judge_result, [{"force": 1.0}]),
    ),
    Case(
        name="study at yield load",
        kinds=("study",),
        judge=several(judge_result, [{"force": YIELD}]),
    ),
    Case(
        name="study under a load of 1e-300 N",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"force": 1e-300}, {"force": 1e-300, "bearing.profile": "iso16281"}],
            refused=f"no roller is loaded|are lost beside those|{BEYOND}",
            check=False,
        ),
    ),
    Case(
        name="study under loads past overflow",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"force": 1e12}, {"force": 1e300}, {"force": 1e300, "bearing.profile": "iso16281"}],
            refused=f"no equilibrium .*; (check|lower)|{BEYOND}",
            must=True,
        ),
    ),
    Case(
        name="normal force under a crown, to its last digits",
        kinds=("study",),
        judge=crowned,
        left_out=dict.fromkeys(STUDIES[2:], "its loads come from the load distribution"),
    ),
    Case(
        name="study with both rings at rest",
        kinds=("study",),
        judge=several(
            judge_result, [{"operation.inner_speed": 0.0}], refused="both rings turn at", must=True
        ),
    ),
    Case(name="study in 1, 2 and 8 threads", kinds=("study",), slow=True, judge=study_in_threads),
    Case(
        name="study in reversed rotation", kinds=("study",), slow=FREE_ROLLER, judge=mirrored_study
    ),
    Case(
        name="study at an epicyclic cage speed of zero",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"operation.inner_speed": W, "operation.outer_speed": -W * 165 / 195}],
            refused="cage slip, which is relative to it, has no meaning",
        ),
    ),
    Case(
        name="study of rings that turn almost together",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"operation.inner_speed": W, "operation.outer_speed": 0.999 * W}],
            refused=".max_cage_slip",
        ),
    ),
    Case(
        name="study at speeds past overflow",
        kinds=("study",),
        judge=several(
            judge_result,
            [{"operation.inner_speed": w} for w in (1e100, 1e150, 1e300)],
            refused=f"{BEYOND}|centrifugal force|no equilibrium",
            check=False,
        ),
    ),
    Case(
        name="clearance that leaves one, no or all rollers",
        kinds=("study",),
        slow=FREE_ROLLER,
        left_out=NO_FORCE,
        judge=several(
            judge_result,
            [
                {"bearing.radial_clearance": 2e-3},
                {"bearing.radial_clearance": -3e-5},
                {"bearing.radial_clearance": 2e-5, "operation.radial_load": 0.0},
                {"bearing.radial_clearance": -3e-5, "operation.radial_load": 0.0},
            ],
            refused="no roller is loaded",
        ),
    ),
    Case(
        name="edge loading, and a tilt that unloads half a roller",
        kinds=("study",),
        slow=FREE_ROLLER,
        left_out=NO_FORCE,
        judge=several(
            judge_result,
            [{"operation.misalignment": 1e-3}, {"operation.misalignment": 5e-3}],
            check=False,
        ),
    ),
    Case(
        name="friction that only rises, and flat friction",
        kinds=("study",),
        slow=FREE_ROLLER,
        judge=several(
            judge_result,
            [
                {"models.traction": {"model": "constant"}},
                {"models.traction": {"model": "constant", "transition": 10.0}},
            ],
        ),
    ),
    Case(
        name="friction that rises within the rounding of the speeds",
        kinds=("study",),
        slow=FREE_ROLLER,
        judge=several(
            judge_result,
            [{"models.traction": {"model": "constant", "transition": 1e-18}}],
            refused="found no spin .*; take closure",
            check=False,
        ),
    ),
    Case(
        name="tolerance that cannot be met",
        kinds=("study",),
        left_out=NO_FORCE,
        slow=True,
        judge=several(
            judge_result,
            [{"accuracy.tolerance": 1e-300}],
            refused="raise accuracy.tolerance",
            must=True,
        ),
    ),
    Case(
        name="NaN or infinity in any key of a scene",
        kinds=("study",),
        judge=partial(
            any_key,
            values=(math.nan, math.inf, -math.inf),
            refused=r"[a-z]+\.[a-z_]+(\[0\])?: ",
            must=True,
        ),
    ),
    Case(
        name="1e300, -1e300 and 5e-324 in any key of a scene",
        kinds=("study",),
        slow=True,
        left_out={STUDIES[-1]: "takes minutes over keys that the other closures read as well"},
        judge=partial(
            any_key,
            values=(1e300, -1e300, DENORMAL),
            refused=f"{UNFIT}|{BEYOND}",
        ),
    ),
    Case(
        name="friction curve with the model, at one newton, 518 N and yield",
        kinds=("contact", "film", "traction"),
        judge=partial(model_in_study, study="friction-curve", forces=(1.0, 518.0, YIELD)),
    ),
    Case(
        name="effective friction with the model, at one newton, 3415 N and yield",
        kinds=("contact", "film", "traction"),
        slow=True,
        large=True,
        judge=partial(model_in_study, study="effective-friction", forces=(1.0, FORCE, YIELD)),
    ),
]


# Lost digits ---------------------------------------------------------------------------------------------------------


@attrs.frozen(kw_only=True)
class Loss:
    """A formula that loses digits, or would: its condition number, and what its plain form and the program make of it.

    ``condition`` is |x/f df/dx| of the formula in the input, or the intermediate number, that the entry is about.
    """

    formula: str
    where: str
    condition: float
    plain: float | None
    error: float
    #: what the program is held to, as a multiple of 1.1e-16: its own roundings, and the condition where it is inherent
    allowed: float


def off(got, expected):
    with mp.workdps(DIGITS):
        return float(abs(mpf(float(got)) / expected - 1))


def worst(errors):
    return max(errors)


def lost_in_barus():
    law = Barus()
    found = []
    m = Conditions(
        viscosity=0.00517,
        pressure_viscosity=9.18e-9,
        thermoviscosity=0.0,
        pressure_thermoviscosity=0.0,
    )
    for p in np.linspace(59.0, 61.0, 500) / 9.18e-9:
        expected = exact("barus", law, attrs.asdict(m) | {"pressure": p})["film_viscosity"]
        found.append(off(law.at(m, p)[0], expected))
    return Loss(
        formula="eta0 exp(alpha p)",
        where="alpha p = 60",
        condition=60.0,
        plain=worst(found),
        error=worst(found),
        allowed=60 + 4,
    )


def lost_in_roelands(m, column, formula, where):
    """Lose digits in one of the law's two results, the viscosity and the rate of its fall with temperature."""
    (law,) = (subject.model for subject in subjects() if subject.name == "roelands")
    kappa = condition_of(
        lambda x: exact("roelands", law, m | x)[column], {"viscosity": m["viscosity"]}
    )
    got = law.at(
        Conditions(**{name: value for name, value in m.items() if name != "pressure"}),
        m["pressure"],
    )
    of = ("film_viscosity", "film_thermoviscosity").index(column)
    error = off(got[of], exact("roelands", law, m)[column])
    return Loss(
        formula=formula, where=where, condition=kappa, plain=error, error=error, allowed=10 * kappa
    )


def lost_in_thin_oil():
    m = {
        "viscosity": 6.4e-5,
        "pressure_viscosity": 9.18e-9,
        "pressure": 1e7,
        "thermoviscosity": 0.0227,
    }
    m |= {"pressure_thermoviscosity": 6.6e-11}
    formula = "eta0 exp{k [(1 + p/p0)^z - 1]}, k = ln(eta0/6.315e-5)"
    return lost_in_roelands(m, "film_viscosity", formula, "eta0 = 6.4e-5 Pa s, k = 0.013, 10 MPa")


def lost_in_roelands_fall():
    m = {"viscosity": 5.17e-3, "pressure_viscosity": 9.18e-9, "thermoviscosity": 0.0227}
    m |= {"pressure_thermoviscosity": 0.0}
    k = math.log(m["viscosity"]) + 9.67
    m["pressure"] = math.expm1(k / (m["pressure_viscosity"] / 5.1e-9) * (1 - 1e-6)) / 5.1e-9
    formula = "its -dln(eta)/dT, a difference"
    return lost_in_roelands(m, "film_thermoviscosity", formula, "gamma = 0, beside its zero")


def lost_in_muraki(sigma, deborah, heating, where):
    L = math.asinh(sigma)
    a = 1 + heating * sigma
    root = math.sqrt(a * a - deborah * heating * L)
    plain = (deborah * heating * L - 2 * a + 2 * root) / (deborah * heating * heating * sigma)
    with mp.workdps(DIGITS):
        expected = exact_muraki(*map(mpf, (sigma, deborah, heating)))
        terms = mpf(2) * mpf(a) / (mpf(deborah) * mpf(heating) ** 2 * mpf(sigma))
    return Loss(
        formula="Muraki, {D Phi L - 2 a + 2 sqrt(a^2 - D Phi L)}/(D Phi^2 sigma)",
        where=where,
        condition=float(terms / expected),
        plain=off(plain, expected),
        error=off(compiled_stress.muraki(sigma, deborah, heating), expected),
        allowed=20,
    )


def lost_in_muraki_root():
    """Beside the switch to the elastic ramp a^2 - D Phi L is 1 of a^2."""
    sigma = 1e6
    heating = 1.0
    deborah = sigma * (2 + heating * sigma) / math.asinh(sigma) * (1 - 1e-9)
    a = 1 + heating * sigma
    with mp.workdps(DIGITS):
        discriminant = mpf(a) ** 2 - mpf(deborah) * mpf(heating) * mp.asinh(sigma)
        expected = exact_muraki(*map(mpf, (sigma, deborah, heating)))
        kappa = float(mpf(a) ** 2 / discriminant)
    y = (
        2
        * math.asinh(sigma)
        / (a + math.sqrt(max(a * a - deborah * heating * math.asinh(sigma), 0.0)))
    )
    return Loss(
        formula="Muraki, a^2 - D Phi L",
        where="beside the switch to the ramp, Phi sigma = 1e6",
        condition=kappa,
        plain=off(y - deborah * y * y / (4 * sigma), expected),
        error=off(compiled_stress.muraki(sigma, deborah, heating), expected),
        allowed=20,
    )


def lost_in_dilogarithms():
    from scipy.special import spence

    sigma = 0.1
    deborah = 1e4
    c = math.hypot(1, sigma)
    p = 2 * c / deborah
    t = sigma / (1 + c)
    a = t / (sigma + c)
    b = t * (sigma + c)
    q = math.exp(-p)
    bracket = spence(1 - a) - spence(1 - a * q) - spence(1 + b) + spence(1 + b * q)
    with mp.workdps(DIGITS):
        expected = exact_maxwell_eyring(mpf(sigma), mpf(deborah), mpf(0))
        kappa = float(mp.asinh(sigma) / expected)
    return Loss(
        formula="Maxwell-Eyring, asinh(eps) - [Li2(A) - Li2(A q) - Li2(-B) + Li2(-B q)]/P",
        where="nearly elastic, sigma = 0.1, D = 1e4, P = 2e-4",
        condition=kappa,
        plain=off(math.asinh(sigma) - bracket / p, expected),
        error=off(compiled_stress.maxwell_eyring(sigma, deborah, 0.0), expected),
        allowed=20,
    )


def lost_in_kragelsky():
    s = 1e-10
    (law,) = (subject.model for subject in subjects() if subject.name == "kragelsky")
    expected = exact("kragelsky", law, {"sliding_speed": s, "rolling_speed": 1.0})["friction"]
    return Loss(
        formula="Kragelsky, (-A + B s) exp(-C s) + A",
        where="s = 1e-10, near pure rolling",
        condition=float(mpf("0.1") / expected),
        plain=off((-0.1 + 22.28 * s) * math.exp(-181.46 * s) + 0.1, expected),
        error=off(law.friction(s), expected),
        allowed=20,
    )


def lost_in_sliding_speed():
    k = kinematics()
    slip = 1e-9
    wc = k.epicyclic_cage_speed * (1 - slip)
    plain = k.inner_radius * (k.inner_speed - wc) - k.roller_radius * k.epicyclic_roller_speed
    with mp.workdps(DIGITS):
        exact = exact_speeds(k, slip, 0.0)
        kappa = float(
            (exact["inner_rolling"] + exact["inner_sliding"] / 2) / exact["inner_sliding"]
        )
    return Loss(
        formula="V_i = R_i (w_i - w_c) - r w_r",
        where="cage slip 1e-9, near pure rolling",
        condition=kappa,
        plain=off(plain, exact["inner_sliding"]),
        error=off(k.surface_speeds(slip, 0.0).inner_sliding, exact["inner_sliding"]),
        allowed=20,
    )


def lost_in_epicyclic_speed():
    found = []
    kappa = 0.0
    for nudge in np.linspace(0.9e-9, 1.1e-9, 50):
        k = kinematics(W, -W * 0.0825 / 0.0975 * (1 + nudge))
        with mp.workdps(DIGITS):
            inner = mpf(0.0825) * mpf(W)
            outer = mpf(0.0975) * mpf(k.outer_speed)
            found.append(
                off(
                    k.direction * k.epicyclic_cage_speed,
                    (inner + outer) / (mpf(0.0825) + mpf(0.0975)),
                )
            )
            kappa = max(kappa, float(abs(inner / (inner + outer))))
    return Loss(
        formula="w_ce = (R_i w_i + R_o w_o)/(R_i + R_o)",
        where="rings against each other, 1e-9 from w_ce = 0",
        condition=kappa,
        plain=worst(found),
        error=worst(found),
        allowed=4 * kappa,
    )


def lost_in_crown():
    radius = 5.0
    x = 0.007
    with mp.workdps(DIGITS):
        expected = mpf(radius) - mp.sqrt(mpf(radius) ** 2 - mpf(x) ** 2)
        kappa = float(radius / expected)
    return Loss(
        formula="crown, R - sqrt(R^2 - x^2)",
        where="R = 5 m, x = 7 mm",
        condition=kappa,
        plain=off(radius - math.sqrt(radius**2 - x**2), expected),
        error=off(profile_of("circular", x, radius=radius), expected),
        allowed=20,
    )


def lost_in_logarithmic_profile():
    x = float(slice_positions(LENGTH, 10_000_001)[-1])
    with mp.workdps(DIGITS):
        fraction = mpf(x) / (mpf(LENGTH) / 2)
        expected = -mpf("0.00035") * mpf("0.015") * mp.log(1 - fraction**2)
        kappa = float(abs(2 * fraction**2 / (1 - fraction**2) / mp.log(1 - fraction**2)))
    got = off(profile_of("iso16281", x), expected)
    return Loss(
        formula="logarithmic profile, ln(1 - (2 x/L)^2)",
        where="last of ten million slices",
        condition=kappa,
        plain=got,
        error=got,
        allowed=4 * kappa,
    )


def lost_in_touch():
    """The crown's drop at ten slices is 0.05 um, the depth of 1e-9 N is 1e-17 m."""
    drop = profile_of("iso16281", slice_positions(LENGTH, 10))
    force = 1e-9
    depth = 3.84e-8 * (5 * force) ** 0.9 / 15**0.8
    scene = scene_for(
        Subject("study", "friction-curve inner"),
        {
            "bearing.profile": "iso16281",
            "accuracy.slices": 10,
            "study.friction-curve.normal_force": [force],
        },
    )
    result = run(scene, "friction-curve")
    with mp.workdps(DIGITS):
        m = {
            "length": mpf(LENGTH),
            "radius": mpf(INNER),
            "modulus": mpf(assemble(scene).inner.conditions.modulus),
        }
        m["radius"] = mpf(assemble(scene).inner.conditions.radius)
        expected = hertz(None, m | {"load": mpf(force) / (mpf(LENGTH) / 5)})[
            "pressure"
        ]  # the two in the middle
        approach = float(drop.min()) + depth
        plain = float(
            abs((mpf(approach) - mpf(float(drop.min()))) / mpf(depth) - 1) * mpf("10") / 18
        )
    return Loss(
        formula="depth of a contact, approach - P(x)",
        where="1e-9 N on a crowned roller, ten slices",
        condition=float(drop.min() / depth),
        plain=plain,
        error=off(result.pressure[0], expected),
        allowed=100,
    )


def lost_beside_centrifugal_force():
    (subject,) = (subject for subject in subjects() if subject.name == "palmgren deflection")
    case = load_case(radial_load=1e-3, centrifugal_force=174.0)
    solved = solve_equilibrium(case, bearing_law(subject))
    with mp.workdps(DIGITS):
        expected = exact_straight(subject, case)
        error = max(
            float(abs(mpf(q) - e) / max(expected))
            for q, e in zip(solved.inner_force[0], expected, strict=False)
        )
    return Loss(
        formula="inner force, outer force less F_c",
        where="F_r = 1 mN beside F_c = 174 N",
        condition=174.0 / float(max(expected)),
        plain=None,
        error=error,
        allowed=1e4
        * 174.0
        / float(max(expected)),  # balanced to 1e-12 of the largest force, not to its last bit
    )


def lost_at_a_maximum():
    slip = np.linspace(0.0, 4.1, 41)
    found = find_critical_slip(
        lambda s: s * math.exp(1 - s), slip, slip * np.exp(1 - slip), "max_slip"
    )
    return Loss(
        formula="critical slip, the place of a flat maximum",
        where="s exp(1 - s), maximum at s = 1",
        condition=math.sqrt(2 / EPS),  # a change of EPS in the curve moves the place by sqrt(2 EPS)
        plain=None,
        error=abs(found.slip - 1),
        allowed=10 * math.sqrt(2 / EPS),
    )


def lost_in_blend():
    """The share of the boundary is ((Lambda_hd - Lambda)/band)^6; it loses digits as it vanishes, the friction none."""
    (model,) = (subject.model for subject in subjects() if subject.name == "lambda-blend")
    ratio = model.hydrodynamic_limit * (1 - 1e-6)
    row = {name: BASE[name] for name in model.reads} | {
        "roughness": 2.36e-7,
        "film_thickness": ratio * 2.36e-7,
    }
    ratio = row["film_thickness"] / row["roughness"]
    fraction = (
        (model.hydrodynamic_limit - ratio) / (model.hydrodynamic_limit - model.boundary_limit)
    ) ** model.exponent
    with mp.workdps(DIGITS):
        high = mpf(model.hydrodynamic_limit)
        low = mpf(model.boundary_limit)
        at = mpf(row["film_thickness"]) / mpf(row["roughness"])
        plain = off(fraction, ((high - at) / (high - low)) ** mpf(model.exponent))
    return Loss(
        formula="share of the boundary, ((Lambda_hd - Lambda)/(Lambda_hd - Lambda_bd))^6",
        where="Lambda 1e-6 below Lambda_hd",
        condition=model.exponent * 1e6,
        plain=plain,
        error=off(
            answer(Chain(model), BASE | row)["friction"],
            exact("lambda-blend", model, row)["friction"],
        ),
        allowed=100,
    )


def lost_in_chain(force):
    """Friction of a contact through all stages, in the pressure-viscosity coefficient."""
    scene = scene_for(
        Subject("study", "friction-curve inner"),
        {
            "study.friction-curve.normal_force": [force],
            "models.traction": "maxwell-eyring",
            "accuracy.tolerance": "exact",  # else a plan may take a series of its tolerance
        },
    )
    result = run(scene, "friction-curve")
    assembly = assemble(scene)
    conditions = assembly.inner.conditions
    with mp.workdps(DIGITS):
        u = exact_speeds_of(assembly, 0.0, mpf(0))["inner_rolling"]
        slip = mpf(float(result.slip[1]))

        def friction(m):
            changed = attrs.evolve(assembly.inner, conditions=attrs.evolve(conditions, **m))
            return exact_contact(
                attrs.evolve(assembly, inner=changed),
                "inner",
                mpf(force) / mpf(LENGTH),
                u,
                slip * u,
            )

        kappa = condition_of(friction, {"pressure_viscosity": conditions.pressure_viscosity})
        error = off(result.friction[0, 1], friction({}))
    alpha_p = conditions.pressure_viscosity * float(result.pressure[0])
    return Loss(
        formula="friction of a contact, in alpha",
        where=f"slip {float(slip):.2g}, alpha p = {alpha_p:.2g}",
        condition=kappa,
        plain=None,
        error=error,
        allowed=20 * (1 + kappa) + 4 * alpha_p,
    )


#: One entry each, made when asked for.
LOSSES = (
    lost_in_barus,
    partial(lost_in_chain, 300.0),
    partial(lost_in_chain, YIELD),
    lost_in_thin_oil,
    lost_in_roelands_fall,
    partial(lost_in_muraki, 1.0, 1e-3, 0.1, "paper's bearing, sigma = 1, D = 1e-3, Phi = 0.1"),
    lost_in_muraki_root,
    lost_in_dilogarithms,
    lost_in_blend,
    lost_in_kragelsky,
    lost_in_sliding_speed,
    lost_in_epicyclic_speed,
    lost_in_crown,
    lost_in_logarithmic_profile,
    lost_in_touch,
    lost_beside_centrifugal_force,
    lost_at_a_maximum,
)
