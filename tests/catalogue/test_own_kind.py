"""Kinds come in by their entry points, ours like a stranger's: listed, loaded, told where they cannot be used."""

import pytest

from packages import install, python, rollslip

KIND = '''\
import abc
from typing import ClassVar
import attrs
from rollslip.catalogue.kinds import Kind, Template

@attrs.frozen(kw_only=True)
class Seal(abc.ABC):
    """A seal beside a bearing."""
    name: ClassVar[str]
    references: ClassVar[tuple[str, ...]] = ()

    @abc.abstractmethod
    def torque(self, diameter):
        """Torque [N m] at a diameter [m]."""

SEAL = Kind(name="seal", hook="seals", base=Seal, template=Template(
    summary="A seal", contents="its torque", use="rollslip models ${model}", package="rollslip_seals"
))
'''
LIP = '''\
import attrs
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip_seals import Seal

@attrs.frozen(kw_only=True)
class Lip(Seal):
    """A lip of rubber."""
    name = "NAME"
    tension: float = parameter(default=100.0, unit="N/m", validator=positive, doc="force on a length of the lip")

    def torque(self, diameter):
        return 0.15 * 3.14 * self.tension * diameter**2

@hookimpl
def seals():
    return [Lip]
'''
REQUESTED = """\
import rollslip
from rollslip.catalogue.kinds import kinds, offered_kinds
from rollslip.errors import PluginError
try:
    said = round(rollslip.get_model("seal", "lip", tension=200.0).torque(0.1), 3)
except PluginError as error:
    said = str(error)
print([said, "film" in offered_kinds(), "seal" in kinds()])
"""


@pytest.fixture
def seals(tmp_path):
    """A package that brings a kind, and another that offers something of it."""
    install(tmp_path, "rollslip-seals", KIND, kind="kind", name="seal", module="rollslip_seals")
    points = tmp_path / "rollslip_seals-1.0.dist-info" / "entry_points.txt"
    points.write_text("[rollslip.kind]\nseal = rollslip_seals:SEAL\n")
    install(tmp_path, "rollslip-lip", LIP, kind="seal")
    return tmp_path


@pytest.mark.soak
def test_a_strangers_kind_is_listed_and_what_is_of_it_is_made(seals):
    assert python(REQUESTED, seals) == [[0.942, True, True]]
    code, said, _ = rollslip("models", "-v", path=seals)
    assert code == 0
    assert "seal        lip\n" in said
    code, said, _ = rollslip("models", "lip", path=seals)
    assert code == 0
    assert said.startswith("lip (seal, rollslip-lip 1.0)\n\nA lip of rubber.\n")
    assert "tension" in said
    assert "rollslip-lip 1.0: ok\n  seal        lip\n" in rollslip("plugins", "list", path=seals)[1]
    code, said, error = rollslip("plugins", "check", "lip", path=seals)
    assert (code, error) == (0, "")


def test_a_class_of_it_can_be_registered(seals):
    code = """\
    import attrs, rollslip
    from rollslip_seals import Seal
    @rollslip.register
    @attrs.frozen(kw_only=True)
    class Felt(Seal):
        "A ring of felt."
        name = "felt"
        def torque(self, diameter):
            return 0.0
    print(rollslip.get_model("seal", "felt").torque(0.1))
    """
    assert python(code, seals) == [0.0]


def test_a_package_of_it_is_written_from_its_own_templates(seals, tmp_path_factory):
    templates = seals / "rollslip_seals" / "templates"
    templates.mkdir(parents=True)
    (seals / "rollslip_seals.py").rename(templates.parent / "__init__.py")
    (templates / "seal.py.in").write_text("# ${summary} called ${model}\n")
    (templates / "test_seal.py.in").write_text("# ${contents}\n")
    folder = tmp_path_factory.mktemp("written")
    code = f"""\
    from pathlib import Path
    from rollslip.catalogue.scaffold import new
    made = new("rollslip-felt", "seal", False, Path({str(folder)!r}))
    print([(made / "src" / "rollslip_felt" / "seal.py").read_text()])
    print((made / "pyproject.toml").read_text().count('[project.entry-points."rollslip.seal"]'))
    """
    assert python(code, seals) == [["# A seal called felt\n"], 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "import abc\n",
            "import abc, nothing_there\n",
            "of package rollslip-seals cannot be imported (ModuleNotFound",
        ),
        (
            "import abc\n",
            "import abc, sys; sys.exit(1)\n",
            "of package rollslip-seals cannot be imported (SystemExit",
        ),
        ("SEAL = Kind(", "OTHER = Kind(", "cannot be imported (AttributeError"),
        (
            'name="seal"',
            'name="lip-seal"',
            "rollslip_seals:SEAL is not a Kind of that name; repair or uninstall",
        ),
    ],
)
def test_a_broken_kind_is_one_sentence_and_stays_its_own(old, new, told, seals):
    path = seals / "rollslip_seals.py"
    path.write_text(path.read_text().replace(old, new))
    [[said, film, _]] = python(REQUESTED, seals)
    assert said.startswith("kind 'seal'")
    assert told in said
    assert film
    code, said, error = rollslip("models", path=seals)
    assert (code, error) == (0, "")
    assert "seal" not in said
    code, said, error = rollslip("models", "film", path=seals)
    assert (code, error) == (0, "")


def test_a_kind_of_two_packages_is_nobodys_until_one_is_disabled(seals):
    install(seals, "rollslip-another", KIND, kind="kind", name="seal", module="another_seal")
    points = seals / "rollslip_another-1.0.dist-info" / "entry_points.txt"
    points.write_text("[rollslip.kind]\nseal = another_seal:SEAL\n")
    [[said, _, known]] = python(REQUESTED, seals)
    assert known
    assert (
        "kind 'seal': packages rollslip-another and rollslip-seals offer it; uninstall one" in said
    )
    assert python(REQUESTED, seals, ROLLSLIP_DISABLED_PLUGINS="rollslip-another") == [
        [0.942, True, True]
    ]
    [[said, film, known]] = python(
        REQUESTED, seals, ROLLSLIP_DISABLED_PLUGINS="rollslip-another,rollslip-seals"
    )
    assert (said[:30], film, known) == ("no kind of model is called 'se", True, False)


def test_no_package_takes_the_name_of_a_kind_of_the_box(seals):
    points = seals / "rollslip_seals-1.0.dist-info" / "entry_points.txt"
    points.write_text("[rollslip.kind]\nfilm = rollslip_seals:SEAL\n")
    assert python(
        "import rollslip\nprint(repr(rollslip.get_model('film', 'moes').name))", seals
    ) == ["moes"]


def test_metadata_that_cannot_be_read_keeps_nobody_from_help(tmp_path):
    install(tmp_path, "valueless", None)
    (tmp_path / "valueless-1.0.dist-info" / "entry_points.txt").write_text(
        "[rollslip.campaign]\nbad\n"
    )
    code, said, error = rollslip("--help", path=tmp_path)
    assert (code, error) == (0, "")
    assert "  sweep " in said


RULES = """
from rollslip.testing import Nonconformance, rule
from rollslip_seals import Seal

@rule(Seal)
def check_a_larger_seal_resists_more(seal):
    "More circumference rubs more."
    if seal.torque(0.2) <= seal.torque(0.1):
        raise Nonconformance(f"{seal.torque(0.2)} N m at 200 mm, {seal.torque(0.1)} N m at 100 mm")
"""


@pytest.mark.soak
@pytest.mark.parametrize(
    ("law", "told"),
    [("diameter**2", "lip: 7 ok\n"), ("1", "  failed    check_a_larger_seal_resists")],
)
def test_a_kind_brings_the_rules_of_its_things(seals, law, told):
    (seals / "seal_rules.py").write_text(RULES)
    kind = seals / "rollslip_seals.py"
    lip = seals / "rollslip_lip.py"
    kind.write_text(kind.read_text().replace('hook="seals"', 'hook="seals", rules="seal_rules"'))
    lip.write_text(lip.read_text().replace("diameter**2", law))
    code, said, error = rollslip("plugins", "check", "lip", path=seals)
    assert error == ""
    assert told in said
    assert code == (5 if law == "1" else 0)


def test_a_kind_without_a_template_is_listed(seals):
    path = seals / "rollslip_seals.py"
    path.write_text(path.read_text().partition(", template=")[0] + ")\n")
    assert ", 1 seal, " in rollslip("models", path=seals)[1]
    assert "  seal        lip\n" in rollslip("models", "-v", path=seals)[1]


@pytest.mark.slow
def test_a_group_that_nobody_reads_is_named(seals):
    """A slip of the pen in a group, or a package whose kind is not installed, was passed over in silence."""
    install(seals, "rollslip-slip", "", kind="tracton", name="fast")
    install(seals, "rollslip-felt", "", kind="gasket", name="felt")
    code, said, _ = rollslip("plugins", "list", path=seals)
    assert code == 0
    read = "or is the package that brings the kind not installed?"
    assert (
        f"rollslip-slip: rollslip.tracton: a group that no package reads; did you mean rollslip.traction, {read}"
        in said
    )
    assert (
        f"rollslip-felt: rollslip.gasket: a group that no package reads; no kind has its name, {read}"
        in said
    )
    (seals / "rollslip_seals.py").write_text("raise ValueError('half a kind')")
    code, said, _ = rollslip("doctor", path=seals)
    assert code == 5
    assert "warning  rollslip-slip: rollslip.tracton  a group that no package reads\n" in said
    assert "kind seal" in said
    assert "(ValueError: half a kind); repair or uninstall rollslip-seals" in said
