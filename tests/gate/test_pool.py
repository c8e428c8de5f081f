"""A robot that crashes, hangs or takes all memory is told as crashed; the others are checked all the same."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gate.stand_ins import behave, leave_politely, no_square, squared
from kinetostat.gate.checking import Task
from kinetostat.gate.pool import check_all, run_all
from kinetostat.gate.result import CheckReport, Verdict
from processes import descendants, runs, wait_for

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
    assert sorted(told, key=lambda file: file.path) == sorted(found, key=lambda file: file.path)  # as they come
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


def test_leaving_by_exit_is_a_crash_and_ends_nobody_else():
    found = check_all([Task("a"), Task("b")], jobs=1, timeout=5, check=leave_politely)
    assert [file.verdict for file in found] == [Verdict.CRASHED, Verdict.CRASHED]
    assert "SystemExit" in found[0].reason


def test_any_task_is_done_and_what_goes_wrong_is_told_in_its_place():
    told, seen = [], set()
    found = run_all(
        [3, -1, 4, -2, -3, -4, 5], squared, no_square, jobs=2, timeout=1, done=told.append, at_work=seen.update
    )
    assert [one for one in found if isinstance(one, int)] == [9, 16, 25]
    died, hung, raised, stuck = (found[i] for i in (1, 3, 4, 5))
    assert died == "-1: its process died (SIGSEGV)"
    assert hung == "-2: no answer within 1 s (--timeout)"
    assert raised == "-3: a bug in kinetostat: ValueError: no square"
    assert stuck.startswith("-4: a bug in kinetostat: ")
    assert sorted(told, key=str) == sorted(found, key=str)
    assert -2 in seen  # it was long at work


def test_results_are_in_the_order_of_the_tasks_and_told_as_they_come():
    told = []
    found = run_all([-2, 1, 2], squared, no_square, jobs=2, timeout=1, done=told.append)
    assert found == (no_square(-2, "no answer within 1 s (--timeout)"), 1, 4)
    assert told == [1, 4, found[0]]


def test_nothing_to_do():
    assert run_all([], squared, no_square, jobs=2, timeout=1) == ()


@pytest.mark.parametrize("module", ["kinetostat.gate.preloaded", "kinetostat.report.fleet.preloaded"])
def test_what_the_processes_load_loads(module):
    # A module that is missing there would be passed over in silence.
    program = f"import {module}, os; os._exit(0)"  # at once: its alarm would end an interpreter that is leaving
    subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted by /proc")
def test_what_is_loaded_before_processes_are_forked_starts_no_thread():
    # Of a process with threads, a fork has one, and the locks that the others held.
    program = "import kinetostat.report.fleet.preloaded, os; os._exit(len(os.listdir('/proc/self/task')))"
    run = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True)
    assert run.returncode == 1


SCRIPT = "import kinetostat as ks; print([f.verdict.value for f in ks.check(['textbook:planar_2r'], jobs=1).files])"


def test_a_script_needs_no_guard_and_no_file(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    for words, given in (([str(tmp_path / "script.py")], ""), (["-"], SCRIPT)):
        run = subprocess.run([sys.executable, *words], input=given, capture_output=True, text=True, check=True)
        assert run.stdout == "['pass']\n"
        assert run.stderr == ""


def test_nothing_is_run_that_lies_in_the_folder_of_the_robots(tmp_path):
    for name in ("multiprocessing", "numpy", "signal", "kinetostat", "yourdfpy", "pinocchio"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'run')!r}, 'w')\n")
    (tmp_path / "arm.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    command = [str(Path(sys.executable).with_name("kinetostat")), "check", "arm.urdf"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "1 file: 1 passed" in run.stdout, run.stderr
    assert not (tmp_path / "run").exists()


@pytest.mark.skipif(sys.platform != "linux", reason="processes outlive their parent elsewhere")
def test_a_hanging_robot_ends_with_whoever_asked():
    program = (
        "from gate.stand_ins import behave; from kinetostat.gate.checking import Task;"
        "from kinetostat.gate.pool import check_all; check_all([Task('hang')], jobs=1, timeout=600, check=behave)"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    asking = subprocess.Popen([sys.executable, "-c", program], env=environment)
    time.sleep(4)
    children = descendants(asking.pid)
    assert children
    asking.kill()
    asking.wait()
    assert wait_for(lambda: not any(map(runs, children)), 5)
