"""What the report says of a robot: the numbers are those of the analyses, and no gap is silent."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.gate.check import check
from kinetostat.gate.checking import Task, check_robot
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.report.fleet.describing import robot_document
from report.check_reports import AGREED, APART, BAD, HOSTILE, MET, UNJUDGED, UNMET
from report.fleet.fleet_reports import (
    PASSED,
    PAYLOAD,
    SAMPLES,
    arm,
    checked,
    described,
    described_text,
    failed,
    profile_of,
    profiled,
)
from trees import load_text

ROBOTS = (
    "textbook:planar_1r",
    "textbook:planar_2r_6_3",
    "textbook:skew_1p",
    "textbook:scara",
    "textbook:rigid_body",
    "example:ur5_robot",
    "example:panda",
    "example:so101",
)


def redone(profile, check=PASSED, **changes):
    return robot_document("r1", check, replace(profile, **changes), status="done", reason="", payload=PAYLOAD)


def whys(rows):
    return {row.what: row.why for row in rows}


# --- joints --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS)
def test_every_joint_that_moves_has_one_row(name):
    info = {joint.name: joint for joint in profiled(name).model.robot.joints if joint.type.nq}
    rows = described(name).joints
    assert [row.name for row in rows] == list(info)
    assert all(
        (row.parent, row.child, row.type) == (j.parent, j.child, j.type.value)
        for row, j in zip(rows, info.values(), strict=True)
    )


@pytest.mark.parametrize("name", ROBOTS)
def test_random_configurations_are_inside_the_limits_of_the_rows(name):
    model = profiled(name).model
    q = ks.random_configurations(model, 3, 200)
    for row in described(name).joints:
        if row.unit != "mixed" and not row.follows:
            where = q[:, model.robot.position_slices[row.name]]
            assert row.lower is None or np.all(where >= row.lower)
            assert row.upper is None or np.all(where <= row.upper)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_torque_depends_on_the_joints_that_are_told_and_on_no_other(name):
    model = profiled(name).model
    names = list(model.robot.position_names)
    for row in described(name).joints:
        for use, payload in ((row.gravity, None), (row.loaded, PAYLOAD)):
            if use is None or not use.torque:
                continue
            q = ks.random_configurations(model, 5, 8)
            for joint, position in use.configuration.items():
                q[:, names.index(joint)] = position
            frame = next((c.frame for c in described(name).chains if c.name == row.limb), None)
            load = None if payload is None else ks.Payload(payload, frame)
            torques = ks.torque(model, q, gravity=True, payload=load).total
            column = model.robot.velocity_slices[row.name].start
            np.testing.assert_allclose(torques[:, column], use.torque, rtol=1e-9, atol=1e-9)


def test_a_torque_is_told_without_the_joints_of_other_limbs():
    other = (
        '<link name="k"/><joint name="other" type="revolute"><parent link="l0"/><child link="k"/><axis xyz="0 1 0"/>'
    )
    other += '<limit lower="-1" upper="1" effort="9" velocity="1"/></joint>'
    rows = described_text(arm("revolute 0 1 0", "revolute 0 1 0").replace("</robot>", f"{other}</robot>")).joints
    told = {row.name: set(row.gravity.configuration) for row in rows}
    assert told == {"j1": {"j1", "j2"}, "j2": {"j1", "j2"}, "other": set()}


def test_a_follower_tells_its_law_and_is_in_the_limb_that_it_moves():
    follower = '<mimic joint="j1" multiplier="-2" offset="-0.25"/></joint>'
    text = arm("revolute 0 1 0", "revolute 0 1 0")
    at = text.index("</joint>", text.index('name="j2"'))
    told = {row.name: row for row in described_text(text[:at] + follower + text[at + len("</joint>") :]).joints}
    assert (told["j2"].follows, told["j1"].follows) == ("j1 * -2 - 0.25", "")
    assert told["j1"].limb == told["j2"].limb != ""
    assert (told["j2"].gravity, told["j2"].effort) == (None, 30.0)
    assert set(told["j1"].gravity.configuration) == {"j1"}


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        ('<limit lower="-1" upper="1.5" effort="0" velocity="1"/>', "the file says 0"),
        ('<limit lower="-1" upper="1.5" effort="1e308" velocity="1"/>', "the file says 1e+308"),
    ],
)
def test_an_effort_limit_that_means_none_is_none_and_says_so(limit, said):
    found = described_text(arm("revolute 0 1 0", limit=limit))
    (joint,) = found.joints
    assert joint.effort is joint.gravity.use is joint.loaded.use is found.chains[0].worst_gravity_use is None
    assert abs(joint.gravity.torque) == pytest.approx(9.81, abs=1e-3)  # 2 kg at 0.5 m, level
    assert said in whys(found.left)["effort limit of 'j1'"]


def test_ranges_that_mean_no_limit_are_none():
    limit = '<limit lower="-1e16" upper="1e16" effort="30" velocity="1"/>'
    found = described_text(arm("revolute 0 0 1", "prismatic 1 0 0", "continuous 0 1 0", limit=limit))
    assert [(row.lower, row.upper) for row in found.joints] == [(None, None)] * 3
    assert [(row.unit, row.effort_unit) for row in found.joints] == [("rad", "Nm"), ("m", "N"), ("rad", "Nm")]


def test_a_joint_that_carries_no_weight_has_no_torque_and_no_place():
    first, second = described_text(arm("revolute 0 0 1", "revolute 0 0 1")).joints
    assert (first.gravity.torque, first.gravity.use, first.gravity.configuration) == (0.0, 0.0, {})
    assert second.loaded.torque == 0.0


@pytest.mark.parametrize("name", ["example:ur5_robot", "example:panda"])
def test_what_rounding_makes_on_an_upright_axis_is_no_torque(name):
    upright = described(name).joints[0]
    assert (upright.gravity.torque, upright.gravity.use, upright.gravity.configuration) == (0.0, 0.0, {})


def test_joints_with_several_coordinates_have_no_ends():
    told = {row.name: row for row in described_text(arm("planar 0 0 1", "revolute 0 1 0")).joints}
    row = told["j1"]
    assert (row.unit, row.effort_unit) == ("mixed", "mixed")
    assert row.lower is row.upper is row.effort is row.gravity is None
    assert {"j1.x", "j1.y", "j1.theta", "j2"} == set(told["j2"].gravity.configuration)


# --- chains --------------------------------------------------------------------------------------------------------


def test_the_textbook_arm_reaches_to_its_outer_radius():
    (chain,) = described("textbook:planar_2r_6_3").chains
    assert chain.reach == pytest.approx(9, abs=1e-6)  # A5
    assert (chain.base, chain.frame, chain.joints) == ("base", "tool", ("joint1", "joint2"))
    assert {"joint2 = 0"} <= {family.condition for family in chain.families if family.inside_limits}
    assert chain.samples == SAMPLES


def test_a_level_rod_holds_what_its_limit_leaves():
    """30 Nm less 2 kg at 0.5 m, at a lever of 1 m, where the middle of limits is level."""
    limit = '<limit lower="-1" upper="1" effort="30" velocity="1"/>'
    (chain,) = described_text(arm("revolute 0 1 0", limit=limit)).chains
    assert chain.payload_at_mid.mass == pytest.approx((30 - 9.81) / 9.81)
    assert chain.payload_at_mid.binding_joint == "j1"
    assert chain.worst_gravity_use == pytest.approx(9.81 / 30)
    assert chain.worst_loaded_use == pytest.approx((1 + PAYLOAD) * 9.81 / 30)
    assert (chain.asked_payload, chain.worst_loaded_joint) == (PAYLOAD, "j1")


@pytest.mark.parametrize("name", ROBOTS)
def test_a_chain_uses_most_where_a_joint_of_it_does(name):
    found = described(name)
    for chain in found.chains:
        rows = [row for row in found.joints if row.name in chain.joints and row.gravity is not None]
        uses = {row.name: row.gravity.use for row in rows if row.gravity.use is not None}
        assert chain.worst_gravity_use == max(uses.values(), default=None)
        assert uses.get(chain.worst_gravity_joint, 0.0) == (chain.worst_gravity_use or 0.0)


@pytest.mark.parametrize("name", ROBOTS)
def test_quantiles_rise_from_the_smallest_to_the_largest(name):
    for chain in described(name).chains:
        measures = [row.measure for row in chain.distributions]
        assert measures[:3] == ["yoshikawa", "minimum_singular_value", "inverse_condition_number"]
        assert measures[3:] in ([], ["effort_use"])  # of the limb, not of each joint
        for row in chain.distributions:
            shares = [float(share) for share in row.quantiles]
            values = [row.minimum, *row.quantiles.values(), row.maximum]
            assert shares == sorted(shares)
            assert {0.1, 0.5, 0.9} <= set(shares)
            slack = 1e-3 * (1e-12 + abs(row.maximum))
            assert all(a <= b + slack for a, b in pairwise(values)), row
            assert row.count == SAMPLES


@pytest.mark.parametrize("name", ["textbook:planar_2r_6_3", "example:ur5_robot", "example:panda"])
def test_a_pose_has_the_indices_of_manipulability_there(name):
    model = profiled(name).model
    for chain in described(name).chains:
        for pose in chain.poses:
            at = ks.configuration(model, pose.configuration).q
            asked = None if len(chain.rows) == 6 else chain.rows
            length = "none" if chain.length is None else chain.length
            blocks = ks.manipulability(model, chain.frame, at, relative_to=chain.base, axes=asked, length=length).blocks
            block = blocks.get("task", blocks["full"])
            assert set(pose.configuration) == set(chain.joints)
            assert (pose.rank, pose.dimension) == (block.rank, len(chain.rows))
            values = block.singular_values[: chain.rank]
            assert pose.smallest_singular_value == pytest.approx(values[-1], abs=1e-9)
            assert pose.yoshikawa == pytest.approx(np.prod(values), abs=1e-9)


def test_a_payload_that_no_joint_feels_is_null_and_says_why():
    (chain,) = described_text(arm("revolute 0 0 1")).chains
    assert (chain.payload_at_mid.mass, chain.payload_at_mid.binding_joint) == (None, "")
    assert chain.payload_at_mid.unbounded
    assert "no joint of the chain feels it" in whys(chain.left)["payload"]


@pytest.mark.parametrize(
    ("joint", "limits", "only"),
    [("1 0 0", (-1, 1.5), True), ("0 0 1", (-1, 1.5), False), ("0 1 0", (0.3, 0.3), False)],
)
def test_a_tool_that_no_joint_moves_along_carries_no_payload_and_a_locked_one_is_none(joint, limits, only):
    limit = '<limit lower="{}" upper="{}" effort="30" velocity="1"/>'.format(*limits)
    (chain,) = described_text(arm(f"revolute {joint}", limit=limit)).chains
    assert chain.turns_only is only
    assert ("they only turn it" in whys(chain.left).get("payload", "")) is only
    assert (chain.payload_at_mid is None) is only


def test_a_payload_that_is_impossible_is_null_and_says_why():
    limit = '<limit lower="-1" upper="1.5" effort="3" velocity="1"/>'
    (chain,) = described_text(arm("revolute 0 1 0", limit=limit)).chains
    assert (chain.payload_at_mid.mass, chain.payload_at_mid.binding_joint) == (None, "j1")
    assert not chain.payload_at_mid.unbounded
    assert "limit of 'j1' is exceeded without it" in whys(chain.left)["payload"]
    assert chain.worst_gravity_use > 1


def test_without_masses_there_is_no_weight_and_it_says_why():
    found = described_text(arm("revolute 0 1 0", mass=0))
    (chain,) = found.chains
    assert found.mass is found.joints[0].gravity is chain.payload_at_mid is chain.worst_gravity_use is None
    assert {"mass", "worst gravity torques"} <= set(whys(found.left))
    assert "payload" in whys(chain.left)
    assert chain.reach == pytest.approx(1.0)


def test_a_chain_of_the_profile_that_has_nothing_still_has_a_row():
    full = profiled("textbook:planar_2r")
    (limb,) = full.limbs
    empty = replace(limb, sweep=None, reach=None, payload=None, poses=(), families=None, sections=(), loaded=None)
    (chain,) = redone(full, limbs=(empty,), worst=None).chains
    assert (chain.id, chain.name, chain.joints) == ("r1-1", limb.limb.name, limb.limb.joints)
    assert chain.rank is chain.reach is chain.length is chain.near_singular_share is chain.unseen is None
    assert (chain.rows, chain.samples, chain.distributions, chain.starts) == ((), 0, (), 0)


# --- the certificate -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS)
def test_all_numbers_are_counted_and_the_engines_agree(name):
    row, certificates = described(name).certificate, profiled(name).certificates
    assert row.agree is True
    assert row.numbers == sum(one.numbers for one in certificates.values()) > 0
    assert row.answers == len(certificates)
    nearest = certificates[row.answer]
    assert (row.max_difference, row.tolerance) == (nearest.max_difference, nearest.tolerance)
    assert all(
        one.max_difference / one.tolerance <= row.max_difference / row.tolerance for one in certificates.values()
    )


BOTH = ("pinocchio", "screw")
FINE = Certificate(BOTH, 1e-15, 1e-12, numbers=40)


@pytest.mark.parametrize(
    ("bad", "apart"),
    [
        (Certificate(BOTH, 2e-9, 1e-12, numbers=7), 2e-9),
        (Certificate(BOTH, math.inf, 1e-12, numbers=7), None),
        (Certificate(BOTH, math.nan, 1e-12, numbers=7), None),
    ],
    ids=["too far", "other shapes", "no number"],
)
def test_one_answer_on_which_the_engines_differ_is_named(bad, apart):
    row = redone(
        profiled("textbook:planar_2r"), certificates={"masses": FINE, "reach": bad, "payload": FINE}
    ).certificate
    assert (row.agree, row.answer, row.max_difference) == (False, "reach", apart)
    assert (row.numbers, row.answers) == (87, 3)


def test_without_cross_check_nothing_is_said_to_agree():
    model = replace(load_text(arm("revolute 0 1 0")), crosscheck=False)
    row = robot_document("r1", PASSED, profile_of(model), status="done", reason="", payload=None).certificate
    assert (row.agree, row.numbers, row.max_difference) == (None, 0, None)


# --- what check says -----------------------------------------------------------------------------------------------


def test_findings_expectations_and_readers_are_those_of_check():
    told = replace(BAD, agreement=APART, outcomes=(MET, UNMET, UNJUDGED))
    found = redone(profiled("textbook:planar_2r"), told)
    assert [row.code for row in found.findings] == [one.code for one in told.findings]
    assert [row.line for row in found.findings] == [one.line for one in told.findings]
    assert [row.met for row in found.expectations] == [True, False, None]
    assert not found.agreement.agree
    assert not found.agreement.engines_agree
    assert "screw is the odd one out" in found.agreement.disagreements[0]
    assert "elbow 0.25" in found.agreement.disagreements[0]


def test_what_check_leaves_out_is_told():
    told = replace(
        PASSED, agreement=None, skipped={"M101": "no mesh"}, suppressed=2, known=1, expanded=True, findings=BAD.findings
    )
    left = redone(profiled("textbook:planar_2r"), told).left
    assert {"rules M101", "2 findings", "1 finding", "lines of the xacro file", "agreement of the readers"} <= set(
        whys(left)
    )
    assert "agreement of the readers" not in whys(
        redone(profiled("textbook:planar_2r"), replace(told, agreement=AGREED)).left
    )


def test_a_file_that_cannot_be_read_tells_its_findings_with_their_lines(tmp_path):
    path = tmp_path / "broken.urdf"
    path.write_text('<robot name="broken">\n<link name="a"/>\n<joint name="j" type="revolute">\n</robot>')
    (told,) = check([path]).files
    assert not told.readable
    found = failed(check=told, reason="it is not XML")
    assert (found.status, found.reason, found.verdict) == ("unreadable", "it is not XML", "fail")
    assert any(row.severity == "error" and row.line > 0 for row in found.findings)
    assert (found.name, found.mass, found.chains, found.joints, found.certificate) == ("", None, (), (), None)


def test_a_robot_whose_process_died_tells_why():
    found = failed(status="crashed", reason="signal 11", check=FileCheck("a.urdf", Verdict.CRASHED, reason="signal 11"))
    assert (found.path, found.status, found.reason, found.verdict) == ("a.urdf", "crashed", "signal 11", "crashed")


def test_texts_that_no_file_can_hold_are_written_out():
    told = replace(BAD, path=HOSTILE, findings=tuple(replace(f, message=HOSTILE) for f in BAD.findings))
    found = redone(profiled("textbook:planar_2r"), told)
    for text in (found.path, found.findings[0].message):
        assert text.encode("utf-8").decode() == text
        assert "\\ud800" in text
        assert "<script>" in text  # as it is: whoever shows it escapes it


def test_checked_robots_pass():
    assert described("example:ur5_robot").verdict == checked("example:ur5_robot").verdict.value
    assert described("example:ur5_robot").agreement.agree


def test_where_a_library_keeps_a_file_is_not_told():
    kinova = check_robot(Task("example:kinova"))
    assert any(Path(found.file).is_absolute() for found in kinova.findings)
    told = robot_document("r1", kinova, None, status="done", reason="", payload=None)
    assert {row.file for row in told.findings} == {"", "kinova.srdf"}
