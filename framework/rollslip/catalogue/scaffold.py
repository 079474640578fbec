"""Writes the package of a new plugin: a distribution that can be installed, is tested, and holds a real law to replace.

- The files are templates beside the framework with the placeholders of `string.Template`; a line that begins with
  ``@compiled`` or ``@python`` belongs to packages with or without a compiled form only.
- Of several laws in one package each has a module, tests and an entry point of its own.
- The name given is the distribution's; module, model and class follow from it, so there is nothing to fill in. The
  model leaves out "rollslip-", with which distributions are found on an index: ``rollslip-cross`` offers ``cross``.
- A compiled package names rollslip among its build requirements, because it needs the header of the version it will
  run with; its README builds it with ``--no-build-isolation``, against the rollslip that is installed.
- Everything is checked before the first file is written, and the folder appears whole or not at all.
"""

import importlib.metadata
import importlib.util
import keyword
import re
import sys
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Final

from rollslip.catalogue.compiled_form import add_compiled
from rollslip.catalogue.discovery import catalogue
from rollslip.catalogue.kinds import Template as Texts
from rollslip.catalogue.kinds import check_kind, get_kind, usable_kinds
from rollslip.catalogue.law_file import class_name, read_law_file
from rollslip.errors import OutputError, PluginError
from rollslip.fields import FieldError

#: Classes that the files of every kind import.
_TAKEN: Final = frozenset({"Chain", "ClassVar", "Conditions", "Conformance", "MappingProxyType", "Slices"})


def new(name: str, kind: str, compiled: bool, folder: Path, law: Path | None = None) -> Path:
    """Write the package of a new plugin."""
    from rollslip.files import blamed, whole

    texts = package(name, kind, compiled, law)
    target = folder / name
    if target.exists() or target.is_symlink():
        raise OutputError(f"{target}: exists, and is left as it is; choose another name or folder, or remove it")
    try:
        with whole(target) as partial, blamed(target):
            for path, text in texts.items():
                (partial / path).parent.mkdir(parents=True, exist_ok=True)
                (partial / path).write_text(text, encoding="utf-8", newline="\n")
    except OutputError as error:  # its remedy is that of a run
        raise OutputError(f"{str(error).partition(';')[0]}; nothing was written; choose another folder") from error
    return target


def compile_too(folder: Path) -> list[str]:
    """Add the frame of a compiled form to a package, and return what is left to do; see `add_compiled`."""
    return add_compiled(folder, _requirement())


def package(name: str, kind: str, compiled: bool, law: Path | None = None) -> dict[str, str]:
    """Return the files of a new package, path -> text, without writing any.

    ``kind`` may be several, with commas between, each with a model's name behind a colon where that is another than the
    package's: "film,traction:ramp".
    """
    of = None if law is None else read_law_file(law)
    if of is not None:
        if kind not in ("", of.kind):
            raise FieldError("kind", f"{law} offers models of kind {of.kind!r}, not {kind!r}; leave it out")
        if compiled:
            raise FieldError("compiled", f"the law of {law} is in Python alone; leave it out, and add it later")
        kind = of.kind
    own, module = name.removeprefix("rollslip-"), name.replace("-", "_")
    wanted = [(one.partition(":")[0], one.partition(":")[2] or own) for one in kind.split(",")]
    for kind, model in wanted:
        _check(name, kind, compiled, {model: class_name(model)} if of is None else of.classes)
    offers, modules = dict[tuple[str, str], str](), dict[str, str]()
    for kind, model in wanted:
        file = kind.replace("-", "_")
        stem = file if file not in offers.values() else f"{file}_{model.replace('-', '_')}"
        if (kind, model) in offers or (stem != file and _texts(kind).files):
            raise FieldError("kind", f"a package takes one {kind} called {model!r} from a template")
        for called in [model] if of is None else of.classes:
            offers[kind, called] = modules[called] = stem
    requirement, groups = _requirement(), dict[str, list[str]]()
    for (kind, model), stem in offers.items():
        groups.setdefault(kind, []).append(f'{model} = "{module}.{stem}"')
    about = {kind: _texts(kind) for kind in groups}
    one, summaries = next(iter(offers)), [texts.summary for texts in about.values()]
    needs = dict.fromkeys([*(need for texts in about.values() for need in texts.needs), requirement])
    data = dict.fromkeys(file for texts in about.values() for file in _package_data(texts, compiled))
    values = {
        "name": name,
        "module": module,
        "model": one[1],
        "called": " and ".join(f"`{model}`" for model in dict.fromkeys(model for _, model in offers)),
        "points": "\n\n".join(
            "\n".join([f'[project.entry-points."rollslip.{kind.replace("-", "_")}"]', *points])
            for kind, points in groups.items()
        ),
        "start": "What it starts with is real; put yours in its\nplace." if of is None else "Its law is yours.",
        "numbers": ", and numbers that do not come from its code" if of is None else "",
        "tests": "\n\n\n".join(
            f'class Test{cls}(Conformance):\n    models = [rollslip.get_model("{one[0]}", "{model}")]'
            for model, cls in (of.classes.items() if of else ())
        ),
        "summary": " and ".join([*summaries[:1], *(f"{text[:1].lower()}{text[1:]}" for text in summaries[1:])]),
        "contents": "\n".join(
            f"- `src/{module}/{stem}.py`: {about[kind].contents}."
            for stem, (kind, _) in {stem: offer for offer, stem in offers.items()}.items()
        ),
        "use": "\n    ".join(Template(about[kind].use).substitute(model=model) for kind, model in offers),
        "package_data": ", ".join(f'"{file}"' for file in data),
        "dependencies": ", ".join(f'"{need}"' for need in needs),
        "requirement": requirement,
    }
    alone = len(set(offers.values())) == 1
    kernels = {stem: "_kernel" if alone else f"_{stem}" for stem in offers.values()}
    values["kernels"] = ", ".join(f'"{kernel}"' for kernel in kernels.values())
    found = dict[str, str]()
    for (kind, model), stem in offers.items():
        file, mine = kind.replace("-", "_"), {"kind": kind, "model": model, "cls": class_name(model), "file": stem}
        for path, text in _templates(kind, module, compiled, of is not None):
            filled = Template(_only(text, "compiled" if compiled else "python")).substitute(
                values | mine | {"file": stem}
            )
            if path.endswith(f"/{file}.py") or "_kernel." in path or path.startswith("tests/"):
                filled = filled.replace("_kernel", kernels[stem]).replace(f"{module}.{file} ", f"{module}.{stem} ")
                path = path.replace("_kernel.", f"{kernels[stem]}.").replace(f"/{file}.py", f"/{stem}.py")
                path = path if alone or "/test_" not in path else f"tests/test_{module}_{stem}.py"
            found.setdefault(path, filled)
    return found if of is None else found | {f"src/{module}/{stem}.py": of.module}


def _package_data(about: Texts, compiled: bool) -> list[str]:
    folders = dict.fromkeys(path.rpartition("/")[0] for path in about.files)
    return ["py.typed", *(["*.pyi"] if compiled else []), *(f"{folder}/*" for folder in folders)]


def _templates(kind: str, module: str, compiled: bool, given: bool) -> Iterator[tuple[str, str]]:
    """Path in the package and template of every file."""
    source, file = f"src/{module}", kind.replace("-", "_")
    wanted = {
        "pyproject.toml": "pyproject.toml",
        "README.md": "README.md",
        "LICENSE": "LICENSE",
        ".github/workflows/wheels.yml": "wheels.yml",
        ".gitignore": "gitignore",
        f"{source}/__init__.py": "init.py",
        f"{source}/{file}.py": f"{file}.py",
        f"tests/test_{module}.py": "test_law.py" if given else f"test_{file}.py",
    }
    wanted |= {f"{source}/{beside}.py": f"{beside}.py" for beside in _texts(kind).beside}
    wanted |= {f"{source}/{path}": template for path, template in _texts(kind).files.items()}
    if compiled:
        wanted |= {
            "setup.py": "setup.py",
            f"{source}/_kernel.pyx": f"{file}.pyx",
            f"{source}/_kernel.pyi": f"{file}.pyi",
        }
    yield f"{source}/py.typed", ""
    for path, template in wanted.items():
        places = [files(of) / "templates" / f"{template}.in" for of in (_texts(kind).package, "rollslip.catalogue")]
        yield path, next(place for place in places if place.is_file()).read_text(encoding="utf-8")


def _texts(kind: str) -> Texts:
    texts = get_kind(kind).template
    if texts is None:
        raise FieldError("kind", f"packages of kind {kind!r} cannot be written from a template")
    return texts


def _only(text: str, mark: str) -> str:
    """Return a template without the lines of the other mark, and without the marks."""
    kept = []
    for line in text.splitlines():
        marked = re.match(r"@(compiled|python)(?: |$)", line)
        if marked is None:
            kept.append(line)
        elif marked[1] == mark:
            kept.append(line[marked.end() :])
    return "".join(f"{line}\n" for line in kept)


def _requirement() -> str:
    """Versions of rollslip that a package written today fits: it says itself where its contract is another one."""
    return "rollslip>=" + ".".join(importlib.metadata.version("rollslip").split(".")[:2])


def _check(name: str, kind: str, compiled: bool, classes: Mapping[str, str]) -> None:
    """Refuse what would give a package that cannot be installed, imported or told apart."""
    try:
        check_kind(kind)
    except PluginError as error:
        raise FieldError("kind", str(error)) from error
    if compiled and not _texts(kind).compiled:
        able = ", ".join(one.name for one in usable_kinds() if one.template and one.template.compiled)
        raise FieldError("compiled", f"{kind} has no compiled form, only {able} have; leave it out")
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name, re.ASCII):
        better = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-0123456789")
        hint = f"; {better!r} would do" if better else ""
        raise FieldError(
            "name", f"{name!r} is not made of lower-case letters and digits with single hyphens, a letter first{hint}"
        )
    module = name.replace("-", "_")
    if keyword.iskeyword(module) or keyword.issoftkeyword(module):
        raise FieldError("name", f"{name!r} is a word of Python's own and cannot name a module; choose another")
    if module in sys.stdlib_module_names or module in ("tests", "test", "setup"):
        raise FieldError("name", f"a module {module!r} would hide Python's own or that of the tests; choose another")
    if importlib.util.find_spec(module) is not None:
        raise FieldError(
            "name", f"a module {module!r} is installed already, and one would hide the other; choose another name"
        )
    for model, cls in classes.items():
        called = name if name.endswith(model) else model
        if not cls.isidentifier():
            raise FieldError(
                "name", f"{called!r} would make a class {cls!r}, which begins with a digit; choose another"
            )
        if cls.startswith("Test"):
            raise FieldError(
                "name", f"pytest would take a class {cls!r} for tests; choose a name that begins otherwise"
            )
        if cls in _TAKEN.union(_texts(kind).classes):
            raise FieldError("name", f"{called!r} would make a class {cls!r} beside rollslip's own; choose another")
        for offer in catalogue():
            if (offer.kind, offer.name) == (kind, model):
                raise FieldError(
                    "name",
                    f"package {offer.package} offers a {kind} called {model!r} already, and of two of one name "
                    "rollslip takes none; choose another",
                )
