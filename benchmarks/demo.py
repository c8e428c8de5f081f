"""`make demo`: the questions that a newcomer asks of a real robot, with the commands that answer them."""

import subprocess
import sys
from pathlib import Path

KINETOSTAT = str(Path(sys.executable).with_name("kinetostat"))
QUESTIONS = (
    ("Where is the hand?", "fk example:panda -f panda_hand -q default"),
    ("How does it move when the joints do?", "jacobian example:panda -f panda_hand -q default"),
    ("The same as a body Jacobian:", "jacobian example:panda -f panda_hand -q default --reference local"),
    ("How well can it move?", "manipulability example:panda -f panda_hand -q default --length auto"),
    ("Where is this arm singular?", "singular find example:ur5_robot -f tool0 --deg"),
    ("And here: why, and what is lost?", "singular at example:ur5_robot -f tool0 -q 0.3,-0.5,0,0.2,1,0"),
    (
        "What must its joints hold, with 2 kg in the hand?",
        "torque example:panda -f panda_hand -q default --gravity --payload 2",
    ),
    ("Which configurations reach this pose?", "ik example:ur5_robot -f tool0 --pose 0.4,0.2,0.5,0,0,0 --all --deg"),
    ("How fast must the joints turn?", "rates example:panda -f panda_hand -q default --twist 0.1,0,0,0,0,0"),
    ("How do the links move then?", "velocity example:ur5_robot --qdot 0.1,0.2,0,0,0,0.1"),
    ("What do joint errors of 1 mrad do?", "error example:ur5_robot -f tool0 -q 0,-1,1,0,1,0 --joint-error 0.001"),
    (
        "It pushes with 5 N along its own z. What is that at the base?",
        "adjoint example:panda -f panda_hand -q default --wrench --apply 0,0,5,0,0,0",
    ),
)

for question, arguments in QUESTIONS:
    print(f"# {question}\n$ kinetostat {arguments}\n", flush=True)
    subprocess.run([KINETOSTAT, *arguments.split()], check=True)
    print(flush=True)
