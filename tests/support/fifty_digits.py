"""The published laws in mpmath with 50 digits: what the hard cases are judged by.

- Written from the formulas as published, with the numbers as printed, and not from the program: where the program
  rearranges a law to keep digits, the plain form stands here and precision is what saves it.
- `exact` takes the members of one slice as the very floats that the program got, and gives what a stage fills.
- An implicit law is solved in ln x, in which its residual rises; that the residual vanishes is asserted.
"""

from functools import cache

from mpmath import mp, mpf

#: Decimal digits: three times those of a double, so that plain forms of the laws may cancel.
DIGITS = 50
PI = mp.pi
STEP = mpf("1e-3")
ROOT = mpf(10) ** -40  # residual in ln x at which an implicit law counts as solved


def exact(name, model, members):
    """Return the columns that a stage fills, for the members of one slice, or None if its law is not known here."""
    law = LAWS.get(name)
    if law is None:
        return None
    with mp.workdps(DIGITS):
        return law(model, {name: mpf(value) for name, value in members.items()})


def solve(residual, start, step=STEP):
    """Root of a rising function by secants from a start near it, kept inside the bracket found so far."""
    old = start - step
    new = start
    value_old = residual(old)
    value = residual(new)
    ends = [-mp.inf, mp.inf]
    for _ in range(300):
        for at, found in ((old, value_old), (new, value)):
            if found < 0:
                ends[0] = max(ends[0], at)
            else:
                ends[1] = min(ends[1], at)
        if abs(value) < ROOT or value == value_old:
            break
        following = new - value * (new - old) / (value - value_old)
        if not ends[0] < following < ends[1]:
            following = (
                (ends[0] + ends[1]) / 2
                if mp.isfinite(ends[1] - ends[0])
                else new - 10 * mp.sign(value) * abs(step)
            )
        old = new
        new = following
        value_old = value
        value = residual(new)
    assert abs(value) < ROOT * 100 * max(1, abs(new)), (start, new, value)
    return new


def fixed_point(law, cold, newton, softening):
    """Root x > 0 of x = law(x), where the law falls and is at most ``cold`` and newton exp(-softening x)."""
    start = min(cold, mp.lambertw(softening * newton).real / softening) if softening else cold
    return mp.exp(solve(lambda x: x - mp.log(law(mp.exp(x))), mp.log(start)))


# Contact -------------------------------------------------------------------------------------------------------------


def hertz(model, m):
    half_width = mp.sqrt(8 * m["load"] * m["radius"] / (PI * m["modulus"]))
    return {"half_width": half_width, "pressure": m["load"] / (2 * half_width)}


def palmgren(m):
    """delta[mm] = 3.84e-5 Q^0.9/l^0.8: approach [m] of a load per length [N/m]."""
    l = m["length"] * 1000  # noqa: E741
    return lambda w: mpf("3.84e-8") * (w * m["length"]) ** mpf("0.9") / l ** mpf("0.8")


def iso16281(m):
    """Q = 35948 l^(8/9) delta^(10/9) [N, mm] of two equal contacts in series."""
    l = m["length"] * 1000  # noqa: E741
    return lambda w: (w * m["length"] / (35948 * l ** (mpf(8) / 9))) ** mpf("0.9") / 2000


def lundberg(m):
    """delta = 4 w/(pi E') (1/2 + ln(2 l/b))."""
    return lambda w: (
        4
        * w
        / (PI * m["modulus"])
        * (mpf(1) / 2 + mp.log(2 * m["length"] / hertz(None, m | {"load": w})["half_width"]))
    )


def load_of(approach_of, approach):
    """Invert a law of deflection: load per length and stiffness of an approach."""
    if approach <= 0:
        return mpf(0), mpf(0)
    w = mp.exp(
        solve(lambda x: mp.log(approach_of(mp.exp(x)) / approach), mp.log(approach * mpf(10) ** 10))
    )
    step = mpf(10) ** -15
    rise = mp.log(approach_of(w * (1 + step)) / approach_of(w * (1 - step))) / (2 * step)
    return w, w / (approach * rise)


def deflection(approach_of):
    def law(model, m):
        load, stiffness = load_of(approach_of(m), m["approach"])
        return {"load": load, "stiffness": stiffness}

    return law


#: Contact model -> its law of deflection, m -> (w -> approach).
DEFLECTIONS = {"palmgren": palmgren, "iso16281": iso16281, "lundberg": lundberg}


# Film ----------------------------------------------------------------------------------------------------------------

#: Model -> c, u, g, w of h/R = c U^u G^g W^w, as published.
POWERS = {
    "martin": ("4.89497", "1", "0", "-1"),
    "blok": ("1.66630", "2/3", "2/3", "0"),
    "herrebrugh": ("3.10", "0.6", "0", "-0.2"),
    "dowson-higginson": ("1.6", "0.7", "0.6", "-0.13"),
    "dowson-1968": ("2.65", "0.70", "0.54", "-0.13"),
    "dowson-toyoda": ("3.06", "0.69", "0.56", "-0.10"),
    "pan-hamrock": ("1.714", "0.694", "0.568", "-0.128"),
}


def groups(m):
    """U, G, W with the mean entrainment speed."""
    stiffness = m["modulus"] * m["radius"]
    return (
        m["viscosity"] * m["rolling_speed"] / stiffness,
        m["pressure_viscosity"] * m["modulus"],
        m["load"] / stiffness,
    )


def power(name, m):
    c, u, g, w = map(mpf, POWERS[name])
    U, G, W = groups(m)
    return c * m["radius"] * U**u * (G**g if g else 1) * W**w


def power_film(model, m):
    assert model.name != "pan-hamrock" or model.thickness == "minimum"
    return {"film_thickness": power(model.name, m)}


def moes(model, m):
    U, G, W = groups(m)
    root = mp.sqrt(2 * U)
    M = W / root
    L = G * mp.sqrt(root)
    ri = 3 / M
    ei = mpf("2.621") * M ** mpf("-0.2")
    isoviscous = (ri ** (mpf(7) / 3) + ei ** (mpf(7) / 3)) ** (mpf(3) / 7)
    s = (7 + 8 * mp.exp(-2 * ei / ri)) / 5
    if L == 0:
        return {"film_thickness": m["radius"] * root * isoviscous}
    rp = mpf("1.287") * L ** (mpf(2) / 3)
    ep = mpf("1.311") * M ** mpf("-0.125") * L ** mpf("0.75")
    piezoviscous = (rp ** mpf("-3.5") + ep ** mpf("-3.5")) ** (mpf(-2) / 7)
    return {"film_thickness": m["radius"] * root * (isoviscous**s + piezoviscous**s) ** (1 / s)}


def regime(model, m):
    ir, vr, ie, ve = (power(name, m) for name in ("martin", "blok", "herrebrugh", "dowson-1968"))
    isoviscous = max(ir, ie)
    piezoviscous = min(vr, ve)
    code = (3 if ve < vr else 1) if piezoviscous > isoviscous else (2 if ie > ir else 0)
    return {"film_thickness": max(isoviscous, piezoviscous), "regime": mpf(code)}


# Viscosity under pressure --------------------------------------------------------------------------------------------


def barus(model, m):
    return {
        "film_viscosity": m["viscosity"] * mp.exp(m["pressure_viscosity"] * m["pressure"]),
        "film_thermoviscosity": m["thermoviscosity"]
        + m["pressure_thermoviscosity"] * m["pressure"],
    }


def roelands(model, m):
    """-dln(eta)/dT by the chain rule from eta0(T) and alpha(T)."""
    pole = 1 / mpf("5.1e-9")
    k = mp.log(m["viscosity"]) + mpf("9.67")
    x = mp.log(1 + m["pressure"] / pole)
    z = m["pressure_viscosity"] * pole / k
    rise = mp.exp(z * x)
    slope = m["thermoviscosity"] * rise + k * rise * x * (
        m["pressure_thermoviscosity"] * pole / k
        - m["pressure_viscosity"] * pole * m["thermoviscosity"] / k**2
    )
    return {
        "film_viscosity": m["viscosity"] * mp.exp(k * (rise - 1)),
        "film_thermoviscosity": slope,
    }


def yasutomi(model, m):
    """The WLF law at pressure over that at none, and its slope by the quotient rule."""
    tg0, a1, a2, b1, b2, c1, c2 = (
        mpf(getattr(model, name))
        for name in ("glass_temperature", "a1", "a2", "b1", "b2", "c1", "c2")
    )

    def fraction(p):
        return 1 - b1 * mp.log(1 + b2 * p)

    def above(p):
        return (m["temperature"] - tg0 - a1 * mp.log(1 + a2 * p)) * fraction(p)

    def log_viscosity(p):
        return -mp.log(10) * c1 * above(p) / (c2 + above(p))

    def fall(p):
        return mp.log(10) * c1 * c2 * fraction(p) / (c2 + above(p)) ** 2

    p = m["pressure"]
    return {
        "film_viscosity": m["viscosity"] * mp.exp(log_viscosity(p) - log_viscosity(mpf(0))),
        "film_thermoviscosity": m["thermoviscosity"] + fall(p) - fall(mpf(0)),
    }


# Stress of an Eyring fluid -------------------------------------------------------------------------------------------


def muraki_stress(sigma, deborah, heating):
    """(D Phi/4) y^2 - (1 + Phi sigma) y + asinh(sigma) = 0, S = y - D y^2/(4 sigma), or sigma/D without a plateau."""
    s, d, phi = map(mpf, (sigma, deborah, heating))
    if s == 0:
        return mpf(0)
    a = 1 + phi * s
    plateau = mp.asinh(s)
    discriminant = a * a - d * phi * plateau
    if discriminant < 0:
        return s / d
    y = 2 * plateau / (a + mp.sqrt(discriminant))
    return s / d if y * d > 2 * s else y - d * y * y / (4 * s)


@cache
def eyring_stress(sigma, heating):
    """sinh(S) exp(Phi sigma S) = sigma."""
    s = mpf(sigma)
    w = mpf(heating) * mpf(sigma)
    return fixed_point(lambda x: mp.asinh(s * mp.exp(-w * x)), mp.asinh(s), s, w) if s else mpf(0)


@cache
def maxwell_eyring_stress(sigma, deborah, heating):
    """Mean over X in [0, 2] of D dS/dX + exp(y) sinh S = sigma, S(0) = 0, y = Phi sigma mean(S), in dilogarithms."""
    s, d, phi = map(mpf, (sigma, deborah, heating))
    if s == 0:
        return mpf(0)
    if d == 0:
        return eyring_stress(sigma, heating)
    w = phi * s
    return (
        fixed_point(lambda x: _mean(s, d, w * x), min(mp.asinh(s), s / d), s, w)
        if w
        else _mean(s, d, mpf(0))
    )


def _mean(s, d, y):
    eps = s * mp.exp(-y)
    c = mp.sqrt(1 + eps**2)
    p = 2 * mp.exp(y) / d
    if eps < mpf(10) ** -40:  # linear viscoelastic, to eps^2
        return eps * (1 + mp.expm1(-p) / p if p > mpf(10) ** -20 else p / 2 - p**2 / 6)
    if p > mpf(10) ** 60:  # all plateau
        return mp.asinh(eps)
    lost = 3 * max(0, -mp.log10(p)) + 3 * abs(mp.log10(eps))  # digits that the closed form cancels
    with mp.workdps(60 + int(lost)):
        eps = s * mp.exp(-y)
        c = mp.sqrt(1 + eps**2)
        p = 2 * mp.exp(y) * c / d
        t = eps / (1 + c)
        a = t / (eps + c)
        b = t * (eps + c)
        q = mp.exp(-p)
        terms = mp.polylog(2, a) - mp.polylog(2, a * q) - mp.polylog(2, -b) + mp.polylog(2, -b * q)
        return mp.asinh(eps) - mp.re(terms) / p


# Traction ------------------------------------------------------------------------------------------------------------


def _odd(law):
    """A law of positive sliding speeds for both signs, zero at zero."""

    def friction(model, m):
        speed = m["sliding_speed"]
        if speed == 0:
            return {"friction": mpf(0)}
        found = law(model, m | {"sliding_speed": abs(speed)})
        return None if found is None else {"friction": found * mp.sign(speed)}

    return friction


def _resistance(model, m):
    """Temperature rise of a film per rate of heat, zeta = flash sqrt(b/(pi u))/sqrt(K rho c) + h/(12 K_f)."""
    surfaces = (
        mpf(model.flash) * mp.sqrt(m["half_width"] / (PI * m["rolling_speed"])) / m["effusivity"]
    )
    return surfaces + m["film_thickness"] / (12 * m["conductivity"])


def _eyring_fluid(stress):
    @_odd
    def law(model, m):
        eta = m["film_viscosity"]
        tau0 = m["eyring_stress"]
        h = m["film_thickness"]
        sigma = eta * m["sliding_speed"] / (tau0 * h)
        heating = m["film_thermoviscosity"] * _resistance(model, m) * tau0**2 * h / eta
        deborah = (
            eta * m["rolling_speed"] / (m["shear_modulus"] * m["half_width"])
            if "shear_modulus" in m
            else mpf(0)
        )
        return tau0 / m["pressure"] * stress(sigma, deborah, heating)

    return law


def _all_digits(law):
    """A law in s = V/u whose terms cancel for small s, in so many more digits."""

    def friction(model, m):
        x = m["sliding_speed"] / m["rolling_speed"]
        with mp.workdps(DIGITS + int(abs(mp.log10(x)))):
            return law(model, x)

    return _odd(friction)


@_all_digits
def kragelsky(model, x):
    limit = mpf(model.limit)
    rise = mpf(model.rise)
    decay = mpf(model.decay)
    return (-limit + rise * x) * mp.exp(-decay * x) + limit


@_odd
def constant(model, m):
    x = m["sliding_speed"] / m["rolling_speed"] / mpf(model.transition)
    return mpf(model.coefficient) * min(x, 1)


@_all_digits
def gupta(model, x):
    a, b, c, d = map(mpf, (model.a, model.b, model.c, model.d))
    return (a + b * x) * mp.exp(-c * x) + d - (a + d) * max(0, 1 - x / mpf(model.transition))


def _cold(m):
    """Stress of a cold Newtonian film."""
    return m["film_viscosity"] * m["sliding_speed"] / m["film_thickness"]


@_odd
def carreau(model, m):
    newtonian = _cold(m)
    n = mpf(model.exponent)
    critical = mpf(model.critical_stress)
    softening = m["film_thermoviscosity"] * _resistance(model, m) * m["sliding_speed"]

    def law(tau):
        warm = newtonian * mp.exp(-softening * tau)
        return warm * (1 + (warm / critical) ** 2) ** ((n - 1) / 2)

    return fixed_point(law, newtonian, newtonian, softening) / m["pressure"]


def _couette(thinning):
    @_odd
    def law(model, m):
        newtonian = _cold(m)
        beta = m["film_thermoviscosity"]
        speed = m["sliding_speed"]
        flash = (
            mpf(model.flash)
            * mp.sqrt(m["half_width"] / (PI * m["rolling_speed"]))
            / m["effusivity"]
        )

        def stress(tau):
            fraction = mp.exp(-beta * flash * tau * speed) * thinning(tau, m)
            x = mp.sqrt(beta * m["film_viscosity"] * fraction * speed**2 / (8 * m["conductivity"]))
            return newtonian * fraction * (mp.asinh(x) / (x * mp.sqrt(1 + x * x)) if x else 1)

        return fixed_point(stress, newtonian, newtonian, beta * flash * speed) / m["pressure"]

    return law


def _eyring_thinning(tau, m):
    x = tau / m["eyring_stress"]
    return x / mp.sinh(x)


def lambda_blend(model, m):
    boundary, hydrodynamic = (
        LAWS.get(child.name) for child in (model.boundary, model.hydrodynamic)
    )
    if boundary is None or hydrodynamic is None:
        return None
    ratio = m["film_thickness"] / m["roughness"]
    low = mpf(model.boundary_limit)
    high = mpf(model.hydrodynamic_limit)
    fraction = min(max((ratio - high) / (low - high), mpf(0)), mpf(1)) ** mpf(model.exponent)
    full = hydrodynamic(model.hydrodynamic, m)["friction"] if fraction < 1 else mpf(0)
    rough = boundary(model.boundary, m)["friction"] if fraction > 0 else mpf(0)
    return {"friction": full + (rough - full) * fraction}


#: Model, or "MODEL deflection" -> its law.
LAWS = {
    **{f"{name} deflection": deflection(law) for name, law in DEFLECTIONS.items()},
    **dict.fromkeys(("palmgren", "iso16281", "lundberg"), hertz),
    **dict.fromkeys(POWERS, power_film),
    "moes": moes,
    "regime": regime,
    "barus": barus,
    "roelands": roelands,
    "yasutomi": yasutomi,
    "muraki": _eyring_fluid(muraki_stress),
    "maxwell-eyring": _eyring_fluid(maxwell_eyring_stress),
    "eyring": _eyring_fluid(lambda sigma, _, heating: eyring_stress(sigma, heating)),
    "kragelsky": kragelsky,
    "constant": constant,
    "gupta": gupta,
    "carreau": carreau,
    "newtonian-thermal": _couette(lambda tau, m: mpf(1)),
    "eyring-thermal": _couette(_eyring_thinning),
    "lambda-blend": lambda_blend,
}
