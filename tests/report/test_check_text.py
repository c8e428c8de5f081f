"""The report for people."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinetostat.gate.result import CheckReport, FileCheck, Verdict
from kinetostat.lint.finding import Severity
from kinetostat.policy.outcome import Outcome
from kinetostat.report.check.text import render
from report.check_reports import AGREED, BAD, CRASH, EMPTY, GOOD, REPORT, XACRO, finding, hostile_report, reports


def shown(*files, **options):
    return render(CheckReport(files), **options)


def test_a_finding_has_its_line_code_severity_element_source_caret_and_hint():
    lines = shown(BAD).splitlines()
    at = lines.index("  3:J103 error <joint name='elbow'><limit>: lower 2 rad is above upper -2 rad")
    source, caret, hint = lines[at + 1 : at + 4]
    assert source.strip(" |") == '<limit lower="2" upper="-2" effort="10" velocity="1"/>'
    assert source[slice(caret.index("^"), len(caret))] == 'lower="2"'
    assert hint == "    hint: swap lower and upper"


def test_findings_of_the_srdf_stand_below_its_name():
    lines = shown(BAD).splitlines()
    srdf = lines.index("  robots/bad.srdf:")
    assert lines[srdf + 1].startswith("  4:N301 warning")
    assert not any("N301" in line for line in lines[:srdf])


def test_a_header_tells_path_verdict_and_counts():
    assert shown(BAD).splitlines()[:2] == [
        "robots/bad.urdf: FAILED:",
        "  1 error, 2 warnings, 1 info, readers disagree, 1 expectation not met, 1",
    ]
    assert shown(GOOD).startswith("robots/good.urdf: passed: 1 info, 1 suppressed, 2 known\n")
    assert shown(CRASH).startswith("robots/crash.urdf: CRASHED: no answer after 60 s\n")


def test_info_is_shown_on_demand_and_always_counted():
    assert "N202" not in shown(BAD)
    assert "N202 info" in shown(BAD, verbose=True)
    assert "1 error, 2 warnings, 1 info" in shown(BAD).splitlines()[-2] + shown(BAD).splitlines()[-1]
    assert "(-v shows the info)" in " ".join(shown(BAD).split())
    assert "(-v" not in shown(BAD, verbose=True)


def test_the_cross_check_is_a_line_or_names_the_odd_one_out():
    agreed = " ".join(shown(GOOD).split())
    assert "pinocchio, screw and yourdfpy agree: 12 frames x 20 configurations, largest difference 4.4e-16" in agreed
    assert "3 configurations" not in agreed
    assert "note: yourdfpy: 3 configurations" in shown(GOOD, verbose=True)
    apart = " ".join(shown(BAD).split())
    assert "screw is the odd one out: placement of tool0 differs by 0.002 m" in apart
    assert "at elbow 0.25" in apart
    assert "wrist" not in apart


def test_an_unmet_expectation_has_wanted_found_and_witness_a_met_one_is_counted():
    text = shown(BAD)
    assert "  kinetostat.toml:12 NOT MET: holds 5 kg at tool0\n    wanted: at most 80 % of effort\n" in text
    assert "    found:  93 %\n    where:  at elbow 1.5\n" in text
    assert "NOT JUDGED: holds 5 kg at hand" in text
    assert "    why:    there is no frame 'hand'\n" in text
    assert "total mass" not in text
    assert "  1 expectation met\n" in text
    assert "kinetostat.toml:4 met: total mass" in shown(BAD, verbose=True)


def test_rules_that_were_not_asked_are_told_by_reason():
    assert "  not asked: K101, K102 (the chain is too long)\n  not asked: M101 (no package)\n" in shown(BAD)
    many = FileCheck("a.urdf", Verdict.FAIL, skipped={f"K{i}": "the robot cannot be read" for i in range(100, 140)})
    assert "  not asked: 40 rules (the robot cannot be read)\n" in shown(many)
    assert "K139" in shown(many, verbose=True)


def test_lines_of_an_expanded_xacro_are_said_to_be_so():
    assert "lines are those of the expanded xacro" in shown(XACRO)
    assert "expanded" not in shown(BAD)


def test_the_last_line_is_the_totals():
    last = " ".join(render(REPORT).rpartition("\n\n")[2].split())
    assert last.startswith(
        "4 files: 1 passed, 2 failed, 1 crashed; 2 errors, 2 warnings, 2 info; 1 suppressed, 2 known;"
    )
    assert "expectations: 2 met, 2 not met (1 could not be judged)" in last
    assert render(EMPTY) == "0 files: nothing checked; 0 errors, 0 warnings, 0 info\n"


def test_colour_changes_no_letter():
    assert render(REPORT, style=lambda _, text: text) == render(REPORT)
    kinds = set()
    styled = render(REPORT, style=lambda kind, text: kinds.add(kind) or f"\x1b[1m{text}\x1b[0m")
    assert styled.replace("\x1b[1m", "").replace("\x1b[0m", "") == render(REPORT)
    assert kinds >= {"path", "pass", "fail", "crashed", "error", "warning", "code", "source", "caret", "hint"}


@pytest.mark.parametrize("report", [REPORT, hostile_report()], ids=["usual", "hostile"])
@pytest.mark.parametrize("verbose", [False, True])
def test_it_fits_80_columns_and_holds_no_control_character(report, verbose):
    for line in render(report, verbose=verbose).splitlines():
        assert line.isprintable()
        assert len(line) <= 80 or line.endswith((": FAILED:", ": CRASHED:", ".srdf:"))  # paths stay in one piece
    assert render(report).encode()


def test_many_findings_take_little_time():
    import time

    many = tuple(finding(line=i, message=f"{i}") for i in range(1, 5001))
    file = FileCheck(
        "a.urdf", Verdict.FAIL, many, AGREED, lines={("", i): '<limit lower="1"/>' for i in range(1, 5001)}
    )
    start = time.perf_counter()
    assert shown(file).count("^^^^^^^^^") == 5000
    assert time.perf_counter() - start < 5


def commands(text):
    """Return the lines in which a runner of GitHub Actions reads a command: ::new:: first, ##[old] anywhere."""
    return [line for line in text.split("\n") if line.lstrip().startswith("::") or "##[" in line]


PLANTED = "::stop-commands::t ##[add-mask]x"


@pytest.mark.parametrize("shift", range(82))
def test_a_folded_line_is_no_command_of_github_wherever_the_fold_is(shift):
    for blank in ("", " "):  # between words, and within a long one
        message = "a" * shift + blank + PLANTED
        file = FileCheck("a.urdf", Verdict.CRASHED, (finding(message=message, hint=message),), reason=message)
        text = shown(file)
        assert commands(text) == []
        assert max(map(len, text.split("\n"))) <= 80


def test_what_stands_first_in_a_line_is_no_command_of_github():
    path = "  ::error::x.urdf"
    found = finding(file=path), finding(Severity.WARNING, file="##[group]a.srdf")
    outcome = Outcome("holds", PLANTED, False, PLANTED, PLANTED, {PLANTED: 1.0}, f"{PLANTED}.toml:3", remedy=PLANTED)
    text = shown(FileCheck(path, Verdict.FAIL, found, outcomes=(outcome,)), verbose=True)
    assert commands(text) == []
    assert text.startswith("./  ::error::x.urdf: FAILED")  # a path to the same file, to be copied


def test_a_source_line_is_no_command_of_github_and_its_caret_still_points():
    line = '<limit effort="##[add-mask]x" lower="2"/>'
    source, caret = shown(FileCheck("a.urdf", Verdict.FAIL, (finding(),), lines={("", 3): line})).split("\n")[2:4]
    assert commands(source) == []
    assert r"##\x5badd-mask]x" in source
    assert source[caret.index("^") : len(caret)] == 'lower="2"'


def test_text_that_is_no_command_stays_as_it_is():
    assert "a::b [c] #[d] ## [e]" in shown(
        FileCheck("a.urdf", Verdict.FAIL, (finding(message="a::b [c] #[d] ## [e]"),))
    )


pieces = st.lists(st.sampled_from(["::", "##[", ":", "#", "[", " ", "a", "\u0301", "\ufe0f"]), max_size=60).map("".join)


@settings(max_examples=300, deadline=None)
@given(pieces, pieces, pieces)
def test_no_text_of_a_robot_becomes_a_command_of_github(path, message, line):
    found = finding(message=message, element=line, hint=message), finding(file=path or "a", message=message)
    file = FileCheck(path or "a", Verdict.FAIL, found, skipped={"K101": message}, lines={("", 3): line})
    text = shown(file, FileCheck(path or "a", Verdict.CRASHED, reason=message), verbose=True)
    assert not re.search(r"##\[", text)
    assert not re.search(r"(?m)^[^!-~\n]*::", text)


@settings(max_examples=100, deadline=None)
@given(reports())
def test_every_finding_that_is_to_be_shown_is_shown(report):
    text = render(report)
    wanted = sum(f.severity is not Severity.INFO for file in report.files for f in file.findings)
    assert sum(f":{'J103'} " in line or line.startswith("  J103 ") for line in text.splitlines()) >= wanted
    assert text.encode()
