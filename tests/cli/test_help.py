"""Help, versions and completion."""

import os
import re
import shlex
import subprocess
import sys
from importlib.metadata import version

import pytest

from kinetostat_cli.main import COMMANDS


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example_that_works(cli, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "motion.csv").write_text("time,joint1,joint2\n0,0.1,1\n1,0.2,-1\n")
    answer = cli(command, "--help")
    assert answer.code == 0
    example = re.search(r"Example: kinetostat (.*)", answer.out)
    assert example, answer.out
    assert cli(*shlex.split(example[1])).code == 0


def test_help_lists_every_command(cli):
    answer = cli("--help")
    assert answer.code == 0
    assert re.findall(r"^  (\w+) +[A-Z]", answer.out, re.MULTILINE) == list(COMMANDS)


def test_nothing_asked_is_help_and_exit_2(cli):
    assert cli().code == 2


def test_version_names_pinocchio_and_numpy(cli):
    answer = cli("--version")
    assert answer.code == 0
    assert answer.out == f"kinetostat {version('kinetostat')} (Pinocchio {version('pin')}, NumPy {version('numpy')})\n"


def test_the_wheel_and_the_package_have_one_version():
    import kinetostat

    assert kinetostat.__version__ == version("kinetostat")


COMPLETIONS = {
    "commands": ("kinetostat ja", {"jacobian"}),
    "frames": ("kinetostat fk example:panda -f panda_h", {"panda_hand", "panda_hand_tcp"}),
    "observers": ("kinetostat jacobian example:panda --relative-to panda_link1", {"panda_link1"}),
    "joints after a comma": (
        "kinetostat jacobian example:panda --joints panda_joint1,panda_f",
        {"panda_joint1,panda_finger_joint1"},
    ),
    "states": ("kinetostat fk example:panda -q def", {"default"}),
    "joint values": ("kinetostat fk example:panda -q panda_joint7", {"panda_joint7="}),
    "example robots": ("kinetostat fk example:pan", {"example:panda", "example:panda_collision"}),
    "Euler sequences": ("kinetostat jacobian x --rates fixed-zy", {"fixed-zyx", "fixed-zyz"}),
    "robots, bash breaking words at colons": ("kinetostat fk example : pan", {"panda", "panda_collision"}),
    "robots of a scheme, likewise": (
        "kinetostat fk textbook : planar_2",
        {"planar_2r", "planar_2r_6_3", "planar_2r_isotropic"},
    ),
    "frames of a robot with a colon": ("kinetostat fk example : panda -f panda_h", {"panda_hand", "panda_hand_tcp"}),
    "nothing of a robot that is not there": ("kinetostat fk nowhere.urdf -f x", set()),
}


@pytest.mark.parametrize("case", COMPLETIONS)
def test_completion_knows_the_robot_at_hand(case):
    line, expected = COMPLETIONS[case]
    words = line.split()
    environment = {
        **os.environ,
        "_KINETOSTAT_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
    }
    program = "import sys; sys.argv = ['kinetostat']; from kinetostat_cli.main import main; main()"
    run = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert set(run.stdout.split()) == expected
