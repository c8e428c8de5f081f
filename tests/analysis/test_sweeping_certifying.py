"""The certificate of a batch: that it notices what is wrong, also in long chains and in what no engine computes."""

from __future__ import annotations

import time

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.sweeping.sweep import SweepWork, sweep_work

GRADIENTS = ("yoshikawa_gradient", "minimum_gradient")


def serial(joints: int) -> str:
    """Return a robot of hinges about z, y and x in turn."""
    parts = ['<robot name="long"><link name="l0"/>']
    for i in range(joints):
        parts.append(
            f'<link name="l{i + 1}"/><joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<origin xyz="0.3 0 0"/><axis xyz="{("0 0 1", "0 1 0", "1 0 0")[i % 3]}"/>'
            '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        )
    return "".join([*parts, "</robot>"])


def work_of(source: str, frame: str, *measures: str) -> SweepWork:
    model = ks.load(source)
    return sweep_work(model, frame, np.zeros(model.robot.nq), samples=20, measures=measures)


@pytest.fixture(scope="module")
def long_work(tmp_path_factory) -> SweepWork:
    path = tmp_path_factory.mktemp("robots") / "long.urdf"
    path.write_text(serial(100))
    return work_of(str(path), "l100", *GRADIENTS)


def definition(work: SweepWork, q) -> dict[str, np.ndarray]:
    return {name: np.array(part) for name, part in work.kernel.definition(q).items()}


def test_gradients_of_a_long_chain_take_no_long_time(long_work):
    q = long_work.source.rows(0, 20)
    outputs = definition(long_work, q)
    began = time.perf_counter()
    found = long_work.witness.differences(q, outputs)
    assert time.perf_counter() - began < 2  # 100 Jacobian rates a row would take ten times as long
    for name in GRADIENTS:
        assert np.max(found[name]) < long_work.witness.tolerances[name]
        assert np.allclose(long_work.witness.again(q[:1])[name][0], outputs[name][0], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", GRADIENTS)
@pytest.mark.parametrize("entry", [0, 57, 99])
def test_one_wrong_entry_of_a_long_gradient_shows(long_work, name, entry):
    q = long_work.source.rows(0, 20)
    outputs = definition(long_work, q)
    outputs[name][7, entry] += 1e-3 * np.max(np.abs(outputs[name][7]))
    apart = long_work.witness.differences(q, outputs)[name] > long_work.witness.tolerances[name]
    assert list(np.flatnonzero(apart)) == [7]


@pytest.mark.parametrize(
    ("source", "frame"),
    [("example:ur5_robot", "tool0"), ("example:panda", "panda_leftfinger"), ("textbook:stanford", "tool")],
)
def test_the_distance_to_limits_is_computed_again(source, frame):
    work = work_of(source, frame, "limit_distance")
    q = work.source.rows(0, 20)
    outputs = definition(work, q)
    assert np.max(work.witness.differences(q, outputs)["limit_distance"]) < 1e-12
    outputs["limit_distance"][3] += 1e-4
    assert work.witness.differences(q, outputs)["limit_distance"][3] > work.witness.tolerances["limit_distance"]
    assert work.witness.certificate("limit_distance", 0.0).engines == ("python", "screw")


def test_planar_joints_wherever_they_are(tmp_path):
    links = "".join(f'<link name="l{i}"><inertial><mass value="1"/></inertial></link>' for i in range(4))
    joint = '<joint name="{0}" type="{1}"><parent link="l{2}"/><child link="l{3}"/><origin xyz=".2 .1 0"/>{4}</joint>'
    bend = '<axis xyz="0 1 0"/>' + LIMIT.format(-1, 1)
    joints = [("p", "planar", ""), ("r", "revolute", bend), ("s", "planar", '<axis xyz="1 0 0"/>')]
    path = tmp_path / "planar.urdf"
    written = "".join(joint.format(name, kind, i, i + 1, more) for i, (name, kind, more) in enumerate(joints))
    path.write_text(f'<robot name="r">{links}{written}</robot>')
    work = work_of(str(path), "l3", "jacobian", "singular_values", "gravity_torque", *GRADIENTS)
    q = work.source.rows(0, 20)
    for name, apart in work.witness.differences(q, definition(work, q)).items():
        assert np.max(apart) <= work.witness.tolerances[name], name


LIMIT = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'
FOLLOWED = (
    '<robot name="r"><link name="a"/><link name="b"/><link name="c"/>'
    '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>{}</joint>'
    '<joint name="k" type="revolute"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/><axis xyz="0 1 0"/>{}'
    '<mimic joint="j" multiplier="-2" offset="0.5"/></joint></robot>'
)


@pytest.mark.parametrize(
    ("leader", "follower", "low", "high"),
    [((-1, 1), (-0.5, 1.5), -0.5, 0.5), ((-1, 1), (-9, 9), -1, 1), ((-1, 1), (7, 8), -1, 1), ((0, 0), (-9, 9), 0, 0)],
)
def test_a_followers_limits_count(tmp_path, leader, follower, low, high):
    path = tmp_path / "followed.urdf"
    path.write_text(FOLLOWED.format(LIMIT.format(*leader), LIMIT.format(*follower)))
    work = work_of(str(path), "c", "limit_distance")
    q = np.linspace(-1, 1, 9)[:, None]
    outputs = definition(work, q)
    assert np.max(work.witness.differences(q, outputs)["limit_distance"]) < 1e-12
    if low < high:
        again = work.witness.again(np.array([[low], [high], [(low + high) / 2]]))["limit_distance"]
        assert np.allclose(again, [0, 0, 1], rtol=0, atol=1e-12)
