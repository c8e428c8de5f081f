"""Pictures of force polytopes: what is drawn is what was computed, to the stated scale; hostile names are text."""

import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.report.figures import polytope_figure, save

HOSTILE = "<script>$x_{$\x1b[31m</script>"
PANDA = ("example:panda", "panda_hand", "default")
UR5 = ("example:ur5_robot", "tool0", "0.3,-0.5,1.2,0.2,1,0")
MODELS = {}


def model_of(source):
    return MODELS.setdefault(source, ks.load(source))


def drawn(source, frame, q, *, gravity=True, limits=None, on="environment", payload=None, **asked):
    """Return the picture of a robot's forces, and the forces."""
    model = source if isinstance(source, ks.Model) else model_of(source)
    at = ks.configuration(model, q)
    if isinstance(limits, (int, float)):
        limits = {joint.name: float(limits) for joint in model.robot.independent}
    held = None if payload is None else ks.Payload(payload, frame)
    rest = ks.torque(model, at.q, gravity=gravity, limits=limits, on=on, payload=held)
    forces = ks.force_polytope(model, frame, at.q, rest, **asked)
    return polytope_figure(model, forces, at), forces


def labelled(ax, label):
    """Return what is drawn under a label: patches and lines."""
    return [artist for artist in (*ax.patches, *ax.lines) if artist.get_label() == label]


def points_of(artist):
    return artist.get_xy()[:-1] if hasattr(artist, "get_xy") else artist.get_xydata()


def legend_text(figure):
    return "\n".join(text.get_text() for legend in figure.legends for text in legend.get_texts())


def stated(figure):
    """Return the force that the legend says a metre is."""
    return float(re.search(r"1 m drawn is (\S+) N", legend_text(figure))[1])


def vector(label):
    """Return the direction (3,) that an axis' label names."""
    found = np.zeros(3)
    for sign, size, letter in re.findall(r"([-+]?) ?([\d.]*) ?([xyz])\b", label.removesuffix(" [m]")):
        found["xyz".index(letter)] = float(size or 1) * (-1 if sign == "-" else 1)
    return found


def view_of(ax):
    return np.array([vector(ax.get_xlabel()), vector(ax.get_ylabel())])


def support(points, direction):
    return float(np.max(points @ direction))


AROUND = [np.array([np.cos(a), np.sin(a)]) for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)]


# --- numbers in the picture


@pytest.mark.parametrize("asked", [
    {},
    {"payload": 7.5},
    {"on": "robot"},
    {"axes": "rxyz"},
    {"axes": "rxyz", "expressed_in": "panda_link5"},
    {"expressed_in": "panda_hand"},
    {"axes": "x y", "expressed_in": "panda_hand"},
    {"axes": "y"},
    {"point": (0.1, 0, 0.2)},
], ids=str)  # fmt: skip
def test_the_outline_is_the_shadow_of_the_corners_to_the_stated_scale(asked):
    figure, forces = drawn(*PANDA, **asked)
    model = model_of(PANDA[0])
    q = ks.configuration(model, "default").q
    place = ks.fk(model, "panda_hand", q).matrix
    point = place[:3, :3] @ np.array(asked.get("point", (0, 0, 0))) + place[:3, 3]
    turned = ks.fk(model, forces.velocity.expressed_in, q).matrix[:3, :3]
    space = np.zeros((len(forces.vertices), 3))
    space[:, [row % 3 for row in forces.task.rows]] = forces.vertices
    assert len(figure.axes) == 2
    for ax in figure.axes:
        view = view_of(ax)
        (outline,) = labelled(ax, "polytope")
        shadow = (turned @ space.T).T @ view.T / stated(figure)
        seen = points_of(outline) - view @ point
        for direction in AROUND:
            assert np.isclose(support(seen, direction), support(shadow, direction), atol=2e-3)
        (zero,) = labelled(ax, "zero")
        assert np.allclose(zero.get_xydata(), view @ point, atol=2e-3)


@pytest.mark.parametrize("source", [PANDA, UR5], ids=str)
def test_near_faces_fill_the_outline_and_have_their_joints_colour(source):
    figure, forces = drawn(*source)
    listed = re.findall(r"^(\d+): limit of (\S+)$", legend_text(figure), re.MULTILINE)
    assert [int(number) for number, _ in listed] == list(range(1, len(listed) + 1))
    shown = set()
    for ax in figure.axes:
        (outline,) = labelled(ax, "polytope")
        areas = []
        for number, name in listed:
            for face in labelled(ax, f"limit {number}"):
                areas.append(area(points_of(face)))
                shown.add(name)
                near = near_side(figure, forces, source, ax, name)
                for direction in AROUND:
                    assert np.isclose(support(points_of(face), direction), support(near, direction), atol=2e-3)
        assert np.isclose(sum(areas), area(points_of(outline)), rtol=1e-6)
    assert shown == {name for _, name in listed}
    assert shown <= {forces.columns[i] for i in forces.face_joints}


def near_side(figure, forces, source, ax, name):
    """Return where a view shows the face of a joint whose torque grows, to its limit, towards the onlooker."""
    model = model_of(source[0])
    jacobian = ks.jacobian(model, source[1], ks.configuration(model, source[2]).q, joints=[name]).matrix[:3, 0]
    facets = forces.facets[[forces.columns[i] == name for i in forces.face_joints]]
    torques = forces.vertices[facets].mean(axis=1) @ jacobian
    upper = torques > forces.vertices.mean(axis=0) @ jacobian
    toward = jacobian @ np.cross(*view_of(ax)) > 0
    corners = forces.vertices[np.unique(facets[upper == toward])]
    (zero,) = labelled(ax, "zero")
    return corners @ view_of(ax).T / stated(figure) + zero.get_xydata()


def area(corners):
    (x, y), (u, v) = np.asarray(corners).T, np.roll(corners, -1, axis=0).T
    return abs(np.sum(x * v - u * y)) / 2


def test_the_edges_of_a_planar_2r_by_hand():
    """With J = [[-0.8, -0.8], [1, 0]]: |y - 0.8 x| <= 8 is joint1's pair of edges, |0.8 x| <= 4 joint2's."""
    figure, _ = drawn("textbook:planar_2r", "tool", [0, np.pi / 2], gravity=False, limits={"joint1": 8, "joint2": 4})
    (ax,) = figure.axes
    scale = stated(figure)
    for number, limit, row in ((1, 8, (-0.8, 1)), (2, 4, (-0.8, 0))):
        edges = labelled(ax, f"limit {number}")
        assert len(edges) == 2
        for edge in edges:
            torques = (edge.get_xydata() - (1, 0.8)) * scale @ row
            assert np.allclose(np.abs(torques), limit)
    assert "1: limit of joint1\n2: limit of joint2" in legend_text(figure)
    assert "force without bound across the drawing" in legend_text(figure)
    assert labelled(ax, "force without bound") == []


def test_the_ball_is_what_is_possible_in_every_direction():
    for source, frame, q, asked in ((*UR5, {}), ("textbook:planar_2r", "tool", [0.5, 1], {"limits": 9})):
        figure, forces = drawn(source, frame, q, **asked)
        for ax in figure.axes:
            (ball,) = labelled(ax, "ball")
            assert np.allclose([ball.width / 2, ball.height / 2], forces.every_way / stated(figure), rtol=1e-9)
            (zero,) = labelled(ax, "zero")
            assert np.allclose(ball.get_center(), zero.get_xydata())
        assert f"{forces.every_way:.3g} N in every" in legend_text(figure)


def test_zero_outside_has_no_ball_and_is_said():
    figure, forces = drawn("textbook:planar_2r", "tool", [0.5, 1.0], gravity=(0, -9.81, 0), limits={"joint1": 20})
    assert forces.every_way == 0
    assert labelled(figure.axes[0], "ball") == []
    assert any("zero is not in the polytope" in text.get_text() for text in figure.texts)
    (zero,) = labelled(figure.axes[0], "zero")
    (low, right), (down, up) = figure.axes[0].get_xlim(), figure.axes[0].get_ylim()
    ((x, y),) = zero.get_xydata()
    assert low < x < right
    assert down < y < up


def test_a_stretched_arm_has_an_arrow_along_itself_and_a_section_across():
    figure, _ = drawn("textbook:planar_2r", "tool", [0.5, 0.0], limits={"joint1": 20, "joint2": 10})
    (ax,) = figure.axes
    along, across = np.array([np.cos(0.5), np.sin(0.5)]), np.array([-np.sin(0.5), np.cos(0.5)])
    (arrow,) = labelled(ax, "force without bound")
    start, end = (np.array(side) for side in arrow._posA_posB)
    assert abs((end - start) @ across) < 1e-12
    assert np.allclose((start + end) / 2, 1.8 * along)
    (section,) = labelled(ax, "polytope")
    ends = section.get_xydata() - 1.8 * along
    assert np.allclose(ends @ along, 0, atol=1e-12)
    assert np.allclose(sorted(ends @ across * stated(figure)), [-20 / 1.8, 20 / 1.8])
    assert "force without bound: needs no torque" in legend_text(figure)
    assert "section across" in legend_text(figure)
    assert any(text.get_text() == "∞" for text in ax.texts)


def test_moments_of_a_planar_arm_are_seen_from_aside():
    figure, _ = drawn("textbook:planar_3r", "tool", [0.5, 1.0, 0.3], limits=10, axes="rz")
    first, second = figure.axes
    assert (second.get_xlabel(), second.get_ylabel()) == ("x [m]", "z [m]")
    (line,) = labelled(second, "polytope")
    assert np.isclose(np.ptp(line.get_xydata()[:, 1]) * stated(figure), 20)
    assert "Nm" in legend_text(figure)
    assert np.allclose(view_of(first), np.eye(3)[:2])


def test_scales_are_rounded_and_pictures_readable():
    for limits in (1e-9, 0.37, 1.0, 12.0, 950.0, 1e9):
        figure, _ = drawn("textbook:planar_2r", "tool", [0.5, 1.0], gravity=False, limits=limits)
        digits = f"{stated(figure):e}".partition("e")[0]
        assert float(digits) in (1, 2, 3, 5)
        (outline,) = labelled(figure.axes[0], "polytope")
        (zero,) = labelled(figure.axes[0], "zero")
        farthest = np.max(np.linalg.norm(points_of(outline) - zero.get_xydata(), axis=1))
        assert 0.2 < farthest < 1.0  # beside 1.8 m of arm


@pytest.mark.parametrize(("source", "frame", "q", "asked"), [
    ("example:panda", "panda_link0", "default", {}),
    ("textbook:rp", "tool", "zero", {"limits": 10}),
    ("textbook:skew_1p", "tool", "zero", {"limits": 10}),
    ("textbook:planar_1r", "tool", "zero", {"limits": 10}),
    ("textbook:helical", "tool", "zero", {"limits": 10}),
    ("textbook:scara", "tool", [0.5, 0.9, 0.1, 0], {}),
    ("textbook:wrist_zyz", "link3", "zero", {"limits": 10, "axes": "rxyz"}),
    ("example:ur5_robot", "tool0", "zero", {}),
    ("example:ur5_robot", "tool0", "0.3,-0.5,0,0.2,0,0", {"axes": "rx ry"}),
    ("example:talos_full_v2", "gripper_left_base_link", "random:1", {}),
], ids=str)  # fmt: skip
def test_singular_and_degenerate_pictures_are_finite(source, frame, q, asked, tmp_path):
    figure, _ = drawn(source, frame, q, **asked)
    for ax in figure.axes:
        assert np.all(np.isfinite([*ax.get_xlim(), *ax.get_ylim()]))
        assert np.diff(ax.get_xlim())[0] < 1e3
    save(figure, tmp_path / "picture.png")


def test_everything_is_inside_its_panel():
    for figure in (drawn(*PANDA)[0], drawn(*UR5)[0], drawn("textbook:planar_2r", "tool", [0.5, 0], limits=9)[0]):
        for ax in figure.axes:
            low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
            for artist in [*labelled(ax, "polytope"), *labelled(ax, "arm")]:
                assert np.all(points_of(artist) >= low)
                assert np.all(points_of(artist) <= high)
            inches = ax.get_position().size * figure.get_size_inches()
            assert np.isclose(*(inches / (high - low)))


# --- words


def test_the_heading_says_whose_forces_on_what_and_where():
    shown = "\n".join(text.get_text() for text in drawn(*PANDA)[0].texts)
    assert shown.startswith("panda: forces of panda_hand")
    assert "all forces that panda_hand exerts within the effort limits" in shown
    assert "panda_joint4 -2.35619" in shown
    assert "that act on panda_hand" in "\n".join(text.get_text() for text in drawn(*PANDA, on="robot")[0].texts)
    local = drawn(*PANDA, axes="x y", expressed_in="panda_link7")[0]
    assert "along x and y" in local.texts[1].get_text()
    assert "axes of panda_link7" in local.texts[1].get_text()


def test_more_joints_than_colours_are_grey_and_counted():
    figure, _ = drawn("example:panda", "panda_hand", "default")
    model = model_of("example:panda")
    at = ks.configuration(model, "default")
    _, forces = drawn(*PANDA)
    many = replace(forces, face_joints=tuple(range(len(forces.facets))), columns=tuple(f"j{i}" for i in range(99)))
    crowded = polytope_figure(model, many, at)
    assert "7: limit of" in legend_text(crowded)
    assert re.search(r"8 to (\d+): (\d+) more joints", legend_text(crowded))
    assert "more joints" not in legend_text(figure)


def test_hostile_names_are_inert_text(tmp_path):
    model, at = model_of("example:panda"), ks.configuration(model_of("example:panda"), "default")
    _, forces = drawn(*PANDA)
    robot = replace(model.robot, name=HOSTILE)
    named = replace(forces, columns=(HOSTILE,) * len(forces.columns))
    figure = polytope_figure(replace(model, robot=robot), named, at)
    for suffix in ("svg", "png", "pdf"):
        save(figure, tmp_path / f"picture.{suffix}")
    content = (tmp_path / "picture.svg").read_text()
    assert "\x1b" not in content
    root = ET.fromstring(content)
    assert "script" not in {element.tag.rpartition("}")[2] for element in root.iter()}
    shown = ["".join(element.itertext()) for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert sum("<script>$x_{$" in words for words in shown) >= 2  # as text, dollars and all: title, and legend


# --- bytes


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
def test_the_same_input_gives_the_same_bytes(tmp_path, suffix):
    written = []
    for i in range(2):
        save(drawn(*UR5)[0], tmp_path / f"{i}.{suffix}")
        written.append((tmp_path / f"{i}.{suffix}").read_bytes())
    assert written[0] == written[1]


def test_another_process_and_the_users_own_style_give_the_same_bytes(tmp_path):
    script = (
        "import sys, pathlib, matplotlib; matplotlib.rcParams.update({'font.size': 20, 'axes.facecolor': 'black'});"
        "import kinetostat as ks; from kinetostat.report.figures import polytope_figure, save;"
        "r = ks.load('example:ur5_robot'); q = ks.configuration(r, '0.3,-0.5,1.2,0.2,1,0');"
        "f = ks.force_polytope(r, 'tool0', q.q, ks.torque(r, q.q, gravity=True));"
        "save(polytope_figure(r, f, q), pathlib.Path(sys.argv[1]));"
        "assert matplotlib.rcParams['font.size'] == 20; assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script, str(tmp_path / "other.svg")], check=True, timeout=120)
    save(drawn(*UR5)[0], tmp_path / "here.svg")
    assert (tmp_path / "other.svg").read_bytes() == (tmp_path / "here.svg").read_bytes()


def test_importing_figures_imports_neither_matplotlib_nor_scipy():
    script = (
        "import sys, kinetostat.report.figures as f; f.polytope_figure;"
        "assert not {'matplotlib', 'scipy'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)
