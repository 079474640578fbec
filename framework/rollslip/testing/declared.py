"""A model does what it declares: it reads and writes the columns that it names, and computes its equation.

- A model which writes to a column that it only reads, or does not fill a column, would fail most rules with different
  messages. Therefore this rule is checked first and names the column, and where it fails, the rules that evaluate the
  model are not run.
- An equation is text that results name. Where it is explicit it is read as arithmetic in the symbols of `NOTATION`, of
  the docstring and of the parameters, and compared with what the model computes. The syntax tree is walked node by
  node, and nothing of it is executed.
"""

import ast
import contextlib
import inspect
import math
import operator
import re
from collections.abc import Callable, Collection, Mapping
from typing import Any, Final, cast

import attrs
import numpy as np

from rollslip.bearing.chain import Chain
from rollslip.errors import DomainError, PluginError
from rollslip.models import DragModel, SliceModel
from rollslip.testing.rules import (
    Check,
    Inapplicable,
    Nonconformance,
    first_of,
    rests_on_evaluation,
    rule,
)
from rollslip.testing.samples import (
    BEARING,
    NumpyForm,
    evaluate,
    members,
    table,
    typical_values,
)
from rollslip_kernels.slices import COLUMNS, CONDITIONS, Conditions, Slices

__all__ = ["not_run"]

#: Value of columns before they are written [any unit]: an arbitrary number, which no law returns to the last bit.
_UNWRITTEN: Final = 0.123456789e-77
#: Symbol in equations -> member of a slice, as in the equations of built-in models.
NOTATION: Final[Mapping[str, str]] = {
    "mu": "friction",
    "h": "film_thickness",
    "b": "half_width",
    "p": "pressure",
    "w": "load",
    "F": "resistance",
    "delta": "approach",
    "u": "rolling_speed",
    "V": "sliding_speed",
    "R": "radius",
    "E'": "modulus",
    "l": "length",
    "T": "temperature",
    "eta": "film_viscosity",
    "beta": "film_thermoviscosity",
    "eta0": "viscosity",
    "alpha": "pressure_viscosity",
    "beta0": "thermoviscosity",
    "gamma": "pressure_thermoviscosity",
    "K_f": "conductivity",
    "tau0": "eyring_stress",
    "Gamma": "shear_modulus",
}
#: Speeds of cage, inner and outer ring at which torques are compared [rad/s]: those of a bearing of 180 mm pitch
#: diameter, in either sense. Doubling them finds the same faults. Chosen.
_SPEEDS: Final = np.array([[40.0, 90.0, 0.0], [-300.0, 0.0, -640.0], [7.0, 30.0, 11.0]])
#: Relative difference between equation and computed value that counts as rounded coefficients [1]. Ten times as much
#: would hide an exponent with two digits exchanged; equations of built-in models are within 1e-4.
_ROUNDED: Final = 1e-3
#: Functions in equations.
_FUNCTIONS: Final[Mapping[str, Callable[..., Any]]] = {
    "abs": np.abs,
    "asinh": np.arcsinh,
    "clip": np.clip,
    "exp": np.exp,
    "ln": np.log,
    "log10": np.log10,
    "max": lambda *terms: np.maximum.reduce(np.broadcast_arrays(*terms)),
    "min": lambda *terms: np.minimum.reduce(np.broadcast_arrays(*terms)),
    "sign": np.sign,
    "sinh": np.sinh,
    "sqrt": np.sqrt,
    "tanh": np.tanh,
}
#: Operators in equations.
_OPERATORS: Final[Mapping[type, Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


class _Watched(Slices):
    """Slices that record which columns are read."""

    requested: set[str]

    def __getattribute__(self, name: str) -> Any:
        if name in COLUMNS:
            super().__getattribute__("requested").add(name)
        return super().__getattribute__(name)


def _usual(model: SliceModel, locked: Collection[str] = ()) -> _Watched:
    """Return slices with usual values; columns that are not read are NaN, and locked ones are read-only."""
    conditions = Conditions(**typical_values(model, members(model, CONDITIONS)))
    slices = _Watched.__new__(_Watched)
    object.__setattr__(slices, "requested", set())
    slices.__init__(4, conditions, **typical_values(model, members(model, COLUMNS)))  # type: ignore[misc]
    for name in COLUMNS:
        column = getattr(slices, name)
        if name in model.writes:
            column[:] = _UNWRITTEN
        column.flags.writeable = name not in locked
    slices.requested.clear()
    return slices


@rule(SliceModel, first=True)
def check_complies_with_its_declarations(model: SliceModel) -> None:
    """It fills exactly the columns in writes, and uses no members except those in reads; other rules require this."""
    if unknown := sorted({*model.reads, *model.domain} - {*COLUMNS, *CONDITIONS}):
        raise Nonconformance(
            f"it reads, or gives a range for, {', '.join(unknown)}, which slices do not have"
        )
    for form in ("evaluate()", "the kernel") if model.kernel() is not None else ("evaluate()",):
        inputs = [name for name in COLUMNS if name not in model.writes]
        slices = _usual(model, inputs if form == "evaluate()" else ())
        before = _usual(model)
        try:
            _run(model, slices, form)
        except (DomainError, PluginError):
            continue  # other rules report refused usual values and kernels that cannot be bound
        except Exception as error:
            fault = (
                _written_of(model, error, inputs)
                or f"fails at usual values: {type(error).__name__}: {error}"
            )
            raise Nonconformance(f"{form} {fault}") from error
        _compare(model, form, slices, before)


def _run(model: SliceModel, slices: Slices, form: str) -> None:
    if form == "the kernel":
        Chain(model)(slices)
        return
    with np.errstate(all="ignore"):
        model.evaluate(slices)


def _written_of(model: SliceModel, error: Exception, inputs: list[str]) -> str:
    """Return the message on an input column to which a model writes; empty for another error."""
    if not isinstance(error, ValueError) or "read-only" not in str(error):
        return ""
    for name in inputs:
        try:
            _run(model, _usual(model, [name]), "evaluate()")
        except ValueError as found:
            if "read-only" in str(found):
                return _writes(model, name)
        except Exception:
            return ""
    return ""


def _writes(model: SliceModel, name: str) -> str:
    if name in model.reads:
        return f"writes to {name}, which it reads, as others do after it; work on a copy"
    return f"writes to {name}, which is not in writes; add it there, or leave it alone"


def _compare(model: SliceModel, form: str, slices: _Watched, before: Slices) -> None:
    """Raise `Nonconformance` for columns that were written wrongly, or not filled."""
    requested = sorted(slices.requested - model.reads - set(model.writes))
    for name in (name for name in COLUMNS if name not in model.writes):
        if not np.array_equal(getattr(before, name), getattr(slices, name), equal_nan=True):
            raise Nonconformance(f"{form} {_writes(model, name)}")
    for name in sorted(model.writes & COLUMNS.keys()):
        values = getattr(slices, name)
        if np.any(values == _UNWRITTEN):
            raise Nonconformance(
                f"{form} leaves {name} as it was, in {'all' if np.all(values == _UNWRITTEN) else 'some'} slices; fill "
                f"the column itself, slices.{name}[...] = ..., and not a name of your own"
            )
        if np.any(np.isnan(values)):
            more = requested or [
                name for name in CONDITIONS if math.isnan(getattr(slices.conditions, name))
            ]
            raise Nonconformance(
                f"{form} gives {name} = nan where all that it reads is usual, so it reads what is not in reads: "
                f"{'' if requested else 'one of '}{', '.join(more)}; add it there, with its range in domain"
            )


def not_run(model: Any, check: Check) -> str:
    """Return the reason why a check is not run on a model: its prerequisite fails; empty if it is run.

    Parameters
    ----------
    model : object
        The model.
    check : callable
        The check.
    """
    if (
        not (isinstance(model, SliceModel) and rests_on_evaluation(check))
        or check is check_complies_with_its_declarations
    ):
        return ""
    try:
        check_complies_with_its_declarations(model)
    except Exception:
        return f"not run: it rests on {check_complies_with_its_declarations.__name__}, which fails"
    return ""


# Equations -----------------------------------------------------------------------------------------------------------


def _syntax_tree(text: str) -> ast.expr | None:
    """Return the syntax tree of an expression as it is printed, in which a blank multiplies; None for other text."""
    text = re.sub(r"\|([^|]+)\|", r"abs(\1)", text).translate(str.maketrans("[]{}'", "()()ʹ"))
    code = ""
    for number, name, call, sign in re.findall(
        r"(\d+\.?\d*(?:e[+-]?\d+)?)|([^\W\d]\w*)(\()?|(\S)", text
    ):
        if re.search(r"[\wʹ)]$", code) and (number or name or sign == "("):
            code += "*"
        # a prefix, because lambda is a keyword of Python
        code += number or (f"s_{name}{call}" if name else sign.replace("^", "**"))
    with contextlib.suppress(SyntaxError):
        return ast.parse(code, mode="eval").body
    return None


def _symbols(tree: ast.AST) -> set[str]:
    """Return the symbols in a syntax tree, and the functions."""
    names = (node.id for node in ast.walk(tree) if isinstance(node, ast.Name))
    return {name.removeprefix("s_").replace("ʹ", "'") for name in names}


def _value(tree: ast.AST | None, known: Mapping[str, Any], definitions: Mapping[str, Any]) -> Any:
    """Return the value of a syntax tree; a `KeyError` names what has none."""
    match tree:
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name():
            (symbol,) = _symbols(tree)
            # a definition may not need itself
            others = {name: of for name, of in definitions.items() if name != symbol}
            of = definitions.get(symbol)
            return known[symbol] if of is None else _value(of, known, others)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, known, definitions)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            terms = (_value(term, known, definitions) for term in (left, right))
            return _OPERATORS[type(op)](*terms)
        case ast.Call(func=ast.Name(id=name), args=arguments):
            terms = (_value(term, known, definitions) for term in arguments)
            return _FUNCTIONS[name.removeprefix("s_")](*terms)
    raise KeyError(type(tree).__name__)


def _documented(model: Any) -> dict[str, str]:
    """Return the symbols that a docstring lists, "- U: speed parameter eta0 u/(E' R) [1]", with their descriptions."""
    listed = re.findall(
        r"^ *- ([^:,\n]+): ([^\[]+)", inspect.getdoc(type(model)) or "", re.MULTILINE
    )
    return {symbol: " ".join(description.split()) for symbol, description in listed}


def _definition(description: str, symbols: Collection[str]) -> ast.expr | None:
    """Return the syntax tree of the formula that ends a description; None if there is none in these symbols."""
    terms = description.rpartition(", ")[2].split()
    while terms and re.fullmatch(r"[a-z-]+", terms[0]) and terms[0] not in symbols:
        del terms[0]
    tree = _syntax_tree(" ".join(terms))
    return tree if tree and _symbols(tree) <= {*symbols, *_FUNCTIONS} else None


def _known(model: Any, documented: Mapping[str, str]) -> tuple[dict[str, Any], set[str]]:
    """Return the values of symbols at loaded bearings, and the symbols of what the model computes."""
    known: dict[str, Any] = {}
    symbols = set(re.findall(r"[^\W\d]\w*'*", model.equation)) - {"a"}
    for field in attrs.fields(type(model)):
        value = getattr(model, field.name)
        if type(value) not in (int, float):
            continue
        # "- lambda: limiting stress (``limit``)" in the docstring, or doc="limiting stress lambda" of the field
        known |= {s: value for s, text in documented.items() if f"(``{field.name}``)" in text}
        for word in re.findall(r"[\w']+", field.metadata.get("doc") or ""):
            known |= {word: known.get(word, value)} if word in symbols else {}
    known["pi"] = math.pi
    if isinstance(model, DragModel):
        known |= dict(zip(("w_c", "w_i", "w_o"), _SPEEDS.T, strict=True))
        return known | {"T": np.array([model.torque(*row) for row in _SPEEDS])}, {"T"}
    filled = evaluate(cast(SliceModel, NumpyForm(model)), table(model, 64, BEARING))
    own = {s: name for s, name in NOTATION.items() if name in model.reads | model.writes}
    for symbol, name in own.items():
        known[symbol] = getattr(filled.conditions if name in CONDITIONS else filled, name)
    known.setdefault("eta", known.get("eta0"))  # of a law that knows one viscosity
    return known, {symbol for symbol, name in own.items() if name in model.writes}


@rule(SliceModel, DragModel)
@np.errstate(all="ignore")
def check_computes_its_equation(model: Any) -> None:
    """The equation that it states gives what it computes, where it is explicit in symbols that are documented."""
    documented = _documented(model)
    known, computed = _known(model, documented)
    clauses = [
        clause.partition(" = ")[::2] for clause in re.split(r", (?![^(\[{]*[)\]}])", model.equation)
    ]
    symbols = {*known, *documented, *(left for left, _ in clauses)}
    definitions = {
        name: _definition(text, symbols) for name, text in documented.items() if name not in known
    }
    definitions |= {left: _syntax_tree(text) for left, text in clauses if left not in computed}
    compared = 0
    for left, right in clauses:
        stated = _syntax_tree(left)
        try:
            value = _value(stated, known, definitions)
            expected = _value(_syntax_tree(right), known, definitions)
        except (KeyError, TypeError):
            continue  # implicit, or in a symbol that is not documented
        if stated is None or not _symbols(stated) & computed:
            continue
        # a negative approach has no power, for example, and a load of zero no relative difference
        large = np.isfinite(value + expected) & (np.abs(value) > 0.0)
        compared += int(large.sum())
        i = first_of(large & (np.abs(value - expected) > _ROUNDED * np.abs(value)))
        if i is not None:
            raise Nonconformance(
                f"it states {left} = {right}, and computes {value[i]:.6g} where that is "
                f"{(value * 0.0 + expected)[i]:.6g}; mend one of them, or write a quantity of your own in a symbol "
                f"that is not {', '.join(NOTATION)}"
            )
    if not compared:
        raise Inapplicable("its equation is not explicit in symbols that are documented")
