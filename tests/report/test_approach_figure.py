"""The picture of the way into a singularity: what is drawn is what was computed, nothing is cut, bytes repeat."""

import math
from dataclasses import replace
from functools import cache
from itertools import combinations
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.report.figures import approach_figure, save

MODELS = {}
LONG = "a_name_that_goes_on_and_on_" * 5


def way_of(source, frame, q, **asked):
    model = MODELS.setdefault(source, ks.load(source))
    return ks.singular_approach(model, frame, ks.configuration(model, q).q, **asked)


def ur5(**asked):
    end = np.array([0.3, -1.2, 1.4, -0.6, 0.0, 0.2])
    return way_of("example:ur5_robot", "tool0", "0.3,-1.2,1.4,-0.6,0.8,0.2", end=end, **asked)


@cache
def ways():
    """Return ways of each sort."""
    return list(sorts())


def sorts():
    """Yield ways of each sort: with limits and without, of rows in m and in rad, with slides, of no singular end."""
    yield ur5()
    yield way_of("textbook:planar_2r", "tool", "0.3,0.7")
    yield way_of("textbook:scara", "tool", "0.5,0.9,0.1,-0.3")
    yield way_of("textbook:wrist_zyz", "tool", "0.1,0.8,0.4", axes="rx ry rz", joint_error=(1e-3, 2e-3, 0))
    yield way_of("textbook:planar_2r", "tool", "0.3,0.7", end=np.array([0.1, 0.4]))
    yield way_of("textbook:planar_2r", "tool", "0.3,0.7", joint_error=0)
    yield ur5(speed=1e-9)
    yield ur5(speed=1e3)
    way = ur5()
    yield replace(way, names=(LONG,) * 6, velocity=replace(way.velocity, of=LONG, relative_to=LONG), end=way.end + 0.1)


def drawn_under(ax, label):
    (line,) = [line for line in ax.lines if line.get_label() == label]
    return line.get_xydata().T


@pytest.mark.parametrize(("degrees", "turn"), [(False, 1.0), (True, 180 / math.pi)])
def test_curves_are_the_numbers_of_the_way(degrees, turn):
    way = ur5(speed=0.2)
    left, right = approach_figure(way, degrees=degrees).axes
    rates = np.array([np.linalg.norm(rates / way.mechanism.units) for rates in way.rates[:-1]])
    x, speed = drawn_under(left, "speed")
    assert np.allclose(x, way.remaining[:-1] * turn, rtol=1e-12)
    assert np.allclose(speed, rates * turn, rtol=1e-9)
    assert np.allclose(drawn_under(right, "worst")[1], way.worst[:-1] * 1e3, rtol=1e-12)
    assert np.allclose(drawn_under(right, "sigma")[1], way.sigma[:-1] * 1e3, rtol=1e-12)
    unit = "deg" if degrees else "rad"
    assert left.get_ylabel() == f"joint speed for 0.2 m/s [{unit}/s]"
    assert right.get_ylabel() == "tool error [mm]"
    for ax in (left, right):
        assert ax.get_xlim()[0] > ax.get_xlim()[1]  # the singularity is on the right
        assert unit in ax.get_xlabel()
    assert right.get_ylim()[0] == 0


def test_the_velocity_limit_is_marked_where_it_is_reached():
    way = ur5()
    left, _ = approach_figure(way).axes
    x, _ = drawn_under(left, "limit")
    assert np.allclose(x, way.limit_at[0])
    figure = approach_figure(way)
    (legend,) = figure.legends
    assert any(way.limit_at[1] in text.get_text() for text in legend.get_texts())
    left, _ = approach_figure(ur5(speed=1e-9)).axes
    assert not [line for line in left.lines if line.get_label() == "limit"]
    assert not left.patches


def test_turns_alone_are_in_degrees_or_mrad():
    way = way_of("textbook:wrist_zyz", "tool", "0.1,0.8,0.4", axes="rx ry rz")
    for degrees, unit, factor in ((False, "mrad", 1e3), (True, "deg", 180 / math.pi)):
        _, right = approach_figure(way, degrees=degrees).axes
        assert right.get_ylabel() == f"tool error [{unit}]"
        assert np.allclose(drawn_under(right, "worst")[1], way.worst[:-1] * factor)


def texts(figure):
    """Return every text that is shown, with its box in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    FigureCanvasAgg(figure).draw()
    ticks = [t for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) for t in (*axis.majorTicks, *axis.minorTicks)]
    labels = {label for tick in ticks for label in (tick.label1, tick.label2)}
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            labels -= {tick.label1 for tick in axis._update_ticks()}
    shown = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text() and text not in labels]
    return [(text.get_text(), text.get_window_extent()) for text in shown]


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize("index", range(9))
def test_no_text_is_cut_and_none_covers_another(index, degrees):
    figure = approach_figure(ways()[index], degrees=degrees)
    page = figure.bbox
    found = texts(figure)
    assert len(found) > 8
    for text, box in found:
        assert page.x0 <= box.x0, text
        assert box.x1 <= page.x1, text
        assert page.y0 <= box.y0, text
        assert box.y1 <= page.y1, text
    for (one, a), (other, b) in combinations(found, 2):
        apart = a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0
        assert apart, (one, other)


def test_hostile_names_are_inert_text(tmp_path):
    hostile = "<script>$x_{$\x1b[31m</script>"
    way = ur5()
    label = replace(way.velocity, of=hostile, relative_to=hostile)
    figure = approach_figure(replace(way, names=(hostile,) * 6, velocity=label))
    for suffix in ("svg", "png", "pdf"):
        save(figure, tmp_path / f"x.{suffix}")
    tree = ET.parse(tmp_path / "x.svg")
    assert not [node for node in tree.iter() if node.tag.endswith("script")]
    assert "\x1b" not in (tmp_path / "x.svg").read_text()


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_way_gives_the_same_bytes(tmp_path, suffix):
    written = []
    for i in range(2):
        save(approach_figure(ur5()), tmp_path / f"{i}.{suffix}")
        written.append((tmp_path / f"{i}.{suffix}").read_bytes())
    assert written[0] == written[1]
