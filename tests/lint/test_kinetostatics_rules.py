"""K102 and K104: what the hint says leads away from a singularity, and weight that Gazebo does not know of."""

import math
from pathlib import Path

import numpy as np
import pytest

from kinetostat.analysis.configuration import random_configurations
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.analysis.statics import torque
from kinetostat.conventions import GRAVITY, Load, Velocity
from kinetostat.lint.bodies import bodies_of
from kinetostat.lint.finding import Severity
from kinetostat.lint.linting import lint
from kinetostat.lint.registry import chosen
from kinetostat.lint.rule import Example
from kinetostat.lint.rules.kinetostatics.states import NEAR, SingularState
from kinetostat.lint.rules.kinetostatics.weightless import weighed, weightless
from kinetostat.lint.subject import subject_of
from lint.examples import linted


def found(name, code):
    return lint(subject_of(name), chosen([code])).findings


# --- K102 ----------------------------------------------------------------------------------------------------------


def test_the_joint_that_the_hint_names_leads_away_from_the_singularity(tmp_path):
    finding = linted(SingularState.bad, tmp_path, chosen(["K102"])).findings[-1]
    assert finding.severity is Severity.WARNING
    assert "move 'j5' by a tenth of a radian" in finding.hint
    subject = subject_of(str(tmp_path / "robot.urdf"))
    arm = mechanism(subject.model, "l6", relative_to="base")
    (state,) = subject.semantics.states
    q = np.array([state.positions[name][0] for name in arm.names])
    assert arm.smallest(q) < NEAR
    moved = [max(float(arm.smallest(q + step * one)) for step in (0.1, -0.1)) for one in np.eye(len(q))]
    assert arm.names[int(np.argmax(moved))] == "j5"
    assert max(moved) > NEAR


def test_no_joint_is_named_where_the_elbow_is_stretched_and_the_wrist_in_line(tmp_path):
    bad = SingularState.bad
    stretched = math.atan2(0.05, 0.4) - 1  # the forearm is offset by 5 cm, and its frame turned by 1 rad
    example = Example(bad.robot, srdf=bad.srdf.replace('name="j3" value="1.8"', f'name="j3" value="{stretched}"'))
    finding = linted(example, tmp_path, chosen(["K102"])).findings[-1]
    assert "it is singular" in finding.message
    assert "none alone leads far from it" in finding.hint


@pytest.mark.parametrize("robot", ["xarm_description/xarm7", "alex_description/alex_nub_hands"])
def test_a_state_that_is_zero_is_told_once_and_is_no_mistake(robot):
    (finding,) = found(f"example:{robot}", "K102")
    assert finding.severity is Severity.INFO
    assert "is zero on the chain, too" in finding.message


def test_an_arm_of_five_joints_with_a_jaw_is_none_of_six():
    assert found("example:so_arm_description/so100", "K102") == ()


# --- K104 ----------------------------------------------------------------------------------------------------------


def test_pr2_is_balanced_only_because_it_says_so(tmp_path):
    subject = subject_of("example:pr2_description/pr2")
    assert lint(subject, chosen(["K104"])).findings == ()
    path = Path(tmp_path / "pr2.urdf")
    path.write_bytes(subject.source.data.replace(b"turnGravityOff", b"gravityWasOff"))
    assert len(found(str(path), "K104")) == 2


def test_the_weight_that_is_left_out_is_that_of_the_weightless_links():
    subject = subject_of("example:pr2_description/pr2")
    light, robot = weightless(subject), subject.model.robot
    assert "r_upper_arm_link" in light
    assert "torso_lift_link" not in light
    head = bodies_of(subject).head
    assert all(link in light for link in head if head[link] in light)  # PR2 says nothing else of any link
    q = random_configurations(robot, 0, 4)
    down = [
        Load(
            Velocity(link.name, robot.root, robot.root, link.inertial.origin.xyz),
            np.concatenate([link.inertial.mass * np.array(GRAVITY), np.zeros(3)]),
        )
        for link in robot.links
        if link.name in light and link.inertial is not None
    ]
    lifted = torque(subject.model, q, down, gravity=True)
    without = torque(weighed(subject), q, gravity=True)
    assert without.certificate.agree
    assert np.allclose(lifted.total, without.total, atol=1e-9)
    assert not np.allclose(torque(subject.model, q, gravity=True).total, without.total, atol=1)
