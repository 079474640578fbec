"""The lines of keys and of faults in TOML."""

import contextlib
import tomllib
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rollslip.errors import SceneError
from rollslip.toml import key_lines, parse

pytestmark = pytest.mark.quick

TRICKY = '''\
# [not.a.table] = "x"
a = "# no comment" # a comment with "quotes
'b c' = 'x = "1"'
"d\\"e".f . g = """
[h]
i = 1 \\""" still
"""""
j = \'\'\'
k = 1
\'\'\'
l = [ # ]
  "]", \'[\', [1, 2],
  { m = 1, n = [ "}" ] },
]
o = ""
p = { q.r = 1, s = "}" }

[t] # [u]
v = 1979-05-27T07:32:00Z
[ w . "x y" ]
z = \'\'
[[aa]]
b = 1
[[aa.b-b]]
c = 1
[[ aa.b-b ]]
c = 1
[aa.b-b.d]
e = 1
[[aa]]
b = 1
[[aa.b-b]]
c = """a"""
[w]
last = -inf'''


def test_the_lines_of_a_tricky_document() -> None:
    expected = {
        ("a",): 2,
        ("b c",): 3,
        ('d"e',): 4,
        ('d"e', "f", "g"): 4,
        ("j",): 8,
        ("l",): 11,
        ("o",): 15,
        ("p",): 16,
        ("t",): 18,
        ("t", "v"): 19,
        ("w",): 34,
        ("w", "x y"): 20,
        ("w", "x y", "z"): 21,
        ("aa",): 22,
        ("aa", 0): 22,
        ("aa", 0, "b"): 23,
        ("aa", 0, "b-b"): 24,
        ("aa", 0, "b-b", 0, "c"): 25,
        ("aa", 0, "b-b", 1): 26,
        ("aa", 0, "b-b", 1, "c"): 27,
        ("aa", 0, "b-b", 1, "d"): 28,
        ("aa", 0, "b-b", 1, "d", "e"): 29,
        ("aa", 1): 30,
        ("aa", 1, "b"): 31,
        ("aa", 1, "b-b", 0, "c"): 33,
        ("w", "last"): 35,
    }
    tomllib.loads(TRICKY)
    for text in (TRICKY, TRICKY + "\n", TRICKY.replace("\n", "\r\n")):
        lines = key_lines(text)
        assert {path: lines.get(path) for path in expected} == expected


keys = st.sampled_from(["a", "b-c", "1", '"q.r"', "'s t'", '"u\\"#v"', "'[w]'"])
scalars = st.sampled_from(
    [
        "1",
        "-1.5e3",
        "true",
        '"x"',
        '"a # [b] \\" = 1"',
        "'# \"'",
        '"""\n[z]\na = 1\n"""',
        "'''\n'''",
        "nan",
        '""""x"""""',
    ]
)
values = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: "[" + " , # ]\n".join([*items, ""]) + "]"),
        st.lists(st.tuples(keys, scalars), max_size=2, unique_by=lambda item: item[0]).map(
            lambda items: "{" + ", ".join(f"{key} = {value}" for key, value in items) + "}"
        ),
    ),
    max_leaves=4,
)
dotted = st.lists(keys, min_size=1, max_size=3).map(" . ".join)
statements = st.lists(
    st.one_of(
        st.tuples(dotted, values).map(lambda item: f"{item[0]} = {item[1]} # x = 1"),
        dotted.map(lambda key: f"[{key}]"),
        dotted.map(lambda key: f"[[ {key} ]] # ["),
        st.sampled_from(["", "# [a]", "  \t"]),
    ),
    max_size=12,
)


def valid_document(lines: list[str]) -> str:
    """Keep the statements that TOML allows after those before them."""
    text = ""
    for line in lines:
        try:
            tomllib.loads(text + line + "\n")
        except tomllib.TOMLDecodeError:
            continue
        text += line + "\n"
    return text


def leaves(value: object, path: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    if isinstance(value, Mapping) and value:
        return [leaf for key, inner in value.items() for leaf in leaves(inner, (*path, key))]
    return [path]


@given(statements)
def test_every_key_has_the_line_where_it_appeared(lines: list[str]) -> None:
    """The line noted for a key is that of the statement with which the key enters the parsed document."""
    text = valid_document(lines)
    noted = key_lines(text)
    every: set[tuple[str | int, ...]] = set()
    for path in leaves(tomllib.loads(text)):
        longest = next((path[:n] for n in range(len(path), 0, -1) if path[:n] in noted), None)
        if path:
            assert longest is not None
            every.add(longest)
    documents = complete_documents(text)
    for path in every:
        line = noted[path]
        before = documents[line]
        after = documents[min(start for start in documents if start > line)]
        assert holds(after, path)
        # Later statements may open a table again; anything else enters once.
        assert not holds(before, path) or isinstance(lookup(before, path), dict | list)


def complete_documents(text: str) -> dict[int, dict[str, Any]]:
    """Map each line before which the document is complete, so that a statement can begin there, to that document."""
    lines = text.splitlines(keepends=True)
    documents = {}
    for number in range(len(lines) + 1):
        with contextlib.suppress(tomllib.TOMLDecodeError):
            documents[number + 1] = tomllib.loads("".join(lines[:number]))
    return documents


def lookup(document: Any, path: tuple[str | int, ...]) -> Any:
    for part in path:
        document = document[part]
    return document


def holds(document: Any, path: tuple[str | int, ...]) -> bool:
    try:
        lookup(document, path)
    except (LookupError, TypeError):
        return False
    return True


@pytest.mark.parametrize(
    ("text", "start", "end"),
    [
        ("a = 1\nb = \n", "scene.toml:2: not valid TOML: ", "(column 5)"),
        ("a = 15 mm\n", "scene.toml:1: not valid TOML: ", 'one with a unit in quotes, as "15 mm"'),
        (
            "[a]\nb = 1,5\n",
            "scene.toml:2: not valid TOML: ",
            'one with a unit in quotes, as "15 mm"',
        ),
        ("[a]\nb = moes\n", "scene.toml:2: not valid TOML: ", 'write a text in quotes, as "moes"'),
        (
            'a = "x\nb = 1\n',
            "scene.toml:1: not valid TOML: ",
            "; a quote is missing at the end of the line",
        ),
        (
            "a = \u201c1 kN\u201d",
            "scene.toml:1: not valid TOML: ",
            'typographic quote, write " instead',
        ),
        (
            "a = \u20181 kN\u2019",
            "scene.toml:1: not valid TOML: ",
            'typographic quote, write " instead',
        ),
        (r'a = "C:\data\x"', "scene.toml:1: not valid TOML: ", "'C:\\data\\rig.csv', or with /"),
        (r'a = "C:\users\x"', "scene.toml:1: not valid TOML: ", "'C:\\data\\rig.csv', or with /"),
        (
            'a = 1\nb = ["\\u0000"]',
            "scene.toml:2: not valid TOML: ",
            "has the character U+0000 (column 1)",
        ),
        ("a = 1\nb = [1,\n", "scene.toml:3: not valid TOML: ", "(at the end of the file)"),
        ("a = 1e5\na = 1e5\nb = 1", "scene.toml:2: not valid TOML: ", ")"),
        ("a = " + "1" * 5000, "scene.toml: not valid TOML: ", ""),
        ("a = " + "[" * 100_000, "scene.toml", ""),
        (
            "[a]\nx = { b" + ' . "c"' * 100_000 + " = 1 }",
            "scene.toml:2: not valid TOML: a key has more than 1000 parts",
            "",
        ),
    ],
)
def test_a_syntax_error_has_its_line(text: str, start: str, end: str) -> None:
    with pytest.raises(SceneError) as caught:
        parse(text, "scene.toml")
    [problem] = caught.value.problems
    assert problem.startswith(start)
    assert problem.endswith(end)
