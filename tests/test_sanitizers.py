"""Our kernels and a third party's, compiled with the address and undefined-behaviour sanitizers, run clean together."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SANITIZE = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer"

#: Every compiled stage beside a stranger's, over blocks and odd remainders, with values that the domain refuses too.
WORK = """
import numpy as np
from rollslip import Chain, Conditions, Slices, available, get_model
from rollslip.errors import DomainError
from rollslip_limiting_shear.traction import LimitingShear

oil = Conditions(length=0.015, radius=0.007, modulus=2.3e11, roughness=2.4e-7, effusivity=1.3e4, temperature=343.15,
                 viscosity=5e-3, pressure_viscosity=1e-8, thermoviscosity=0.02, pressure_thermoviscosity=7e-11,
                 conductivity=0.14, eyring_stress=4e6, shear_modulus=3e8)
stranger = LimitingShear()
tractions = [get_model("traction", name) for name in available("traction")]
tractions += [stranger, get_model("traction", "lambda-blend", hydrodynamic=stranger)]
done = 0
for contact in (get_model("contact", name) for name in available("contact")):
    for film in (get_model("film", name) for name in available("film")):
        for traction in tractions:
            for n in (1, 255, 256, 257, 1000):
                slices = Slices(n, oil, approach=np.linspace(-1e-6, 5e-6, n), load=np.geomspace(1e-3, 1e6, n),
                                rolling_speed=np.geomspace(1e-3, 50.0, n), sliding_speed=np.linspace(-10.0, 10.0, n))
                Chain(contact.deflection())(Slices(n, oil, approach=np.linspace(-1e-6, 5e-6, n)))
                Chain(contact, film, traction)(slices)
                assert np.isfinite(slices.friction).all()
                done += 1
                for wrong in (0.0, -1.0, np.nan, np.inf):
                    slices.load[n // 2] = wrong
                    try:
                        Chain(contact, film, traction)(slices)
                    except DomainError:
                        continue
                    raise AssertionError(wrong)
print(done)
"""


@pytest.mark.plugins
def test_kernels_run_clean_under_sanitizers(tmp_path):
    for folder in ("framework", "kernels", "plugins"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("*.so", "*.c", "__pycache__"))
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(
        ROOT / "docs" / "example-plugins" / "rollslip-limiting-shear",
        tmp_path / "stranger",
        ignore=shutil.ignore_patterns("*.so", "build", "__pycache__"),
    )
    paths = [tmp_path / "framework", tmp_path / "kernels", tmp_path / "plugins", tmp_path / "stranger" / "src"]
    environment = os.environ | {"CFLAGS": SANITIZE, "PYTHONPATH": os.pathsep.join(map(str, paths))}
    for folder in (tmp_path, tmp_path / "stranger"):
        built = subprocess.run(
            [sys.executable, "setup.py", "-q", "build_ext", "--inplace"],
            cwd=folder, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert built.returncode == 0, built.stderr[-3000:]
    libraries = [
        subprocess.run(["cc", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    done = subprocess.run(
        [sys.executable, "-c", WORK],
        cwd=tmp_path,
        env=environment | {"LD_PRELOAD": " ".join(libraries), "ASAN_OPTIONS": "detect_leaks=0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-5000:]
    assert int(done.stdout) > 1000
    assert "runtime error" not in done.stderr
