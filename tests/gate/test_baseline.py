"""Known findings do not count, and only those."""

from dataclasses import replace

import pytest

import kinetostat as ks
from kinetostat.gate.baseline import baseline_text, read_baseline, without_known
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.lint.finding import Finding, Severity


def finding(line, message, element="<joint name='a'>", code="J103"):
    return Finding(code, "name", Severity.ERROR, message, line, element, "hint")


def checked(*findings, path="robots/arm.urdf"):
    return FileCheck(path, Verdict.PASS, findings)


def known(tmp_path, *files):
    path = tmp_path / "known.json"
    path.write_text(baseline_text(files, tmp_path), encoding="utf-8")
    return read_baseline(path)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_what_is_known_does_not_count_wherever_it_has_moved(tmp_path):
    old = known(tmp_path, checked(finding(3, "used at line 2"), finding(9, "wrong")))
    new = without_known(checked(finding(5, "used at line 4"), finding(11, "wrong"), finding(12, "new")), old, tmp_path)
    assert [f.message for f in new.findings] == ["new"]
    assert new.known == 2


def test_a_second_one_of_the_same_kind_is_new(tmp_path):
    old = known(tmp_path, checked(finding(3, "wrong")))
    new = without_known(checked(finding(3, "wrong"), finding(4, "wrong")), old, tmp_path)
    assert [f.line for f in new.findings] == [4]


def test_other_files_elements_and_codes_are_new(tmp_path):
    old = known(tmp_path, checked(finding(3, "wrong")))
    others = [
        checked(finding(3, "wrong"), path="robots/leg.urdf"),
        checked(finding(3, "wrong", element="<joint name='b'>")),
        checked(finding(3, "wrong", code="J101")),
    ]
    assert [len(without_known(other, old, tmp_path).findings) for other in others] == [1, 1, 1]


def test_one_that_stands_for_several_is_known_whichever_comes_first(tmp_path):
    old = known(tmp_path, checked(replace(finding(3, "72 links have it"), several=True)))
    one_less = replace(finding(9, "71 links have it", element="<joint name='b'>"), several=True)
    assert without_known(checked(one_less), old, tmp_path).findings == ()
    assert (
        len(without_known(checked(finding(9, "one has it", element="<joint name='b'>")), old, tmp_path).findings) == 1
    )


def test_what_was_known_of_files_that_were_not_checked_stays(tmp_path):
    first = checked(finding(3, "wrong"), path="a.urdf")
    before = known(tmp_path, first, checked(finding(3, "wrong"), path="b.urdf"))
    (tmp_path / "known.json").write_text(baseline_text([checked(path="b.urdf")], tmp_path, before))
    after = read_baseline(tmp_path / "known.json")
    assert without_known(first, after, tmp_path).findings == ()
    assert len(without_known(checked(finding(3, "wrong"), path="b.urdf"), after, tmp_path).findings) == 1


def test_paths_are_relative_to_the_baseline(tmp_path, monkeypatch):
    old = known(tmp_path, checked(finding(3, "wrong")))
    (tmp_path / "robots").mkdir()
    monkeypatch.chdir(tmp_path / "robots")
    assert without_known(checked(finding(3, "wrong"), path="arm.urdf"), old, tmp_path).findings == ()


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"schema": "x"}', '{"schema":"kinetostat/baseline/1","findings":[1]}']
)
def test_what_is_no_baseline(tmp_path, text):
    (tmp_path / "known.json").write_text(text)
    with pytest.raises(ks.UsageError, match="not a baseline"):
        read_baseline(tmp_path / "known.json")


def test_that_a_robot_cannot_be_read_is_never_known(tmp_path):
    broken = replace(checked(finding(1, "not well-formed")), readable=False)
    old = known(tmp_path, broken)
    assert len(without_known(broken, old, tmp_path).findings) == 1
    assert len(without_known(broken, known(tmp_path, checked(finding(1, "not well-formed"))), tmp_path).findings) == 1
