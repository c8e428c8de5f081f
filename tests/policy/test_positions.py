"""The finder of lines against tomllib: the same keys, and each where its name is."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetostat.policy.positions import key_lines, line_of

TEXT = '''# [no] table = 1
title = "a # b = [c"  # [nor here]
[check]
select = ["J", 'X'] # [
a . "c d".b = 3
many = """
[fake]
x = 1
""""
raw = \'\'\'
q = 2\'\'\'
when = 1979-05-27T07:32:00.5Z
[[robots]]
path = "a"
list = [
  [1, 2.5],
  { a = 1, b = { c = "}" } },  # ]
]
[[robots.expect]]
kind = "x"
  [[ robots . expect ]]
kind = "y"
[[robots]]
path = "b"
[[robots.expect]]
kind = "z"
'''


def walked(value, path=()):
    """Yield the path of each key and each list entry."""
    if path:
        yield path
    if isinstance(value, dict):
        for key, part in value.items():
            yield from walked(part, (*path, key))
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield from walked(part, (*path, i))


def test_finds_every_key_that_tomllib_reads():
    found, read = set(key_lines(TEXT)), set(walked(tomllib.loads(TEXT)))
    assert read - found == {
        ("robots",),
        ("robots", 0, "expect"),
        ("robots", 1, "expect"),
    }  # lists of tables have no line
    assert found <= read


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("title",), 2),
        (("check", "a", "c d", "b"), 5),
        (("check", "raw"), 10),
        (("check", "when"), 12),
        (("robots", 0, "list", 1, "b", "c"), 17),
        (("robots", 0, "expect", 0), 19),
        (("robots", 0, "expect", 1), 21),
        (("robots", 0, "expect", 1, "kind"), 22),
        (("robots", 1, "expect", 0, "kind"), 26),
    ],
)
def test_knows_the_line(path, line):
    assert key_lines(TEXT)[path] == line


def test_a_key_that_is_not_there_is_where_its_table_is():
    lines = key_lines(TEXT)
    assert line_of(("robots", 0, "expect", 1, "frame"), lines) == 21
    assert line_of(("nowhere",), lines) is None


values = st.recursive(
    st.integers(-9, 9) | st.booleans() | st.text(st.characters(codec="utf-8", exclude_categories=["C"]), max_size=6),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("ab.=[ #'", min_size=1, max_size=4), inner, max_size=3)
    ),
    max_leaves=8,
)


def toml(value):
    """Write a value, each entry of a list on its own line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, list):
        return "[\n" + "".join(f"  {toml(part)},  # ]\n" for part in value) + "]"
    return "{" + ", ".join(f"{toml(key)} = {toml(part)}" for key, part in value.items()) + "}"


@given(st.dictionaries(st.text("ab.=[ #'", min_size=1, max_size=4), values, max_size=4))
def test_finds_the_keys_of_any_values(content):
    text = "".join(f"\n{toml(key)} = {toml(value)}\n" for key, value in content.items())
    assert tomllib.loads(text) == content
    lines = key_lines(text)
    assert set(lines) == set(walked(content))
    for path, line in lines.items():
        if isinstance(path[-1], str):
            assert toml(path[-1]) in text.splitlines()[line - 1]
