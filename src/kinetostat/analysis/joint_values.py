"""Values of joints: from the words and numbers that people give to vectors over coordinates, each value checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import ConfigurationError, cut, quote
from kinetostat.urdf.description import JointType, Robot

__all__ = ["Value", "described", "filled", "joint_rates", "listed", "parsed", "scale_angles"]

Value = float | Sequence[float]


def described(model: Model | Robot) -> Robot:
    """Return the description of a model's robot, or of the robot that is given."""
    return model.robot if isinstance(model, Model) else model


def joint_rates(
    model: Model | Robot,
    wanted: str | Mapping[str, Value] | Sequence[float] | Array,
    *,
    degrees: bool = False,
    quantity: str = "rate",
) -> Array:
    """Return joint rates (nv,) in m/s and rad/s, or what else there is one of for each velocity coordinate.

    Args:
        model: whose: a model, or the description of a robot.
        wanted: `j1=0.3,j2=-1.2` (others zero), an ordered list in file order, or the mapping or sequence they mean.
        degrees: rates given for angles of joints are in degrees per second.
        quantity: what the numbers are, for messages: "rate", "acceleration".

    Raises:
        ConfigurationError: wrong length, not finite, a rate for a fixed or a follower joint.
        UnknownNameError: no such joint.
    """
    robot = described(model)
    values = parsed(wanted) if isinstance(wanted, str) else wanted
    if values is None:
        raise ConfigurationError(
            f"{quote(str(wanted))} is no list of {quantity}s", remedy="write j1=0.3,j2=-1.2 or 0.3,-1.2,..."
        )
    rates = np.zeros(robot.nv)
    rates = filled(robot, rates, robot.velocity_names, robot.velocity_slices, values, quantity)
    if degrees:
        scale_angles(robot, rates, robot.velocity_slices, math.pi / 180)
    return rates


def parsed(text: str) -> dict[str, Value] | list[float] | None:
    """Return the mapping or list that a text writes; None if it is a name."""
    parts = [part.strip() for part in text.replace("\n", ",").split(",")]
    if "=" in text:
        values: dict[str, Value] = {}
        for part in parts:
            name, equals, number = part.rpartition("=")
            numbers = [_number(word) for word in number.split()]
            if not equals or not numbers:
                raise ConfigurationError(
                    f"{quote(part)} is not of the form joint=value",
                    remedy="write j1=0.3,j2=-1.2; or j=x y z with blanks, where a joint has several",
                )
            if name.strip() in values:
                raise ConfigurationError(f"joint {quote(name.strip())} is given twice")
            values[name.strip()] = numbers[0] if len(numbers) == 1 else numbers
        return values
    words = [word for part in parts for word in part.split()]
    try:
        return [float(word) for word in words] if words else None
    except ValueError:
        if len(words) > 1 and "," in text:
            for word in words:
                _number(word)
        return None


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise ConfigurationError(f"{quote(word)} is not a number", remedy="write numbers such as 1.5708") from None


def filled(
    robot: Robot,
    vector: Array,
    names: Sequence[str],
    slices: Mapping[str, slice],
    values: Mapping[str, Value] | Sequence[float] | Array,
    what: str,
) -> Array:
    """Return the vector with the given values put in."""
    if isinstance(values, Mapping):
        index = {name: i for i, name in enumerate(names)}
        for name, value in values.items():
            if not _are_numbers(value):
                raise ConfigurationError(f"the {what} of {quote(str(name))} is {quote(str(value))}, not a number")
            if name in index:
                if not isinstance(value, (int, float)) and np.size(value) != 1:
                    raise ConfigurationError(f"joint {quote(name)} takes one {what}, not {np.size(value)}")
                vector[index[name]] = np.reshape(value, ())
            else:
                where = slices[robot.independent_joint(name, names).name]
                if np.size(value) != where.stop - where.start:
                    raise ConfigurationError(
                        f"joint {quote(name)} takes {where.stop - where.start} {what}s, not {np.size(value)}",
                        remedy="separate them by spaces: joint=x y z ...",
                    )
                vector[where] = value
    else:
        given = np.asarray(values, dtype=np.float64)
        if given.shape != vector.shape:
            message = f"{_counted(given.size, what)} given, {len(names)} are needed"
            raise ConfigurationError(message, remedy=f"in the order {listed(names)}")
        vector = given.copy()
    for name, value in zip(names, vector, strict=True):
        if not math.isfinite(value):
            raise ConfigurationError(f"the {what} of {quote(name)} is {value}, not a finite number")
    return vector


def scale_angles(robot: Robot, vector: Array, slices: Mapping[str, slice], factor: float) -> None:
    """Multiply the angles among positions or velocities in place: a joint's only, a planar joint's last coordinate."""
    for joint in robot.independent:
        if joint.type.is_angle or joint.type is JointType.PLANAR:
            vector[..., slices[joint.name].stop - 1] *= factor


def _are_numbers(value: object) -> bool:
    """Return whether a value of a mapping is a number, or a list of numbers."""
    try:
        return np.asarray(value).dtype.kind in "iuf"
    except ValueError:
        return False


def _counted(count: int, what: str) -> str:
    return f"{count} {what} is" if count == 1 else f"{count} {what}s are"


def listed(names: Sequence[str], longest: int = 12) -> str:
    """Return names for a message, the first dozen."""
    return ", ".join([cut(name) for name in names[:longest]] + (["..."] if len(names) > longest else []))
