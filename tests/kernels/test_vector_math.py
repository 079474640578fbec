"""The elementary functions of the kernels: worst error over their range against mpmath, on every instruction set."""

import mpmath
import numpy as np
import pytest

from rollslip_kernels.stages import simd, vector_math

mpmath.mp.dps = 40

INF = np.inf
NAN = np.nan
#: The smallest number above zero, 2^-1074.
TINY = 5e-324
MOST = np.finfo(float).max


def spread(rng, low, high, n, *, both=False):
    """Return n numbers whose magnitudes are uniform in the exponent."""
    values = 2.0 ** rng.uniform(np.log2(low), np.log2(high), n)
    return values * rng.choice([-1.0, 1.0], n) if both else values


def near_one(rng, n):
    """Return n numbers at distances from 1 that are uniform in the exponent."""
    return 1.0 + spread(rng, 2.0**-52, 0.4, n, both=True)


#: function -> (exact, samples of its range and of where it errs most, worst error that rollslip_math.h states [ulp])
FUNCTIONS = {
    "exp": (mpmath.exp,
            lambda r, n: np.concatenate([r.uniform(-745, 709.7, n), spread(r, 1e-18, 1, n, both=True)]), 1.1),
    "exp2": (lambda x: mpmath.mpf(2) ** x,
             lambda r, n: np.concatenate([r.uniform(-1075, 1024, n), spread(r, 1e-18, 1, n, both=True)]), 1.2),
    "expm1": (mpmath.expm1,
              lambda r, n: np.concatenate(
        [r.uniform(-60, 709.7, n), spread(r, 1e-310, 40, n, both=True), r.uniform(0.34, 0.42, n)]), 2.5),
    "log": (mpmath.log, lambda r, n: np.concatenate([spread(r, 1e-320, MOST, n), near_one(r, n)]), 1.2),
    "log2": (lambda x: mpmath.log(x, 2),
             lambda r, n: np.concatenate([spread(r, 1e-320, MOST, n), near_one(r, n)]), 1.5),
    "log1p": (mpmath.log1p, lambda r, n: np.concatenate(
        [spread(r, 1e-310, MOST, n), -spread(r, 1e-310, 1, n), spread(r, 2.0**-52, 0.4, n) - 1.0,
         r.uniform(0.41, 0.48, n)]), 2.0),
    "asinh": (mpmath.asinh, lambda r, n: np.concatenate(
        [spread(r, 1e-310, MOST, 2 * n, both=True), r.uniform(0.35, 0.42, n)]), 5.0),
}  # fmt: skip

every_set = pytest.mark.parametrize("path", simd.available())
every_function = pytest.mark.parametrize("name", FUNCTIONS)


def ulps(computed, exact):
    """Return the error in units of the last place of the exact value, as a double would have it."""
    worst = 0.0
    where = None
    for k, (value, truth) in enumerate(zip(computed.tolist(), exact, strict=True)):
        nearest = float(truth)
        if not np.isfinite(nearest) or not np.isfinite(value):
            assert value == nearest, (k, value, nearest)
            continue
        error = abs(
            float((mpmath.mpf(value) - truth) / mpmath.mpf(float(np.spacing(abs(nearest)))))
        )
        if error > worst:
            worst = error
            where = k
    return worst, where


def error_of(name, path, n, seed=1):
    exact, samples, _ = FUNCTIONS[name]
    x = samples(np.random.default_rng(seed), n)
    worst, where = ulps(
        getattr(vector_math, name)(x, simd=path), [exact(mpmath.mpf(v)) for v in x.tolist()]
    )
    return worst, x[where]


@every_set
@every_function
def test_worst_error_over_the_whole_range(name, path):
    worst, at = error_of(name, path, 1000)
    assert worst <= FUNCTIONS[name][2], at


def powers(rng, n):
    """Pairs whose power is neither 0 nor infinite: any exponent, then bases for it; and bases near 1."""
    y = spread(rng, 1e-3, 1e3, n, both=True)
    x = 2.0 ** np.clip(rng.uniform(-1070, 1023.9, n) / y, -1074, 1023.9)
    near = near_one(rng, n)
    return np.concatenate([x, near]), np.concatenate([y, rng.uniform(-700, 700, n) / np.log(near)])


def pow_error(path, n, seed=1):
    x, y = powers(np.random.default_rng(seed), n)
    exact = [mpmath.mpf(a) ** mpmath.mpf(b) for a, b in zip(x.tolist(), y.tolist(), strict=True)]
    worst, where = ulps(vector_math.pow(x, y, simd=path), exact)
    return worst, x[where], y[where]


@every_set
def test_worst_error_of_powers(path):
    worst, *at = pow_error(path, 4000)
    assert worst <= 1.3, at


@every_set
def test_worst_error_of_what_is_added_to_a_logarithm(path):
    """2^x relative, log2(1 + x) absolute."""
    rng = np.random.default_rng(4)
    x = np.concatenate([-rng.uniform(0, 3, 2000), -rng.uniform(0, 1000, 2000), [0.0, -1000.0]])
    falling = vector_math.exp2_falling(x, simd=path)
    assert (
        max(
            abs(float(v / mpmath.mpf(2) ** mpmath.mpf(at) - 1))
            for v, at in zip(falling, x, strict=True)
        )
        <= 2e-16
    )
    y = np.concatenate([rng.uniform(0, 1, 2000), spread(rng, 1e-300, 1, 2000), [0.0, 1.0]])
    plus_one = vector_math.log2p1(y, simd=path)
    exact = [mpmath.log1p(mpmath.mpf(at)) / mpmath.log(2) for at in y]
    assert max(abs(float(v - truth)) for v, truth in zip(plus_one, exact, strict=True)) <= 4e-16
    assert vector_math.exp2_falling([-1e308, -INF], simd=path).tolist() == [2.0**-1000] * 2


@every_set
def test_short_forms_have_the_bits_of_the_long_ones(path):
    """Stages take them for whole blocks, and a neighbour that needs the long form may change no bit of a slice."""
    rng = np.random.default_rng(5)
    x = np.concatenate(
        [
            rng.uniform(-700, 700, 4000),
            spread(rng, 1e-300, 700, 4000, both=True),
            [0.0, -700.0, 700.0],
        ]
    )
    assert vector_math.exp_normal(x, simd=path).tobytes() == vector_math.exp(x, simd=path).tobytes()


@every_set
def test_expm1_of_what_is_not_positive(path):
    """As good as expm1 is; below -693 it is -1 as well."""
    rng = np.random.default_rng(6)
    x = -np.concatenate([rng.uniform(0, 60, 3000), spread(rng, 1e-300, 40, 3000), [0.0]])
    worst, where = ulps(
        vector_math.expm1_falling(x, simd=path), [mpmath.expm1(mpmath.mpf(v)) for v in x.tolist()]
    )
    assert worst <= FUNCTIONS["expm1"][2], x[where]
    assert vector_math.expm1_falling([-693.5, -1e308, -INF], simd=path).tolist() == [-1.0] * 3


# Where the range ends -------------------------------------------------------------------------------------------------

#: function -> {argument: exact result}
ENDS = {
    "exp": {
        0.0: 1.0,
        -INF: 0.0,
        INF: INF,
        709.79: INF,
        -745.2: 0.0,
        -1e308: 0.0,
        MOST: INF,
        NAN: NAN,
    },
    "exp2": {
        0.0: 1.0,
        -INF: 0.0,
        INF: INF,
        1024.0: INF,
        1023.0: 2.0**1023,
        -1074.0: TINY,
        -1076.0: 0.0,
        NAN: NAN,
    },
    "expm1": {
        0.0: 0.0,
        -INF: -1.0,
        INF: INF,
        709.79: INF,
        -1e308: -1.0,
        TINY: TINY,
        -1e-310: -1e-310,
        NAN: NAN,
    },
    "log": {1.0: 0.0, 0.0: -INF, INF: INF, -1.0: NAN, -INF: NAN, -TINY: NAN, NAN: NAN},
    "log2": {
        1.0: 0.0,
        0.0: -INF,
        INF: INF,
        TINY: -1074.0,
        2.0**1023: 1023.0,
        0.5: -1.0,
        -1.0: NAN,
        NAN: NAN,
    },
    "log1p": {
        0.0: 0.0,
        -1.0: -INF,
        INF: INF,
        -1.5: NAN,
        -INF: NAN,
        TINY: TINY,
        -1e-310: -1e-310,
        NAN: NAN,
    },
    "asinh": {0.0: 0.0, INF: INF, -INF: -INF, TINY: TINY, -1e-310: -1e-310, NAN: NAN},
}
POWERS = {
    (0.0, 2.0): 0.0, (0.0, -2.0): INF, (0.0, 0.0): 1.0, (INF, 2.0): INF, (INF, -2.0): 0.0, (INF, 0.0): 1.0,
    (2.0, INF): INF, (2.0, -INF): 0.0, (0.5, INF): 0.0, (0.5, -INF): INF, (1.0, INF): 1.0, (1.0, 1e308): 1.0,
    (3.0, 0.0): 1.0, (2.0, 1e308): INF, (0.5, 1e308): 0.0, (TINY, 1.0): TINY, (TINY, 0.5): 2.0**-537,
    (2.0, -1074.0): TINY, (2.0, 1023.0): 2.0**1023, (1.0000000000000002, 1e300): INF, (-1.0, 2.0): NAN,
    (-INF, 1.0): NAN,
    (NAN, 1.0): NAN, (1.0, NAN): NAN, (NAN, 0.0): NAN, (0.0, INF): 0.0, (0.0, -INF): INF, (INF, INF): INF,
}  # fmt: skip


@every_set
@every_function
def test_ends_of_the_range(name, path):
    x = np.array(list(ENDS[name]))
    np.testing.assert_array_equal(
        getattr(vector_math, name)(x, simd=path), list(ENDS[name].values())
    )


@every_set
def test_ends_of_powers(path):
    x, y = np.array(list(POWERS)).T
    np.testing.assert_array_equal(vector_math.pow(x, y, simd=path), list(POWERS.values()))


@every_set
@pytest.mark.parametrize("name", ["expm1", "log1p", "asinh"])
def test_zero_keeps_its_sign(name, path):
    assert np.signbit(getattr(vector_math, name)(-0.0, simd=path))


@every_function
def test_all_sets_that_fuse_give_the_same_bits_and_all_do_for_any_length(name):
    x = FUNCTIONS[name][1](np.random.default_rng(2), 500)
    widest = getattr(vector_math, name)(x, simd=simd.available()[-1]).tobytes()
    for path in simd.available():
        function = getattr(vector_math, name)
        whole = function(x, simd=path).tobytes()
        assert path == "baseline" or whole == widest
        assert (
            b"".join(function(x[k : k + 7], simd=path).tobytes() for k in range(0, len(x), 7))
            == whole
        )


def test_shapes_are_kept_and_checked():
    assert vector_math.exp(np.zeros((2, 0, 3))).shape == (2, 0, 3)
    assert vector_math.pow(np.ones((2, 3)), np.ones((2, 3))).shape == (2, 3)
    with pytest.raises(ValueError, match="one shape"):
        vector_math.pow([1.0, 2.0], [1.0])


@pytest.mark.soak
@every_function
def test_worst_error_over_the_whole_range_long(name):
    worst, at = error_of(name, simd.active(), 100_000, seed=3)
    assert worst <= FUNCTIONS[name][2], at


@pytest.mark.soak
def test_worst_error_of_powers_long():
    worst, *at = pow_error(simd.active(), 100_000, seed=3)
    assert worst <= 1.3, at
