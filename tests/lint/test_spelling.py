"""What was meant by a misspelt word, and what was not."""

import time

import pytest

from kinetostat.lint.schema import ROBOT
from kinetostat.lint.spelling import Speller, meant

LINK, JOINT = ROBOT.children["link"], ROBOT.children["joint"]
LIMIT, ORIGIN = JOINT.children["limit"], JOINT.children["origin"]


@pytest.mark.parametrize(
    ("word", "part", "wanted"),
    [
        ("colision", LINK.known_children, "collision"),
        ("Visual", LINK.known_children, "visual"),
        ("intertial", LINK.known_children, "inertial"),
        ("visuals", LINK.known_children, "visual"),
        ("limits", JOINT.known_children, "limit"),
        ("safetyController", JOINT.known_children, "safety_controller"),
        ("pose", JOINT.known_children, "origin"),
        ("ryp", ORIGIN.known_attributes, "rpy"),
        ("min", LIMIT.known_attributes, "lower"),
        ("joints", ROBOT.known_children, "joint"),
        ("transmision", ROBOT.known_children, "transmission"),
    ],
)
def test_slips_are_understood(word, part, wanted):
    assert meant(word, part) == wanted


@pytest.mark.parametrize("word", ["x", "D", "mu_coulomb", "command_effort", "dont_care", "手", "", "_"])
def test_other_words_are_left_alone(word):
    parts = (ROBOT, LINK, JOINT, LIMIT, ORIGIN, *JOINT.children.values(), *LINK.children.values())
    assert not any(meant(word, part.known_children | part.known_attributes) for part in parts)


def test_no_word_of_the_schema_is_taken_for_another_in_its_place():
    stack, seen = [ROBOT], set()
    while stack:
        part = stack.pop()
        if id(part) in seen:
            continue
        seen.add(id(part))
        stack.extend(part.children.values())
        for known in (part.known_children, part.known_attributes):
            for word in known:
                assert meant(word, known) == word


def test_long_words_and_many_words_cost_little():
    speller, known = Speller(), LINK.known_children
    start = time.perf_counter()
    assert meant("collision" * 100_000, known) == ""
    found = [speller.meant(f"colision{i}", known) for i in range(100_000)]
    assert time.perf_counter() - start < 5
    assert found[0] == "collision"
    assert found[-1] == "", "the limit"
