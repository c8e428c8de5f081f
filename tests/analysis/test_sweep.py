"""Laws of sweeps: rows are what one question after the other answers, sums are of those rows, workers do not matter."""

import math
import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.sweeping.measures import MEASURES
from kinetostat.analysis.sweeping.running import Outcome, run
from kinetostat.analysis.sweeping.samples import BLOCK
from kinetostat.analysis.sweeping.sweep import sweep, sweep_work
from kinetostat.analysis.task import FULL, Task
from kinetostat.analysis.typical_length import typical_length
from trees import load_text

ROBOTS = (
    ("example:ur5_robot", "tool0"),
    ("example:panda", "panda_rightfinger"),  # a slide, which another follows
    ("example:talos_full_v2", "gripper_left_fingertip_1_link"),
    ("example:romeo_small", "l_sole"),
    ("textbook:planar_1r", "tool"),
    ("textbook:rp", "tool"),
    ("textbook:planar_3r", "tool"),
    ("textbook:stanford", "tool"),
    ("textbook:helical", "tool"),
)
INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
CART = f"""<robot name="cart"><link name="floor"/>
  <link name="body"><inertial><mass value="3"/><origin xyz="0.1 0.2 0.3"/>{INERTIA}</inertial></link>
  <link name="hand"><inertial><mass value="2"/><origin xyz="0.3 0 0"/>{INERTIA}</inertial></link>
  <joint name="roll" type="planar"><parent link="floor"/><child link="body"/><origin xyz="0 0 0.2" rpy="0.3 0.2 0"/>
  <axis xyz="0 0 1"/></joint>
  <joint name="arm" type="revolute"><parent link="body"/><child link="hand"/><origin xyz="0.2 0 0.5"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="40" velocity="1"/></joint></robot>"""
ALL = tuple(MEASURES)


@cache
def model_of(source):
    return load_text(CART) if source == "cart" else ks.load(source)


def zero(model):
    return ks.configuration(model, "zero").q


def rows_of(model, frame, **asked):
    """Return configurations of the whole robot, {column: values}, and the sweep; m and rad mixed, as in a Jacobian."""
    asked = {"length": "none", **asked}
    blocks = []
    found = sweep(model, frame, zero(model), sink=blocks.append, **asked)
    work = sweep_work(model, frame, zero(model), **asked)
    assert [block.start for block in blocks] == [i * BLOCK for i in range(len(blocks))]
    q = np.concatenate([block.q for block in blocks])
    values = np.concatenate([block.values for block in blocks])
    table = {column.name: values[:, i] for i, column in enumerate(work.columns)}
    return work.coordinates.configuration(q, found.rest), table, found


def part(table, measure):
    """Return the columns of a measure beside each other. (m, c)."""
    return np.stack([values for name, values in table.items() if name.partition(".")[0] == measure], -1)


SIX = "xyz rx ry rz"


# --- rows -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("reference", ["aligned", "local"])
@pytest.mark.parametrize(("source", "frame"), ROBOTS)
def test_rows_are_what_each_question_alone_answers(source, frame, reference):
    model, point = model_of(source), (0.05, -0.1, 0.2)
    payload = ks.Payload(1.5, frame, (0.0, 0.1, 0.0))
    measures = [name for name in ALL if name != "effort_use"]
    q, table, found = rows_of(
        model,
        frame,
        samples=200,
        seed=3,
        axes=SIX,
        measures=measures,
        reference=reference,
        point=point,
        payload=payload,
    )
    jacobian = ks.jacobian(model, frame, q, reference=reference, point=point)
    tolerance = 20 * jacobian.certificate.tolerance
    assert np.allclose(part(table, "jacobian"), jacobian.matrix.reshape(200, -1), rtol=0, atol=tolerance)
    block = ks.manipulability(model, frame, q, reference=reference, point=point).blocks["full"]
    assert np.allclose(part(table, "singular_values"), block.singular_values, rtol=0, atol=tolerance)
    assert np.allclose(table["minimum_singular_value"], block.minimum_singular_value, rtol=0, atol=tolerance)
    assert np.allclose(table["yoshikawa"], block.yoshikawa, rtol=1e-9, atol=tolerance)
    assert np.allclose(table["inverse_condition_number"], block.inverse_condition_number, rtol=0, atol=tolerance)
    assert np.allclose(table["isotropy"], block.isotropy, rtol=1e-6, atol=1e-6)
    smooth = block.inverse_condition_number > 1e-3
    expected = block.gradients["yoshikawa"]
    if np.any(smooth):
        assert np.allclose(part(table, "yoshikawa_gradient")[smooth], expected[smooth], rtol=1e-7, atol=1e-9)
    placed = ks.fk(model, frame, q)
    assert np.allclose(
        part(table, "position"), placed.position + placed.matrix[:, :3, :3] @ point, rtol=0, atol=tolerance
    )
    assert np.allclose(part(table, "pose")[:, :3], part(table, "position"), rtol=0, atol=0)
    turned = np.abs(np.sum(part(table, "pose")[:, 3:] * placed.quaternion_xyzw, axis=1))
    assert np.allclose(turned, 1, rtol=0, atol=1e-12)
    torques = ks.torque(model, q, gravity=True, payload=payload)
    columns = model.robot.velocity_columns(model.robot.movable_path(model.robot.root, frame))
    assert np.allclose(part(table, "gravity_torque"), torques.total[:, columns], rtol=0, atol=1e-9)
    assert found.certificate.agree


@pytest.mark.parametrize(("source", "frame"), [("example:ur5_robot", "tool0"), ("textbook:planar_3r", "tool")])
def test_effort_use_is_that_of_torque(source, frame):
    model = model_of(source)
    q, table, found = rows_of(
        model, frame, samples=100, measures="effort_use", gravity=(0, -9.81, 1), below={"effort_use": 0.1}
    )
    use = ks.torque(model, q, gravity=(0, -9.81, 1)).utilisation
    assert np.allclose(part(table, "effort_use")[:, 1:], use, rtol=1e-9, atol=1e-12)
    assert np.allclose(table["effort_use"], np.max(use, axis=1), rtol=1e-9, atol=1e-12)
    assert found.below[0].count == np.sum(np.max(use, axis=1) < 0.1)


LINK = "<link name='l{0}'/><joint name='j{0}' type='continuous'><parent link='l{1}'/><child link='l{0}'/>{2}</joint>"


def test_an_arm_is_near_singular_where_its_own_rank_is_lost(tmp_path):
    """Four parallel axes have rank 3 of 6 everywhere: that is no singularity; stretched, they have 2."""
    where = "<axis xyz='0 0 1'/><origin xyz='0.5 0 0'/>"
    links = "".join(LINK.format(i, i - 1, where) for i in range(1, 5))
    file = tmp_path / "four.urdf"
    tool = (
        "<link name='t'/><joint name='f' type='fixed'><parent link='l4'/><child link='t'/><origin xyz='1 0 0'/></joint>"
    )
    file.write_text(f"<robot name='four'><link name='l0'/>{links}{tool}</robot>")
    model = ks.load(file)
    stretched, bent = np.array([[0.3, 0, 0, 0.0]]), np.array([[0.3, 1.0, 1.2, -0.4]])
    _, table, found = rows_of(model, "t", configurations=stretched)
    assert (table["minimum_singular_value"][0], table["yoshikawa"][0]) == pytest.approx((0, 0), abs=1e-15)
    assert found.near_singular_share == 1
    _, table, found = rows_of(model, "t", configurations=bent, measures="singular_values,yoshikawa")
    assert part(table, "singular_values").shape == (1, 3)
    assert table["yoshikawa"][0] == pytest.approx(np.prod(part(table, "singular_values")), rel=1e-12)
    assert (found.near_singular_share, found.certificate.agree) == (0, True)
    assert any("the rank of the 6 rows is 3" in warning for warning in found.warnings)
    with pytest.raises(ks.UsageError, match="no gradient"):
        rows_of(model, "t", configurations=bent, measures="yoshikawa_gradient")
    mapped = ks.capability_map(model, "t", np.zeros(4), samples=2000)
    assert np.nanmax(mapped.best_singular_value) > 0.1
    assert mapped.certificate.agree


def test_rows_by_default_are_those_of_singular():
    """An arm of two joints carries a point about: its orientation is no task (theory A5: stretched, it is singular)."""
    model = model_of("textbook:planar_2r_6_3")
    _, table, found = rows_of(model, "tool", configurations=np.array([[0.7, 0.0], [0.7, 1.0]]))
    assert found.task.row_names == ks.singular_at(model, "tool", np.array([0.7, 0.0])).mechanism.task.row_names
    assert table["minimum_singular_value"][0] == pytest.approx(0, abs=1e-15)
    assert table["minimum_singular_value"][1] > 0.1


def test_distance_to_limits_is_one_in_the_middle_and_zero_at_an_end():
    model = model_of("example:panda")
    middle, low = ks.configuration(model, "mid").q, ks.configuration(model, "mid").q
    low[3] = model.robot.joint_by_name["panda_joint4"].limit.range[0]
    _, table, _ = rows_of(model, "panda_hand", configurations=np.stack([middle, low]), measures="limit_distance")
    assert np.allclose(table["limit_distance"], [1, 0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("axes", ["xyz", "x y rz", "xyz rx ry rz"])
@pytest.mark.parametrize(("source", "frame"), [("example:ur5_robot", "tool0"), ("textbook:stanford", "tool")])
def test_axes_and_length_mean_what_they_mean_for_one_configuration(source, frame, axes):
    model = model_of(source)
    q, table, found = rows_of(model, frame, samples=50, axes=axes, length=0.37, measures="singular_values,yoshikawa")
    block = ks.manipulability(model, frame, q, axes=axes, length=0.37).blocks["task"]
    assert np.allclose(part(table, "singular_values"), block.singular_values, rtol=0, atol=1e-11)
    assert np.allclose(table["yoshikawa"], block.yoshikawa, rtol=1e-9, atol=1e-11)
    assert found.measures["singular_values.s1"].unit == block.unit


def test_a_planar_joints_rows_are_along_its_coordinates():
    model = model_of("cart")
    measures = [name for name in ALL if name != "effort_use"]
    q, table, found = rows_of(model, "hand", samples=300, measures=measures, point=(0.3, 0.1, 0))
    assert found.names == ("roll.x", "roll.y", "roll.theta", "arm")
    assert found.certificate.agree, found.certificates
    assert set(found.certificates) >= {"jacobian", "yoshikawa_gradient", "gravity_torque"}
    step = 1e-6  # central differences of the position, and of the index, along each coordinate
    jacobian = part(table, "jacobian").reshape(-1, 6, 4)[:, :3]
    for j in range(4):
        moved = [q + sign * step * np.eye(4)[j] for sign in (1, -1)]
        _, ahead, _ = rows_of(
            model, "hand", configurations=moved[0], measures="position,yoshikawa", point=(0.3, 0.1, 0)
        )
        _, behind, _ = rows_of(
            model, "hand", configurations=moved[1], measures="position,yoshikawa", point=(0.3, 0.1, 0)
        )
        slope = (part(ahead, "position") - part(behind, "position")) / (2 * step)
        assert np.allclose(jacobian[:, :, j], slope, rtol=0, atol=1e-8)
        slope = (ahead["yoshikawa"] - behind["yoshikawa"]) / (2 * step)
        assert np.allclose(part(table, "yoshikawa_gradient")[:, j], slope, rtol=0, atol=1e-7)


# --- summaries --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("source", "frame"), [("example:panda", "panda_hand"), ("textbook:planar_2r", "tool")])
def test_a_summary_is_of_the_rows(source, frame):
    measures = "yoshikawa,inverse_condition_number,position,minimum_gradient"
    model, below, above = model_of(source), {"yoshikawa": 0.05, "position.x": 0.0}, {"position.x": 0.0, "position.y": 0}
    q, table, found = rows_of(
        model, frame, low_discrepancy=BLOCK + 500, measures=measures, below=below, above=above, near=0.03
    )
    assert found.count == BLOCK + 500
    for name, values in table.items():
        one, known = found.measures[name], values[~np.isnan(values)]
        assert one.count == len(known)
        assert one.invalid == len(values) - len(known)
        assert one.mean == pytest.approx(np.mean(known), rel=1e-9, abs=1e-12)
        assert one.minimum.value == np.nanmin(values)
        assert one.maximum.row == np.nanargmax(values)
        assert np.array_equal(one.maximum.configuration, q[one.maximum.row])
        for share, value in one.quantiles.items():
            exact = np.quantile(known, share, method="inverted_cdf")
            assert abs(value - exact) <= one.accuracy * abs(exact) + 1e-15
    for level in found.below:
        assert level.count == np.sum(table[level.column.name] < level.threshold)
        assert level.share == level.count / found.count
    for level in found.above:
        assert level.count == np.sum(table[level.column.name] > level.threshold)
    assert len(found.above) == 2
    assert found.near_singular_share == np.mean(table["inverse_condition_number"] < 0.03)


def test_the_planar_arm_is_best_at_a_right_angle_and_worst_stretched():
    model = model_of("textbook:planar_2r")
    first, second = 1.0, 0.8  # m, robots/SOURCES.md
    found = sweep(
        model,
        "tool",
        zero(model),
        grid={"joint1": (0, np.pi, 5), "joint2": (-np.pi / 2, np.pi / 2, 181)},
        near=1e-3,
        axes="xy",
        measures="yoshikawa,minimum_singular_value,position",
        below={"minimum_singular_value": 1e-9},
    )
    best, worst = found.measures["yoshikawa"].maximum, found.measures["yoshikawa"].minimum
    assert best.value == pytest.approx(first * second, rel=1e-12)
    assert abs(abs(best.q[1]) - np.pi / 2) < 1e-12
    assert worst.value == pytest.approx(0, abs=1e-12)
    assert abs(worst.q[1]) < 1e-12
    assert found.measures["position.x"].maximum.value == pytest.approx(first + second, rel=1e-12)
    assert found.measures["position.x"].minimum.value == pytest.approx(-first - second, rel=1e-12)
    assert found.below[0].count == 5  # stretched, once for each of joint1
    assert found.near_singular_share == 5 / found.count
    assert found.measures["yoshikawa"].unit == "(m/rad)^2"


def test_the_median_of_the_planar_arms_index_is_known():
    model = model_of("textbook:planar_2r")
    found = sweep(
        model,
        "tool",
        zero(model),
        grid={"joint2": (0, np.pi / 2, 100_001)},
        axes="xy",
        measures="yoshikawa",
    )
    # w = l1 l2 sin(q2) over even q2 in [0, pi/2]: median l1 l2 sin(pi/4), mean l1 l2 2/pi.
    assert found.measures["yoshikawa"].quantile(0.5) == pytest.approx(0.8 * math.sin(math.pi / 4), rel=1e-3)
    assert found.measures["yoshikawa"].mean == pytest.approx(0.8 * 2 / math.pi, rel=1e-4)


def test_the_first_axis_changes_no_index():
    model = model_of("example:ur5_robot")
    found = sweep(
        model, "tool0", np.full(6, 0.4), grid="shoulder_pan_joint=-3:3:100", measures="yoshikawa,singular_values"
    )
    for one in found.measures.values():
        assert one.maximum.value - one.minimum.value < 1e-12


# --- workers, order, processes ----------------------------------------------------------------------------------------


def states_equal(a, b):
    mine, other = a.state(), b.state()
    return mine.keys() == other.keys() and all(mine[k].tobytes() == other[k].tobytes() for k in mine)


def work_of(source="example:ur5_robot", frame="tool0", **asked):
    model = model_of(source)
    return sweep_work(model, frame, zero(model), **{"samples": 3 * BLOCK + 17, "below": {"yoshikawa": 0.1}, **asked})


@pytest.mark.parametrize("measures", ["yoshikawa,inverse_condition_number,position", "yoshikawa,gravity_torque"])
def test_any_number_of_workers_gives_the_same_bits(measures):
    work = work_of(measures=measures)
    assert work.chunks == 4
    assert sum(map(work.size, range(4))) == work.rows
    one, three = run(work), run(work, workers=3)
    parts = [work.compute(chunk) for chunk in (2, 0, 3, 1)]
    by_hand = parts[0].merged(parts[1]).merged(parts[2].merged(parts[3])).merged(work.empty())
    assert states_equal(one.partial, three.partial)
    assert states_equal(one.partial, by_hand)
    assert states_equal(work.restore(one.partial.state()), one.partial)


def test_work_that_travelled_gives_the_same_bits():
    work = work_of(samples=500, payload=ks.Payload(1.0, "tool0"), measures="yoshikawa,gravity_torque,effort_use")
    work.compute(0)  # what it keeps for itself does not hinder it
    travelled = pickle.loads(pickle.dumps(work))
    assert travelled.digest == work.digest
    assert states_equal(travelled.compute(0), work.compute(0))


@pytest.mark.parametrize(
    "other",
    [
        {"samples": 501},
        {"samples": 500, "seed": 1},
        {"samples": None, "low_discrepancy": 500},
        {"measures": "yoshikawa,position"},
        {"below": {"yoshikawa": 0.2}},
        {"above": {"yoshikawa": 0.2}},
        {"near": 0.02},
        {"axes": "xyz"},
        {"length": 0.5},
        {"point": (0, 0, 0.1)},
        {"reference": "local"},
        {"relative_to": "shoulder_link"},
        {"source": "textbook:planar_2r", "frame": "tool"},
    ],
)
def test_another_question_has_another_digest(other):
    asked = {"samples": 500, "measures": "yoshikawa"}
    assert work_of(**asked).digest == work_of(**asked).digest
    assert work_of(**{**asked, **other}).digest != work_of(**asked).digest


def test_a_part_of_a_run_has_an_answer_that_says_so():
    work = work_of()
    whole = run(work)
    some = work.compute(1).merged(work.compute(3))
    partial = Outcome(some, whole.done, complete=False, rows=some.rows, continued=0, seconds=1.0, rate=1.0)
    found = work.result(partial)
    assert not found.complete
    assert found.count == BLOCK + 17
    assert found.requested == work.rows
    assert found.certificate.agree
    nothing = replace(partial, partial=work.empty(), rows=0)
    assert work.result(nothing).measures["yoshikawa"].maximum is None
    assert work.result(nothing).near_singular_share is None


# --- the certificate --------------------------------------------------------------------------------------------------


def bent(work, **changes):
    """Return the work with another robot's chain: what a bug in a kernel would do."""
    kernel = replace(work.kernel, **changes)
    return replace(work, witness=replace(work.witness, kernel=kernel))


@pytest.mark.parametrize(
    "measure", [name for name in ALL if name not in ("limit_distance", "effort_use", "gravity_torque")]
)
def test_a_wrong_chain_is_found_out(measure):
    work = work_of(samples=100, measures=measure, below={})
    home = work.kernel.chain.home.copy()
    home[0, 3] += 1e-6
    twisted = work.kernel.chain.screws.copy()
    twisted[:3, 2] += 1e-6
    wrong = bent(work, chain=replace(work.kernel.chain, home=home, screws=twisted))
    assert work.result(run(work)).certificate.agree is True
    certificate = wrong.result(run(wrong)).certificate
    assert certificate.agree is False
    assert len(certificate.values) == 2
    assert certificate.values[0].shape == certificate.values[1].shape


@pytest.mark.parametrize("measure", ["gravity_torque", "effort_use"])
def test_a_wrong_mass_is_found_out(measure):
    work = work_of(samples=100, measures=measure, below={})
    wrong = bent(work, tree=replace(work.kernel.tree, masses=work.kernel.tree.masses * (1 + 1e-8)))
    assert work.result(run(work)).certificate.agree is True
    assert wrong.result(run(wrong)).certificate.agree is False


def test_only_a_distance_to_limits_is_certified_by_the_placement_too():
    found = sweep(model_of("example:ur5_robot"), "tool0", np.zeros(6), samples=100, measures="limit_distance")
    assert list(found.certificates) == ["placement", "limit_distance"]
    assert found.certificate.agree
    assert list(found.measures) == ["limit_distance"]
    assert found.near_singular_share is None


def test_without_crosscheck_nothing_is_certified():
    model = ks.load("example:ur5_robot", crosscheck=False)
    found = sweep(model, "tool0", np.zeros(6), samples=100)
    assert found.certified_rows == 0
    assert found.certificate.agree is None
    assert found.certificate.engines == ("screw",)


def test_extremes_are_among_the_certified_rows():
    work = work_of(samples=5000, measures="yoshikawa")
    partial = run(work).partial
    assert work.result(run(work)).certified_rows == partial.checked + 2


# --- the question -----------------------------------------------------------------------------------------------------


def test_one_length_for_all_configurations_makes_both_parts_weigh_the_same():
    model = model_of("example:panda")
    _, table, found = rows_of(model, "panda_hand", low_discrepancy=4096, length="auto", measures="jacobian")
    entries = part(table, "jacobian").reshape(-1, 6, 7)
    linear, angular = np.sum(entries[:, :3] ** 2), np.sum(entries[:, 3:] ** 2)
    assert found.length == pytest.approx(math.sqrt(linear / angular), rel=1e-9)
    other = sweep(model, "panda_hand", zero(model), grid="panda_joint1=0:1:2", length="auto")
    assert other.length == found.length


def test_joints_outside_the_chain_are_where_the_list_has_them():
    model = model_of("example:ur5_robot")
    q = np.tile(np.array([0.1, -0.5, 0.3, 0.7, 0.8, 0.9]), (3, 1))
    q[:, 0] = [0, 1, 2]
    _, table, found = rows_of(model, "forearm_link", configurations=q, measures="gravity_torque")
    assert np.allclose(
        part(table, "gravity_torque"), ks.torque(model, q, gravity=True).total[:, :3], rtol=0, atol=1e-10
    )
    assert np.array_equal(found.rest, q[0])
    q[:, 4] = [0, 1, 2]
    sweep(model, "forearm_link", np.zeros(6), configurations=q, measures="yoshikawa")
    with pytest.raises(ks.UsageError, match="depends on 'wrist_2_joint', which the configurations move"):
        sweep(model, "forearm_link", np.zeros(6), configurations=q, measures="gravity_torque")


def test_measures_are_told_of_their_units():
    model = model_of("textbook:rp")
    measures = [n for n in ALL if n != "effort_use"]
    work = sweep_work(model, "tool", np.zeros(2), samples=1, measures=measures, axes="xy", length="none")
    units = {column.name: column.unit for column in work.columns}
    assert units["gravity_torque.joint1"] == "Nm"
    assert units["gravity_torque.joint2"] == "N"
    assert units["jacobian.vx.joint1"] == "m/rad"
    assert units["jacobian.vx.joint2"] == "1"
    assert units["jacobian.wz.joint1"] == "1"
    assert units["yoshikawa"] == "mixed"
    assert "m and rad are mixed" in work.warnings[0]
    scaled = sweep_work(model, "tool", np.zeros(2), samples=1, axes="xy", length=1.0)
    assert scaled.columns[0].unit == "(m/rad)^2"
    assert not scaled.warnings


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({}, "exactly one"),
        ({"samples": 1, "low_discrepancy": 1}, "exactly one"),
        ({"samples": 0}, "between 1 and"),
        ({"samples": 1, "measures": "yosikawa"}, "did you mean 'yoshikawa'"),
        ({"samples": 1, "measures": ""}, "measures something"),
        ({"samples": 1, "below": {"isotropi": 0.1}}, "did you mean 'isotropy'"),
        ({"samples": 1, "above": {"position.w": 0.1}}, "no measured column 'position.w'"),
        ({"samples": 1, "measures": "isotropy isotropy"}, "named twice"),
        ({"samples": 1, "near": 0}, "between 0 and 1"),
        ({"samples": 1, "measures": "jacobian", "below": {"jacobian.vx.joint1": 0.1}}, "no measured column"),
        ({"samples": 1, "below": {"yoshikawa": math.nan}}, "finite"),
        ({"samples": 1, "reference": "world"}, "aligned or local"),
        ({"samples": 1, "length": -1}, "the length is auto, none"),
        ({"samples": 1, "length": "long"}, "the length is auto, none"),
        ({"samples": 1, "axes": "q"}, "no axis"),
        ({"configurations": np.zeros((2, 3))}, "shape"),
        ({"configurations": np.zeros((0, 2))}, "no configuration"),
        ({"samples": 1, "seed": -1}, "seed"),
        ({"samples": 1, "measures": "gravity_torque", "gravity": (1, 2)}, "gravity"),
        ({"samples": 1, "measures": "gravity_torque", "payload": ks.Payload(-1, "tool")}, "payload"),
        ({"samples": 1, "relative_to": "tool"}, "no joint"),
    ],
)
def test_questions_that_cannot_be_asked(asked, words):
    model = model_of("textbook:planar_2r")
    with pytest.raises(ks.UsageError, match=words):
        sweep_work(model, "tool", np.zeros(2), **asked)


def test_effort_use_needs_an_effort_limit_and_names_those_that_are_missing():
    def arm(*efforts):
        text = '<link name="l0"/>'
        for i, effort in enumerate(efforts):
            limit = f'effort="{effort}"' if effort else ""
            text += (
                f'<link name="l{i + 1}"/><joint name="j{i + 1}" type="revolute">'
                f'<parent link="l{i}"/><child link="l{i + 1}"/>'
                f'<axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" {limit}/></joint>'
            )
        return load_text(f'<robot name="arm">{text}</robot>')

    with pytest.raises(ks.UsageError, match="needs the effort limit of joint 'j1'"):
        sweep_work(arm(0, 0), "l2", np.zeros(2), samples=1, measures="effort_use")
    work = sweep_work(arm(5, 0), "l2", np.zeros(2), samples=1, measures="effort_use")
    assert work.warnings == ("no effort limit of 'j2' (--effort-limits gives them)",)
    assert work.result(run(work)).measures["effort_use.j2"].invalid == 1
    assert work.result(run(work)).certificate.agree


def test_slides_that_cannot_move_and_joints_without_limits_are_told_of():
    model = load_text(
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="s" type="prismatic"><parent link="a"/><child link="b"/><limit effort="1" velocity="1"/></joint>'
        '<joint name="t" type="continuous"><parent link="b"/><child link="c"/></joint></robot>'
    )
    warnings = sweep_work(model, "c", np.zeros(2), samples=1, axes="xyz", measures="position").warnings
    assert any("the limits of 's' are one position: locked there" in line for line in warnings)
    assert ks.sweep(model, "c", np.zeros(2), samples=50, measures="position").measures["position.x"].maximum.value == 0
    assert any("no limits, so swept: t (-3.142 to 3.142 rad)" in line for line in warnings)
    assert not sweep_work(model, "c", np.zeros(2), grid="t=0:1:2", measures="position").warnings


def test_a_configuration_without_turns_or_without_mixing_has_no_typical_length():
    for source, task in (("textbook:skew_1p", "full"), ("textbook:planar_2r", "xy"), ("example:ur5_robot", "rx ry rz")):
        model = model_of(source)
        frame = "tool0" if "ur5" in source else model.robot.default_tip()
        velocity = ks.jacobian(model, frame, zero(model)).velocity
        chain = coordinates(model, velocity.of, velocity.relative_to)
        assert typical_length(chain, FULL if task == "full" else Task.named(task)) is None


def test_numbers_are_pure_where_no_turn_moves_a_linear_row_and_mixed_where_one_does():
    neck = """<robot name="neck"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="slide" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
      <limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
    <joint name="nod" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
    model = load_text(neck)
    for axes in (None, "xyz", "x ry", "x z ry"):
        work = sweep_work(model, "c", np.zeros(2), samples=10, axes=axes)
        assert [column.unit for column in work.columns] == ["1", "1", "1"], axes
        assert work.length is None
        assert not any("mixed" in line for line in work.warnings)
    # What is pure is the same in every unit of length: the slide is a metre a metre, the turn a radian a radian.
    found = sweep(model, "c", np.zeros(2), samples=10, measures="singular_values").measures
    assert all(one.mean == pytest.approx(1, abs=1e-12) for one in found.values())
    off = sweep_work(model, "c", np.zeros(2), samples=10, axes="y ry", point=(0.1, 0, 0))
    assert off.columns[0].unit == "1"
    # The turn moves z, and no angular row that counts: no length compares the two.
    off = sweep_work(model, "c", np.zeros(2), samples=10, axes="x z rx", point=(0.1, 0, 0))
    assert off.columns[0].unit == "mixed"
    assert any("no turn moves an angular row" in line for line in off.warnings)


def test_a_length_is_of_the_joint_range_and_not_of_what_is_swept():
    model = model_of("example:panda")
    chain = coordinates(model, "panda_hand", "panda_link0")
    length = typical_length(chain, FULL)
    assert sweep(model, "panda_hand", zero(model), samples=10).length == length
    assert sweep(model, "panda_hand", zero(model), grid="panda_joint1=0:1:3", length="auto").length == length


@pytest.mark.parametrize("workers", [1, 3])
def test_effort_use_above_one_is_counted_always(workers):
    model, few = model_of("example:ur5_robot"), {"elbow_joint": 5.0}
    found = sweep(model, "tool0", zero(model), samples=2 * BLOCK, measures="effort_use", limits=few, workers=workers)
    share = {one.column.name: one.share for one in found.above}
    assert share["effort_use.elbow_joint"] == found.above[0].share > 0.3  # the elbow alone is too weak
    assert share["effort_use.wrist_1_joint"] == 0
    assert {one.threshold for one in found.above} == {1.0}
    assert found.limits == few


def test_a_part_of_a_list_has_its_rows_alone():
    model = model_of("example:ur5_robot")
    q = ks.random_configurations(model, 1, 2 * BLOCK + 5)
    work = sweep_work(model, "tool0", zero(model), configurations=q, measures="yoshikawa,position")
    light, heavy = work.with_part(work.part(())), len(pickle.dumps(work))
    assert len(pickle.dumps(light)) < heavy / 20
    assert light.digest != work.digest  # nobody is to take one for the other
    for chunks in ((0,), (2,), (1, 2)):
        part_of = light.with_part(work.part(chunks))
        assert len(pickle.dumps(work.part(chunks))) < 48 * BLOCK * len(chunks) + 10_000
        for chunk in chunks:
            assert states_equal(part_of.compute(chunk), work.compute(chunk))
    drawn = sweep_work(model, "tool0", zero(model), samples=10)
    assert drawn.part((0,)) is drawn.source


def test_a_list_is_outside_limits_where_it_is():
    model = model_of("example:ur5_robot")
    q = np.zeros((5, 6))
    q[1, 2], q[3, 2], q[3, 0] = 9.0, -9.0, 7.0
    (said,) = sweep_work(model, "tool0", zero(model), configurations=q).warnings
    assert said == "2 of 5 configurations are outside limits: of 'shoulder_pan_joint', 'elbow_joint'"
    (said,) = sweep_work(model, "tool0", zero(model), grid="shoulder_pan_joint=-9:9:7,elbow_joint=0:4:3").warnings
    inside_pan, inside_elbow = 5, 2  # -6, -3, 0, 3, 6 of 2 pi; 0 and 2 of pi
    assert said.startswith(f"{21 - inside_pan * inside_elbow} of 21 configurations")
    assert not sweep_work(model, "tool0", zero(model), grid="elbow_joint=0:3:3").warnings


def test_task_rows_are_in_the_answer():
    found = sweep(model_of("textbook:planar_2r"), "tool", np.zeros(2), samples=10, axes="x y")
    assert found.task == Task.named("xy")
    assert repr(found) == "<Sweep of 'tool': 10 configurations>"
