"""`agreement`: whole robots agree; a reader that is broken on purpose is named, with frame, place, size and unit."""

from __future__ import annotations

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis import panel as panel_module
from kinetostat.analysis.agreement import DIFFERENCES, agreement
from kinetostat.analysis.panel import configurations
from kinetostat.conventions import Reference
from kinetostat.engines.pinocchio import PinocchioEngine
from kinetostat.engines.screw import ScrewEngine
from kinetostat.engines.third import ThirdReader
from kinetostat.urdf.files import example_robots, textbook_robots
from trees import load_text, random_urdf

ROBOT = """
<robot name="victim">
  <link name="base"/>
  <link name="mast"><inertial><origin xyz="0.1 0.02 0.2"/><mass value="3"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="boom"><inertial><origin xyz="0.05 0.2 -0.1"/><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="slide"><inertial><origin xyz="0 0.1 0.1"/><mass value="1.5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="mast"/><axis xyz="0.2 -0.3 1"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="boom" type="continuous"><parent link="mast"/><child link="boom"/><axis xyz="0 1 0"/>
    <origin xyz="0.3 -0.1 0.2" rpy="-0.3 0.2 0.7"/></joint>
  <joint name="slide" type="prismatic"><parent link="boom"/><child link="slide"/><axis xyz="0 0 1"/>
    <origin xyz="0 0.4 0.1" rpy="1 -0.5 0.2"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="turn" multiplier="-0.4" offset="0.15"/></joint>
  <joint name="tip" type="revolute"><parent link="slide"/><child link="tip"/><axis xyz="1 0 0"/>
    <origin xyz="0.3 0.1 0" rpy="0 0.6 0.3"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>
"""
# A joint that the third reader does not know: nobody but the witnesses can decide beyond it.
LONELY = (
    ROBOT.replace('type="continuous"', 'type="screw"')
    .replace('<joint name="boom"', '<drake:joint name="boom"')
    .replace(
        'rpy="-0.3 0.2 0.7"/></joint>', 'rpy="-0.3 0.2 0.7"/><drake:screw_thread_pitch value="0.8"/></drake:joint>'
    )
)


class Changed:
    """An engine, or another object, with some of its methods replaced."""

    def __init__(self, original, **changes):
        self._original, self._changes = original, changes

    def __getattr__(self, name):
        return self._changes[name] if name in self._changes else getattr(self._original, name)


def model_with(text=ROBOT, *, engine=None, witness=None):
    """Return a robot whose engines are made by the given functions of their originals."""
    model = load_text(text)
    for name, change in (("engine", engine), ("witness", witness)):
        if change is not None:
            model.__dict__[name] = change(getattr(model, name))
    return model


def negated(*methods, part=np.s_[...]):
    """Return what flips the sign of a part of what some methods give."""

    def change(engine):
        def flipped(name):
            def call(*arguments):
                value = np.array(getattr(engine, name)(*arguments))
                value[part] *= -1
                return value

            return call

        return Changed(engine, **{name: flipped(name) for name in methods})

    return change


def other_text(pattern, wanted):
    """Return what gives Pinocchio a text in which something is changed."""

    def change(_):
        text = load_text(ROBOT).loaded.text
        changed = re.sub(pattern, wanted, text)
        assert changed != text
        return PinocchioEngine(changed)

    return change


def other_joint(name, **changes):
    """Return what lets the screw engine see one joint with some of its fields changed."""

    def change(engine):
        robot = engine._robot
        joints = tuple(replace(joint, **changes) if joint.name == name else joint for joint in robot.joints)
        return ScrewEngine(replace(robot, joints=joints))

    return change


def odd_ones(found):
    return {one.quantity: one.odd_one for one in found.disagreements}


# --- whole robots ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    [
        *(f"example:{n}" for n in example_robots() if n != "ur_description/ur3"),
        *(f"textbook:{n}" for n in textbook_robots()),
    ],
)
def test_the_readers_agree_on_every_robot_that_ships(name):
    model = ks.load(name)
    found = agreement(model)
    assert found.agree, found.disagreements
    assert found.frames == len(model.robot.links)
    assert found.configurations == 20
    assert found.max_difference <= found.tolerance
    screws = any(joint.type == "screw" for joint in model.robot.joints)
    assert ("yourdfpy" in found.readers) is not screws
    assert bool(found.notes) is (screws or "psyonic" in name)


@pytest.mark.parametrize("seed", range(12))
def test_the_readers_agree_on_random_trees(seed):
    found = agreement(load_text(random_urdf(seed)), samples=6, seed=seed)
    assert found.agree, found.disagreements


@pytest.mark.parametrize("text", [ROBOT, LONELY])
def test_the_victim_is_healthy(text):
    assert agreement(load_text(text)).agree


def test_a_floating_base_is_compared_without_the_third_reader():
    found = agreement(ks.load("example:panda", floating_base=True), samples=4)
    assert found.agree
    assert found.readers == ("pinocchio", "screw")
    assert "floating base" in found.notes[0]


def test_it_says_how_much_was_compared_and_that_the_screw_engine_takes_part_even_if_queries_leave_it_out():
    found = agreement(ks.load("example:panda", crosscheck=False), samples=5, third=False)
    assert (found.frames, found.configurations, found.readers) == (13, 5, ("pinocchio", "screw"))


@pytest.mark.parametrize("samples", [0, -3, 10_001])
def test_a_number_of_samples_that_cannot_be_is_refused(samples):
    with pytest.raises(ks.UsageError, match="samples"):
        agreement(load_text(ROBOT), samples=samples)


# --- what is asked ---------------------------------------------------------------------------------------------------


def test_zero_and_the_middle_come_first_and_the_seed_decides_the_rest():
    model = ks.load("example:panda")
    q = configurations(model, 6, 3)
    assert np.array_equal(q[0], ks.configuration(model, "zero").q)
    assert np.array_equal(q[1], ks.configuration(model, "mid").q)
    assert np.array_equal(q, configurations(model, 6, 3))
    assert not np.array_equal(q[2:], configurations(model, 6, 4)[2:])
    assert len(configurations(model, 1, 0)) == 1
    for row in q[2:]:
        assert ks.configuration(model, row).warnings == ()


def test_joints_without_limits_are_moved_all_the_same():
    text = ROBOT.replace('lower="-2" upper="2"', 'lower="0" upper="0"')
    q = configurations(load_text(text), 8, 0)
    assert np.all(q[:2] == 0)
    assert np.all(np.abs(q[2:]) > 1e-6)


# --- one broken reader -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("engine", "first"),
    [
        (other_text('multiplier="-0.4"', 'multiplier="0.4"'), "placement"),
        (other_text('offset="0.15"', 'offset="0.151"'), "placement"),
        (other_text('axis xyz="0 1 0"', 'axis xyz="0 -1 0"'), "placement"),
        (other_text('axis xyz="0.2 -0.3 1"', 'axis xyz="-0.3 0.2 1"'), "placement"),
        (other_text('xyz="0.3 0.1 0"', 'xyz="0.3 0.1 1e-9"'), "placement"),
        (other_text('mass value="2"', 'mass value="2.001"'), "mass"),
        (other_text('xyz="0.05 0.2 -0.1"', 'xyz="0.05 0.2 0.1"'), "gravity torque"),
        (negated("jacobians", part=np.s_[..., 4, :]), "Jacobian"),
        (negated("jacobians", part=np.s_[..., 1]), "Jacobian"),
        (negated("holding_torques"), "gravity torque"),
    ],
)
def test_pinocchio_is_named_if_it_is_the_odd_one(engine, first):
    found = agreement(model_with(engine=engine))
    assert found.disagreements[0].quantity == first
    assert set(odd_ones(found).values()) == {"pinocchio"}
    assert found.disagreements[0].size > found.disagreements[0].tolerance
    assert found.disagreements[0].readers == ("pinocchio", "screw")


@pytest.mark.parametrize(
    ("witness", "first"),
    [
        (other_joint("turn", axis=(0.0, 0.0, 1.0)), "placement"),
        (other_joint("boom", axis=(0.0, -1.0, 0.0)), "placement"),
        (negated("jacobians", part=np.s_[..., :3, :]), "Jacobian"),
        (negated("holding_torques", part=np.s_[..., 0]), "gravity torque"),
    ],
)
def test_the_screw_engine_is_named_if_it_is_the_odd_one(witness, first):
    found = agreement(model_with(witness=witness))
    assert found.disagreements[0].quantity == first
    assert set(odd_ones(found).values()) == {"screw"}


def test_a_wrong_placement_comes_with_its_frame_configuration_size_and_unit():
    model = model_with(engine=other_text('xyz="0.3 0.1 0"', 'xyz="0.3 0.1 0.25"'))
    worst = agreement(model).disagreements[0]
    assert (worst.quantity, worst.frame, worst.unit) == ("placement", "tip", "m")
    assert tuple(worst.configuration) == model.robot.position_names
    q = np.array(list(worst.configuration.values()))
    apart = model.engine.placement(q, "tip", "base") - model.witness.placement(q, "tip", "base")
    assert worst.size == pytest.approx(np.max(np.abs(apart)))
    assert 0.1 < worst.size <= 0.25


def test_a_yaw_that_is_off_is_a_difference_of_directions():
    worst = agreement(model_with(engine=other_text('rpy="0 0.6 0.3"', 'rpy="0 0.6 0.4"'))).disagreements[0]
    assert (worst.quantity, worst.frame, worst.unit) == ("placement", "tip", "1")


def test_numbers_that_are_none_never_agree():
    def poisoned(engine):
        return Changed(engine, placements=lambda q, frames: engine.placements(q, frames) * np.nan)

    found = agreement(model_with(engine=poisoned))
    assert odd_ones(found)["placement"] == "pinocchio"
    assert found.max_difference == float("inf")


# --- without a third reader ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("engine", "quantity"),
    [
        (negated("jacobians", part=np.s_[..., 0]), "Jacobian"),
        (negated("placements", part=np.s_[..., 0, 3]), "placement"),  # no longer what the Jacobians are rates of
        (negated("holding_torques"), "gravity torque"),
        (negated("holding_torques"), "torque of a wrench"),
    ],
)
@pytest.mark.parametrize("which", ["engine", "witness"])
@pytest.mark.parametrize("text", [ROBOT, LONELY])
def test_one_against_one_the_witness_decides(engine, quantity, which, text):
    found = agreement(model_with(text, **{which: engine}), third=text is LONELY)
    assert odd_ones(found)[quantity] == ("pinocchio" if which == "engine" else "screw")


def test_one_against_one_without_a_witness_nobody_is_blamed():
    found = agreement(model_with(engine=other_text('multiplier="-0.4"', 'multiplier="0.4"')), third=False)
    assert odd_ones(found)["placement"] == ""
    found = agreement(model_with(engine=other_text('mass value="2"', 'mass value="2.001"')), third=False)
    assert odd_ones(found) == {"mass": "", "gravity torque": ""}


@pytest.mark.parametrize(
    ("methods", "part", "quantity"),
    [
        (("jacobians",), np.s_[..., 1], "Jacobian"),
        (("holding_torques",), np.s_[...], "gravity torque"),
        (("holding_torques",), np.s_[...], "torque of a wrench"),
    ],
)
def test_engines_that_are_wrong_together_are_found_out_by_the_witness(methods, part, quantity):
    both = negated(*methods, part=part)
    found = [one for one in agreement(model_with(engine=both, witness=both)).disagreements if one.quantity == quantity]
    assert {one.readers for one in found} == {("pinocchio", DIFFERENCES), ("screw", DIFFERENCES)}
    assert {one.odd_one for one in found} == {""}


def test_engines_that_see_other_joints_disagree():
    model = load_text(ROBOT)
    model.__dict__["engine"] = PinocchioEngine(re.sub(r"<mimic[^>]*>", "", model.loaded.text))
    found = agreement(model)
    assert [one.quantity for one in found.disagreements] == ["joints"]


# --- the third reader ------------------------------------------------------------------------------------------------


def broken_third(monkeypatch, change):
    class Broken(ThirdReader):
        def placements(self, q):
            return change(super().placements(q))

    monkeypatch.setattr(panel_module, "ThirdReader", Broken)


def test_a_third_reader_that_both_engines_outvote_is_named(monkeypatch):
    broken_third(monkeypatch, lambda found: found + np.array([[0, 0, 0, 1e-6], *np.zeros((3, 4))]))
    found = agreement(load_text(ROBOT))
    (only,) = found.disagreements
    assert (only.odd_one, only.readers, only.quantity) == ("yourdfpy", ("yourdfpy", "pinocchio"), "placement")
    assert only.size == pytest.approx(1e-6)
    assert found.max_difference < 1e-14  # the engines agree


def test_a_third_reader_that_fails_is_a_note_and_no_crash(monkeypatch):
    def fail(_):
        raise ks.errors.EngineError("it fails as it places links: Boom")

    broken_third(monkeypatch, fail)
    found = agreement(load_text(ROBOT))
    assert found.agree
    assert found.readers == ("pinocchio", "screw")
    assert found.notes == ("yourdfpy is left out: it fails as it places links: Boom",)
    broken = agreement(model_with(engine=other_text('offset="0.15"', 'offset="0.2"')))
    assert odd_ones(broken)["placement"] == ""


def test_all_three_may_differ(monkeypatch):
    broken_third(monkeypatch, lambda found: found * 1.5)
    found = agreement(model_with(engine=other_text('offset="0.15"', 'offset="0.2"')))
    assert odd_ones(found)["placement"] in ("", "yourdfpy")
    assert found.disagreements[0].odd_one == ""


def test_a_negative_mass_leaves_weight_out_and_says_so():
    found = agreement(load_text(ROBOT.replace('mass value="2"', 'mass value="-2"')))
    assert found.agree
    assert any("negative" in note for note in found.notes)


def test_every_reference_is_looked_at():
    def only_world(engine):
        def jacobians(q, frames, reference):
            found = engine.jacobians(q, frames, reference)
            return -found if reference is Reference.WORLD else found

        return Changed(engine, jacobians=jacobians)

    assert odd_ones(agreement(model_with(witness=only_world))) == {"Jacobian": "screw"}


def test_nothing_is_warned_of_and_nothing_is_logged(caplog, capfd):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        agreement(load_text(LONELY))
    assert caplog.records == []
    assert capfd.readouterr() == ("", "")
