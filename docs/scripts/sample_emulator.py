"""Write sample_emulator.csv of docs/trust/time_of_a_run.rst: emulated samples against the same computed as a whole.

``python docs/scripts/sample_emulator.py FOLDER [SAMPLES [SCENE ...]]`` computes SAMPLES (by default 512) of each scene
as a whole, up to a second of a core each, and keeps them in FOLDER; then it emulates all but the first ones.
Choices in the emulator were made with `turbine` of this seed and NU 2216 of another one.

The torques at chosen slips are those of the loading branches, which are the same as without the branch (within 1e-7).
Errors of quantiles are relative to the standard error of the quantile of 1024 independent samples, by a bootstrap. Of
several quantiles the largest error stands in the table. Times are those of the processor for a sample, of both kinds in
turn, without those of the sweep.
"""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from output import write_table

from rollslip_campaigns.sweep.folder import Points
from rollslip_campaigns.sweep.point import compute
from rollslip_campaigns.uncertainty import UncertaintySettings
from rollslip_campaigns.uncertainty.emulation import WHOLE_SAMPLES
from rollslip_campaigns.uncertainty.emulator import balance, choose_basis, scales
from rollslip_campaigns.uncertainty.plan import torque_sweep
from rollslip_campaigns.uncertainty.samples import friction_samples

SEED = 7
SAMPLES = 512
#: Scene -> bearing, speed [rpm] and load [kN] of a new one; None for a shipped one.
SCENES = {
    "gearbox": None,
    "turbine": None,
    "NU2216": (4500, 1.5),
    "NU310": (3000, 0.5),
    "NU1012": (6000, 0.6),
}
QUANTILES = (0.01, 0.05, 0.5, 0.95, 0.99)
QUANTITIES = ("steady slip", "drag reserve")
TIMED = 6


def scene_of(name, folder):
    """Name or file of a scene."""
    if SCENES[name] is None:
        return name
    speed, load = SCENES[name]
    path = folder / f"{name}.toml"
    if not path.exists():
        command = (
            str(Path(sys.executable).parent / "rollslip"),
            *("new", str(path), "--bearing", name, "--oil", "iso-vg-68"),
            *("--speed", f"{speed} rpm", "--load", f"{load} kN", "--temperature", "75 degC"),
            *("--cage", "brass", "--supply", "bath"),
        )
        subprocess.run(command, check=True, capture_output=True)
    return str(path)


def whole_samples(plan, path, count):
    """Outcomes (2, n), torques and drags (n, P) and slips (P,) of samples computed as a whole, kept in a file."""
    if not path.exists():
        points = Points.in_folder(plan.critical, path.with_suffix(""), print, lambda progress: None)
        points.compute(range(count))
        found = points.collect(range(count)).isel(sample=slice(count))
        samples = friction_samples(found)
        np.savez(
            path,
            outcomes=np.array([samples[name] for name in QUANTITIES]),
            torques=found["driving_torque"].transpose("sample", ...),
            drags=found["drag_torque"].transpose("sample", ...),
            slips=found["torque_slip"],
        )
    return dict(np.load(path))


def milliseconds(sweep, numbers):
    """Processor time of a sample [ms], mean of several."""
    points = [(number, sweep.design.changes(number)) for number in numbers]
    begin = time.process_time()
    assert {row.status for row in compute(sweep.work, points).rows} == {"ok"}
    return 1e3 * (time.process_time() - begin) / len(points)


def quantile(values, probability):
    """Quantile by order statistic, (...)."""
    rank = max(int(np.ceil(probability * values.shape[-1] - 1e-9)), 1) - 1
    return np.sort(values)[..., rank]


def relative_errors(emulated, values):
    """Errors of quantiles over the standard error of 1024 independent samples, (5,)."""
    rng = np.random.default_rng(0)
    drawn = values[rng.integers(0, values.size, (500, 1024))]
    spread = [max(float(quantile(drawn, p).std()), 0.01) for p in QUANTILES]
    return [
        abs(float(quantile(emulated, p) - quantile(values, p))) / s
        for p, s in zip(QUANTILES, spread, strict=True)
    ]


def judged(name, folder, count):
    """Row of the table of a scene."""
    plan = UncertaintySettings(
        scene_of(name, folder), samples=SAMPLES, loads=0, seed=SEED, engine="serial"
    ).plan()
    whole = whole_samples(plan, folder / f"{name}.npz", count)
    outcomes, torques, drags, slips = (
        whole[name] for name in ("outcomes", "torques", "drags", "slips")
    )
    count = len(torques)
    for first in WHOLE_SAMPLES:
        known = (outcomes[0, :first], outcomes[1, :first])
        basis = choose_basis(slips, torques[:first], drags[:first], known)
        if basis is not None:
            break
    if basis is None:
        return name, count, first, *("–",) * 11
    branches = basis.branches(torques[:, np.searchsorted(slips, basis.torque_slips)])
    emulated = balance(basis.slips, branches, drags[:, np.searchsorted(slips, basis.slips)])
    row = [name, count, first, basis.torque_slips.size]
    for values, others, scale, stated in zip(
        outcomes, emulated, scales(), basis.errors, strict=True
    ):
        exact = scale.forward(values)
        found = np.append(exact[:first], scale.forward(others[first:]))
        actual = np.sqrt(np.mean((found - exact)[first:] ** 2))
        errors = relative_errors(found, exact)
        row += [
            f"{stated / exact.std():.3f}",
            f"{actual / exact.std():.3f}",
            f"{max(errors[1:4]):.2f}",
            f"{max(errors[0], errors[4]):.2f}",
        ]
    sweep = torque_sweep(plan.critical, basis.torque_slips)
    timed = range(first, first + TIMED)
    milliseconds(plan.critical, timed[:1])
    times = [(milliseconds(plan.critical, timed), milliseconds(sweep, timed)) for _ in range(2)]
    slow, fast = (min(column) for column in zip(*times, strict=True))
    return *row, f"{slow:.0f}", f"{fast:.0f}"


def main(folder, count=SAMPLES, *names):
    """Judge some scenes, or all, and write the table."""
    folder.mkdir(exist_ok=True)
    rows = []
    for name in names or SCENES:
        rows.append(judged(name, folder, count))
        print(*rows[-1], flush=True)
    if names:
        return
    head = ["scene", "samples", "as a whole", "slips"]
    for quantity in ("slip", "reserve"):
        head += [
            f"{quantity}: stated error",
            f"{quantity}: error",
            f"{quantity}: 5, 50, 95 %",
            f"{quantity}: 1, 99 %",
        ]
    write_table("sample_emulator", (*head, "whole [ms]", "emulated [ms]"), rows)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *map(int, sys.argv[2:3]), *sys.argv[3:])
