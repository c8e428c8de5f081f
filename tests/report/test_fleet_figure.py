"""The picture of a fleet: a mark for each chain where its numbers are, which leads to it; what is left out is told."""

import re
from xml.etree import ElementTree as ET

import msgspec
import numpy as np
import pytest

from figure_texts import covered_texts, cut_texts, texts
from kinetostat.report.figures.embedding import embedded
from kinetostat.report.figures.fleets import scatter_figure
from report.fleet import fleet_documents as made


def chain(key, reach, median, joints=6, name="arm"):
    measure = made.distribution("inverse_condition_number", "dexterity", "1", median)
    return made.chain(key, name, reach, [f"j{i}" for i in range(joints)], distributions=(measure,))


def fleet(seed, count, spread=0.3, name="robot"):
    random = np.random.default_rng(seed)
    robots = []
    for i in range(1, count + 1):
        reach, median = float(np.exp(spread * random.normal())), float(random.uniform(0.05, 0.5))
        robots.append(
            made.robot(f"r{i}", f"{name}{i}", chains=(chain(f"r{i}-1", reach, median, int(random.integers(2, 10))),))
        )
    return made.document(*robots)


def marks(figure):
    """Return the mark of each chain by its id."""
    (ax,) = figure.axes
    return {line.get_label(): line for line in ax.lines if re.fullmatch(r"r\d+-\d+", str(line.get_label()))}


@pytest.mark.parametrize("seed", range(4))
def test_every_chain_stands_where_its_numbers_are_and_its_mark_leads_to_it(seed):
    document = fleet(seed, 12)
    figure = scatter_figure(document)
    links = set(re.findall(r'<a href="(#[^"]*)"', embedded(figure, "x")))
    for robot in document.robots:
        (one,) = robot.chains
        mark = marks(figure)[one.id]
        assert np.allclose(mark.get_xydata()[0], [one.reach, one.distributions[0].quantiles["0.5"]])
        (span,) = [line for line in figure.axes[0].lines if line.get_label() == f"span of {one.id}"]
        assert list(span.get_ydata()) == [one.distributions[0].quantiles[share] for share in ("0.1", "0.9")]
        assert f"#{one.id}" in links


@pytest.mark.parametrize(("seed", "count"), [(0, 3), (1, 12), (2, 25), (3, 90)])
def test_names_lie_on_no_other_and_few_chains_are_all_named(seed, count):
    figure = scatter_figure(fleet(seed, count))
    names = [text for text, _ in texts(figure) if re.fullmatch(r"robot\d+", text)]
    assert not covered_texts(figure)
    assert not cut_texts(figure)
    assert len(names) == count or count > 12
    assert len(names) >= min(count, 15)
    told = [text for text, _ in texts(figure) if "are named" in text]
    assert len(told) == (len(names) < count)
    assert all(text.startswith(f"{len(names)} of {count} are named;") for text in told)
    assert len(embedded(figure, "x")) < 60_000


def test_limbs_of_a_robot_at_one_place_are_named_once():
    dog = made.robot("r1", "dog", chains=tuple(chain(f"r1-{i}", 0.5, 0.3, name=f"leg{i}") for i in range(4)))
    cat = made.robot("r2", "cat", chains=(chain("r2-1", 0.5, 0.3),))
    arm = made.robot("r3", "arm", chains=(chain("r3-1", 1.5, 0.1),))
    shown = [text for text, _ in texts(scatter_figure(made.document(dog, cat, arm)))]
    assert [text for text in shown if text.startswith("dog")] == ["dog: leg0"]
    assert {"cat", "arm"} <= set(shown)


def test_chains_of_different_joints_differ_in_shape_and_colour():
    robots = [made.robot(f"r{n}", chains=(chain(f"r{n}-1", 1.0 + n, 0.2, n),)) for n in (2, 4, 6, 7, 9)]
    found = marks(scatter_figure(made.document(*robots))).values()
    assert len({mark.get_marker() for mark in found}) == len({mark.get_color() for mark in found}) == 5


@pytest.mark.parametrize(("reaches", "scale"), [((0.5, 1.0, 4.9), "linear"), ((0.05, 1.0), "log")])
def test_reach_is_by_logarithm_beyond_a_decade(reaches, scale):
    robots = [made.robot(f"r{i}", chains=(chain(f"r{i}-1", reach, 0.2),)) for i, reach in enumerate(reaches, 1)]
    (ax,) = (figure := scatter_figure(made.document(*robots))).axes
    assert ax.get_xscale() == scale
    assert ax.get_xlim()[0] < min(reaches) <= max(reaches) < ax.get_xlim()[1]
    assert not cut_texts(figure)


def test_what_has_no_numbers_is_left_out_and_counted():
    lost = made.robot(
        "r2", chains=(msgspec.structs.replace(made.chain("r2-1"), reach=None), made.chain("r2-2", distributions=()))
    )
    figure = scatter_figure(made.document(made.robot("r1"), lost, made.failed(), made.without_chains()))
    assert set(marks(figure)) == {"r1-1"}
    said = " ".join(text for text, _ in texts(figure))
    assert "2 chains without reach or dexterity, 1 robot that could not be computed, 1 robot without a chain" in said


def test_dexterity_that_compares_nothing_is_left_out_and_said():
    limbs = chain("r1-1", 1.0, 0.2), chain("r1-2", 1.0, 1.0, joints=1), chain("r1-3", 1.0, 1.0)
    head = msgspec.structs.replace(limbs[2], turns_only=True)
    figure = scatter_figure(made.document(made.robot(chains=(*limbs[:2], head))))
    assert set(marks(figure)) == {"r1-1"}
    assert "not shown: 2 chains of one joint, or that only turn their tool" in " ".join(t for t, _ in texts(figure))


def test_a_line_that_goes_on_below_the_axis_is_marked_and_others_are_whole():
    def spanned(key, median, low):
        measure = made.distribution("inverse_condition_number", "dexterity", "1", median)
        measure = msgspec.structs.replace(measure, quantiles={"0.1": low, "0.5": median, "0.9": 1.1 * median})
        return made.chain(key, "arm", 1.0 + float(key[-1]), distributions=(measure,))

    limbs = [
        spanned(f"r1-{i}", *one) for i, one in enumerate(((0.9, 0.4), (0.05, 0.01), (0.04, 1e-9), (0.05, 0.03)), 1)
    ]
    figure = scatter_figure(made.document(made.robot(chains=tuple(limbs))))
    (ax,) = figure.axes
    assert ax.get_yscale() == "log"
    cut = [line.get_xdata()[0] for line in ax.lines if line.get_label() == "cut"]
    assert cut == [limbs[2].reach]
    assert ax.get_ylim()[0] < 0.01
    assert "ends in a triangle" in " ".join(text for text, _ in texts(figure))
    assert "by logarithm" in ax.get_ylabel()


def test_an_empty_fleet_is_a_picture_too():
    for document in (made.document(), made.document(made.failed()), made.document(made.without_chains())):
        assert "no chain has both" in [text for text, _ in texts(scatter_figure(document))]


@pytest.mark.parametrize("name", made.HOSTILE)
def test_hostile_names_are_inert_and_links_stay_in_the_page(name):
    document = made.document(
        made.robot("r1", name, chains=(chain("r1-1", 1.0, 0.2, name=name), chain("r1-2", 2.0, 0.3)))
    )
    svg = ET.fromstring(embedded(scatter_figure(document), "x"))
    assert {one.tag for one in svg.iter()} <= {"svg", "defs", "g", "a", "path", "use", "text", "clipPath", "rect"}
    assert {one.get("href") for one in svg.iter("a")} <= {"#r1-1", "#r1-2"}


def test_what_turns_on_its_spot_is_said_and_leaves_the_axis_to_the_arms():
    arms = [made.chain("r1-1", "hand", 0.1), made.chain("r1-2", "arm", 2.0)]
    for reach in (0.0, 1e-17):
        head = made.chain("r1-3", "head", reach)
        figure = scatter_figure(made.document(made.robot(chains=(*arms, head))))
        assert "not shown: 1 chain without reach or dexterity" in "\n".join(text.get_text() for text in figure.texts)
        assert figure.axes[0].get_xscale() == "log"
