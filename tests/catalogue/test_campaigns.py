"""Campaigns come in by their entry points, ours like a stranger's: a class whose fields make command and function."""

import inspect
import typing

import attrs
import click
import pytest

import rollslip as package
from packages import install, python, rollslip
from rollslip.catalogue.registry import available
from rollslip.cli.campaign import command_of
from rollslip.cli.main import cli
from rollslip.errors import SceneError
from rollslip.planning.campaign import (
    Campaign,
    campaign,
    campaigns,
    function_of,
    help_of,
    listed,
    options_of,
    setting,
)

SAYS = '''\
import json
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.planning.campaign import OfScene, setting

@attrs.frozen
class MeanFriction(OfScene):
    """Tell the mean friction of SCENE at several loads.

    It is a test.

    Returns
    -------
    xarray.Dataset
        The friction.
    """

    name = "NAME"

    loads: list[str] | tuple[str, ...] = setting(
        "Loads.", default=("2 kN",), metavar="LOAD", repeatable=True, positional=True
    )
    points: int = setting("Points of a curve.", value_type=int, default=5, minimum=2, metavar="N", show_default=True)

    def plan(self):
        return {"operation.radial_load": list(self.loads)}

    def run(self, made, folder, show, said):
        import rollslip
        scene = rollslip.evolve(self.base_scene, {"study.friction-curve.points": self.points})
        study = {"study": "friction-curve", "output": ["friction"], "engine": "serial"}
        return rollslip.sweep(scene, made, **study)

@hookimpl
def campaigns():
    return [MeanFriction]
'''


@pytest.fixture
def stranger(tmp_path):
    install(tmp_path, "rollslip-mean-friction", SAYS, kind="campaign")
    return tmp_path


@pytest.mark.quick
def test_every_campaign_of_the_box_is_a_command_and_a_function_of_its_fields():
    assert set(campaigns()) >= {
        "compare",
        "explore",
        "fit",
        "limit",
        "pareto",
        "rank",
        "sweep",
        "uncertainty",
    }
    assert set(campaigns()) == set(available("campaign"))
    context = click.Context(cli)
    assert set(campaigns()) <= set(cli.list_commands(context))
    for name in campaigns():
        cls = campaign(name)
        command = cli.get_command(context, name)
        assert command is command_of(cls)
        command = command.commands["run"] if isinstance(command, click.Group) else command
        taken = {one.name for one in command.params}
        assert {one.name for one in (*options_of(cls), *options_of(cls, arguments=True))} <= taken
        assert " ".join(command.help.split()).startswith(
            " ".join(help_of(cls).split("\n\n")[0].split())
        )
        function = getattr(package, name)
        fields = {one.name for one in attrs.fields(cls)}
        assert set(inspect.signature(function).parameters) == fields
        assert typing.get_type_hints(function).keys() == fields | {"return"}
        assert function.__doc__.startswith(
            help_of(cls).split("\n")[0].split("SCENE")[0].split("DATA")[0]
        )
        assert all(f"\n{one} : " in function.__doc__ for one in fields)
    assert cli.get_command(context, "nothing") is None


def test_a_field_is_an_option_an_argument_and_a_line_of_the_docs():
    @attrs.frozen
    class Counting(Campaign):
        """Count what DATA holds."""

        name = "count"

        data: str = setting("", default=attrs.NOTHING, argument="DATA", positional=True)
        least: int | None = setting(
            "Least count.", value_type=int, minimum=1, metavar="N", details="A whole number."
        )

        def plan(self):
            return self.least

        def run(self, made, folder, show, said):
            said("counted")
            return made or len(self.data)

    function = function_of(Counting)
    (option, *_) = [one for one in command_of(Counting).params if one.name == "least"]
    assert list(inspect.signature(function).parameters) == ["data", "least", "report"]
    assert typing.get_type_hints(function)["least"] == int | None
    assert function.__doc__.startswith(
        "Count what data holds.\n\nParameters\n----------\ndata : str\n"
    )
    assert "least : int | None, optional\n    Least count.\n    A whole number." in function.__doc__
    assert (option.opts, option.metavar, option.help, option.type.min) == (
        ["--least"],
        "N",
        "Least count.",
        1,
    )
    assert (function("abc"), function("abc", least=2), function(data="abcd")) == (3, 2, 4)
    for wrong in (0, 1.5, "2", True):
        with pytest.raises(
            SceneError,
            match=r"^least: a whole number, 1 or more, is expected, not .*; rollslip count",
        ):
            function("abc", least=wrong)
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'data'"):
        function(least=3)


def test_names_may_have_commas_between_them():
    assert listed("a, b,,c ") == ["a", "b", "c"]
    assert listed(["a,b", "c"]) == ["a", "b", "c"]
    table = {"model": "a"}
    assert listed([table, "b"]) == [table, "b"]
    assert listed("") == listed(()) == []


@pytest.mark.slow
def test_a_strangers_campaign_is_listed_and_runs_by_its_entry_point(stranger):
    code, said, _ = rollslip("--help", path=stranger)
    assert code == 0
    assert "  mean-friction  Tell the mean friction of SCENE at several loads\n" in said
    assert "  limit  " in said
    code, said, _ = rollslip("plugins", "list", path=stranger)
    assert "rollslip-mean-friction 1.0: ok\n  campaign    mean-friction\n" in f"{said}\n"
    code, said, _ = rollslip("mean-friction", "--help", path=stranger)
    assert "--points N" in said
    assert "[default: 5; x>=2]" in said
    requested = (
        "1032930-70C",
        "--loads",
        "2 kN",
        "--loads",
        "4 kN",
        "--out",
        f"{stranger}/made",
        "--json",
        "--no-plots",
    )
    code, said, error = rollslip("mean-friction", *requested, path=stranger)
    assert code == 0, error
    single = (
        "import rollslip\nfound = rollslip.mean_friction('1032930-70C', ['2 kN', '4 kN'])\n"
        f"kept = rollslip.open_result({str(stranger / 'made' / 'mean-friction.nc')!r})\n"
        "print(found.drop_vars('seconds').drop_attrs().identical(kept.drop_vars('seconds').drop_attrs()))\n"
        "print(['rollslip-mean-friction' in one.attrs['packages'] for one in (found, kept)])"
    )
    assert python(single, stranger) == [True, [True, True]]
    code, said, _ = rollslip(
        "plugins", "check", "mean-friction", "--kind", "campaign", path=stranger
    )
    assert code == 0, said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("return [MeanFriction]", "return 1/0, [", "its campaigns() fails (ZeroDivisionError"),
        (
            'name = "mean-friction"',
            'name = "other"',
            "but its entry point promises 'mean-friction'",
        ),
        ("def run(", "def ran(", "class MeanFriction does not define run"),
        ("import json", "import nothing_there", "cannot be imported (ModuleNotFoundError"),
        ("return [MeanFriction]", "return [3]", "offers None, but its entry point promises"),
    ],
)
def test_a_broken_campaign_is_one_sentence_and_stays_its_own(old, new, told, stranger):
    path = stranger / "rollslip_mean_friction.py"
    path.write_text(path.read_text().replace(old, new).replace("1/0, [", "1/0"))
    code, said, error = rollslip("mean-friction", "1032930-70C", path=stranger)
    assert (code, said) == (5, "")
    assert told in error
    assert error.count("\n") == 1
    code, said, error = rollslip("--help", path=stranger)
    assert (code, error) == (0, "")
    assert "  mean-friction " in said
    assert rollslip("sweep", "--help", path=stranger)[0] == 0


@pytest.mark.slow
def test_a_command_of_its_own_that_is_broken_is_one_sentence(stranger):
    path = stranger / "rollslip_mean_friction.py"
    path.write_text(
        path.read_text().replace(
            "    loads:", '    own_command = "nothing_there:command"\n\n    loads:'
        )
    )
    code, said, error = rollslip("mean-friction", "1032930-70C", path=stranger)
    assert (code, said, error.count("\n")) == (5, "", 1)
    assert "its command nothing_there:command cannot be imported (ModuleNotFoundError" in error
    assert rollslip("--help", path=stranger)[0] == 0


def test_a_name_that_two_packages_offer_is_neither_ones(tmp_path):
    install(tmp_path, "rollslip-other", SAYS, kind="campaign", name="limit")
    code, _, error = rollslip("limit", "--help", path=tmp_path)
    assert code == 5
    assert "packages rollslip and rollslip-other offer this name" in error
    assert (
        rollslip("limit", "--help", path=tmp_path, ROLLSLIP_DISABLED_PLUGINS="rollslip-other")[0]
        == 0
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("    It is a test.\n", "", ""),
        (
            'setting("Points of a curve.", value_type=int, ',
            "dict(",
            "points: declare it by setting()",
        ),
        ("points: int =", 'points: "Count" =', "no function can be made of it (NameError"),
        (
            '    name = "',
            '    summary = "Say it."\n    own_command = "rollslip.cli.run:plan"\n    name = "',
            "its command's help begins with 'Print models and resolution",
        ),
        (
            '    name = "',
            '    own_command = "rollslip.cli.run:Path"\n    name = "',
            "no command of click",
        ),
        (
            '    name = "',
            '    own_command = "nowhere:x"\n    name = "',
            "its command nowhere:x cannot be imported",
        ),
        (
            "return rollslip.sweep(scene, made, **study)",
            "import time\n        return rollslip.sweep(scene, made, **study)[['friction']] * time.time()",
            "friction is another at the second run",
        ),
    ],
)
def test_the_kit_holds_a_campaign_against_what_is_made_of_it(old, new, told, stranger):
    path = stranger / "rollslip_mean_friction.py"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    code, said, _ = rollslip(
        "plugins", "check", "mean-friction", "--kind", "campaign", path=stranger
    )
    assert (code == 5) == bool(told), said
    assert told in " ".join(said.split())
