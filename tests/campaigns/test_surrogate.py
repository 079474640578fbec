"""Tables of a bearing for other programs: held against the study, motions of dynamics, and the standard of FMI."""

import csv
import importlib.util
import io
import json
import lzma
import math
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import click
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import recorded
import rollslip
import without_bands
from mean_roller import MeanRoller
from rollslip.bearing.assembly import assemble
from rollslip.cli.main import cli, main
from rollslip.errors import SceneError
from rollslip.planning.new_scene import new
from rollslip.results.accounts import account_of
from rollslip.results.dataset import open_result
from rollslip.scene.changes import evolve
from rollslip.scene.formats import format_of
from rollslip.units import quantity
from rollslip_campaigns.surrogate import SurrogateSettings
from rollslip_campaigns.surrogate import surrogate as made_by
from rollslip_campaigns.surrogate.exports import sources
from rollslip_campaigns.surrogate.stiffness import N_POSITIONS
from rollslip_campaigns.surrogate.tables import Axis, Tables, weights
from rollslip_studies.raceway_friction.study import RacewayFriction
from small_forces import by_differences
from tabled import TABLES, rows_of

#: Every drag that acts by default.
SCENE = evolve(rollslip.load_scene("gearbox"), {"accuracy.slices": 7})
OVER = ["radial_load=1 kN:2.5 kN", "temperature=70 degC:90 degC", "inner_speed=500 rpm:1800 rpm"]
#: The same under axial load, with ribs.
RIBS = evolve(SCENE, {"bearing.ribs.height": "1 mm", "operation.axial_load": "300 N"})
needs_compiler = pytest.mark.skipif(
    shutil.which("cc") is None, reason="an FMU is run by what a C compiler makes of it"
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("surrogate")


def made(folder, over=OVER, error=0.01, scene=SCENE, checks=4):
    """Tables within an error, and the file that holds them."""
    dataset = SurrogateSettings(
        scene, over, error=error, checks=checks, engine="serial", out=folder
    ).execute()
    return dataset, folder / made_by.RESULT


@pytest.fixture(scope="module", params=["stored", pytest.param("fine", marks=pytest.mark.slow)])
def tables(request, place):
    """The stored result, which is of the same scene and ranges, within 5 %; those within 2 % take a minute."""
    if request.param == "fine":
        return made(place / "fine", error=0.02)
    path = place / "stored.nc"
    path.write_bytes(lzma.decompress((recorded.STORED / "surrogate.nc.xz").read_bytes()))
    return open_result(path), path


@pytest.fixture
def dataset(tables):
    return tables[0]


@pytest.fixture
def error(dataset):
    """What was asked for."""
    return float(dataset.attrs["error_requested"])


def exported(place, path, name, *options):
    out = place / name
    with pytest.raises(SystemExit) as leave:
        main(["export", "--result", str(path), "--out", str(out), "--overwrite", *options])
    assert leave.value.code == 0
    return out


@pytest.fixture(scope="module")
def fmu(place, tables):
    return exported(place, tables[1], "bearing.fmu")


@pytest.fixture(scope="module")
def fmpy():
    return pytest.importorskip(
        "fmpy", reason="FMUs are run by fmpy, which is not installed: pip install fmpy"
    )


def test_weights_are_exact_for_cubics_and_hold_beyond_the_ends():
    x = np.linspace(-1.0, 7.0, 33)
    held = np.clip(x, 0.0, 6.0)
    nodes = np.arange(7.0)
    assert weights(7, x) @ (nodes**3 - 4.0 * nodes) == pytest.approx(
        held**3 - 4.0 * held, abs=1e-11
    )
    assert Axis(np.array([5.0]), logarithmic=True).weights(np.array([1.0, 9.0])).tolist() == [
        [1.0],
        [1.0],
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("T", "W"),
    [
        (355.6, 2306.0),
        *(pytest.param(*at, marks=pytest.mark.slow) for at in [(358.2, 1366.0), (350.1, 2270.0)]),
    ],
)
def test_tables_are_right_at_an_operation_that_nobody_looked_at(dataset, error, T, W):
    tables = Tables.from_dataset(dataset)
    assert float(dataset.attrs["error"]) <= error
    low, high = dataset["rolling_speed"].to_numpy()[[0, -1]]
    study = RacewayFriction(slowest=float(low), fastest=float(high))
    true = study.run(
        assemble(evolve(SCENE, {"operation.temperature": T, "operation.radial_load": W}, si=True))
    )
    u = true["rolling_speed"].to_numpy()
    ratio = true["slide_roll"].to_numpy()[1:]
    folded = tables.interpolate(T, W)
    for ring in (0, 1):
        friction, force = (
            true[name].to_numpy()[ring, 0] for name in ("mean_friction", "ring_force")
        )
        for k in range(0, u.size, 6):
            w = np.full(ratio.size, u[k] / tables.numbers["outer_radius"])
            pull, rolls = folded.ring_forces(ring, w, ratio * u[k], np.full(ratio.size, u[k]))
            size = friction[k].max() * force[k]
            assert pull == pytest.approx(friction[k, 1:] * force[k], abs=2.0 * error * size)
            assert rolls[0] == pytest.approx(
                true["ring_resistance"].to_numpy()[ring, 0, k], rel=2.0 * error
            )


def test_the_drags_of_the_cage_are_those_of_the_scene_at_the_speeds_of_its_rings(dataset):
    folded = Tables.from_dataset(dataset).interpolate(SCENE.operation.temperature, 1500.0)
    for speed in (55.0, 100.0, 185.0):  # less oil is between the rings, the faster they are
        drags = assemble(evolve(SCENE, {"operation.inner_speed": speed}, si=True)).cage.drags
        for w in (-40.0, 0.0, 3.0, 60.0, 110.0):
            assert folded.drag(np.array([w]), speed, 0.0)[0] == pytest.approx(
                drags.torque(w, speed, 0.0), rel=2e-3, abs=1e-9
            )


def test_a_constant_torque_is_tabulated_over_the_speed_of_the_cage():
    scene = evolve(SCENE, {"cage.drag": ["constant-torque", "churning"]})
    ranges = {"operation.inner_speed": (50.0, 200.0), "operation.outer_speed": (0.0, 0.0)}
    k = assemble(SCENE).kinematics
    own = SCENE.operation.inner_speed / (1.0 / k.inner_radius + 1.0 / k.outer_radius)
    tables = made_by.tabulate_drags(scene, np.array([353.15]), ranges, np.array([own]))
    found = tables.terms
    torque = assemble(scene).cage.drags.torque
    cages = np.sinh(np.linspace(0.0, np.arcsinh(tables.cage_top), found["rest"].shape[1]))
    told = found["rest"][0] - found["cage"][0, 0] * cages**2
    assert told == pytest.approx([torque(w, 0.0, 0.0) for w in cages], rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("scene", "requested", "said"),
    [
        (
            evolve(SCENE, {"cage.drag": ["pocket-friction"]}),
            {},
            "one mean roller has no force in its pocket",
        ),
        (
            evolve(RIBS, {"operation.radial_load": "0 N"}),
            {},
            "operation.radial_load: tables range over it, and hold the axial load in its ratio",
        ),
        (
            evolve(new("32216", speed="1500 rpm", load="2 kN"), {"operation.axial_load": "1 kN"}),
            {"over": ["radial_load=20 N:3 kN"]},
            "20 N, with the axial load in its ratio, does not hold the rings of a tapered bearing",
        ),
        (SCENE, {"error": "40 %"}, "error: a fraction from 0.0001 to 0.2 is expected"),
        (
            SCENE,
            {"over": ["lubricant.name=a:b"]},
            "lubricant.name: there are: operation.temperature",
        ),
        (
            SCENE,
            {"over": ["radial_load=2 kN:1 kN"]},
            "the lower end must be above 0 and below the upper one",
        ),
        (SCENE, {"over": ["inner_speed=0 rpm:0 rpm"]}, "nothing rolls at any speed"),
        (SCENE, {"over": ["inner_speed=0 rpm"]}, "nothing rolls at any speed"),
    ],
)
def test_what_cannot_be_tabulated_is_refused_in_words(scene, requested, said):
    with pytest.raises(SceneError, match=said):
        SurrogateSettings(scene, **requested).plan()


def test_the_account_tells_the_error_and_the_ranges(dataset):
    account = account_of(dataset)
    assert account.record(dataset)["ranges"]["radial_load"] == [1000.0, 2500.0]
    assert account.record(dataset)["error"]["largest"] == dataset["operation_error"].max()


@pytest.fixture(scope="module")
def operations(place, tables):
    dataset, path = tables
    text = exported(place, path, "b.csv").read_text(encoding="utf-8")
    heads = [head.rstrip("]").split(" [") for head in next(csv.reader(io.StringIO(text)))]
    assert dict(heads)["temperature"] == "degC"
    assert dict(heads)["inner_speed"] == "rpm"
    assert dict(heads)["steady_cage_slip"] == "%"
    rows = [
        {
            name: quantity(f"{cell} {unit}", dataset[name].attrs["units"]) if cell else math.nan
            for (name, unit), cell in zip(heads, row.values(), strict=True)
            if name != "inside"  # 1 or 0, which the export adds
        }
        for row in csv.DictReader(io.StringIO(text))
    ]
    assert len(rows) == dataset["steady_cage_slip"].size
    return rows


@pytest.mark.parametrize("step", [25, pytest.param(5, marks=pytest.mark.slow)])
def test_a_table_of_operations_says_where_the_bearing_runs(operations, error, step):
    bearings = {}
    for row in operations[::step]:
        T, W, speed = (row[name] for name in ("temperature", "radial_load", "inner_speed"))
        if T not in bearings:
            bearings[T] = MeanRoller(evolve(SCENE, {"operation.temperature": T}, si=True))
        slip = row["steady_cage_slip"]
        left, torque = bearings[T].balanced(slip, W, speed, 0.0)
        largest = bearings[T].largest(slip, W, speed, 0.0)
        assert abs(left) <= error * largest
        assert row["friction_torque"] == pytest.approx(torque, rel=error)
        drag = bearings[T].drag(slip, speed, 0.0)
        assert row["drag_reserve"] == pytest.approx(largest / abs(drag), rel=error)


#: What one spin of all rollers leaves out, as the page says: smallest ratio of the slips, error of the torque.
ONE_SPIN = (0.79, 0.02)
#: Deviation of the cage's speed, as a fraction of its largest one.
OF_SPEED = 0.006


@pytest.mark.slow
@pytest.mark.parametrize(
    ("T", "W"),
    [
        (353.15, 1500.0),
        *(pytest.param(*at, marks=pytest.mark.slow) for at in [(353.15, 1000.0), (362.0, 2400.0)]),
    ],
)
def test_rollers_of_one_spin_slip_less_than_rollers_of_their_own_by_what_the_page_says(
    dataset, T, W
):
    told = (
        Tables.from_dataset(dataset)
        .interpolate(T, W)
        .steady_state(np.array([SCENE.operation.inner_speed]), 0.0)
    )
    run = without_bands.run(
        evolve(SCENE, {"operation.temperature": T, "operation.radial_load": W}, si=True),
        "steady-slip",
    )
    assert ONE_SPIN[0] < told.cage_slip[0] / float(run["slip_without_play"]) < 0.96
    assert told.torque[0] == pytest.approx(float(run["friction_torque"][0]), rel=ONE_SPIN[1])


def test_stiffnesses_are_what_small_forces_say(dataset):
    for t, w in ((0, 0), (0, -1), (-1, 0)):
        for k in (2, 6):
            at = {"temperature": t, "radial_load": w, "inner_speed": k}
            one = dataset.isel(at)
            keys = ("operation.temperature", "operation.radial_load", "operation.inner_speed")
            bearing = assemble(
                evolve(
                    SCENE, dict(zip(keys, (float(one[name]) for name in at), strict=True)), si=True
                )
            )
            cage = bearing.kinematics.epicyclic_cage_speed * (1.0 - float(one["steady_cage_slip"]))
            true = by_differences(bearing, cage, N_POSITIONS)
            along, across, oblique = (
                float(one[f"stiffness_{name}"]) for name in ("along", "across", "oblique")
            )
            found = np.array([[along, oblique], [oblique, across]])
            assert found == pytest.approx(true, rel=2e-3, abs=1e-5 * true[1, 1])


def test_files_hold_no_scene_and_need_tables(place, capsys):
    for name in ("b.fmu", "b.csv"):
        with pytest.raises(
            SceneError, match="is not a scene; name the scene of exported tables, and "
        ):
            format_of(name).read(b"", name)
    with pytest.raises(SceneError, match="compute them by rollslip surrogate SCENE"):
        format_of("b.fmu").write({}, None)
    to_json = ["--out", str(place / "x.json"), "--binary-only"]
    for words, said in ((["--binary-only"], "need an --out"), (to_json, "--binary-only")):
        with pytest.raises(SystemExit) as leave:
            main(["export", "gearbox", *words])
        assert leave.value.code == 2
        assert said in capsys.readouterr().err


DRIVER = r"""
#include <stdio.h>
#include <stdlib.h>
int main(int count, char **words) {
    bearing *b = malloc(bearing_size());
    double *v = bearing_values(b);
    bearing_init(b);
    v[B_FIRST_CAGE_SLIP] = atof(words[1]);
    for (int k = 0; scanf("%lf %lf %lf", v + B_RADIAL_LOAD, v + B_INNER_SPEED, v + B_OUTER_SPEED) == 3; k++) {
        if (k == 0) bearing_start(b);
        else bearing_step(b, 1e-3);
        bearing_output(b);
        printf("%.17g\n", v[B_CAGE_SPEED]);
    }
    return 0;
}
"""


def driven(place, path):
    """What moves a bearing by the file of C: cage speeds at every ms, by load and speeds of the rings up to there."""
    folder = place / path.stem
    folder.mkdir(exist_ok=True)
    code = exported(folder, path, "b.c").read_text(encoding="utf-8")
    (folder / "driver.c").write_text(f"{code}\n{DRIVER}", encoding="utf-8")
    subprocess.run(
        ["cc", "-std=c11", "-O2", "-ffp-contract=off", "driver.c", "-o", "driver", "-lm"],
        cwd=folder,
        check=True,
    )

    def speeds(inputs, slip):
        lines = "".join(f"{load!r} {inner!r} {outer!r}\n" for load, inner, outer in inputs)
        done = subprocess.run(
            [folder / "driver", repr(slip)], input=lines, capture_output=True, text=True, check=True
        )
        return np.array(done.stdout.split(), dtype=float)

    return speeds


@pytest.fixture(scope="module")
def driver(place, tables):
    return driven(place, tables[1])


BEYOND = r"""
int main(void) {
    static const double loads[] = {2000.0, 1e6, 1e6, 2000.0};
    bearing *b = malloc(bearing_size());
    bearing_init(b), bearing_start(b);
    for (int k = 0; k < 4; k++) {
        bearing_values(b)[B_RADIAL_LOAD] = loads[k];
        bearing_step(b, 1e-3), bearing_output(b);
        printf("%g ", bearing_values(b)[B_INSIDE]);
    }
    return 0;
}
"""


@needs_compiler
def test_the_file_of_c_warns_once_of_a_load_beyond_the_tables(place, tables, tmp_path):
    code = exported(place, tables[1], "beyond.c").read_text(encoding="utf-8")
    (tmp_path / "host.c").write_text(f"#include <stdlib.h>\n{code}{BEYOND}", encoding="utf-8")
    command = ["cc", "-std=c11", "-O1", "host.c", "-o", "host", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run([tmp_path / "host"], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["1", "0", "0", "1"]
    assert done.stderr == (
        "bearing: warning: radial_load is beyond the tables, which are held at their ends\n"
    )


@pytest.mark.slow
@needs_compiler
def test_equal_tables_give_equal_files_and_sources_can_be_left_out(place, tables, fmu):
    assert exported(place, tables[1], "again.fmu").read_bytes() == fmu.read_bytes()
    with (
        zipfile.ZipFile(fmu) as whole,
        zipfile.ZipFile(exported(place, tables[1], "bare.fmu", "--binary-only")) as bare,
    ):
        assert {"sources/bearing.c", "sources/fmi2.c", "sources/bearing_data.h"} < {
            *whole.namelist()
        }
        assert not [name for name in bare.namelist() if name.startswith("sources")]
        assert b"SourceFiles" not in bare.read("modelDescription.xml")


@needs_compiler
def test_types_are_those_of_the_official_headers(fmpy, dataset, tmp_path):
    headers = Path(fmpy.__file__).parent / "c-code"
    for name, text in sources(dataset)[0].items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    for more in ([], ["-DFMI2_HEADERS", f"-I{headers}"]):
        subprocess.run(["cc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-Wno-missing-braces", *more, "-c", "fmi2.c"],
                       cwd=tmp_path, check=True)  # fmt: skip


@needs_compiler
def test_a_host_by_the_official_headers_calls_the_library(fmpy, fmu, place, tmp_path):
    described = fmpy.read_model_description(str(fmu))
    at = {one.name.upper(): one.valueReference for one in described.modelVariables}
    folder = Path(fmpy.extract(str(fmu), str(tmp_path / "unit"))) / "binaries" / "linux64"
    host = Path(__file__).parents[1] / "support" / "fmi2_host.c"
    names = [f"-D{name}={at[name]}" for name in ("RADIAL_LOAD", "CAGE_SPEED")]
    headers = Path(fmpy.__file__).parent / "c-code"
    subprocess.run(["cc", "-std=c11", "-Wall", "-Werror", *names, f"-I{headers}", host, str(folder / "bearing.so"),
                    f"-Wl,-rpath,{folder}", "-o", "host", "-lm"], cwd=tmp_path, check=True)  # fmt: skip
    done = subprocess.run(
        [tmp_path / "host", described.guid, "9000"], capture_output=True, text=True, check=True
    )
    *said, speed = done.stdout.splitlines()
    assert said == ["host 1 logStatusWarning radial_load is beyond the tables, which are held at their ends",
                    "host 3 logStatusError no such variable"]  # fmt: skip
    assert float(speed) == Unit(fmpy, fmu, place, "called", radial_load=9000.0).go(50)


@needs_compiler
def test_the_file_of_c_moves_as_the_fmu_does(driver, fmpy, fmu):
    speeds = driver(
        [(SCENE.operation.radial_load, SCENE.operation.inner_speed, 0.0)] * 101, slip=0.0
    )
    assert (
        speeds[-1]
        == fmpy.simulate_fmu(str(fmu), stop_time=0.1, output_interval=1e-3)["cage_speed"][-1]
    )


def test_the_fmu_of_the_page_has_the_version_and_the_error_that_are_stated_there():
    docs = Path(__file__).parents[2] / "docs"
    page = " ".join((docs / "howto" / "surrogate.rst").read_text(encoding="utf-8").split())
    with zipfile.ZipFile(docs / "examples" / "gearbox.fmu") as archive:
        described = archive.read("modelDescription.xml").decode()
        version = re.search('generationTool="(.*?)"', described)[1]
        error = re.search("friction within (.*?) of", described)[1]
        assert f"by {version}, with a table error of {error}" in page
        for name in ("bearing.c", "fmi2.c"):
            # otherwise: python docs/scripts/fmu_hosts.py --export
            assert archive.read(f"sources/{name}") == (
                Path(made_by.__file__).with_name(name).read_bytes()
            )
    rows = rows_of(TABLES / "fmu_hosts.csv")
    for row in rows:
        torque = float(row["torque of the FMU, N m"])
        assert torque == pytest.approx(float(row["of rollslip run, N m"]), rel=0.01)
        assert float(row["largest difference between hosts"]) < 1e-10
    assert len(rows) == 5


@needs_compiler
def test_the_standard_finds_nothing(fmpy, fmu):
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmu)) == []


class Unit:
    """One instance of an FMU, between its steps."""

    def __init__(self, fmpy, fmu, place, name="one", **start):
        from fmpy import fmi2

        self.said, described = [], fmpy.read_model_description(str(fmu))
        folder = fmpy.extract(str(fmu), str(place / f"unpacked-{name}"))
        self.at = {one.name: one.valueReference for one in described.modelVariables}
        self.unit = fmi2.FMU2Slave(
            guid=described.guid, unzipDirectory=folder, modelIdentifier="bearing", instanceName=name
        )
        calls = fmi2.fmi2CallbackFunctions()
        calls.logger = fmi2.fmi2CallbackLoggerTYPE(
            lambda env, who, status, category, text, *rest: self.said.append(status)
        )
        calls.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        calls.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        self.unit.instantiate(callbacks=calls, loggingOn=True)
        self.unit.setupExperiment(startTime=0.0)
        self.unit.enterInitializationMode()
        self.set(**start)
        self.unit.exitInitializationMode()
        self.time = 0.0

    def set(self, **values):
        self.unit.setReal([self.at[name] for name in values], [*values.values()])

    def get(self, name):
        return self.unit.getReal([self.at[name]])[0]

    def go(self, steps, span=1e-3):
        for _ in range(steps):
            self.unit.doStep(currentCommunicationPoint=self.time, communicationStepSize=span)
            self.time += span
        return self.get("cage_speed")


@needs_compiler
def test_two_instances_know_nothing_of_each_other_and_a_state_brings_back_all_of_one(
    fmpy, fmu, place
):
    one = Unit(fmpy, fmu, place)
    two = Unit(fmpy, fmu, place, "two", radial_load=2400.0, first_cage_slip=0.3)
    alone = Unit(fmpy, fmu, place, "alone").go(40)
    assert [(one.go(1), two.go(1))[0] for _ in range(40)][-1] == alone
    kept = one.unit.getFMUstate()
    at = one.time
    stored = one.unit.serializeFMUstate(kept)
    first = one.go(30)
    one.set(radial_load=1100.0)
    assert one.go(20) != first
    one.unit.setFMUstate(kept)
    one.time = at
    assert one.go(30) == first
    two.unit.setFMUstate(two.unit.deSerializeFMUstate(stored))
    assert two.go(30) == first


@needs_compiler
def test_steps_of_any_length_come_to_the_same(fmpy, fmu, place):
    ends = [
        Unit(fmpy, fmu, place, f"by{n}", first_cage_slip=0.2).go(n, 0.1 / n)
        for n in (1000, 100, 10)
    ]
    assert ends == pytest.approx([ends[0]] * 3, rel=1e-4)


@needs_compiler
def test_inputs_beyond_the_tables_are_held_and_logged(fmpy, fmu, place):
    unit = Unit(fmpy, fmu, place, "beyond", radial_load=2500.0)
    assert unit.said == []
    at_the_end = unit.go(100)
    over = Unit(fmpy, fmu, place, "over", radial_load=9000.0, temperature=400.0)
    unit.set(temperature=400.0)
    assert unit.go(1) < 1.1 * at_the_end
    assert unit.said == over.said == [1]
    unit.set(temperature=350.0, radial_load=2000.0)
    unit.go(1)
    assert unit.said == [1, 0]
    assert (unit.get("inside"), over.get("inside")) == (1.0, 0.0)
    held = Unit(fmpy, fmu, place, "held", radial_load=2500.0, temperature=363.15)
    assert over.go(50) == pytest.approx(held.go(50), rel=1e-9)


def ramp(t, first, last, begins, within):
    return first + (last - first) * min(max((t - begins) / within, 0.0), 1.0)


RPM = np.pi / 30.0
#: Load and speeds of inner and outer ring over time, and what says the same to study dynamics, if it is asked.
MOTIONS = {
    "constant": (lambda t: (1500.0, 1500.0 * RPM, 0.0), {}),
    "run-up": (lambda t: (1500.0, ramp(t, 600.0, 1500.0, 0.0, 0.2) * RPM, 0.0),
               {"inner_speed": {"shape": "ramp", "from": "600 rpm", "to": "1500 rpm", "within": "0.2 s"}}),
    "load drop": (lambda t: (2500.0 if t < 0.2 else 1000.0, 1500.0 * RPM, 0.0),
                  {"radial_load": {"shape": "step", "from": "2.5 kN", "to": "1 kN", "at": "0.2 s"}}),
}  # fmt: skip


def both_rings(t):
    return 1500.0, ramp(t, 900.0, 1400.0, 0.1, 0.2) * RPM, ramp(t, 250.0, -200.0, 0.1, 0.3) * RPM


def moved(driver, inputs, n_positions):
    """Cage speeds [rad/s] at every ms in a motion, the inputs those in the middle of steps."""
    middles = (max(1e-3 * k - 0.5e-3, 0.0) for k in range(n_positions))
    return driver([inputs(t) for t in middles], slip=0.1)


@needs_compiler
@pytest.mark.parametrize("name", MOTIONS)
def test_the_cage_moves_as_by_the_laws_of_the_bearing(driver, error, name):
    inputs, _ = MOTIONS[name]
    times = 1e-3 * np.arange(601)
    true = MeanRoller(SCENE).motion(times, 0.1, inputs)
    assert (
        np.abs(moved(driver, inputs, times.size) - true).max() <= 0.1 * error * np.abs(true).max()
    )


@pytest.mark.slow
@needs_compiler
def test_the_cage_moves_as_by_the_laws_where_both_rings_turn(place):
    over = [
        "radial_load=1.5 kN",
        "temperature=80 degC",
        "inner_speed=900 rpm:1400 rpm",
        "outer_speed=-200 rpm:250 rpm",
    ]
    # with few slices too many nodes would be needed where a ring turns backwards; friction has kinks over the load,
    # so that the finest tables leave 1.2 %
    scene = rollslip.load_scene("gearbox")
    _, path = made(place / "both", over, scene=scene, error=0.015)
    times = 1e-3 * np.arange(601)
    true = MeanRoller(scene).motion(times, 0.1, both_rings)
    assert (
        np.abs(moved(driven(place, path), both_rings, times.size) - true).max()
        <= 1e-3 * np.abs(true).max()
    )


@pytest.mark.slow
@needs_compiler
@pytest.mark.parametrize("name", MOTIONS)
def test_the_cage_moves_nearly_as_in_study_dynamics_with_the_friction_of_every_slice(driver, name):
    inputs, history = MOTIONS[name]
    motion = {"friction": "conventional", "level": "cage-set", "duration": 0.6, "points": 601, "cage_slip": 0.1,
              "history": history}  # fmt: skip
    told = {f"study.dynamics.{key}": value for key, value in motion.items() if value} | {
        "accuracy.tolerance": 0.05
    }
    true = np.abs(
        rollslip.run(evolve(SCENE, told, si=True), study="dynamics")["cage_speed"].to_numpy()
    )
    assert np.abs(moved(driver, inputs, true.size) - true).max() <= OF_SPEED * true.max()


@pytest.mark.slow
@needs_compiler
def test_the_rotor_of_the_page_runs_up_as_by_the_laws_of_its_bearing(fmpy, fmu, error):
    example = Path(__file__).parents[2] / "docs" / "examples" / "rotor_fmu.py"
    spec = importlib.util.spec_from_file_location("rotor_fmu", example)
    rotor = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(rotor)
    time, speed, load, slip, *_ = np.array(rotor.run(str(fmu))).T
    bearing = MeanRoller(SCENE)

    def rates(t, y):
        torque = rotor.motor(y[2])
        spin, cage, inner, _ = bearing.torques(
            y[0], bearing.r * (y[1] + y[0]), rotor.WEIGHT + rotor.MESH * torque, y[2], 0.0
        )
        return [cage / bearing.orbital, spin / bearing.spin, (torque - inner) / rotor.INERTIA]

    w = bearing.cage_speed(0.0, rotor.FIRST, 0.0)
    spin = 0.5 * (bearing.Ri * (rotor.FIRST - w) + bearing.Ro * w) / bearing.r - w
    y = solve_ivp(rates, (0.0, 0.5), [w, spin, rotor.FIRST], "LSODA", time, rtol=1e-5, atol=1e-4).y
    true = 1.0 - y[0] / np.array([bearing.cage_speed(0.0, one, 0.0) for one in y[2]])
    assert speed == pytest.approx(y[2], rel=2e-3)  # steps of Euler in the driver
    assert slip == pytest.approx(true, abs=4e-3)
    assert slip[-1] == pytest.approx(true[-1], rel=2.0 * error)
    assert load[0] == 2.0 * rotor.WEIGHT > 1.9 * load[-1]


def test_tables_are_made_and_a_second_call_goes_on_with_what_is_there(tmp_path, monkeypatch):
    # laws that read no speed of the rings: the bearing is put together once, not at every rolling speed
    scene = evolve(
        SCENE,
        {
            "accuracy.slices": 3,
            "models.approach": "dry",
            "models.film": "moes",
            "models.traction": "muraki",
            "cage.drag": [
                "rolling-resistance",
                {"model": "constant-torque", "size": "0.1 N m"},
            ],
        },
    )
    over = ["radial_load=1.4 kN:1.6 kN", "temperature=80 degC", "inner_speed=1400 rpm:1500 rpm"]
    first, _ = made(tmp_path, over, 0.2, scene)
    bearing = MeanRoller(evolve(scene, {"operation.temperature": 353.15}, si=True))
    found = (
        Tables.from_dataset(first).interpolate(353.15, 1500.0).steady_state(np.array([150.0]), 0.0)
    )
    left, torque = bearing.balanced(found.cage_slip[0], 1500.0, 150.0, 0.0)
    assert abs(left) <= 0.02 * bearing.largest(found.cage_slip[0], 1500.0, 150.0, 0.0)
    assert found.torque[0] == pytest.approx(torque, rel=0.02)

    def not_again(*args, **kwargs):
        raise AssertionError("a point was computed again")

    monkeypatch.setattr(RacewayFriction, "run", not_again)
    monkeypatch.setattr(made_by, "drag_errors", lambda scene, T, tables: np.full(T.size, 0.15))
    again, _ = made(tmp_path, over, 0.2, scene)
    assert float(first.attrs["error"]) < float(again.attrs["error"]) == 0.15
    assert again["mean_friction"].equals(first["mean_friction"])
    assert json.loads(again.attrs["nodes"]) == json.loads(first.attrs["nodes"])
    assert cli.get_command(click.Context(cli), "surrogate") is not None
