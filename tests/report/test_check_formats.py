"""All formats by their names."""

import pytest

from kinetostat.errors import UsageError
from kinetostat.report.check import FORMATS, rendered
from report.check_reports import EMPTY, REPORT, hostile_report


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("report", [REPORT, EMPTY, hostile_report()], ids=["usual", "empty", "hostile"])
def test_each_is_text_that_ends_its_last_line_and_says_the_same_twice(form, report):
    text = rendered(report, form)
    assert text.endswith("\n")
    assert text.encode()
    assert rendered(report, form) == text
    assert all(line.isprintable() for line in text.split("\n"))


def test_another_is_refused():
    with pytest.raises(UsageError, match="'xml'"):
        rendered(REPORT, "xml")
