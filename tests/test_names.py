"""Names of the product are terms of the field, not words that only this project uses."""

import keyword
import re
import tokenize

import pytest

import legibility

pytestmark = pytest.mark.quick

#: Names of Python, of libraries and of methods that contain a private word by accident; an option of `rollslip limit`.
ALLOWED = {
    "LeastSquaresEstimate", "break_long_words", "keep", "least_squares", "one_of", "ones", "ones_like",
}  # fmt: skip


def private_names(path):
    """Yield the private identifiers of a module with their lines."""
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            name = token.string
            is_name = token.type == tokenize.NAME and not keyword.iskeyword(name)
            if is_name and name not in ALLOWED and legibility.is_private(name):
                yield f"{path.name}:{token.start[0]}: {name}"


#: C code in a string of Cython, and what is no code: comments and strings of C, and those of Cython.
VERBATIM = re.compile(r'(cdef extern from [^\n]*:\n\s*)"""(.*?)"""', re.DOTALL)
TEXTS_OF_C = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)
TEXTS_OF_CYTHON = re.compile(
    r'"""(?:.*?)"""|#(?!define)[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'',
    re.DOTALL,
)


def private_names_of_kernel(path):
    """Return the private identifiers of a source in C or Cython; `ones` is NumPy's."""
    text = VERBATIM.sub(r"\1\2", path.read_text(encoding="utf-8"))
    texts = TEXTS_OF_C if path.suffix in (".h", ".c") else TEXTS_OF_CYTHON
    names = re.findall(r"[A-Za-z_]\w*", texts.sub(" ", text))
    return sorted({name for name in names if name != "ones" and legibility.is_private(name)})


def test_a_private_word_is_found_in_a_name(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("told = 1\nones = [told]\nslip = 2\n")
    assert [*private_names(path)] == ["module.py:1: told", "module.py:2: told"]


@pytest.mark.lint
def test_no_name_of_the_product_has_a_private_word():
    root = legibility.REPOSITORY
    paths = [
        path
        for place in legibility.PRODUCT
        for path in sorted((root / legibility.ROOTS[place]).rglob("*.py"))
    ]
    found = [name for path in paths for name in private_names(path)]
    assert found == []
    assert len(paths) > 300


def test_a_private_word_is_found_in_a_name_of_a_kernel(tmp_path):
    header = tmp_path / "law.h"
    header.write_text(
        '/* told */\n#define MOST 1 // held\nvoid f(double told, double s); /* kept */ char *w = "kept";\n'
    )
    assert private_names_of_kernel(header) == ["MOST", "told"]
    source = tmp_path / "law.pyx"
    source.write_text(
        '"""Is told."""\n# kept\ncdef extern from *:\n    """\n    #define RS_MOST 1\n    """\n'
        'cdef double held(double x):\n    """Is kept."""\n    return np.ones(x["share"])  # share\n'
    )
    assert private_names_of_kernel(source) == ["RS_MOST", "held"]


def test_no_name_of_the_kernels_has_a_private_word():
    kernels = legibility.REPOSITORY / "kernels"
    texts = {
        path: path.read_text(encoding="utf-8")
        for path in sorted(kernels.rglob("*"))
        if path.suffix in legibility.KERNEL_SUFFIXES
    }
    written = [path for path, text in texts.items() if not text.startswith(legibility.GENERATED)]
    found = {path.name: names for path in written if (names := private_names_of_kernel(path))}
    of_python = [name for path in sorted(kernels.rglob("*.py")) for name in private_names(path)]
    assert (found, of_python) == ({}, [])
    # with none read, none would be found
    assert len(written) > 50
