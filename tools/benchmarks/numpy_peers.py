"""The contact chain in NumPy: as a person writes it down from the paper, and as one writes it who counts passes."""

import math

import numpy as np

from constants import constants
from contacts import KRAGELSKY, MURAKI, TRACTION


def textbook(film, given):
    """Formulas as they stand in the paper, its Eq. (8) with the misprint corrected, and np.where for the branches."""
    c = given.conditions
    low = TRACTION.boundary_limit
    high = TRACTION.hydrodynamic_limit

    def moes(U, G, W):
        M = W / np.sqrt(2 * U)
        L = G * (2 * U) ** 0.25
        ri = 3 / M
        rp = 1.287 * L ** (2 / 3)
        ei = 2.621 * M**-0.2
        ep = 1.311 * M**-0.125 * L**0.75
        s = (7 + 8 * np.exp(-2 * ei / ri)) / 5
        isoviscous = (ri ** (7 / 3) + ei ** (7 / 3)) ** (3 * s / 7)
        piezoviscous = (rp ** (-7 / 2) + ep ** (-7 / 2)) ** (-2 * s / 7)
        return c.radius * np.sqrt(2 * U) * (isoviscous + piezoviscous) ** (1 / s)

    def regime(U, G, W):
        ri = 4.89497 * U / W
        rp = 1.66630 * (G * U) ** (2 / 3)
        ei = 3.10 * U**0.6 * W**-0.2
        ep = 2.65 * U**0.7 * G**0.54 * W**-0.13
        return c.radius * np.maximum(np.maximum(ri, ei), np.minimum(rp, ep))

    thickness = {"moes": moes, "regime": regime}[film]

    def friction(load, speed, sliding):
        b = np.sqrt(8 * load * c.radius / (np.pi * c.modulus))
        p = load / (2 * b)
        U = c.viscosity * speed / (c.modulus * c.radius)
        h = thickness(U, c.pressure_viscosity * c.modulus, load / (c.modulus * c.radius))
        eta = c.viscosity * np.exp(c.pressure_viscosity * p)
        V = np.abs(sliding)
        s = V / speed
        sigma = eta * V / (c.eyring_stress * h)
        D = eta * speed / (c.shear_modulus * b)
        zeta = MURAKI.flash * np.sqrt(b / (np.pi * speed)) / c.effusivity + h / (
            12 * c.conductivity
        )
        Phi = (
            (c.thermoviscosity + c.pressure_thermoviscosity * p)
            * zeta
            * c.eyring_stress**2
            * h
            / eta
        )
        a = 1 + Phi * sigma
        L = np.arcsinh(sigma)
        root = a**2 - D * Phi * L
        S = (D * Phi * L - 2 * a + 2 * np.sqrt(np.maximum(root, 0))) / (D * Phi**2 * sigma)
        y = 2 * (a - np.sqrt(np.maximum(root, 0))) / (D * Phi)
        S = np.where((root < 0) | (y > 2 * sigma / D), sigma / D, S)
        full = c.eyring_stress * S / p
        boundary = (-KRAGELSKY.limit + KRAGELSKY.rise * s) * np.exp(
            -KRAGELSKY.decay * s
        ) + KRAGELSKY.limit
        ratio = h / c.roughness
        mixed = full + (boundary - full) * ((ratio - high) / (low - high)) ** 6
        return np.sign(sliding) * np.where(
            ratio < low, boundary, np.where(ratio >= high, full, mixed)
        )

    result = [None]

    def call():
        mu = friction(given.load, given.rolling_speed, given.sliding_speed)
        result[0] = mu
        return np.sum(mu * given.load) * given.width

    return call, lambda: result[0]


def careful(film, given):
    """In place in ten arrays made once: no temporaries, one pass an operation, shared subexpressions."""
    k = constants(given)
    n = len(given.load)
    w = given.load
    u = given.rolling_speed
    sliding = given.sliding_speed
    b, p, h, v, x, y, z, t, a, mu = np.empty((10, n))
    flag = np.empty(n, dtype=bool)
    band = 1 / (k.hydrodynamic_limit - k.boundary_limit)

    def moes():
        """In logarithms: x is ln sqrt(2 U), y ln M, z H_EI/H_RI, then the sums."""
        np.log(u, out=x)
        np.add(x, math.log(2) + k.log_speed, out=x)
        np.multiply(x, 0.5, out=x)
        np.log(w, out=y)
        np.add(y, k.log_load, out=y)
        np.subtract(y, x, out=y)
        # t: ln(H_EP/H_RP), a: ln H_EP
        np.multiply(x, 0.75 / 2, out=a)
        np.multiply(y, 0.125, out=t)
        np.subtract(a, t, out=a)
        np.multiply(x, 1 / 3, out=t)
        np.subtract(a, t, out=t)
        np.add(t, math.log(1.311 / 1.287) + (0.75 - 2 / 3) * k.log_material, out=t)
        np.add(a, math.log(1.311) + 0.75 * k.log_material, out=a)
        np.multiply(t, 3.5, out=t)
        np.exp(t, out=t)
        np.log1p(t, out=t)
        np.multiply(t, 2 / 7, out=t)
        np.subtract(a, t, out=a)
        # z: ln(H_EI/H_RI), then exponent s; h: ln of the isoviscous film
        np.multiply(y, 0.8, out=z)
        np.add(z, math.log(2.621 / 3), out=z)
        np.multiply(z, 7 / 3, out=t)
        np.exp(t, out=t)
        np.log1p(t, out=t)
        np.multiply(t, 3 / 7, out=t)
        np.subtract(t, y, out=h)
        np.add(h, math.log(3), out=h)
        np.exp(z, out=z)
        np.multiply(z, -2, out=z)
        np.exp(z, out=z)
        np.multiply(z, 1.6, out=z)
        np.add(z, 1.4, out=z)
        np.subtract(a, h, out=a)
        np.multiply(a, z, out=a)
        np.exp(a, out=a)
        np.log1p(a, out=a)
        np.divide(a, z, out=a)
        np.add(h, a, out=h)
        np.add(h, x, out=h)
        np.exp(h, out=h)
        np.multiply(h, k.radius, out=h)

    def regime():
        """In logarithms: x is ln U, y ln W."""
        np.log(u, out=x)
        np.add(x, k.log_speed, out=x)
        np.log(w, out=y)
        np.add(y, k.log_load, out=y)
        np.multiply(x, 0.7, out=z)
        np.multiply(y, 0.13, out=t)
        np.subtract(z, t, out=z)
        np.add(z, math.log(2.65) + 0.54 * k.log_material, out=z)
        np.multiply(x, 2 / 3, out=t)
        np.add(t, math.log(1.66630) + 2 / 3 * k.log_material, out=t)
        np.minimum(z, t, out=z)
        np.subtract(x, y, out=h)
        np.add(h, math.log(4.89497), out=h)
        np.maximum(h, z, out=h)
        np.multiply(x, 0.6, out=x)
        np.multiply(y, 0.2, out=y)
        np.subtract(x, y, out=x)
        np.add(x, math.log(3.10), out=x)
        np.maximum(h, x, out=h)
        np.exp(h, out=h)
        np.multiply(h, k.radius, out=h)

    thickness = {"moes": moes, "regime": regime}[film]

    def call():
        np.multiply(w, k.per_load, out=b)
        np.sqrt(b, out=b)
        np.multiply(b, k.per_width, out=p)
        thickness()
        np.abs(sliding, out=v)
        # x: sigma, y: D
        np.multiply(p, k.pressure_viscosity, out=x)
        np.exp(x, out=x)
        np.multiply(x, k.viscosity, out=x)
        np.multiply(x, u, out=y)
        np.divide(y, b, out=y)
        np.multiply(y, 1 / k.shear_modulus, out=y)
        np.multiply(x, v, out=x)
        np.divide(x, h, out=x)
        np.multiply(x, 1 / k.eyring_stress, out=x)
        # a: w = Phi sigma, z: asinh(sigma)
        np.divide(b, u, out=a)
        np.sqrt(a, out=a)
        np.multiply(a, k.flash, out=a)
        np.multiply(h, k.across, out=t)
        np.add(a, t, out=a)
        np.multiply(p, k.pressure_thermoviscosity, out=t)
        np.add(t, k.thermoviscosity, out=t)
        np.multiply(a, t, out=a)
        np.multiply(a, v, out=a)
        np.multiply(a, k.eyring_stress, out=a)
        np.arcsinh(x, out=z)
        # y: D/sigma, t: discriminant
        np.divide(y, x, out=y)
        np.multiply(y, a, out=t)
        np.multiply(t, z, out=t)
        np.add(a, 1, out=a)
        np.multiply(a, a, out=b)
        np.subtract(b, t, out=t)
        np.maximum(t, 0, out=t)
        np.sqrt(t, out=t)
        np.add(a, t, out=a)
        np.divide(z, a, out=z)  # half the plateau
        np.multiply(z, y, out=t)
        np.greater(t, 1, out=flag)
        np.multiply(z, t, out=t)
        np.add(z, z, out=z)
        np.subtract(z, t, out=z)
        np.divide(1, y, out=y)
        np.copyto(z, y, where=flag)
        np.divide(z, p, out=z)
        np.multiply(z, k.eyring_stress, out=z)
        # x: boundary friction
        np.divide(v, u, out=v)
        np.multiply(v, -k.decay, out=t)
        np.expm1(t, out=t)
        np.add(t, 1, out=x)
        np.multiply(x, v, out=x)
        np.multiply(x, k.rise, out=x)
        np.multiply(t, k.limit, out=t)
        np.subtract(x, t, out=x)
        # a: its share
        np.multiply(h, -band * k.per_roughness, out=a)
        np.add(a, band * k.hydrodynamic_limit, out=a)
        np.clip(a, 0, 1, out=a)
        np.multiply(a, a, out=t)
        np.multiply(t, a, out=a)
        np.multiply(a, a, out=a)
        np.subtract(x, z, out=x)
        np.multiply(x, a, out=x)
        np.add(z, x, out=x)
        np.copysign(x, sliding, out=mu)
        return float(np.dot(mu, w)) * k.width

    return call, lambda: mu
