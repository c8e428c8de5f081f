"""Which findings a comment takes back, by its place in the document; in what order findings come."""

import os
import time

import pytest

from kinetostat.engines import pinocchio
from kinetostat.errors import EngineError
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.linting import lint
from kinetostat.lint.registry import RULES, chosen
from kinetostat.lint.subject import subject_of
from kinetostat.lint.suppression import suppressions, taken_back
from kinetostat.urdf.document import parse

LINK = '<link name="{}"/>'
BAD = (
    '<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/><axis xyz="0 0 1"/>'
    '<limit lower="1" upper="-1" effort="1" velocity="1"/></joint>'
)
IGNORE = "<!-- kinetostat: ignore[J103] as built -->"
A, B = BAD.format("j1", "a", "b"), BAD.format("j2", "b", "c")
LINKS = "".join(LINK.format(name) for name in "abc")
ASKED = ("J103", "X002")


def asked(folder, text, suffix=".urdf", srdf="", rules=ASKED):
    path = folder / f"robot{suffix}"
    path.write_text(text, encoding="utf-8")
    if srdf:
        (folder / "robot.srdf").write_text(srdf, encoding="utf-8")
    return lint(subject_of(str(path)), chosen(rules) if rules else RULES)


def kept(result, code="J103"):
    return [name for name in ("j1", "j2") for f in result.findings if f.code == code and f"'{name}'" in f.element]


CASES = {
    "nothing": (f"{LINKS}\n{A}\n{B}", ["j1", "j2"]),
    "before the element, on its own": (f"{LINKS}\n{IGNORE}\n{A}\n{B}", ["j2"]),
    "before the element, in its line": (f"{LINKS}\n{A}\n{IGNORE}{B}", ["j1"]),
    "behind the element": (f"{LINKS}\n{A} {IGNORE}\n{B}", ["j2"]),
    "behind an end tag": (f"{LINKS}\n{A.replace('><', '>' + chr(10) + '<')} {IGNORE}\n{B}", ["j2"]),
    "all in one line, before the first": (f"{LINKS}{IGNORE}{A}{B}", ["j2"]),
    "all in one line, before the second": (f"{LINKS}{A}{IGNORE}{B}", ["j1"]),
    "all in one line, at its beginning": (f"{IGNORE}{LINKS}{A}{B}", ["j1", "j2"]),
    "all in one line, at its end": (f"{LINKS}{A}{B}{IGNORE}", ["j1"]),
    "over lines": (f"{LINKS}\n{IGNORE.replace('as', 'as' + chr(10))}{A}\n{B}", ["j2"]),
    "inside": (f"{LINKS}\n{A.replace('<limit', IGNORE + '<limit')}\n{B}", ["j2"]),
}


@pytest.mark.parametrize(("inside", "left"), CASES.values(), ids=CASES)
def test_a_comment_counts_by_its_place(inside, left, tmp_path):
    result = asked(tmp_path, f'<robot name="r">{inside}</robot>')
    assert kept(result) == left
    assert len(result.suppressed) == 2 - len(left)
    unused = [f for f in result.findings if f.code == "X002"]
    assert len(unused) == (IGNORE[:30] in inside and len(left) == 2)


def test_a_comment_before_the_robot_counts_for_all_of_it(tmp_path):
    assert kept(asked(tmp_path, f'{IGNORE}<robot name="r">{LINKS}{A}\n{B}</robot>')) == []


@pytest.mark.parametrize("before", ["j1", "j2"])
def test_a_comment_in_xacro_counts_for_its_element_only(before, tmp_path):
    text = f"{LINKS}\n{A}\n{B}".replace(f'<joint name="{before}"', f'{IGNORE}\n<joint name="{before}"')
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    result = asked(tmp_path, f"{head}{text}</robot>", ".urdf.xacro")
    assert kept(result) == [name for name in ("j1", "j2") if name != before]
    assert len(result.suppressed) == 1


def test_a_comment_in_the_srdf_counts_for_what_is_found_there(tmp_path):
    good = A.replace('lower="1" upper="-1"', 'lower="-1" upper="1"')
    robot = f'<robot name="r">{LINK.format("a")}{LINK.format("b")}{good}</robot>'
    state = '<group_state name="{}" group="arm">\n<joint name="j1" value="5"/></group_state>'
    group = '<group name="arm"><joint name="j1"/></group>'

    def found(comment):
        both = f"{state.format('one')}\n{comment}\n{state.format('two')}"
        return asked(tmp_path, robot, srdf=f'<robot name="r">{group}\n{both}\n</robot>', rules=())

    plain = [f for f in found("").findings if f.file and f.element]
    code = next(f.code for f in plain if f.message.count("5"))
    mine = found(f"<!-- kinetostat: ignore[{code}] it folds away -->")
    assert len(mine.suppressed) == 1
    assert mine.suppressed[0].line > 4
    unused = found("<!-- kinetostat: ignore[N311] no reason at all -->")
    assert [(f.line, f.file.endswith("robot.srdf")) for f in unused.findings if f.code == "X002"] == [(4, True)]


def finding(**more):
    values = {"code": "J103", "name": "n", "severity": Severity.ERROR, "message": "m", "line": 1, "element": "e"}
    return Finding(**(values | {"hint": ""} | more))


def test_many_comments_and_findings_take_no_more_than_their_number():
    def seconds(count):
        everywhere = f"{IGNORE}\n" * count  # each of them counts for the whole file
        text = f'{everywhere}<robot name="r">\n' + f'{IGNORE}\n<link name="a"/>\n' * count + "</robot>"
        document = parse(text.encode(), "robot.urdf")
        findings = [finding(line=link.line, column=link.column) for link in document.root.children]
        start = time.process_time()
        comments = suppressions(document)
        taken, used = taken_back(comments, findings)
        assert len(taken) == count
        assert len(comments) == 2 * count
        assert used == set(comments)
        return time.process_time() - start

    assert seconds(16_000) < 10  # minutes, if each were asked of each


def test_findings_that_share_line_and_message_have_one_order():
    apart = [finding(column=4), finding(column=2), finding(element="f"), finding(attribute="k"), finding(several=True)]
    assert len({each.place for each in apart}) == len(apart)


def test_a_robot_that_only_pinocchio_refuses_has_an_error(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise EngineError("Pinocchio (urdf) refuses the robot: it says no")

    monkeypatch.setattr(pinocchio, "PinocchioEngine", refuse)
    comment = "<!-- kinetostat: ignore[X001] let it pass -->"
    result = asked(tmp_path, f'{comment}<robot name="r">{LINK.format("a")}</robot>', rules=("J",))
    assert [(f.code, f.severity.value, f.message) for f in result.findings] == [
        ("X001", "error", "Pinocchio (urdf) refuses the robot: it says no")
    ]


def test_a_broken_include_of_xacro_is_told_with_its_own_file(tmp_path):
    (tmp_path / "part.xacro").write_text('<robot>\n<link name="a">\n</robot>')
    include = '<xacro:include filename="part.xacro"/>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>'
    for rules in (("X",), ("J",)):
        (told,) = asked(tmp_path, text, ".urdf.xacro", rules=rules).findings
        assert (told.severity, told.line, told.file) == (Severity.ERROR, 3, str(tmp_path / "part.xacro"))


@pytest.mark.parametrize("make", [lambda path: path.symlink_to("nowhere"), os.mkfifo], ids=["dangling link", "FIFO"])
def test_an_srdf_that_is_no_file_is_found_and_told(make, tmp_path):
    make(tmp_path / "robot.srdf")
    (told,) = asked(tmp_path, f'<robot name="r">{LINK.format("a")}</robot>', rules=("N311",)).findings
    assert told.file == str(tmp_path / "robot.srdf")


def test_what_overflows_or_vanishes_is_no_crash(tmp_path):
    thin = '<collision><geometry><box size="1e-200 1e-200 1"/></geometry></collision>'
    mass = '<inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/><origin rpy="1e308 0 0"/></joint>'
    text = f'<robot name="r"><link name="a"/><link name="b">{thin}{mass}</link>{joint}</robot>'
    result = asked(tmp_path, text, rules=("I", "J"))
    assert result.findings  # the number that is too large, at least
    moved = text.replace("1e308 0 0", "0 0 0").replace('type="fixed"', 'type="floating"')
    assert "I303" in {each.code for each in asked(tmp_path, moved, rules=("I",)).findings}
