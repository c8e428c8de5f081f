"""A robot that crashes, hangs or takes all memory is told as crashed; the others are checked all the same."""

import pytest

from gate.stand_ins import behave
from kinetostat.gate.checking import Task
from kinetostat.gate.pool import check_all
from kinetostat.gate.result import CheckReport, Verdict

REASONS = {
    "raise": "a bug in kinetostat: RuntimeError: a broken analysis\\x1b[31m",
    "die": "SIGSEGV",
    "leave": "exit code 7",
    "hang": "no answer within 2 s",
    "eat": "out of memory",
}


@pytest.fixture(scope="module")
def results():
    names = ["a", "raise", "b", "die", "c", "leave", "d", "hang", "e", "eat", "f"]
    told = []
    found = check_all([Task(name) for name in names], jobs=2, timeout=2, done=told.append, check=behave)
    assert tuple(told) == found
    assert [file.path for file in found] == names
    return {file.path: file for file in found}


@pytest.mark.parametrize("name", REASONS)
def test_what_goes_wrong_in_a_process_is_a_crash_of_that_robot(results, name):
    assert results[name].verdict is Verdict.CRASHED
    assert REASONS[name] in results[name].reason


@pytest.mark.parametrize("name", ["a", "b", "c", "d", "e", "f"])
def test_the_other_robots_are_checked(results, name):
    assert results[name].verdict is Verdict.PASS


def test_a_crash_is_no_pass(results):
    assert not CheckReport((results["a"], results["die"])).passed
    assert CheckReport((results["a"], results["b"])).passed


def test_a_single_robot_is_isolated_too():
    (found,) = check_all([Task("die")], jobs=4, timeout=5, check=behave)
    assert found.verdict is Verdict.CRASHED
