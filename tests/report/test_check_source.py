"""The line that a finding points at: where the caret stands."""

import time

import pytest
from rich.cells import cell_len

from kinetostat.report.check.source import columns, marked
from report.check_reports import finding

JOINT = "<joint name='elbow'>"


@pytest.mark.parametrize(
    ("text", "element", "attribute", "pointed"),
    [
        ('  <limit lower="2" upper="-2"/>', "<limit>", "lower", 'lower="2"'),
        ('  <limit lower="2" upper="-2"/>', "<limit>", "upper", 'upper="-2"'),
        ("  <limit lower = '2'/>", "<limit>", "lower", "lower = '2'"),
        ('  <joint name="elbow" type="revolute">', JOINT, "", "<joint"),
        ('  <joint name="elbow" type="revolute">', JOINT, "axis", "<joint"),  # it is in another line
        ('<parent link="a"/><child link="b"/>', f"{JOINT}<child>", "link", 'link="b"'),
        ('<a note="lower=1" lower="2"/>', "<a>", "lower", 'lower="2"'),
        ('<a note=">" lower="2"/>', "<a>", "lower", 'lower="2"'),
        ('<a flower="1" lower="2"/>', "<a>", "lower", 'lower="2"'),
        ('<b lower="1"/><a upper="2"/>', "<a>", "lower", "<a"),  # not that of its neighbour
        ('   lower="2" upper="3">', "<limit>", "lower", 'lower="2"'),  # the element starts above
        ('<mesh filename="package://x', "<mesh>", "filename", 'filename="package://x'),
        ('<drake:joint name="j">', "<drake:joint name='j'>", "name", 'name="j"'),
        ("<!-- kinetostat: ignore[J103] -->", "'kinetostat: ignore'", "", "<!--"),
        ('<!-- why --><limit lower="2"/>', "<limit>", "lower", 'lower="2"'),
        ("nothing here", "<limit>", "lower", None),
    ],
)
def test_a_finding_points_at_its_attribute_or_else_at_its_element(text, element, attribute, pointed):
    span = columns(text, finding(element=element, attribute=attribute))
    found = None if span is None else text[slice(*span)]
    assert found == pointed


def test_the_column_of_the_element_tells_it_from_its_twins():
    text = '<box size="1"/><box size="2"/><box size="3"/>'
    second = text.index("<box", 1)
    span = columns(text, finding(element="<box>", attribute="size", column=second))
    assert text[slice(*span)] == 'size="2"'


@pytest.mark.parametrize(
    "text",
    [
        '  <limit lower="2" upper="3"/>',
        '\t\t<a\tx="1"\tlower="2"/>',
        '<joint name="\u95a2\u7bc0\u95a2\u7bc0" lower="2"/>',  # wide characters
        '<joint name="e\u0301e\u0301" lower="2"/>',  # accents that take no column
        '<joint name="\x1b[31m\u202e" lower="2"/>',
        '<joint name="' + "long " * 60 + '" lower="2"/>',
        '<joint name="' + "\u95a2" * 300 + '" lower="2" more="' + "x" * 500 + '"/>',
        '<joint lower="2" name="' + "x" * 5000 + '"/>',
    ],
)
def test_the_marks_are_below_what_they_mean_and_the_line_fits(text):
    span = columns(text, finding(element="", attribute="lower"))
    line = marked(text, span, 72)
    assert cell_len(line.text) <= 72
    assert line.indent + line.marks <= 72
    assert line.text.isprintable()
    before, _, after = line.text.partition('lower="2"')
    assert after
    assert cell_len(before) == line.indent
    assert line.marks == len('lower="2"')


def test_what_is_longer_than_the_line_is_marked_as_far_as_it_is_seen():
    text = '<mesh filename="' + "x" * 300 + '"/>'
    line = marked(text, columns(text, finding(element="<mesh>", attribute="filename")), 72)
    assert len(line.text) <= 72
    assert line.text[line.indent :].startswith("filename=")
    assert line.indent + line.marks <= len(line.text)


@pytest.mark.parametrize("piece", ["a", "<", "<a ", '<a "', "a=", "a =", "'", " ", "=\"'", "<a x='"])
def test_a_hostile_line_takes_no_time(piece):
    text = piece * 20_000
    start = time.perf_counter()
    for _ in range(5):
        marked(text, columns(text, finding(element="<b>", attribute="lower")), 72)
    assert time.perf_counter() - start < 20  # the square of its length would take minutes
