"""Cost of a step of rodas5p against the number of rollers; run as ``python bench_rosenbrock.py``, needs a C compiler.

A cage and rollers with smooth dry friction, loaded as they pass, in C: head 1, block 2 (angle and spin), ledger 1.
Beside the arrow the same system is solved densely, as one head, as far as that goes. Prints a table; no test.
"""

import ctypes
import math
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from rollslip_kernels.motion.rosenbrock import Rosenbrock

SOURCE = r"""
#include <math.h>
#include <stddef.h>
static double load(double angle) { double c = cos(angle); return c > 0.0 ? c * c : 0.0; }
static double force_of(double w, const double *own, double *sliding) {
    *sliding = 1.0 - own[1] - w;
    return load(own[0]) * *sliding / sqrt(*sliding * *sliding + 1e-4);
}
int roller_rates(double t, const double *head, const double *own, double *rates, double *added, void *state) {
    size_t j, n = *(size_t *)state;
    double sliding;
    for (j = 0; j < n; j++) {
        double force = force_of(head[0], own + 2 * j, &sliding);
        rates[2 * j] = 100.0 * head[0];
        rates[2 * j + 1] = 50.0 * force;
        added[2 * j] = force;
        added[2 * j + 1] = force * sliding;
    }
    return 0;
}
int head_rates(double t, const double *head, double *rates, void *state) {
    rates[0] = -0.3 * head[0];
    rates[1] = 0.0;
    return 0;
}
int dense_rates(double t, const double *y, double *rates, void *state) {
    size_t j, n = *(size_t *)state;
    double sliding;
    head_rates(t, y, rates, state);
    rates[1 + 2 * n] = 0.0;
    for (j = 0; j < n; j++) {
        double force = force_of(y[0], y + 1 + 2 * j, &sliding);
        rates[1 + 2 * j] = 100.0 * y[0];
        rates[2 + 2 * j] = 50.0 * force;
        rates[0] += force;
        rates[1 + 2 * n] += force * sliding;
    }
    return 0;
}
"""


class System(ctypes.Structure):
    """``rs_system`` of motion/rollslip_system.pxd."""

    _fields_ = (
        *((name, ctypes.c_size_t) for name in ("head", "rollers", "block", "ledger")),
        *((name, ctypes.c_void_p) for name in ("roller_rates", "head_rates")),
        ("watched", ctypes.c_size_t),
        *((name, ctypes.c_void_p) for name in ("watch", "jacobian", "scale")),
        ("autonomous", ctypes.c_int),
        ("state", ctypes.c_void_p),
    )


def capsule(library, rollers, dense):
    """Return a capsule and what has to live as long."""
    count, scale = ctypes.c_size_t(rollers), np.ones(2 + 2 * rollers)
    shape = (2 + 2 * rollers, 0, 0, 0) if dense else (1, rollers, 2, 1)
    system = System(
        *shape,
        0 if dense else ctypes.cast(library.roller_rates, ctypes.c_void_p),
        ctypes.cast(library.dense_rates if dense else library.head_rates, ctypes.c_void_p),
        0, 0, 0, scale.ctypes.data, 1, ctypes.addressof(count),
    )  # fmt: skip
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    return new(ctypes.addressof(system), NAME, None), (count, scale, system)


NAME = b"rollslip.system.v1"


def cost(library, rollers, dense=False):
    """Return microseconds a step, its evaluations of the rates, and the final cage speed."""
    given, keep = capsule(library, rollers, dense)
    y0 = np.zeros(2 + 2 * rollers)
    y0[1:-1:2] = 2 * math.pi * np.arange(rollers) / rollers
    best = math.inf
    for _ in range(3):
        solver = Rosenbrock(given, 0.0, y0, 1e3, 1e-5, 1e-8)
        solver.advance(max_steps=20)
        steps, evaluations, start = solver.steps, solver.evaluations, time.perf_counter()
        solver.advance(max_steps=max(3, 20_000 // (rollers**3 // 100 + 10) if dense else 20_000 // rollers))
        best = min(best, (time.perf_counter() - start) / (solver.steps - steps))
    assert keep
    return 1e6 * best, (solver.evaluations - evaluations) / (solver.steps - steps)


def main():
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        source, built = Path(folder) / "system.c", Path(folder) / "system.so"
        source.write_text(SOURCE)
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", built, source, "-lm"], check=True)
        library = ctypes.CDLL(str(built))
        print("rollers  unknowns  us a step  us a step and roller  evaluations a step  us a step, dense")
        times = {}
        for rollers in (10, 20, 28, 50, 100, 200, 500, 1000):
            times[rollers], evaluations = cost(library, rollers)
            dense = f"{cost(library, rollers, dense=True)[0]:16.1f}" if rollers <= 100 else ""
            print(
                f"{rollers:7d}  {2 + 2 * rollers:8d}  {times[rollers]:9.2f}  {times[rollers] / rollers:20.4f}  "
                f"{evaluations:18.1f}  {dense}"
            )
        sizes = np.log(list(times))
        exponent = np.polyfit(sizes[3:], np.log(list(times.values()))[3:], 1)[0]
        print(f"time a step goes as rollers^{exponent:.2f} from 50 to 1000")


if __name__ == "__main__":
    main()
