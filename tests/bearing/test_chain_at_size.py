"""Chains on bound, replaced and large tables: lifetime, threads, growth of memory, and the error of the whole chain."""

import gc
import os
import subprocess
import sys
import threading
import tracemalloc

import attrs
import mpmath
import numpy as np
import pytest

import fifty_digits
from chain_samples import BEARING, OwnError, run_together
from foreign_stages import Stage, foreign_capsule
from rollslip import Chain, Slices, engine
from rollslip.bearing import chain as chain_module
from rollslip.errors import DomainError, PluginError, RollslipError
from rollslip_kernels.slices import COLUMNS
from rollslip_kernels.stages import simd
from rollslip_plugins.contact import Palmgren
from rollslip_plugins.film.formulas import Moes
from rollslip_plugins.pressure_viscosity import Barus
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.boundary import Kragelsky
from rollslip_plugins.traction.eyring import Muraki

PAPER = (Palmgren(), Moes(), Barus(), LambdaBlend(boundary=Kragelsky(), hydrodynamic=Muraki()))
PART = chain_module._PART
LARGE = chain_module._LARGE


def contacts(n, conditions=BEARING):
    """Loaded contacts whose films cross both limits of the blend."""
    at = np.linspace(0.0, 1.0, n)
    return Slices(
        n,
        conditions,
        load=1e4 + 3e4 * at,
        rolling_speed=10.0 ** (-4 + 6 * np.sin(9 * at) ** 2),
        sliding_speed=3 * np.sin(7 * at),
    )


def same(one, other):
    for name in COLUMNS:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


# Tables --------------------------------------------------------------------------------------------------------------


def test_a_column_that_is_assigned_is_filled_and_not_replaced():
    slices = Slices(3, BEARING, load=1.0)
    view = slices.load
    slices.load = [1e4, 2e4, 3e4]
    assert slices.load is view
    Chain(Palmgren())(slices)
    expected = Slices(3, BEARING, load=[1e4, 2e4, 3e4])
    Chain(Palmgren())(expected)
    same(slices, expected)
    with pytest.raises(ValueError, match="broadcast"):
        slices.load = [1.0, 2.0]
    with pytest.raises(AttributeError, match="freezing"):
        slices.freezing  # noqa: B018
    with pytest.raises(AttributeError, match="freezing"):
        slices.freezing = 1.0


def test_all_columns_of_a_new_table_are_its_own_rows():
    slices = Slices(2, BEARING)
    for row, name in enumerate(COLUMNS):
        assert np.isnan(getattr(slices, name)).all()
        getattr(slices, name)[:] = row
    np.testing.assert_array_equal(slices._table, np.repeat(np.arange(13.0)[:, None], 2, axis=1))
    view = Slices.of_columns(BEARING, {"load": np.ones((2, 3))})
    assert not hasattr(view, "friction")
    with pytest.raises(AttributeError, match="friction"):
        view.friction = 1.0


# Bound ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [0, 1, 16, 300, LARGE])
def test_a_bound_chain_gives_what_the_chain_gives(n):
    chain = Chain(*PAPER)
    slices = contacts(n)
    expected = contacts(n)
    evaluate = chain.bind(slices)
    for load in (1e4, 2e4):
        slices.load = load
        expected.load = load
        evaluate()
        chain(expected)
        same(slices, expected)
    assert chain.evaluated == 4 * n


def test_a_bound_chain_keeps_its_table_and_its_models():
    seen = []
    stage = Stage(lambda part: seen.append(part.load.tolist()), writes=frozenset())
    evaluate = Chain(stage).bind(Slices(2, BEARING, load=[1.0, 2.0]))
    del stage
    gc.collect()
    np.full((13, 2), -1.0)  # would be laid where a freed table was
    evaluate()
    assert seen == [[1.0, 2.0]]


def test_a_bound_chain_sees_replaced_conditions_and_columns():
    slices = contacts(20)
    hot = attrs.evolve(BEARING, viscosity=2e-3)
    evaluate = Chain(*PAPER).bind(slices)
    evaluate()
    slices.conditions = hot
    slices.sliding_speed = 0.5
    evaluate()
    expected = contacts(20, hot)
    expected.sliding_speed = 0.5
    Chain(*PAPER)(expected)
    same(slices, expected)
    slices.conditions = attrs.evolve(BEARING, viscosity=np.nan)
    for _ in range(2):
        with pytest.raises(DomainError, match="moes: needs viscosity"):
            evaluate()
    slices.conditions = hot
    evaluate()


def test_a_bound_chain_refuses_as_the_chain_does():
    chain = Chain(*PAPER)
    slices = contacts(300)
    evaluate = chain.bind(slices)
    slices.load[290] = -1.0
    slices.sliding_speed[280] = np.nan
    with pytest.raises(DomainError) as bound:
        evaluate()
    with pytest.raises(DomainError) as plain:
        chain(slices)
    assert (
        str(bound.value)
        == str(plain.value)
        == "palmgren: load = -1 N/m at slice 290 is outside its domain (> 0)"
    )
    failing = Chain(Stage(lambda part: (_ for _ in ()).throw(OwnError("mine")))).bind(slices)
    with pytest.raises(OwnError, match="mine"):
        failing()
    with pytest.raises(PluginError, match="returned a status that"):
        Chain(Stage(capsule=foreign_capsule(lambda part: -7))).bind(slices)()


def test_a_stage_may_call_the_bound_chain_it_belongs_to():
    depth = []

    def again(part):
        if len(depth) < 3:
            depth.append(len(part.load))
            evaluate()
        part.friction[...] = part.load

    slices = contacts(5)
    evaluate = Chain(Stage(again)).bind(slices)
    evaluate()
    assert depth == [5, 5, 5]
    np.testing.assert_array_equal(slices.friction, slices.load)


def test_bound_calls_from_threads_see_whole_conditions():
    """One thread replaces the conditions while eight call: every film is that of one of them, in every slice."""
    slices = Slices(64, BEARING, load=2e4, rolling_speed=20.0)
    evaluate = Chain(Moes()).bind(slices)
    films = set()
    thin = attrs.evolve(BEARING, viscosity=1e-3)
    known = set()
    for conditions in (BEARING, thin):
        slices.conditions = conditions
        evaluate()
        known.add(float(slices.film_thickness[0]))

    def task(k):
        for turn in range(300):
            if k == 0:
                slices.conditions = (BEARING, thin)[turn % 2]
            else:
                evaluate()
                films.add(float(slices.film_thickness[turn % 64]))

    assert run_together(task) == [None] * 8
    assert films <= known


@pytest.mark.parametrize("member", ["load", "rolling_speed", "sliding_speed"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -1.0, 0.0, -0.0, 5e-324, 1e200])
def test_the_refusal_is_that_of_stages_one_by_one(member, value):
    """Checks of several stages are made at once; a table that they stop is gone through one stage at a time."""
    slices = contacts(300)
    steps = contacts(300)
    for table in (slices, steps):
        getattr(table, member)[270] = value

    def outcome(*chains):
        try:
            for chain in chains:
                chain(slices if len(chains) == 1 else steps)
        except RollslipError as error:
            return str(error)
        return "done"

    whole = outcome(Chain(*PAPER))
    # one stage a block of its own table: the first stage refuses before the second has seen any block
    assert whole == outcome(*[Chain(model) for model in PAPER])
    if whole == "done":
        same(slices, steps)


# Threads -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 8])
@pytest.mark.parametrize("n", [LARGE - 1, LARGE, LARGE + 77, 4 * LARGE + 1])
def test_the_number_of_threads_changes_no_bit(count, n):
    one = contacts(n)
    shared = contacts(n)
    Chain(*PAPER, threads=1)(one)
    chain = Chain(*PAPER, threads=count)
    chain(shared)
    same(one, shared)
    assert chain.evaluated == n


@pytest.mark.parametrize("count", [1, 2, 3, 8])
@pytest.mark.parametrize(
    "places", [(0,), (PART,), (3 * PART - 1, 5 * PART + 3), (6 * PART + 4, 7 * PART)]
)
def test_the_first_refused_slice_is_named_whatever_the_threads(count, places):
    slices = contacts(8 * PART + 5)
    for place in places:
        slices.rolling_speed[place] = -1.0
    with pytest.raises(
        DomainError, match=rf"^moes: rolling_speed = -1 m/s at slice {places[0]} is outside"
    ):
        Chain(*PAPER, threads=count)(slices)
    slices = contacts(8 * PART + 5)
    slices.regime = 0.0
    slices.regime[list(places)] = 7.0

    def evaluate(part):
        bad = [i for i in range(part.n) if part.regime[i] == 7.0]
        return bad[0] + 1 if bad else 0

    with pytest.raises(
        DomainError, match=rf"^made-in-a-test: slice {places[0]} is outside its domain$"
    ):
        Chain(Stage(capsule=foreign_capsule(evaluate), writes=frozenset()), threads=count)(slices)


def test_a_condition_is_refused_before_any_thread_writes():
    slices = contacts(2 * LARGE, attrs.evolve(BEARING, viscosity=np.nan))
    with pytest.raises(DomainError, match="moes: needs viscosity"):
        Chain(*PAPER, threads=4)(slices)
    assert np.isnan(slices.half_width).all()


@pytest.mark.parametrize(
    "wrap", [lambda s: s, lambda s: LambdaBlend(boundary=s)], ids=["stage", "child of a blend"]
)
def test_python_stages_run_in_the_thread_that_calls(wrap):
    threads = set()

    def evaluate(part):
        threads.add(threading.get_ident())
        part.friction[...] = 0.1

    slices = contacts(2 * LARGE)
    Chain(*PAPER[:3])(slices)
    slices.film_thickness = 1e-9
    Chain(wrap(Stage(evaluate)))(slices)
    assert threads == {threading.get_ident()}


def in_new_process(code, **environment):
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ
        | {"PYTHONPATH": os.pathsep.join([os.path.dirname(__file__), *sys.path])}
        | environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.split()


USE = (
    "import os, _thread, threading, time; import numpy as np\nfrom "
    "test_chain_at_size import *; chain = Chain(*PAPER)\n"
)


@pytest.mark.slow
def test_threads_are_made_for_large_tables_only():
    code = (
        USE
        + "for n in (16, LARGE - 1, 2 * LARGE): chain(contacts(n)); time.sleep(0.2); print(1 + _thread._count())"
    )
    assert in_new_process(code, ROLLSLIP_THREADS="3") == ["1", "1", "3"]
    assert in_new_process(code, ROLLSLIP_THREADS="1") == ["1", "1", "1"]


def test_a_number_of_threads_that_is_none_is_refused_in_words(monkeypatch):
    for given in ("0", "-2", "two", "", "1.5", "\N{SUPERSCRIPT TWO}"):
        monkeypatch.setenv("ROLLSLIP_THREADS", given)
        engine.threads.cache_clear()
        with pytest.raises(RollslipError) as error:
            Chain(*PAPER)(contacts(LARGE))
        assert str(error.value) == (
            f"ROLLSLIP_THREADS = {given!r} is not a number of threads: set a whole number of at least 1, or unset it"
        )
    with pytest.raises(ValueError, match="at least one thread, not in 0"):
        Chain(*PAPER, threads=0)
    monkeypatch.setenv("ROLLSLIP_THREADS", "3")
    assert engine.threads() == 3
    monkeypatch.delenv("ROLLSLIP_THREADS")
    engine.threads.cache_clear()
    assert 1 <= engine.threads() <= os.cpu_count()


@pytest.mark.parametrize("count", [1, 2, 3, 8])
def test_the_first_error_is_raised_whatever_the_threads(count):
    """Two parts raise: the error of the earlier one comes through, and nothing goes on behind the caller's back."""
    running = []

    def evaluate(part):
        running.append(1)
        try:
            if part.regime[0] > 0.0:
                raise OwnError(float(part.regime[0]))
        finally:
            running.pop()

    slices = contacts(8 * PART)
    slices.regime = 0.0
    slices.regime[3 * PART] = 4.0
    slices.regime[5 * PART] = 6.0
    for _ in range(5):
        with pytest.raises(OwnError) as error:
            Chain(Stage(evaluate, writes=frozenset()), block=PART, threads=count)(slices)
        assert error.value.args == (4.0,)
        assert not running


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_process_makes_threads_of_its_own():
    code = USE + (
        "expected, slices = contacts(2 * LARGE), contacts(2 * LARGE)\n"
        "chain(expected)\n"
        "child = os.fork()\n"
        "chain(slices)\n"
        "same(slices, expected)\n"
        "if child == 0: os._exit(7)\n"
        "print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))"
    )
    assert in_new_process(code, ROLLSLIP_THREADS="2") == ["7"]


def test_large_tables_at_the_same_time_and_at_the_end_of_the_interpreter():
    code = USE + (
        "import atexit\n"
        "def task(k):\n"
        "    slices = contacts(2 * LARGE)\n"
        "    for _ in range(3): chain(slices)\n"
        "    return float(slices.friction.sum())\n"
        "print(len(set(run_together(task))))\n"
        "atexit.register(lambda: print(task(0) > 0))"
    )
    assert in_new_process(code, ROLLSLIP_THREADS="3") == ["1", "True"]


def test_an_interruption_finds_no_thread_half_started():
    """What a signal leaves of the start of threads is waited for by nobody: here the second is never started."""
    code = (
        "import _thread\n"
        "start, started = _thread.start_new_thread, []\n"
        "def interrupted(*given):\n"
        "    if len(started) == 1:\n"
        "        raise KeyboardInterrupt\n"
        "    started.append(start(*given))\n"
        "_thread.start_new_thread = interrupted\n"
    ) + USE
    code += (
        "slices = contacts(2 * LARGE)\n"
        "try: chain(slices)\n"
        "except KeyboardInterrupt: started += [0]\n"
        "chain(slices)\n"
        "print(len(started), np.count_nonzero(slices.friction) > 2 * LARGE - 2)"
    )
    assert in_new_process(code, ROLLSLIP_THREADS="4") == ["5", "True"]


def test_threads_that_die_before_they_work_are_not_waited_for():
    """As they do for want of memory: the calling thread does all."""
    code = (
        "import _thread\n"
        "start = _thread.start_new_thread\n"
        "_thread.start_new_thread = lambda work, given: start(lambda: None, ())\n"
    ) + USE
    code += "slices = contacts(2 * LARGE)\nchain(slices)\nprint(np.count_nonzero(slices.friction) > 2 * LARGE - 2)"
    assert in_new_process(code, ROLLSLIP_THREADS="4") == ["True"]


def test_a_thread_that_helps_waits_for_no_other():
    """A foreign kernel that evaluates a large table itself: threads that waited for each other would never end."""
    inner = Chain(*PAPER, threads=2)

    def evaluate(part):
        if part.regime[0] == 7.0:
            inner(contacts(LARGE))
        return 0

    slices = contacts(LARGE)
    slices.regime = 0.0
    slices.regime[::PART] = 7.0
    Chain(Stage(capsule=foreign_capsule(evaluate), writes=frozenset()), threads=2)(slices)
    assert inner.evaluated == 5 * LARGE


# Growth --------------------------------------------------------------------------------------------------------------


def growth(n):
    """Peaks of what NumPy allocates and of what the process holds, beside the bytes of the table, for n slices."""
    code = USE + (
        "import resource, tracemalloc\n"
        "chain(contacts(LARGE))\n"
        "base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "tracemalloc.start()\n"
        f"slices = Slices({n}, BEARING, load=2e4, rolling_speed=20.0, sliding_speed=1.0)\n"
        "chain(slices)\n"
        "held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base\n"
        "print(tracemalloc.get_traced_memory()[1], 1024 * held, slices._table.nbytes)"
    )
    return [int(value) for value in in_new_process(code, ROLLSLIP_THREADS="2")]


@pytest.mark.slow
@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="ru_maxrss has other units elsewhere"
)
@pytest.mark.parametrize("n", [10**6, pytest.param(10**7, marks=pytest.mark.soak)])
def test_memory_is_that_of_the_table(n):
    traced, held, table = growth(n)
    assert table == 13 * 8 * n
    assert table <= traced < 1.1 * table
    assert held < 1.5 * table


def test_calls_leave_nothing_behind():
    """Neither the chain nor a bound one; a refusal leaves no more than an exception that is dropped."""
    chain = Chain(*PAPER)
    slices = contacts(16)
    bad = contacts(16)
    evaluate = chain.bind(slices)
    bad.load = -1.0

    def calls(count):
        for _ in range(count):
            evaluate()
            chain(slices)
            chain.bind(slices)()
            Slices(16, BEARING, load=1e4)
            with pytest.raises(DomainError):
                chain(bad)

    calls(20)
    tracemalloc.start()
    calls(20)
    gc.collect()
    before = tracemalloc.get_traced_memory()[0]
    calls(200)
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 200 * 16  # less than one object a call


# Error of the whole chain --------------------------------------------------------------------------------------------

#: What each case forces, and how many of its slices are there: the branches of the whole chain.
BRANCHES = {
    "boundary alone": lambda s, k: s["film_parameter"] <= 0.01,
    "blend": lambda s, k: 0.01 < s["film_parameter"] < 1.5,
    "full film": lambda s, k: s["film_parameter"] >= 1.5,
    "elastic ramp": lambda s, k: s["ramp"],
    "Eyring plateau": lambda s, k: not s["ramp"] and s["sigma"] > 1.0,
    "Newtonian": lambda s, k: 0.0 < s["sigma"] < 1e-3,
    "at rest": lambda s, k: s["sigma"] == 0.0,
    "backwards": lambda s, k: k["sliding_speed"] < 0.0,
    "rigid": lambda s, k: s["M"] < 0.5,
    "elastic": lambda s, k: s["M"] > 10.0,
    "isoviscous": lambda s, k: s["L"] < 1.0,
    "piezoviscous": lambda s, k: s["L"] > 5.0,
}


FILLED = (
    "half_width",
    "pressure",
    "film_thickness",
    "film_viscosity",
    "film_thermoviscosity",
    "friction",
)


def wide_conditions(rng):
    """Conditions of an oil between water and grease on steel between fine and rough, soft or stiff."""

    def factor(decades):
        return 10.0 ** rng.uniform(-decades, decades)

    changes = {
        "viscosity": 1.0,
        "pressure_viscosity": 0.5,
        "roughness": 0.7,
        "eyring_stress": 0.5,
        "radius": 0.3,
    }
    changes |= {"shear_modulus": 2.0, "conductivity": 0.2, "thermoviscosity": 0.3}
    return attrs.evolve(
        BEARING, **{name: getattr(BEARING, name) * factor(d) for name, d in changes.items()}
    )


def exact_chain(conditions, columns):
    """The columns that the paper's chain fills, by the published laws in fifty digits, and what tells its branches."""
    members = attrs.asdict(conditions) | columns
    for model in PAPER:
        members |= fifty_digits.exact(model.name, model, members)
    with mpmath.workdps(50):
        m = {name: mpmath.mpf(value) for name, value in members.items()}
        sigma = (
            m["film_viscosity"]
            * abs(m["sliding_speed"])
            / (m["eyring_stress"] * m["film_thickness"])
        )
        deborah = m["film_viscosity"] * m["rolling_speed"] / (m["shear_modulus"] * m["half_width"])
        U, G, W = fifty_digits.groups(m)
        ramp = m["sliding_speed"] != 0 and abs(m["friction"]) * m["pressure"] == (
            m["eyring_stress"] * sigma / deborah
        )
        return members, {
            "film_parameter": m["film_thickness"] / m["roughness"],
            "sigma": sigma,
            "ramp": bool(ramp or sigma / deborah < mpmath.asinh(sigma) / 2),
            "M": W / mpmath.sqrt(2 * U),
            "L": G * (2 * U) ** mpmath.mpf("0.25"),
        }


def chain_error(cases, each):
    """Worst relative error of every filled column over drawn slices, and the branches they took."""
    rng = np.random.default_rng(11)
    worst = dict.fromkeys(("film_thickness", "film_viscosity", "friction"), 0)
    taken = {}
    for _ in range(cases):
        conditions = wide_conditions(rng)
        columns = {
            "load": 10.0 ** rng.uniform(2, 6, each),
            "rolling_speed": 10.0 ** rng.uniform(-3, 2, each),
        }
        ratio = 10.0 ** rng.uniform(-7, 0, each) * rng.choice([-1.0, 1.0], each)
        columns["sliding_speed"] = np.where(
            rng.random(each) < 0.1, 0.0, ratio * columns["rolling_speed"]
        )
        slices = Slices(each, conditions, **columns)
        Chain(*PAPER)(slices)
        for i in range(each):
            members, signs = exact_chain(
                conditions, {name: float(values[i]) for name, values in columns.items()}
            )
            for name in worst:
                found = float(getattr(slices, name)[i])
                truth = members[name]
                error = abs(float((found - truth) / truth)) if truth else abs(found)
                worst[name] = max(worst[name], error)
            for branch, holds in BRANCHES.items():
                taken[branch] = taken.get(branch, 0) + bool(holds(signs, members))
    return worst, taken


def test_the_whole_chain_is_right_to_a_million_millionth_in_every_branch():
    """At 1e-12 of fifty digits: film, viscosity and friction of oils and loads that force each branch."""
    worst, taken = chain_error(40, 12)
    assert min(taken[branch] for branch in BRANCHES) >= 5, taken
    assert max(worst.values()) < 1e-12, worst


@pytest.mark.soak
def test_the_whole_chain_is_right_to_a_million_millionth_in_every_branch_long():
    worst, _ = chain_error(600, 40)
    assert max(worst.values()) < 1e-12, worst


@pytest.mark.slow
def test_the_whole_chain_gives_the_same_bits_on_every_instruction_set_that_fuses():
    code = USE + (
        "import hashlib; digest = hashlib.sha256()\n"
        "for n in (*range(1, 18), 255, 256, 257, 3000):\n"
        "    slices = contacts(n); chain(slices); digest.update(slices._table.tobytes())\n"
        "print(digest.hexdigest())"
    )
    fused = [name for name in simd.available() if name != "baseline"] or ["baseline"]
    assert len({in_new_process(code, ROLLSLIP_SIMD=name)[0] for name in fused}) == 1
