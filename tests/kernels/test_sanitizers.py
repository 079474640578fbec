"""Our kernels and a third party's, compiled with sanitizers and bounds checks, run clean together and leak nothing.

- AddressSanitizer sees an overrun only where an allocation ends: `fuzz.stages.call_apart` gives each column its own.
- Indices of memoryviews are checked by Cython, in the same build.
- A leak is growth of the heap over many repetitions. LeakSanitizer is off: what the interpreter never frees would have
  to be suppressed, and Python is on every stack, so that ours would be suppressed with it.
- Each check is shown to catch a fault that is planted.
"""

import os
import shutil
import subprocess
import sys

import pytest

from architecture import ROOT

SANITIZE = "-O1 -g1 -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer"

pytestmark = pytest.mark.plugins


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory):
    """Give a folder with our kernels and an example package's, built under test, and what runs code there."""
    folder = tmp_path_factory.mktemp("sanitized")
    example = next((ROOT / "docs" / "example-plugins").glob("*/src/*/*.pyx")).parents[2]
    for source in (ROOT / "framework", ROOT / "kernels", ROOT / "plugins", ROOT / "tests", example):
        ignored = shutil.ignore_patterns("*.so", "*.c", "__pycache__", "build", "*.egg-info")
        shutil.copytree(
            source, folder / ("example" if source is example else source.name), ignore=ignored
        )
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    paths = [
        folder / part
        for part in ("framework", "kernels", "plugins", "tests/support", "example/src")
    ]
    environment = os.environ | {
        "CFLAGS": SANITIZE,
        "ROLLSLIP_BOUNDSCHECK": "1",
        "PYTHONPATH": os.pathsep.join(map(str, paths)),
        "PYTHONMALLOC": "malloc",  # else small objects share blocks of Python's own
        "ASAN_OPTIONS": "detect_leaks=0",
    }

    def run(command, at=folder, **more):
        return subprocess.run(
            command, cwd=at, env=environment | more, capture_output=True, text=True, check=False
        )

    # with its metadata beside it, the example is found like an installed package
    for place, commands in ((folder, []), (folder / "example", ["egg_info"])):
        built = run([sys.executable, "setup.py", "-q", *commands, "build_ext", "--inplace"], place)
        assert built.returncode == 0, built.stderr[-3000:]
    libraries = [
        run(["cc", f"-print-file-name={name}"]).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    return folder, lambda code: run([sys.executable, "-c", code], LD_PRELOAD=" ".join(libraries))


def clean(done):
    """Return what a run printed, if nothing was found in it."""
    assert done.returncode == 0, done.stderr[-5000:]
    assert "runtime error" not in done.stderr
    return done.stdout.split()


#: Every compiled stage alone and in every chain, over blocks and odd remainders, and with values that it refuses.
WORK = """
import itertools
import numpy as np
from fuzz import stages
from rollslip import Chain, available
from rollslip.bearing.chain import stage
from rollslip.errors import DomainError
from rollslip.testing.samples import MAGNITUDES

single, contacts, films, tractions = stages.stages()
chains = list(itertools.product(contacts, films, stages.LAWS, tractions))
done = 0
for k, n in enumerate((1, 2, 255, 256, 257, 1000)):
    for models in [*((model,) for model in single), *chains[k::6]]:
        slices = stages.table(stages.typical(n))
        for model in models:
            assert stages.call_apart(stage(model), slices) == 0, model
        Chain(*models)(slices)
        assert all(np.isfinite(getattr(slices, name)).all() for model in models for name in model.writes)
        done += 1
        for wrong in (0.0, -1.0, np.nan, np.inf):
            slices.load[n // 2] = slices.approach[n // 2] = slices.pressure[n // 2] = wrong
            try:
                Chain(*models)(slices)
            except DomainError:
                continue
print(done, len(single), *available("traction"))
"""


def test_kernels_run_clean(sanitized):
    done, single, *tractions = clean(sanitized[1](WORK))
    assert int(done) > 1000
    assert int(single) > 30
    assert "muraki" in tractions
    assert len(set(tractions) - {"muraki"}) > 5


FUZZ = """
import random
from fuzz import stages
for seed in range(3000):
    stages.run(stages.changed(random.Random(seed), random.Random(seed).choice(stages.SEEDS)))
"""


def test_kernels_run_clean_on_any_bits(sanitized):
    clean(sanitized[1](FUZZ))


# Shapes of the elementwise laws, through the memoryviews whose indices this build checks.
SHAPES = """
import numpy as np
from rollslip_kernels.stages import stress
for law in (stress.muraki, stress.maxwell_eyring, stress.eyring):
    for shapes in (((), (), ()), ((0,), (1,), (1,)), ((3, 1), (2,), ()), ((1000,), (1000,), (1,))):
        result = law(*(np.full(shape, 0.5) for shape in shapes))
        assert result.shape == np.broadcast_shapes(*shapes)
        assert np.isfinite(result).all()
print((sum(1 for _ in open("kernels/rollslip_kernels/stages/stress.c") if "__Pyx_RaiseBufferIndexError" in _)))
"""


def test_elementwise_laws_keep_their_bounds(sanitized):
    (checks,) = clean(sanitized[1](SHAPES))
    assert int(checks) > 0  # the switch is on


#: Writes one past the end of a column.
OVERRUN = """
#include "rollslip.h"
int overrun(const rs_slices *s, const void *params) {
    for (size_t i = 0; i <= s->n; i++) s->friction[i] = 0.0;
    return 0;
}
"""
CALL = """
import ctypes, sys
from fuzz import stages
from rollslip import Chain
from rollslip.foreign import capsule_from_address
from foreign_stages import Stage
library = ctypes.CDLL("./overrun.so")
capsule = capsule_from_address(ctypes.cast(library.overrun, ctypes.c_void_p).value, owner=library)
slices = stages.table(stages.typical(7))
CALL
"""


def test_an_overrun_of_a_column_is_caught(sanitized):
    folder, run = sanitized
    (folder / "overrun.c").write_text(OVERRUN)
    include = folder / "kernels" / "rollslip_kernels" / "include"
    command = [
        "cc",
        *SANITIZE.split(),
        "-shared",
        "-fPIC",
        f"-I{include}",
        "overrun.c",
        "-o",
        "overrun.so",
    ]
    subprocess.run(command, cwd=folder, check=True)
    clean(
        run(CALL.replace("CALL", "Chain(Stage(capsule=capsule))(slices)"))
    )  # the next row hides it
    done = run(CALL.replace("CALL", "stages.call_apart(capsule, slices)"))
    assert done.returncode != 0
    assert "heap-buffer-overflow" in done.stderr
    assert "overrun.c:4" in done.stderr


#: Growth of the heap [B] a time of what allocates: capsules, chains, calls that end well, are refused, raise.
LEAKS = """
import ctypes, gc
import numpy as np
from fuzz import stages
from rollslip import Chain, Slices
from rollslip.errors import DomainError
from rollslip.testing.samples import NumpyForm
from foreign_stages import Stage

allocated = ctypes.CDLL(None).__sanitizer_get_current_allocated_bytes
allocated.restype = ctypes.c_size_t

def grown(action, times):
    for _ in range(100):
        action()
    gc.collect()
    before = allocated()
    for _ in range(times):
        action()
    gc.collect()
    return (allocated() - before) / times

def raising(slices):
    raise ZeroDivisionError

def failing(chain, slices, error):
    try:
        chain(slices)
    except error:
        return
    raise AssertionError(chain)

single = stages.stages()[0]
table, empty = stages.table(stages.typical(300)), Slices(300)
for model in single:
    chain = Chain(model)
    print(grown(model.kernel, 100_000 // len(single)))
    print(grown(lambda: Chain(model), 500))
    print(grown(lambda: chain(table), 100))
    print(grown(lambda: failing(chain, empty, DomainError), 500))
python = Chain(NumpyForm(single[0]))
print(grown(lambda: python(table), 2000))
broken = Chain(Stage(body=raising))
print(grown(lambda: failing(broken, table, ZeroDivisionError), 2000))
"""
#: A capsule that nobody frees.
PLANTED = (
    "\nprint(grown(lambda: ctypes.pythonapi.Py_IncRef(ctypes.py_object(single[0].kernel())), 1000))"
)


def test_nothing_is_left_behind(sanitized):
    *grown, planted = (float(number) for number in clean(sanitized[1](LEAKS + PLANTED)))
    assert len(grown) > 100
    assert (
        max(grown) < 8.0
    )  # what is kept once, as in caches, divided by hundreds; the least object is larger
    assert planted > 16.0
