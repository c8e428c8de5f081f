"""One robot checked: what fails it, and the lines that are shown."""

from dataclasses import replace

import pytest

import kinetostat as ks
from kinetostat.analysis import agreement as module
from kinetostat.analysis.agreement import Agreement, Disagreement
from kinetostat.gate.checking import Task, check_robot, judged
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity
from kinetostat.policy.outcome import Outcome

ROBOT = Task("textbook:planar_2r")


def test_readers_that_cannot_be_compared_have_not_agreed(monkeypatch):
    def refuse(*_, **__):
        raise ks.EngineError("no more memory")

    monkeypatch.setattr(module, "agreement", refuse)
    found = check_robot(ROBOT)
    assert found.skipped["crosscheck"] == "no more memory"
    assert [f.message for f in found.findings if f.code == "K201"] == [
        "the readers could not be compared: no more memory"
    ]
    assert judged(found, Severity.ERROR).verdict is Verdict.FAIL


def test_a_cross_check_that_is_not_wanted_fails_nothing():
    found = judged(check_robot(replace(ROBOT, samples=0)), Severity.ERROR)
    assert found.agreement is None
    assert found.verdict is Verdict.PASS
    assert found.skipped["K201"]


def test_engines_that_disagree_fail_a_robot_whatever_rules_are_asked():
    one = Disagreement("placement", "screw", ("pinocchio", "screw"), "a", {}, 0.1, 1e-12, "m")
    apart = Agreement(("pinocchio", "screw"), 1, 1, 0.1, 1e-12, (one,))
    assert judged(FileCheck("r", Verdict.PASS, agreement=apart), Severity.ERROR).verdict is Verdict.FAIL
    third = replace(apart, disagreements=(replace(one, odd_one="yourdfpy"),))
    assert judged(FileCheck("r", Verdict.PASS, agreement=third), Severity.ERROR).verdict is Verdict.PASS


@pytest.mark.parametrize(("met", "verdict"), [(True, Verdict.PASS), (False, Verdict.FAIL), (None, Verdict.FAIL)])
def test_an_expectation_that_could_not_be_judged_is_not_met(met, verdict):
    file = FileCheck("r", Verdict.PASS, outcomes=(Outcome("mass", "total mass", met, "", ""),))
    assert judged(file, Severity.ERROR).verdict is verdict


@pytest.mark.parametrize("found", Severity)
@pytest.mark.parametrize("fail_on", Severity)
def test_what_is_as_bad_as_asked_for_fails(found, fail_on):
    file = FileCheck("r", Verdict.PASS, (Finding("J103", "name", found, "message", 1, "", "hint"),))
    failed = judged(file, fail_on).verdict is Verdict.FAIL
    assert failed == (found.rank <= fail_on.rank)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1"])
def test_the_lines_that_findings_point_at_are_shown_as_they_are_read(tmp_path, encoding):
    text = (
        f'<?xml version="1.0" encoding="{encoding}"?>\n<robot name="é">\n<link name="a b"/>\n'
        + '<link name="ü x"/>\n</robot>\n'
    )
    (tmp_path / "r.urdf").write_bytes(text.encode(encoding))
    found = check_robot(Task(str(tmp_path / "r.urdf")))
    assert found.lines["", 4] == '<link name="ü x"/>'
