"""Compiled code takes half a second to load: a question that does not need it does not wait for it."""

import subprocess
import sys

import pytest

QUESTIONS = {
    "jacobian": ["jacobian", "example:panda", "-f", "panda_hand"],
    "manipulability": ["manipulability", "example:panda", "-f", "panda_hand"],
    "torque": ["torque", "example:panda", "--gravity", "-q", "mid"],
    "the worst torques": ["torque", "example:panda", "--worst", "--samples", "500"],
    "ik": ["ik", "textbook:puma560", "--pose", "0.4,0.2,0.3"],
    "singular at": ["singular", "at", "example:ur5_robot", "-f", "wrist_3_link"],
    "singular find": ["singular", "find", "example:ur5_robot", "-f", "wrist_3_link"],
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_question_about_few_configurations_loads_no_compiled_code(question):
    program = (
        "import sys; from kinetostat_cli.main import run;"
        f"code = run({QUESTIONS[question]!r});"
        "print(code, [m for m in ('numba', 'distributed', 'pyarrow') if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert run.stdout.splitlines()[-1] == "0 []", run.stderr
