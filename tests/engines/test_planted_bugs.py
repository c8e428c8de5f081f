"""The certificate is worth something: any one of these bugs, planted in one engine, makes it say that they disagree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.engines import pinocchio as pinocchio_module
from kinetostat.engines import screw as screw_module
from kinetostat.engines.pinocchio import PinocchioEngine
from kinetostat.engines.screw import ScrewEngine
from kinetostat.urdf.description import Mimic, Robot
from trees import load_text

Plant = Callable[[pytest.MonkeyPatch], None]

# One path over every joint type, from an observer that moves; a follower; no placement and no axis that is special.
ROBOT = """
<robot name="victim">
  <link name="base"/><link name="mast"/><link name="boom"/><link name="slide"/><link name="nut"/><link name="table"/>
  <link name="free"/><link name="tip"/><link name="turret"/><link name="camera"/>
  <joint name="mast" type="revolute"><parent link="base"/><child link="mast"/><axis xyz="0.2 -0.3 1"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="boom" type="continuous"><parent link="mast"/><child link="boom"/><axis xyz="0 1 0"/>
    <origin xyz="0.3 -0.1 0.2" rpy="-0.3 0.2 0.7"/></joint>
  <joint name="slide" type="prismatic"><parent link="boom"/><child link="slide"/><axis xyz="1 2 3"/>
    <origin xyz="0 0.4 0.1" rpy="1 -0.5 0.2"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
    <mimic joint="mast" multiplier="-0.4" offset="0.15"/></joint>
  <drake:joint name="nut" type="screw"><parent link="slide"/><child link="nut"/><axis xyz="-1 0.5 0"/>
    <origin xyz="0.2 0 0.3" rpy="0.1 0.9 -0.4"/><drake:screw_thread_pitch value="0.8"/></drake:joint>
  <joint name="table" type="planar"><parent link="nut"/><child link="table"/><axis xyz="0.5 0.2 0.8"/>
    <origin xyz="-0.2 0.1 0.1" rpy="0.2 0.3 0.4"/></joint>
  <joint name="free" type="floating"><parent link="table"/><child link="free"/>
    <origin xyz="0.1 0 0.2" rpy="0.5 0 1"/></joint>
  <joint name="tip" type="fixed"><parent link="free"/><child link="tip"/>
    <origin xyz="0.3 0.1 0" rpy="0 0.6 0.3"/></joint>
  <joint name="turret" type="revolute"><parent link="base"/><child link="turret"/><axis xyz="0 0.3 -1"/>
    <origin xyz="0.5 0.5 0" rpy="0.3 0 0.2"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="camera" type="revolute"><parent link="turret"/><child link="camera"/><axis xyz="1 0 0.4"/>
    <origin xyz="0 0.2 0.2" rpy="0.1 0.2 0.3"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>
"""


def certificate(*, rate: bool = False) -> ks.Certificate:
    """Return what the engines say of one Jacobian: a point of the tip, seen from the camera, in the boom's axes."""
    model = load_text(ROBOT)
    q = ks.random_configurations(model.robot, 1)
    qdot = np.random.default_rng(1).uniform(0.2, 1, model.robot.nv) if rate else None
    found = ks.jacobian(
        model, "tip", q, relative_to="camera", expressed_in="boom", point=(0.2, -0.3, 0.4), joints="all", qdot=qdot
    )
    return found.certificate


class Changed:
    """A module, or an object, with some of its attributes replaced."""

    def __init__(self, original: Any, **changes: Any) -> None:
        self._original, self._changes = original, changes

    def __getattr__(self, name: str) -> Any:
        return self._changes[name] if name in self._changes else getattr(self._original, name)


# --- in the screw engine ---------------------------------------------------------------------------------------------


def _of_joint(name: str, **changes: Any) -> Plant:
    """Let the screw engine see one joint with some of its fields changed."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = screw_module._screws
        patch.setattr(screw_module, "_screws", lambda j: original(replace(j, **changes) if j.name == name else j))

    return plant


def _transposed_origins(patch: pytest.MonkeyPatch) -> None:
    original = screw_module._origin

    def transposed(origin: Any) -> np.ndarray:
        matrix = original(origin).copy()
        matrix[:3, :3] = matrix[:3, :3].T.copy()
        return matrix

    patch.setattr(screw_module, "_origin", transposed)


def _transposed_axes(patch: pytest.MonkeyPatch) -> None:
    original = ScrewEngine._in_axes

    def in_axes(
        self: ScrewEngine, columns: Any, placements: dict[str, np.ndarray], velocity: ks.Velocity
    ) -> np.ndarray:
        turned = np.swapaxes(placements[velocity.expressed_in], -1, -2)
        return original(self, columns, placements | {velocity.expressed_in: turned}, velocity)

    patch.setattr(ScrewEngine, "_in_axes", in_axes)


def _transposed_plane(patch: pytest.MonkeyPatch) -> None:
    original = screw_module.so3.carry_z_to
    patch.setattr(screw_module.so3, "carry_z_to", lambda axis: original(axis).T)


def _wrong_point(**changes: Any) -> Plant:
    def plant(patch: pytest.MonkeyPatch) -> None:
        original = ScrewEngine._point

        def point(self: ScrewEngine, placements: dict[str, np.ndarray], velocity: ks.Velocity) -> np.ndarray:
            return original(self, placements, replace(velocity, **changes))

        patch.setattr(ScrewEngine, "_point", point)

    return plant


def _follower_laws(change: Callable[[Mimic], Mimic]) -> Plant:
    """Change the laws of followers, which only the screw engine takes from the description."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = Robot.followers.func
        changed = property(lambda self: {name: change(law) for name, law in original(self).items()})
        patch.setattr(Robot, "followers", changed)

    return plant


def _multiplier_forgotten_in_columns(patch: pytest.MonkeyPatch) -> None:
    original = ScrewEngine._columns_of
    patch.setattr(ScrewEngine, "_columns_of", lambda self, joint: (original(self, joint)[0], 1.0))


def _columns_in_another_order(patch: pytest.MonkeyPatch) -> None:
    original = ScrewEngine._relative_columns
    patch.setattr(ScrewEngine, "_relative_columns", lambda *arguments: original(*arguments)[..., ::-1])


def _observer_forgotten(patch: pytest.MonkeyPatch) -> None:
    original = Robot.path
    patch.setattr(
        Robot, "path", lambda self, start, end: [(j, sign) for j, sign in original(self, start, end) if sign > 0]
    )


def _body_screws_taken_for_space_screws(patch: pytest.MonkeyPatch) -> None:
    original = screw_module.carry
    patch.setattr(screw_module, "carry", lambda t, screws: original(np.broadcast_to(np.eye(4), t.shape), screws))


def _wrong_sign_of_a_cross_product(patch: pytest.MonkeyPatch) -> None:
    original = screw_module.cross
    patch.setattr(screw_module, "cross", lambda a, b: -original(a, b))


def _quaternion_of_the_other_order(patch: pytest.MonkeyPatch) -> None:
    original = screw_module.so3.from_quaternion
    patch.setattr(screw_module.so3, "from_quaternion", lambda q: original(np.roll(q, 1, axis=-1)))


SCREW_BUGS: dict[str, Plant] = {
    "wrong sign of a turning axis": _of_joint("boom", axis=(0.0, -1.0, 0.0)),
    "wrong sign of a sliding axis": _of_joint("slide", axis=tuple(-np.array([1, 2, 3]) / 14**0.5)),
    "swapped axes": _of_joint("boom", axis=(0.0, 0.0, 1.0)),
    "swapped components of an axis": _of_joint("slide", axis=tuple(np.array([2, 1, 3]) / 14**0.5)),
    "forgotten pitch": _of_joint("nut", pitch=0.0),
    "wrong sign of the pitch": _of_joint("nut", pitch=-0.8),
    "transposed rotations of placements": _transposed_origins,
    "transposed rotation to the axes": _transposed_axes,
    "transposed plane": _transposed_plane,
    "the frame's origin for the point": _wrong_point(point=(0.0, 0.0, 0.0)),
    "the observer's origin for the point": _wrong_point(point=None),
    "the point in another frame": _wrong_point(of="free"),
    "forgotten multiplier": _follower_laws(lambda law: replace(law, multiplier=1.0)),
    "forgotten offset": _follower_laws(lambda law: replace(law, offset=0.0)),
    "multiplier forgotten in the columns": _multiplier_forgotten_in_columns,
    "order of columns": _columns_in_another_order,
    "forgotten motion of the observer": _observer_forgotten,
    "body screws taken for space screws": _body_screws_taken_for_space_screws,
    "wrong sign of a cross product": _wrong_sign_of_a_cross_product,
    "order of a quaternion": _quaternion_of_the_other_order,
}


def _without_cross(module: Any) -> Plant:
    """Leave out every cross product that a module takes from numpy."""
    return lambda patch: patch.setattr(module, "np", Changed(np, cross=lambda a, b: np.zeros_like(np.add(a, b))))


def _frame_taken_as_resting(name: str) -> Plant:
    def plant(patch: pytest.MonkeyPatch) -> None:
        original = ScrewEngine._twists

        def without(self: ScrewEngine, *arguments: Any) -> dict[str, np.ndarray]:
            found = original(self, *arguments)
            return found | {name: np.zeros_like(found[name])}

        patch.setattr(ScrewEngine, "_twists", without)

    return plant


def _brackets_without_moments(patch: pytest.MonkeyPatch) -> None:
    original = screw_module.twist_matrix

    def cut(twist: np.ndarray) -> np.ndarray:
        matrix = original(twist)
        matrix[..., :3, 3:] = 0
        return matrix

    patch.setattr(screw_module, "twist_matrix", cut)


SCREW_RATE_BUGS: dict[str, Plant] = {
    "the point dragged without turning": _without_cross(screw_module),
    "the observer taken as resting": _frame_taken_as_resting("camera"),
    "the axes taken as resting": _frame_taken_as_resting("boom"),
    "the point taken as resting": _frame_taken_as_resting("tip"),
    "a bracket without its moment": _brackets_without_moments,
}


# --- in the Pinocchio engine -----------------------------------------------------------------------------------------


def _installed(name: str, change: Callable[[Any], None]) -> Plant:
    """Change one joint as the Pinocchio engine has read it, before it is used."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = pinocchio_module._read_joints

        def read(*arguments: Any) -> list[Any]:
            joints = original(*arguments)
            change(next(joint for joint in joints if joint.name == name))
            return joints

        patch.setattr(pinocchio_module, "_read_joints", read)

    return plant


def _attribute(name: str, value: Any) -> Callable[[Any], None]:
    return lambda joint: setattr(joint, name, value)


def _text(old: str, new: str) -> Plant:
    """Let Pinocchio, and it alone, read another number."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = pinocchio_module._build

        def build(text: str, floating_base: bool) -> Any:
            assert text.count(old) == 1
            return original(text.replace(old, new), floating_base)

        patch.setattr(pinocchio_module, "_build", build)

    return plant


def _negative_position(patch: pytest.MonkeyPatch) -> None:
    original = PinocchioEngine._configurations

    def configurations(self: PinocchioEngine, q: np.ndarray) -> np.ndarray:
        full = original(self, q)
        mast = next(joint for joint in self._joints if joint.name == "mast")
        full[:, mast.q] = -full[:, mast.q]
        return full

    patch.setattr(PinocchioEngine, "_configurations", configurations)


def _turned(change: Callable[..., np.ndarray]) -> Plant:
    def plant(patch: pytest.MonkeyPatch) -> None:
        original = PinocchioEngine._turned
        patch.setattr(PinocchioEngine, "_turned", lambda self, *arguments: change(original, self, *arguments))

    return plant


def _other_label(method: str, **changes: Any) -> Plant:
    """Let one step of the Pinocchio engine take another label for the one that is asked."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original = getattr(PinocchioEngine, method)

        def with_label(self: PinocchioEngine, velocity: ks.Velocity, *others: Any) -> Any:
            return original(self, replace(velocity, **changes), *others)

        patch.setattr(PinocchioEngine, method, with_label)

    return plant


def _folded(change: Callable[[np.ndarray], np.ndarray]) -> Plant:
    def plant(patch: pytest.MonkeyPatch) -> None:
        original = PinocchioEngine._lead

        def lead(self: PinocchioEngine) -> None:
            original(self)
            self._fold = change(self._fold)

        patch.setattr(PinocchioEngine, "_lead", lead)

    return plant


def _of_pin(**changes: Any) -> Plant:
    return lambda patch: patch.setattr(pinocchio_module, "pin", Changed(pinocchio_module.pin, **changes))


def _frame_at_the_wrong_place(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(pinocchio_module, "_AT_FRAME", pinocchio_module.pin.ReferenceFrame.WORLD)


PINOCCHIO_BUGS: dict[str, Plant] = {
    "wrong sign of a position": _negative_position,
    "wrong sign of an axis": _text('xyz="0 1 0"', 'xyz="0 -1 0"'),
    "swapped axes": _text('xyz="1 2 3"', 'xyz="2 1 3"'),
    "a number read wrong": _text('xyz="0.3 -0.1 0.2"', 'xyz="0.3 -0.1 0.2000001"'),
    "transposed rotation of a placement": _text('rpy="0 0.6 0.3"', 'rpy="0 -0.6 -0.3"'),
    "wrong sign of the pitch": _installed("nut", _attribute("pitch", -0.8)),
    "pitch in metres for each radian": _installed("nut", _attribute("pitch", 0.8 * 2 * np.pi)),
    "wrong point": _other_label("_relative", point=(0.0, 0.0, 0.0)),
    "wrong frame": _other_label("_relative", of="free"),
    "forgotten motion of the observer": _other_label("_relative", relative_to="base"),
    "linear and angular rows swapped": _turned(lambda f, self, v, w, label: f(self, w, v, label)),
    "wrong axes": _turned(lambda f, self, v, w, label: f(self, v, w, replace(label, expressed_in="camera"))),
    "transposed rotation to the axes": _turned(
        lambda f, self, v, w, label: np.vstack([_rotation_of(self, label) @ v, _rotation_of(self, label) @ w])
    ),
    "forgotten multiplier": _installed("slide", _attribute("multiplier", 1.0)),
    "forgotten offset": _installed("slide", _attribute("offset", 0.0)),
    "forgotten follower": _folded(lambda fold: np.where(fold == 1, fold, 0.0)),
    "order of columns": _folded(lambda fold: fold[:, ::-1]),
    "plane left as it is": _installed("table", _attribute("axis", np.array([0.0, 0.0, 1.0]))),
    "columns of another point": _frame_at_the_wrong_place,
    "wrong sign of a cross product": _of_pin(skew=lambda v, skew=pinocchio_module.pin.skew: -skew(v)),
}


def _rotation_of(engine: PinocchioEngine, label: ks.Velocity) -> np.ndarray:
    return np.array(engine._data.oMf[engine._frame(label.expressed_in)].rotation)


def _resting_columns(*arguments: Any) -> np.ndarray:
    return np.zeros((6, arguments[0].nv))


def _forgotten_in_the_rate(field: str, value: str) -> Plant:
    """In the rate alone: `_relative` and `_turned`, which it uses, keep the label that is asked."""

    def plant(patch: pytest.MonkeyPatch) -> None:
        original, relative, turned = PinocchioEngine._rate, PinocchioEngine._relative, PinocchioEngine._turned

        def rate(self: PinocchioEngine, velocity: ks.Velocity, qdot: np.ndarray) -> np.ndarray:
            with pytest.MonkeyPatch.context() as inner:
                inner.setattr(PinocchioEngine, "_relative", lambda self, _: relative(self, velocity))
                inner.setattr(PinocchioEngine, "_turned", lambda self, v, w, _: turned(self, v, w, velocity))
                return original(self, replace(velocity, **{field: value}), qdot)

        patch.setattr(PinocchioEngine, "_rate", rate)

    return plant


PINOCCHIO_RATE_BUGS: dict[str, Plant] = {
    "columns taken as resting": _of_pin(getFrameJacobianTimeVariation=_resting_columns),
    "the point dragged without turning": _without_cross(pinocchio_module),
    "the axes taken as resting": _forgotten_in_the_rate("expressed_in", "base"),
    "the observer taken as resting": _forgotten_in_the_rate("relative_to", "base"),
    "the frame taken for another": _forgotten_in_the_rate("of", "free"),
}


# --- the tests -------------------------------------------------------------------------------------------------------


def test_without_a_bug_the_engines_agree() -> None:
    assert certificate().agree is True
    assert certificate(rate=True).agree is True


BUGS = [
    *(pytest.param(plant, id=f"screw: {name}") for name, plant in SCREW_BUGS.items()),
    *(pytest.param(plant, id=f"pinocchio: {name}") for name, plant in PINOCCHIO_BUGS.items()),
]
RATE_BUGS = [
    *(pytest.param(plant, id=f"screw: {name}") for name, plant in SCREW_RATE_BUGS.items()),
    *(pytest.param(plant, id=f"pinocchio: {name}") for name, plant in PINOCCHIO_RATE_BUGS.items()),
]


@pytest.mark.parametrize("plant", BUGS)
def test_a_bug_in_one_engine_is_seen(plant: Plant) -> None:
    with pytest.MonkeyPatch.context() as patch:
        plant(patch)
        found = certificate()
    assert found.agree is False
    assert found.max_difference is not None
    assert found.max_difference > 1e-8  # far beyond the tolerance: not seen by luck
    assert len(found.values) == 2  # and both answers are shown
    assert certificate().agree is True


@pytest.mark.parametrize("plant", RATE_BUGS)
def test_a_term_missing_in_the_rate_is_seen(plant: Plant) -> None:
    with pytest.MonkeyPatch.context() as patch:
        plant(patch)
        assert certificate().agree is True  # the Jacobian itself is right: only its rate is not
        found = certificate(rate=True)
    assert found.agree is False
    assert found.max_difference is not None
    assert found.max_difference > 1e-3
    assert certificate(rate=True).agree is True


def test_placements_and_frame_changes_are_certified_too() -> None:
    with pytest.MonkeyPatch.context() as patch:
        _transposed_origins(patch)
        model = load_text(ROBOT)
        q = ks.random_configurations(model.robot, 1)
        assert ks.fk(model, "tip", q).certificate.agree is False
        assert ks.adjoint(model, "tip", "base", q).certificate.agree is False
        assert ks.adjoint(model, "tip", "base", q, kind=ks.WrenchOrTwist.WRENCH).certificate.agree is False


@pytest.mark.parametrize("lost", [float("nan"), float("inf")])
def test_what_is_not_a_number_never_agrees(lost: float, monkeypatch: pytest.MonkeyPatch) -> None:
    for engine in (ScrewEngine, PinocchioEngine):
        original = engine.jacobian
        with monkeypatch.context() as patch:
            patch.setattr(engine, "jacobian", lambda self, *a, original=original: original(self, *a) * lost)
            with np.errstate(invalid="ignore"):
                assert certificate().agree is False


def test_engines_that_see_other_joints_do_not_get_as_far_as_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    original = pinocchio_module._read_joints
    monkeypatch.setattr(pinocchio_module, "_read_joints", lambda *arguments: original(*arguments)[:-1])
    with pytest.raises(ks.DisagreementError, match="different joints"):
        certificate()
