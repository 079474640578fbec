"""Writes the package of a new plugin: a distribution that can be installed, is tested, and holds a real law to replace.

- The files are templates beside the framework with the placeholders of `string.Template`; a line that begins with
  ``@compiled`` or ``@python`` belongs to packages with or without a compiled form only.
- Each kind has a module, tests and an entry point of its own, which are called after the kind.
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
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Final

from rollslip.catalogue.discovery import catalogue
from rollslip.catalogue.kinds import Template as KindTemplate
from rollslip.catalogue.kinds import built_in_module, check_kind, get_kind, usable_kinds
from rollslip.errors import OutputError, PluginError
from rollslip.fields import FieldError

__all__ = ["new", "package"]

#: Package whose templates are those of every kind.
_COMMON: Final = "rollslip.catalogue"


def new(name: str, kinds: str, compiled: bool, folder: Path) -> Path:
    """Write the package of a new plugin; ``name``, ``kinds`` and ``compiled`` are those of `package`."""
    from rollslip.files import blamed, whole

    texts = package(name, kinds, compiled)
    target = folder / name
    if target.exists() or target.is_symlink():
        raise OutputError(
            f"{target}: exists, and is left as it is; choose another name or folder, or remove it"
        )
    try:
        with whole(target) as partial, blamed(target):
            for path, text in texts.items():
                (partial / path).parent.mkdir(parents=True, exist_ok=True)
                (partial / path).write_text(text, encoding="utf-8", newline="\n")
    except OutputError as error:  # its remedy is that of a run
        raise OutputError(
            f"{str(error).partition(';')[0]}; nothing was written; choose another folder"
        ) from error
    return target


def package(name: str, kinds: str, compiled: bool) -> dict[str, str]:
    """Return the files of a new package, path -> text, without writing any.

    Parameters
    ----------
    name : str
        Name of the package.
    kinds : str
        What it offers: kinds with commas between them, each with the name of its model after a colon where that is not
        the name of the package: "film,traction:ramp".
    compiled : bool
        Whether its laws have a compiled form.
    """
    models = _models(name, kinds)
    templates = {kind: _template(kind, compiled) for kind in models}
    _check_name(name)
    for kind, model in models.items():
        _check_model(kind, model, name if name.endswith(model) else model, templates[kind])
    module = name.replace("-", "_")
    requirement = _requirement()
    summaries = [template.summary for template in templates.values()]
    needs = dict.fromkeys(
        [*(need for template in templates.values() for need in template.needs), requirement]
    )
    values = {
        "name": name,
        "module": module,
        "model": next(iter(models.values())),
        "called": " and ".join(f"`{model}`" for model in dict.fromkeys(models.values())),
        "points": "\n\n".join(
            f'[project.entry-points."rollslip.{_file(kind)}"]\n{model} = "{module}.{_file(kind)}"'
            for kind, model in models.items()
        ),
        "summary": " and ".join(
            [summaries[0], *(f"{text[:1].lower()}{text[1:]}" for text in summaries[1:])]
        ),
        "contents": "\n".join(
            f"- `src/{module}/{_file(kind)}.py`: {one.contents}." for kind, one in templates.items()
        ),
        "use": "\n    ".join(
            Template(templates[kind].use).substitute(model=model) for kind, model in models.items()
        ),
        "package_data": '"py.typed", "*.pyi"' if compiled else '"py.typed"',
        "dependencies": ", ".join(f'"{need}"' for need in needs),
        "requirement": requirement,
        "kernels": ", ".join(f'"_{_file(kind)}"' for kind in models),
    }
    texts = {f"src/{module}/py.typed": ""}
    for path, file in _common_files(module, compiled).items():
        texts[path] = _filled(_COMMON, file, values, compiled)
    for kind, model in models.items():
        own = values | {"model": model, "cls": _class_name(model)}
        for path, file in _files(kind, templates[kind], module, compiled).items():
            texts[path] = _filled(templates[kind].package, file, own, compiled)
    return texts


def _models(name: str, kinds: str) -> dict[str, str]:
    """Return the names of models by kind."""
    models = dict[str, str]()
    for wanted in kinds.split(","):
        kind, _, model = wanted.partition(":")
        if kind in models:
            raise FieldError(
                "kind", f"a package takes one {kind} from a template; write a second one beside it"
            )
        models[kind] = model or name.removeprefix("rollslip-")
    return models


def _template(kind: str, compiled: bool) -> KindTemplate:
    """Return how a package of a kind is written, or refuse a kind of which none is."""
    try:
        check_kind(kind)
    except PluginError as error:
        raise FieldError("kind", str(error)) from error
    template = get_kind(kind).template
    if template is None:
        start = built_in_module(kind) or "another package that offers one"
        raise FieldError(
            "kind",
            f"{kind!r} has no template; start from {start}, as docs/reference/plugins.rst shows",
        )
    if compiled and not template.compiled:
        able = ", ".join(
            one.name for one in usable_kinds() if one.template and one.template.compiled
        )
        raise FieldError("compiled", f"{kind} has no compiled form, only {able} have; leave it out")
    return template


def _file(kind: str) -> str:
    """Return the name of the module, and of the group of entry points, of a kind: neither takes hyphens."""
    return kind.replace("-", "_")


def _class_name(model: str) -> str:
    """Return what the class of a model is called."""
    return "".join(word.capitalize() for word in model.replace("_", "-").split("-"))


def _common_files(module: str, compiled: bool) -> dict[str, str]:
    """Return the files of a package of any kind: path -> template."""
    return {
        "pyproject.toml": "pyproject.toml",
        "README.md": "README.md",
        "LICENSE": "LICENSE",
        ".github/workflows/wheels.yml": "wheels.yml",
        ".gitignore": "gitignore",
        f"src/{module}/__init__.py": "init.py",
        **({"setup.py": "setup.py"} if compiled else {}),
    }


def _files(kind: str, template: KindTemplate, module: str, compiled: bool) -> dict[str, str]:
    """Return the files of a kind: path -> template."""
    file = _file(kind)
    found = {f"src/{module}/{name}.py": f"{name}.py" for name in (file, *template.beside)}
    found[f"tests/test_{module}_{file}.py"] = (
        f"test_{file}.py"  # no other package has a test of this name
    )
    return found | (
        {f"src/{module}/_{file}.{end}": f"{file}.{end}" for end in ("pyx", "pyi")}
        if compiled
        else {}
    )


def _read(package: str, file: str) -> str:
    return (files(package) / "templates" / f"{file}.in").read_text(encoding="utf-8")


def _filled(package: str, file: str, values: Mapping[str, str], compiled: bool) -> str:
    """Return a template with its placeholders filled, without the lines of the other form."""
    kept = []
    for line in _read(package, file).splitlines():
        marked = re.match(r"@(compiled|python)(?: |$)", line)
        if marked is None or (marked[1] == "compiled") == compiled:
            kept.append(line if marked is None else line[marked.end() :])
    return Template("".join(f"{line}\n" for line in kept)).substitute(values)


def _requirement() -> str:
    """Versions of rollslip that a package written today fits: it says itself where its contract is another one."""
    return "rollslip>=" + ".".join(importlib.metadata.version("rollslip").split(".")[:2])


def _check_name(name: str) -> None:
    """Refuse the name of a package that cannot be installed or imported."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name, re.ASCII):
        better = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-0123456789")
        hint = f"; {better!r} would do" if better else ""
        raise FieldError(
            "name",
            f"{name!r} is not made of lower-case letters and digits with single hyphens, a letter first{hint}",
        )
    module = name.replace("-", "_")
    if keyword.iskeyword(module) or keyword.issoftkeyword(module):
        raise FieldError(
            "name", f"{name!r} is a word of Python's own and cannot name a module; choose another"
        )
    if module in sys.stdlib_module_names or module in ("tests", "test", "setup"):
        raise FieldError(
            "name",
            f"a module {module!r} would hide Python's own or that of the tests; choose another",
        )
    if importlib.util.find_spec(module) is not None:
        raise FieldError(
            "name",
            f"a module {module!r} is installed already, and one would hide the other; choose another name",
        )


def _check_model(kind: str, model: str, called: str, template: KindTemplate) -> None:
    """Refuse the name of a model whose class would hide another one, and one that is taken."""
    cls = _class_name(model)
    if not cls.isidentifier():
        raise FieldError(
            "name",
            f"{called!r} would make a class {cls!r}, which begins with a digit; choose another",
        )
    if cls.startswith("Test"):
        raise FieldError(
            "name",
            f"pytest would take a class {cls!r} for tests; choose a name that begins otherwise",
        )
    texts = [_read(template.package, file) for file in _files(kind, template, "", False).values()]
    imports = re.findall(r"^ *(?:from|import) .*", "\n".join(texts), re.MULTILINE)
    if re.search(rf"\b{cls}\b", "\n".join(imports)):
        raise FieldError(
            "name", f"{called!r} would make a class {cls!r} beside rollslip's own; choose another"
        )
    for offer in catalogue():
        if (offer.kind, offer.name) == (kind, model):
            raise FieldError(
                "name",
                f"package {offer.package} offers a {kind} called {model!r} already, and of two of one name "
                "rollslip takes none; choose another",
            )
