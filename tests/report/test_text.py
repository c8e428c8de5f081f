"""Tables as text."""

import pytest

from kinetostat.report import csv, text
from kinetostat.report.view import Table, View


def lines(table):
    return text.render(View("title", (table,))).splitlines()[2:]


def test_columns_are_broken_into_blocks_that_repeat_the_labels():
    table = Table(("", *(f"joint_{i}" for i in range(20))), (("vx", *map(float, range(20))), ("vy", *[0.5] * 20)))
    shown = lines(table)
    assert max(map(len, shown)) <= 80
    assert sum(line.startswith("vx") for line in shown) == 3
    numbers = [word for line in shown if line.startswith("vx") for word in line.split()[1:]]
    assert [float(word) for word in numbers] == list(range(20))


def test_long_names_are_broken_after_underscores():
    shown = lines(Table(("", "panda_finger_joint1"), (("vx", 1.0),)))
    assert [line.strip() for line in shown[:-1]] == ["panda_", "finger_", "joint1"]


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ((1.0, -0.5), ["1.00000", "-0.50000"]),
        ((1.0, 1e-17), ["1.00000", "0"]),
        ((1.0, -1e-9), ["1.00000", "0.00000"]),
        ((123.456, -1.0), ["123.4560", "-1.0000"]),
        ((123456.0, 0.001), ["1.2346e+05", "1.0000e-03"]),
        ((2e-6, -1e-6), ["2.0000e-06", "-1.0000e-06"]),
        ((0.0, -0.0), ["0", "0"]),
    ],
)
def test_numbers_of_a_table_share_a_format_that_shows_them(values, shown):
    assert lines(Table(("", "a", "b"), (("row", *values),)))[-1].split()[1:] == shown


def test_words_are_cut_in_their_middle_and_the_last_column_is_folded():
    table = Table(("name", "what"), (("x" * 60 + "_left_end", " ".join(["word"] * 40)),), words=True)
    shown = lines(table)
    assert max(map(len, shown)) <= 80
    assert shown[1].split()[0].endswith("_left_end"[-5:])
    assert ".." in shown[1]
    assert sum(line.count("word") for line in shown) == 40


def test_numbers_are_never_cut_and_headers_above_them_are_folded():
    row = ("1", "12.345678 s", "112.345678 s", "row 1234567", "3.1e-05", "some_joint_of_a_long_name", "word " * 20)
    header = ("", "from", "to", "the worst moment at", "smallest / largest", "joint", "what it takes")
    shown = lines(Table(header, (row, row), words=True))
    assert max(map(len, shown)) <= 80
    page = "\n".join(shown)
    for number in row[1:5]:
        assert page.replace("112.345678", "x" if number == row[1] else "112.345678").count(number) == 2
    assert page.count("..") == 2  # the name alone
    head = " ".join(" ".join(line.split()) for line in shown[: next(i for i, s in enumerate(shown) if "12.3" in s)])
    assert set(" ".join(header).split()) <= set(head.split())
    assert page.count("word") == 40


def test_a_name_beside_a_number_is_cut_all_the_same():
    row = ("x" * 70, "3.5 s", "word " * 10)
    shown = lines(Table(("name", "at", "what"), (row, ("7", "3.5 s", "")), words=True))
    assert max(map(len, shown)) <= 80


def test_control_characters_become_text():
    shown = text.render(View("title", (Table(("name",), (("a\x1b[31m\nb",),), words=True),)))
    assert "\x1b" not in shown
    assert r"a\x1b[31m\nb" in shown


def test_csv_escapes_and_defuses():
    table = Table(("name", "value"), (('a,"b"', 0.1), ("=cmd()", -1e-17), ("-2", None)), ("", "m"))
    assert csv.render(table) == 'name,value [m]\n"a,""b""",0.1\n\'=cmd(),-1e-17\n-2,\n'
