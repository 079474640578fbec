"""``rollslip new``: a complete scene from a few options, or from answers."""

import contextlib
import os
import re
import select
import subprocess
import sys
import tomllib

import pytest
from click.testing import CliRunner

import rollslip
from rollslip import evolve, load_scene, plan
from rollslip.bearing.assembly import assemble
from rollslip.bearing.cage import estimated_inertia
from rollslip.cli import run
from rollslip.cli.main import cli, main
from rollslip.errors import SceneError
from rollslip.planning.plausibility import implausible
from rollslip.scene import Bearing
from rollslip.structure import Location, structure

GIVEN = {
    "--bearing": "nj 312 ecp/c3",
    "--oil": "VG 46",
    "--speed": "3000 rpm",
    "--load": "5 kN",
    "--temperature": "60 degC",
    "--cage": "polyamide",
    "--supply": "oil jet",
    "--profile": "straight",
}


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def new(*arguments, **options):
    """Exit code, output and errors of the command in this process."""
    return CliRunner().invoke(cli, ["new", *arguments], **options)


def told(capsys, *arguments):
    with pytest.raises(SystemExit) as left:
        main(["new", *arguments])
    return left.value.code, capsys.readouterr().err.strip()


def test_options_make_a_scene_that_says_what_they_say(tmp_path):
    done = new("my.toml", *(text for both in GIVEN.items() for text in both))
    assert done.exit_code == 0, done.output
    scene = load_scene("my.toml")
    assert scene.raw["bearing"]["name"] == "NJ 312 ECP/C3"
    assert scene.lubricant.name == "iso-vg-46"
    assert scene.operation.radial_load == 5000.0
    assert scene.operation.inner_speed == pytest.approx(314.159, rel=1e-5)
    assert scene.operation.temperature == pytest.approx(333.15)
    mass, _ = estimated_inertia(scene.bearing, "polyamide")
    assert scene.cage["guidance"] == "roller"
    assert assemble(scene).cage.mass == pytest.approx(mass, rel=5e-3)
    assert scene.lubrication.supply == "jet"
    assert scene.bearing.profile.shape == "none"
    assert not implausible(scene)
    assert "ASSUMED" not in scene.text
    assert sorted(plan(scene).studies) == ["effective-friction", "steady-slip"]


def test_numbers_and_names_are_read_as_people_write_them():
    done = new(
        "my.toml",
        "--bearing",
        "NUP2210 ECP",
        "--speed",
        "1500 U/min",
        "--load",
        "2,5 kN",
        "--temperature",
        "160 F",
    )
    assert done.exit_code == 0, done.output
    scene = load_scene("my.toml")
    assert scene.operation.radial_load == 2500.0
    assert scene.operation.inner_speed == pytest.approx(157.0796, rel=1e-6)
    assert scene.operation.temperature == pytest.approx(344.261, rel=1e-6)
    assert scene.cage == {"make": "polyamide", "guidance": "roller"}  # ECP says so
    assert not scene.raw["cage"]
    assert "assumed, since no option gives it: oil, supply, profile;" in done.output
    sheet = new("other.toml", "--bearing", "NU2210 ECP", "--cage", "bronze")
    assert "brass" in sheet.output


def test_all_that_is_wrong_is_told_at_once(capsys):
    given = (
        "--bearing",
        "NU2210",
        "--speed",
        "1,500 rpm",
        "--load",
        "2000",
        "--oil",
        "Shell Morlina S2 B 68",
    )
    code, said = told(capsys, "my.toml", *given)
    assert code == 2
    assert said.splitlines() == [
        "speed: '1,500 rpm': a decimal comma is not read; write '1500 rpm' or '1.5 rpm'",
        "load: '2000' has no unit, here a force is expected, such as '2000 N'",
        "no lubricant is called 'Shell Morlina S2 B 68'; did you mean 'iso-vg-68' or 'pao-68'? ('rollslip models "
        "lubricant' lists them)",
    ]


def test_what_nobody_gives_is_assumed_and_marked():
    done = new("my")
    assert done.exit_code == 0, done.output
    assert (
        "assumed, since no option gives it: bearing, oil, speed, load, temperature, cage, supply, profile"
        in done.stderr
    )
    text = load_scene("my.toml").text
    assert len(re.findall("ASSUMED, write yours", text)) == 8


def test_without_a_file_it_asks_or_says_what_to_name(monkeypatch):
    done = new()
    assert done.exit_code == 2
    assert "rollslip new my.toml --bearing 'NU 2210'" in done.stderr
    monkeypatch.setattr(run, "is_interactive", lambda: True)
    asked = ("file", *GIVEN)
    assert new(input="\n" * (len(asked) - 1)).exit_code == 1
    done = new(input="\n" * len(asked))
    assert done.exit_code == 0
    assert done.stderr.count("]: ") == len(asked)
    assert load_scene("my.toml").raw["bearing"]["name"] == "NU2210"


def test_every_commented_value_of_the_bearing_is_the_one_that_counts():
    new("my.toml", "--bearing", "NU1010")
    scene = load_scene("my.toml")
    comments = [
        line[2:]
        for line in scene.text.partition("\n[bearing.mounting]")[0].splitlines()
        if re.match(r"# \w+ = ", line)
    ]
    assert len(comments) == 7
    written = structure(Bearing, tomllib.loads("\n".join(comments)), Location({}), [])
    for name in ("rollers", "roller_diameter", "roller_length", "inner_raceway_diameter"):
        assert getattr(written, name) == pytest.approx(getattr(scene.bearing, name), rel=1e-12)
    assert written.clearance_class == scene.bearing.clearance_class
    assert written.radial_clearance == pytest.approx(
        scene.bearing.radial_clearance, abs=1e-7
    )  # 3 digits


@pytest.mark.parametrize(
    ("bearing", "fit", "says"),
    [
        ("NU210", "k5", "45 CN - 9.1 k5 - 4.9 for 5 K = 31 um"),
        ("NU 2216 ECP", "m5", "57.5 CN - 17 m5 - 7.6 for 5 K = 33 um"),
        ("NU 322/C3", "m6", "105 C3 - 21 m6 - 13 for 5 K = 71 um"),
    ],
)
def test_a_new_scene_says_how_its_clearance_comes_about(bearing, fit, says):
    done = new("my.toml", "--bearing", bearing, "--speed", "1 rpm")
    assert done.exit_code == 0, done.output
    scene = load_scene("my.toml")
    assert (
        f"[bearing.mounting]                       # clearance in operation: {says}\n" in scene.text
    )
    assert str(scene.bearing.mounted) == says
    assert scene.bearing.mounted.assumed == ("shaft_fit", "housing_fit")
    assert f'# shaft_fit = "{fit}" ' in scene.text


def test_a_bearing_without_clearance_classes_is_not_mounted():
    assert new("my.toml", "--bearing", "1032930").exit_code == 0
    assert load_scene("my.toml").bearing.mounted is None


def test_in_a_terminal_it_asks_and_asks_again(monkeypatch):
    monkeypatch.setattr(run, "is_interactive", lambda: True)
    answers = [
        "NU9999",
        "nu2210",
        "",
        "3000",
        "3000 rpm",
        "90 degC",
        "wood",
        "steel",
        "tap",
        "drip",
        "round",
        "log",
    ]
    done = new("my.toml", "--load", "3 kN", input="\n".join(answers) + "\n")
    assert done.exit_code == 0, done.output
    assert "no bearing is called 'NU9999'" in done.output
    assert "'3000' has no unit" in done.output
    assert "there are cages of brass, steel, polyamide, not of 'wood'" in done.output
    scene = load_scene("my.toml")
    assert (
        "there are supplies by bath, splash, circulating, jet, mist, grease, not by 'tap'"
        in done.output
    )
    assert "there are profiles called iso16281, none, not called 'round'" in done.output
    assert (scene.lubricant.name, scene.lubrication.supply) == ("iso-vg-68", "mist")
    assert scene.bearing.profile.shape == "iso16281"
    assert scene.operation.temperature == pytest.approx(363.15)
    assert "ASSUMED" not in scene.text


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["--bearing", "NU2299"], 2, "no bearing is called 'NU2299'; did you mean 'NU22"),
        (["--lubricant", "olive"], 2, "no lubricant is called 'olive'"),
        (["--speed", "3000"], 2, "speed: '3000' has no unit"),
        (["--load", "0N"], 2, "load: '0N' loads no roller; give more, such as '2 kN'"),
        (["--load", "3 rpm"], 2, "load: '3 rpm' is a rotational speed, here a force is expected"),
        (
            ["--temperature", "300 degC"],
            2,
            "operation.temperature: iso-vg-68 at 300 degC: its data hold from",
        ),
        (["--temperature", "300 degC"], 2, "my.toml (not written):"),
        (["--bearing", "NU 9999"], 2, "state its rollers and raceways in [bearing]"),
        (["--cage", "wood"], 2, "cage: there are cages of brass, steel, polyamide"),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_nothing(tmp_path, capsys, arguments, code, says):
    left, errors = told(capsys, "my.toml", *arguments)
    assert (left, len(errors.splitlines())) == (code, 1)
    assert says in errors
    assert not list(tmp_path.iterdir())


def test_nothing_is_replaced(tmp_path, capsys):
    (tmp_path / "my.toml").write_text("mine")
    assert told(capsys, "my") == (2, "my.toml: exists, and is not replaced; name another file")
    assert (tmp_path / "my.toml").read_text() == "mine"
    assert told(capsys, "no/my.toml")[0] == 2


def test_the_cage_that_is_assumed_is_the_bearings_and_follows_its_name():
    given = [
        "--oil",
        "iso-vg-68",
        "--speed",
        "3000 rpm",
        "--load",
        "3 kN",
        "--temperature",
        "70 degC",
    ]
    for file, bearing in (
        ("brass.toml", "NU 2312 MA"),
        ("plain.toml", "NU 2312"),
        ("ecp.toml", "NU 2312 ECP"),
    ):
        assert new(file, "--bearing", bearing, *given).exit_code == 0
    brass, plain, ecp = (load_scene(f"{name}.toml") for name in ("brass", "plain", "ecp"))
    assert brass.cage == {"make": "brass", "guidance": "outer"}
    assert plain.cage == ecp.cage == {"make": "polyamide", "guidance": "roller"}
    assert "most makers put it in; ASSUMED, write yours" in plain.text
    assert "P in the name" in ecp.text
    changed = evolve(brass, {"bearing.name": "NU 2312 ECP"})
    assert changed.cage == ecp.cage
    assert assemble(changed).cage == assemble(ecp).cage
    # what is said on purpose stays
    assert new("own.toml", "--bearing", "NU 2312", "--cage", "brass", *given).exit_code == 0
    own = load_scene("own.toml")
    assert own.raw["cage"] == {"make": "brass"}
    assert assemble(own).cage.guidance == "outer"
    (told,) = implausible(evolve(own, {"bearing.name": "NU 2312 ECP"}))
    assert "cage.make: 'brass', but P of NU 2312 ECP says 'polyamide'" in told


def test_every_commented_value_of_the_cage_is_the_one_that_counts():
    new("my.toml", "--bearing", "NU 2312 MA")
    scene = load_scene("my.toml")
    comments = scene.text.partition("[cage]")[2].partition("[operation]")[0].splitlines()
    written = tomllib.loads("\n".join(line[2:] for line in comments if re.match(r"# \w+ = ", line)))
    assert set(written) == {
        "make",
        "mass",
        "inertia",
        "guidance",
        "pocket_clearance",
        "pocket_stiffness",
        "pocket_contact",
        "drag",
    }
    cage, own = (assemble(one).cage for one in (evolve(scene, {"cage": written}, si=True), scene))
    for name in ("make", "guidance", "pocket_stiffness", "pocket_contact"):
        assert getattr(cage, name) == getattr(own, name)
    for name in ("mass", "inertia", "pocket_clearance"):
        assert getattr(cage, name) == pytest.approx(getattr(own, name), rel=5e-3)
    assert [drag.name for drag in cage.drags] == [drag.name for drag in own.drags]


def test_python_makes_the_scene_that_the_command_writes(tmp_path):
    given = {"bearing": "NU 312 ECP", "speed": "1000 rpm", "supply": "splash"}
    done = new("my.toml", *(f"--{name}={value}" for name, value in given.items()))
    assert done.exit_code == 0, done.output
    made = rollslip.new(**given)
    assert made.text == (tmp_path / "my.toml").read_text(encoding="utf-8")
    assert made == rollslip.load_scene(tmp_path / "my.toml")


def test_python_names_an_option_that_is_none():
    with pytest.raises(SceneError, match="there is no sped; there are bearing, oil, speed"):
        rollslip.new("NU 2210", sped="1500 rpm")


@pytest.mark.skipif(sys.platform == "win32", reason="there are no terminals of this kind")
@pytest.mark.parametrize(
    ("keys", "code", "says"),
    [
        (["\x03"], 130, "interrupted; nothing was left behind"),  # Ctrl-C
        (["\x04"], 130, "interrupted; nothing was left behind"),  # Ctrl-D
        (["\n", "\n", "fast\n", "\x04"], 130, "speed: 'fast' is not a number with a unit"),
        pytest.param(
            ["\n"] * 8,
            0,
            "written to my.toml: NU2210, iso-vg-68, 1500 rpm",
            marks=pytest.mark.slow,
        ),
        pytest.param(
            ["\xff\x1b\n", *["\n"] * 8],
            0,
            "written to my.toml: NU2210",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_keys_at_a_terminal_end_it_or_are_answers(keys, code, says, tmp_path):
    """Each is pressed when it asks: once it has told what it asks for, and nothing comes for a while."""
    import fcntl
    import pty
    import termios

    program = "from rollslip.cli import main; main()"
    shown = ""
    left = list(keys)
    ours, theirs = pty.openpty()
    command = [sys.executable, "-c", program, "new", "my"]
    process = subprocess.Popen(
        command, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True,
        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
    )  # fmt: skip
    os.close(theirs)
    with contextlib.suppress(OSError):  # Linux ends so what nobody writes to any more
        while select.select([ours], [], [], 60.0)[0] and (come := os.read(ours, 4096)):
            shown += come.decode(errors="replace")
            # readline sets out after it has asked: what comes before is heard with the next key
            if left and shown.endswith("]: ") and not select.select([ours], [], [], 0.3)[0]:
                os.write(ours, left.pop(0).encode("latin-1"))
    os.close(ours)
    assert process.wait(60) == code, shown
    assert says in shown
    assert "Traceback" not in shown
    assert not left
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"] * (code == 0)
