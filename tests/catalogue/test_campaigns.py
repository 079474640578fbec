"""Campaigns come in by their entry points, ours like a stranger's: a command, a function, a line of help."""

import click
import pytest

import rollslip as package
from packages import install, python, rollslip
from rollslip.catalogue.campaign import campaign, campaigns
from rollslip.catalogue.registry import available
from rollslip.cli.main import cli

SAYS = """\
from rollslip.catalogue.campaign import Campaign
from rollslip.hookspecs import hookimpl

@hookimpl
def campaigns():
    summary = "Tell the mean friction of SCENE at several loads."
    return [Campaign(name="NAME", summary=summary, command="mean_loads:command", function="mean_loads:mean")]
"""
DOES = '''\
import click
from rollslip.cli.app import print_json, scene_argument, scene_of

def mean(scene, loads):
    import rollslip
    over = {"operation.radial_load": list(loads)}
    found = rollslip.sweep(scene, over, study="friction-curve", output=["friction"], engine="serial")
    return float(found["friction"].mean())

@click.command()
@scene_argument
@click.argument("loads", nargs=-1)
def command(scene, loads):
    """Tell the mean friction of SCENE at several loads. It is a test."""
    print_json({"mean": mean(scene_of(scene, ()), loads)})
'''


@pytest.fixture
def stranger(tmp_path):
    install(tmp_path, "rollslip-mean-friction", SAYS, kind="campaign")
    (tmp_path / "mean_loads.py").write_text(DOES)
    return tmp_path


@pytest.mark.quick
def test_every_campaign_of_the_box_is_a_command():
    assert set(campaigns()) >= {"compare", "explore", "fit", "limit", "pareto", "rank", "sweep", "uncertainty"}
    assert set(campaigns()) == set(available("campaign"))
    context = click.Context(cli)
    assert set(campaigns()) <= set(cli.list_commands(context))
    for name in campaigns():
        assert cli.get_command(context, name) is campaign(name).load_command()
        if campaign(name).function:
            assert callable(getattr(package, name))
    assert cli.get_command(context, "nothing") is None


def test_a_strangers_campaign_is_listed_and_runs_by_its_entry_point(stranger):
    code, said, _ = rollslip("--help", path=stranger)
    assert code == 0
    assert "  mean-friction  Tell the mean friction of SCENE at several loads.\n" in said
    assert "  limit  " in said
    code, said, _ = rollslip("plugins", "list", path=stranger)
    assert "rollslip-mean-friction 1.0: ok\n  campaign    mean-friction\n" in f"{said}\n"
    code, said, _ = rollslip("mean-friction", "1032930-70C", "2 kN", "4 kN", path=stranger)
    assert code == 0
    single = "import rollslip\nprint(rollslip.mean_friction('1032930-70C', ['2 kN', '4 kN']))"
    (value,) = python(single, stranger)
    assert f'"mean": {value!r}' in said
    code, said, _ = rollslip("plugins", "check", "mean-friction", "--kind", "campaign", path=stranger)
    assert code == 0, said


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("mean_loads", "import click", "import nothing_there", "command mean_loads:command cannot be imported (Module"),
        ("mean_loads", "def command", "def another", "command mean_loads:command cannot be imported (AttributeError"),
        ("rollslip_mean_friction", "return [", "return 1/0, [", "its campaigns() fails (ZeroDivisionError"),
        ("rollslip_mean_friction", '"mean-friction"', '"other"', "but its entry point promises 'mean-friction'"),
    ],
)
def test_a_broken_campaign_is_one_sentence_and_stays_its_own(file, old, new, told, stranger):
    path = stranger / f"{file}.py"
    path.write_text(path.read_text().replace(old, new))
    code, said, error = rollslip("mean-friction", "1032930-70C", path=stranger)
    assert (code, said) == (5, "")
    assert told in error
    assert error.count("\n") == 1
    code, said, error = rollslip("--help", path=stranger)
    assert (code, error) == (0, "")
    assert "  mean-friction " in said
    assert rollslip("sweep", "--help", path=stranger)[0] == 0


def test_a_name_that_two_packages_offer_is_neither_ones(tmp_path):
    install(tmp_path, "rollslip-other", SAYS, kind="campaign", name="limit")
    (tmp_path / "mean_loads.py").write_text(DOES)
    code, _, error = rollslip("limit", "--help", path=tmp_path)
    assert code == 5
    assert "packages rollslip and rollslip-other offer this name" in error
    assert rollslip("limit", "--help", path=tmp_path, ROLLSLIP_DISABLED_PLUGINS="rollslip-other")[0] == 0


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("It is a test.", "", ""),
        ("Tell the mean", "Say the mean", "its command's help begins with 'Say the mean"),
        ("@click.command()\n@scene_argument\n@click.argument(\"loads\", nargs=-1)\n", "", "is a function, no"),
        ("def mean(", "mean = 1\ndef other(", "mean_loads:mean cannot be called"),
    ],
)  # fmt: skip
def test_the_kit_holds_a_campaign_against_its_command(old, new, told, stranger):
    (stranger / "mean_loads.py").write_text(DOES.replace(old, new))
    code, said, _ = rollslip("plugins", "check", "mean-friction", "--kind", "campaign", path=stranger)
    assert (code == 5) == bool(told)
    assert told in said
