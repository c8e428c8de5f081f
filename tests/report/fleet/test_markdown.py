"""report.md, as a Markdown parser reads it."""

import re

import pytest

from kinetostat.errors import printable
from kinetostat.report.fleet.markdown import markdown
from report.fleet import fleet_documents as made
from report.markdown_page import Page

OURS = {
    "h3",
    "p",
    "table",
    "thead",
    "tbody",
    "tr",
    "th",
    "td",
    "details",
    "summary",
    "ul",
    "li",
    "code",
    "strong",
    "em",
}
COLUMNS = 14  # one of them is of the payload that is asked for


def shown(document, **options):
    return Page(markdown(document, **options).encode().decode())


def test_it_opens_with_the_totals():
    text = "".join(shown(made.fleet()).runs)
    assert text.startswith("kinetostat report: 5 robots")
    assert "5 robots, 4 chains; 1 could not be read; 1 fails check; 17,248 numbers computed twice" in text
    assert "index.html" in text


def test_each_chain_and_each_robot_without_has_a_row_of_all_columns():
    assert shown(made.fleet()).rows == [COLUMNS] * (1 + 6)


def test_a_robot_that_failed_says_why():
    runs = shown(made.fleet()).runs
    assert "could not be read" in runs
    assert any("two links are named 'arm'" in run for run in runs)


def test_all_robots_are_folded_those_that_failed_first():
    page = shown(made.fleet())
    assert page.folded == [True] * 5
    text = "".join(page.runs)
    folds = text[text.index("drone") + len("drone") :]
    order = [folds.index(name) for name in ("robots/broken.urdf", "two-armed", "panda")]
    assert order == sorted(order)


def test_what_limits_a_robot_and_what_is_left_out_of_it_are_told():
    text = "".join(shown(made.document(made.loaded_robot())).runs)
    assert "worst gravity use 127 % (joint2)" in text
    assert "worst use with 5 kg 180 % (shoulder)" in text
    assert "not met: reach of the arm" in text
    assert "not judged: reach of the arm" in text
    assert "The engines DISAGREE." in text
    assert "not computed, or held: hand (it is a gripper)" in text


def test_a_robot_that_fails_check_says_so_in_its_row_and_where_it_is_folded():
    text = "".join(shown(made.fleet()).runs)
    assert "0 / 30 / 0, 2 unmet" in text
    assert "findings: 30 warnings; fails check: 2 of 3 expectations not met" in text


def test_the_payload_that_is_asked_for_is_named():
    assert "seed 0, payload 3 kg." in "".join(shown(made.document(payload=3.0)).runs)


def test_infos_are_counted_only():
    document = made.document(made.robot(findings=(made.finding("info", message="worth knowing"),)))
    text = "".join(shown(document).runs)
    assert "1 info" in text
    assert "worth knowing" not in text


@pytest.mark.parametrize("text", made.HOSTILE, ids=range(len(made.HOSTILE)))
def test_hostile_texts_are_text(text):
    document = made.hostile(made.fleet(), text)
    page = shown(document)
    assert set(page.tags) <= OURS
    assert set(page.attributes) == set()
    assert len(set(page.rows)) == 1
    for run in page.runs:
        assert not re.search(r"@\w|#\d", run), "a mention, or a reference to an issue"
    assert printable(text)[:100] in "".join(page.runs)


@pytest.mark.parametrize("longest", [4_000, 20_000, 60_000])
def test_it_is_cut_at_a_size_and_says_what_is_left_out(longest):
    robots = [made.loaded_robot(f"r{i}") for i in range(100)]
    text = markdown(made.document(*robots), longest=longest)
    assert len(text) <= longest
    rows, robots = (int(n) for n in re.findall(r"and (\d+) (?:row|robot)s?, for which there is no room", text))
    page = Page(text)
    assert len(page.rows) - 1 + rows == 200
    assert len(page.folded) + robots == 100


def test_a_report_of_nothing_and_one_without_numbers_are_markdown():
    assert shown(made.document()).tags == ["h3", "p", "code"]
    assert shown(made.without_numbers(made.fleet())).rows == [COLUMNS - 1] * 7


def test_the_same_document_gives_the_same_text():
    assert markdown(made.fleet()) == markdown(made.fleet())
