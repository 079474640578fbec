"""Writes the package of a new plugin: a distribution that can be installed, is tested, and holds a real law to replace.

- The files are templates beside the framework with the placeholders of `string.Template`; a line that begins with
  ``@compiled`` or ``@python`` belongs to packages with or without a compiled form only.
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
    """Return the files of a new package, path -> text, without writing any."""
    of = None if law is None else read_law_file(law)
    if of is not None:
        if kind not in ("", of.kind):
            raise FieldError("kind", f"{law} offers models of kind {of.kind!r}, not {kind!r}; leave it out")
        if compiled:
            raise FieldError("compiled", f"the law of {law} is in Python alone; leave it out, and add it later")
        kind = of.kind
    own = name.removeprefix("rollslip-")
    classes = {own: class_name(own)} if of is None else of.classes
    _check(name, kind, compiled, classes)
    module, model, about = name.replace("-", "_"), next(iter(classes)), _texts(kind)
    file = kind.replace("-", "_")
    requirement, points = _requirement(), [f'{one} = "{module}.{file}"' for one in classes]
    values = {
        "name": name,
        "module": module,
        "model": model,
        "kind": kind,
        "file": file,
        "cls": classes[model],
        "called": " and ".join(f"`{one}`" for one in classes),
        "points": "\n".join(points),
        "start": "What it starts with is real; put yours in its\nplace." if of is None else "Its law is yours.",
        "numbers": ", and numbers that do not come from its code" if of is None else "",
        "tests": "\n\n\n".join(
            f'class Test{cls}(Conformance):\n    models = [rollslip.get_model("{kind}", "{one}")]'
            for one, cls in classes.items()
        ),
        "summary": about.summary,
        "contents": about.contents,
        "use": Template(about.use).substitute(model=model),
        "requirement": requirement,
        "package_data": ", ".join(f'"{one}"' for one in _package_data(about, compiled)),
        "dependencies": ", ".join(f'"{one}"' for one in (*about.needs, requirement)),
    }
    found = {
        path: Template(_only(text, "compiled" if compiled else "python")).substitute(values)
        for path, text in _templates(kind, module, compiled, of is not None)
    }
    return found if of is None else found | {f"src/{module}/{file}.py": of.module}


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
    """Versions of rollslip that a package written today fits: until the next one that may break it."""
    major, minor = map(int, importlib.metadata.version("rollslip").split(".")[:2])
    after = f"{major + 1}" if major else f"0.{minor + 1}"
    return f"rollslip>={major}.{minor},<{after}"


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
