"""The largest distance of a frame from a point: where a closed form knows it, and what there is none of."""

import math

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.configuration import random_configurations
from kinetostat.analysis.farthest import farthest
from trees import load_text, random_urdf


def two_links(first, second, limits, offset=(0.0, 0.0, 0.0), kinds=("revolute", "revolute"), extra=("", "")):
    """Return a planar arm of two joints about z, whose second joint has limits, its first joint at an offset."""
    low, high = limits
    return load_text(
        f"""<robot name="arm"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
        <joint name="one" type="{kinds[0]}"><parent link="base"/><child link="a"/>
          <origin xyz="{" ".join(map(str, offset))}" rpy="0.3 -0.2 0.1"/><axis xyz="0 0 1"/>{extra[0]}
          <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
        <joint name="two" type="{kinds[1]}"><parent link="a"/><child link="b"/><origin xyz="{first} 0 0"/>
          <axis xyz="0 0 1"/>{extra[1]}<limit lower="{low}" upper="{high}" effort="1" velocity="1"/></joint>
        <joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="{second} 0 0"/></joint>
        </robot>"""
    )


def found(model, frame, observer, point=(0.0, 0.0, 0.0), samples=200):
    return farthest(model, frame, observer, random_configurations(model, 0, samples), point=point)


@pytest.mark.parametrize("seed", range(8))
def test_two_links_whose_elbow_cannot_stretch_obey_the_law_of_cosines(seed):
    draw = np.random.default_rng(seed)
    first, second, offset = draw.uniform(0.1, 9), draw.uniform(0.1, 9), draw.uniform(-5, 5, 3)
    low = draw.uniform(0.2, 2.5)
    arm = two_links(first, second, (low, draw.uniform(low + 0.1, 3.1)), offset)
    result = found(arm, "tip", "base", tuple(offset))
    assert result.distance == pytest.approx(math.sqrt(first**2 + second**2 + 2 * first * second * math.cos(low)))
    assert result.certificate.agree is True


def test_an_arm_that_can_stretch_does_and_one_link_turns_in_a_circle():
    arm = two_links(6, 3, (-1, 1))
    assert found(arm, "tip", "base").distance == pytest.approx(9, abs=1e-9)
    assert found(arm, "tip", "a").distance == pytest.approx(9, abs=1e-9)
    assert found(arm, "tip", "a", (6, 0, 0)).distance == pytest.approx(3, abs=1e-12)


@pytest.mark.parametrize("seed", range(30))
def test_no_sample_is_farther_and_both_frames_are_as_far_from_each_other(seed):
    model = load_text(random_urdf(seed, kinds=("revolute", "continuous", "prismatic", "fixed")))
    frame, root = model.robot.tips[-1], model.robot.root
    drawn = random_configurations(model, seed, 100)
    try:
        result = farthest(model, frame, root, drawn)
    except ks.UsageError as error:
        assert "no joint moves" in error.message or "without a limit" in error.message  # noqa: PT017
        return
    sampled = np.linalg.norm(ks.fk(model, frame, drawn).position, axis=-1)
    assert result.distance >= np.max(sampled) - 1e-12
    assert np.linalg.norm(ks.fk(model, frame, result.q).position) == pytest.approx(result.distance, rel=1e-12)
    again = farthest(model, root, frame, drawn)
    assert again.distance == pytest.approx(result.distance, rel=1e-6)


LEADER = '<mimic joint="one" multiplier="{}"/>'


def test_what_gets_away_any_distance_has_no_largest_one():
    endless = '<limit effort="1" velocity="1"/>'
    slide = load_text(
        '<robot name="s"><link name="base"/><link name="tip"/><joint name="slide" type="prismatic">'
        '<parent link="base"/><child link="tip"/><axis xyz="1 0 0"/>'
        '<limit lower="-1e308" upper="1e308" effort="1" velocity="1"/></joint></robot>'
    )
    with pytest.raises(ks.UsageError, match="'slide' slides without a limit"):
        found(slide, "tip", "base")
    driven = load_text(
        '<robot name="d"><link name="base"/><link name="a"/><link name="tip"/>'
        f'<joint name="turn" type="continuous"><parent link="base"/><child link="a"/>{endless}</joint>'
        f'<joint name="rack" type="prismatic"><parent link="base"/><child link="tip"/><axis xyz="1 0 0"/>'
        f'<limit lower="-1e308" upper="1e308" effort="1" velocity="1"/><mimic joint="turn"/></joint></robot>'
    )
    with pytest.raises(ks.UsageError, match="'turn' advances without a limit"):
        found(driven, "tip", "base")
    with pytest.raises(ks.UsageError, match="several coordinates"):
        found(ks.load("textbook:planar_2r", floating_base=True), "tool", "universe")
    with pytest.raises(ks.UsageError, match="no joint moves"):
        found(ks.load("textbook:planar_2r"), "base", "base")


def test_turns_without_limits_and_followers_with_them_have_one():
    wheel = two_links(2, 1, (-1, 1), kinds=("continuous", "continuous"))
    assert found(wheel, "tip", "base").distance == pytest.approx(3, abs=1e-9)
    bent = two_links(2, 1, (0.5, 1), kinds=("revolute", "revolute"), extra=("", LEADER.format(0.5)))
    stretched = math.sqrt(
        4 + 1 + 4 * math.cos(0.5)
    )  # the follower is inside its limits where the leader is from 1 to 2
    assert found(bent, "tip", "base").distance == pytest.approx(stretched)
