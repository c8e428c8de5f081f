"""Pictures of maps: voxels are drawn where they are, and what is not reached is not drawn; hostile names are text."""

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from matplotlib.collections import LineCollection, QuadMesh

import kinetostat as ks
from kinetostat.analysis.capability.capability_map import capability_map
from kinetostat.analysis.capability.placing import base_placement
from kinetostat.analysis.inverse.pose import Pose
from kinetostat.report.figures import save
from kinetostat.report.figures.maps import capability_figure, placement_figure

HOSTILE = "<script>$x_{$\x1b[31m</script>"


def mapped(robot, frame, **asked):
    model = ks.load(robot)
    return capability_map(model, frame, ks.configuration(model).q, **asked)


@pytest.fixture(scope="module")
def planar():
    return mapped("textbook:planar_2r", "tool", low_discrepancy=65_536, axes="xy")


@pytest.fixture(scope="module")
def spatial():
    return mapped("example:ur5_robot", "tool0", samples=65_536, length="auto")


def meshes(figure):
    found = [[each for each in ax.collections if isinstance(each, QuadMesh)] for ax in figure.axes]
    return [(ax, each[0]) for ax, each in zip(figure.axes, found, strict=True) if each and ax.get_xlabel()]


def test_a_planar_arm_is_one_picture_of_all_its_voxels(planar):
    ((ax, mesh),) = meshes(capability_figure(planar))
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    drawn = np.ma.filled(mesh.get_array(), np.nan)
    np.testing.assert_array_equal(drawn, planar.best_singular_value[..., 0].T)
    corners = mesh.get_coordinates()
    np.testing.assert_allclose(corners[0, 0], planar.box[0][:2], atol=1e-12)
    np.testing.assert_allclose(corners[-1, -1], planar.box[1][:2], atol=1e-12)


def test_a_spatial_arm_is_cut_upright_and_level_through_its_base(spatial):
    upright, level = meshes(capability_figure(spatial))
    assert (upright[0].get_ylabel(), level[0].get_ylabel()) == ("z [m]", "y [m]")
    y, z = (int(np.argmin(np.abs(axis))) for axis in spatial.grid.axes[1:])
    np.testing.assert_array_equal(np.ma.filled(upright[1].get_array(), np.nan), spatial.best_singular_value[:, y].T)
    np.testing.assert_array_equal(np.ma.filled(level[1].get_array(), np.nan), spatial.best_singular_value[:, :, z].T)
    assert upright[1].norm.vmax == level[1].norm.vmax


def test_the_edge_goes_round_what_is_reached(planar):
    ((ax, _),) = meshes(capability_figure(planar))
    (edge,) = [each for each in ax.collections if isinstance(each, LineCollection)]
    reached = planar.reached[..., 0]
    for start, end in np.array(edge.get_segments())[::7]:
        middle, across = (start + end) / 2, (end - start)[::-1] / 4
        sides = planar.grid.index(np.array([[*(middle + across), 0.0], [*(middle - across), 0.0]]))
        assert {bool(side >= 0 and reached.ravel()[side]) for side in sides} == {True, False}


@pytest.mark.parametrize("suffix", [".svg", ".png", ".pdf"])
def test_it_is_written_in_every_format(planar, tmp_path, suffix):
    path = tmp_path / f"map{suffix}"
    save(capability_figure(planar), path)
    assert path.stat().st_size > 1000


def test_names_are_text(planar, tmp_path):
    hostile = replace(planar, velocity=replace(planar.velocity, of=HOSTILE, relative_to=HOSTILE))
    save(capability_figure(hostile), tmp_path / "map.svg")
    root = ET.parse(tmp_path / "map.svg").getroot()
    assert not [each for each in root.iter() if each.tag.endswith("script")]
    assert any("<script>" in (each.text or "") for each in root.iter())


def test_nothing_is_outside_the_page(spatial):
    figure = capability_figure(spatial)
    figure.canvas.draw()
    width, height = figure.get_size_inches() * figure.dpi
    for ax in figure.axes:
        box = ax.get_tightbbox()
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= width
        assert box.y1 <= height


def test_places_of_the_base_are_drawn_with_their_share(planar):
    model = ks.load("textbook:planar_2r")
    turns = 2 * np.pi * np.arange(8) / 8
    poses = np.tile(np.eye(4), (8, 1, 1))
    poses[:, 0, 3], poses[:, 1, 3] = 3 + np.cos(turns), np.sin(turns)
    found = base_placement(model, planar, Pose(poses, oriented=False), np.zeros(2))
    ((ax, mesh),) = meshes(placement_figure(found))
    shares = np.ma.filled(mesh.get_array(), np.nan)
    corners = mesh.get_coordinates()
    middles = (corners[:-1, :-1] + corners[1:, 1:]) / 2
    best = found.proved[0]
    at = np.unravel_index(np.argmin(np.hypot(middles[..., 0] - best.x, middles[..., 1] - best.y)), shares.shape)
    assert shares[at] == best.promised / 8 == 1.0
    assert np.isnan(shares[0, 0])
    points = [line.get_xydata() for line in ax.lines if len(line.get_xydata()) == 8]
    np.testing.assert_allclose(points[0], poses[:, :2, 3])


def test_the_approach_is_told():
    figure = capability_figure(mapped("example:ur5_robot", "tool0", samples=65_536, approach=(0, 0, -1)))
    assert any("within 15 degrees of (0, 0, -1)" in text.get_text() for text in figure.texts)


def test_poses_that_no_place_reaches_are_drawn(tmp_path):
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[:, 2, 3] = 5.0
    spatial = mapped("example:ur5_robot", "tool0", samples=20_000, axes="xyz")
    found = base_placement(spatial.coordinates.model, spatial, Pose(poses, oriented=False), np.zeros(6))
    save(placement_figure(found), tmp_path / "place.svg")
    assert (tmp_path / "place.svg").stat().st_size > 1000
