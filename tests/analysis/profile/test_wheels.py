"""Wheels, casters and rotors are told from arms, legs and pendulums."""

from __future__ import annotations

import pytest

import kinetostat as ks
from kinetostat.analysis.profile.wheels import rolls, spins
from trailers import HIP, KNEE, SWIVEL, WHEEL, trailer
from trees import load_text


@pytest.mark.parametrize(
    ("joints", "centre", "wheel"),
    [
        ([WHEEL], 0.0, True),
        ([SWIVEL, WHEEL], 0.0, True),
        ([SWIVEL, WHEEL], 0.01, True),  # as real masses are
        ([WHEEL], 0.3, False),  # a pendulum
        ([SWIVEL, ("revolute", "-0.05 0 -0.1", "0 1 0")], 0.0, False),  # a pan and tilt head
        ([SWIVEL, WHEEL, ("fixed", "0.3 0 0", "1 0 0")], 0.0, False),  # the end of an arm: the last joint moves it
        ([HIP, KNEE, ("revolute", "0 0 -0.3", "0 1 0"), WHEEL], 0.0, False),  # a leg with a wheel
    ],
)
def test_wheels_and_casters_are_told_from_arms(joints, centre, wheel):
    model = trailer(*joints, centre=centre)
    assert rolls(model, f"l{len(joints)}") is wheel
    assert spins(model, f"l{len(joints)}") is wheel


@pytest.mark.parametrize(("limits", "rotor"), [("-1e16 1e16", True), ("-7 7", True), ("-6.28 6.28", False)])
def test_a_range_of_more_than_two_turns_is_endless(limits, rotor):
    lower, upper = limits.split()
    model = load_text(
        '<robot name="drone"><link name="base"/><link name="rotor"/><joint name="j" type="revolute">'
        f'<parent link="base"/><child link="rotor"/><limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'
        "</joint></robot>"
    )
    assert spins(model, "rotor") is rotor
    assert not rolls(model, "rotor")


@pytest.mark.parametrize("name", ["example:ur5_robot", "example:kinova", "example:xarm7", "textbook:wrist_three_roll"])
def test_wrists_that_turn_without_end_are_no_wheels(name):
    model = ks.load(name)
    assert not any(spins(model, frame) for frame in model.robot.tips)
