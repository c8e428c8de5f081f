"""Motions of links, holding torques, wrenches in joints and gravity stiffness: both engines, and laws that bind them.

A witness of an engine's statics is energy: weights and loads are asked for their power along joint rates, and only
placements, whose derivatives are taken by central differences, are used for that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest

import differences
import kinetostat as ks
from engines.agreement import difference
from kinetostat.conventions import GRAVITY, Load, Velocity
from kinetostat.engines import pinocchio as pinocchio_module
from kinetostat.engines import screw as screw_module
from kinetostat.engines.pinocchio import PinocchioEngine
from kinetostat.engines.protocol import Engine
from kinetostat.engines.screw import ScrewEngine
from kinetostat.screw import so3
from kinetostat.urdf.description import JointType, Mimic, Robot
from kinetostat.urdf.files import example_robots, textbook_robots
from trees import ALL_KINDS, load_text, random_tree

ROBOTS = [
    *(f"textbook:{name}" for name in textbook_robots()),
    *(f"example:{name}" for name in example_robots() if name != "ur_description/ur3"),  # which is empty
]
INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
ONE_COORDINATE = ("revolute", "continuous", "prismatic", "fixed", "screw")
MOST_LINKS = 8  # of a large robot, drawn


# --- what is asked ---------------------------------------------------------------------------------------------------


def some_links(robot: Robot, random: np.random.Generator) -> list[str]:
    names = [link.name for link in robot.links]
    return names if len(names) <= MOST_LINKS else [names[int(k)] for k in random.integers(len(names), size=MOST_LINKS)]


def some_loads(robot: Robot, random: np.random.Generator, batch: tuple[int, ...]) -> list[Load]:
    """Return loads on any links, at any points, in any axes; of one wrench, and of one for each configuration."""

    def name() -> str:
        return robot.links[int(random.integers(len(robot.links)))].name

    def point() -> tuple[float, float, float]:
        x, y, z = random.uniform(-1, 1, 3).tolist()
        return x, y, z

    return [
        Load(Velocity(name(), robot.root, name(), point()), random.normal(size=6)),
        Load(Velocity(name(), robot.root, name(), point()), random.normal(size=(*batch, 6))),
        Load(Velocity(name(), robot.root, name(), None), random.normal(size=6)),
        Load(Velocity(name(), name(), name(), point()), random.normal(size=6)),
    ]


def questions(robot: Robot, seed: int, batch: tuple[int, ...] = (2,)) -> dict[str, Callable[[Engine], np.ndarray]]:
    """Return what is asked of both engines: at random configurations, rates, gravity, loads."""
    random = np.random.default_rng(seed)
    q, links = ks.random_configurations(robot, seed, batch), some_links(robot, random)
    rates, accelerations = random.uniform(-1, 1, (2, *batch, robot.nv)) / max(1, robot.nv)
    gravity, loads = random.uniform(-10, 10, 3), some_loads(robot, random, batch)
    return {
        "link motions": lambda e: e.link_motions(q, rates, accelerations, links),
        "torques of weight": lambda e: e.holding_torques(q, gravity, ()),
        "torques with loads": lambda e: e.holding_torques(q, gravity, loads),
        "torques of loads": lambda e: e.holding_torques(q, np.zeros(3), loads),
        "wrenches of weight": lambda e: e.joint_wrenches(q, gravity, (), links),
        "wrenches with loads": lambda e: e.joint_wrenches(q, gravity, loads, links),
        "stiffness": lambda e: e.gravity_stiffness(q, gravity),
    }


def allowed(robot: Robot, question: str) -> float:
    """Return the largest difference of two engines: 1e-12 of a length, and of a force where there is one."""
    masses = sum(abs(link.inertial.mass) for link in robot.links if link.inertial)
    force = 1.0 if question == "link motions" else max(1.0, 10 * masses)
    return 1e-12 * max(1.0, robot.reach) * robot.largest_multiplier**2 * force


def assert_engines_agree(model: ks.Model, seed: int = 1, batch: tuple[int, ...] = (2,)) -> None:
    apart = {
        name: found
        for name, evaluate in questions(model.robot, seed, batch).items()
        if not (found := difference(model, evaluate)) <= allowed(model.robot, name)
    }
    assert not apart, f"the engines differ: {apart}"


# --- agreement -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("name", ROBOTS)
def test_engines_agree_on_robots(name: str, floating: bool) -> None:
    assert_engines_agree(ks.load(name, floating_base=floating))


@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
@pytest.mark.parametrize("seed", range(60))
def test_engines_agree_on_random_trees(seed: int, floating: bool) -> None:
    assert_engines_agree(random_tree(seed, floating_base=floating), seed)


@pytest.mark.parametrize("kind", ALL_KINDS)
@pytest.mark.parametrize("seed", range(4))
def test_engines_agree_on_trees_of_one_joint_type(kind: str, seed: int) -> None:
    assert_engines_agree(random_tree(seed, kinds=(kind,), most=5), seed)
    assert_engines_agree(random_tree(seed, kinds=(kind, "fixed"), most=1), seed)


@pytest.mark.parametrize("normal", ["1 -2 3", "0 -1 0", "0 0 -1"])
def test_wrenches_beyond_a_plane_that_is_not_x_y(normal: str) -> None:
    """The Pinocchio engine turns the frame of such a joint, and what hangs on it has to be turned back."""
    assert_engines_agree(chain(2.0, 3.0, 1.0, 0.5, kind="planar", axis=normal))


# --- motions of links ------------------------------------------------------------------------------------------------


def moving(seed: int, kinds: tuple[str, ...] = ALL_KINDS) -> tuple[ks.Model, np.ndarray, np.ndarray, np.ndarray]:
    model = random_tree(seed, kinds=kinds, floating_base=seed % 2 == 1, most=6)
    q = ks.random_configurations(model.robot, seed)
    rates, accelerations = np.random.default_rng(seed).uniform(-1, 1, (2, model.robot.nv))
    return model, q, rates, accelerations


def engines(model: ks.Model) -> list[Engine]:
    assert model.witness is not None
    return [model.engine, model.witness]


@pytest.mark.parametrize("seed", range(8))
def test_twists_are_the_rates_of_placements(seed: int) -> None:
    model, q, rates, accelerations = moving(seed)
    links = [link.name for link in model.robot.links]
    for engine in engines(model):
        found = engine.link_motions(q, rates, accelerations, links)[:, 0]
        for link, twist in zip(links, found, strict=True):
            seen = differences.twist(engine, model.robot, q, rates, Velocity(link, model.robot.root, link))
            np.testing.assert_allclose(twist, seen, atol=1e-8 * max(1, model.robot.reach))


@pytest.mark.parametrize("seed", range(8))
def test_accelerations_are_the_rates_of_twists(seed: int) -> None:
    """Of their components in the link's own axes; the path is q + qdot t, its rates qdot + qddot t."""
    model, q, rates, accelerations = moving(seed)
    links = [link.name for link in model.robot.links]

    def twists(engine: Engine, times: np.ndarray) -> np.ndarray:
        path, now = differences.moved(model.robot, q, rates, times), rates + np.outer(times, accelerations)
        return engine.link_motions(path, now, np.zeros_like(now), links)[..., 0, :]

    for engine in engines(model):
        found = engine.link_motions(q, rates, accelerations, links)[:, 1]
        seen = differences.derivative(lambda t, engine=engine: twists(engine, t))
        np.testing.assert_allclose(found, seen, atol=2e-7 * max(1, model.robot.reach) ** 2)


@pytest.mark.parametrize("seed", range(4))
def test_what_rests_stays_at_rest(seed: int) -> None:
    model, q, rates, _ = moving(seed)
    links, still = [link.name for link in model.robot.links], np.zeros(model.robot.nv)
    for engine in engines(model):
        assert not np.any(engine.link_motions(q, still, still, links))  # no gravity hides in an acceleration
        assert not np.any(engine.link_motions(q, rates, rates, [model.robot.root]))


# --- torques ---------------------------------------------------------------------------------------------------------


def energy(engine: Engine, robot: Robot, path: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """Return the potential energy of all links along a path (k, nq). (k,)."""
    total = np.zeros(len(path))
    for link in robot.links:
        if link.inertial is not None:
            placement = engine.placement(path, link.name, robot.root)
            centre = placement[:, :3, :3] @ np.array(link.inertial.origin.xyz) + placement[:, :3, 3]
            total -= link.inertial.mass * centre @ gravity
    return total


@pytest.mark.parametrize("seed", range(10))
def test_torques_against_gravity_are_the_gradient_of_energy(seed: int) -> None:
    model, q, _, _ = moving(seed)
    gravity = np.random.default_rng(seed).uniform(-10, 10, 3)
    for engine in engines(model):
        found = engine.holding_torques(q, gravity, ())
        for unit, torque in zip(np.eye(model.robot.nv), found, strict=True):
            slope = differences.derivative(
                lambda t, engine=engine, unit=unit: energy(
                    engine, model.robot, differences.moved(model.robot, q, unit, t), gravity
                )
            )
            assert torque == pytest.approx(slope, abs=1e-8 * max(1, allowed(model.robot, "") * 1e12))


@pytest.mark.parametrize("seed", range(10))
def test_loads_cost_the_power_that_they_give(seed: int) -> None:
    model, q, rates, _ = moving(seed)
    random = np.random.default_rng(seed)
    loads = [load for load in some_loads(model.robot, random, ()) if load.at.relative_to == model.robot.root]
    for engine in engines(model):
        found = engine.holding_torques(q, np.zeros(3), loads) @ rates
        given = sum(float(load.wrench @ differences.twist(engine, model.robot, q, rates, load.at)) for load in loads)
        assert found == pytest.approx(given, abs=1e-7 * max(1, model.robot.reach))


@pytest.mark.parametrize("seed", range(6))
def test_torques_are_linear_in_weight_and_loads(seed: int) -> None:
    model, q, _, _ = moving(seed)
    random = np.random.default_rng(seed)
    loads, gravity = some_loads(model.robot, random, ()), random.uniform(-10, 10, 3)
    doubled = [replace(load, wrench=2 * load.wrench) for load in loads]
    for engine in engines(model):
        one, two = engine.holding_torques(q, gravity, loads), engine.holding_torques(q, 2 * gravity, doubled)
        np.testing.assert_allclose(two, 2 * one, atol=allowed(model.robot, ""))
        apart = engine.holding_torques(q, gravity, ()) + sum(
            engine.holding_torques(q, np.zeros(3), [load]) for load in loads
        )
        np.testing.assert_allclose(one, apart, atol=allowed(model.robot, ""))


def test_gravity_of_one_question_is_forgotten_in_the_next() -> None:
    """The Pinocchio engine keeps gravity in its model."""
    model = ks.load("example:panda")
    q = ks.random_configurations(model.robot, 1)
    for engine in engines(model):
        before = engine.holding_torques(q, np.array(GRAVITY), ())
        engine.gravity_stiffness(q, np.array([3.0, 0, 0]))
        engine.joint_wrenches(q, np.array([0, 5.0, 0]), (), ["panda_hand"])
        np.testing.assert_array_equal(engine.holding_torques(q, np.array(GRAVITY), ()), before)
        assert not np.any(engine.link_motions(q, np.zeros(model.robot.nv), np.zeros(model.robot.nv), ["panda_hand"]))


# --- wrenches in joints ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(10))
def test_torques_are_what_joints_feel_of_their_wrenches(seed: int) -> None:
    """Along its axis a joint has nothing but its motor to hold with; a leader's motor holds its followers, too."""
    model, q, _, _ = moving(seed, ONE_COORDINATE)
    robot, random = model.robot, np.random.default_rng(seed)
    loads, gravity = some_loads(robot, random, ()), random.uniform(-10, 10, 3)
    joints = [joint for joint in robot.joints if joint.type is not JointType.FIXED]
    for engine in engines(model):
        felt = np.zeros(robot.nv)
        for joint in joints:
            (wrench,) = engine.joint_wrenches(q, gravity, loads, [joint.child])
            force, moment = wrench[:3] @ joint.axis, wrench[3:] @ joint.axis
            own = force if joint.type is JointType.PRISMATIC else moment + joint.pitch / (2 * np.pi) * force
            law = robot.followers.get(joint.name, Mimic(joint.name))
            felt[robot.velocity_slices[law.joint]] += (
                wrench if joint.type is JointType.FLOATING else law.multiplier * own
            )
        found = engine.holding_torques(q, gravity, loads)
        np.testing.assert_allclose(found, felt, atol=allowed(robot, ""))


@pytest.mark.parametrize("seed", range(10))
def test_the_ground_holds_all_weight_and_all_loads(seed: int) -> None:
    model, q, _, _ = moving(seed)
    robot, random = model.robot, np.random.default_rng(seed)
    loads, gravity = some_loads(robot, random, ()), random.uniform(-10, 10, 3)
    for engine in engines(model):
        force, moment = np.zeros(3), np.zeros(3)
        for link in robot.links:
            if link.inertial is not None:
                placement = engine.placement(q, link.name, robot.root)
                centre = placement[:3, :3] @ np.array(link.inertial.origin.xyz) + placement[:3, 3]
                force -= link.inertial.mass * gravity
                moment -= np.cross(centre, link.inertial.mass * gravity)
        for load in loads:
            axes = engine.placement(q, load.at.expressed_in, robot.root)[:3, :3]
            carrier = load.at.relative_to if load.at.point is None else load.at.of
            placement = engine.placement(q, carrier, robot.root)
            point = placement[:3, :3] @ np.array(load.at.point or (0, 0, 0)) + placement[:3, 3]
            force += axes @ load.wrench[:3]
            moment += axes @ load.wrench[3:] + np.cross(point, axes @ load.wrench[:3])
        (found,) = engine.joint_wrenches(q, gravity, loads, [robot.root])
        np.testing.assert_allclose(found, np.concatenate([force, moment]), atol=allowed(robot, ""))


def test_a_leaf_feels_its_own_weight_and_load_alone() -> None:
    model = ks.load("example:panda")
    q = ks.random_configurations(model.robot, 3)
    load = Load(Velocity("panda_hand", "panda_link0", "panda_hand"), np.arange(6.0))
    for engine in engines(model):
        beyond = engine.joint_wrenches(q, np.zeros(3), [load], ["panda_leftfinger", "panda_hand", "panda_link0"])
        assert not np.any(beyond[0])
        np.testing.assert_allclose(beyond[1], np.arange(6.0), atol=1e-15)
        # Carried to the base, a wrench keeps the sizes of its force and of its pitch f . m.
        assert np.linalg.norm(beyond[2, :3]) == pytest.approx(np.linalg.norm([0.0, 1, 2]), abs=1e-14)
        assert beyond[2, :3] @ beyond[2, 3:] == pytest.approx(np.dot([0.0, 1, 2], [3, 4, 5]), abs=1e-13)


# --- stiffness -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(16))
def test_stiffness_is_the_derivative_of_torques(seed: int) -> None:
    """Along any coordinate, also those of planar and floating joints: along their body twists."""
    model, q, _, _ = moving(seed)
    robot, gravity = model.robot, np.random.default_rng(seed).uniform(-10, 10, 3)
    for engine in engines(model):
        found = engine.gravity_stiffness(q, gravity)
        for unit, column in zip(np.eye(robot.nv), found.T, strict=True):
            seen = differences.derivative(
                lambda t, engine=engine, unit=unit: engine.holding_torques(
                    differences.moved(robot, q, unit, t), gravity, ()
                )
            )
            np.testing.assert_allclose(column, seen, atol=1e-8 * max(1, allowed(robot, "") * 1e12))


@pytest.mark.parametrize("seed", range(16))
def test_stiffness_is_symmetric_where_coordinates_are_numbers(seed: int) -> None:
    """It is the second derivative of an energy there. Turns of a floating joint do not commute, and are left out."""
    model = random_tree(seed, kinds=ONE_COORDINATE)
    q = ks.random_configurations(model.robot, seed)
    for engine in engines(model):
        found = engine.gravity_stiffness(q, np.array([1.0, -2, -9]))
        np.testing.assert_allclose(found, found.T, atol=allowed(model.robot, ""))


def test_a_hanging_pendulum_is_stable_and_an_upright_one_is_not() -> None:
    model = chain(0.0, 2.0, axis="0 1 0", origin="0 0 0", rpy="0 0 0", centre="0 0 -0.5")
    for engine in engines(model):
        found = engine.gravity_stiffness(np.array([[0.0], [np.pi], [np.pi / 2]]), np.array(GRAVITY))
        np.testing.assert_allclose(found[:, 0, 0], [9.81, -9.81, 0], atol=1e-14)


# --- edges -----------------------------------------------------------------------------------------------------------


def link(name: str, mass: float | str | None, centre: str) -> str:
    """Return a link with a mass, with an inertial as it is written, or with none."""
    if mass is None or isinstance(mass, str):
        return f'<link name="{name}">{mass or ""}</link>'
    origin = f'<origin xyz="{centre}" rpy="1 2 3"/>'
    return f'<link name="{name}"><inertial>{origin}<mass value="{mass!r}"/>{INERTIA}</inertial></link>'


def chain(
    *masses: float | str | None,
    kind: str = "revolute",
    axis: str = "0.1 1 0.3",
    origin: str = "0.3 0.2 0.1",
    rpy: str = "0.1 0.2 0.3",
    centre: str = "0.1 0.2 0.3",
    every: int = 2,
    floating_base: bool = False,
) -> ks.Model:
    """Return links in a row: one joint in `every` moves, the others are fixed."""
    links = "".join(link(f"l{i}", mass, centre) for i, mass in enumerate(masses))
    joints = "".join(
        f'<joint name="j{i}" type="{"fixed" if i % every else kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="{origin}" rpy="{rpy}"/><axis xyz="{axis}"/>'
        '<limit lower="-4" upper="4" effort="1" velocity="1"/></joint>'
        for i in range(len(masses) - 1)
    )
    return load_text(f'<robot name="chain">{links}{joints}</robot>', floating_base=floating_base)


@pytest.mark.parametrize("batch", [(), (0,), (2, 3), (2, 0)])
@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("floating", [False, True], ids=["fixed base", "floating base"])
def test_robots_without_joints_and_with_one(count: int, floating: bool, batch: tuple[int, ...]) -> None:
    for kind in ("fixed", "revolute"):
        model = chain(*[2.0] * count, kind=kind, floating_base=floating)
        assert_engines_agree(model, batch=batch)


@pytest.mark.parametrize("batch", [(0,), (3, 0)])
def test_an_empty_batch_keeps_its_shape(batch: tuple[int, ...]) -> None:
    model = ks.load("example:panda")
    q, rates, gravity = np.zeros((*batch, 8)), np.zeros((*batch, 8)), np.array(GRAVITY)
    for engine in engines(model):
        assert engine.link_motions(q, rates, rates, ["panda_hand"] * 3).shape == (*batch, 3, 2, 6)
        assert engine.holding_torques(q, gravity, ()).shape == (*batch, 8)
        assert engine.joint_wrenches(q, gravity, (), ["panda_hand"] * 3).shape == (*batch, 3, 6)
        assert engine.gravity_stiffness(q, gravity).shape == (*batch, 8, 8)


def test_no_links_and_no_loads() -> None:
    model = ks.load("example:panda")
    q = ks.random_configurations(model.robot, 1, (2,))
    for engine in engines(model):
        assert engine.link_motions(q, q, q, []).shape == (2, 0, 2, 6)
        assert engine.joint_wrenches(q, np.array(GRAVITY), (), []).shape == (2, 0, 6)
        assert not np.any(engine.holding_torques(q, np.zeros(3), ()))


def test_shapes_of_configurations_rates_and_loads_go_together() -> None:
    model = ks.load("textbook:puma560")
    q = ks.random_configurations(model.robot, 1, (3, 1))
    rates, wrench = np.random.default_rng(1).normal(size=(4, 6)), np.random.default_rng(2).normal(size=(2, 1, 4, 6))
    tip = model.robot.default_tip()
    load = Load(Velocity(tip, model.robot.root, tip), wrench)
    for engine in engines(model):
        assert engine.link_motions(q, rates, rates[0], [tip]).shape == (3, 4, 1, 2, 6)
        many = engine.holding_torques(q, np.array(GRAVITY), [load])
        assert many.shape == (2, 3, 4, 6)
        one = engine.holding_torques(q[2, 0], np.array(GRAVITY), [replace(load, wrench=wrench[1, 0, 3])])
        np.testing.assert_allclose(many[1, 2, 3], one, atol=1e-13)
        assert engine.joint_wrenches(q, np.array(GRAVITY), [load], [tip]).shape == (2, 3, 4, 1, 6)


NO_MASS = f'<inertial><origin xyz="1 1 1"/>{INERTIA}</inertial>'
NO_INERTIA = '<inertial><origin xyz="1 1 1"/><mass value="3"/></inertial>'
PART = '<inertial><origin xyz="1 1 1"/><mass value="3"/><inertia ixx="1"/></inertial>'
NO_MOMENTS = NO_INERTIA.replace("</inertial>", INERTIA.replace('"1"', '"0"') + "</inertial>")
MASSES: dict[str, tuple[float | str | None, ...]] = {
    "none": (None, None, None, None),
    "zero": (0.0, 0.0, 0.0, 0.0),
    "zero and not": (0.0, 2.0, 0.0, 3.0, 0.0),
    "without a mass": (1.0, NO_MASS, 2.0, NO_MASS),
    "without an inertia": (1.0, NO_INERTIA, NO_INERTIA, 2.0),
    "with a part of one": (1.0, PART, 2.0, PART, PART),
    "without moments": (1.0, NO_MOMENTS, 2.0, NO_MOMENTS),
    "huge and small": (1e9, 1.0, 1e-9, 1e9, 1.0, 1e-9),
    "tiny": (1e-12, 1e-15, 1e-12, 1e-12),
    "below zero, less than what they are fixed to": (1.0, 3.0, -2.0, 5.0, -1.0),
}


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic", "planar", "floating"])
@pytest.mark.parametrize("name", MASSES)
def test_masses_at_the_edges(name: str, kind: str) -> None:
    for floating in (False, True):
        assert_engines_agree(chain(*MASSES[name], kind=kind, axis="0 0 1", floating_base=floating))


@pytest.mark.parametrize("masses", [(1.0, -2.0, 3.0), (0.0, -1.0, -1.0), (1.0, -1.0, 2.0)])
def test_masses_below_zero_are_never_agreed_on_by_chance(masses: tuple[float, ...]) -> None:
    """Ours takes them as they are; Pinocchio divides by them and loses the centre of mass: that has to be seen."""
    model = chain(*masses, every=1)
    q, gravity = ks.random_configurations(model.robot, 1), np.array(GRAVITY)
    right, other = model.witness, model.engine
    assert right is not None
    found = right.holding_torques(q, gravity, ())
    slopes = [
        differences.derivative(
            lambda t, unit=unit: energy(right, model.robot, differences.moved(model.robot, q, unit, t), gravity)
        )
        for unit in np.eye(model.robot.nv)
    ]
    np.testing.assert_allclose(found, slopes, atol=1e-7)
    apart = float(np.max(np.abs(other.holding_torques(q, gravity, ()) - found)))
    assert apart <= allowed(model.robot, "") or apart > 1e-3


def test_an_inertial_that_is_not_whole_counts_for_nothing() -> None:
    whole, less = chain(1.0, PART, 2.0, NO_MASS), chain(1.0, None, 2.0, None)
    q = ks.random_configurations(whole.robot, 1)
    for first, second in zip(engines(whole), engines(less), strict=True):
        np.testing.assert_array_equal(
            first.holding_torques(q, np.array(GRAVITY), ()), second.holding_torques(q, np.array(GRAVITY), ())
        )


def test_a_chain_of_400_links() -> None:
    assert_engines_agree(chain(*[1.0] * 400, origin="0.01 0.02 0.1", every=2), batch=())


def test_300_degrees_of_freedom() -> None:
    model = chain(*[1.0] * 301, origin="0.01 0.02 0.1", every=1)
    assert model.robot.nv == 300
    assert_engines_agree(model, batch=())


# --- planted bugs ----------------------------------------------------------------------------------------------------

Plant = Callable[[pytest.MonkeyPatch], None]

VICTIM_KINDS = ("revolute", "prismatic", "planar", "floating", "revolute", "fixed", "continuous")


def victim() -> ks.Model:
    """Return links in a row by joints of many kinds, one of which follows another; nothing about them is special."""
    follows = '<mimic joint="j0" multiplier="-0.6"/>'
    links = "".join(link(f"l{i}", 1.0 + 0.3 * i, "0.1 -0.2 0.3") for i in range(len(VICTIM_KINDS) + 1))
    joints = "".join(
        f'<joint name="j{i}" type="{kind}"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="0.3 0.2 -0.1" rpy="0.4 -0.5 0.{i}"/><axis xyz="0.2 0.{i + 1} 0.7"/>'
        f'<limit lower="-1" upper="1" effort="1" velocity="1"/>{follows if i == 4 else ""}</joint>'
        for i, kind in enumerate(VICTIM_KINDS)
    )
    return load_text(f'<robot name="victim">{links}{joints}</robot>')


class Changed:
    """A module with some of its attributes replaced."""

    def __init__(self, original: Any, **changes: Any) -> None:
        self._original, self._changes = original, changes

    def __getattr__(self, name: str) -> Any:
        return self._changes[name] if name in self._changes else getattr(self._original, name)


def _of(owner: Any, name: str, change: Callable[..., Any]) -> Plant:
    """Return what changes an attribute: `change` takes the original and what it is called with."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = getattr(owner, name)
        patch.setattr(owner, name, lambda *arguments: change(original, *arguments))

    return plant


def _of_pin(name: str, change: Callable[..., Any]) -> Plant:
    pin = pinocchio_module.pin
    return lambda patch: patch.setattr(
        pinocchio_module,
        "pin",
        Changed(pin, **{name: lambda *arguments: change(getattr(pin, name), *arguments)}),
    )


def _without_cross(module: Any) -> Plant:
    return lambda patch: patch.setattr(module, "np", Changed(np, cross=lambda a, b: np.zeros_like(np.add(a, b))))


def _plane_taken_for_x_y(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(so3, "carry_z_to", lambda axis: np.eye(3))


def _wrenches_without_what_lies_beyond(original: Any, self: Any, q: Any, gravity: Any, loads: Any, links: Any) -> Any:
    return original(self, q, gravity, (), links)


def _gravity_upwards(original: Any, self: Any, *arguments: Any) -> Any:
    q, gravity, *others = arguments
    return original(self, q, -np.asarray(gravity), *others)


METHODS = {"torques of weight", "torques with loads", "wrenches of weight", "wrenches with loads", "stiffness"}
LOADED = {"torques with loads", "torques of loads", "wrenches with loads"}
BUGS: dict[str, tuple[Plant, set[str]]] = {
    "screw: a multiplier is forgotten": (
        _of(ScrewEngine, "_columns_of", lambda f, self, joint: (f(self, joint)[0], 1.0)),
        {"link motions", "torques of weight", "torques of loads", "stiffness"},
    ),
    "screw: brackets are forgotten": (
        lambda patch: patch.setattr(screw_module, "bracket", lambda a, b: np.zeros_like(a)),
        {"link motions"},
    ),
    "screw: brackets have the other sign": (_of(screw_module, "bracket", lambda f, a, b: -f(a, b)), {"link motions"}),
    "screw: a plane is x-y": (_plane_taken_for_x_y, {"link motions", *METHODS}),
    "screw: forces have no moments": (
        _of(screw_module, "_through", lambda f, point, force: f(np.zeros_like(point), force)),
        METHODS - {"stiffness"} | LOADED,
    ),
    "screw: no cross products": (_without_cross(screw_module), METHODS),
    "screw: wrenches are carried as twists are": (
        lambda patch: patch.setattr(screw_module, "coadjoint", screw_module.adjoint),
        {"wrenches of weight", "wrenches with loads"},
    ),
    "screw: a load is through the frame's origin": (
        _of(ScrewEngine, "_point", lambda f, self, places, at: f(self, places, replace(at, point=(0.0, 0.0, 0.0)))),
        LOADED,
    ),
    "screw: a load is in the root's axes": (
        _of(
            ScrewEngine,
            "_held",
            lambda f, self, places, gravity, loads: f(self, places, gravity, _in_root(self, loads)),
        ),
        LOADED,
    ),
    "screw: masses beyond are forgotten": (
        _of(ScrewEngine, "_masses_beyond", lambda f, self, places: _own_masses(f(self, places))),
        {"stiffness"},
    ),
    "pinocchio: accelerations in the world": (
        _of_pin("getFrameAcceleration", lambda f, m, d, i, r: f(m, d, i, pinocchio_module.pin.WORLD)),
        {"link motions"},
    ),
    "pinocchio: velocities in the world's axes": (
        _of_pin("getFrameVelocity", lambda f, m, d, i, r: f(m, d, i, pinocchio_module.pin.LOCAL_WORLD_ALIGNED)),
        {"link motions"},
    ),
    "pinocchio: classical accelerations": (
        lambda patch: patch.setattr(
            pinocchio_module,
            "pin",
            Changed(pinocchio_module.pin, getFrameAcceleration=pinocchio_module.pin.getFrameClassicalAcceleration),
        ),
        {"link motions"},
    ),
    "pinocchio: loads push the other way": (
        _of(PinocchioEngine, "_exerted", lambda f, self, load, wrench: -f(self, load, wrench)),
        LOADED,
    ),
    "pinocchio: a load is through the frame's origin": (
        _of(PinocchioEngine, "_point", lambda f, self, at: f(self, replace(at, point=(0.0, 0.0, 0.0)))),
        LOADED,
    ),
    "pinocchio: a load is carried by its link alone": (
        _of(PinocchioEngine, "_carriers", lambda f, self, name: {self._frame(name)}),
        {"wrenches with loads"},
    ),
    "pinocchio: centres of mass are at the frames' origins": (
        _of(PinocchioEngine, "_beyond", lambda f, self: (f(self)[0], f(self)[1] * 0)),
        {"wrenches of weight", "wrenches with loads"},
    ),
    "pinocchio: loads are forgotten": (
        _of(PinocchioEngine, "joint_wrenches", _wrenches_without_what_lies_beyond),
        {"wrenches with loads"},
    ),
    "pinocchio: gravity pulls upwards in torques": (
        _of(PinocchioEngine, "holding_torques", _gravity_upwards),
        {"torques of weight", "torques with loads"},
    ),
    "pinocchio: gravity pulls upwards in wrenches": (
        _of(PinocchioEngine, "joint_wrenches", _gravity_upwards),
        {"wrenches of weight", "wrenches with loads"},
    ),
    "pinocchio: gravity pulls upwards in the stiffness": (
        _of(PinocchioEngine, "gravity_stiffness", _gravity_upwards),
        {"stiffness"},
    ),
}


def _in_root(engine: Any, loads: Any) -> list[Load]:
    return [replace(load, at=replace(load.at, expressed_in=engine._robot.root)) for load in loads]


def _own_masses(found: tuple[dict[str, float], dict[str, np.ndarray]]) -> tuple[dict[str, float], Any]:
    return dict.fromkeys(found[0], 1.0), found[1]


@lru_cache(maxsize=1)
def _asked() -> dict[str, Callable[[Engine], np.ndarray]]:
    return questions(victim().robot, 3)


def _seen() -> set[str]:
    """Return the questions on which the engines of a newly built model differ far beyond the tolerance."""
    model = victim()
    return {name for name, evaluate in _asked().items() if not difference(model, evaluate) < 1e-6}


def test_without_a_bug_nothing_is_seen() -> None:
    assert _seen() == set()
    assert_engines_agree(victim())


@pytest.mark.parametrize("name", BUGS)
def test_a_bug_in_one_engine_is_seen(name: str) -> None:
    plant, questions_hurt = BUGS[name]
    with pytest.MonkeyPatch.context() as patch:
        plant(patch)
        found = _seen()
    assert questions_hurt <= found
    assert _seen() == set()


def test_a_number_read_wrong_by_pinocchio_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    original = pinocchio_module._build
    monkeypatch.setattr(
        pinocchio_module,
        "_build",
        lambda text, floating: original(text.replace('value="1.6"', 'value="1.60001"'), floating),
    )
    assert _seen() >= METHODS
