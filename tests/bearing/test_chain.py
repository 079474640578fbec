"""The chain of stages: C layout, blocks, threads, Python stages, refusals, and the capsules of strangers."""

import ctypes
import gc
import itertools
import math
import sys
import threading
import time
import weakref

import attrs
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chain_samples import BEARING, OwnError, run_together
from foreign_stages import PYTHON_RAISED, RsModel, RsSlices, Stage, foreign_capsule
from rollslip import Chain, Conditions, Slices
from rollslip.bearing.chain import along
from rollslip.errors import DomainError, PluginError
from rollslip_kernels import chain as compiled
from rollslip_kernels.layout import layout
from rollslip_kernels.slices import COLUMNS, CONDITIONS, PLACES
from rollslip_plugins.contact import Iso16281, Lundberg, Palmgren
from rollslip_plugins.film.formulas import Martin, Moes, PanHamrock, Regime
from rollslip_plugins.pressure_viscosity import Barus, Roelands, Yasutomi
from rollslip_plugins.traction.blend import LambdaBlend
from rollslip_plugins.traction.boundary import Constant, Kragelsky
from rollslip_plugins.traction.eyring import Eyring, MaxwellEyring, Muraki
from strategies import NumpyForm, forms, law_of

STAGES = [
    Palmgren().deflection(),
    Iso16281().deflection(),
    Lundberg().deflection(),
    Palmgren(),
    Lundberg(),
    Martin(),
    PanHamrock(),
    Moes(),
    Regime(),
    Barus(),
    Roelands(),
    Yasutomi(glass_temperature=245.0, a1=60.0, a2=1.929e-9, b1=4.8, b2=0.16e-9, c1=16.0, c2=20.7),
    Muraki(),
    MaxwellEyring(),
    Eyring(),
    Kragelsky(),
    Constant(),
    LambdaBlend(),
]


def bearing_slices(n=5, conditions=BEARING):
    """Slices whose every column has a sensible value, and whose film parameters cross both limits of the blend."""
    at = np.linspace(0, 1, n)
    return Slices(
        n,
        conditions,
        approach=1e-6 * (1 + 4 * at),
        rolling_speed=10 + 20 * at,
        sliding_speed=3 * np.sin(7 * at) + 0.1,
        load=1e4 + 3e4 * at,
        stiffness=1e9,
        half_width=3e-5 + 4e-5 * at,
        pressure=2e8 + 3e8 * at,
        film_thickness=2.3e-7 * 10 ** (-3 + 4 * np.sin(5 * at) ** 2),
        regime=3.0,
        friction=0.0,
        film_viscosity=0.1 * 20**at,
        film_thermoviscosity=0.05 + 0.03 * at,
        resistance=100.0 + 50.0 * at,
    )


# Layout --------------------------------------------------------------------------------------------------------------


#: What packages that were compiled against version 1 of the contract read, at its place.
ABI_1 = (
    "n", "length", "radius", "modulus", "roughness", "effusivity", "temperature", "viscosity", "pressure_viscosity",
    "thermoviscosity", "pressure_thermoviscosity", "conductivity", "eyring_stress", "shear_modulus",
    "approach", "rolling_speed", "sliding_speed", "load", "stiffness", "half_width", "pressure", "film_thickness",
    "regime", "friction", "film_viscosity", "film_thermoviscosity", "resistance",
)  # fmt: skip


def test_members_are_only_ever_appended():
    assert tuple(layout()[1])[: len(ABI_1)] == ABI_1


def test_c_structure_has_the_members_of_python_in_their_order():
    size, offsets = layout()
    assert sorted(offsets, key=offsets.get) == list(offsets) == ["n", *CONDITIONS, *COLUMNS]
    assert list(offsets.values()) == [getattr(RsSlices, name).offset for name in offsets]
    assert size == ctypes.sizeof(RsSlices)
    assert tuple(a.name for a in attrs.fields(Conditions)) == tuple(CONDITIONS)


def marked():
    """Slices in which every member of every slice has a number of its own."""
    slices = Slices(3, Conditions(**{name: 1000.0 + k for k, name in enumerate(CONDITIONS)}))
    for row, name in enumerate(COLUMNS):
        getattr(slices, name)[:] = 10.0 * row + np.arange(3)
    return slices


@pytest.mark.parametrize("language", ["C", "Python"])
def test_every_member_arrives_under_its_name(language):
    seen = {}

    def keep(part):
        source = part if language == "C" else part.conditions
        seen.update({name: getattr(source, name) for name in CONDITIONS})
        # copies: the arrays of a stage are views on the block
        seen.update({name: [getattr(part, name)[i] for i in range(3)] for name in COLUMNS})
        seen["n"] = part.n if language == "C" else len(part.friction)

    capsule = foreign_capsule(lambda part: keep(part) or 0) if language == "C" else None
    stage = Stage(
        keep, capsule, reads=frozenset(COLUMNS)
    )  # where slices are is there for who reads it
    slices = marked()
    Chain(stage)(slices)
    assert seen.pop("n") == 3
    for k, name in enumerate(CONDITIONS):
        assert seen.pop(name) == 1000.0 + k, name
    for row, name in enumerate(COLUMNS):
        assert seen.pop(name) == [10.0 * row, 10.0 * row + 1, 10.0 * row + 2], name
    assert not seen


@pytest.mark.parametrize("language", ["C", "Python"])
def test_every_column_can_be_filled_under_its_name(language):
    def fill(part):
        for row, name in enumerate(COLUMNS):
            for i in range(3):
                getattr(part, name)[i] = -10.0 * row - i

    capsule = foreign_capsule(lambda part: fill(part) or 0) if language == "C" else None
    slices = marked()
    Chain(Stage(fill, capsule, writes=frozenset(COLUMNS)))(slices)
    for row, name in enumerate(COLUMNS):
        assert getattr(slices, name).tolist() == [-10.0 * row - i for i in range(3)]


# Blocks, order, threads ----------------------------------------------------------------------------------------------


def mixed():
    """Compiled and NumPy stages in turn, and a NumPy child in a compiled blend.

    The NumPy ones are those whose operations IEEE 754 rounds the same in every lane and remainder of a vector loop:
    products, quotients, square roots. NumPy's exp or pow may differ in a last bit with the position in an array.
    """
    blend = LambdaBlend(boundary=NumpyForm(Constant()), hydrodynamic=MaxwellEyring())
    return [Lundberg().deflection(), NumpyForm(Lundberg()), Moes(), blend]


def results(slices):
    return slices._table.copy()


#: Slices: of several default blocks, and no multiple of the blocks of 7 and 256 that are compared with them.
N = 1000


@pytest.mark.parametrize(
    "models", [mixed(), [NumpyForm(Palmgren()), Regime(), LambdaBlend()]], ids=["mixed", "other"]
)
@pytest.mark.parametrize("block", [1, 7, 256, N, 0, 10 * N])
def test_results_do_not_depend_on_the_block(models, block):
    def at(block):
        slices = bearing_slices(N)
        Chain(*models, block=block)(slices)
        return results(slices)

    np.testing.assert_array_equal(at(block), at(None))


@settings(max_examples=25)
@given(order=st.permutations(range(40)), block=st.sampled_from([1, 7, 256, 0]))
def test_results_do_not_depend_on_the_order_of_slices(order, block):
    straight = bearing_slices(40)
    shuffled = bearing_slices(40)
    shuffled._table[:] = shuffled._table[:, order]
    for slices in (straight, shuffled):
        Chain(*mixed(), block=block)(slices)
    np.testing.assert_array_equal(results(shuffled), results(straight)[:, order])


def test_one_chain_gives_the_same_bits_in_eight_threads():
    chain = Chain(*mixed(), block=64)
    expected = []
    for k in range(8):
        expected.append(bearing_slices(N + k))
        chain(expected[-1])

    def task(k):
        slices = bearing_slices(N + k)
        for _ in range(5):
            chain(slices)
        return results(slices)

    for answer, slices in zip(run_together(task), expected, strict=True):
        np.testing.assert_array_equal(answer, results(slices))


def test_compiled_blocks_run_without_the_gil():
    """A thread that ticks goes on ticking during one call.

    With an endless switch interval no thread is made to yield: the ticker lives in the moments in which the GIL is
    given up, by its own sleep or by the chain. Held through the call, not one tick would fall into it.
    """
    ticks = [0]
    stop = threading.Event()

    def tick():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(1e-5)

    chain = Chain(MaxwellEyring())
    slices = bearing_slices(100_000)
    interval = sys.getswitchinterval()
    ticker = threading.Thread(target=tick)
    sys.setswitchinterval(1000.0)
    ticker.start()
    try:
        for _ in range(50):  # a busy machine may not run the ticker in the first call
            before = ticks[0]
            chain(slices)
            advanced = ticks[0] - before
            if advanced:
                break
    finally:
        stop.set()
        sys.setswitchinterval(interval)
        ticker.join()
    assert advanced


@pytest.mark.parametrize("rollers", [1, 3])
@pytest.mark.parametrize("size", [0, 1, 13, 700])
def test_rows_of_speeds_are_as_the_table_at_each_of_them(rollers, size):
    """Compiled, mixed and guarded tables in one go; sums within the rounding of as many terms."""
    rng = np.random.default_rng(size)
    u = 10 + rng.random((9, rollers))
    V = rng.random((9, rollers))
    weight = rng.random(size)
    owner = np.arange(size) % 3
    chains = [
        Chain(Moes(), Muraki()),
        Chain(*mixed()),
        Chain(Moes(), Muraki(), bounds=[lambda slices: None]),
    ]
    tables = [bearing_slices(size) for _ in chains]
    jobs = [
        (chain.bind(table), u, V, owner, weight)
        for chain, table in zip(chains, tables, strict=True)
    ]
    found = along(jobs)
    assert np.array_equal(found[0][0], found[2][0])  # bounds change no bit
    for chain, (sums, films) in zip(chains, found, strict=True):
        assert chain.evaluated == 9 * size
        expected = bearing_slices(size)
        for k in range(9):
            of = owner if rollers > 1 else 0 * owner
            expected.rolling_speed[:] = u[k][of]
            expected.sliding_speed[:] = V[k][of]
            chain(expected)
            true = math.fsum(expected.friction * weight)
            assert abs(sums[k] - true) <= 4.0 * max(size, 1) * np.finfo(float).eps * true
            assert films[k] == expected.film_thickness.min(initial=np.inf)


def test_of_rows_of_speeds_the_first_that_is_refused_is_named():
    u = np.array([[10.0], [12.0], [-7.0], [-8.0]])
    chain = Chain(Moes(), Muraki())
    owner = np.zeros(5, dtype=np.intp)
    jobs = [
        (chain.bind(bearing_slices()), speeds, 0.1 * speeds, owner, np.ones(5))
        for speeds in (u[:2], u)
    ]
    with pytest.raises(DomainError, match=r"moes: rolling_speed = -7 m/s at slice 0"):
        along(jobs)
    assert chain.evaluated == 25
    python = Chain(Stage(lambda part: 1 / 0))
    with pytest.raises(ZeroDivisionError):
        along([jobs[0], (python.bind(bearing_slices()), u, u, owner, np.ones(5))])


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({1: np.ones((2, 2))}, "one shape"),
        ({1: np.ones((3, 0)), 2: np.ones((3, 0))}, "of 0 rollers"),
        ({1: np.ones((3, 2)), 2: np.ones((3, 2))}, "of 2 rollers, and slices belong to others"),
        ({3: np.zeros(4, dtype=np.intp)}, "owners and weights are expected of 5 slices"),
        ({4: np.zeros(6)}, "owners and weights are expected of 5 slices"),
    ],
)
def test_rows_of_speeds_that_do_not_fit_the_table_are_refused(changed, said):
    given = [
        Chain(Moes()).bind(bearing_slices()),
        np.ones((3, 1)),
        np.ones((3, 1)),
        np.arange(5),
        np.ones(5),
    ]
    for k, value in changed.items():
        given[k] = value
    with pytest.raises(ValueError, match=said):
        along([tuple(given)])


def test_a_python_stage_makes_one_call_of_all_slices_by_default():
    sizes = []
    slices = bearing_slices(1000)
    chain = Chain(Kragelsky(), Stage(lambda part: sizes.append(len(part.friction))))
    chain(slices)
    assert (chain.block, sizes, chain.evaluated) == (0, [1000], 1000)
    assert Chain(Kragelsky()).block == 256
    Chain(Stage(lambda part: sizes.append(len(part.friction))), block=256)(slices)
    assert sizes == [1000, 256, 256, 256, 232]


@pytest.mark.parametrize("block", [None, 0, 1, 256])
def test_an_empty_table_is_done_at_once(block):
    Chain(*STAGES[3:8], block=block)(Slices(0, BEARING))
    Chain(Stage(lambda part: pytest.fail("called for nothing")), block=block)(Slices(0, BEARING))
    Chain(block=block)(bearing_slices())
    with pytest.raises(
        DomainError, match="needs modulus"
    ):  # the conditions of no slices are still conditions
        Chain(Palmgren(), block=block)(Slices(0))


def test_a_chain_has_at_most_eight_stages():
    slices = bearing_slices()
    Chain(*[Kragelsky()] * 8)(slices)
    with pytest.raises(ValueError, match="at most 8 stages, got 9"):
        Chain(*[Kragelsky()] * 9)


# Python stages -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(set(COLUMNS) - {"friction"}))
@pytest.mark.parametrize("child", [False, True], ids=["stage", "child of a blend"])
def test_a_python_stage_cannot_change_its_inputs(name, child):
    def spoil(part):
        getattr(part, name)[:] = 0.0

    slices = bearing_slices()
    stage = Stage(spoil, reads=frozenset({name} & {*PLACES}))
    for place in PLACES:
        getattr(slices, place)[:] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        Chain(LambdaBlend(boundary=stage) if child else stage)(slices)
    np.testing.assert_array_equal(
        getattr(slices, name), 1.0 if name in PLACES else getattr(bearing_slices(), name)
    )


@pytest.mark.parametrize("child", [False, True], ids=["stage", "child of a blend"])
@pytest.mark.parametrize(
    "error", [ZeroDivisionError("by me"), KeyError("k"), OwnError(1, 2), DomainError("no")]
)
def test_an_error_in_a_python_stage_comes_through_as_it_is(child, error):
    def fail(part):
        raise error

    stage = Stage(fail)
    with pytest.raises(type(error)) as caught:
        Chain(LambdaBlend(boundary=stage) if child else stage)(bearing_slices())
    assert caught.value is error
    assert caught.traceback[-1].name == "fail"


def test_every_thread_gets_its_own_error():
    """All eight raise between two meetings, so all eight errors are pending at once."""
    meet = threading.Barrier(8)

    def fail(part):
        meet.wait(timeout=60)
        try:
            raise OwnError(part.load[0])
        finally:
            meet.wait(timeout=60)

    chain = Chain(Kragelsky(), Stage(fail), Palmgren())

    def task(k):
        slices = bearing_slices()
        slices.load[:] = k
        chain(slices)

    errors = run_together(task)
    assert [type(error) for error in errors] == [OwnError] * 8
    assert [error.args for error in errors] == [(float(k),) for k in range(8)]


def test_later_stages_and_blocks_do_not_run_after_an_error():
    calls = []

    def second_time(part):
        calls.append("first stage")
        if calls.count("first stage") == 2:
            raise KeyError

    with pytest.raises(KeyError):
        Chain(Stage(second_time), Stage(lambda part: calls.append("later stage")), block=2)(
            bearing_slices(9)
        )
    assert calls == ["first stage", "later stage", "first stage"]


def test_a_capsule_freed_while_an_error_is_on_its_way_leaves_the_error_alone(capsys):
    """The first of two capsules that a call is being given is dropped when the second cannot be made."""
    with pytest.raises(KeyError, match="mine"):
        print(Kragelsky().kernel(), {}["mine"])
    gc.collect()
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    "wrap", [lambda child: child, lambda child: LambdaBlend(boundary=child)], ids=["stage", "child"]
)
def test_models_live_as_long_as_their_chain_and_no_longer(wrap):
    @attrs.frozen
    class Mortal(Stage):
        def evaluate(self, slices):
            slices.friction[...] = 0.25

    def bound():
        model = wrap(Mortal())
        capsule = model.kernel() or compiled.python_stage(model.evaluate, model.writes)
        return compiled.Chain([(capsule, {}, frozenset({"friction"}))]), weakref.ref(
            getattr(model, "boundary", model)
        )

    chain, alive = bound()
    gc.collect()
    assert alive() is not None
    slices = bearing_slices()
    slices.film_thickness[:] = 1e-12  # boundary friction alone
    assert chain.run(slices) is None
    assert slices.friction.tolist() == [0.25] * 5
    del chain
    gc.collect()
    assert alive() is None


# Refusals ------------------------------------------------------------------------------------------------------------


def spoiled(member, value, at=3, n=5):
    if member in CONDITIONS:
        return bearing_slices(n, attrs.evolve(BEARING, **{member: value}))
    slices = bearing_slices(n)
    getattr(slices, member)[at] = value
    return slices


@pytest.mark.parametrize("block", [1, 2, 256, 0])
@pytest.mark.parametrize("at", [0, 1, 2, 255, 256, 257, 599])
def test_a_refusal_names_model_member_value_slice_and_range(block, at):
    slices = spoiled("load", -7.5, at, n=600)
    with pytest.raises(DomainError) as error:
        Chain(Kragelsky(), NumpyForm(Moes()), block=block)(slices)
    assert str(error.value) == f"moes: load = -7.5 N/m at slice {at} is outside its domain (> 0)"


def test_a_range_with_two_ends_is_shown():
    stage = Stage(lambda part: None, domain={"load": (1.0, 2.0), "radius": (0.5, 1.0)})
    with pytest.raises(DomainError) as error:
        Chain(stage)(bearing_slices())
    assert (
        str(error.value)
        == "made-in-a-test: radius = 0.006875 m is outside its domain (>= 0.5 and <= 1)"
    )
    with pytest.raises(DomainError) as error:
        Chain(stage)(bearing_slices(conditions=attrs.evolve(BEARING, radius=0.5)))
    assert (
        str(error.value)
        == "made-in-a-test: load = 10000 N/m at slice 0 is outside its domain (>= 1 and <= 2)"
    )


def test_the_first_bad_slice_of_the_first_stage_is_reported():
    slices = spoiled("load", -1.0, at=4)
    slices.rolling_speed[2] = 0.0
    with pytest.raises(DomainError, match="kragelsky: rolling_speed = 0 m/s at slice 2"):
        Chain(Kragelsky(), Palmgren())(slices)
    with pytest.raises(DomainError, match="palmgren: load = -1 N/m at slice 4"):
        Chain(Palmgren(), Kragelsky())(slices)


def test_a_condition_that_nobody_gave_is_asked_for():
    with pytest.raises(DomainError) as error:
        Chain(Muraki())(bearing_slices(conditions=attrs.evolve(BEARING, conductivity=np.nan)))
    assert str(error.value) == (
        "muraki: needs conductivity (thermal conductivity of the oil K_f), which the lubricant or scene does not give"
    )


def test_a_column_that_nobody_filled_is_refused():
    needs = "muraki: slice 0 has no film_thickness .*; give it, or put a stage that fills it before this one"
    with pytest.raises(DomainError, match=needs):
        Chain(Palmgren(), Barus(), Muraki())(
            Slices(2, BEARING, load=1e4, rolling_speed=10.0, sliding_speed=0.1)
        )


@pytest.mark.parametrize("block", [1, 2, 0])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("language", ["C", "Python"])
def test_a_result_that_is_not_finite_is_refused(block, bad, language):
    def write(part):
        for i in range(part.n if language == "C" else len(part.load)):
            part.friction[i] = bad if part.regime[i] == 7 else 0.5

    slices = spoiled("regime", 7.0)
    capsule = foreign_capsule(lambda part: write(part) or 0) if language == "C" else None
    with pytest.raises(
        DomainError, match="made-in-a-test: slice 3 gives a friction that is not finite"
    ):
        Chain(Stage(write, capsule), Kragelsky(), block=block)(slices)


@pytest.mark.parametrize("model", forms([Barus()]))
def test_overflow_inside_a_law_is_refused(model):
    """exp(alpha p) overflows at alpha p = 710."""
    slices = spoiled("pressure", 800 / BEARING.pressure_viscosity)
    with (
        np.errstate(all="ignore"),
        pytest.raises(DomainError, match=f"{model.name}: slice 3 gives a film_viscosity"),
    ):
        Chain(model)(slices)


def status_where(column, value, code=lambda i: i + 1):
    """A capsule that refuses the first slice whose column has a value."""

    def evaluate(part):
        for i in range(part.n):
            if getattr(part, column)[i] == value:
                return code(i)
            part.friction[i] = 0.5
        return 0

    return foreign_capsule(evaluate)


@pytest.mark.parametrize("block", [1, 7, 256, 0])
@pytest.mark.parametrize("at", [0, 6, 7, 255, 256, 599])
def test_a_status_names_its_slice(block, at):
    stage = Stage(capsule=status_where("regime", 7.0))
    with pytest.raises(DomainError, match=f"^made-in-a-test: slice {at} is outside its domain$"):
        Chain(Kragelsky(), stage, block=block)(spoiled("regime", 7.0, at, n=600))


def mixed_film(at, elsewhere):
    """Slices of mixed film but for every third, and one of mixed film that a stage may refuse by its regime."""
    slices = spoiled("regime", 7.0, at, n=600)
    slices.film_thickness[:] = BEARING.roughness * np.where(np.arange(600) % 3, 0.5, elsewhere)
    slices.film_thickness[at] = BEARING.roughness * 0.5
    return slices


@pytest.mark.parametrize("block", [1, 7, 256, 0])
@pytest.mark.parametrize(("which", "elsewhere"), [("boundary", 9), ("hydrodynamic", 1e-3)])
def test_a_status_from_inside_a_blend_names_the_slice_of_the_table(block, which, elsewhere):
    """The blend gathers the slices a child needs: the child's number is translated back."""
    blend = LambdaBlend(**{which: Stage(capsule=status_where("regime", 7.0))})
    for at in range(0, 600, 37):
        with pytest.raises(DomainError, match=f"^lambda-blend: slice {at} is outside its domain$"):
            Chain(blend, block=block)(mixed_film(at, elsewhere))


@pytest.mark.parametrize("code", [PYTHON_RAISED, -2, -1000, 601, 100_000])
@pytest.mark.parametrize(
    "wrap", [lambda s: s, lambda s: LambdaBlend(boundary=s)], ids=["stage", "child of a blend"]
)
def test_a_status_that_does_not_exist_is_the_plugins_fault(code, wrap):
    """-1 without a Python error, other negative numbers, and more than the block has slices."""
    model = wrap(Stage(capsule=status_where("regime", 7.0, lambda i: code)))
    said = f"the kernel of '{model.name}' returned a status that rollslip.h does not"
    for block, at in itertools.product((2, 256, 0), (0, 1, 500)):
        with pytest.raises(PluginError, match=said):
            Chain(model, block=block)(mixed_film(at, 9))


# Blend ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
@pytest.mark.parametrize("n", [1, 5, 256, 257, 600])
def test_a_blend_evaluates_a_child_only_where_it_is_needed(form, n):
    """Boundary below Lambda_hd, hydrodynamic above Lambda_bd, each in the order of the table; no call for no slice."""
    seen = {"boundary": [], "hydrodynamic": []}

    def child(which, value):
        def evaluate(part):
            assert len(part.load) > 0
            seen[which] += part.load.tolist()
            part.friction[...] = value

        return Stage(evaluate)

    slices = bearing_slices(n)
    slices.load[:] = np.arange(n)
    film_parameter = slices.film_thickness / BEARING.roughness
    Chain(
        form(LambdaBlend(boundary=child("boundary", 0.1), hydrodynamic=child("hydrodynamic", 0.02)))
    )(slices)
    assert seen["boundary"] == np.flatnonzero(film_parameter < 1.5).tolist()
    assert seen["hydrodynamic"] == np.flatnonzero(film_parameter > 0.01).tolist()
    assert np.all(slices.friction[film_parameter <= 0.01] == 0.1)
    assert np.all(slices.friction[film_parameter >= 1.5] == 0.02)
    band = (film_parameter > 0.01) & (film_parameter < 1.5)
    assert np.all((slices.friction[band] >= 0.02) & (slices.friction[band] <= 0.1))


@pytest.mark.parametrize("which", ["boundary", "hydrodynamic"])
@pytest.mark.parametrize("form", [lambda model: model, NumpyForm], ids=["compiled", "numpy"])
def test_a_blend_leaves_out_a_child_that_nothing_needs(which, form):
    slices = bearing_slices(600)
    slices.film_thickness[:] = BEARING.roughness * (10.0 if which == "boundary" else 1e-3)
    idle = Stage(lambda part: pytest.fail("called for nothing"))
    Chain(form(LambdaBlend(**{which: idle})))(slices)


def test_a_gathered_child_sees_the_columns_of_its_slices():
    """Every column but the result, for slices picked out of several blocks."""

    def evaluate(part):
        for row, name in enumerate(COLUMNS):
            if name not in ("film_thickness", "friction"):
                np.testing.assert_array_equal(getattr(part, name) - part.approach, row * 1000.0)
        assert part.conditions == BEARING
        part.friction[...] = part.approach

    slices = Slices(600, BEARING)
    for row, name in enumerate(COLUMNS):
        getattr(slices, name)[:] = row * 1000.0 + np.arange(600)
    thin = np.arange(600) % 3 == 0
    slices.film_thickness[:] = BEARING.roughness * np.where(thin, 1e-3, 10.0)
    Chain(LambdaBlend(boundary=Stage(evaluate, reads=frozenset(PLACES)), hydrodynamic=Constant()))(
        slices
    )
    np.testing.assert_array_equal(slices.friction[thin], np.arange(600)[thin])


# Capsules of strangers -----------------------------------------------------------------------------------------------

DONE = staticmethod(lambda part: 0)
NOT_CAPSULES = [42, "capsule", object(), lambda: None]
WRONG = [
    *[
        (
            lambda thing=thing: thing,
            "must return None or a capsule named 'rollslip.slice_model.v1', got",
        )
        for thing in NOT_CAPSULES
    ],
    (lambda: foreign_capsule(DONE, name=b"someone.else.v1"), "must return None or a capsule named"),
    (lambda: foreign_capsule(DONE, name=None), "must return None or a capsule named"),
    (
        lambda: foreign_capsule(DONE, abi=0),
        "was built for ABI 0 of rollslip.h, this is 1: rebuild it against this",
    ),
    (
        lambda: foreign_capsule(DONE, abi=2),
        "was built for ABI 2 of rollslip.h, this is 1: rebuild it against this",
    ),
    (
        lambda: foreign_capsule(DONE, size=ctypes.sizeof(RsSlices) + 8),
        f"reads {ctypes.sizeof(RsSlices) + 8} bytes of rs_slices, this rollslip has {ctypes.sizeof(RsSlices)}: "
        "it needs a newer rollslip",
    ),
    (lambda: foreign_capsule(None), "gave a table whose evaluate is NULL"),
]


@pytest.mark.parametrize(("make", "complaint"), WRONG, ids=range(len(WRONG)))
@pytest.mark.parametrize(
    "wrap", [lambda s: s, lambda s: LambdaBlend(hydrodynamic=s)], ids=["stage", "child of a blend"]
)
def test_a_wrong_capsule_is_refused_by_class_and_remedy(make, complaint, wrap):
    with pytest.raises(PluginError) as error:
        Chain(wrap(Stage(capsule=make())))
    who = f"model 'made-in-a-test': {Stage.__module__}.Stage.kernel() "
    assert str(error.value).startswith(who + complaint)


def test_a_kernel_built_against_a_shorter_structure_still_runs():
    """Members are only ever appended, so what an older build knows has not moved."""

    def evaluate(part):
        part.friction[0] = part.shear_modulus
        return 0

    slices = bearing_slices(1)
    Chain(Stage(capsule=foreign_capsule(evaluate, size=ctypes.sizeof(RsSlices) - 8)))(slices)
    assert slices.friction[0] == BEARING.shear_modulus
    assert ctypes.sizeof(RsModel) == 24


def test_columns_are_checked_by_name():
    with pytest.raises(
        TypeError, match="Slices has no column 'freezing'; it has approach, rolling_speed"
    ):
        Slices(2, freezing=1.0)
    assert len(Slices(3)) == 3
    assert np.isnan(Slices(3).load).all()
    assert law_of(NumpyForm(Moes())) == Moes()
