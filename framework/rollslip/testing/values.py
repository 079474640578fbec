"""The rules of all models, named values and studies: frozen, equal, pickled, named, quiet, and said what it is."""

import json
import math
import pickle
import re
import subprocess
import sys
from functools import cache
from typing import Any, Final

import attrs

from rollslip.catalogue.kinds import kind_of
from rollslip.catalogue.registry import catalogue, get_class
from rollslip.engine import Engine
from rollslip.errors import PluginError
from rollslip.models import FilmModel
from rollslip.testing.rules import (
    CITATIONS_WANTED,
    MODELS,
    Inapplicable,
    Nonconformance,
    is_citation,
    refuse_unless,
    rule,
    without_evaluation,
)
from rollslip.units import UnitError, check_unit

#: What a change of units may do to a result: some hundred roundings, most of them in powers.
UNITS_TOLERANCE: Final = 1e-10
#: A loop over blocks of 256 meets whole blocks, a rest and, with it, the end of a vector loop.
MANY: Final = 515
THREADS: Final = 8
#: Seconds for which threads run against each other; a shared scratch is found in 40 of 40 runs, on one core or two.
MEETING: Final = 0.06
#: Seconds that a module may take beyond rollslip itself.
IMPORT_LIMIT: Final = 0.5


# Values --------------------------------------------------------------------------------------------------------------


@rule("value")
def check_is_frozen(model: Any) -> None:
    """A model is shared between threads, plans and results, so nobody may change it."""
    cls = type(model)
    refuse_unless(attrs.has(cls), f"{cls.__qualname__} is no attrs class; decorate it with @attrs.frozen")
    for name in [*(attribute.name for attribute in attrs.fields(cls)), "an_attribute_of_nobody"]:
        try:
            setattr(model, name, getattr(model, name, None))
        except AttributeError:
            continue
        raise Nonconformance(f"{cls.__qualname__}.{name} can be set; decorate the class with @attrs.frozen")


@rule("value")
def check_equal_models_are_equal_and_have_equal_hashes(model: Any) -> None:
    """Models are compared with those of a saved result and serve as keys of caches."""
    twin = attrs.evolve(model)
    refuse_unless(twin == model, f"a copy with the same parameters is not equal: {twin!r} against {model!r}")
    try:
        equal = hash(twin) == hash(model)
    except TypeError as error:
        raise Nonconformance(f"it cannot be hashed ({error}); keep tuples, not lists, as parameters") from None
    refuse_unless(equal, "a copy with the same parameters is equal but has another hash")
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if isinstance(value, float) and attribute.init:
            try:
                other = attrs.evolve(model, **{attribute.alias: value * (1 + 1e-9) if value else 1e-9})
            except ValueError:
                continue  # at the end of the parameter's range
            refuse_unless(other != model, f"two models that differ in {attribute.name} are equal")


@rule("value")
def check_survives_pickling(model: Any) -> None:
    """Sweeps send models to other processes."""
    try:
        twin = pickle.loads(pickle.dumps(model))
    except Exception as error:
        raise Nonconformance(f"it cannot be pickled ({type(error).__name__}: {error})") from error
    refuse_unless(twin == model, f"its pickled copy is not equal: {twin!r} against {model!r}")


@rule("value")
def check_is_named_as_its_entry_point(model: Any) -> None:
    """The catalogue is listed without importing anything, so a name stands twice and must be the same."""
    offers = _offers(model)
    for offer in offers:
        try:
            get_class(offer.kind, offer.name)
        except PluginError as error:
            raise Nonconformance(str(error)) from error
    names = sorted(offer.name for offer in offers)
    refuse_unless(model.name in names, f"it is called {model.name!r}, its module's entry points {', '.join(names)}")


def _offers(model: Any) -> list[Any]:
    """Return what entry points promise of the module that a model, or a named value, comes from."""
    kind = kind_of(model) or kind_of(type(model))
    if kind is None:
        raise Inapplicable("it is of no kind")
    offers = [offer for offer in catalogue() if offer.kind == kind.name]
    # a named value's class is not its package's
    ours = [o for o in offers if (o.name == model.name if kind.data else o.module == type(model).__module__)]
    if not ours:
        raise Inapplicable("no entry point leads to its module")
    return ours


@rule("value")
def check_its_module_is_imported_fast_and_quietly(model: Any) -> None:
    """A plugin is imported by people who want one model of it, and what it prints would end in their output."""
    # a named value's class is not its package's
    module = _offers(model)[0].module if kind_of(model) else type(model).__module__
    seconds, printed = _import_of(module, tuple(sys.path))
    refuse_unless(not printed, f"importing {module} prints {printed[:200]!r}")
    refuse_unless(
        seconds < IMPORT_LIMIT,
        f"importing {module} takes {seconds:.2g} s beyond rollslip itself, allowed is {IMPORT_LIMIT:g} s; "
        "import inside the function that needs it",
    )


_IMPORT = """
import json, os, sys, time
sys.path[:] = json.loads(sys.argv[2])
import rollslip, rollslip.bearing.chain, rollslip.hookspecs, rollslip.lubricant, rollslip.models
import rollslip.studies.study
import rollslip_kernels.stages.traction
answer = os.fdopen(os.dup(1), "w")
start = time.process_time()
__import__(sys.argv[1])
answer.write(f"\\n{time.process_time() - start}")
"""


@cache
def _import_of(module: str, path: tuple[str, ...]) -> tuple[float, str]:
    """Return the shortest time of up to three imports, in a process each, and what they print."""
    best = math.inf
    for _ in range(3):  # a busy computer makes an import slow, but not three times
        done = subprocess.run(
            [sys.executable, "-c", _IMPORT, module, json.dumps(path)], capture_output=True, text=True, check=False
        )
        if done.returncode:
            if f"No module named {module!r}" in done.stderr or module == "__main__":
                raise Inapplicable(f"{module} cannot be imported by its name")
            raise Nonconformance(
                f"importing {module} fails: {(done.stderr.strip().splitlines() or ['no message'])[-1]}"
            )
        printed, _, seconds = done.stdout.rpartition("\n")
        printed = (printed + done.stderr).strip()
        best = min(best, float(seconds))
        if printed or best < IMPORT_LIMIT:
            break
    return best, printed


# What is said --------------------------------------------------------------------------------------------------------


@rule(*MODELS)
@without_evaluation
def check_says_what_it_is_and_where_it_comes_from(model: Any) -> None:
    """Name, one line of text, equation and citations: lists, reports and `rollslip cite` are made of them."""
    cls = type(model)
    name = getattr(cls, "name", None)
    refuse_unless(
        isinstance(name, str) and re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name),
        f"its name is {name!r}; use small letters, digits and hyphens, as in 'pan-hamrock'",
    )
    first = (cls.__doc__ or "").strip().splitlines()[:1]
    # attrs writes no docstring; one that is taken over from the base says nothing about this law
    refuse_unless(
        first and cls.__doc__ != cls.__mro__[1].__doc__ and first[0].endswith((".", ":")),
        f"the docstring of {cls.__qualname__} must start with a sentence in one line, it starts with {first}",
    )
    equation = getattr(cls, "equation", None)
    refuse_unless(
        isinstance(equation, str) and "=" in equation and "\n" not in equation,
        f"its equation is {equation!r}; give the law in one line, in the symbols of its docstring",
    )
    references = getattr(cls, "references", None)
    refuse_unless(
        isinstance(references, tuple) and references and all(map(is_citation, references)),
        f"its references are {references!r}; {CITATIONS_WANTED}",
    )


@rule(*MODELS, Engine)
@without_evaluation
def check_every_parameter_has_a_meaning_and_a_unit(model: Any) -> None:
    """What a scene can set is explained there, and read with its unit."""
    for attribute in attrs.fields(attrs.resolve_types(type(model))):
        doc, unit = attribute.metadata.get("doc"), attribute.metadata.get("unit")
        refuse_unless(
            isinstance(doc, str) and doc.strip() and not doc.endswith("."),
            f"parameter {attribute.name} has no meaning; declare it with "
            "rollslip.fields.parameter(doc='in a few words')",
        )
        if attribute.type is float or unit is not None:
            try:
                check_unit(str(unit))
            except UnitError as error:
                raise Nonconformance(
                    f"parameter {attribute.name} has no SI unit ({error}); '1' is a plain number"
                ) from None


@rule(FilmModel)
@without_evaluation
def check_says_which_film_it_gives(model: FilmModel) -> None:
    """Minimum, central and dp/dx = 0 differ by a quarter, and the regimes by much more."""
    refuse_unless(
        any(word in getattr(model, "location", "") for word in ("minimum", "central", "dp/dx = 0")),
        "its location must say which thickness it returns: 'minimum', 'central' or 'dp/dx = 0'",
    )
    refuse_unless(
        model.regime in ("IR", "VR", "IE", "VE", "all"), f"its regime is {model.regime!r}; say IR, VR, IE, VE or all"
    )
