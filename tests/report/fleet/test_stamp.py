"""When a report is made: the clock, or SOURCE_DATE_EPOCH."""

import time
from datetime import datetime

import pytest

from kinetostat.errors import UsageError
from kinetostat.report.fleet.stamp import stamp


@pytest.mark.parametrize(
    ("seconds", "made"),
    [("0", "1970-01-01T00:00:00Z"), ("951827696", "2000-02-29T12:34:56Z"), ("1700000000", "2023-11-14T22:13:20Z")],
)
def test_the_environment_sets_it(monkeypatch, seconds, made):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", seconds)
    assert stamp() == made


@pytest.mark.parametrize("zone", ["UTC", "Asia/Tokyo", "America/New_York"])
def test_it_is_now_wherever_one_is(monkeypatch, zone):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    monkeypatch.setenv("TZ", zone)
    time.tzset()
    try:
        before, made, after = int(time.time()), stamp(), int(time.time())
    finally:
        monkeypatch.undo()
        time.tzset()
    assert made.endswith("Z")
    assert before <= datetime.fromisoformat(made).timestamp() <= after


@pytest.mark.parametrize("wrong", ["now", "1.5", "-1", "1e9", "9" * 30, "\u0661", " 1"])
def test_what_is_no_time_is_refused(monkeypatch, wrong):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", wrong)
    with pytest.raises(UsageError, match="SOURCE_DATE_EPOCH") as refused:
        stamp()
    assert refused.value.remedy
