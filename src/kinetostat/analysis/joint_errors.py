"""Errors of joints: from what people write to a vector over the columns of a path."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from kinetostat.analysis.configuration import LARGEST_LENGTH
from kinetostat.analysis.joint_values import Value, joint_rates, listed, parsed
from kinetostat.analysis.task import turning_columns
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, cut, quote

__all__ = ["UNIT_ERROR", "JointErrors", "joint_errors"]

UNIT_ERROR = 1e-3  # rad or m: what is taken of every joint where no error is given

JointErrors = float | str | Sequence[float] | Mapping[str, Value] | Array


def joint_errors(
    model: Model, frame: str, wanted: JointErrors, *, relative_to: str | None = None, degrees: bool = False
) -> Array:
    """Return errors of the joints between two frames, one for each column of the Jacobian between them.

    Args:
        model: the robot.
        frame: F, a link.
        wanted: one number, for every joint that turns (for every joint, where all slide); `j1=0.001,j2=-0.002`, others
            being 0; a list in path order; or the number, mapping or sequence that these mean. Signs count in the move
            that the errors make, and in nothing else.
        relative_to: A, the observer's link; default the root link.
        degrees: numbers given for angles are in degrees.

    Returns:
        d, (n,), in rad and m.

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: no joint between the frames; not so many numbers as there are columns; a joint that is not between
            the frames; a number that is not finite, or that is half a turn or more.
        ConfigurationError: an error of a fixed or follower joint.
    """
    robot = model.robot
    observer, of = robot.frame(relative_to or robot.root), robot.frame(frame)
    joints = robot.moving_joints(observer, of)
    names = [name for joint in joints for name in joint.velocity_names]
    turning = np.array(turning_columns(joints))
    values = parsed(wanted) if isinstance(wanted, str) else wanted
    if isinstance(values, Mapping):
        every = joint_rates(robot, values, quantity="joint error")
        columns = robot.velocity_columns(joints)
        elsewhere = np.flatnonzero(np.delete(every, columns))
        if elsewhere.size:
            others = np.delete(robot.velocity_names, columns)
            raise UsageError(
                f"joint {quote(str(others[elsewhere[0]]))} does not move {quote(of)} relative to {quote(observer)}",
                remedy=f"these do: {listed(names)}",
            )
        errors = every[columns]
    else:
        errors = _numbers(values, wanted, names)
        if len(errors) == 1 < len(names):
            errors = np.where(turning | ~np.any(turning), errors, 0.0)
    if len(errors) != len(names):
        raise UsageError(
            f"{len(errors)} joint errors are given, {len(names)} are needed",
            remedy=f"one for all joints that turn, or in the order {listed(names)}",
        )
    errors = np.where(turning & degrees, np.radians(errors), errors)
    for name, value, turns in zip(names, errors, turning, strict=True):
        most = math.pi if turns else LARGEST_LENGTH
        if not abs(value) < most:  # nor is what is no number
            what = "half a turn" if turns else f"{LARGEST_LENGTH:g} m"
            raise UsageError(
                f"the joint error of {quote(name)} is {value:g} {'rad' if turns else 'm'}, not a number below {what}",
                remedy="check the unit",
            )
    return errors


def _numbers(values: object, given: object, names: Sequence[str]) -> Array:
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if values is None or numbers.ndim != 1 or not numbers.size:
        raise UsageError(
            f"{quote(str(given))} is no joint error, nor a list of them",
            remedy=f"for instance 0.001, or {cut(names[0])}=0.001",
        )
    return numbers
