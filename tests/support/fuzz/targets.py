"""What is fuzzed: functions of some bytes that return if rollslip does what it promises for them, and raise if not.

- A target takes bytes, so that hypothesis, libFuzzer and a kept case feed it alike.
- The promise is one of two outcomes: a value that holds its invariants, or an error of rollslip that names the place.
- A mutator knows the format, so that most of what it makes passes the first parser and reaches what lies behind it.
"""

import contextlib
import json
import math
import re
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import attrs
import numpy as np
import xarray as xr

from fuzz import stages
from rollslip import open_result
from rollslip.bearing.assembly import assemble
from rollslip.errors import OutputError, PluginError, SceneError
from rollslip.results.dataset import save
from rollslip.scene import Scene, resolved, scene_hash
from rollslip.scene.changes import evolve, parse_set
from rollslip.scene.interchange import read_foreign, to_parameters
from rollslip.scene.reading import load_scene, shipped_scenes
from rollslip.scene.schema import schema
from rollslip.structure import structure
from rollslip.studies.study import settings
from rollslip.units import UnitError, format_quantity, quantity
from rollslip_campaigns.measurement.rig import EXAMPLE, load_rig, read_data

ROOT = Path(__file__).parents[3]
FOLDER = Path(tempfile.mkdtemp(prefix="rollslip-fuzz-"))


@attrs.frozen
class Target:
    """What to call, inputs to start from, and how to make new ones of them."""

    run: Callable
    seeds: list
    mutate: Callable

    def draw(self, random):
        """Return a new input."""
        return self.mutate(random, random.choice(self.seeds))


def _file(name, data):
    path = FOLDER / name
    path.write_bytes(data)
    return path


@contextlib.contextmanager
def refused(*kinds, place=""):
    """Let errors of rollslip pass if they name the place and are short enough to be read."""
    error = None
    try:
        yield
    except kinds as raised:
        error = raised
    if error is None:
        return
    problems = error.problems if isinstance(error, SceneError) else [str(error)]
    assert problems, "an error without a word"
    for problem in problems:
        assert str(place) in problem, f"no place in {problem!r}"
        assert len(problem) < 4000 or isinstance(error, PluginError), (
            f"a message of {len(problem)} characters"
        )


# Text ---------------------------------------------------------------------------------------------------------------


def scene(data):
    """A scene file: a scene that survives being written out and read, or an error with file, line and key."""
    path = _file("scene.toml", data)
    with refused(SceneError, PluginError, place=path):
        read = load_scene(path)
        assert structure(Scene, json.loads(json.dumps(resolved(read))), "", []) == read
        assert evolve(read, {}) == read
        assert len(scene_hash(read)) == 64


def bearing(data):
    """What of a scene is read later, oil, models and studies, and the bearing put together of it."""
    path = _file("scene.toml", data)
    try:
        read = load_scene(path)
    except (SceneError, PluginError):  # of these `scene` takes care
        return
    with refused(PluginError), refused(SceneError, place=path):
        settings(read)
        made = assemble(read)
        assert np.isfinite(made.drop).all()


@cache
def _base():
    return load_scene(shipped_scenes()[0])


def setting(data):
    """``--set KEY=VALUE``: a key and a value that give a scene or are refused."""
    with refused(SceneError, PluginError):
        key, value = parse_set(data.decode(errors="replace"))
        changed = evolve(_base(), {key: value}, si=True)
        assert structure(Scene, json.loads(json.dumps(resolved(changed))), "", []) == changed


UNITS = sorted({row.unit for row in schema()} - {""})


def unit(data):
    """A quantity: a finite value that is read back as it is shown, or an error."""
    expected = UNITS[data[0] % len(UNITS)] if data else "1"
    with refused(UnitError):
        value = quantity(data[1:].decode(errors="replace"), expected)
        assert math.isfinite(value)
        with refused(UnitError):  # beyond the largest float in a smaller unit
            back = quantity(format_quantity(value, expected, 17), expected)
            assert math.isclose(
                back, value, rel_tol=1e-12, abs_tol=1e-9 if expected == "K" else 0.0
            ), (back, value)


def rig(data):
    """A rig file."""
    path = _file("rig.toml", data)
    with refused(SceneError, PluginError, place=path):
        load_rig(path)


def parameters(data):
    """A file of parameters in JSON, as other programs write it."""
    path = _file("parameters.json", data)
    with refused(SceneError, PluginError, place=path):
        read_foreign(path)


def measurements(data):
    """A table of measurements: finite numbers, or an error with file and line."""
    path = _file("data.csv", data)
    with refused(SceneError, place=path):
        read = read_data(path)
        assert len(read) > 0
        for column in read.columns.values():
            assert column.shape == (len(read),)
            assert np.isfinite(column).all()


def result(data):
    """A file of results: a dataset, or an error that names the file."""
    path = _file("result.nc", data)
    with refused(OutputError, place=path):
        open_result(path)


#: Numbers at the ends of doubles, integers that are large, other spellings, and what is nearly a number.
_NUMBERS = [
    *(
        "0",
        "-0",
        "1",
        "-1",
        "3",
        "17",
        "1e-3",
        "0.5",
        "-0.0",
        "1e308",
        "-1e308",
        "1e309",
        "5e-324",
        "1e-300",
        "nan",
    ),
    *(
        "-nan",
        "inf",
        "-inf",
        "0x7fff",
        "0o17",
        "0b11",
        "1_000",
        "9223372036854775808",
        "9" * 400,
        "9" * 5000,
    ),
    *(
        "0x" + "f" * 5000,
        "0.1e1",
        "1e400",
        "1e-400",
        "1.7976931348623157e308",
        "6371",
        "1000000000",
        "1e-5",
    ),
]
#: Units of scenes, misspelt ones, and what only looks like a unit.
_UNITS = [
    *(
        "",
        "mm",
        "m",
        "um",
        "rpm",
        "rad/s",
        "degC",
        "K",
        "N",
        "kN",
        "MPa",
        "GPa",
        "1/GPa",
        "Pa s",
        "mPa s",
        "%",
    ),
    *(
        "kg/m3",
        "J/(kg K)",
        "J/kg K",
        "W/(m K)",
        "W/(m K",
        "mrad",
        "°C",
        "µm",
        "m²",
        "m^2",
        "m m4",
        "1/(GPa K)",
        "m5",
    ),
    *(
        "furlong",
        "m/",
        "/",
        "m//s",
        "(m)",
        "K K",
        "degC/s",
        "1 1",
        "\xa0mm",
        "m\u0661",
        "mm " * 5000,
    ),
    f"m{' ' * 5000}mm",
]
#: Names of models, oils and bearings, and texts that lead astray: paths, formats, quotes.
_TEXTS = [
    *(
        "none",
        "table",
        "circular",
        "iso16281",
        "moes",
        "lambda-blend",
        "muraki",
        "kragelsky",
        "palmgren",
        "lundberg",
    ),
    *(
        "mil-prf-7808",
        "1032930",
        "walther",
        "vogel",
        "barus",
        "roelands",
        "yasutomi",
        "inner",
        "outer",
        "epicyclic",
    ),
    *(
        "",
        " ",
        "1,5 mm",
        "1.000,5 N",
        "\u0661\u0665 mm",
        "\uff11\uff15 mm",
        "a" * 5000,
        "\U0001f600",
        "\u202e",
    ),
    *(
        "\ufeff",
        "e\u0301",
        "\u2028",
        "rollslip>=0.1",
        "no-such>=1",
        ">=",
        "a;b",
        "[x]",
        "../x",
        "%s{}{0}",
        "'",
        "\\",
    ),
]
#: TOML values of all kinds, right and broken.
_TOKENS = [
    *(
        "1979-05-27",
        "1979-05-27T07:32:00Z",
        "07:32:00",
        "true",
        "false",
        "[]",
        "{}",
        "[[]]",
        "[1, 'a', {}]",
        "''''''",
    ),
    *(
        "{ model = 'muraki' }",
        "{ model = 'lambda-blend', hydrodynamic = { model = 'eyring' } }",
        "{ model = 1 }",
    ),
    "{ shape = 'table', position = [-7.5e-3, 0, 7.5e-3], drop = [1e-5, 0, 1e-5] }",
    "{ shape = 'circular', radius = 5 }",
    "[{ temperature = '40 degC', viscosity = '12 mPa s' }, { temperature = '70 degC', viscosity = '5 mPa s' }]",
    *(
        "[" * 50 + "]" * 50,
        "[" * 2000 + "]" * 2000,
        "{a=" * 50 + "1" + "}" * 50,
        "{a=" * 400 + "1" + "}" * 400,
    ),
    *(
        "'a",
        '"\\x"',
        '"\\u0000"',
        '"\\ud800"',
        '"\\U00110000"',
        "1 2",
        "=",
        "#",
        "1__0",
        "00",
        "+1",
        "1.",
        ".5",
        "1e",
    ),
]
_JSON = [
    "null",
    "true",
    '""',
    "[]",
    "{}",
    "[1, 2]",
    '{"value": 1, "unit": "furlong"}',
    '"\\ud800"',
    '"\\u0000"',
    "-1e999",
]
_KEYS = [row.key.replace("*", "x") for row in schema()]
_KEYS += [
    f"lubricant.{key}"
    for key in ("viscosity_law", "points", "density", "pressure_viscosity_law", "viscosity_factor")
]
_KEYS += [
    "x",
    '""',
    '"a.b"',
    "'\u00e4'",
    '"\\n"',
    "1",
    "1.2",
    "a.b.c.d.e",
    ".".join("a" * 1000),
    "study.x" + ".a" * 60,
]
_MARKS = [
    '"',
    "'",
    '"""',
    "'''",
    "[",
    "]",
    "{",
    "}",
    ".",
    ",",
    "=",
    "#",
    "\n",
    "\r",
    "\t",
    "\x00",
    "\ufeff",
    "\ud7ff",
]


def _number(random):
    return (
        random.choice(_NUMBERS)
        if random.random() < 0.5
        else f"{random.gauss(0, 1) * 10 ** random.gauss(0, 6):g}"
    )


def _quantity(random):
    return f"{_number(random)} {random.choice(_UNITS)}"


def _value(random):
    """Return a value as TOML writes it, often of the wrong kind."""
    kind = random.randrange(6)
    if kind == 0:
        return _number(random)
    if kind == 1:
        return f'"{_quantity(random)}"'
    if kind == 2:
        return json.dumps(random.choice(_TEXTS), ensure_ascii=random.random() < 0.5)
    if kind == 3:
        return "[" + ", ".join(_value(random) for _ in range(random.randrange(4))) + "]"
    return random.choice(_TOKENS)


def _changed_number(random, text):
    return (
        _number(random) if random.random() < 0.2 else f"{float(text) * 10 ** random.gauss(0, 3):g}"
    )


def changed_toml(random, data):
    """Return a file near another one: values, keys and tables changed, put in and taken out."""
    text = data.decode(errors="replace")
    for _ in range(random.choice((1, 1, 1, 2, 3, 8))):
        lines = text.split("\n")
        at = random.randrange(len(lines))
        key, equals, value = lines[at].partition("=")
        kind = random.randrange(10)
        if kind < 5 and equals:
            changed = re.sub(
                r"\d+\.?\d*(e-?\d+)?", lambda found: _changed_number(random, found[0]), value
            )
            lines[at] = f"{key}={changed if kind < 2 else ' ' + _value(random)}"
        elif kind < 6:
            del lines[at]
        elif kind < 7:
            lines.insert(at, random.choice(lines))
        elif kind < 8:
            table = random.choice(_KEYS).rpartition(".")[0] or "x"
            lines.insert(at, f"[{table}]" if random.random() < 0.8 else f"[[{table}]]")
        elif kind < 9:
            key = random.choice(_KEYS)
            lines.insert(
                at, f"{key if random.random() < 0.5 else key.rpartition('.')[2]} = {_value(random)}"
            )
        else:
            place = random.randrange(len(lines[at]) + 1)
            lines[at] = (
                lines[at][:place] + random.choice(_MARKS) + lines[at][place + random.randrange(3) :]
            )
        text = "\n".join(lines)
    data = text.encode(errors="replace")
    return changed_bytes(random, data) if random.random() < 0.1 else data


def changed_setting(random, data):
    """Return a setting of any key."""
    return f"{random.choice(_KEYS)}{random.choice(['=', ' = ', '', '=='])}{_value(random)}".encode()


def changed_unit(random, data):
    """Return a quantity for any unit."""
    return random.randbytes(1) + _quantity(random).encode()


def changed_bytes(random, data):
    """Return the bytes with a few of them changed, taken out or put in, or cut off."""
    for _ in range(random.choice((1, 1, 2, 8))):
        place = random.randrange(len(data) + 1)
        count = random.randrange(4)
        out = count if random.random() < 0.8 else random.randrange(4)  # else what lies behind moves
        data = data[:place] + random.randbytes(count) + data[place + out :]
    return data[: random.randrange(len(data) + 1)] if random.random() < 0.2 else data


def changed_json(random, data):
    """Return JSON with a few of its values and names changed, or another character in it."""
    text = data.decode()
    for _ in range(random.choice((1, 1, 2, 4))):
        tokens = [*re.finditer(r'"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:e-?\d+)?', text)]
        at = random.choice(tokens)
        kind = random.randrange(4)
        if kind == 3:
            place = random.randrange(len(text))
            text = text[:place] + random.choice(_MARKS) + text[place + random.randrange(2) :]
            continue
        new = random.choice(tokens)[0] if kind == 2 else random.choice((_number(random), *_JSON))
        text = text[: at.start()] + new + text[at.end() :]
    return text.encode(errors="replace")


def changed_csv(random, data):
    """Return a table with cells, columns and rows changed."""
    lines = data.decode(errors="replace").split("\n")
    for _ in range(random.choice((1, 1, 2, 4))):
        at = random.randrange(len(lines))
        cells = lines[at].split(",")
        which = random.randrange(len(cells))
        kind = random.randrange(6)
        if kind < 2:
            cells[which] = (
                _number(random)
                if at
                else cells[which].partition("[")[0] + f"[{random.choice(_UNITS)}]"
            )
        elif kind < 3:
            cells[which] += random.choice([*_MARKS, *_TEXTS])
        elif kind < 4:
            del cells[which]
        elif kind < 5:
            cells.insert(which, random.choice(cells))
        else:
            cells = random.choice(lines).split(",")
        lines[at] = ",".join(cells)
    data = "\n".join(lines).encode(errors="replace")
    return changed_bytes(random, data) if random.random() < 0.1 else data


#: A bearing, an oil and a profile of the user's own, in the forms that shipped scenes do not use.
OWN = b"""\
[bearing]
rollers = 12
roller_diameter = "10 mm"
roller_length = "12 mm"
inner_raceway_diameter = "40 mm"
outer_raceway_diameter = 0.06002
material = { elastic_modulus = "300 GPa", poisson_ratio = 0.26 }

[bearing.profile]
shape = "table"
position = ["-6 mm", 0, "3 mm", "6 mm"]
drop = ["10 um", 0, 0, "10 um"]

[lubricant]
viscosity_law = "vogel"
density = "870 kg/m3"
conductivity = 0.14
eyring_stress = "5 MPa"
shear_modulus = "0.2 GPa"
maximum_temperature = "150 degC"
viscosity_factor = 1.1

[[lubricant.points]]
temperature = "20 degC"
viscosity = "80 mPa s"

[[lubricant.points]]
temperature = "40 degC"
kinematic_viscosity = "32 mm2/s"

[[lubricant.points]]
temperature = "70 degC"
viscosity = "9 mPa s"

[[lubricant.points]]
temperature = "100 degC"
kinematic_viscosity = "5.4 mm2/s"

[lubricant.pressure_viscosity_law]
model = "yasutomi"
glass_temperature = "-73 degC"
a1 = 188.86
a2 = "0.719 1/GPa"
b1 = 8.2
b2 = "0.192 1/GPa"
c1 = 16.09
c2 = 17.38

[operation]
inner_speed = "3000 rpm"
outer_speed = "-100 rpm"
radial_load = "1 kN"
temperature = "60 degC"
inner_ring_temperature = "70 degC"
misalignment = "0.2 mrad"

[models]
contact = "lundberg"

[models.traction]
model = "lambda-blend"
boundary = { model = "constant", coefficient = 0.1 }
hydrodynamic = "maxwell-eyring"

[cage]
mass = "0.4 kg"

[study.friction-curve]
normal_force = ["300 N", 518]
max_slip = 0.2

[accuracy]
slices = 21

[plugins]
require = ["rollslip>=0.1"]
"""
CSV = b"""\
# measured
slide_roll_ratio [1], friction [1], rolling_speed [m/s], max_pressure [GPa], temperature [degC]
0.01, 0.02, 2, 1.1, 40
0.05, 0.045, 2, 1.1, 40
0.1, 0.05, 2, 1.1, 40
"""
SCENES = [
    path.read_bytes()
    for path in sorted((ROOT / "plugins" / "rollslip_plugins" / "scenes").glob("*.toml"))
]
SCENES += [path.read_bytes() for path in sorted((ROOT / "docs" / "examples").glob("*.toml"))] + [
    OWN
]


def _result():
    """Return a small file of results."""
    slip = xr.Variable("slip", np.linspace(0.0, 1.0, 11), {"units": "1", "long_name": "slip"})
    friction = xr.Variable(
        ("ring", "slip"), np.ones((2, 11)), {"units": "1", "long_name": "friction"}
    )
    attributes = {
        "study": "friction-curve",
        "scene_hash": 64 * "0",
        "models": json.dumps([{"name": "moes"}]),
    }
    save(
        xr.Dataset({"friction": friction}, {"slip": slip, "ring": ["inner", "outer"]}, attributes),
        FOLDER / "seed.nc",
    )
    return (FOLDER / "seed.nc").read_bytes()


TARGETS = {
    "scene": Target(scene, SCENES, changed_toml),
    "bearing": Target(bearing, SCENES, changed_toml),
    "setting": Target(setting, [b"operation.radial_load=500 N"], changed_setting),
    "unit": Target(unit, [b"\x0015 mm"], changed_unit),
    "rig": Target(rig, [EXAMPLE.encode()], changed_toml),
    "parameters": Target(
        parameters, [json.dumps(to_parameters(load_scene("gearbox"))).encode()], changed_json
    ),
    "measurements": Target(measurements, [CSV], changed_csv),
    "result": Target(result, [_result()], changed_bytes),
    "stages": Target(stages.run, stages.SEEDS, stages.changed),
}
