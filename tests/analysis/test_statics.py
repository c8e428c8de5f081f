"""Laws of holding torques and reactions: power, potential energy, weight, links cut free; on trees and real robots."""

from functools import cache, lru_cache

import numpy as np
import pytest

import kinetostat as ks
from differences import derivative, moved
from kinetostat.urdf.files import example_robots, textbook_robots
from trees import load_text, random_tree

TREES = [(seed, seed % 3 == 0) for seed in range(600, 616)]
REAL = [f"example:{name}" for name in example_robots() if name != "ur_description/ur3"]
REAL += [f"textbook:{name}" for name in textbook_robots()]
SKEW = np.array([1.5, -3.0, -8.0])  # gravity along no axis
WITNESSED = 2e-10  # of a six-point difference's size
AGREED = 1e-9


@cache
def tree(seed, floating=False):
    return random_tree(seed, floating_base=floating)


@lru_cache(maxsize=2)
def real(source, floating=False):
    return ks.load(source, floating_base=floating)


def asked(model, q, *wrenches, **words):
    """Return torques on which both engines agree."""
    result = ks.torque(model, q, wrenches, **words)
    assert result.certificate.engines == ("pinocchio", "screw")
    assert result.certificate.agree, result.certificate
    return result


def held(model, q, result):
    """Return reactions on which both engines agree."""
    found = ks.reactions(model, q, result)
    assert found.certificate.agree, found.certificate
    return found


def masses(robot):
    return {link.name: link.inertial.mass for link in robot.links if link.inertial is not None}


def centres(model, q, engine=None):
    """Return the centres of mass (..., k, 3) in the root's axes, of the links that have a mass."""
    engine, robot, found = engine or model.engine, model.robot, []
    for name in masses(robot):
        placement = engine.placement(q, name, robot.root)
        local = np.array(robot.link_by_name[name].inertial.origin.xyz)
        found.append(placement[..., :3, :3] @ local + placement[..., :3, 3])
    return np.stack(found, -2) if found else np.zeros((*np.shape(q)[:-1], 0, 3))


def energy(model, q, gravity, engine=None):
    """Return the potential energy of the links in J."""
    weights = np.outer(list(masses(model.robot).values()), gravity)
    return -np.sum(weights * centres(model, q, engine), axis=(-1, -2))


def size_of(model, q, gravity):
    """Return the size that errors of torques are measured by: weight times lever."""
    weight = sum(masses(model.robot).values()) * np.linalg.norm(gravity)
    slid = float(np.max(np.abs(q), initial=1.0))
    return max(1.0, weight) * max(1.0, model.robot.reach + slid) * model.robot.largest_multiplier


def loads_of(model, seed, count=3):
    """Return random wrenches at random points of random links, in the axes of others; one about the root's origin."""
    random, names = np.random.default_rng(seed), [link.name for link in model.robot.links]
    found = []
    for i in range(count):
        link, axes = (names[int(k)] for k in random.integers(len(names), size=2))
        point = "world" if i == 0 else random.uniform(-1, 1, 3)
        found.append(ks.load_at(model, link, random.uniform(-5, 5, 6), axes=axes, point=point))
    return found


# --- wrenches


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_power_of_torques_is_power_of_wrenches(seed, floating):
    model = tree(seed, floating)
    q, loads = ks.random_configurations(model, seed), loads_of(model, seed)
    result = asked(model, q, *loads)
    for rates in np.random.default_rng(seed).uniform(-1, 1, (3, model.robot.nv)):
        power = 0.0
        for load in loads:
            twist = ks.jacobian(
                model,
                load.at.of,
                q,
                relative_to=load.at.relative_to,
                expressed_in=load.at.expressed_in,
                joints="all",
                **({"reference": "world"} if load.at.point is None else {"point": load.at.point}),
            )
            power += load.wrench @ twist.matrix @ rates
        assert np.isclose(result.torques @ rates, power, rtol=0, atol=1e-10 * size_of(model, q, [10, 0, 0]))
    assert np.array_equal(result.total, result.torques + result.gravity + result.from_payload)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_power_of_a_force_is_that_of_its_point_differenced(seed, floating):
    model = tree(seed, floating)
    q, random = ks.random_configurations(model, seed), np.random.default_rng(seed)
    link, point, force = model.robot.links[-1].name, random.uniform(-1, 1, 3), random.uniform(-5, 5, 3)
    result = asked(model, q, ks.load_at(model, link, [*force, 0, 0, 0], point=point))
    rates = random.uniform(-1, 1, model.robot.nv) / max(1, model.robot.nv)

    def height(times):
        placement = model.engine.placement(moved(model.robot, q, rates, times), link, model.robot.root)
        return (placement[:, :3, :3] @ point + placement[:, :3, 3]) @ force

    assert np.isclose(result.torques @ rates, derivative(height), rtol=0, atol=WITNESSED * 10 * size_of(model, q, [10]))


@pytest.mark.parametrize(("seed", "floating"), TREES[:6])
def test_wrenches_on_the_robot_are_held_with_the_opposite_torques(seed, floating):
    model = tree(seed, floating)
    q, loads = ks.random_configurations(model, seed), loads_of(model, seed)
    exerted, borne = asked(model, q, *loads), asked(model, q, *loads, on="robot")
    assert np.allclose(borne.torques, -exerted.torques, rtol=0, atol=1e-12 * size_of(model, q, [10]))
    assert borne.loads == exerted.loads


@pytest.mark.parametrize(("seed", "floating"), TREES[:6])
def test_torques_are_linear_in_wrenches_gravity_and_payload(seed, floating):
    model = tree(seed, floating)
    q, (first, second, _) = ks.random_configurations(model, seed), loads_of(model, seed)
    payload, size = ks.Payload(1.5, model.robot.links[-1].name, (0.1, 0.2, -0.3)), size_of(model, q, SKEW)
    together = asked(model, q, first, second, gravity=SKEW, payload=payload)
    apart = asked(model, q, first).total + asked(model, q, second).total + asked(model, q, gravity=SKEW).total
    doubled = ks.Payload(3.0, payload.frame, payload.point)
    from_payload = asked(model, q, gravity=SKEW, payload=doubled).from_payload
    assert np.allclose(together.total, apart + from_payload / 2, rtol=0, atol=1e-11 * size)
    assert np.allclose(asked(model, q, gravity=-2 * SKEW).gravity, -2 * together.gravity, rtol=0, atol=1e-11 * size)


def test_a_payload_is_the_force_that_holds_it_up():
    model = real("example:panda")
    q, at = ks.configuration(model, "default").q, (0.1, 0.0, 0.2)
    payload = asked(model, q, payload=ks.Payload(2.0, "panda_hand", at))  # down the root's z where no gravity is given
    force = asked(model, q, ks.load_at(model, "panda_hand", [0, 0, 2 * 9.81, 0, 0, 0], point=at))
    assert np.allclose(payload.total, force.total, rtol=0, atol=1e-12)
    assert not np.any(payload.gravity)
    assert not np.any(asked(model, q, payload=ks.Payload(0.0, "panda_hand")).total)
    on_robot = asked(model, q, payload=ks.Payload(2.0, "panda_hand", at), on="robot")
    assert np.array_equal(on_robot.total, payload.total)  # --on is about the given wrenches alone


def test_batches_are_their_configurations_one_by_one():
    model = tree(600, floating=True)
    q = ks.random_configurations(model, 3, (2, 4))
    loads = [*loads_of(model, 1), ks.load_at(model, model.robot.root, np.zeros(6))]
    whole = asked(model, q, *loads, gravity=SKEW)
    found = held(model, q, whole)
    assert whole.total.shape == (2, 4, model.robot.nv)
    assert found.local.shape == (2, 4, len(model.robot.links), 6)
    for i in np.ndindex(2, 4):
        one = asked(model, q[i], *loads, gravity=SKEW)
        assert np.allclose(whole.total[i], one.total, rtol=0, atol=1e-10)
        assert np.allclose(found.base[i], held(model, q[i], one).base, rtol=0, atol=1e-10)


def test_wrenches_may_be_a_batch_of_one_configuration_each():
    model = real("textbook:planar_2r")
    q = ks.random_configurations(model, 3, (5,))
    wrenches = np.random.default_rng(0).uniform(-1, 1, (5, 6))
    whole = asked(model, q, ks.load_at(model, "tool", wrenches))
    for i in range(5):
        assert np.allclose(whole.total[i], asked(model, q[i], ks.load_at(model, "tool", wrenches[i])).total, atol=1e-13)


def test_an_empty_batch_is_empty():
    model = real("textbook:planar_2r")
    result = asked(model, np.zeros((0, 2)), ks.load_at(model, "tool", np.ones(6)), gravity=True)
    assert result.total.shape == result.utilisation.shape == (0, 2)
    assert result.binding.shape == (0,)


def test_a_robot_without_joints_needs_no_torques_but_is_borne():
    link = '<link name="block"><inertial><mass value="3"/><origin xyz="1 0 0"/>'
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    model = load_text(f'<robot name="still">{link}{inertia}</robot>')
    result = asked(model, np.zeros(0), gravity=True)
    assert result.total.shape == (0,)
    assert (result.binding_joint, int(result.binding)) == (None, -1)
    found = held(model, np.zeros(0), result)
    assert np.allclose(found.local, [[0, 0, 29.43, 0, -29.43, 0]], rtol=0, atol=1e-12)
    assert found.residual == 0


# --- gravity is the gradient of the potential energy


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_gravity_of_a_tree_is_the_gradient_of_its_potential_energy(seed, floating):
    model = tree(seed, floating)
    for q in (ks.random_configurations(model, seed), ks.configuration(model, "zero").q):
        assert_gradients(model, q, SKEW, seed)


@pytest.mark.parametrize("source", REAL)
def test_gravity_of_a_real_robot_is_the_gradient_of_its_potential_energy(source):
    model = real(source)
    assert_gradients(model, ks.random_configurations(model, 5), SKEW, 5)


@pytest.mark.parametrize("source", ["example:panda", "example:solo12", "example:pr2", "textbook:helical"])
def test_gravity_on_a_floating_base_is_the_gradient_too(source):
    model = real(source, floating=True)
    assert_gradients(model, ks.random_configurations(model, 5), SKEW, 5)


def assert_gradients(model, q, gravity, seed):
    """Check both engines: torques against the energy, stiffness against the torques, each along random rates."""
    nv, size = model.robot.nv, size_of(model, q, gravity)
    both = [engine.holding_torques(q, gravity, ()) for engine in (model.engine, model.witness)]
    assert np.max(np.abs(both[0] - both[1]), initial=0.0) <= AGREED * max(1.0, np.max(np.abs(both[0]), initial=0.0))
    for rates in np.random.default_rng(seed).uniform(-1, 1, (2, nv)) / max(1, nv):
        slope = derivative(lambda t, rates=rates: energy(model, moved(model.robot, q, rates, t), gravity))
        for engine, torques in zip((model.engine, model.witness), both, strict=True):
            assert np.isclose(torques @ rates, slope, rtol=0, atol=WITNESSED * size)
            change = derivative(
                lambda t, engine=engine, rates=rates: engine.holding_torques(
                    moved(model.robot, q, rates, t), gravity, ()
                )
            )
            stiffness = engine.gravity_stiffness(q, gravity)
            assert stiffness.shape == (nv, nv)
            assert np.allclose(stiffness @ rates, change, rtol=0, atol=WITNESSED * size)


@pytest.mark.parametrize("source", ["example:panda", "example:allegro_left_hand", "textbook:scara"])
def test_the_stiffness_of_single_coordinates_is_symmetric_in_both_engines(source):
    model = real(source)
    q = ks.random_configurations(model, 7, (3,))
    stiff = [engine.gravity_stiffness(q, SKEW) for engine in (model.engine, model.witness)]
    assert np.allclose(stiff[0], np.swapaxes(stiff[0], -1, -2), rtol=0, atol=1e-11)
    assert np.allclose(*stiff, rtol=0, atol=1e-11)


def test_gravity_is_none_true_or_a_vector():
    model = real("example:ur5_robot")
    q = ks.configuration(model, "random:1").q
    assert not np.any(asked(model, q).total)
    assert np.array_equal(asked(model, q, gravity=True).total, asked(model, q, gravity=(0, 0, -9.81)).total)
    assert not np.any(asked(model, q, gravity=False).total)
    assert not np.any(asked(model, q, gravity=(0, 0, 0)).total)


# --- reactions


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_the_ground_bears_the_weight_and_the_wrenches(seed, floating):
    model = tree(seed, floating)
    q, random = ks.random_configurations(model, seed), np.random.default_rng(seed)
    link, point, force = model.robot.links[-1].name, random.uniform(-1, 1, 3), random.uniform(-5, 5, 3)
    result = asked(model, q, ks.load_at(model, link, [*force, 0, 0, 0], point=point), gravity=SKEW)
    found = held(model, q, result)
    root = found.links.index(model.robot.root)
    weights = np.outer(list(masses(model.robot).values()), SKEW)
    placement = model.engine.placement(q, link, model.robot.root)
    at = placement[:3, :3] @ point + placement[:3, 3]
    moment = np.cross(at, force) - np.sum(np.cross(centres(model, q), weights), axis=0)
    expected = [*(force - weights.sum(axis=0)), *moment]
    assert np.allclose(found.base[root], expected, rtol=0, atol=1e-10 * size_of(model, q, SKEW))
    assert np.array_equal(found.base[root], found.local[root])
    assert (found.holders[root], found.joints[root]) == (None, None)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_projections_are_the_torques(seed, floating):
    model = tree(seed, floating)
    robot, q = model.robot, ks.random_configurations(model, seed)
    result = asked(model, q, *loads_of(model, seed), gravity=SKEW, payload=ks.Payload(1.0, robot.links[0].name))
    found, size = held(model, q, result), size_of(model, q, SKEW)
    assert found.residual <= 1e-10 * size
    for i, name in enumerate(found.joints):
        joint = robot.joint_by_name.get(name)
        assert np.isnan(found.projections[i]) == (joint is None or joint.type.nv != 1)
        leads = {law.joint for law in robot.followers.values()}
        if joint in robot.independent and joint.type.nv == 1 and name not in leads:
            torque = result.total[robot.velocity_slices[name]]
            assert np.allclose(found.projections[i], torque, rtol=0, atol=1e-10 * size)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_a_floating_joint_bears_what_its_coordinates_give(seed, floating):
    """A joint of six coordinates gives the whole wrench, in the axes of its body twist: its child link's."""
    model = tree(seed, floating)
    robot, q = model.robot, ks.random_configurations(model, seed)
    result = asked(model, q, *loads_of(model, seed), gravity=SKEW)
    found = held(model, q, result)
    leaders = {law.joint for law in robot.followers.values()}
    for joint in robot.independent:
        if joint.type is ks.JointType.FLOATING and joint.name not in leaders:
            local = found.local[found.links.index(joint.child)]
            atol = 1e-10 * size_of(model, q, SKEW)
            assert np.allclose(local, result.total[robot.velocity_slices[joint.name]], rtol=0, atol=atol)


@pytest.mark.parametrize(("seed", "floating"), TREES)
def test_action_is_reaction_on_every_link_cut_free(seed, floating):
    """What holds a link, minus what it holds others by, is its own weight's opposite: about any point."""
    model = tree(seed, floating)
    robot, q = model.robot, ks.random_configurations(model, seed)
    found = held(model, q, asked(model, q, gravity=SKEW))
    places = {link: model.engine.placement(q, link, robot.root)[:3, 3] for link in found.links}
    about = np.array([0.3, -0.2, 0.7])
    own = dict(zip(masses(robot), centres(model, q), strict=True))
    for i, link in enumerate(found.links):
        net = carried(found.base[i], places[link] - about)
        for k, holder in enumerate(found.holders):
            if holder == link:
                net = net - carried(found.base[k], places[found.links[k]] - about)
        weight = masses(robot).get(link, 0.0) * SKEW
        centre = own.get(link, about) - about
        expected = -np.array([*weight, *np.cross(centre, weight)])
        assert np.allclose(net, expected, rtol=0, atol=1e-10 * size_of(model, q, SKEW))


def carried(wrench, lever):
    """Return a wrench about a point that lies back by a lever."""
    return np.array([*wrench[:3], *(wrench[3:] + np.cross(lever, wrench[:3]))])


@pytest.mark.parametrize("source", ["example:panda", "example:talos_full_v2", "example:pr2", "example:solo12"])
def test_reactions_of_real_robots(source):
    model = real(source)
    q = ks.random_configurations(model, 2, (3,))
    result = asked(model, q, gravity=True)
    found = held(model, q, result)
    assert found.residual < 1e-9
    weight = 9.81 * sum(masses(model.robot).values())
    assert np.allclose(found.base[:, found.links.index(model.robot.root), :3], [0, 0, weight], rtol=0, atol=1e-9)


@pytest.mark.parametrize("kind", ["planar", "revolute"])
def test_joints_whose_frame_pinocchio_turns_hold_the_same(kind):
    """A plane across y, and an axis within Pinocchio's own snapping: it turns their frames, and must turn weights."""
    text = (
        '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/><origin xyz="0.2 0.3 -0.1"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial></link>'
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/><axis xyz="0 1 -1e-13"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="1"/></joint></robot>'
    )
    model = load_text(text)
    q = ks.configuration(model, "zero").q
    found = held(model, q, asked(model, q, gravity=(0, 0, -10)))
    assert np.allclose(found.base[1], [0, 0, 20, 6, -4, 0], rtol=0, atol=1e-11)


def test_turned_inertial_frames_change_nothing():
    """The weight acts at the centre of mass, however the axes of its inertia are turned."""
    text = (
        '<robot name="r"><link name="a"><inertial><mass value="2"/><origin xyz="0.1 0 0" rpy="{turn}"/>{inertia}'
        '</inertial></link><link name="b"><inertial><mass value="3"/><origin xyz="0.2 0.3 -0.1" rpy="{turn}"/>'
        '{inertia}</inertial></link><joint name="j" type="revolute"><parent link="a"/><child link="b"/>'
        '<axis xyz="1 2 3"/><limit lower="-1" upper="1" effort="9" velocity="1"/></joint></robot>'
    )
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/>'
    plain, turned = (load_text(text.format(turn=turn, inertia=inertia)) for turn in ("0 0 0", "1 -0.5 2"))
    results = [asked(model, [0.4], gravity=SKEW) for model in (plain, turned)]
    assert np.allclose(results[0].total, results[1].total, rtol=0, atol=1e-13)
    bases = [held(model, [0.4], result).base for model, result in zip((plain, turned), results, strict=True)]
    assert np.allclose(*bases, rtol=0, atol=1e-13)
    assert np.allclose(bases[0][0, :3], -5 * SKEW)  # the base link's own mass counts


# --- effort limits


def test_utilisation_is_measured_in_the_direction_of_the_torque():
    model = real("textbook:planar_2r")
    result = asked(model, [0, np.pi / 2], ks.load_at(model, "tool", [1, 0, 0, 0, 0, 0]), limits={"joint1": (-4, 2)})
    assert np.allclose(result.total, [-0.8, -0.8])
    assert np.allclose(result.utilisation, [0.2, 0.8 / 30])
    assert result.binding_joint == "joint1"
    opposite = asked(model, [0, np.pi / 2], ks.load_at(model, "tool", [-1] + [0] * 5), limits={"joint1": (-4, 2)})
    assert np.allclose(opposite.utilisation, [0.4, 0.8 / 30])


def test_joints_without_limits_have_no_use_and_never_bind():
    model = tree(600, floating=True)
    result = asked(model, ks.random_configurations(model, 0), gravity=SKEW)
    missing = np.array([name in result.limits.missing for name in result.columns])
    assert missing[:6].all()
    assert np.array_equal(np.isnan(result.utilisation), missing)
    assert not missing[int(result.binding)] or int(result.binding) == -1


def test_a_one_sided_limit_is_used_infinitely_by_the_other_side():
    model = real("textbook:planar_2r")
    at, load = [0, np.pi / 2], ks.load_at(model, "tool", [1, 0, 0, 0, 0, 0])
    assert np.isinf(asked(model, at, load, limits={"joint1": (0, 2)}).utilisation[0])
    assert asked(model, at, limits={"joint1": (0, 2)}).utilisation[0] == 0


# --- refusals


@pytest.mark.parametrize(("call", "error", "part"), [
    (lambda m: ks.load_at(m, "hand", np.zeros(6)), ks.UnknownNameError, "hand"),
    (lambda m: ks.load_at(m, "tool", np.zeros(6), axes="hand"), ks.UnknownNameError, "hand"),
    (lambda m: ks.load_at(m, "tool", np.zeros(5)), ks.UsageError, "six"),
    (lambda m: ks.load_at(m, "tool", 3.0), ks.UsageError, "six"),
    (lambda m: ks.load_at(m, "tool", [np.nan, 0, 0, 0, 0, 0]), ks.UsageError, "six finite"),
    (lambda m: ks.load_at(m, "tool", [1e10, 0, 0, 0, 0, 0]), ks.UsageError, "six finite"),
    (lambda m: ks.load_at(m, "tool", np.zeros(6), point="tip"), ks.UsageError, "tip"),
    (lambda m: ks.load_at(m, "tool", np.zeros(6), point=(0, 0)), ks.UsageError, "point"),
    (lambda m: ks.load_at(m, "tool", np.zeros(6), point=(0, 0, np.inf)), ks.UsageError, "point"),
    (lambda m: ks.torque(m, [0, 0], on="earth"), ks.UsageError, "earth"),
    (lambda m: ks.torque(m, [0, 0], gravity=(0, 0)), ks.UsageError, "gravity"),
    (lambda m: ks.torque(m, [0, 0], gravity=(0, 0, np.nan)), ks.UsageError, "gravity"),
    (lambda m: ks.torque(m, [0, 0], payload=ks.Payload(-1, "tool")), ks.UsageError, "payload"),
    (lambda m: ks.torque(m, [0, 0], payload=ks.Payload(np.nan, "tool")), ks.UsageError, "payload"),
    (lambda m: ks.torque(m, [0, 0], payload=ks.Payload(1, "hand")), ks.UnknownNameError, "hand"),
    (lambda m: ks.torque(m, [0, 0], payload=ks.Payload(1, "tool", (0, np.nan, 0))), ks.UsageError, "point"),
    (lambda m: ks.torque(m, [0, 0, 0]), ks.ConfigurationError, "2"),
    (lambda m: ks.torque(m, [0, np.nan]), ks.ConfigurationError, "finite"),
    (lambda m: ks.torque(m, [0, 0], limits={"elbow": 3}), ks.UnknownNameError, "elbow"),
    (lambda m: ks.torque(m, [0, 0], limits={"tool_joint": 3}), ks.ConfigurationError, "fixed"),
    (lambda m: ks.torque(m, [0, 0], limits={"joint1": 0}), ks.UsageError, "joint1"),
    (lambda m: ks.torque(m, [0, 0], limits={"joint1": -3}), ks.UsageError, "joint1"),
    (lambda m: ks.torque(m, [0, 0], limits={"joint1": (1, 2)}), ks.UsageError, "joint1"),
    (lambda m: ks.torque(m, [0, 0], limits={"joint1": np.nan}), ks.UsageError, "joint1"),
    (lambda m: ks.torque(m, [0, 0], limits={"joint1": np.inf}), ks.UsageError, "joint1"),
    (lambda m: ks.reactions(m, [0, 0, 0], ks.torque(m, [0, 0])), ks.ConfigurationError, "2"),
])  # fmt: skip
def test_what_cannot_be_is_refused(call, error, part):
    with pytest.raises(error, match=part):
        call(real("textbook:planar_2r"))


def test_a_follower_has_no_effort_limit_of_its_own():
    model = real("example:panda")
    with pytest.raises(ks.ConfigurationError, match="panda_finger_joint1"):
        ks.torque(model, ks.configuration(model, "zero").q, limits={"panda_finger_joint2": 3})


def test_results_are_values():
    result = asked(real("textbook:planar_2r"), [0.1, 0.2], gravity=SKEW)
    with pytest.raises(ValueError, match="read-only"):
        result.torques[0] = 1


def test_a_negative_mass_is_refused_where_it_would_weigh(tmp_path):
    """Pinocchio loses the centre of such a link in silence, and the engines would disagree."""
    text = """<robot name="r"><link name="a"/><link name="b"><inertial><origin xyz="0.3 0 0"/><mass value="-2"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint></robot>"""
    path = tmp_path / "negative.urdf"
    path.write_text(text)
    model = ks.load(path)
    with pytest.raises(ks.NumberError, match="'b' is -2 kg"):
        ks.torque(model, [0.3], gravity=True)
    assert ks.torque(model, [0.3], [ks.load_at(model, "b", [0, 0, 1, 0, 0, 0], point=(1, 0, 0))]).certificate.agree
