"""Adds the frame of a compiled form to a package whose model is in Python: all but its law.

- What the author wrote stays as it is, but for the line of ``pyproject.toml`` that says what a build needs and the one
  that says which files belong to the package.
- The model goes on in Python until it has a ``kernel``, a method of its class or what `rollslip.model` is given; from
  then on the conformance kit holds both forms against each other. The law in the frame is NaN, so that none that is not
  written passes for one.
"""

import importlib
import inspect
import sys
import tomllib
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, Final

import attrs

from rollslip.catalogue.discovery import offered_by, taken_back
from rollslip.catalogue.kinds import get_kind, usable_kinds
from rollslip.errors import OutputError, in_words
from rollslip.fields import FieldError
from rollslip_kernels.slices import CONDITIONS

__all__ = ["add_compiled"]

_BUILD: Final = 'requires = ["setuptools>=77"]'
_DATA: Final = '["py.typed"'


def add_compiled(folder: Path, requirement: str) -> list[str]:
    """Add the frame of a compiled form to a package."""
    from rollslip.files import whole_file

    def refused(reason: str) -> FieldError:
        return FieldError("add-compiled", f"{folder}: {reason}")

    try:
        text = (folder / "pyproject.toml").read_text(encoding="utf-8")
        groups: dict[str, dict[str, str]] = tomllib.loads(text)["project"].get("entry-points", {})
    except (OSError, ValueError, KeyError) as error:
        raise refused(f"is no package that can be read ({in_words(error)}); name the folder of one") from None
    able = {kind.name for kind in usable_kinds() if kind.template and kind.template.compiled}
    found = [
        (kind, module)
        for kind in sorted(able)
        for module in set(groups.get(f"rollslip.{kind.replace('-', '_')}", {}).values())
    ]
    if len(found) != 1:
        offered = " and ".join(sorted(groups)) or "nothing"
        raise refused(f"offers {offered}; a form is added to one module of {', '.join(sorted(able))}")
    ((kind, module),) = found
    package = module.partition(".")[0]
    source = folder / "src" / package
    there = [path for path in (folder / "setup.py", source / "_kernel.pyx", source / "_kernel.pyi") if path.exists()]
    if there:
        raise refused(f"{there[0].name} is there already, and is left as it is")
    if _BUILD not in text or _DATA not in text:
        raise refused(f"its pyproject.toml does not hold {_BUILD} and {_DATA} any more; write them so, and try again")
    cls = _model(source.parent, module, kind, refused)
    fields = {one.name: one.type for one in attrs.fields(cls)}
    if other := [name for name, of in fields.items() if of not in (float, "float")]:
        raise refused(f"its parameters {', '.join(other)} are no plain numbers; such a form is written by hand")
    setup = (files("rollslip.catalogue") / "templates" / "setup.py.in").read_text(encoding="utf-8")
    arguments = ", ".join(f"{name}: float" for name in fields)
    texts = {
        source / "_kernel.pyx": _frame(cls, module, list(fields)),
        source / "_kernel.pyi": f"def capsule({arguments}) -> object: ...\n",
        folder / "setup.py": Template(setup).substitute(module=package, kernels='"_kernel"'),
        folder / "pyproject.toml": text.replace(
            _BUILD, f'requires = ["setuptools>=77", "Cython>=3.1", "{requirement}"]', 1
        ).replace(_DATA, f'{_DATA}, "*.pyi"', 1),
    }
    try:
        for path, content in texts.items():
            with whole_file(path) as partial:
                partial.write_text(content, encoding="utf-8", newline="\n")
    except OutputError:
        for path in texts.keys() - {folder / "pyproject.toml"}:
            path.unlink(missing_ok=True)
        raise
    given = ", ".join(f"self.{name}" for name in fields)
    if inspect.isfunction(getattr(sys.modules[module], cls.__name__, None)):
        offering = "and give @rollslip.model of it: kernel=_kernel.capsule"
    else:
        offering = (
            f"and give class {cls.__name__} its method: def kernel(self) -> object: return _kernel.capsule({given})"
        )
    return [
        f"1. write the law in {source.relative_to(folder) / '_kernel.pyx'} in place of NaN",
        f"2. in src/{module.replace('.', '/')}.py import it: from {package} import _kernel",
        f"3. {offering}",
        '4. pip install "setuptools>=77" "Cython>=3.1"; pip install --no-build-isolation -e .; pytest',
    ]


def _model(source: Path, module: str, kind: str, refused: Any) -> Any:
    """Return the one class that a module of a package offers."""
    sys.path.insert(0, str(source))
    try:
        with taken_back():
            offered = offered_by(importlib.import_module(module), get_kind(kind))
    except Exception as error:
        raise refused(f"{module} cannot be used ({in_words(error)})") from error
    finally:
        sys.path.remove(str(source))
    if len(offered) != 1:
        raise refused(f"{module} offers {len(offered)} models; a form is added where it is one")
    return offered[0]


def _frame(cls: Any, module: str, fields: list[str]) -> str:
    """Write the Cython file of a class: parameters, what it reads of a slice, and the loop."""
    columns = [name for name in sorted(cls.reads) if name not in CONDITIONS]
    lines = [
        f'"""The law of {module} compiled: a loop over the slices of a block, without Python."""',
        "",
        "from libc.math cimport NAN",
        "from rollslip_abi cimport rs_slices",
        "from rollslip_stage cimport rs_new_model",
        "",
        "",
        *(["cdef struct law_t:", *(f"    double {name}" for name in fields), "", ""] if fields else []),
        *(f"# {line}".rstrip() for line in cls.equation.splitlines()),
        "cdef int _evaluate(const rs_slices *s, const void *params) noexcept nogil:",
        *(["    cdef const law_t *own = <const law_t *>params"] if fields else []),
        *(f"    cdef double {name} = own.{name}" for name in fields),
        *(f"    cdef double {name} = s.{name}" for name in sorted(cls.reads) if name in CONDITIONS),
        *([f"    cdef double {', '.join(columns)}"] if columns else []),
        "    cdef size_t i",
        "    for i in range(s.n):",
        *(f"        {name} = s.{name}[i]" for name in columns),
        *(f"        s.{name}[i] = NAN  # the law of evaluate(), for one slice" for name in sorted(cls.writes)),
        "    return 0",
        "",
        "",
        f"def capsule({', '.join(f'double {name}' for name in fields)}):",
        '    """Return the stage; the capsule holds its own copy of the parameters."""',
        *(["    cdef law_t own", *(f"    own.{name} = {name}" for name in fields)] if fields else []),
        f"    return rs_new_model(_evaluate, {'&own, sizeof(own)' if fields else 'NULL, 0'}, None)",
        "",
    ]
    return "\n".join(lines)
