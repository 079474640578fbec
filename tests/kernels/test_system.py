"""Systems of arrow shape: rates and Jacobian against the same problem written densely, linear algebra against NumPy."""

import gc
import weakref

import numpy as np
import pytest

from rollslip_kernels.motion.rosenbrock import Rosenbrock
from rollslip_kernels.motion.system import RefusedError, System, python_system

pytestmark = pytest.mark.quick

#: Unknowns of the head, a and b.
HEAD = 2
#: Unknowns of each roller, x, y and z.
BLOCK = 3
#: Unknowns that only receive: no rate depends on them.
LEDGER = 2
N_RECEIVING = HEAD + LEDGER


def arrow(rollers, scale=1.0):
    """A made-up nonlinear system of arrow shape, of the head's and the rollers' functions."""

    def head_rates(t, head):
        a, b = head
        return np.array([np.sin(a * b) + t, b**2 - a, a * b, np.cos(a)])

    def roller_rates(t, head, own):
        x, y, z = own.T
        a, b = head
        rates = np.array([y * z - a, np.exp(-x) * b + t, -np.tanh(z + x) * a * b]).T
        return rates, np.array([x * y, np.sin(z) - x * a, x**2, a * b * z]).T

    return python_system(
        head_rates,
        HEAD,
        roller_rates=roller_rates,
        rollers=rollers,
        block=BLOCK,
        ledger=LEDGER,
        scale=scale,
    )


def dense(t, u):
    """The same system from one vector to another, for complex numbers too, a roller at a time."""
    a, b = u[:HEAD]
    rates = np.zeros_like(u)
    rates[0] = np.sin(a * b) + t
    rates[1] = b * b - a
    rates[-2] = a * b
    rates[-1] = np.cos(a)
    for j in range((u.size - N_RECEIVING) // BLOCK):
        first = HEAD + j * BLOCK
        x, y, z = u[first : first + BLOCK]
        rates[first : first + BLOCK] = y * z - a, np.exp(-x) * b + t, -np.tanh(z + x) * a * b
        rates[0] += x * y
        rates[1] += np.sin(z) - x * a
        rates[-2] += x * x
        rates[-1] += a * b * z
    return rates


def complex_step(t, u):
    """df/dy to rounding: the imaginary part of f(y + i h e) over h, h = 1e-30."""
    shifted = u + 1e-30j * np.eye(u.size)
    return np.array([dense(t, row).imag / 1e-30 for row in shifted]).T


def state(rollers, seed=1):
    return np.random.default_rng(seed).normal(size=HEAD + BLOCK * rollers + LEDGER)


# Rates and derivatives -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rollers", [1, 2, 7])
def test_rates_are_those_of_the_same_system_written_densely(rollers):
    system = System(arrow(rollers))
    y = state(rollers)
    assert (system.n, system.head, system.rollers) == (y.size, HEAD, rollers)
    assert (system.block, system.ledger, system.watched) == (BLOCK, LEDGER, 0)
    np.testing.assert_allclose(system(0.3, y), dense(0.3, y), rtol=1e-14, atol=1e-14)
    # SciPy's differences pass columns of a matrix
    columns = np.array([y, y]).T.copy()
    assert not columns[:, 1].flags.c_contiguous
    assert np.array_equal(system.rates(0.3, columns[:, 1]), system.rates(0.3, y))


@pytest.mark.parametrize(("central", "tolerance"), [(False, 2e-7), (True, 2e-9)])
def test_the_arrow_jacobian_is_that_of_complex_steps(central, tolerance):
    system = System(arrow(7))
    y = state(7)
    exact = complex_step(0.3, y)
    found = system.jacobian(0.3, y, central=central)
    np.testing.assert_allclose(found, exact, rtol=0, atol=tolerance * np.max(np.abs(exact)))
    assert np.all(found[exact == 0.0] == 0.0), "the shape is not an arrow's"


def test_differences_take_the_scale_of_an_unknown_that_is_zero():
    """With y = 0 and f = sin(y/s), df/dy = 1/s needs increments well below s."""
    sizes = np.array([1e-9, 1.0, 1e6])
    system = System(python_system(lambda t, y: np.sin(y / sizes), 3, scale=sizes))
    np.testing.assert_allclose(
        np.diag(system.jacobian(0.0, np.zeros(3), central=False)) * sizes, 1.0, rtol=1e-7
    )


@pytest.mark.parametrize("rollers", [1, 10, 300])
@pytest.mark.parametrize(("central", "times"), [(False, 1), (True, 2)])
def test_a_jacobian_costs_as_many_evaluations_whatever_the_number_of_rollers(
    rollers, central, times
):
    system = System(arrow(rollers))
    system.jacobian(0.0, state(rollers), central=central)
    assert system.evaluations == 1 + times * (HEAD + BLOCK)


@pytest.mark.parametrize("central", [False, True])
@pytest.mark.parametrize("edge", ["raises", "is not a number"])
def test_differences_take_the_other_side_at_an_edge_of_the_domain(central, edge):
    """sqrt(1 - y) + sqrt(1 + x) at y = 1 and x = -1, where either is defined on one side only."""

    def rates(t, u):
        if edge == "raises" and (u[0] > 1 or u[1] < -1):
            raise RefusedError("outside", reason=u.tolist())
        with np.errstate(invalid="ignore"):
            return np.array([(1 - u[0]) ** 1.5, (1 + u[1]) ** 1.5 + u[0]])

    found = System(python_system(rates, 2)).jacobian(0.0, [1.0, -1.0], central=central)
    np.testing.assert_allclose(found, [[0, 0], [1, 0]], atol=5e-3)  # of (increment)^1/2


def test_rates_that_are_nowhere_finite_have_no_jacobian():
    system = System(python_system(lambda t, y: y * np.nan, 2))
    assert np.all(np.isnan(system(0.0, [1.0, 2.0]))), "SciPy's solvers see it in the rates"
    with pytest.raises(ArithmeticError, match="the rates are not finite near t = 0"):
        system.jacobian(0.0, [1.0, 2.0])


def test_a_given_jacobian_is_taken_as_it_is():
    matrix = np.arange(9.0).reshape(3, 3)
    system = System(python_system(lambda t, y: matrix @ y, 3, jacobian=lambda t, y: matrix))
    assert np.array_equal(system.jacobian(0.0, np.ones(3)), matrix)
    assert system.evaluations == 0


# Linear algebra ------------------------------------------------------------------------------------------------------

#: Head, rollers, block and ledger: one and many of each, and systems without rollers, ledger or head.
SHAPES = [
    (1, 1, 1, 0),
    (1, 28, 1, 8),
    (2, 5, 3, 2),
    (24, 7, 8, 32),
    (3, 0, 0, 4),
    (40, 0, 0, 0),
    (0, 4, 2, 1),
    (9, 3, 6, 0),
]


def linear(head, rollers, block, ledger, seed=2):
    """A linear system of arrow shape with coefficients from a normal distribution."""
    draw = np.random.default_rng(seed).normal
    own = draw(size=(head + ledger, head))
    pull = draw(size=(rollers, head + ledger, block))
    by_head = draw(size=(rollers, block, head))
    within = draw(size=(rollers, block, block))
    return python_system(
        lambda t, h: own @ h,
        head,
        roller_rates=(
            lambda t, h, r: (
                by_head @ h + np.einsum("zij,zj->zi", within, r),
                np.einsum("zij,zj->zi", pull, r),
            )
        )
        if rollers
        else None,
        rollers=rollers,
        block=block,
        ledger=ledger,
        autonomous=True,
    )


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("shift", [0.3, 1e4])
def test_the_arrow_is_solved_as_numpy_solves_the_dense_matrix(shape, shift):
    system = System(linear(*shape))
    right = np.random.default_rng(3).normal(size=system.n)
    y = np.zeros(system.n)
    matrix = shift * np.eye(system.n) - system.jacobian(0.0, y)
    x, _ = system.solve(0.0, y, shift, right)
    expected = np.linalg.solve(matrix, right)
    # the head is eliminated last, without exchanging rows across blocks: some digits more than the condition may go
    limit = 1e-15 * np.linalg.cond(matrix) * 1e2
    assert np.linalg.norm(x - expected) <= limit * np.linalg.norm(expected)
    assert np.linalg.norm(matrix @ x - right) <= 1e-11 * np.linalg.norm(matrix) * np.linalg.norm(x)


def test_rows_are_exchanged_within_the_head_and_within_a_block():
    """A matrix without a diagonal: [0 1; -1 0] for the head, for a block, and for both."""
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    system = System(
        python_system(
            lambda t, h: turn @ h,
            2,
            roller_rates=lambda t, h, r: (r @ turn.T, np.zeros((3, 2))),
            rollers=3,
            block=2,
        )
    )
    x, _ = system.solve(0.0, np.zeros(8), 0.0, np.arange(8.0))
    np.testing.assert_allclose(x, np.array([[1, 0], [3, -2], [5, -4], [7, -6]]).ravel(), atol=1e-10)


def test_a_singular_matrix_is_refused():
    system = System(python_system(lambda t, y: y, 2))
    with pytest.raises(ArithmeticError, match="1 - df/dy has a singular block at t = 0"):
        system.solve(0.0, np.zeros(2), 1.0, np.ones(2))


def test_operations_grow_in_proportion_to_the_rollers():
    """The work of factors and solution is a + b Z: third differences and second ones vanish exactly."""
    spent = {}
    for rollers in (10, 100, 190, 1000):
        system = System(arrow(rollers))
        y = np.ones(system.n)
        spent[rollers] = system.solve(0.0, y, 10.0, y)[1]
    assert spent[190] - spent[100] == spent[100] - spent[10] > 0
    assert spent[1000] - spent[100] == 10 * (spent[100] - spent[10])
    # a matrix of m by n takes a vector in m n multiplications, and factors in n^3
    H = HEAD
    B = BLOCK
    L = LEDGER
    factors = B**3 + B * B * H + H * B * H
    solution = B * B + H * B + B * H + L * B
    assert spent[100] - spent[10] == 90 * (factors + solution)
    assert spent[10] == 10 * (factors + solution) + H**3 + H * H + L * H + L


# What is refused -----------------------------------------------------------------------------------------------------


def test_what_is_no_system_is_refused():
    for kind in (System, lambda capsule: Rosenbrock(capsule, 0.0, [1.0], 1.0)):
        with pytest.raises(TypeError, match=r"a capsule named 'rollslip\.system\.v1', got 3"):
            kind(3)


@pytest.mark.parametrize(
    ("keywords", "sentence"),
    [
        ({"rollers": 3, "block": 1}, "roller_rates, rollers and block come together"),
        ({"roller_rates": len, "rollers": 3}, "roller_rates, rollers and block come together"),
        ({"watch": len}, "watch and watched come together"),
        ({"ledger": 1, "jacobian": len}, "a system without rollers and ledger only"),
        ({"scale": [1.0, 0.0]}, r"scale must be finite and above 0, got \[1. 0.\]"),
        ({"scale": np.nan}, "scale must be finite and above 0"),
    ],
)
def test_a_system_that_does_not_fit_together_is_refused(keywords, sentence):
    with pytest.raises(ValueError, match=sentence):
        python_system(lambda t, y: y, 2, **keywords)


def test_arrays_that_do_not_fit_are_refused():
    system = System(arrow(2))
    with pytest.raises(
        ValueError, match=r"the system has 10 unknowns, got an array of shape \(9,\)"
    ):
        system(0.0, np.ones(9))
    with pytest.raises(ValueError, match="unknown 3 is not finite"):
        system(0.0, np.where(np.arange(10) == 3, np.inf, 1.0))
    with pytest.raises(ValueError, match="the right-hand side must be 10 numbers, got 3"):
        system.solve(0.0, np.ones(10), 1.0, np.ones(3))


def good_rollers(t, head, own):
    return own, np.zeros((2, 1))


@pytest.mark.parametrize(
    ("head_rates", "roller_rates", "error", "sentence"),
    [
        (
            lambda t, h: np.ones(2),
            good_rollers,
            ValueError,
            r"the rates must have the shape \(1,\), got \(2,\)",
        ),
        (lambda t, h: h * 1j, good_rollers, TypeError, "the rates must be real, got complex128"),
        (
            lambda t, h: h,
            lambda t, h, r: (r.T, r[:, :1]),
            ValueError,
            r"the rollers' rates must .* \(2, 3\), got \(3, 2\)",
        ),
        (
            lambda t, h: h,
            lambda t, h, r: (r, r),
            ValueError,
            r"what the rollers add must .* \(2, 1\), got \(2, 3\)",
        ),
        (lambda t, h: {}["speed"], good_rollers, KeyError, "speed"),
    ],
)
def test_a_fault_in_a_python_function_comes_out_as_it_is(head_rates, roller_rates, error, sentence):
    system = System(python_system(head_rates, 1, roller_rates=roller_rates, rollers=2, block=3))
    for requested in (system.rates, system.jacobian):
        with pytest.raises(error, match=sentence):
            requested(0.0, np.ones(7))


def test_watched_values_are_asked_for_and_their_faults_come_out():
    system = System(python_system(lambda t, y: y, 2, watch=lambda t, y: [y[0] - t], watched=1))
    assert system.watch(0.5, [2.0, 1.0]).tolist() == [1.5]
    bad = System(python_system(lambda t, y: y, 2, watch=lambda t, y: y, watched=1))
    with pytest.raises(
        ValueError, match=r"the watched values must have the shape \(1,\), got \(2,\)"
    ):
        bad.watch(0.0, [1.0, 1.0])


def test_a_refusal_carries_its_reason():
    def rates(t, y):
        raise RefusedError("too fast", reason=("input", 1, "rolling_speed", 4))

    system = System(python_system(rates, 1))
    with pytest.raises(RefusedError, match=r"the rates are not defined at t = 0\.5") as refused:
        system(0.5, [1.0])
    assert refused.value.reason == system.refusal() == ("input", 1, "rolling_speed", 4)


def test_functions_may_keep_their_arrays():
    kept = []

    def rates(t, y):
        kept.append(y)
        return y

    system = System(python_system(rates, 2))
    system.jacobian(0.0, [1.0, 2.0])
    assert kept[0].tolist() == [1.0, 2.0]
    assert len({array.ctypes.data for array in kept}) == len(kept)


def test_a_capsule_keeps_its_owner_and_no_longer():
    class Rates:
        def __call__(self, t, y):
            return -y

    rates = Rates()
    gone = weakref.ref(rates)
    system = System(python_system(rates, 1))
    del rates
    gc.collect()
    assert system(0.0, [2.0]).tolist() == [-2.0]
    del system
    gc.collect()
    assert gone() is None
