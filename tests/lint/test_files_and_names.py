"""M and N: how bad each finding is, in which file it is, and what is found in real robots."""

from dataclasses import replace
from pathlib import Path

import pytest

from kinetostat.lint.finding import Severity
from kinetostat.lint.linting import lint
from kinetostat.lint.meshes import MANY
from kinetostat.lint.registry import chosen
from kinetostat.lint.rule import Example
from kinetostat.lint.subject import subject_of
from kinetostat.urdf.files import example_robots
from lint.examples import linted

RULES = chosen(["M", "N"])
ARM = """
<link name="base_link"/><link name="arm"/>
<joint name="shoulder" type="continuous"><parent link="base_link"/><child link="arm"/></joint>"""


def mesh(name, kind="visual"):
    return f'<link name="base_link"><{kind}><geometry><mesh filename="{name}"/></geometry></{kind}></link>'


def severities(result):
    return {(finding.code, finding.severity.value) for finding in result.findings}


@pytest.mark.parametrize(
    ("robot", "expected"),
    [
        (mesh("a.stl"), ("M101", "warning")),
        (mesh("../../a.txt"), ("M103", "error")),
        (mesh("../../a.stl"), ("M103", "warning")),
        (mesh("../meshes/a.stl"), ("M103", "info")),
        (mesh("package://../a.stl"), ("M103", "error")),
        (mesh("/home/me/a.stl"), ("M104", "warning")),
        (mesh("C:\\a.txt"), ("M104", "warning")),
        (mesh("/etc/passwd"), ("M104", "error")),
        (mesh("/dev/a.stl"), ("M104", "error")),
        (mesh("file:///opt/a.stl"), ("M105", "warning")),
        (mesh("file:///usr/Romeo/a.mesh"), ("M105", "warning")),
        (mesh("file:///etc/passwd"), ("M105", "error")),
        (mesh("file:///dev/a.stl"), ("M105", "error")),
        (mesh("model://a.stl"), ("M105", "warning")),
        (mesh("a.stl").replace("/></geo", ' scale="-1 1 1"/></geo'), ("M202", "info")),
        (mesh("a.stl", "collision").replace("/></geo", ' scale="-1 1 1"/></geo'), ("M202", "info")),
        ('<link name="a"><visual><geometry><box size="1 1 0"/></geometry></visual></link>', ("M204", "warning")),
        ('<link name="a"><visual><geometry><box size="1 1 -1"/></geometry></visual></link>', ("M204", "error")),
    ],
)
def test_how_bad_it_is_depends_on_what_it_is(robot, expected, tmp_path):
    result = linted(Example(robot), tmp_path, RULES)
    assert expected in severities(result)
    assert len([f for f in result.findings if f.severity is not Severity.INFO]) <= 2


def test_a_broken_picture_is_not_as_bad_as_a_broken_mesh(tmp_path):
    robot = mesh("a.stl") + '<material name="m"><texture filename="a.png"/></material>'
    found = linted(Example(robot, files={"a.stl": "", "a.png": ""}), tmp_path, RULES)
    assert {(f.severity.value, f.message.split(":")[0]) for f in found.findings if f.code == "M109"} == {
        ("error", "'a.stl'"),
        ("warning", "'a.png'"),
    }


@pytest.mark.parametrize(
    ("name", "told"), [("file:///ws/a.stl", False), ("/ws/a.stl", False), ("/etc/passwd", True), ("file:///x", True)]
)
def test_xacro_makes_absolute_paths_that_no_one_wrote(name, told, tmp_path):
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{mesh(name)}</robot>', encoding="utf-8")
    subject = replace(subject_of(str(tmp_path / "robot.urdf")), expanded=True)
    assert any(f.code in ("M104", "M105") for f in lint(subject, RULES).findings) == told


def test_that_not_all_names_were_looked_for_is_said(tmp_path):
    robot = "".join(mesh(f"{i}.stl").replace("base_link", f"l{i}") for i in range(MANY + 2))
    found = [f.message for f in linted(Example(robot), tmp_path, RULES).findings if f.code == "M101"]
    assert len(found) == 2
    assert any(f"only the first {MANY} of {MANY + 2} names" in message for message in found)


def test_standard_input_has_no_folder_and_that_is_no_pass(tmp_path):
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{mesh("a.stl")}</robot>', encoding="utf-8")
    subject = subject_of(str(tmp_path / "robot.urdf"))
    subject = replace(subject, packages=replace(subject.packages, file=None))
    assert lint(subject, RULES).skipped == {"M101": "standard input has no folder to look in"}


def test_findings_about_the_srdf_say_in_which_file_they_are(tmp_path):
    result = linted(Example(ARM, srdf='<passive_joint name="elbow"/>'), tmp_path, RULES)
    assert [(f.code, f.file, f.line) for f in result.findings] == [("N316", str(tmp_path / "robot.srdf"), 2)]


def test_the_srdf_of_another_robot_is_one_finding(tmp_path):
    srdf = "".join(f'<group name="g{i}"><joint name="x{i}"/><link name="y{i}"/></group>' for i in range(9))
    srdf += '<group_state name="s" group="g0"><joint name="x0" value="0"/></group_state>'
    result = linted(Example(ARM, srdf=srdf), tmp_path, RULES)
    assert [f.code for f in result.findings] == ["N312"]
    assert "18 of the 18 links and joints" in result.findings[0].message


@pytest.mark.parametrize(
    ("robot", "srdf", "code", "severity", "hint"),
    [
        (mesh("package:///meshes/a.stl"), "", "M106", "warning", "package://NAME/...: two slashes"),
        (mesh("package://lost/a.stl"), "", "M106", "warning", "--package-dir"),
        ('<link name="world"/>', "", "N201", "info", "the first link after it 'base_link'"),
        ('<link name="pelvis"/>', "", "N201", "info", "where the root is"),
        (
            ARM,
            '<group name="g"><link name="arm"/></group><end_effector name="e" parent_link="shoulder" group="g"/>',
            "N315",
            "warning",
            "moves is 'arm'",
        ),
        (ARM, '<passive_joint name="arm"/>', "N316", "warning", "leads to it is 'shoulder'"),
        (ARM, '<passive_joint name="shuolder"/>', "N316", "warning", "did you mean 'shoulder'"),
        (
            ARM.replace("continuous", "fixed"),
            '<group name="g"><joint name="shoulder"/></group>'
            '<group_state name="s" group="g"><joint name="shoulder" value="0"/></group_state>',
            "N323",
            "info",
            "remove the line",
        ),
    ],
)
def test_what_to_do_depends_on_what_it_is(robot, srdf, code, severity, hint, tmp_path):
    found = [f for f in linted(Example(robot, srdf=srdf), tmp_path, RULES).findings if f.code == code]
    assert [f.severity.value for f in found] == [severity]
    assert hint in found[0].hint


def test_findings_in_a_group_or_a_state_say_in_which(tmp_path):
    srdf = '<group name="g"><chain base_link="x" tip_link="arm"/></group>\n'
    srdf += '<group_state name="s" group="g"><joint name="y" value="0"/></group_state>'
    found = linted(Example(ARM, srdf=srdf), tmp_path, RULES).findings
    assert "<group name='g'><chain>" in {f.element for f in found}
    assert "<group_state name='s'><joint name='y'>" in {f.element for f in found}


def test_hostile_names_come_out_as_text(tmp_path):
    name = "\u202e&#10;[red]&quot;" + "n" * 1000
    robot = f'<link name="{name}"><visual><geometry><mesh filename="{name}"/></geometry></visual></link>'
    for finding in linted(Example(robot, srdf=f'<passive_joint name="{name}"/>'), tmp_path, RULES).findings:
        assert finding.message.isprintable()
        assert finding.element.isprintable()
        assert len(finding.message) < 250


# --- real robots ---------------------------------------------------------------------------------------------------


def example(name):
    """Return the findings; the engines that `lint` would load have no say in these rules."""
    subject = subject_of(f"example:{name}")
    return [] if subject.robot is None else [finding for rule in RULES for finding in rule.check(subject)]


@pytest.mark.parametrize(
    ("robot", "code", "line", "words"),
    [
        ("tiago_dual", "N302", 346, "'wheel_{side}_joint' is not in the robot"),
        ("kinova", "N324", 19, "-1.5707 rad is below the lower limit 0.331613"),
        ("talos_left_arm", "N312", 2, "links and joints that the SRDF names are not in the robot"),
        ("solo12", "N314", 33, "4 names of groups are not defined"),
        ("alex_sake_hands", "N315", 86, "link 'LeftGripperYaw' is not in the robot: it is a joint"),
        ("solo", "N314", 6, "8 names of joints and links are not in the robot"),
        ("talos_left_arm", "N301", 353, "'arm_left_1_joint' is not in the robot; also used at line 163"),
        ("so101", "N202", 256, "before the jaws"),
        ("z1", "N321", 16, "names no group"),
        ("pr2", "N301", 174, "the joint is fixed, line 147; likewise 11 more joints"),
        ("talos_full_v2", "M106", 31, "names no package"),
        ("centauro", "M202", 99, "mirrors it; likewise 18 more meshes"),
        ("romeo_laas_small", "M105", 172, "one machine"),
        ("romeo_laas_small", "N102", 38, "likewise 31 more names"),
    ],
)
def test_what_is_wrong_with_real_robots_is_found(robot, code, line, words):
    found = [f for f in example(robot) if f.code == code and f.line == line]
    assert len(found) == 1
    assert words in found[0].message


def test_no_real_robot_has_an_error_and_all_meshes_are_there():
    for name in example_robots():
        found = example(name)
        assert not [f for f in found if f.severity is Severity.ERROR], name
        assert not {"M101", "M102", "M109", "M110", "M112"} & {f.code for f in found}, name
        assert all(f.file == "" or Path(f.file).is_file() for f in found)
