"""What `explain` shows of a kind of expectation."""

import json

import pytest

from kinetostat.policy.manual import kind_pages
from kinetostat.report import csv, text
from kinetostat.report import json as report_json
from kinetostat.report.expectations import expectation_result, expectation_view

PAGES = pytest.mark.parametrize("page", kind_pages(), ids=lambda page: page.name)


@PAGES
def test_every_key_is_shown_with_what_it_takes_and_says(page):
    shown = text.render(expectation_view(page))
    assert max(map(len, shown.splitlines())) <= 80
    words = " ".join(shown.split())
    assert page.aim in words
    for key in page.keys:
        assert f"\n{key.name} " in shown
        assert key.description in words
        assert key.unit in words
        assert key.type in words
    for line in page.example.splitlines():
        assert f"\n  {line}\n" in shown + "\n"


@PAGES
def test_json_and_csv_have_every_key(page):
    told = json.loads(report_json.render(expectation_result(page)))
    assert [key["key"] for key in told["keys"]] == [key.name for key in page.keys]
    assert told["example"] == page.example
    rows = csv.render(expectation_view(page).csv).splitlines()
    assert rows[0] == "key,type,unit,default,description,examples"
    assert [row.split(",")[0] for row in rows[1:]] == [key.name for key in page.keys]
