"""Every built-in law says its symbols with units, its range and its source, and its example runs.

An example compares with a number that is not the law's own: worked out by hand in its text, or from a named script.
"""

import doctest
import importlib
import inspect
import re

import attrs
import pytest

from rollslip import available
from rollslip.catalogue.discovery import get_class
from rollslip.errors import PluginError
from rollslip.models import IntegratorModel
from rollslip.units import UnitError, check_unit
from rollslip_kernels.slices import COLUMNS, CONDITIONS
from rollslip_plugins.contact import LundbergDeflection, PowerDeflection
from rollslip_plugins.film.formulas import Moes
from rollslip_plugins.traction.boundary import Kragelsky

pytestmark = pytest.mark.quick

KINDS = ("contact", "film", "traction", "drag", "integrator")
LAWS = [
    *(
        get_class(kind, name)
        for kind in KINDS
        for name, by in available(kind).items()
        if by.package == "rollslip"
    ),
    PowerDeflection,
    LundbergDeflection,
]
#: What an equation says beside its symbols: functions, constants, and which of several formulas it is.
WORDS = {
    "asinh", "clip", "exp", "int", "ln", "max", "mean", "mean_z", "min", "sign", "sinh", "sqrt", "pi", "of", "with",
    "d", "minimum", "central", "murch", "wilson", "gupta",
}  # fmt: skip
#: Models without a law behind them have no source.
NO_LAW = {"constant", "constant-torque", "tabulated"}
UNITS = {unit for unit, _ in (*COLUMNS.values(), *CONDITIONS.values())}


def symbols(text):
    """The list of symbols of a docstring: name -> unit."""
    found = {}
    _, _, listed = text.partition("Symbols:\n\n")
    for item in re.findall(r"^- (.*(?:\n  .*)*)", listed.partition("\n\n")[0], re.MULTILINE):
        names, _, meaning = " ".join(item.split()).partition(": ")
        unit = re.search(r"\[([^\]]+)\]$", meaning)
        found |= dict.fromkeys(names.split(", "), unit and unit[1])
    return found


def named(equation):
    """The symbols of an equation."""
    return set(re.findall(r"(?<![\w.])[A-Za-z]\w*'?", equation)) - WORDS


def faults(law, text, *, equation=None):
    """What a docstring lacks, in words."""
    found = []
    prose = text.partition("\nExamples\n")[0]
    found += [f"parameter {a.name}" for a in attrs.fields(law) if f"``{a.name}``" not in prose]
    if not re.search(r"^Range: \S", prose, re.MULTILINE):
        found.append("range")
    if not issubclass(law, IntegratorModel):
        listed = symbols(prose)
        for name in sorted(named(equation or law.equation)):
            if (
                not {name, re.sub(r"^d2?|2$", "", name)} & listed.keys()
            ):  # of dtau, d2theta and dz2 the variable
                found.append(f"symbol {name}")
        for name, unit in listed.items():
            try:
                assert unit in UNITS or check_unit(str(unit))
            except UnitError:
                found.append(f"unit of {name}")
    examples = doctest.DocTestParser().get_examples(text)
    if "\nExamples\n--------\n" not in text or not any(example.want for example in examples):
        found.append("example")
    if law.name not in NO_LAW and not any(
        re.search(r"\b(1[89]|20)\d\d\b|:20\d\d", str(one)) for one in law.references
    ):
        found.append("source")
    return found


def failures(law, text):
    """Number of examples of a docstring that do not answer as shown."""
    names = vars(importlib.import_module(law.__module__)).copy()
    test = doctest.DocTestParser().get_doctest(text, names, law.__name__, None, 0)
    return doctest.DocTestRunner(verbose=False).run(test, out=lambda _: None).failed


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_law_says_symbols_range_and_source(law):
    assert faults(law, inspect.cleandoc(law.__doc__)) == []


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_the_example_of_a_law_runs(law):
    if issubclass(law, IntegratorModel):
        try:
            law().solver()
        except PluginError as missing:
            pytest.skip(str(missing))
    assert failures(law, inspect.cleandoc(law.__doc__)) == 0


@pytest.mark.parametrize(
    ("law", "old", "new", "fault"),
    [
        (Kragelsky, "- C: decay", "- k: decay", "symbol C"),
        (Kragelsky, "(``limit``) [1]", "(``limit``)", "unit of A"),
        (Kragelsky, "(``rise``) [1]", "(``rise``) [mm]", "unit of B"),
        (Kragelsky, "(``decay``)", "", "parameter decay"),
        (Kragelsky, "Range: ", "Ranges: ", "range"),
        (Kragelsky, "Examples\n--------", "Numbers", "example"),
        (Moes, "- H_RI, H_EI:", "- H_RI:", "symbol H_EI"),
    ],
)
def test_a_planted_fault_is_caught(law, old, new, fault):
    text = inspect.cleandoc(law.__doc__)
    assert old in text
    assert faults(law, text.replace(old, new)) == [fault]


def test_a_wrong_number_or_a_new_symbol_is_caught():
    text = inspect.cleandoc(Kragelsky.__doc__)
    assert failures(Kragelsky, text.replace("'0.12000450'", "'0.12000451'")) == 1
    assert faults(Kragelsky, text, equation=Kragelsky.equation + " + k") == ["symbol k"]

    class Unsourced(Kragelsky):
        references = ("A well-known law of friction.",)

    assert faults(Unsourced, text) == ["source"]
