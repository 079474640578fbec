"""The door for strangers: every fault of a package is one sentence with its name and a remedy, and stays its own."""

import ctypes

import pytest

from packages import TRACTION, install, python, rollslip
from rollslip import available, get_model
from rollslip.foreign import SlicesStruct

SIZE = ctypes.sizeof(SlicesStruct)

#: Source that gives the class of TRACTION a capsule made by hand.
CAPSULE = """
import ctypes
class Table(ctypes.Structure):
    _fields_ = [("abi", ctypes.c_uint32), ("size", ctypes.c_uint32), ("evaluate", ctypes.c_void_p),
                ("params", ctypes.c_void_p)]
done = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda slices, params: {status})
table = Table({abi}, {size}, {evaluate}, None)
new = ctypes.pythonapi.PyCapsule_New
new.restype, new.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
label = {label}
Mine.kernel = lambda self: new(ctypes.addressof(table), label, None)
"""


def capsule(*, abi=1, size=SIZE, null=False, label="rollslip.slice_model.v1", status=0):
    evaluate = None if null else "ctypes.cast(done, ctypes.c_void_p)"
    return TRACTION + CAPSULE.format(
        abi=abi, size=size, evaluate=evaluate, label=label.encode(), status=status
    )


def broken(old, new):
    assert old in TRACTION
    return TRACTION.replace(old, new)


WHO = "traction '{0}' of package rollslip-{0} 1.0"
IMPORT = WHO + " cannot be imported ({1}); repair or uninstall rollslip-{0}"
USE = WHO + " cannot be used, {1}; repair or uninstall rollslip-{0}"
ORIGIN = "it comes from package rollslip-{0} 1.0: update or uninstall that, or choose another model"
KERNEL = "model '{0}': rollslip_{0}.Mine.kernel() {1}; " + ORIGIN

#: name -> (source, sentence, what it says beyond the name)
FAULTS = {
    "absent": (None, IMPORT, "ModuleNotFoundError: No module named 'rollslip_absent'"),
    "needs": (
        "import nothing_of_that_name",
        IMPORT,
        "ModuleNotFoundError: No module named 'nothing_of_that_name'",
    ),
    "raises": ("raise RuntimeError('half\\n  a module')", IMPORT, "RuntimeError: half a module"),
    "syntax": ("def (", IMPORT, "SyntaxError: invalid syntax (rollslip_syntax.py, line 1)"),
    "exits": ("import sys; sys.exit(3)", IMPORT, "SystemExit: 3"),
    "leaves": ("raise SystemExit", IMPORT, "SystemExit"),
    "base": ("class Own(BaseException): pass\nraise Own('no')", IMPORT, "Own: no"),
    "warns": ("import warnings; warnings.warn('old')", IMPORT, "UserWarning: old"),
    "hook": (
        broken("return [Mine]", "1 / 0"),
        USE,
        "its traction_models() fails (ZeroDivisionError: division by zero)",
    ),
    "quits": (
        broken("return [Mine]", "raise SystemExit(1)"),
        USE,
        "its traction_models() fails (SystemExit: 1)",
    ),
    "number": (
        broken("return [Mine]", "return 42"),
        USE,
        "its traction_models() fails (TypeError: 'int' object is not iterable)",
    ),
    "takes": (
        broken("def traction_models()", "def traction_models(wanted)"),
        USE,
        "its traction_models() fails (PluginValidationError: Plugin 'rollslip_takes' for hook 'traction_models' "
        "hookimpl definition: traction_models(wanted) Argument(s) {'wanted'} are declared in the hookimpl but can not "
        "be found in the hookspec)",
    ),
    "instance": (
        broken("[Mine]", "[Mine()]"),
        USE,
        "Mine(factor=0.05) is not a class derived from TractionModel",
    ),
    "film": (
        broken("TractionModel\n", "DragModel as TractionModel\n").replace(
            "evaluate(self, slices)", "torque(self)"
        ),
        USE,
        "<class 'rollslip_film.Mine'> is not a class derived from TractionModel",
    ),
    "abstract": (broken("def evaluate", "def compute"), USE, "class Mine does not define evaluate"),
    "plain": (
        broken("@attrs.frozen(kw_only=True)\n", "").replace("parameter(", "dict("),
        USE,
        "class Mine is not decorated with @attrs.frozen",
    ),
    "silent": (
        broken('    equation = "mu = f V/u"\n', ""),
        USE,
        "class Mine does not define equation",
    ),
    "makes": (
        broken(
            "    def evaluate",
            "    def __attrs_post_init__(self):\n        1 / 0\n\n    def evaluate",
        ),
        "traction '{0}' cannot be made ({1}); " + ORIGIN,
        "ZeroDivisionError: division by zero",
    ),
    "binds": (
        TRACTION + "\nMine.kernel = lambda self: {}['gone']\n",
        KERNEL,
        "fails (KeyError: 'gone')",
    ),
    "wrong": (
        TRACTION + "\nMine.kernel = lambda self: 42\n",
        KERNEL,
        "must return None or a capsule named 'rollslip.slice_model.v1', got 42",
    ),
    "abi": (
        capsule(abi=2),
        KERNEL,
        "was built for ABI 2 of rollslip.h, this is 1: rebuild it against this version",
    ),
    "longer": (
        capsule(size=SIZE + 8),
        KERNEL,
        f"reads {SIZE + 8} bytes of rs_slices, this rollslip has {SIZE}: it needs a newer rollslip",
    ),
    "null": (capsule(null=True), KERNEL, "gave a table whose evaluate is NULL"),
    "label": (
        capsule(label="other.v1"),
        KERNEL,
        "must return None or a capsule named 'rollslip.slice_model.v1', got <capsule object \"other.v1\" at 0x>",
    ),
    "status": (
        capsule(status=-7),
        "the kernel of '{0}' returned a status that rollslip.h does not define; " + ORIGIN,
        "",
    ),
}

ASK = """
import re
from rollslip import Chain, Slices, get_model
from rollslip.errors import PluginError
def ask(name):
    slices = Slices(600, rolling_speed=10.0, sliding_speed=1.0)
    try:
        Chain(get_model("traction", name))(slices)
    except PluginError as error:
        return re.sub("0x[0-9a-f]+", "0x", str(error)).removeprefix(f"{name}: ")  # its place in the scene
    return float(slices.friction[-1])
"""


@pytest.fixture(scope="module")
def street(tmp_path_factory):
    """A path with every faulty package and two good ones."""
    folder = tmp_path_factory.mktemp("street")
    for name, (source, _, _) in FAULTS.items():
        install(folder, f"rollslip-{name}", source)
    for name in ("good", "alright"):
        install(folder, f"rollslip-{name}", TRACTION)
    return folder


@pytest.fixture(scope="module")
def answers(street):
    """What each package of the street answers, twice, all in one process."""
    (found,) = python(
        ASK
        + f"print({{name: [ask(name), ask(name)] for name in {[*FAULTS, 'good', 'kragelsky']}}})",
        street,
    )
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_one_sentence_and_the_same_again(answers, name):
    _, sentence, more = FAULTS[name]
    assert answers[name] == [sentence.format(name, more)] * 2
    assert "\n" not in answers[name][0]


@pytest.mark.slow
def test_no_other_model_suffers(answers):
    assert answers["good"] == [0.05 * 1.0 / 10.0] * 2
    assert answers["kragelsky"] == pytest.approx(
        [float(get_model("traction", "kragelsky").friction(0.1))] * 2
    )


def test_the_command_line_names_the_fault_and_runs_without_it(street):
    code, out, err = rollslip("plan", "1032930-70C", path=street)
    assert (code, err) == (0, "")
    assert "lambda-blend" in out
    code, out, err = rollslip("plan", "1032930-70C", "--set", "models.traction=exits", path=street)
    assert (code, out) == (5, "")
    assert err == "changes: models.traction: " + IMPORT.format("exits", "SystemExit: 3") + "\n"
    code, out, err = rollslip(
        "plan", "1032930-70C", "--set", "models.traction.hydrodynamic=null", path=street
    )
    assert (code, out) == (5, "")
    assert err == KERNEL.format("null", "gave a table whose evaluate is NULL") + "\n"


RAISES_LATER = broken(
    "        slices.friction",
    "        if slices.load.max() >= 7: raise LookupError(float(slices.load[0]))\n        slices.friction",
)


def test_an_error_in_the_middle_of_a_block_says_whose_it_is_in_every_thread(tmp_path):
    install(tmp_path, "rollslip-later", RAISES_LATER)
    raised, done = python(
        """
        import threading
        from concurrent.futures import ThreadPoolExecutor
        from rollslip import Chain, Conditions, Slices, get_model
        start = threading.Barrier(8)
        laws = dict(boundary="later", hydrodynamic="maxwell-eyring")
        blend = Chain(get_model("traction", "lambda-blend", boundary_limit=1.0, **laws), block=2)
        conditions = Conditions(
            roughness=1e-6, modulus=2e11, effusivity=1e4, conductivity=0.1, eyring_stress=4e6, shear_modulus=3e8,
            radius=0.007,
        )
        def task(k):
            slices = Slices(9, conditions, rolling_speed=10.0, sliding_speed=1.0, film_thickness=1e-9, load=0.0,
                            half_width=5e-5, pressure=3e8, film_viscosity=0.2, film_thermoviscosity=0.03)
            if k % 2:
                slices.load[6:] = 7 + k
            start.wait(timeout=60)
            try:
                blend(slices)
            except LookupError as error:
                return error.args, error.__notes__
            return slices.friction.tolist()
        with ThreadPoolExecutor(8) as pool:
            results = list(pool.map(task, range(8)))
        print(results[1::2])
        print(results[::2])
        """,
        tmp_path,
    )
    note = (
        "raised by evaluate() of model 'later'; it comes from package rollslip-later 1.0: "
        "update or uninstall that, or choose another model"
    )
    assert raised == [((7.0 + k,), [note]) for k in (1, 3, 5, 7)]
    assert done == [[0.005] * 9] * 4


@pytest.mark.slow
def test_eight_threads_may_ask_at_once(street):
    names = ["raises", "good", "takes", "alright", "exits", "kragelsky", "hook", "good"]
    together, alone = python(
        ASK
        + f"""
import threading
from concurrent.futures import ThreadPoolExecutor
names, start = {names}, threading.Barrier(8)
def task(name):
    start.wait(timeout=60)
    return ask(name)
with ThreadPoolExecutor(8) as pool:
    print(list(pool.map(task, names)))
print(list(map(ask, names)))
""",
        street,
    )
    assert together == alone
    assert together[0] == IMPORT.format("raises", "RuntimeError: half a module")
    assert [type(answer) for answer in together] == [str, float] * 4


def test_an_interrupt_is_no_fault_of_a_package(tmp_path):
    install(tmp_path, "rollslip-slow", "raise KeyboardInterrupt")
    install(tmp_path, "rollslip-hook", broken("return [Mine]", "raise KeyboardInterrupt"))
    interrupted = python(
        """
        from rollslip import get_model
        for name in ("slow", "hook"):
            try:
                get_model("traction", name)
            except KeyboardInterrupt as error:
                print(repr(type(error).__name__))
        """,
        tmp_path,
    )
    assert interrupted == ["KeyboardInterrupt"] * 2


# By metadata alone ---------------------------------------------------------------------------------------------------

FIND = """
from rollslip import available
from rollslip.errors import PluginError
from rollslip.catalogue.registry import find
for name in {names}:
    try:
        print(repr(find("traction", name).package))
    except PluginError as error:
        print(repr(str(error)))
print(len(available("traction")))
"""
BOX = sum(offer.package == "rollslip" for offer in available("traction").values())
IMPORTED = "raise SystemExit('imported')"


def test_versions_that_do_not_fit_say_which_are_needed(tmp_path):
    requires = {
        "new": ["rollslip>=99"],
        "old": ["Rollslip<0.1,>=0.0.1"],
        "extra": ["rollslip; extra == 'x'", "rollslip>=99; extra == 'x'"],
        "other": ["rollslip>=99; python_version < '3'"],
        "fits": ["rollslip>=0.1"],
    }
    for name, lines in requires.items():
        install(tmp_path, f"rollslip-{name}", IMPORTED, requires=lines)
    new, old, *fits, count = python(FIND.format(names=[*requires]), tmp_path)
    said = "traction '{}' of package rollslip-{}: requires rollslip{}, this is 0.1.0; install a version that fits"
    assert new == said.format("new", "new", ">=99")
    assert old == said.format("old", "old", "<0.1,>=0.0.1")
    assert fits == ["rollslip-extra", "rollslip-other", "rollslip-fits"]
    assert count == BOX + 3


def test_one_name_of_two_packages_is_nobodys_until_one_is_disabled(tmp_path):
    for package in ("rollslip-twin", "a-twin"):
        install(tmp_path, package, IMPORTED, name="twin")
    install(tmp_path, "rollslip-impostor", IMPORTED, name="muraki")
    install(tmp_path, "rollslip-ancient", IMPORTED, name="twin", requires=["rollslip<0.0.1"])
    twin, muraki, eyring, count = python(FIND.format(names=["twin", "muraki", "eyring"]), tmp_path)
    remedy = "offer this name; uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS"
    assert twin == f"traction 'twin' of package a-twin: packages a-twin and rollslip-twin {remedy}"
    assert (
        muraki
        == f"traction 'muraki' of package rollslip: packages rollslip and rollslip-impostor {remedy}"
    )
    assert (eyring, count) == ("rollslip", BOX - 1)
    disabled = "A_Twin, rollslip.impostor,,nothing-of-that-name"
    *found, count = python(
        FIND.format(names=["twin", "muraki"]), tmp_path, ROLLSLIP_DISABLED_PLUGINS=disabled
    )
    assert (found, count) == (["rollslip-twin", "rollslip"], BOX + 1)


def test_a_disabled_package_says_so_before_anything_else(tmp_path):
    install(tmp_path, "rollslip-flat", IMPORTED, requires=["rollslip>=99"])
    disabled = {"ROLLSLIP_DISABLED_PLUGINS": "Rollslip.Flat"}
    said, count = python(FIND.format(names=["flat"]), tmp_path, **disabled)
    reason = "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it"
    assert (said, count) == (f"traction 'flat' of package rollslip-flat: {reason}", BOX)
    code, out, err = rollslip(
        "plan", "1032930-70C", "--set", "models.traction=flat", path=tmp_path, **disabled
    )
    assert (code, out, err) == (5, "", f"changes: models.traction: {said}\n")


def test_a_box_that_is_disabled_is_disabled_whole(tmp_path):
    said, count = python(FIND.format(names=["muraki"]), ROLLSLIP_DISABLED_PLUGINS="rollslip")
    reason = "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it"
    assert (said, count) == (f"traction 'muraki' of package rollslip: {reason}", 0)


def test_metadata_that_cannot_be_read_hides_only_itself(tmp_path):
    install(tmp_path, "rollslip-good", TRACTION)
    for name, metadata, points in [
        ("empty", None, None),
        ("nameless", b"Version: 1.0\n", "[rollslip.traction]\nbad = bad\n"),
        ("versionless", b"Name: versionless\n", "[rollslip.traction]\nbad = bad\n"),
        ("garbled", b"Name: garbled\nVersion: \xff1\n", "[rollslip.traction]\nbad = bad\n"),
        ("valueless", b"Name: valueless\nVersion: 1.0\n", "[rollslip.traction]\nbad\n"),
    ]:
        info = tmp_path / f"{name}-1.0.dist-info"
        info.mkdir()
        if metadata is not None:
            (info / "METADATA").write_bytes(metadata)
        if points is not None:
            (info / "entry_points.txt").write_text(points)
    good, count = python(FIND.format(names=["good"]), tmp_path)
    assert (good, count) == ("rollslip-good", BOX + 1)


@pytest.mark.parametrize("child", ["42", "[1]", "{ factor = 1 }"])
def test_what_is_no_model_is_a_mistake_of_the_scene(tmp_path, child):
    code, out, err = rollslip(
        "plan", "1032930-70C", "--set", f"models.traction.boundary={child}", path=tmp_path
    )
    expected = "a traction model is expected: its name, or a table with model = 'NAME'"
    assert (code, out, err) == (2, "", f"changes: models.traction.boundary: {expected}\n")


def test_a_scene_that_a_package_offers_too_is_said_to_be_of_both(tmp_path):
    install(tmp_path, "rollslip-impostor", "", kind="scene", name="gearbox")
    code, _, told = rollslip("plan", "gearbox", path=tmp_path)
    assert (code, "packages rollslip and rollslip-impostor offer this name" in told) == (5, True)


def test_a_model_that_leaves_the_program_is_named(tmp_path):
    leaves = TRACTION.replace(
        "        slices.friction[...] = ", "        raise SystemExit(3)\n        slices.x = "
    )
    install(tmp_path, "rollslip-leaves", leaves)
    run = [
        "run",
        "1032930-70C",
        "--study",
        "friction-curve",
        "--set",
        "models.traction=leaves",
        "--out",
    ]
    code, _, told = rollslip(*run, str(tmp_path / "out"), path=tmp_path)
    assert (
        code,
        "sys.exit(3) raised by evaluate() of model 'leaves'; it comes from package" in told,
    ) == (5, True)
