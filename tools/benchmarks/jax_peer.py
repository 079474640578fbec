"""The contact chain in JAX: one jitted function of three arrays, float64, on one CPU."""

import math

import jax
import jax.numpy as jnp

from constants import constants

jax.config.update("jax_enable_x64", True)
jax.config.update("jax_platforms", "cpu")


def moes(k, log_u, log_w):
    """ln(h/R) of the composite film."""
    root = 0.5 * (math.log(2.0) + k.log_speed + log_u)
    M = k.log_load + log_w - root
    L = k.log_material + 0.5 * root
    ei_ri = math.log(2.621 / 3) + 0.8 * M
    ep = math.log(1.311) - 0.125 * M + 0.75 * L
    ep_rp = ep - math.log(1.287) - 2 / 3 * L
    isoviscous = math.log(3.0) - M + 3 / 7 * jnp.log1p(jnp.exp(7 / 3 * ei_ri))
    piezoviscous = ep - 2 / 7 * jnp.log1p(jnp.exp(3.5 * ep_rp))
    s = 1.4 + 1.6 * jnp.exp(-2 * jnp.exp(ei_ri))
    return root + isoviscous + jnp.log1p(jnp.exp(s * (piezoviscous - isoviscous))) / s


def regime(k, log_u, log_w):
    """ln(h/R) of the film that the regime has."""
    U = k.log_speed + log_u
    G = k.log_material
    W = k.log_load + log_w
    isoviscous = jnp.maximum(math.log(4.89497) + U - W, math.log(3.10) + 0.6 * U - 0.2 * W)
    piezoviscous = jnp.minimum(
        math.log(1.66630) + 2 / 3 * (G + U), math.log(2.65) + 0.7 * U + 0.54 * G - 0.13 * W
    )
    return jnp.maximum(isoviscous, piezoviscous)


def jitted(film, given):
    """Return a call that waits for its result, and the frictions."""
    k = constants(given)
    thickness = {"moes": moes, "regime": regime}[film]

    @jax.jit
    def chain(w, u, sliding):
        v = jnp.abs(sliding)
        b = jnp.sqrt(k.per_load * w)
        h = k.radius * jnp.exp(thickness(k, jnp.log(u), jnp.log(w)))
        p = k.per_width * b
        eta = k.viscosity * jnp.exp(k.pressure_viscosity * p)
        sigma = eta * v / (k.eyring_stress * h)
        rate = v / u * (k.shear_modulus * b / (k.eyring_stress * h))
        heat = (k.thermoviscosity + k.pressure_thermoviscosity * p) * (
            k.flash * jnp.sqrt(b / u) + k.across * h
        )
        heating = heat * k.eyring_stress * v
        a = 1 + heating
        plateau = jnp.arcsinh(sigma)
        half = plateau / (a + jnp.sqrt(jnp.maximum(a * a - heating * plateau / rate, 0.0)))
        full = k.eyring_stress / p * jnp.where(half > rate, rate, half * (2 - half / rate))
        gone = jnp.expm1(-k.decay * v / u)
        boundary = k.rise * v / u * (1 + gone) - k.limit * gone
        x = (k.hydrodynamic_limit - h * k.per_roughness) / (k.hydrodynamic_limit - k.boundary_limit)
        x = jnp.clip(x, 0.0, 1.0)
        mu = jnp.copysign(full + (boundary - full) * (x * x * x * (x * x * x)), sliding)
        return mu, jnp.dot(mu, w) * k.width

    arguments = [jnp.asarray(x) for x in (given.load, given.rolling_speed, given.sliding_speed)]
    result = [None]

    def call():
        result[0] = jax.block_until_ready(chain(*arguments))
        return float(result[0][1])

    call()
    return call, lambda: result[0][0]
