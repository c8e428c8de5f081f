"""The two engines agree on small robots at the edges of what a file may say: names, axes, lengths, counts."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

import numpy as np
import pytest

import kinetostat as ks
from engines.agreement import assert_agreement, assert_masses_agree, labels
from trees import load_text

KINDS = ("revolute", "continuous", "prismatic", "planar")
INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'


def arm(
    *,
    kind: str = "revolute",
    axis: str = "0 0 1",
    xyz: str = "1 0 0",
    rpy: str = "0 0 0",
    links: tuple[str, str, str] = ("a", "b", "c"),
    joints: tuple[str, str] = ("j", "k"),
    second: str = "revolute",
) -> str:
    """Return a robot of two joints, the first of which is odd."""
    a, b, c = (quoteattr(name) for name in links)
    j, k = (quoteattr(name) for name in joints)
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return f"""<robot name="edge"><link name={a}/><link name={b}/><link name={c}/>
      <joint name={j} type="{kind}"><parent link={a}/><child link={b}/><origin xyz="{xyz}" rpy="{rpy}"/>
        <axis xyz="{axis}"/>{limit}</joint>
      <joint name={k} type="{second}"><parent link={b}/><child link={c}/><origin xyz="0 0.5 0"/>
        <axis xyz="0 1 0"/>{limit}</joint></robot>"""


def assert_engines_agree(model: ks.Model) -> None:
    robot = model.robot
    q = ks.random_configurations(robot, 1, (3,))
    qdot = np.random.default_rng(1).uniform(-1, 1, (3, robot.nv)) / max(1, robot.nv)
    for velocity in labels(robot, 1, 9):
        assert_agreement(model, q, velocity, qdot)


# --- counts ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
def test_a_single_link(floating: bool) -> None:
    assert_engines_agree(load_text('<robot name="rock"><link name="rock"/></robot>', floating_base=floating))


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
def test_no_joint_that_moves(floating: bool) -> None:
    assert_engines_agree(load_text(arm(kind="fixed", second="fixed"), floating_base=floating))


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_one_joint_that_moves(kind: str) -> None:
    """A Jacobian of one column, which Pinocchio hands over as a vector."""
    model = load_text(arm(kind=kind, second="fixed"))
    assert_engines_agree(model)
    assert ks.jacobian(model, "c", np.array([0.3]), qdot=np.array([0.5])).certificate.agree is True


def test_a_long_chain() -> None:
    count = 200
    links = "".join(f'<link name="l{i}"/>' for i in range(count + 1))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="0.3 0.2 1"/>'
        '<origin xyz="0.01 0.02 0.1" rpy="0.1 0.2 -0.1"/></joint>'
        for i in range(count)
    )
    model = load_text(f'<robot name="snake">{links}{joints}</robot>')
    q = ks.random_configurations(model.robot, 1)
    found = ks.jacobian(model, f"l{count}", q, relative_to="l50", qdot=np.full(count, 1 / count))
    assert found.certificate.agree is True
    assert found.matrix.shape == (6, count - 50)


# --- names -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["universe", "root_joint", "", " ", "a"], ids=repr)
def test_names_of_joints_that_mean_something_to_pinocchio(name: str) -> None:
    if not name:
        with pytest.raises(ks.StructureError, match="without a name"):
            load_text(arm(joints=(name, "k")))
        return
    for joints in ((name, "k"), ("j", name)):
        assert_engines_agree(load_text(arm(joints=joints)))


@pytest.mark.parametrize("name", ["universe", "root_joint", " ", "j"], ids=repr)
def test_names_of_links_that_mean_something_to_pinocchio(name: str) -> None:
    for links in ((name, "b", "c"), ("a", name, "c"), ("a", "b", name)):
        assert_engines_agree(load_text(arm(links=links)))


def test_a_floating_base_needs_its_two_names() -> None:
    for taken in (arm(links=("universe", "b", "c")), arm(joints=("root_joint", "k"))):
        with pytest.raises(ks.UsageError, match="a floating base needs the name"):
            load_text(taken, floating_base=True)
    assert_engines_agree(load_text(arm(links=("a", "b", "root_joint"), joints=("j", "a")), floating_base=True))


# --- axes ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "axis",
    [
        *("0 0 -1", "-0 -0 -1", "0 0 7", "-1 0 0", "1 1 1", "1e-8 -1e-8 0", "2e-9 0 0", "1e9 1 0", "1e-160 0 1"),
        *("1e-5 0 1", "1e-7 0 1", "1e-12 0 1", "1e-17 1e-17 1"),  # nearly z
        *("1e-5 0 -1", "1e-7 1e-7 -1", "0 1e-8 -1", "1e-12 0 -1", "1e-17 -1e-17 -1"),  # nearly -z
        *("1 5e-12 0", "0 1 -1e-10"),  # nearly x, nearly y
    ],
)
def test_odd_axes(axis: str, kind: str) -> None:
    assert_engines_agree(load_text(arm(kind=kind, axis=axis, rpy="0.3 0.2 0.1")))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("axis", ["1e200 0 1", "1e154 1e154 1e154", "1e308 -1e308 0", "3e300 1 1"])
def test_axes_whose_squares_overflow_are_refused_or_agreed_on(axis: str, kind: str) -> None:
    try:
        model = load_text(arm(kind=kind, axis=axis))
    except ks.NumberError:
        return
    assert_engines_agree(model)


# --- placements ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rpy", ["0 1.5707963267948966 0", "1 -1.5707963267948966 2", "0 1.5708 1", "3.14159 0 -3.1416"]
)
def test_right_angles(rpy: str) -> None:
    assert_engines_agree(load_text(arm(rpy=rpy)))


@pytest.mark.parametrize("xyz", ["0 0 0", "1e-310 0 0", "1e-400 0 0", "+1 .5 5.", "1E1 -1e+1 1e-1", " 1  2\t3\n"])
def test_ways_to_write_a_number(xyz: str) -> None:
    assert_engines_agree(load_text(arm(xyz=xyz)))


@pytest.mark.parametrize("xyz", ["1e6 0 0", "1e-6 2e-6 0", "3e8 -2e8 1e-9", "1e12 1 1"])
def test_sizes_from_insects_to_orbits(xyz: str) -> None:
    assert_engines_agree(load_text(arm(xyz=xyz)))


@pytest.mark.parametrize("pitch", ["0", "1e-12", "-0.5", "300", "-1e6"])
def test_pitches_of_screws(pitch: str) -> None:
    text = arm(axis="1 2 3", rpy="0.1 0.2 0.3").replace(
        '<joint name="j" type="revolute">', '<drake:joint name="j" type="screw">'
    )
    text = text.replace("</joint>", f'<drake:screw_thread_pitch value="{pitch}"/></drake:joint>', 1)
    model = load_text(text)
    for seed in range(3):
        q = ks.random_configurations(model.robot, seed)
        assert ks.fk(model, "c", q).certificate.agree is True
        assert ks.jacobian(model, "c", q, qdot=np.ones(2)).certificate.agree is True


@pytest.mark.parametrize("multiplier", [1e-6, 1e3, -1e6])
def test_followers_that_hardly_move_or_race(multiplier: float) -> None:
    """Two of them, so that one turns what the other moves."""
    follows = f'<mimic joint="j" multiplier="{multiplier}"/>'
    joints = "".join(
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
        f'<origin xyz="1 0 0"/>{law}</joint>'
        for name, parent, child, axis, law in (
            ("j", "a", "b", "0 0 1", ""),
            ("k", "b", "c", "0 1 0", follows),
            ("l", "c", "d", "0.3 1 0.5", follows),
        )
    )
    links = "".join(f'<link name="{name}"/>' for name in "abcd")
    model = load_text(f'<robot name="race">{links}{joints}</robot>')
    for q in np.linspace(-3, 3, 20):
        assert ks.fk(model, "d", np.array([q])).certificate.agree is True
        assert ks.jacobian(model, "d", np.array([q]), qdot=np.ones(1)).certificate.agree is True


# --- masses ----------------------------------------------------------------------------------------------------------


def with_masses(text: str) -> str:
    """Return the arm with a kilogram on its first link, two on its second, four on its third."""
    for name, mass in (("a", 1.0), ("b", 2.0), ("c", 4.0)):
        inertial = f'<inertial><mass value="{mass}"/>{INERTIA}</inertial>'
        text = text.replace(f'<link name="{name}"/>', f'<link name="{name}">{inertial}</link>')
    return text


@pytest.mark.parametrize("name", ["root_joint", "universe"])
def test_masses_of_a_fixed_base_whose_joint_is_called_as_that_of_a_floating_one(name: str) -> None:
    model = load_text(with_masses(arm(joints=(name, "k"))))
    assert tuple(model.engine.masses()) == pytest.approx((1.0, 6.0))
    assert_masses_agree(model)


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("kind", ["fixed", *KINDS, "floating"])
def test_masses_behind_every_joint_type(kind: str, floating: bool) -> None:
    model = load_text(with_masses(arm(kind=kind)), floating_base=floating)
    assert_masses_agree(model)
    # The base is the root link: with a floating base the massless `universe`.
    assert tuple(model.engine.masses()) == pytest.approx((0.0, 7.0) if floating else (1.0, 6.0))


@pytest.mark.parametrize("where", ["a", "b"])
@pytest.mark.parametrize("kind", ["fixed", "revolute"])
@pytest.mark.parametrize(
    "inertial",
    [
        f'<mass value="2"/>{INERTIA}',
        f'<mass value="0"/>{INERTIA}',
        INERTIA,
        '<mass value="2"/>',
        '<mass value="2"/><inertia ixx="1"/>',
        "",
    ],
    ids=["whole", "massless", "no mass", "no inertia", "part of an inertia", "empty"],
)
def test_masses_of_inertials_that_are_not_whole(inertial: str, kind: str, where: str) -> None:
    text = arm(kind=kind).replace(
        f'<link name="{where}"/>', f'<link name="{where}"><inertial>{inertial}</inertial></link>'
    )
    assert_masses_agree(load_text(text))
