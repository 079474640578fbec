"""Size and legibility are measured as their definitions say, and the sources keep their budgets."""

import pytest

import legibility

#: Code, and its counts worked out by hand. Counts that are left out are not looked at.
SAMPLES = [
    # a docstring, an import and a comment cost nothing
    ('"""About."""\nimport re\n\n# comment\nx = 1\n', {"statements": 1, "tokens": 5, "code_lines": 2}),
    # import re / x = 1 has five tokens; a name in a docstring is no identifier, a keyword neither
    ('"""A told name."""\nimport re\nx = 1\n', {"identifiers": 2, "private_identifiers": 0}),
    # statements in one line, and in two
    ("a = 1; b = 2\n", {"statements": 2, "assignments": 2, "tuple_assignments": 0, "code_lines": 1}),
    ("a, b, c = 1, 2, 3\n", {"statements": 3, "assignments": 1, "tuple_assignments": 1}),
    # unpacking what a call returns is one statement
    ("a, b = pair()\n", {"statements": 1, "assignments": 1, "tuple_assignments": 0}),
    # a conditional expression is as much as an `if` with two branches, a comprehension as a loop
    ("a = 1 if b else 2\n", {"statements": 3}),
    ("if b:\n    a = 1\nelse:\n    a = 2\n", {"statements": 3}),
    ("a = [x for x in y]\n", {"statements": 2}),
    ("a = {x: {z for z in x} for x in y}\nb = sum(x for x in y)\n", {"statements": 5}),
    # class, field, method, return
    ('class A:\n  """Doc."""\n  b: int = 1\n  def c(self):\n    """Doc."""\n    return 1\n', {"statements": 4}),
    # a text that is no docstring is a statement
    ('x = 1\n"text"\n', {"statements": 2}),
    # private are told, share, way_up and toldMore
    ("told(sharing, share, way_up, up_way, toldMore)\n", {"identifiers": 6, "private_identifiers": 4}),
    # three tokens and a text of two lines, with fields: it is one token in each version of Python
    ('x = f"""a{told + f\'{share}\'}\n"""\n', {"tokens": 3, "code_lines": 2, "identifiers": 1}),
    # packed: a pair, and two names of one value; not of variables
    ("A, B = 1, 2\nC = D = f()\ne, f = 1, 2\n", {"packed_constants": 2}),
    # bare: A, D and E; a constant in a function and the result of a call are none
    (
        "A = 1\n# why\nB = 2.0\nC = 3  # why\nD: int = 4\n\nE = (1, -2.5)\nF = f(1)\nG = True\nH = 'x'\nlow = 1\n"
        "def f(x):\n    K = 1\n",
        {"bare_constants": 3, "packed_constants": 0},
    ),
    # 14 and 15 branches, of which the last three are `for`, `if` and `or` of one comprehension
    ("def f():\n" + "    if x: pass\n" * 14, {"branchy_functions": 0}),
    ("def f():\n" + "    if x: pass\n" * 13 + "    [y for y in z if y or x]\n", {"branchy_functions": 1}),
    # branches of an inner function count for the outer one
    ("def f():\n    def g():\n" + "        while x: pass\n" * 15, {"branchy_functions": 2}),
]  # fmt: skip

PROMISED = '''
__all__ = ["Law", "f", "g", "h", "missing"]


def f(a, b):
    """Return `a` of ``b``."""


def g(a, *, b):
    """Return a of ``b``."""


def h(a):
    """Say nothing: it has one parameter."""


def other(a, b):
    """Is not promised."""


class Law:
    def __init__(self, a, b):
        """Has no public name."""

    def film(self, load, /, speed, *rest, **more):
        """Return the film.

        Parameters
        ----------
        load, speed
            N/m, m/s
        """

    def width(self, load):
        """Have one parameter."""

    @classmethod
    def made(cls, load, speed):
        return 1
'''

PYX = '''"""Doc
of two lines."""
# comment

cdef double f(double x) noexcept:
    r"""Doc."""
    return x  # comment
    """
    Doc.
    """
'''

HEADER = """/* one line */
/* two
 * lines */
#define A 1 /* why */

static int f(void) { return A; } // why
// comment
"""


@pytest.mark.quick
@pytest.mark.parametrize(("text", "counts"), SAMPLES)
def test_counts_are_those_worked_out_by_hand(text, counts):
    measured = legibility.measure(text)
    assert {name: measured[name] for name in counts} == counts


def test_promised_functions_describe_each_parameter():
    counts = legibility.measure(PROMISED)
    # f, g, Law.film and Law.made are asked for it; f and Law.film do it
    assert (counts["promised_functions"], counts["described_functions"]) == (4, 2)
    assert legibility.FIGURES["described_parameters"].value(counts) == 50


@pytest.mark.parametrize(
    ("name", "is_private"),
    [
        ("told", True), ("TOLD", True), ("untold", True), ("told_slip", True), ("slipTold", True), ("Told2", True),
        ("toll", False), ("atoll", False), ("retold", False),
        ("way_up", True), ("wayUp", True), ("way", False), ("up_way", False), ("way_to_up", False),
        ("at_most", False), ("at_least_2", False), ("most", True), ("at_most_most", True), ("left_at_most_out", False),
    ],
)  # fmt: skip
def test_private_words_are_found_in_identifiers(name, is_private):
    assert legibility.is_private(name) is is_private


def test_lines_of_kernels_are_those_with_code():
    assert legibility.count_kernel_lines(PYX, is_c=False) == 2
    assert legibility.count_kernel_lines(HEADER, is_c=True) == 2


@pytest.fixture
def repository(tmp_path):
    """A repository with a module in each root and kernels beside what the build makes of them."""
    for folder in legibility.ROOTS.values():
        path = tmp_path / folder / "inner" / "module.py"
        path.parent.mkdir(parents=True)
        path.write_text("a, b = 1, 2\n")
    kernels = tmp_path / "kernels" / "rollslip_kernels"
    kernels.mkdir(parents=True)
    (kernels / "law.pyx").write_text(PYX)
    (kernels / "law.pyi").write_text("def f(x: float) -> float: ...\n")
    (kernels / "law.c").write_text("/* Generated by Cython 3 */\nint x;\n")
    (kernels / "law_h.pxd").write_text(
        "# Written by setup.py from law.h.\ncdef double f(double x)\n"
    )
    (kernels / "written.c").write_text("int x;\n")
    (kernels / "law.h").write_text(HEADER)
    return tmp_path


def test_figures_of_a_repository_cover_its_roots(repository):
    figures = legibility.budgeted_figures(repository)
    assert figures["statements"] == {"product": 8, "tests": 2}
    assert figures["kernel_lines"] == {"kernels": 5}
    assert figures["tuple_assignments"] == dict.fromkeys(legibility.ROOTS, 100)
    assert figures["described_parameters"] == dict.fromkeys(legibility.ROOTS, 0)
    assert figures.keys() == legibility.FIGURES.keys()


#: Budgets of made-up figures: two counts, a ratio that should be small and one that should be large.
LIMITS = {
    "statements": {"product": 1000},
    "tokens_per_line": {"tests": 9.0},
    "packed_constants": {"tests": 20},
    "described_parameters": {"models": 50},
}


@pytest.mark.parametrize(
    ("name", "place", "value", "violations", "loose"),
    [
        (
            "statements",
            "product",
            1001,
            ["statements of product: 1,001 is worse than the budget, 1,000"],
            [],
        ),
        ("statements", "product", 1000, [], []),
        ("statements", "product", 990, [], []),
        (
            "statements",
            "product",
            989,
            [],
            ["statements of product: set the budget to 989, it is 1,000"],
        ),
        (
            "tokens_per_line",
            "tests",
            9.2,
            ["tokens_per_line of tests: 9.2 is worse than the budget, 9.0"],
            [],
        ),
        # a ratio has slack: deleting code that is better than the rest raises it, too
        ("tokens_per_line", "tests", 9.1, [], []),
        ("tokens_per_line", "tests", 8.9, [], []),
        (
            "tokens_per_line",
            "tests",
            8.8,
            [],
            ["tokens_per_line of tests: set the budget to 8.8, it is 9.0"],
        ),
        (
            "packed_constants",
            "tests",
            21,
            ["packed_constants of tests: 21 is worse than the budget, 20"],
            [],
        ),
        ("packed_constants", "tests", 19, [], []),
        (
            "packed_constants",
            "tests",
            0,
            [],
            ["packed_constants of tests: set the budget to 0, it is 20"],
        ),
        (
            "described_parameters",
            "models",
            48,
            ["described_parameters of models: 48 is worse than the budget, 50"],
            [],
        ),
        ("described_parameters", "models", 49, [], []),
        ("described_parameters", "models", 51, [], []),
        (
            "described_parameters",
            "models",
            52,
            [],
            ["described_parameters of models: set the budget to 52, it is 50"],
        ),
    ],
)
def test_a_figure_may_neither_be_worse_than_its_budget_nor_far_better(
    name, place, value, violations, loose
):
    figures = LIMITS | {name: {place: value}}
    assert legibility.find_violations(figures, LIMITS) == violations
    assert legibility.find_loose_budgets(figures, LIMITS) == loose


def test_each_figure_has_a_budget():
    without = {name: places for name, places in LIMITS.items() if name != "statements"}
    fault = ["statements of product: has no budget, or a budget without a figure"]
    assert (
        legibility.find_violations(LIMITS, without)
        == legibility.find_violations(without, LIMITS)
        == fault
    )


def test_budgets_are_lowered_and_never_raised(tmp_path):
    path = tmp_path / "budgets.toml"
    before = (
        "# why\n[statements]\nproduct = 39_653\n# of tests\ntests = 100  # why\n\n"
        "[tuple_assignments]\ntests = 10.7\nmodels = 9.0\n"
    )
    path.write_text(before)
    worse = {
        "statements": {"product": 39_000, "tests": 101},
        "tuple_assignments": {"tests": 8, "models": 9},
    }
    with pytest.raises(ValueError, match="tests: 101 is worse than the budget, 100"):
        legibility.lower(path, worse)
    assert path.read_text() == before
    # a ratio within its slack is no violation, and its budget stays
    better = {
        "statements": {"product": 38_000, "tests": 100},
        "tuple_assignments": {"tests": 9.5, "models": 9.1},
    }
    legibility.lower(path, better)
    assert path.read_text() == before.replace("39_653", "38_000").replace("10.7", "9.5")


def test_the_command_lists_the_worst_files(monkeypatch, capsys, repository):
    short = repository / "framework/rollslip/inner/module.py"
    (short.parent / "long.py").write_text(short.read_text() + "told = 1\n" * 100)
    monkeypatch.setattr(legibility.measure_files, "__defaults__", (repository,))
    assert legibility.main(["--worst", "3"]) == 0
    shown = capsys.readouterr().out
    assert [line.split()[:2] for line in shown.splitlines()[1:6]] == [
        ["framework", "104"], ["models", "2"], ["studies", "2"], ["campaigns", "2"], ["tests", "2"],
    ]  # fmt: skip
    assert "product: 110 statements" in shown
    worst = shown.partition("worst by private/1000:\n")[2].partition("\n\n")[0].split()
    assert worst == ["980.4", "framework/rollslip/inner/long.py"]


def test_the_command_refuses_to_raise_a_budget(monkeypatch, capsys, tmp_path):
    path = tmp_path / "budgets.toml"
    path.write_text("[statements]\nproduct = 1\n")
    monkeypatch.setattr(legibility, "BUDGETS", path)
    monkeypatch.setattr(legibility, "budgeted_figures", lambda: {"statements": {"product": 2}})
    assert legibility.main(["--lower"]) == 1
    assert "product: 2 is worse" in capsys.readouterr().err
    monkeypatch.setattr(legibility, "budgeted_figures", lambda: {"statements": {"product": 0}})
    assert legibility.main(["--lower"]) == 0
    assert path.read_text() == "[statements]\nproduct = 0\n"


@pytest.mark.lint
def test_the_sources_keep_their_budgets():
    figures = legibility.budgeted_figures()
    budgets = legibility.read_budgets()
    assert legibility.find_violations(figures, budgets) == []
    assert (
        legibility.find_loose_budgets(figures, budgets) == []
    )  # `python tests/support/legibility.py --lower` mends it
