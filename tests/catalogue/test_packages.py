"""Which packages are installed, in which state, and what a scene requires of them."""

import ast
import json
import textwrap

import pytest

from packages import TRACTION, install, process, python, rollslip
from rollslip.catalogue.packages import as_dicts, as_text, check_required, packages, requirements
from rollslip.errors import PluginError, SceneError
from rollslip.planning.plan import plan
from rollslip.scene.changes import evolve
from rollslip.scene.reading import load_scene, parse_scene
from rollslip.structure import Location

IMPORTED = "print('imported')"


@pytest.fixture(scope="module")
def street(tmp_path_factory):
    """One package in each state, and one that offers a good and a broken model."""
    folder = tmp_path_factory.mktemp("street")
    install(folder, "rollslip-good", TRACTION, version="1.2.post1")
    install(folder, "rollslip-exits", "raise SystemExit(3)")
    install(folder, "rollslip-new", IMPORTED, requires=["rollslip>=99"])
    install(folder, "rollslip-off", IMPORTED)
    install(folder, "rollslip-one", IMPORTED, name="twin")
    install(folder, "rollslip-two", IMPORTED, name="twin")
    install(folder, "rollslip-half", TRACTION, name="half")
    info = folder / "rollslip_half-1.0.dist-info" / "entry_points.txt"
    info.write_text(
        info.read_text() + "gone = rollslip_half\n[rollslip.film]\nnowhere = rollslip_nowhere\n"
    )
    install(folder, "unrelated", IMPORTED, name="")
    return folder


LIST = """
from rollslip.catalogue.discovery import catalogue
from rollslip.catalogue.packages import as_dicts, as_text, packages, requirements
found = packages()
print([(p.name, p.version, p.state, p.cause) for p in found if p.name != "rollslip"])
print(repr(as_text(p for p in found if p.name != "rollslip")))
print(as_dicts(found))
print(requirements())
print({o.state for o in catalogue()})
"""

TWIN = (
    "traction 'twin': packages rollslip-one and rollslip-two offer this name; "
    "uninstall one or put it in ROLLSLIP_DISABLED_PLUGINS"
)
HALF = (
    "film 'nowhere' of package rollslip-half 1.0 cannot be imported (ModuleNotFoundError: No module named "
    "'rollslip_nowhere'); repair or uninstall rollslip-half; "
    "traction 'gone' of package rollslip-half 1.0: its traction_models() offers 'half', but its entry point promises "
    "'gone'"
)
EXITS = (
    "traction 'exits' of package rollslip-exits 1.0 cannot be imported (SystemExit: 3); "
    "repair or uninstall rollslip-exits"
)


@pytest.mark.slow
def test_every_package_is_listed_with_its_state_and_cause(street):
    listed, text, dicts, required, states = python(
        LIST, street, ROLLSLIP_DISABLED_PLUGINS="rollslip-off"
    )
    assert listed == [
        ("rollslip-exits", "1.0", "broken", EXITS),
        ("rollslip-good", "1.2.post1", "ok", ""),
        ("rollslip-half", "1.0", "broken", HALF),
        (
            "rollslip-new",
            "1.0",
            "incompatible",
            "requires rollslip>=99, this is 0.1.0; install a version that fits",
        ),
        (
            "rollslip-off",
            "1.0",
            "disabled",
            "disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there to use it",
        ),
        ("rollslip-one", "1.0", "shadowed", TWIN),
        ("rollslip-two", "1.0", "shadowed", TWIN),
    ]
    assert text.splitlines()[:9] == [
        "rollslip-exits 1.0: broken",
        f"  {EXITS}",
        "  traction    exits",
        "rollslip-good 1.2.post1: ok",
        "  traction    good",
        "rollslip-half 1.0: broken",
        f"  {HALF}",
        "  film        nowhere",
        "  traction    gone, half (ok)",
    ]
    assert json.dumps(dicts)
    assert dicts[0]["name"] == "rollslip"
    assert dicts[0]["state"] == "ok"
    assert {"kind": "film", "name": "moes", "state": "ok"}.items() <= next(
        offer for offer in dicts[0]["offers"] if offer["name"] == "moes"
    ).items()
    assert required == [
        "rollslip==0.1.0",
        "rollslip-exits==1.0",
        "rollslip-good==1.2.post1",
        "rollslip-half==1.0",
        "rollslip-one==1.0",
        "rollslip-two==1.0",
    ]
    assert states == {
        "ok",
        "incompatible",
        "disabled",
        "shadowed",
    }  # the catalogue itself imports nobody


def test_the_box_is_a_package_like_any_other():
    box = packages()[0]
    assert (box.name, box.state, box.cause) == ("rollslip", "ok", "")
    assert {offer.state for offer in box.offers} == {"ok"}
    assert as_dicts([box])[0]["version"] == box.version
    assert as_text([box]).startswith(
        f"rollslip {box.version}: ok\n  account     alternatives, cases, comparison, "
    )
    assert requirements()[0] == f"rollslip=={box.version}"


# What a scene requires -----------------------------------------------------------------------------------------------

TEXT = load_scene("1032930-70C").text


def scene(*required):
    return parse_scene(
        f"{TEXT}\n[plugins]\n\nrequire = {json.dumps(list(required))}\n", "scene.toml"
    )


LINE = TEXT.count("\n") + 4


def test_what_is_installed_satisfies_a_scene():
    fits = [
        "rollslip",
        "Rollslip>=0.1",
        "numpy>=2,<99",
        "nothing-at-all>=1; python_version < '3'",
        "numpy[extra]>=1",
    ]
    assert plan(scene(*fits)).scene.plugins.require == tuple(fits)


def test_everything_that_is_missing_is_said_at_once_with_line_and_remedy():
    with pytest.raises(PluginError) as error:
        plan(scene("rollslip-nowhere>=0.1", "numpy>=2", "rollslip >=99, <100", "rollslip-absent"))
    at = f"scene.toml:{LINE}: plugins.require"
    assert str(error.value).splitlines() == [
        f"{at}[0]: package rollslip-nowhere>=0.1 is required but not installed; "
        "install it with: pip install 'rollslip-nowhere>=0.1'",
        f"{at}[2]: package rollslip<100,>=99 is required but 0.1.0 is installed; "
        "install it with: pip install 'rollslip<100,>=99'",
        f"{at}[3]: package rollslip-absent is required but not installed; "
        "install it with: pip install 'rollslip-absent'",
    ]


def test_what_is_no_requirement_is_a_mistake_of_the_scene():
    with pytest.raises(SceneError) as error:
        plan(scene("rollslip-nowhere>=0.1", ">=0.1", "two words"))
    first, second = error.value.problems
    assert first.startswith(
        f"scene.toml:{LINE}: plugins.require[1]: '>=0.1' is not a requirement ("
    )
    assert second.startswith(
        f"scene.toml:{LINE}: plugins.require[2]: 'two words' is not a requirement ("
    )
    assert all(
        problem.endswith("); write it as 'rollslip-cross>=0.1'") for problem in error.value.problems
    )
    assert "\n" not in first + second


def test_a_requirement_is_checked_before_the_models_are_looked_up():
    changes = {"models.traction": "cross", "plugins.require": ["rollslip-nowhere"]}
    with pytest.raises(
        PluginError,
        match=r"^changes: plugins.require\[0\]: package rollslip-nowhere is required but",
    ):
        plan(evolve(load_scene("1032930-70C"), changes, si=True))


def test_nothing_is_required_by_default():
    check_required((), Location({}))


def test_the_command_line_checks_versions_without_an_import(street):
    for required, said in [
        ("Rollslip_Exits<2", None),
        ("rollslip-exits>=2", "package rollslip-exits>=2 is required but 1.0 is installed; "
         "install it with: pip install 'rollslip-exits>=2'"),
        ("rollslip-off", "package rollslip-off is required but disabled by ROLLSLIP_DISABLED_PLUGINS; remove it there"),
    ]:  # fmt: skip
        change = f'plugins.require=["{required}"]'
        code, out, err = rollslip(
            "plan",
            "1032930-70C",
            "--set",
            change,
            path=street,
            ROLLSLIP_DISABLED_PLUGINS="rollslip-off",
        )
        if said is None:
            assert (code, err) == (0, "")
        else:
            assert (code, out, err) == (5, "", f"changes: plugins.require[0]: {said}\n")


EDITABLE = """
[bearing]
name = "NU 2210"
[operation]
inner_speed = "1500 rpm"
radial_load = "2 kN"
temperature = "70 degC"
[lubricant]
name = "iso-vg-68"
[models.traction]
model = "lambda-blend"
hydrodynamic = "edited"
[study.friction-curve]
points = 5
[accuracy]
slices = 3
"""


def test_a_run_names_the_package_of_a_law_within_a_law(tmp_path):
    install(tmp_path, "rollslip-edited", TRACTION, version="2.5")
    (tmp_path / "own.toml").write_text(EDITABLE)
    said = """
    import json, sys, rollslip
    found = rollslip.run(sys.argv[1], "friction-curve")
    print(json.loads(found.attrs["packages"])["rollslip-edited"])
    print([one["submodels"] for one in json.loads(found.attrs["models"]) if one["kind"] == "traction"])
    """
    code = f"import sys; sys.argv = ['', {str(tmp_path / 'own.toml')!r}]\n" + textwrap.dedent(said)
    version, children = process(code, paths=[tmp_path]).stdout.splitlines()
    (children,) = ast.literal_eval(children)
    assert version == "2.5"
    assert {
        "kind": "traction",
        "name": "edited",
        "package": "rollslip-edited",
        "version": "2.5",
    } in children


@pytest.mark.slow
def test_a_sweep_goes_on_with_no_package_that_was_edited(tmp_path):
    install(tmp_path, "rollslip-edited", TRACTION, version="2.5")
    (tmp_path / "own.toml").write_text(EDITABLE)
    info = tmp_path / "rollslip_edited-2.5.dist-info" / "direct_url.json"
    info.write_text(json.dumps({"url": tmp_path.as_uri(), "dir_info": {"editable": True}}))
    folder = str(tmp_path / "swept")
    over = "operation.inner_speed=1000rpm:1500rpm:2"
    given = [
        "sweep",
        "run",
        str(tmp_path / "own.toml"),
        "--study",
        "friction-curve",
        "--over",
        over,
    ]
    code, _, err = rollslip(*given, "--out", folder, "--engine", "serial", path=tmp_path)
    assert code == 0, err
    assert rollslip("sweep", "resume", folder, path=tmp_path)[0] == 0
    module = tmp_path / "rollslip_edited.py"
    module.write_text(module.read_text().replace("self.factor *", "2.0 * self.factor *"))
    code, _, err = rollslip("sweep", "resume", folder, path=tmp_path)
    assert code != 0
    assert "editable packages.rollslip-edited" in err


CHANGES = """
from rollslip_plugins.traction.eyring import Muraki
plain = Muraki.evaluate
def weaker(self, slices):
    plain(self, slices)
    slices.friction[...] *= 0.9
"""


@pytest.mark.soak
@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("Muraki.evaluate = Muraki.kernel = weaker", "Muraki.evaluate"),
        ("Muraki.tolerance = 0.0", "Muraki.tolerance"),
        (
            "Muraki.evaluate.__code__ = (lambda self, slices: None).__code__",
            "_EyringFluid.evaluate",
        ),
        ("import rollslip.models as m; m.POSITIVE = (0.0, 1.0)", "rollslip.models.POSITIVE"),
    ],
)
def test_a_package_that_changes_a_law_of_the_box_is_broken(tmp_path, line, name):
    """Results would name rollslip for what it does: doctor and list say so, and nothing of it is used."""
    install(tmp_path, "rollslip-changes", TRACTION + CHANGES + line + "\n")
    code = """
    from rollslip.cli.doctor import _plugins
    print([(f.state, f.remedy) for f in _plugins() if f.check == "plugin rollslip-changes"])
    """
    [[(state, remedy)]] = python(code, tmp_path)
    assert state == "fault"
    assert "its import changes" in remedy
    assert name in remedy
    assert "repair or uninstall rollslip-changes" in remedy


def test_a_law_that_is_changed_before_it_is_imported_by_others_is_seen(tmp_path):
    install(tmp_path, "rollslip-changes", TRACTION + CHANGES + "Muraki.evaluate = weaker\n")
    code = """
    import rollslip
    try:
        print(rollslip.get_model("traction", "changes").name)
    except rollslip.errors.PluginError as error:
        print(repr(str(error)))
    """
    [said] = python(code, tmp_path)
    assert "its import changes rollslip_plugins.traction.eyring.Muraki.evaluate of rollslip" in said
