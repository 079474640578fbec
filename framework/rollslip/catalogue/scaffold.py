"""Write the package of a new plugin: an installable and tested distribution with a real law as an example.

- The files are templates with the placeholders of `string.Template`; a line that begins with ``@compiled`` or
  ``@python`` is only for packages with or without a compiled form.
- Each kind has its own module, tests and entry point, which are named after the kind.
- Module, model and class follow from the name of the distribution. The model is named without "rollslip-", the prefix
  of distributions on an index: ``rollslip-cross`` offers ``cross``.
- A compiled package has rollslip among its build requirements, because it needs the header of the version with which it
  runs; its README builds it with ``--no-build-isolation``, with the installed rollslip.
- All checks come before the first file is written, and the folder is created completely or not at all.
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
from rollslip.fields import FieldError, refuse_if

__all__ = ["new", "package"]

#: Package with the templates of all kinds.
_COMMON: Final = "rollslip.catalogue"


def new(name: str, kinds: str, compiled: bool, folder: Path) -> Path:
    """Write the package of a new plugin, and return its folder.

    Parameters
    ----------
    name, kinds, compiled
        As of `package`.
    folder : Path
        Folder in which that of the package is created.

    Raises
    ------
    OutputError
        If the folder of the package exists already, or cannot be written.
    """
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
    except OutputError as error:  # with the remedy for this command, in place of that for a run
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
        Kinds of its models, separated by commas, each with the name of its model after a colon where that is not the
        name of the package, and a variant of the template after an equals sign: "film,drag:ramp=resistance".
    compiled : bool
        Whether its laws have a compiled form.
    """
    models, variants = _models(name, kinds)
    templates = {kind: _template(kind, compiled, variants[kind]) for kind in models}
    _check_name(name)
    for kind, model in models.items():
        _check_model(kind, model, name if name.endswith(model) else model, templates[kind])
    module = name.replace("-", "_")
    values = _placeholders(name, models, templates, compiled)
    texts = {f"src/{module}/py.typed": ""}
    for path, file in _common_files(module, compiled).items():
        texts[path] = _filled(_COMMON, file, values, compiled)
    for kind, model in models.items():
        own = values | {"model": model, "cls": _class_name(model)}
        for path, file in _files(kind, templates[kind], module, compiled).items():
            texts[path] = _filled(templates[kind].package, file, own, compiled)
    return texts


def _placeholders(
    name: str, models: dict[str, str], templates: dict[str, KindTemplate], compiled: bool
) -> dict[str, str]:
    """Return the values of the placeholders of all templates of a package."""
    module = name.replace("-", "_")
    present = importlib.metadata.version("rollslip")
    requirement = "rollslip>=" + ".".join(present.split(".")[:2])  # at least the present version
    first, *further = (template.summary for template in templates.values())
    needs = [need for template in templates.values() for need in template.needs]
    return {
        "name": name,
        "module": module,
        "model": next(iter(models.values())),
        "called": " and ".join(f"`{model}`" for model in dict.fromkeys(models.values())),
        "points": "\n\n".join(
            f'[project.entry-points."rollslip.{_file(kind)}"]\n{model} = "{module}.{_file(kind)}"'
            for kind, model in models.items()
        ),
        "summary": " and ".join([first, *(f"{text[:1].lower()}{text[1:]}" for text in further)]),
        "contents": "\n".join(
            f"- `src/{module}/{_file(kind)}.py`: {template.contents}."
            for kind, template in templates.items()
        ),
        "use": "\n    ".join(
            Template(templates[kind].use).substitute(model=model) for kind, model in models.items()
        ),
        "package_data": '"py.typed", "*.pyi"' if compiled else '"py.typed"',
        "dependencies": ", ".join(f'"{need}"' for need in dict.fromkeys([*needs, requirement])),
        "requirement": requirement,
        "kernels": ", ".join(f'"_{_file(kind)}"' for kind in models),
    }


def _models(name: str, kinds: str) -> tuple[dict[str, str], dict[str, str]]:
    """Return the names of models, and of the variants of their templates, by kind."""
    models = dict[str, str]()
    variants = dict[str, str]()
    for entry in kinds.split(","):
        named, _, variant = entry.partition("=")
        kind, _, model = named.partition(":")
        refuse_if(
            kind in models,
            "kind",
            f"a package takes one {kind} from a template; write a second one beside it",
        )
        models[kind] = model or name.removeprefix("rollslip-")
        variants[kind] = variant
    return models, variants


def _template(kind: str, compiled: bool, variant: str) -> KindTemplate:
    """Return the template of a kind; raise `FieldError` for what has none, or has no compiled form."""
    try:
        check_kind(kind)
    except PluginError as error:
        raise FieldError("kind", str(error)) from error
    if (template := get_kind(kind).template) is None:
        start = built_in_module(kind) or "another package that offers one"
        raise FieldError(
            "kind",
            f"{kind!r} has no template; start from {start}, as docs/reference/plugins.rst shows",
        )
    if variant:
        offered = ", ".join(template.variants) or "none"
        refuse_if(
            variant not in template.variants,
            "kind",
            f"{kind} has no variant {variant!r}; there are: {offered}",
        )
        template = template.variants[variant]
    if compiled and not template.compiled:
        compilable = ", ".join(
            other.name for other in usable_kinds() if other.template and other.template.compiled
        )
        raise FieldError(
            "compiled",
            f"{variant or kind} has no compiled form, only {compilable} have; leave it out",
        )
    return template


def _file(kind: str) -> str:
    """Return the name of the module, and of the group of entry points, of a kind, in which hyphens are not allowed."""
    return kind.replace("-", "_")


def _class_name(model: str) -> str:
    """Return the name of the class of a model."""
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
    of_template = template.file or file
    paths = {f"src/{module}/{file}.py": f"{of_template}.py"}
    paths |= {f"src/{module}/{name}.py": f"{name}.py" for name in template.further_modules}
    # with the module in its name, so that no other package has a test of this name
    paths[f"tests/test_{module}_{file}.py"] = f"test_{of_template}.py"
    if compiled:
        paths |= {f"src/{module}/_{file}.{end}": f"{file}.{end}" for end in ("pyx", "pyi")}
    return paths


def _read(package: str, file: str) -> str:
    """Return the text of a template."""
    return (files(package) / "templates" / f"{file}.in").read_text(encoding="utf-8")


def _filled(package: str, file: str, values: Mapping[str, str], compiled: bool) -> str:
    """Return a template with its placeholders filled in, without the lines of the other form."""
    lines = []
    for line in _read(package, file).splitlines():
        mark = re.match(r"@(compiled|python)(?: |$)", line)
        if mark is None or (mark[1] == "compiled") == compiled:
            lines.append(line if mark is None else line[mark.end() :])
    return Template("".join(f"{line}\n" for line in lines)).substitute(values)


def _check_name(name: str) -> None:
    """Raise `FieldError` for the name of a package that cannot be installed or imported."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name, re.ASCII):
        better = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-0123456789")
        hint = f"; {better!r} would do" if better else ""
        raise FieldError(
            "name",
            f"{name!r} is not made of lower-case letters and digits with single hyphens, a letter first{hint}",
        )
    module = name.replace("-", "_")
    refuse_if(
        keyword.iskeyword(module) or keyword.issoftkeyword(module),
        "name",
        f"{name!r} is a keyword of Python and cannot name a module; choose another",
    )
    refuse_if(
        module in sys.stdlib_module_names or module in ("tests", "test", "setup"),
        "name",
        f"a module {module!r} would hide Python's own or that of the tests; choose another",
    )
    refuse_if(
        importlib.util.find_spec(module) is not None,
        "name",
        f"a module {module!r} is installed already, and one would hide the other; choose another name",
    )


def _check_model(kind: str, model: str, called: str, template: KindTemplate) -> None:
    """Raise `FieldError` for the name of a model whose class would hide another one, or that exists already."""
    cls = _class_name(model)
    refuse_if(
        not cls.isidentifier(),
        "name",
        f"{called!r} would make a class {cls!r}, which begins with a digit; choose another",
    )
    refuse_if(
        cls.startswith("Test"),
        "name",
        f"pytest would take a class {cls!r} for tests; choose a name that begins otherwise",
    )
    texts = [_read(template.package, file) for file in _files(kind, template, "", False).values()]
    imports = re.findall(r"^ *(?:from|import) .*", "\n".join(texts), re.MULTILINE)
    refuse_if(
        re.search(rf"\b{cls}\b", "\n".join(imports)),
        "name",
        f"{called!r} would make a class {cls!r} beside rollslip's own; choose another",
    )
    for offer in catalogue():
        refuse_if(
            (offer.kind, offer.name) == (kind, model),
            "name",
            (
                f"package {offer.package} offers a {kind} called {model!r} already, and of two of one name "
                "rollslip takes none; choose another"
            ),
        )
