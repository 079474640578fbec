"""The contact chain in Numba, one loop over the slices; also a process of its own, for a Numba with Intel's SVML.

The newest Numba cannot use SVML: its LLVM is not patched for it, as ``numba -s`` says; 0.61.2 is the last whose wheels
are. So the peer with SVML runs under an interpreter of its own and measures itself when told: `Elsewhere`.
"""

import functools
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

if __name__ == "__main__":  # of this machine LLVM takes half the width if it is not told
    import llvmlite.binding as llvm

    os.environ["NUMBA_CPU_NAME"] = llvm.get_host_cpu_name()
    os.environ["NUMBA_CPU_FEATURES"] = llvm.get_host_cpu_features().flatten() + ",-prefer-256-bit"

import numba
import numpy as np

njit = numba.njit(error_model="numpy")


@njit
def moes(k, log_u, log_w):
    """ln(h/R) of the composite film."""
    root = 0.5 * (math.log(2.0) + k.log_speed + log_u)
    M = k.log_load + log_w - root
    L = k.log_material + 0.5 * root
    ei_ri = math.log(2.621 / 3.0) + 0.8 * M
    ep = math.log(1.311) - 0.125 * M + 0.75 * L
    ep_rp = ep - math.log(1.287) - 2.0 / 3.0 * L
    isoviscous = math.log(3.0) - M + 3.0 / 7.0 * math.log1p(math.exp(7.0 / 3.0 * ei_ri))
    piezoviscous = ep - 2.0 / 7.0 * math.log1p(math.exp(3.5 * ep_rp))
    s = 1.4 + 1.6 * math.exp(-2.0 * math.exp(ei_ri))
    return root + isoviscous + math.log1p(math.exp(s * (piezoviscous - isoviscous))) / s


@njit
def regime(k, log_u, log_w):
    """ln(h/R) of the film that the regime has."""
    U = k.log_speed + log_u
    G = k.log_material
    W = k.log_load + log_w
    isoviscous = max(math.log(4.89497) + U - W, math.log(3.10) + 0.6 * U - 0.2 * W)
    piezoviscous = min(
        math.log(1.66630) + 2.0 / 3.0 * (G + U), math.log(2.65) + 0.7 * U + 0.54 * G - 0.13 * W
    )
    return max(isoviscous, piezoviscous)


@njit
def full(k, b, p, h, u, v):
    """Friction of a full film."""
    eta = k.viscosity * math.exp(k.pressure_viscosity * p)
    sigma = eta * v / (k.eyring_stress * h)
    rate = v / u * (k.shear_modulus * b / (k.eyring_stress * h))  # sigma/D
    heat = (k.thermoviscosity + k.pressure_thermoviscosity * p) * (
        k.flash * math.sqrt(b / u) + k.across * h
    )
    w = heat * k.eyring_stress * v
    a = 1.0 + w
    plateau = math.asinh(sigma)
    half = plateau / (a + math.sqrt(max(a * a - w * plateau / rate, 0.0)))
    stress = rate if half > rate else half * (2.0 - half / rate)
    return k.eyring_stress / p * stress


@njit
def boundary(k, s):
    """Boundary friction."""
    gone = math.expm1(-k.decay * s)
    return k.rise * s * (1.0 + gone) - k.limit * gone


@njit
def fraction(k, h):
    """Share of boundary friction."""
    x = (k.hydrodynamic_limit - h * k.per_roughness) / (k.hydrodynamic_limit - k.boundary_limit)
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (x * x * x)


@functools.cache
def with_branches(film):
    """Loop that computes of each slice only what it needs."""

    @njit
    def chain(k, load, speed, sliding, friction):
        force = 0.0
        for i in range(load.size):
            w = load[i]
            u = speed[i]
            v = abs(sliding[i])
            b = math.sqrt(k.per_load * w)
            h = k.radius * math.exp(film(k, math.log(u), math.log(w)))
            p = k.per_width * b
            part = fraction(k, h)
            mu = full(k, b, p, h, u, v) if part < 1.0 else 0.0
            if part > 0.0:
                mu += (boundary(k, v / u) - mu) * part
            friction[i] = math.copysign(mu, sliding[i])
            force += friction[i] * w
        return force * k.width

    return chain


@functools.cache
def without_branches(film):
    """Loops that compute all of every slice, so that they vectorise; the sum apart, which keeps its order."""

    @njit
    def chain(k, load, speed, sliding, friction):
        for i in range(load.size):
            w = load[i]
            u = speed[i]
            v = abs(sliding[i])
            b = math.sqrt(k.per_load * w)
            h = k.radius * math.exp(film(k, math.log(u), math.log(w)))
            p = k.per_width * b
            mu = full(k, b, p, h, u, v)
            mu += (boundary(k, v / u) - mu) * fraction(k, h)
            friction[i] = math.copysign(mu, sliding[i])
        force = 0.0
        for i in range(load.size):
            force += friction[i] * load[i]
        return force * k.width

    return chain


def loop(form, film, k, load, speed, sliding):
    """Return a call of a compiled loop, its result, and the loop."""
    chain = form({"moes": moes, "regime": regime}[film])
    mu = np.empty_like(load)

    def call():
        return chain(k, load, speed, sliding, mu)

    call()
    return call, lambda: mu, chain


def plain(film, given):
    """Numba as it comes, with branches: without vector mathematics the form without them is slower."""
    from constants import constants

    call, friction, _ = loop(
        with_branches, film, constants(given), given.load, given.rolling_speed, given.sliding_speed
    )
    return call, friction


# In a process of its own ----------------------------------------------------------------------------------------------


class Elsewhere:
    """A peer under another interpreter; it measures itself when told, so that it takes its turn among the others."""

    def __init__(self, python):
        library = Path(python).absolute().parents[1] / "lib"
        self.process = subprocess.Popen(
            [python, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
            | {"LD_LIBRARY_PATH": str(library)},
        )
        self.versions = self._ask(do="versions")

    def _ask(self, **request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise RuntimeError(f"{self.process.args[0]} ended with status {self.process.wait()}")
        return json.loads(answer)

    def __call__(self, film, given):
        """Return a call that can time itself, as `timing.interleaved` asks, and the frictions."""
        from constants import constants

        with tempfile.NamedTemporaryFile(suffix=".npz") as file:
            np.savez(
                file.name, load=given.load, speed=given.rolling_speed, sliding=given.sliding_speed
            )
            loop = self._ask(
                do="make", film=film, constants=constants(given)._asdict(), file=file.name
            )

        def call():
            return self._ask(do="call", loop=loop)

        call.seconds = lambda repeats: self._ask(do="time", loop=loop, repeats=repeats)
        return call, lambda: np.array(self._ask(do="friction", loop=loop))

    def close(self):
        """End it."""
        self.process.stdin.close()
        self.process.wait()


def serve():
    """Answer requests, one JSON value a line."""
    from typing import NamedTuple

    made = []
    kind = []

    def make(film, constants, file):
        if (
            not kind
        ):  # one type for all: what Numba compiles for a second one is no longer inlined, and slow
            kind.append(NamedTuple("Constants", [(name, float) for name in constants]))
        k = kind[0](**constants)
        arrays = np.load(file)
        call, friction, chain = loop(
            without_branches, film, k, arrays["load"], arrays["speed"], arrays["sliding"]
        )
        symbols = set(re.findall(r"__svml_(\w+)", "".join(chain.inspect_asm().values())))
        if not {"exp", "log", "asinh"} <= {re.sub(r"\d.*", "", symbol) for symbol in symbols}:
            raise RuntimeError(f"the loop calls no SVML: {symbols}")
        made.append(SimpleNamespace(call=call, friction=friction))
        return len(made) - 1

    def seconds(peer, repeats):
        begin = time.process_time()
        for _ in range(repeats):
            peer.call()
        return time.process_time() - begin

    for line in sys.stdin:
        request = json.loads(line)
        match request.pop("do"):
            case "versions":
                answer = {
                    "python": sys.version.split()[0],
                    "numba": numba.__version__,
                    "numpy": np.__version__,
                }
            case "make":
                answer = make(**request)
            case "call":
                answer = made[request["loop"]].call()
            case "time":
                answer = seconds(made[request["loop"]], request["repeats"])
            case "friction":
                answer = made[request["loop"]].friction().tolist()
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    serve()
