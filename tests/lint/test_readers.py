"""K201 and K202, which no file can fire: broken engines do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinetostat.analysis import panel
from kinetostat.analysis.agreement import Disagreement, agreement
from kinetostat.engines.screw import ScrewEngine
from kinetostat.engines.third import ThirdReader
from kinetostat.lint.finding import Severity
from kinetostat.lint.registry import RULES
from kinetostat.lint.rules.kinetostatics import EnginesDisagree, ThirdReaderDisagrees
from kinetostat.lint.subject import subject_of

READERS = (EnginesDisagree(), ThirdReaderDisagrees())


def test_they_are_the_only_rules_that_only_the_gate_can_ask():
    assert {rule.code for rule in RULES if rule.by_gate} == {"K201", "K202"}
    subject = subject_of("example:panda")
    assert [finding for rule in READERS for finding in rule.check(subject)] == []


def test_an_engine_that_is_wrong_is_an_error_at_the_link_that_it_misplaces():
    subject = subject_of("example:panda")
    robot = subject.robot
    joints = tuple(
        replace(joint, axis=tuple(-x for x in joint.axis)) if joint.name == "panda_joint5" else joint
        for joint in robot.joints
    )
    subject.model.__dict__["witness"] = ScrewEngine(replace(robot, joints=joints))
    found = agreement(subject.model)
    engines, third = READERS
    assert all(engines.takes(one) and not third.takes(one) for one in found.disagreements)
    finding = engines.of(found.disagreements[0], subject)
    assert (finding.code, finding.severity) == ("K201", Severity.ERROR)
    assert finding.line == subject.link_elements[found.disagreements[0].frame].line
    assert finding.message.startswith("pinocchio and screw differ on the placement of 'panda_")
    assert "screw is the odd one out, at panda_" in finding.message
    assert "\n" not in finding.message


def test_a_third_reader_that_is_outvoted_is_a_warning(monkeypatch):
    class Broken(ThirdReader):
        def placements(self, q):
            return super().placements(q) + np.eye(4)[0][:, None] * np.eye(4)[3]

    monkeypatch.setattr(panel, "ThirdReader", Broken)
    subject = subject_of("example:panda")
    (one,) = agreement(subject.model).disagreements
    engines, third = READERS
    assert third.takes(one)
    assert not engines.takes(one)
    finding = third.of(one, subject)
    assert (finding.code, finding.severity) == ("K202", Severity.WARNING)
    assert "by 1 m" in finding.message
    assert "yourdfpy is the odd one out" in finding.message


@pytest.mark.parametrize("odd", ["", "pinocchio"])
def test_what_is_about_no_link_is_at_the_robot_and_names_are_printable(odd):
    subject = subject_of("example:panda")
    one = Disagreement("gravity torque", odd, ("pinocchio", "screw"), "", {"a\x1b[2Jb": 1.0, "c": 0.0}, 2.5, 1e-9, "Nm")
    finding = READERS[0].of(one, subject)
    assert finding.line == subject.root.line
    assert finding.message.isprintable()
    assert "by 2.5 Nm" in finding.message
    assert ("not known" in finding.message) is (odd == "")
    assert "c=" not in finding.message
