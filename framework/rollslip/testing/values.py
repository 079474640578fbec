"""The rules of all models, named data and studies: frozen, comparable, picklable, named, quiet and documented."""

import atexit
import datetime
import json
import math
import os
import pickle
import re
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache
from typing import Any, Final, cast

import attrs
import numpy as np

from rollslip.catalogue.discovery import load
from rollslip.catalogue.kinds import kind_of
from rollslip.catalogue.registry import catalogue, get_class
from rollslip.catalogue.shipped import changed_names, is_ours, snapshot
from rollslip.engine import Engine
from rollslip.errors import PluginError
from rollslip.models import DragModel, FilmModel, SliceModel
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
from rollslip.testing.samples import evaluate, forms_of, table
from rollslip.units import UnitError, check_unit

#: Longest import of a module in addition to rollslip itself [s]. Doubling it accepts modules that delay every command.
#: Chosen: NumPy and SciPy are imported already, and users notice half a second.
IMPORT_LIMIT: Final = 0.5


# Values --------------------------------------------------------------------------------------------------------------


@rule("value")
def check_is_frozen(model: Any) -> None:
    """A model is shared between threads, plans and results, so nobody may change it."""
    cls = type(model)
    refuse_unless(
        attrs.has(cls), f"{cls.__qualname__} is not an attrs class; decorate it with @attrs.frozen"
    )
    for name in [*(attribute.name for attribute in attrs.fields(cls)), "an_attribute_of_nobody"]:
        with suppress(AttributeError):
            setattr(model, name, getattr(model, name, None))
            raise Nonconformance(
                f"{cls.__qualname__}.{name} can be set; decorate the class with @attrs.frozen"
            )


@rule("value")
def check_equal_models_are_equal_and_have_equal_hashes(model: Any) -> None:
    """Models are compared with those of a saved result and serve as keys of caches."""
    twin = attrs.evolve(model)
    refuse_unless(
        twin == model, f"a copy with the same parameters is not equal: {twin!r} against {model!r}"
    )
    try:
        equal = hash(twin) == hash(model)
    except TypeError as error:
        raise Nonconformance(
            f"it cannot be hashed ({error}); keep tuples, not lists, as parameters"
        ) from None
    refuse_unless(equal, "a copy with the same parameters is equal but has another hash")
    for attribute in attrs.fields(type(model)):
        value = getattr(model, attribute.name)
        if isinstance(value, float) and attribute.init:
            near = value * (1 + 1e-9) if 0 < abs(value) < math.inf else 1e-9
            try:
                other = attrs.evolve(model, **{attribute.alias: near})
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
    refuse_unless(
        model.name in names,
        f"it is called {model.name!r}, its module's entry points {', '.join(names)}",
    )


def _offers(model: Any) -> list[Any]:
    """Return the offers by entry points of the module of a model or a data set."""
    kind = kind_of(model) or kind_of(type(model))
    if kind is None:
        raise Inapplicable("it is of no kind")
    offers = [offer for offer in catalogue() if offer.kind == kind.name]
    # a named value's class is not its package's
    ours = [
        o
        for o in offers
        if (o.name == model.name if kind.data else o.module == type(model).__module__)
    ]
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


#: Imports modules one after the other, each in a fork of a process that has imported what all of them need; where there
#: are no forks, the first one itself. It answers with what a module prints and, if it can be imported, the time below.
_IMPORT = """
import json, os, sys, tempfile, time, traceback
sys.path[:] = json.loads(sys.argv[1])
import rollslip, rollslip.bearing.chain, rollslip.hookspecs, rollslip.lubricant, rollslip.models
import rollslip.studies.study, rollslip_kernels.stages.traction
answers, forks = os.fdopen(os.dup(1), "w"), hasattr(os, "fork")
for module in iter(sys.stdin.readline, ""):
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        if forks and (child := os.fork()):
            os.waitpid(child, 0)
        else:
            os.dup2(said.fileno(), 1), os.dup2(said.fileno(), 2)
            start = time.process_time()
            try:
                __import__(module.strip())
                print(f"\\n{time.process_time() - start}", end="")
            except BaseException:
                traceback.print_exc()
            sys.stdout.flush(), sys.stderr.flush()
            if forks:
                os._exit(0)
        said.seek(0)
        print(json.dumps(said.read()), file=answers, flush=True)
"""


@cache
def _importer(path: tuple[str, ...]) -> "subprocess.Popen[str]":
    process = subprocess.Popen(
        [sys.executable, "-c", _IMPORT, json.dumps(path)], text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    atexit.register(_end, process)
    return process


@cache
def _import_of(module: str, path: tuple[str, ...]) -> tuple[float, str]:
    """Return the shortest time of up to three imports, in a process each, and what they print."""
    best = math.inf
    for _ in range(3):  # a busy computer makes an import slow, but not three times
        process = _importer(path)
        assert process.stdin is not None
        assert process.stdout is not None
        print(module, file=process.stdin, flush=True)
        output = json.loads(process.stdout.readline())
        printed, _, seconds = output.rpartition("\n")
        if not hasattr(os, "fork"):
            _end(process)
            _importer.cache_clear()
        try:
            best = min(best, float(seconds))
        except ValueError:
            if f"No module named {module!r}" in output or module == "__main__":
                raise Inapplicable(f"{module} cannot be imported by its name") from None
            last = (output.strip().splitlines() or ["no message"])[-1]
            raise Nonconformance(f"importing {module} fails: {last}") from None
        if (printed := printed.strip()) or best < IMPORT_LIMIT:
            break
    return best, printed


# Another process -----------------------------------------------------------------------------------------------------

#: Offset of the clock in the other process [s]: another year, weekday and hour. Any large number would do.
_CLOCK_OFFSET: Final = 1e8


@cache
def _other(path: tuple[str, ...], **variables: str) -> "subprocess.Popen[bytes]":
    """Return a process with another clock, folder, language and seed, in which all built-in modules are imported."""
    home = tempfile.gettempdir()
    other = {"TZ": "Pacific/Apia", "LC_ALL": "C", "PYTHONHASHSEED": "77", "HOME": home}
    code = "from rollslip.testing.values import answer; answer()"
    process = subprocess.Popen(
        [sys.executable, "-c", code], env=os.environ | other | {"PYTHONPATH": os.pathsep.join(path)} | variables,
        cwd=home, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    atexit.register(_end, process)
    return process


def _end(process: "subprocess.Popen[bytes] | subprocess.Popen[str]") -> None:
    with process, suppress(BrokenPipeError):
        process.kill()


def _requested(model: Any, **variables: str) -> tuple[Any, list[str], list[str]]:
    """Return the answer of another process on a model.

    These are its numbers, or an error as text; names of rollslip that its import has changed; and environment variables
    that its package has read. Another rule reports models that cannot be sent there.
    """
    try:
        order = pickle.dumps(model)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise Inapplicable(f"it cannot be sent to another process ({error})") from None
    process = _other(tuple(map(os.path.abspath, sys.path)), **variables)
    to, back = cast("tuple[Any, Any]", (process.stdin, process.stdout))
    try:
        pickle.dump(order, to)
        to.flush()
        result: tuple[Any, list[str], list[str]] = pickle.load(back)
    except (EOFError, OSError):
        _end(process)
        _other.cache_clear()
        raise Nonconformance("another process, in which it is imported, ends") from None
    if isinstance(result[0], str) and ("No module named" in result[0] or "__main__" in result[0]):
        raise Inapplicable(f"its module cannot be imported by its name ({result[0]})")
    return result


def answer() -> None:
    """Answer questions on models from the standard input, as the other process."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    for offer in catalogue():
        if offer.package == "rollslip":
            with suppress(PluginError):
                load(offer)
    before = snapshot()
    changed = dict[str, list[str]]()
    _set_clocks()
    read = _watch_environment()
    while True:
        try:
            order = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        root = ""
        given = None
        try:
            model = pickle.loads(order)
            root = type(model).__module__.partition(".")[0]
            given = _given(model)
        except BaseException as error:
            given = f"{type(error).__name__}: {error}"
        changed.setdefault(root, []).extend(changed_names(before))
        before = snapshot()
        pickle.dump((given, changed[root], sorted({name for name, of in read if of == root})), out)
        out.flush()


def _set_clocks() -> None:
    """Shift the clocks from which programs take the date."""
    import pandas  # noqa: F401 - its compiled dates inherit from the present class, which must not be replaced before

    now = time.time
    nanoseconds = time.time_ns
    offset = datetime.timedelta(seconds=_CLOCK_OFFSET)

    class Later(datetime.datetime):
        @classmethod
        def now(cls, tz: datetime.tzinfo | None = None) -> Any:
            return super().now(tz) + offset

    def shifted(convert: Any) -> Any:
        return lambda seconds=None: convert(time.time() if seconds is None else seconds)

    time.time = lambda: now() + _CLOCK_OFFSET
    time.time_ns = lambda: nanoseconds() + int(1e9 * _CLOCK_OFFSET)
    for name in ("localtime", "gmtime", "ctime"):
        setattr(time, name, shifted(getattr(time, name)))
    datetime.datetime = Later  # type: ignore[misc]


def _watch_environment() -> set[tuple[str, str]]:
    """Return a set to which names of environment variables are added when a package reads them, with the package."""
    found = set[tuple[str, str]]()
    kind = type(os.environ)
    plain = kind.__getitem__

    def watched(self: Any, name: Any) -> Any:
        caller = sys._getframe(1)
        while caller.f_back is not None and caller.f_globals.get("__name__") in (
            "os",
            "collections.abc",
            "_collections_abc",
        ):
            caller = caller.f_back
        found.add((str(name), str(caller.f_globals.get("__name__")).partition(".")[0]))
        return plain(self, name)

    kind.__getitem__ = watched  # type: ignore[method-assign]
    return found


def _given(model: Any) -> Any:
    """Return the numbers of a model for usual inputs."""
    if isinstance(model, DragModel):
        return [model.torque(*speeds) for speeds in ((100.0, 250.0, 0.0), (-30.0, 0.0, 90.0))]
    filled = (
        [evaluate(form, table(form, 67)) for _, form in forms_of(model)]
        if isinstance(model, SliceModel)
        else []
    )
    return [
        value
        for slices in filled
        for name in sorted(model.writes)
        for value in getattr(slices, name).tolist()
    ]


@rule("value")
def check_import_does_not_change_rollslip(model: Any) -> None:
    """A built-in law that another package changes gives other numbers, and results name rollslip for them."""
    if is_ours(type(model).__module__):
        return
    _, changed, _ = _requested(model)
    refuse_unless(
        not changed,
        f"importing {type(model).__module__} changes {', '.join(changed[:5])} of rollslip; derive a class with a name "
        "of its own, which scenes can ask for",
    )


@rule(SliceModel, DragModel)
def check_gives_the_same_in_another_process(model: Any) -> None:
    """Other clock, time zone, language, folder, seed of hashes and variables of the environment: the same numbers."""
    if is_ours(type(model).__module__):
        return
    here = _given(model)
    (there, _, names) = _requested(model)

    def refuse_another(there: Any, how: str) -> None:
        equal = len(there) == len(here) and not isinstance(there, str)
        refuse_unless(
            equal and np.allclose(there, here, rtol=1e-12, atol=0.0, equal_nan=True),
            f"{how} {there if isinstance(there, str) else 'it gives other numbers'}; what a law depends on is a "
            "parameter, which results name",
        )

    refuse_another(
        there, "in a process with another clock, time zone, language, folder and seed of hashes"
    )
    if names:  # nobody knows what to set before it asks
        other = {name: "2" if os.environ.get(name) != "2" else "3" for name in names}
        refuse_another(
            _requested(model, **other)[0],
            f"where {' and '.join(names)} of the environment is another",
        )


# What is said --------------------------------------------------------------------------------------------------------


@rule(*MODELS)
@without_evaluation
def check_has_description_and_citations(model: Any) -> None:
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
        doc = attribute.metadata.get("doc")
        unit = attribute.metadata.get("unit")
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
def check_declares_its_film_thickness(model: FilmModel) -> None:
    """Minimum, central and dp/dx = 0 differ by a quarter, and the regimes by much more."""
    refuse_unless(
        any(word in getattr(model, "location", "") for word in ("minimum", "central", "dp/dx = 0")),
        "its location must say which thickness it returns: 'minimum', 'central' or 'dp/dx = 0'",
    )
    refuse_unless(
        model.regime in ("IR", "VR", "IE", "VE", "all"),
        f"its regime is {model.regime!r}; say IR, VR, IE, VE or all",
    )
