"""The figure of a trajectory: what is in it, that it is the same every time, that many samples lose no extreme."""

import re

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.trajectory.trajectory import trajectory
from kinetostat.report.figures import save
from kinetostat.report.figures.timelines import _thinned, timeline_figure
from kinetostat.report.trajectory_rows import BadRow, FileRows


def rows(count):
    return FileRows(np.arange(count) + 1, count)


@pytest.fixture(scope="module")
def planar():
    model = ks.load("textbook:planar_2r")
    time = np.linspace(0, 2, 121)
    q = np.stack([2.9 + 0.15 * time, 1 - time], axis=1)
    return trajectory(model, "tool", q, time, gravity=(0, -9.81, 0))


def labels(figure):
    return [ax.get_ylabel() for ax in figure.axes]


def test_every_panel_has_its_unit(planar):
    figure = timeline_figure(planar, rows(121))
    expected = ["position [rad]", "smallest / largest", "tool speed [m/s]", "velocity limit [%]", "static effort [%]"]
    assert labels(figure) == [*expected, "turning [rad/s]"]
    assert "position [deg]" in labels(timeline_figure(planar, rows(121), degrees=True))
    assert figure.axes[4].get_xlabel() == "time [s]"


def test_the_lines_are_the_samples(planar):
    figure = timeline_figure(planar, rows(121))
    top, index = figure.axes[:2]
    for joint in range(2):
        np.testing.assert_array_equal(top.lines[joint].get_ydata(), planar.q[:, joint])
        np.testing.assert_array_equal(top.lines[joint].get_xdata(), planar.time)
    shown, ratio = index.lines[0].get_ydata(), planar.inverse_condition_number
    np.testing.assert_array_equal(shown[ratio > 1e-6], ratio[ratio > 1e-6])
    assert any(abs(line.get_ydata()[0] - np.pi) < 1e-6 for line in top.lines[2:])  # the limit that is near
    (span,) = planar.spans
    for ax in figure.axes[1:5]:
        (shade,) = ax.patches
        assert shade.get_x() == planar.time[span.first]
        assert shade.get_x() + shade.get_width() == pytest.approx(planar.time[span.last])


def texts(figure):
    legend = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    return [*legend, *(text.get_text() for text in figure.texts)]


def test_violations_are_bands_in_the_panel_of_their_kind():
    model = ks.load("textbook:planar_2r")
    time = np.arange(60) * 0.05
    q = np.stack([np.where(time < 2, 1.0, 3.3), np.full(60, 1.2)], axis=1)  # a jump, and beyond pi from there on
    result = trajectory(model, "tool", q, time, gravity=(0, -9.81, 0), limits={"joint2": 0.01})
    figure = timeline_figure(result, rows(60))
    panels = dict(zip(labels(figure), figure.axes, strict=True))
    expected = {"position": "position [rad]", "velocity": "velocity limit [%]", "effort": "static effort [%]"}
    assert {one.kind for one in result.violations} == set(expected)
    for one in result.violations:
        shade = panels[expected[one.kind]].patches[-1]
        assert shade.get_x() <= time[one.first] + 1e-9
        assert shade.get_x() + shade.get_width() >= time[one.last] - 1e-9
    assert not panels["smallest / largest"].patches
    assert not panels["tool speed [m/s]"].patches
    used = panels["velocity limit [%]"]
    assert used.lines[0].get_ydata().max() == pytest.approx(100 * 2.3 / 0.05 / result.speed_limits[0])
    assert any(set(line.get_ydata()) == {100} for line in used.lines)
    assert "beyond a limit" in texts(figure)
    assert any("effort limits as given" in text for text in texts(figure))


def test_many_violations_are_few_bands():
    model = ks.load("textbook:planar_2r")
    q = np.stack([3.2 * (np.arange(20_000) % 2), np.full(20_000, 0.5)], axis=1)
    figure = timeline_figure(trajectory(model, "tool", q), rows(20_000))
    assert len(figure.axes[0].patches) < 1600


def test_rows_that_are_left_out_are_marked(planar):
    numbers = np.delete(np.arange(123) + 1, [40, 41])
    bad = (BadRow(41, 42, "x"), BadRow(42, 43, "x"))
    figure = timeline_figure(planar, FileRows(numbers, 123, bad))
    (mark,) = (line for line in figure.axes[0].lines if line.get_marker() == "x")
    assert all(planar.time[39] < x < planar.time[40] for x in mark.get_xdata())
    assert len(mark.get_xdata()) == 2
    assert "rows left out: 2" in texts(figure)


def test_a_ratio_that_is_clipped_is_said_to_be(planar):
    assert any("drawn as 1e-06" in text for text in texts(timeline_figure(planar, rows(121))))
    away = trajectory(planar.mechanism.model, "tool", planar.q[:20], planar.time[:20])
    assert not any("1e-06" in text for text in texts(timeline_figure(away, rows(20))))


def test_nothing_of_speed_without_time(planar):
    model = planar.mechanism.model
    alone = trajectory(model, "tool", planar.q[:1])
    figure = timeline_figure(alone, rows(1))
    assert not any("speed" in label for label in labels(figure))
    assert figure.axes[2].get_xlabel() == "row of the file"


def test_the_same_bytes_and_text_that_is_text(planar, tmp_path):
    for name in ("a.svg", "b.svg"):
        save(timeline_figure(planar, rows(121)), tmp_path / name)
    content = (tmp_path / "a.svg").read_bytes()
    assert content == (tmp_path / "b.svg").read_bytes()
    assert {"joint1", "joint2", "time [s]"} <= set(re.findall(r">([^<>]+)</text>", content.decode()))


def test_a_humanoid_has_more_joints_than_lines():
    model = ks.load("example:talos_full_v2")
    q = np.linspace(*ks.random_configurations(model, 0, 2), 40)
    result = trajectory(model, "gripper_right_base_link", q, np.linspace(0, 5, 40))
    assert len(result.columns) > 20
    figure = timeline_figure(result, rows(40))
    texts = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert f"and {len(result.columns) - 10} more, not drawn" in texts


def test_slides_have_a_panel_of_their_own():
    model = ks.load("textbook:stanford")
    q = np.linspace(*ks.random_configurations(model, 0, 2), 30)
    figure = timeline_figure(trajectory(model, "tool", q), rows(30))
    assert labels(figure)[:3] == ["position [rad]", "position [m]", "smallest / largest"]
    slide = model.robot.position_names.index(next(j.name for j in model.robot.joints if j.type.value == "prismatic"))
    np.testing.assert_array_equal(figure.axes[1].lines[0].get_ydata(), q[:, slide])


@pytest.mark.parametrize("count", [10, 3000, 3001, 200_000])
def test_no_extreme_is_lost(count):
    generator = np.random.default_rng(count)
    y, x = generator.normal(size=count), np.arange(count) / 7
    y[count // 3], y[2 * count // 3] = 99.0, -99.0
    thin_x, thin_y = _thinned(x, y)
    assert len(thin_x) <= 3002
    assert (thin_y.max(), thin_y.min()) == (99.0, -99.0)
    assert (thin_x[0], thin_x[-1]) == (x[0], x[-1])
    assert np.all(np.diff(thin_x) > 0)
    assert np.all(y[np.searchsorted(x, thin_x)] == thin_y)
