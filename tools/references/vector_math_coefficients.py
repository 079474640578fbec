"""Make the coefficients of rollslip_math.h: interpolation at Chebyshev nodes in 60 digits; prints them and their error.

Interpolation at these nodes is within a factor of two of the best polynomial, and needs no iteration.
"""

import mpmath as mp

mp.mp.dps = 60


def fit(function, low, high, degree):
    """Coefficients, lowest first, of the polynomial through Chebyshev's nodes."""
    middle = (low + high) / 2
    half = (high - low) / 2
    nodes = [
        middle + half * mp.cos(mp.pi * (2 * k + 1) / (2 * degree + 2)) for k in range(degree + 1)
    ]
    matrix = mp.matrix(degree + 1, degree + 1)
    for i, x in enumerate(nodes):
        for j in range(degree + 1):
            matrix[i, j] = x**j
    return list(mp.lu_solve(matrix, mp.matrix([function(x) for x in nodes])))


def worst(function, coefficients, low, high):
    """Largest relative error of the polynomial."""
    places = [low + (high - low) * k / mp.mpf(997) for k in range(998)]
    return max(abs(mp.polyval(coefficients[::-1], x) / function(x) - 1) for x in places)


def without_zero(function, value):
    """Give the function its limit at 0."""
    return lambda x: value if x == 0 else function(x)


LN2 = mp.log(2)
HALF = LN2 / 2 * (1 + mp.mpf(2) ** -20)
REACH = (mp.sqrt(2) - 1) ** 2 / (mp.sqrt(2) + 1) ** 2 * (1 + mp.mpf(2) ** -20)


def tail(first):
    """Rest of 2 artanh(sqrt z)/sqrt z from the term z^first on, over z^first."""
    return lambda z: (
        mp.nsum(lambda k: 2 * z**k / (2 * (k + first) + 1), [0, mp.inf])
        if z
        else 2 / mp.mpf(2 * first + 1)
    )


#: name -> (what, low, high, degree)
FITS = {
    # exp(f) = 1 + f + f^2 E(f)
    "EXP": (without_zero(lambda f: (mp.expm1(f) - f) / f**2, mp.mpf(1) / 2), -HALF, HALF, 9),
    # 2^f = 1 + f P(f)
    "EXP2": (without_zero(lambda f: mp.expm1(f * LN2) / f, LN2), -mp.mpf(1) / 2, mp.mpf(1) / 2, 10),
    # 2 artanh(s) = 2 s + s z A(z), z = s^2
    "ARTANH": (tail(1), mp.mpf(0), REACH, 6),
    # 2 artanh(s)/ln 2 = s (2/ln2 + z C(z))
    "LOG2": (lambda z: tail(1)(z) / LN2, mp.mpf(0), REACH, 6),
    # 2 artanh(s) = 2 s + 2/3 s z + s z^2 B(z)
    "ARTANH2": (tail(2), mp.mpf(0), REACH, 7),
}

if __name__ == "__main__":
    for name, (function, low, high, degree) in FITS.items():
        rounded = [mp.mpf(float(c)) for c in fit(function, low, high, degree)]
        print(f"/* {name}: {mp.nstr(worst(function, rounded, low, high), 2)} */")
        print(",\n".join(float(c).hex() for c in rounded))
    for name, value in {
        "2/ln2": 2 / LN2,
        "2/(3 ln2)": 2 / (3 * LN2),
        "ln2": LN2,
        "1/ln2": 1 / LN2,
    }.items():
        high = mp.mpf(float.fromhex(f"{float(value).hex()}"))
        print(name, float(value).hex(), float(value - high).hex())
