"""The picture of a limb's measures: lines are the sweep's numbers, poses stand where their values are."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from figure_texts import covered_texts, cut_texts, texts
from kinetostat.analysis.sweeping.accumulators import Tally
from kinetostat.report.figures.distributions import distributions_figure, varies
from kinetostat.report.figures.embedding import embedded
from limb_profiles import limb_of, pose_of, profile_of

POSES = {"zero": (0.0, 0.0), "mid": (0.2, 0.9), "home": (0.2, 0.95), "folded": (0.5, 2.0)}


@cache
def planar():
    model = ks.load("textbook:planar_2r")
    limb = limb_of(model.robot, "tool")
    profile = profile_of(model, limb, {}, samples=2000, axes="x y")
    poses = []
    for name, q in POSES.items():
        block = ks.manipulability(model, "tool", np.array(q), axes="x y").blocks["task"]
        values = {measure: float(getattr(block, measure)) for measure in profile.sweep.measures}
        poses.append(replace(pose_of(model, limb, name, q), values=values))
    return replace(profile, poses=tuple(poses))


def labelled(ax, label):
    return [artist for artist in ax.lines if artist.get_label() == label]


def test_lines_are_median_and_tenth_and_triangles_the_poses():
    profile = planar()
    figure = distributions_figure(profile)
    for ax, one in zip(figure.axes, profile.sweep.measures.values(), strict=True):
        for share in (0.1, 0.5):
            (line,) = labelled(ax, f"{share:g}")
            assert np.isclose(line.get_xdata()[0], one.quantile(share))
        for letter, pose in zip("abcd", profile.poses, strict=True):
            (mark,) = labelled(ax, f"pose {letter}")
            low, high = ax.get_xlim()
            assert np.isclose(mark.get_xdata()[0], np.clip(pose.values[one.column.name], low, high))


def test_letters_are_told_and_lie_on_no_other():
    figure = distributions_figure(planar())
    said = [text for text, _ in texts(figure)]
    assert "named poses: a zero, b mid, c home, d folded" in said
    assert all(said.count(letter) == len(figure.axes) for letter in "abcd")
    assert not covered_texts(figure)
    assert not cut_texts(figure)


def test_letters_of_twenty_poses_at_one_place_stand_side_by_side():
    profile = planar()
    many = replace(profile, poses=(profile.poses[0],) * 20)
    figure = distributions_figure(many)
    letters = [(text, box) for text, box in texts(figure) if len(text) == 1 and text.islower()]
    assert len(letters) == 20 * len(figure.axes)
    assert not [pair for pair in covered_texts(figure) if len(pair[0]) == len(pair[1]) == 1]


@pytest.mark.parametrize(("value", "marker"), [(1e9, ">"), (-1e9, "<"), (0.4, "v")])
def test_a_value_far_outside_stands_at_the_edge_with_an_arrow(value, marker):
    profile = planar()
    far = replace(profile.poses[0], values=dict.fromkeys(profile.sweep.measures, value))
    for ax in distributions_figure(replace(profile, poses=(far,))).axes:
        (mark,) = labelled(ax, "pose a")
        low, high = ax.get_xlim()
        assert mark.get_marker() == marker
        assert low <= mark.get_xdata()[0] <= high


def test_a_pose_without_a_value_has_no_mark_and_one_outside_limits_is_told():
    profile = planar()
    lost = replace(profile.poses[0], values={"yoshikawa": float("nan")}, inside=False)
    figure = distributions_figure(replace(profile, poses=(lost, profile.poses[1])))
    assert not any(labelled(ax, "pose a") for ax in figure.axes)
    assert any("a zero (outside limits)" in text for text, _ in texts(figure))


def test_without_a_sweep_the_reason_is_told():
    said = [text for text, _ in texts(distributions_figure(replace(planar(), sweep=None)))]
    assert "measures: they are not asked for" in said


def test_a_measure_that_is_the_same_everywhere_is_told_not_drawn():
    model = ks.load("textbook:planar_1r")
    figure = distributions_figure(profile_of(model, limb_of(model.robot, "tool"), {}, samples=200))
    said = " ".join(text for text, _ in texts(figure))
    assert "the same everywhere: yoshikawa" in said
    assert "no measure has several values" in said


def test_a_figure_is_worth_drawing_where_something_varies():
    model = ks.load("textbook:planar_1r")
    assert not varies(profile_of(model, limb_of(model.robot, "tool"), {}, samples=200))
    assert varies(planar())
    assert not varies(replace(planar(), sweep=None))


def test_a_measure_that_bins_cannot_tell_apart_is_the_same_everywhere():
    profile = planar()
    one = profile.sweep.measures["yoshikawa"]
    tallies = {width: Tally.of(0.3 + width * np.arange(100.0)) for width in (1e-8, 1e-3)}
    for width, worth in ((1e-8, False), (1e-3, True)):
        tally = tallies[width]
        ends = {"minimum": replace(one.minimum, value=0.3), "maximum": replace(one.maximum, value=0.3 + 99 * width)}
        sweep = replace(profile.sweep, measures={"yoshikawa": replace(one, tally=tally, **ends)})
        assert varies(replace(profile, sweep=sweep)) is worth


@pytest.mark.parametrize(("payload", "beyond"), [(0.0, False), (100.0, True)])
def test_effort_use_beyond_the_limit_is_marked_with_its_share(payload, beyond):
    model = ks.load("example:ur5_robot")
    at = ks.configuration(model, "zero").q
    swept = ks.sweep(model, "tool0", at, samples=500, measures=("effort_use",), payload=ks.Payload(payload, "tool0"))
    profile = replace(planar(), sweep=swept, poses=())
    figure = distributions_figure(profile)
    (ax,) = figure.axes
    lines = labelled(ax, "limit")
    said = " ".join(text.get_text() for legend in figure.legends for text in legend.get_texts())
    assert bool(lines) is beyond
    if beyond:
        assert np.allclose(lines[0].get_xdata(), 100)
        share = 100 * np.mean(swept.measures["effort_use"].tally.above[-1] / swept.count)
        assert f"{share:.2g} % are beyond it" in said


def test_names_of_poses_that_begin_alike_keep_their_ends():
    profile = planar()
    named = [replace(profile.poses[0], name=f"standing_with_arm_{side}_left") for side in ("up", "home")]
    said = " ".join(text for text, _ in texts(distributions_figure(replace(profile, poses=tuple(named)))))
    assert "up_left" in said
    assert "home_left" in said


def test_a_page_gets_few_bytes():
    assert len(embedded(distributions_figure(planar()), "x")) < 40_000
