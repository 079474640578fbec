"""Write the tables of a surrogate for other programs: as an FMU (FMI 2.0 for co-simulation), as C, and as CSV.

- These are scene formats: found by the ending of a file name, written by ``rollslip export --result surrogate.nc``.
  They hold no scene, so that nothing is read from them.
- Equal tables give identical files: the GUID is a hash of the numbers, entries of archives have a fixed date, and the
  compiler receives no path. The library is compiled for this machine; hosts of another system compile the sources.
"""

import abc
import csv
import io
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import uuid
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable, Mapping
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, Final

import attrs
import numpy as np

from rollslip.errors import OutputError, SceneError
from rollslip.results.dataset import about, xr
from rollslip.results.table import in_shown_unit
from rollslip.scene.formats import Read, SceneFormat, Written
from rollslip.scene.values import Scene
from rollslip_campaigns.surrogate import SurrogateSettings
from rollslip_campaigns.surrogate.findings import axial_sentences
from rollslip_campaigns.surrogate.tables import CAGE_SMALL, Axis, Tables
from rollslip_studies.motion.rib_friction import LINEAR_SPEED

__all__ = [
    "CSV_FORMAT",
    "C_FORMAT",
    "FMU_FORMAT",
    "VARIABLES",
    "TablesFormat",
    "c_header",
    "sources",
]

#: Name, unit, causality, start and meaning of the variables of an FMU, in the order of bearing.h.
VARIABLES: Final = (
    ("time", "s", "independent", "", "time"),
    ("radial_load", "N", "input", "first_load", "radial load"),
    ("inner_speed", "rad/s", "input", "first_inner_speed", "speed of the inner ring"),
    ("outer_speed", "rad/s", "input", "first_outer_speed", "speed of the outer ring"),
    ("temperature", "K", "input", "first_temperature", "temperature of oil, rings and rollers"),
    ("cage_speed", "rad/s", "output", "", "speed of the cage"),
    ("roller_speed", "rad/s", "output", "", "mean spin of the rollers relative to the cage"),
    ("cage_slip", "1", "output", "", "1 - cage speed/cage speed without slip"),
    ("torque", "N.m", "output", "", "torque that drives the inner ring against rollers and land"),
    (
        "outer_torque",
        "N.m",
        "output",
        "",
        "torque that drives the outer ring against rollers and land",
    ),
    ("power_loss", "W", "output", "", "sliding, rolling and drags turned into heat"),
    ("drag_reserve", "1", "output", "", "largest torque of the rollers on the cage over its drag"),
    ("first_cage_slip", "1", "parameter", "", "cage slip at the start"),
    (
        "inside",
        "1",
        "output",
        "",
        "1 where load, speeds and temperature are within the tables, 0 beyond",
    ),
)
#: Exponents of the SI base units of each unit.
_UNITS: Final[Mapping[str, dict[str, str]]] = {
    "s": {"s": "1"}, "N": {"kg": "1", "m": "1", "s": "-2"}, "rad/s": {"rad": "1", "s": "-1"}, "K": {"K": "1"}, "1": {},
    "N.m": {"kg": "1", "m": "2", "s": "-2"}, "W": {"kg": "1", "m": "2", "s": "-3"},
}  # fmt: skip
#: Date of the entries of an archive, the first that ZIP can hold; a fixed one makes archives of equal tables identical.
_DATE: Final = (1980, 1, 1, 0, 0, 0)
#: Namespace of GUIDs, drawn at random once; another one changes all GUIDs.
_GUID_NAMESPACE: Final = uuid.UUID("6f0b1a3c-6c0e-5d0c-9f0e-0a5b7c1d2e3f")
#: Flags of the compiler: no debugging information and no build id, which hold paths, and no fused multiplications,
#: which would give other results on another processor.
_FLAGS: Final = (
    "-std=c11",
    "-O2",
    "-g0",
    "-ffp-contract=off",
    "-shared",
    "-fPIC",
    "-fvisibility=hidden",
    "-Wall",
    "-Wextra",
    "-Wl,--build-id=none",
)


#: Files in C that are the same for each bearing.
_C_FILES: Final = ("bearing.h", "bearing.c", "fmi2.c")
#: Number of characters after which a line of numbers in C ends, because some compilers limit lines. Half as many make a
#: file of twice as many lines. Chosen: the width of an editor.
_LINE_LENGTH = 110


def _read_source(name: str) -> str:
    """Return the text of a file in C of this package."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def _array(name: str, values: Any, kind: str) -> str:
    """Return the definition of an array in C: floats with eight digits, doubles with as many as they need."""
    values = np.asarray(values, dtype=float)
    numbers = (f"{v:.8g}" if kind == "float" else repr(v) for v in values.ravel().tolist())
    sizes = "".join(f"[{n}]" for n in values.shape)
    text = ""
    line = ""
    for number in numbers:
        if len(line) > _LINE_LENGTH:
            text += f"{line}\n"
            line = ""
        line += f"{number},"
    return f"static const {kind} {name}{sizes} = {{\n{text}{line}\n}};\n"


def c_header(result: "xr.Dataset") -> tuple[str, str]:
    """Return the tables as a header in C, and the GUID that is a hash of them."""
    tables = Tables.from_dataset(result)
    n = tables.numbers

    def axis_macros(letter: str, axis: Axis) -> str:
        nodes = np.log(axis.nodes) if axis.logarithmic else axis.nodes
        step = float(nodes[-1] - nodes[0]) / (nodes.size - 1) if nodes.size > 1 else 1.0
        return (
            f"#define N{letter} {nodes.size}\n#define {letter}_FIRST {float(nodes[0])!r}\n"
            f"#define {letter}_STEP {step!r}\n"
        )

    # axes of temperature, load, cage ratio and rolling speed
    text = "".join(map(axis_macros, "TWRU", tables.axes.values()))
    rest = tables.drags["rest"]
    cage_step = float(np.arcsinh(tables.cage_top / CAGE_SMALL)) / (rest.shape[1] - 1)
    numbers = {
        "RI": n["inner_radius"], "RO": n["outer_radius"], "ROLLER": n["roller_radius"],
        "ORBITAL_INERTIA": n["orbital_inertia"], "SPIN_INERTIA": n["spin_inertia"], "FIRST_LOAD": n["first_load"],
        "FIRST_INNER": n["first_inner_speed"], "FIRST_OUTER": n["first_outer_speed"],
        "FIRST_T": n["first_temperature"], "X_SMALL": tables.sliding_small, "X_STEPS": 1.0 / tables.sliding_step,
        "C_SMALL": CAGE_SMALL, "C_STEPS": 1.0 / cage_step,
    }  # fmt: skip
    rib_steps = tables.rib.shape[-1] - 1
    if rib_steps:
        numbers |= {
            "RIB_RADIUS": n["rib_radius"],
            "Y_SMALL": LINEAR_SPEED,
            "Y_STEPS": rib_steps / float(np.arcsinh(tables.rib_top / LINEAR_SPEED)),
        }
        text += _array("RIB", tables.rib, "float")
    text += "".join(f"#define {name} {float(value)!r}\n" for name, value in numbers.items())
    text += f"#define NX {tables.friction.shape[-1]}\n#define NC {rest.shape[1]}\n#define NY {rib_steps + 1}\n"
    for name, table, kind in (
        ("FRICTION", tables.friction, "float"),
        ("FORCE", tables.force, "float"),
        ("ROLLS", tables.resistance, "float"),
        ("LARGEST", tables.largest, "float"),
        ("LEAD_INNER", tables.drags["inner"], "double"),
        ("LEAD_OUTER", tables.drags["outer"], "double"),
        ("SQUARE", tables.drags["cage"], "double"),
        ("REST", rest, "double"),
    ):
        text += _array(name, table, kind)
    program = "".join([text, *map(_read_source, _C_FILES)])
    guid = f"{{{uuid.uuid5(_GUID_NAMESPACE, program)}}}"
    return (
        "".join(
            f"/* {sentence} */\n"
            for sentence in (
                f"Tables of a bearing, within {float(result.attrs['error']):.2g}.",
                *axial_sentences(result),
            )
        )
        + f'#define GUID "{guid}"\n{text}',
        guid,
    )


def sources(result: "xr.Dataset") -> tuple[dict[str, str], str]:
    """Return the files in C of which a library is compiled, by name, and the GUID."""
    header, guid = c_header(result)
    return {
        "bearing_data.h": header,
        **{name: _read_source(name) for name in _C_FILES},
    }, guid


#: Random operations that give the error of tables in a limited time. Twice as many take the time of as many nodes.
_CHECKS: Final = 8


@attrs.frozen
class TablesFormat(SceneFormat):
    """A format for the tables of a surrogate, which holds no scene; subclasses implement `render`."""

    def read(self, content: bytes, source: str) -> Read:
        """Raise `SceneError`, because such a file holds no scene.

        Parameters
        ----------
        content : bytes
            The file, which is not read.
        source : str
            Name of the file, for the message.
        """
        raise SceneError(
            [
                f"{source}: is not a scene; name the scene of exported tables, and rollslip fit, rank and validate "
                "take measured ones"
            ]
        )

    def write(self, document: Mapping[str, Any], result: "xr.Dataset | None") -> Written:
        """Return the file for a result of campaign surrogate; other results and none are refused.

        Parameters
        ----------
        document : mapping
            Scene, which is not used.
        result : xarray.Dataset or None
            Result of campaign surrogate.
        """
        if result is None or result.attrs.get("study") != "surrogate":
            raise SceneError(
                [
                    f"format {self.name}: is written from tables; compute them by rollslip surrogate SCENE, and give "
                    "--result surrogate.nc"
                ]
            )
        return self.render(result)

    def compute_result(
        self,
        scene: Scene,
        within: str,
        message: Callable[[str], None],
        progress: Callable[..., None],
    ) -> "xr.Dataset":
        """Return the tables of a scene, as fine as a time allows.

        Parameters
        ----------
        scene : Scene
            The scene.
        within : str
            Time for the tables, such as "1 min".
        message : callable
            Takes a line of text.
        progress : callable
            Takes a text on the progress, the fraction that is done, and the time left [s].
        """
        requested = SurrogateSettings(scene, checks=_CHECKS, within=within)
        with TemporaryDirectory() as folder:
            return requested.run(requested.plan(), Path(folder), progress, message)

    @abc.abstractmethod
    def render(self, result: "xr.Dataset") -> Written:
        """Return the content of the file, and notes for the user."""


#: Name of the platform in an FMU, as FMI 2.0 defines it without the number of bits, and ending of its shared libraries,
#: by `sys.platform`; all others are taken as Linux.
_PLATFORMS: Final = {"win32": ("win", ".dll"), "darwin": ("darwin", ".dylib")}


@attrs.frozen
class Fmu(TablesFormat):
    """A unit of FMI 2.0 for co-simulation, without the sources if `binary_only`."""

    endings: ClassVar[tuple[str, ...]] = (".fmu",)

    binary_only: bool = False

    def render(self, result: "xr.Dataset") -> Written:
        """Return the archive: description, sources, and a library for this machine if a compiler is found."""
        code, guid = sources(result)
        library, note = _compile_library(code)
        if library is None and self.binary_only:
            raise OutputError(f"an FMU without sources needs a library, and {note}")
        notes = [] if library is not None else [f"the FMU has sources only: {note}"]
        entries = {"modelDescription.xml": _description(result, guid, self.binary_only).encode()}
        if library is not None:
            system, suffix = _PLATFORMS.get(sys.platform, ("linux", ".so"))
            bits = 64 if sys.maxsize > 2**32 else 32
            entries[f"binaries/{system}{bits}/bearing{suffix}"] = library
        if not self.binary_only:
            entries |= {f"sources/{name}": text.encode() for name, text in code.items()}
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            for name in sorted(entries, key=lambda name: (name != "modelDescription.xml", name)):
                entry = zipfile.ZipInfo(name, _DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = 3
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, entries[name])
        return Written(buffer.getvalue(), tuple(notes))


def _compile_library(code: Mapping[str, str]) -> tuple[bytes | None, str]:
    """Return the compiled library and "", or None and the reason why there is none."""
    command = (os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc").split()[0]
    candidates = map(shutil.which, (command, "cc", "gcc", "clang"))
    if (compiler := next(filter(None, candidates), None)) is None:
        return None, "no C compiler is found"
    with TemporaryDirectory() as folder:
        for name, text in code.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        flags = [
            flag
            for flag in _FLAGS
            if sys.platform.startswith("linux") or not flag.startswith("-Wl")
        ]
        process = subprocess.run(
            [
                compiler,
                *flags,
                "-Wno-missing-braces",
                "bearing.c",
                "fmi2.c",
                "-o",
                "bearing.so",
                "-lm",
            ],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        if process.returncode:
            return None, f"{compiler} cannot compile it: {process.stderr.strip().splitlines()[-1:]}"
        return (Path(folder) / "bearing.so").read_bytes(), ""


#: Attributes of a variable of an FMU, by its causality; inputs and time are continuous.
_VARIABILITY: Final[Mapping[str, dict[str, str]]] = {
    "parameter": {"variability": "fixed", "initial": "exact"},
    "output": {"variability": "continuous", "initial": "calculated"},
}


def _description(result: "xr.Dataset", guid: str, binary_only: bool) -> str:
    """Return modelDescription.xml: variables, units and default experiment, as FMI 2.0 defines it."""
    error = 100.0 * float(result.attrs["error"])
    root = ET.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName="bearing",
        guid=guid,
        description=f"Cage and rollers of a roller bearing; friction within {error:.2g} % of "
        f"{result.attrs.get('title') or result.attrs.get('source', 'a scene')}"
        + "".join(f"; {sentence}" for sentence in axial_sentences(result)),
        generationTool=f"rollslip {json.loads(result.attrs['packages']).get('rollslip', '')}".strip(),
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    simulation = ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier="bearing",
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="false",
    )
    if not binary_only:
        compiled = ET.SubElement(simulation, "SourceFiles")
        for name in ("bearing.c", "fmi2.c"):
            ET.SubElement(compiled, "File", name=name)
    units = ET.SubElement(root, "UnitDefinitions")
    for name, exponents in _UNITS.items():
        ET.SubElement(ET.SubElement(units, "Unit", name=name), "BaseUnit", exponents)
    ET.SubElement(root, "DefaultExperiment", startTime="0", stopTime="2", stepSize="0.001")
    variables = ET.SubElement(root, "ModelVariables")
    ranges = {name: result[f"{name}_range"].to_numpy() for name in ("radial_load", "temperature")}
    for reference, (name, unit, causality, start, text) in enumerate(VARIABLES):
        attributes = {
            "name": name,
            "valueReference": str(reference),
            "causality": causality,
            "description": text,
            **_VARIABILITY.get(causality, {"variability": "continuous"}),
        }
        variable = ET.SubElement(variables, "ScalarVariable", attributes)
        real = ET.SubElement(variable, "Real", unit=unit)
        if start or causality == "parameter":
            real.set("start", repr(float(result[start])) if start else "0.0")
        for end, value in zip(("min", "max"), ranges.get(name, ()), strict=False):
            real.set(end, repr(float(value)))
    structure = ET.SubElement(root, "ModelStructure")
    for group in ("Outputs", "InitialUnknowns"):
        unknowns = ET.SubElement(structure, group)
        for index, (*_, causality, _, _) in enumerate(VARIABLES, start=1):
            if causality == "output":
                ET.SubElement(unknowns, "Unknown", index=str(index))
    ET.indent(root, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


#: Warning of the file in C; a caller that has a logger defines the macro before.
_C_WARNING: Final = """#include <math.h>
#include <stdio.h>
#ifndef BEARING_WARN
#define BEARING_WARN(text) fprintf(stderr, "bearing: warning: %s\\n", text)
#endif
"""


@attrs.frozen
class C(TablesFormat):
    """One file in C with the tables and the motion, for programs that link it."""

    endings: ClassVar[tuple[str, ...]] = (".c",)

    def render(self, result: "xr.Dataset") -> Written:
        """Return declarations, numbers and code in one file; it begins with bearing.h, which callers copy.

        The first input beyond the tables writes a warning to the standard error stream.
        """
        parts, _ = sources(result)
        code = parts["bearing.c"]
        for name in ("bearing.h", "bearing_data.h"):
            code = code.replace(f'#include "{name}"\n', parts[name], 1)
        return Written(code.replace("#include <math.h>\n", _C_WARNING, 1))


#: Columns of the CSV file after temperature, load and speed.
_COLUMNS: Final = (
    "steady_cage_slip",
    "friction_torque",
    "outer_torque",
    "power_loss",
    "drag_reserve",
)


@attrs.frozen
class Csv(TablesFormat):
    """A row for each temperature, load and speed: the steady state of the bearing."""

    endings: ClassVar[tuple[str, ...]] = (".csv",)

    def render(self, result: "xr.Dataset") -> Written:
        """Return the rows in engineering units, with names and units in the first; cells of NaN are empty.

        The column inside says whether the rolling speed is within the tables, and a note where the rows end. The axial
        load, if there is one, is the last column.
        """
        axes = ("temperature", "radial_load", "inner_speed")
        leads = np.abs(result["inner_speed"] - float(result["first_outer_speed"]))
        rolling = leads / (1.0 / result["inner_radius"] + 1.0 / result["outer_radius"])
        tables = result["rolling_speed"].to_numpy()
        inside = (rolling >= tables[0]) & (rolling <= tables[-1])
        result = result.assign(inside=inside.astype(float).assign_attrs(about("1", "inside")))
        text = io.StringIO()
        rows = csv.writer(text, lineterminator="\n")
        columns = []
        ends = list[str]()
        columns_shown = [*axes, *_COLUMNS, "inside"]
        if "axial_ratio" in result:
            axial_load = result["radial_load"] * result["axial_ratio"]
            result["axial_load"] = axial_load.assign_attrs(about("N", "axial load"))
            columns_shown.append("axial_load")
        for grid in xr.broadcast(*(result[name] for name in columns_shown)):
            values = grid.transpose(*axes).to_numpy().ravel().tolist()
            unit, shown = in_shown_unit(str(grid.name), values, grid.attrs["units"])
            cells = ["" if value is None else f"{value:.8g}" for value in shown]
            columns.append([f"{grid.name} [{unit or 1}]", *cells])
            if grid.name in axes:
                ends.append(f"{grid.name} {cells[0]} to {cells[-1]} {unit}".rstrip())
        rows.writerows(zip(*columns, strict=True))
        beyond = f"nothing is known beyond the rows: {', '.join(ends)}"
        return Written(text.getvalue(), (beyond, *axial_sentences(result)))


FMU_FORMAT: Final = Fmu("fmu")
C_FORMAT: Final = C("c")
CSV_FORMAT: Final = Csv("csv")
