"""Write what other tools read of the kernels, from the sources that say it.

- A stub for type checkers, .pyi, from each .pyx file, with the public names of the module. Their types are the C types
  and annotations of the .pyx; what has neither is an object. A function without an annotation of its result returns a
  capsule.
- The form for Cython, .pxd, of the C headers below: their structures, enumerators, functions and constants. Cython sees
  neither macros nor sizes of arrays, so that lists are written out, and arrays stand as pointers.
- The names that elementary functions have in each instruction set, stages/names.h.
"""

import re
from collections.abc import Iterator
from pathlib import Path

#: Headers that Cython reads: module of declarations -> header.
HEADERS = {
    "rollslip_abi": "include/rollslip.h",
    "columns_h": "motion/columns.h",
    "linear_friction_h": "motion/linear_friction.h",
    "friction_table_h": "motion/friction_table.h",
    "system_h": "motion/system.h",
    "bearing_h": "motion/bearing.h",
    "planar_columns_h": "motion/planar_columns.h",
    "carried_columns_h": "motion/carried_columns.h",
    "table_h": "stages/table.h",
}

#: What annotations may name that the .pyx does not import, since they are kept as text: module -> names.
NAMES = {
    "collections.abc": ("Callable", "Collection", "Iterable", "Mapping", "Sequence"),
    "typing": ("Any", "Final", "Literal", "TypeAlias"),
    "numpy.typing": ("ArrayLike", "NDArray"),
    "rollslip_kernels.chain": ("Chain", "Refusal"),
    "rollslip_kernels.motion.rosenbrock": ("Stepper",),
    "rollslip_kernels.slices": ("Slices",),
}
ARRAY = "Array: TypeAlias = NDArray[np.float64]"
PYTHON = {
    "double": "float",
    "bint": "bool",
    "int": "int",
    "size_t": "int",
    "Py_ssize_t": "int",
    "object": "Any",
}
C_TYPE = r"(?:const )?\w+(?:\[[^]]*\])?"
#: A class, a function or an annotated name, at the margin or within a class; texts are cut to their first line before.
ITEM = re.compile(
    r"^(?P<indent>(?: {4})?)(?:"
    r"(?P<decorator>@\S+)"
    r"|(?:cdef )?class (?P<cls>\w+)(?P<base>\(\w+\))?:"
    r"|def (?P<name>\w+)\((?P<parameters>.*?)\)(?: -> (?P<returns>[^\n]+))?:"
    r"|(?P<variable>\w+): (?P<type>[^=#\n]+?)(?P<value> = [^\n]+)?$"
    r")(?:\n +(?P<text>\"\"\"[^\n]*\"\"\")$)?",
    re.MULTILINE | re.DOTALL,
)


def python_type(c_type: str) -> str:
    """Return what Python sees of a C type; a typed memoryview takes an array."""
    if "[" in c_type:
        return "NDArray[np.intp]" if "Py_ssize_t" in c_type else "Array"
    return PYTHON.get(c_type, c_type)


def parameter(text: str) -> str:
    """Return a parameter of a Cython function as a stub has it."""
    form = rf"(?:(?P<c>{C_TYPE}) )?(?P<name>\**\w*)(?: not None)?(?:: (?P<annotation>.+?))?(?P<default> ?= ?.+)?"
    found = re.fullmatch(form, text)
    assert found, f"no parameter: {text}"
    if found["name"] in ("self", "*"):
        return found["name"]
    annotation = found["annotation"] or "object"
    if found["c"] and not found["annotation"]:
        annotation = python_type(found["c"])
        if found["default"] == "=None":
            annotation += " | None"
    default = " = ..." if found["default"] else ""
    return f"{found['name']}: {annotation}{default}"


def parameters(text: str) -> str:
    """Return the parameters of a Cython function, which commas outside brackets separate."""
    depth = 0
    start = 0
    parts = []
    text = " ".join(text.split()).rstrip(",") + ","
    for k, character in enumerate(text):
        if character in "([":
            depth += 1
        elif character in ")]":
            depth -= 1
        elif character == "," and depth == 0:
            parts.append(text[start:k].strip())
            start = k + 1
    return ", ".join(parameter(part) for part in parts if part)


def members(text: str) -> dict[str, list[str]]:
    """Return what Cython classes show of their attributes: class -> lines of a stub."""
    found = dict[str, list[str]]()
    cls = ""
    pattern = rf"^cdef class (\w+)|^    cdef (?:readonly|public) ({C_TYPE}) ([\w, ]*\w)"
    for opened, c_type, names in re.findall(pattern, text, re.MULTILINE):
        cls = opened or cls
        lines = found.setdefault(cls, [])
        lines += [f"    {name}: {python_type(c_type)}" for name in names.split(", ") if name]
    return found


def imports(code: str, own: str) -> list[str]:
    """Return the imports of a stub for the names that its code has; ``own`` is the name of its module."""
    lines = ["import numpy as np"]
    for module, names in NAMES.items():
        used = [name for name in names if re.search(rf"\b{name}\b", code)]
        if used and not module.endswith(f".{own}"):
            lines.append(f"from {module} import {', '.join(used)}")
    return lines


def stub(source: Path) -> str:
    """Return the stub of a .pyx file."""
    text = re.sub(
        r'"""(.*?)(?:\n.*?)?"""', r'"""\1"""', source.read_text(encoding="utf-8"), flags=re.DOTALL
    )
    header = source.with_suffix(".pxd")
    attributes = members((header.read_text(encoding="utf-8") if header.exists() else "") + text)
    lines = list[str]()
    decorator = cls = ""
    for item in ITEM.finditer(text):
        indent = item["indent"]
        name = item["cls"] or item["name"] or item["variable"] or ""
        if not indent:
            cls = item["cls"] or ""
        body = f"{indent}    {item['text'] or '...'}"
        if re.match("_[^_]", name) or re.match("_[^_]", cls) or (indent and not cls):
            decorator = ""
        elif item["decorator"]:
            decorator = f"{indent}{item['decorator']}\n"
        elif item["cls"]:
            lines += ["", f"class {name}{item['base'] or ''}:", body]
            lines += attributes.get(name, [])
        elif item["name"]:
            result = (
                "None"
                if name == "__init__" or ".setter" in decorator
                else item["returns"] or "object"
            )
            space = "" if indent else "\n"
            lines.append(
                f"{space}{decorator}{indent}def {name}({parameters(item['parameters'])}) -> {result}:"
            )
            lines.append(body)
            decorator = ""
        else:
            value = item["value"] if item["type"] == "TypeAlias" else ""
            lines.append(f"{indent}{name}: {item['type']}{value}")
    code = "\n".join(line for line in lines if '"""' not in line)
    head = [
        f"# Written by setup.py from {source.name}.",
        *imports(ARRAY + code, source.stem),
        "",
        ARRAY,
    ]
    return "\n".join(head + lines) + "\n"


def expanded(text: str) -> Iterator[str]:
    """Yield the lines of a header without comments, with what macros of one name write out, such as lists X(name)."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL).replace("\\\n", " ")
    macros = dict[str, tuple[str, str]]()
    for line in re.sub(r'"[^"\n]*"', '""', text).splitlines():
        define = re.match(r"#define (\w+)\((\w+)[^)]*\)(.*)", line)
        if define:
            macros[define[1]] = define[2], define[3]
            continue
        while call := re.search(rf"\b({'|'.join(macros) or '-'})\((\w+)[^()]*\)", line):
            name, form = macros[call[1]]
            line = line[: call.start()] + re.sub(rf"\b{name}\b", call[2], form) + line[call.end() :]
        yield line


def items(text: str) -> Iterator[str]:
    """Yield what stands in C at the margin: definitions of types, and functions with their bodies."""
    depth = 0
    start = 0
    for k, character in enumerate(text):
        depth += (character == "{") - (character == "}")
        if depth == 0 and character in ";}":
            item = " ".join(text[start : k + 1].split())
            if character == ";" or re.match(r"[^{;]*\) ?\{", item):
                item = re.sub(r"^(?:(?:static|inline|RS_[A-Z_]+) )+|\b__restrict ", "", item)
                yield item.replace("( ", "(").replace(" )", ")")
                start = k + 1


def member(text: str) -> list[str]:
    """Return the members that a line of a C structure declares; an array is declared as a pointer."""
    if "(" in text:
        return [f"{text} noexcept nogil"]
    found = re.fullmatch(r"((?:const )?\w+) (.*)", text)
    assert found, f"no member: {text}"
    names = [name.strip() for name in found[2].split(",")]
    return [f"{found[1]} {'*' * name.count('[')}{name.partition('[')[0]}" for name in names]


def declaration(item: str) -> list[str]:
    """Return lines that declare a definition of C in Cython."""
    if found := re.fullmatch(r"enum \{(.*)\};", item):
        return [
            "enum:",
            *(f"    {name.split('=')[0].strip()}" for name in found[1].split(",") if name.strip()),
        ]
    if found := re.fullmatch(r"typedef struct \{(.*)\} (\w+);", item):
        lines = [text.strip() for text in found[1].split(";") if text.strip()]
        return [
            f"ctypedef struct {found[2]}:",
            *(f"    {line}" for text in lines for line in member(text)),
        ]
    if found := re.fullmatch(r"typedef (.*);", item):
        return [f"ctypedef {found[1]}{' noexcept nogil' if '(' in found[1] else ''}"]
    found = re.match(r"([^{=]+\)) ?\{", item)
    return [found[1]] if found else []


def constant(line: str) -> list[str]:
    """Return lines that declare a macro that is a text or a number."""
    found = re.match(r"#define (\w+) +(\"\"|[\d.]\S*)", line)
    if not found:
        return []
    if found[2].isdigit():
        return ["enum:", f"    {found[1]}"]
    kind = "double " if found[2][0].isdigit() else "char *"
    return [f"const {kind}{found[1]}"]


def declarations(header: Path) -> str:
    """Return the .pxd file that declares what a C header defines, and what the headers do that it includes."""
    text = header.read_text(encoding="utf-8")
    lines = list(expanded(text))
    code = "\n".join(line for line in lines if not line.startswith("#"))
    found = [*map(constant, lines), *map(declaration, items(code))]
    written = [f"# Written by setup.py from {header.name}.", "from libc.stdint cimport uint32_t"]
    for name in re.findall(r'#include "(?:\w+/)?(\w+\.h)"', text):
        written += [
            f"from {module} cimport *"
            for module, place in HEADERS.items()
            if place.endswith(f"/{name}")
        ]
    place = (
        header.name if header.parent.name == "include" else f"{header.parent.name}/{header.name}"
    )
    written += ["", f'cdef extern from "{place}" nogil:']
    for block in dict.fromkeys(tuple(block) for block in found if block):
        written += [f"    {line}" for line in block] + [""]
    return "\n".join(written)


def names(header: Path) -> str:
    """Return macros that name the functions of a header after the instruction set that is compiled, PATH(name)."""
    found = re.findall(r"^RS_INLINE \w+ (\w+)\(", header.read_text(encoding="utf-8"), re.MULTILINE)
    head = f"/* Written by setup.py from {header.name}: rs_exp is rs_exp_v3 while v3 is compiled, as not all fuse. */"
    return "\n".join([head, *(f"#define {name} PATH({name})" for name in found)]) + "\n"


def write(path: Path, text: str) -> None:
    """Write a file, unless it is there with this text: what depends on it is not built again."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def write_declarations(package: Path) -> None:
    """Write the stubs of all modules of the kernels, and the forms for Cython of their headers."""
    for source in sorted(package.rglob("*.pyx")):
        write(source.with_suffix(".pyi"), stub(source))
    for module, place in HEADERS.items():
        header = package / place
        write(header.with_name(f"{module}.pxd"), declarations(header))
    write(package / "stages/names.h", names(package / "include/rollslip_math.h"))
