"""Instruction sets: the one asked for runs, one that is not there is refused in words, all give the same bits."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fuzz import stages
from rollslip import Chain
from rollslip_kernels.stages import simd

SUPPORT = Path(__file__).parents[1] / "support"


def run(code, name):
    """Run Python code with the instruction set forced."""
    path = os.pathsep.join(filter(None, [str(SUPPORT), os.environ.get("PYTHONPATH")]))
    environment = os.environ | {"ROLLSLIP_SIMD": name, "PYTHONPATH": path}
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)


def test_the_widest_set_runs_by_default():
    code = "from rollslip_kernels.stages import simd; print(simd.active())"
    environment = {name: value for name, value in os.environ.items() if name != "ROLLSLIP_SIMD"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == simd.available()[-1]
    assert simd.available()[0] == "baseline"


@pytest.mark.parametrize("name", ["avx9", ""])
def test_a_set_that_is_not_there_is_refused_in_words(name):
    done = run("from rollslip_kernels import chain", name)
    assert done.returncode != 0
    assert f"ROLLSLIP_SIMD = {name!r} names no instruction set of this machine" in done.stderr
    assert f"it has {', '.join(simd.available())}" in done.stderr


#: Digest of what every compiled stage fills: typical slices, all lengths of an odd end, and then wide ones.
DIGEST = """
import hashlib, random
import numpy as np
from fuzz import stages
from rollslip import Chain
from rollslip.errors import DomainError
from rollslip_kernels.stages import simd

single, *_ = stages.stages()
rng = np.random.default_rng(7)
print(simd.active())
for model in single:
    digest, refused = hashlib.sha256(), 0
    for n in (*range(1, 18), 255, 256, 257, 1000):
        for wide in (0.0, 2.0):
            slices = stages.table(stages.typical(n))
            varied = {"load", "approach", "rolling_speed", "sliding_speed", "film_thickness"}
            for column in sorted(model.reads & varied):
                getattr(slices, column)[:] *= np.exp(wide * rng.normal(size=n))
            try:
                Chain(model)(slices)
            except DomainError:
                refused += 1
            for column in sorted(model.writes):
                digest.update(getattr(slices, column).tobytes())
    print(type(model).__module__, model.name, digest.hexdigest(), refused)
"""


def test_all_sets_give_the_same_bits():
    printed = {}
    for name in simd.available():
        done = run(DIGEST, name)
        assert done.returncode == 0, done.stderr[-2000:]
        active, *lines = done.stdout.splitlines()
        assert active == name
        printed[name] = lines
    assert len(printed["baseline"]) > 30
    assert sum(int(line.split()[-1]) for line in printed["baseline"]) < 200  # of some 1500: most are computed
    for lines in printed.values():
        assert lines == printed["baseline"]


def test_neighbours_change_no_bit_of_a_slice():
    """Each stage of a table, again one slice at a time."""
    n = 300
    for model in stages.stages()[0]:
        whole = stages.table(stages.typical(n))
        whole.load[:] *= np.linspace(0.1, 3.0, n)
        whole.sliding_speed[:] *= np.linspace(-2.0, 2.0, n)
        whole.film_thickness[:] *= np.linspace(0.1, 2.0, n)
        whole.approach[:] *= np.linspace(-1.0, 2.0, n)
        alone = stages.table(stages.typical(n))
        alone._table[:] = whole._table
        Chain(model)(whole)
        Chain(model, block=1)(alone)
        for name in model.writes:
            np.testing.assert_array_equal(getattr(whole, name), getattr(alone, name), err_msg=model.name)


def test_the_command_line_says_which_runs_and_refuses_what_is_not_there():
    def info(name):
        code = "from rollslip.cli import main; main(['info'])"
        return subprocess.run(
            [sys.executable, "-c", code], env=os.environ | {"ROLLSLIP_SIMD": name}, capture_output=True, text=True
        )

    assert "instructions  baseline, of baseline" in info("baseline").stdout
    refused = info("v9")
    assert refused.returncode == 2
    assert refused.stderr.startswith("ROLLSLIP_SIMD = 'v9' names no instruction set of this machine")
