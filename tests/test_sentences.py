"""Every sentence that the program can say has been read, and what it tells one to type exists."""

import functools
import re

import attrs
import click
import pytest

import sentences
from dialect import STAYS, dialect
from rollslip.bearing.cage import Cage
from rollslip.catalogue.registry import available, get_class
from rollslip.cli.main import cli
from rollslip.lubricant import OilTable
from rollslip.scene.schema import schema
from rollslip.scene.values import Separator
from rollslip.studies.study import study_class
from rollslip_campaigns.sweep.definition import SweepTable

pytestmark = pytest.mark.quick

every = functools.cache(sentences.sentences)  # by the tests, not by the collection of them


@pytest.mark.lint
def test_the_list_of_all_sentences_is_up_to_date():
    stored = sentences.LIST.read_text(encoding="utf-8").splitlines()
    now = sentences.as_csv(every()).splitlines()
    new = sorted(set(now) - set(stored))
    gone = sorted(set(stored) - set(now))
    assert not new, "read them, then write the list by: python tests/support/sentences.py"
    assert not gone, "write the list by: python tests/support/sentences.py"


SAMPLE = '''
"""A docstring is not said."""
names = {"key_of_a_table": "what it means"}
def told(value: "a type") -> "another type":
    """Nor is this."""
    if not re.match("a pattern or two", value):
        raise DomainError(f"{value:.3g} is too {'small' if value < 0 else 'large'}; lower {key!r}")
    return [f"it was {value}", "one"] + [parameter(doc="the first of all")]
'''


def test_what_is_said_is_found_in_any_form_and_code_is_not():
    found = sorted((one.where, one.kind, one.text) for one in sentences.of_python(SAMPLE, "module"))
    assert found == [
        ("", "told", "what it means"),
        ("told", "error", "{value:.3g} is too {'small' if value < 0 else 'large'}; lower {key!r}"),
        ("told", "meaning", "the first of all"),
        ("told", "told", "it was {value}"),
    ]
    cython = '"""Not said."""\ncdef int f() except -1:\n    raise ValueError(f"the state is {n} long, " "not {m}")\n'
    assert [one.text for one in sentences.of_cython(cython, "module")] == [
        "the state is {n} long, not {m}"
    ]


# What they tell one to type -------------------------------------------------------------------------------------------

TABLES = "operation|bearing|lubricant|surface|accuracy|study|models|cage|uncertainty|sweep|plugins"
KEY = re.compile(rf"(?<![\w./-])(?:{TABLES})\.[a-z][\w.-]*\w")
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*")


def known_keys():
    """Every key of a scene as it is typed, and of the tables in it."""
    tables = {"lubricant": OilTable, "cage": Cage, "sweep": SweepTable}
    tables |= {f"study.{name}": study_class(name) for name in available("study")}
    keys = {f"{table}.{field.name}" for table, cls in tables.items() for field in attrs.fields(cls)}
    stages = {
        f"models.{kind}.{field.name}"
        for kind in ("contact", "film", "traction")
        for name in available(kind)
        for field in attrs.fields(get_class(kind, name))
    }
    # tables as a whole can be given, too
    keys |= {f"models.separator.{field.name}" for field in attrs.fields(Separator)}
    return (
        keys
        | stages
        | {row.key for row in schema()}
        | {"uncertainty.lubricant", "uncertainty.correlation"}
    )


def below_of(command):
    """Commands of a group by name, those of campaigns among them."""
    context = click.Context(command)
    names = command.list_commands(context) if isinstance(command, click.Group) else ()
    return {name: command.get_command(context, name) for name in names}


def known_options(command=cli):
    own = {option for parameter in command.params for option in parameter.opts}
    return own.union(*(known_options(below) for below in below_of(command).values()))


def bare(text):
    """A sentence without its gaps and without commands of other programs."""
    return re.sub(r"\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}", "", re.sub(r"pip install .*", "", text))


def names_nothing(text):
    """Keys and options in a sentence that nobody could type."""
    keys = {
        key
        for key in KEY.findall(bare(text))
        if key not in KEYS and not key.startswith("plugins.require")
    }
    return keys | {option for option in OPTION.findall(bare(text)) if option not in OPTIONS}


KEYS = known_keys()
OPTIONS = known_options() | {"--help"}
#: Settings of studies whose names are no plain words; of others it cannot be told whether they are meant as a key.
SETTINGS = sorted(
    {
        key.rpartition(".")[2]
        for key in KEYS
        if key.startswith("study.") and "_" in key.rpartition(".")[2]
    }
)
#: A setting without the table that it stands in, or written as no command takes it.
UNTYPABLE = re.compile(
    rf"(?<![\w.])(?:{'|'.join(SETTINGS)})\b|(?:take|with|set) (?:inertia|closure|level|friction) = "
)


@pytest.mark.lint
def test_every_key_and_option_that_a_sentence_names_exists():
    assert [
        (one, wrong)
        for one in every()
        if one.kind != "source" and (wrong := names_nothing(one.text))
    ] == []
    assert sum(bool(KEY.search(bare(one.text))) for one in every()) > 10


def test_every_command_that_a_sentence_names_exists():
    words = re.compile(r"(?:by: |'|`|take )rollslip ([a-z]+)(?: ([a-z]+))?")
    named = {pair for one in every() for pair in words.findall(one.text)}
    commands = below_of(cli)
    assert {command for command, _ in named} - commands.keys() == set()
    groups = {pair for pair in named if below_of(commands[pair[0]])}
    assert {pair for pair in groups if pair[1] not in below_of(commands[pair[0]])} == set()
    assert ("sweep", "resume") in groups


def test_a_key_or_an_option_that_does_not_exist_is_every():
    said = (
        "raise accuracy.tolerances, study.dynamics.durations or lubricant.{name}, by "
        "--sets or --set accuracy.tolerance"
    )
    assert names_nothing(said) == {"accuracy.tolerances", "study.dynamics.durations", "--sets"}
    assert {"study.dynamics.duration", "cage.drag", "models.traction.hydrodynamic"} <= KEYS
    assert {"--set", "--resume", "--overwrite"} <= OPTIONS


def test_no_sentence_names_a_setting_without_its_table():
    """A key can be typed as it stands: ``study.friction-curve.max_slip``, not ``max_slip``."""
    # what a study says of its own setting stands behind the place of that setting
    told = [
        one
        for one in every()
        if one.kind in ("told", "error") and "__attrs_post_init__" not in one.where
    ]
    assert [one for one in told if UNTYPABLE.search(bare(one.text))] == []
    assert UNTYPABLE.search("raise max_cage_slip")
    assert UNTYPABLE.search("take inertia = true")
    assert not UNTYPABLE.search(
        "with --set study.steady-slip.inertia=true, or study.friction-curve.max_slip"
    )


def test_no_sentence_of_the_program_says_what_only_its_authors_would():
    own = [one for one in every() if not one.module.startswith("rollslip_kernels")]
    told = [one for one in own if one.kind != "source" and one.text not in STAYS]
    assert [(one.module, one.text, wrong) for one in told if (wrong := dialect(one.text))] == []
    assert len(told) > 3000
