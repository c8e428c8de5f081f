"""Bad input: one clear line on standard error, nothing on standard output, the right exit code."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import kinetostat
from kinetostat.engines.pinocchio import PinocchioEngine

PANDA = ("example:panda", "-f", "panda_hand")
USAGE = {
    "unknown command": (("jacobain", "example:panda"), "Did you mean"),
    "unknown option": (("fk", "example:panda", "--relativ-to", "x"), "No such option"),
    "no robot": (("fk",), "Missing argument"),
    "unknown format": (("fk", *PANDA, "-F", "yaml"), "yaml"),
    "unknown frame": (("fk", "example:panda", "-f", "panda_hnd"), "did you mean 'panda_hand'"),
    "frame in other case": (("fk", "example:panda", "-f", "PANDA_HAND"), "did you mean 'panda_hand'"),
    "a joint is no frame": (("fk", "example:panda", "-f", "panda_joint7"), "child link 'panda_link7'"),
    "two tips": (("fk", "example:panda"), "'panda_leftfinger'"),
    "unknown observer": (("jacobian", *PANDA, "--relative-to", "base_lnk"), "no frame 'base_lnk'"),
    "unknown axes": (("jacobian", *PANDA, "--expressed-in", "nowhere"), "no frame 'nowhere'"),
    "unknown joint": (("jacobian", *PANDA, "--joints", "panda_joint11"), "did you mean"),
    "joint named twice": (("jacobian", *PANDA, "--joints", "panda_joint1,panda_joint1"), "twice"),
    "follower chosen": (("jacobian", *PANDA, "--joints", "panda_finger_joint2"), "'panda_finger_joint1', its leader"),
    "fixed joint chosen": (("jacobian", *PANDA, "--joints", "panda_joint8"), "fixed"),
    "value for a follower": (("fk", *PANDA, "-q", "panda_finger_joint2=0.01"), "'panda_finger_joint1', its leader"),
    "value for an unknown joint": (("fk", *PANDA, "-q", "panda_joint0=1"), "did you mean"),
    "value not finite": (("fk", *PANDA, "-q", "panda_joint1=inf"), "not a finite number"),
    "value not a number": (("fk", *PANDA, "-q", "panda_joint1=x"), "'x' is not a number"),
    "value given twice": (("fk", *PANDA, "-q", "panda_joint1=1,panda_joint1=2"), "twice"),
    "list too short": (("fk", *PANDA, "-q", "1,2,3"), "3 positions are given, 8 are needed"),
    "unknown state": (("fk", *PANDA, "-q", "defalt"), "did you mean 'default'"),
    "random without a seed": (("fk", *PANDA, "-q", "random"), "random:0"),
    "missing file of values": (("fk", *PANDA, "-q", "@nowhere.json"), "no such file"),
    "point of two numbers": (("jacobian", *PANDA, "--point", "1,2"), "--point takes 3"),
    "point with world": (("jacobian", *PANDA, "--point", "1,2,3", "--reference", "world"), "observer's origin"),
    "six-vector of five": (("adjoint", *PANDA, "--apply", "1,2,3,4,5"), "--apply takes 6"),
    "no such sequence": (("jacobian", *PANDA, "--rates", "zyw"), "no Euler sequence 'zyw'"),
    "sequence that repeats": (("jacobian", *PANDA, "--rates", "zzx"), "neighbours must differ"),
    "rates in other axes": (("jacobian", *PANDA, "--rates", "rpy", "--reference", "local"), "leave out --reference"),
    "rates that do not exist": (
        ("jacobian", "example:panda", "-f", "panda_link1", "--rates", "zyz"),
        "a singularity of the angles",
    ),
    "rates of joints too few": (("jacobian", *PANDA, "--qdot", "1,2"), "2 rates are given, 8 are needed"),
    "unknown example": (("fk", "example:pandaa"), "did you mean 'panda'"),
    "ambiguous example": (("fk", "example:anymal"), "example:anymal_c_simple_description/anymal"),
    "unknown textbook robot": (("fk", "textbook:planar_9r"), "did you mean"),
    "output into nowhere": (("fk", *PANDA, "-o", "/nonexistent/x.json"), "cannot write"),
    "malformed xacro argument": (("fk", *PANDA, "--xacro-arg", "side=left"), "NAME:=VALUE"),
}


def only_line(answer):
    """The one error line; warnings about the configuration may come before it."""
    lines = answer.err.splitlines()
    assert all(line.startswith("kinetostat: warning: ") for line in lines[:-1]), answer.err
    assert lines[-1].startswith("kinetostat: error: ")
    assert answer.out == ""
    assert "Traceback" not in answer.err
    return lines[-1]


@pytest.mark.parametrize("case", USAGE)
def test_wrong_usage_is_one_line_and_exit_2(cli, case):
    arguments, expected = USAGE[case]
    answer = cli(*arguments)
    assert answer.code == 2, answer.err
    assert expected in only_line(answer)


def test_a_robot_that_cannot_be_read_is_one_line_and_exit_3(cli, arm):
    arm.write_text(arm.read_text().replace('xyz="0 0 1"', 'xyz="0 0 nan"'))
    answer = cli("fk", arm)
    assert answer.code == 3
    line = only_line(answer)
    assert f"{arm}:5: <joint name='shoulder'><axis>: xyz: 'nan' is not a finite number" in line


def test_a_missing_file_names_its_neighbour(cli, arm):
    answer = cli("fk", arm.with_name("my_arm.urdf"))
    assert answer.code == 3
    assert "did you mean 'my arm.urdf'" in only_line(answer)


def test_outside_limits_warns_and_answers(cli, arm):
    answer = cli("fk", arm, "-q", "shoulder=1.9,slide=0.7", "-F", "json")
    assert answer.code == 0
    assert len(answer.json["warnings"]) == 2
    assert "joint 'shoulder' is at 1.9 rad, outside [-2, 1]" in answer.err
    assert "joint 'slide' is at 0.7 m, outside [0, 0.5]" in answer.err


def test_warnings_speak_degrees_to_who_asks_in_degrees(cli, arm):
    err = cli("fk", arm, "-q", "shoulder=100,slide=0.7", "--deg").err
    assert "joint 'shoulder' is at 100 deg, outside [-114.592, 57.2958]" in err
    assert "joint 'slide' is at 0.7 m, outside [0, 0.5]" in err


def test_a_dash_is_standard_output(cli, arm, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli("fk", arm, "-o", "-").out == cli("fk", arm).out
    assert [path.name for path in tmp_path.iterdir()] == ["my arm.urdf"]


def test_an_empty_name_is_no_robot(cli):
    assert "no robot is named" in only_line(cli("fk", ""))


def test_a_follower_outside_its_own_limits_is_told(cli, arm):
    text = arm.read_text().replace('lower="-1" upper="1"', 'lower="-0.2" upper="1"')
    arm.write_text(text)
    assert (
        "joint 'elbow' is at -0.4 rad, by following 'shoulder', outside [-0.2, 1]"
        in cli("fk", arm, "-q", "shoulder=1").err
    )


def test_engines_that_disagree_are_shown_both_and_exit_4(cli, monkeypatch):
    right = PinocchioEngine.jacobian
    monkeypatch.setattr(PinocchioEngine, "jacobian", lambda self, q, velocity: -right(self, q, velocity))
    answer = cli("jacobian", *PANDA, "-q", "mid")
    assert answer.code == 4
    assert "the engines disagree" in answer.err
    assert "by pinocchio" in answer.out
    assert "by screw" in answer.out
    broken = cli("jacobian", *PANDA, "-q", "mid", "-F", "json")
    assert broken.code == 4
    assert '"agree": false' in broken.out
    assert set(kinetostat.__all__) >= {"DisagreementError"}


def test_a_bug_of_ours_is_exit_70_and_says_how_to_report_it(cli, monkeypatch):
    monkeypatch.setattr(PinocchioEngine, "placement", lambda *_: 1 / 0)
    answer = cli("fk", *PANDA)
    assert answer.code == 70
    assert "bug in kinetostat: ZeroDivisionError" in answer.err
    assert "report" in answer.err
    assert "Traceback" not in answer.err


def test_debug_shows_the_traceback(cli):
    assert "Traceback" in cli("fk", "example:panda", "-f", "nowhere", "--debug").err


def test_verbose_tells_what_is_odd_and_where_the_file_is(cli, arm):
    arm.write_text(arm.read_text().replace('<axis xyz="1 0 0"/>', ""))
    err = cli("fk", arm, "-v").err
    assert str(arm) in err
    assert "no axis: URDF's default 1 0 0 holds" in err
    assert "default 1 0 0" not in cli("fk", arm).err


def test_standard_input_is_a_robot(cli, arm):
    assert cli("fk", "-", stdin=arm.read_bytes()).out == cli("fk", arm).out


def test_too_large_a_robot_is_refused(cli, arm):
    for answer in (cli("fk", arm, "--max-bytes", 100), cli("fk", "-", "--max-bytes", 100, stdin=arm.read_bytes())):
        assert answer.code == 3
        assert "more than 100 bytes" in only_line(answer)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("redirected", [True, False])
def test_a_full_disk_is_no_bug_of_ours(redirected):
    with Path("/dev/full").open("w") as full:
        more = [] if redirected else ["-o", "/dev/full"]
        run = subprocess.run(command("robots", *more), stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == 2
    assert "No space left on device" in run.stderr
    assert len(run.stderr.splitlines()) == 1


def test_a_state_that_names_a_lost_joint_warns(cli, arm, tmp_path):
    srdf = tmp_path / "arm.srdf"
    srdf.write_text(
        '<robot name="arm"><group_state name="s" group="g"><joint name="elbo" value="1"/></group_state></robot>'
    )
    answer = cli("fk", arm, "--srdf", srdf, "-q", "s")
    assert answer.code == 0
    assert "state 's' sets joint 'elbo', which the robot does not have" in answer.err


def test_a_robot_is_no_srdf(cli, arm):
    answer = cli("fk", arm, "--srdf", arm)
    assert answer.code == 3
    assert "this is a robot, not an SRDF" in only_line(answer)


def test_a_robot_asked_for_without_its_scheme_is_recognised(cli):
    assert "did you mean example:panda?" in only_line(cli("fk", "panda"))
    assert "did you mean 'ur5_" in only_line(cli("fk", "example:ur5"))


def test_output_goes_to_a_file_whole(cli, arm, tmp_path):
    out = tmp_path / "result.json"
    out.write_text("old")
    answer = cli("fk", arm, "-F", "json", "-o", out)
    assert (answer.code, answer.out) == (0, "")
    assert out.read_text() == cli("fk", arm, "-F", "json").out
    assert sorted(p.name for p in tmp_path.iterdir()) == ["my arm.urdf", "result.json"]


def test_a_failed_run_leaves_the_old_output(cli, arm, tmp_path):
    out = tmp_path / "result.json"
    out.write_text("old")
    assert cli("fk", arm, "-f", "nowhere", "-o", out).code == 2
    assert out.read_text() == "old"


def command(*arguments):
    return [sys.executable, "-m", "kinetostat_cli", *map(str, arguments)]


def test_a_closed_pipe_is_no_error(arm):
    process = subprocess.Popen(command("info", "example:tiago_dual"), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    err = process.stderr.read()
    process.stderr.close()
    assert process.wait(60) == 0
    assert b"Traceback" not in err
    assert b"BrokenPipe" not in err


def test_an_interrupt_ends_quietly(cli, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(PinocchioEngine, "placement", interrupted)
    answer = cli("fk", *PANDA, "-q", "mid")
    assert (answer.code, answer.out) == (130, "")
    assert "Traceback" not in answer.err


def test_a_terminal_that_knows_no_unicode_is_no_bug(arm):
    arm.write_text(arm.read_text().replace('"tip"', '"Spitze\u2082"'))
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    run = subprocess.run(command("frames", arm), capture_output=True, env=environment, check=False)
    assert run.returncode == 0
    assert rb"Spitze\u2082" in run.stdout
