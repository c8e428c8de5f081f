"""The picture of a sweep: what is drawn is what was counted, nothing is cut or covered, bytes repeat."""

from dataclasses import replace
from functools import cache
from itertools import combinations
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.sweeping.sweep import sweep, sweep_work
from kinetostat.report.figures import save
from kinetostat.report.figures.heat_maps import MOST_POINTS, axes_of_map, heat_map_figure, is_map
from kinetostat.report.figures.histograms import histogram_figure
from kinetostat.report.measured import reading

LONG = "a_name_that_goes_on_and_on_" * 5
ASKED = {
    "one": {"measures": "yoshikawa"},
    "three": {},
    "constant": {"measures": "position"},  # z of a planar arm
    "all": {"measures": "singular_values,position,gravity_torque,effort_use,yoshikawa_gradient,minimum_gradient"},
}


@cache
def swept(name):
    model = ks.load("textbook:planar_2r")
    return sweep(model, "tool", np.zeros(2), samples=2000, axes="x y", **ASKED[name])


@pytest.mark.parametrize("name", ["one", "three"])
def test_bars_and_lines_are_the_numbers_of_the_sweep(name):
    result = swept(name)
    panels = histogram_figure(result).axes
    assert len(panels) == len(result.measures)
    for ax, one in zip(panels, result.measures.values(), strict=True):
        (bars,) = [patch for patch in ax.patches if patch.get_label() == "bars"]
        shares, edges, _ = bars.get_data()
        assert np.sum(shares) == pytest.approx(100)
        assert (edges[0], edges[-1]) == (one.minimum.value, one.maximum.value)
        marks = {line.get_label(): line.get_xdata()[0] for line in ax.lines}
        assert marks["mean"] == one.mean
        assert marks["0.5"] == one.quantiles[0.5]
        assert marks["0.05"] < marks["0.5"] < marks["0.95"]
        below = np.sum(shares[edges[1:] <= marks["0.5"]])
        assert below <= 51
        assert reading(one.column).name in ax.get_xlabel()


def test_a_measure_that_is_the_same_everywhere_is_said():
    figure = histogram_figure(swept("constant"))
    assert len(figure.axes) == 2
    assert any(text.get_text() == "the same everywhere: position z 0" for text in figure.texts)


def test_the_first_of_many_columns_are_drawn():
    model = ks.load("example:panda")
    asked = "position,gravity_torque,effort_use"
    figure = histogram_figure(sweep(model, "panda_hand", ks.configuration(model, "zero").q, samples=99, measures=asked))
    assert len(figure.axes) == 12
    assert not any("everywhere" in text.get_text() for ax in figure.axes for text in ax.texts)
    assert any("the first 12 of" in text.get_text() for text in figure.texts)


def test_a_partial_sweep_says_so():
    figure = histogram_figure(replace(swept("one"), complete=False, requested=10**7))
    assert any("partial: interrupted before all 10,000,000" in text.get_text() for text in figure.texts)


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


@pytest.mark.parametrize("name", ASKED)
@pytest.mark.parametrize("long", [False, True])
def test_no_text_is_cut_and_none_covers_another(name, long):
    result = swept(name)
    if long:
        columns = {key: replace(one, column=replace(one.column, name=LONG)) for key, one in result.measures.items()}
        result = replace(result, measures=columns, velocity=replace(result.velocity, of=LONG, relative_to=LONG))
    figure = histogram_figure(result)
    page, found = figure.bbox, texts(figure)
    assert len(found) > 8
    for text, box in found:
        assert page.x0 <= box.x0, text
        assert box.x1 <= page.x1, text
        assert page.y0 <= box.y0, text
        assert box.y1 <= page.y1, text
    for (one, a), (other, b) in combinations(found, 2):
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0, (one, other)


def test_hostile_names_are_inert_text(tmp_path):
    hostile = "<script>$x_{$\x1b[31m</script>"
    result = swept("one")
    columns = {key: replace(one, column=replace(one.column, name=hostile)) for key, one in result.measures.items()}
    label = replace(result.velocity, of=hostile, relative_to=hostile)
    save(histogram_figure(replace(result, measures=columns, velocity=label)), tmp_path / "x.svg")
    tree = ET.parse(tmp_path / "x.svg")
    assert not [node for node in tree.iter() if node.tag.endswith("script")]
    assert "\x1b" not in (tmp_path / "x.svg").read_text()


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_sweep_gives_the_same_bytes(tmp_path, suffix):
    written = []
    for i in range(2):
        save(histogram_figure(swept("three")), tmp_path / f"{i}.{suffix}")
        written.append((tmp_path / f"{i}.{suffix}").read_bytes())
    assert written[0] == written[1]


# --- maps ----------------------------------------------------------------------------------------------------------


def mapped(**asked):
    """Return a sweep of a grid over two joints of three, and the values of its columns."""
    model = ks.load("textbook:planar_3r")
    asked = {"grid": {"joint3": (-1, 1, 5), "joint1": (0, 2, 3)}, "axes": "x y", "measures": "position", **asked}
    work = sweep_work(model, "tool", np.array([0.0, 0.4, 0.0]), **asked)
    return sweep(model, "tool", np.array([0.0, 0.4, 0.0]), **asked), work.summed_values(), work


def test_a_map_has_the_numbers_of_the_rows():
    result, values, work = mapped()
    figure = heat_map_figure(result, values, degrees=True)
    panels = [ax for ax in figure.axes if ax.get_xlabel()]
    assert [ax.get_title(loc="left") for ax in panels] == ["position x [m]", "position y [m]"]  # z is the same
    q, model = work.source.rows(0, 15), ks.load("textbook:planar_3r")
    for i, ax in enumerate(panels):
        (mesh,) = ax.collections
        drawn = np.asarray(mesh.get_array()).reshape(5, 3)  # rows: joint3; columns: joint1
        expected = [[ks.fk(model, "tool", q[5 * a + b]).position[i] for a in range(3)] for b in range(5)]
        np.testing.assert_allclose(drawn, expected, atol=1e-12)
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("joint1 [deg]", "joint3 [deg]")
        low, high = (line.get_xydata()[0] for line in ax.lines[::-1])
        one = list(result.measures.values())[i]
        np.testing.assert_allclose(high, np.degrees(one.maximum.q[[0, 2]]))
        np.testing.assert_allclose(low, np.degrees(one.minimum.q[[0, 2]]))


@pytest.mark.parametrize("measures", ["yoshikawa", "position,yoshikawa,singular_values,yoshikawa_gradient"])
def test_no_text_of_a_map_is_cut_and_none_covers_another(measures):
    figure = heat_map_figure(*mapped(measures=measures)[:2])
    page, found = figure.bbox, texts(figure)
    for text, box in found:
        assert page.x0 <= box.x0, text
        assert box.x1 <= page.x1, text
        assert page.y0 <= box.y0, text
        assert box.y1 <= page.y1, text
    for (one, a), (other, b) in combinations(found, 2):
        assert a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 or b.y1 <= a.y0, (one, other)


def test_what_is_a_map():
    assert is_map(mapped()[2].source)
    assert not is_map(mapped(grid="joint1=0:1:3,joint2=0:0:1")[2].source)
    model = ks.load("textbook:planar_3r")
    fine = sweep_work(model, "tool", np.zeros(3), grid=f"joint1=0:1:{MOST_POINTS},joint2=0:1:2").source
    assert axes_of_map(fine) == (0, 1)
    assert not is_map(fine)
