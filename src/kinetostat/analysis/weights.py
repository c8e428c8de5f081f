"""Joint weights: how much of a joint's motion counts, by its speed and by its distance from position limits.

A weight a_i scales column i of a Jacobian: the unit ball of rates is that of qdot_i / a_i. Each comes with its
derivative da_i/dq_i, so that gradients of weighted indices are exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint, Robot

__all__ = ["JointWeights", "fixed_weights", "limit_weights"]

_SMALLEST = 1e-9


@dataclass(frozen=True)
class JointWeights:
    """Weights of the columns of a Jacobian.

    Attributes:
        factors: a, (..., n) or (n,) where they are the same everywhere.
        derivatives: da_i/dq_i, of that shape; NaN at a kink.
        rule: what they are, in words.
        speeds: whether they are speeds, rad/s and m/s, so that weighted columns are shares of them.
        penalty: the factor P in [0, 1] that penalises an index near position limits, (...); None without.
        penalty_gradient: dP/dq, (..., n); None without.
        outside: names of joints at or beyond a position limit, whose weight is zero.
    """

    factors: Array
    derivatives: Array
    rule: str
    speeds: bool
    penalty: Array | None = None
    penalty_gradient: Array | None = None
    outside: tuple[str, ...] = ()


def fixed_weights(numbers: Sequence[float] | Array, count: int) -> JointWeights:
    """Return weights as given, one for each column.

    Raises:
        UsageError: another count, or one that is not finite and positive.
    """
    factors = np.array([float(number) for number in numbers])
    if factors.shape != (count,):
        message = f"--weights takes {count} positive numbers here, one for each column, not {len(factors)}"
        raise UsageError(message, remedy="or limits, for the joints' own")
    if not np.all((factors >= _SMALLEST) & (factors <= 1 / _SMALLEST)):
        message = f"weights are positive numbers between {_SMALLEST:g} and {1 / _SMALLEST:g}"
        raise UsageError(message, remedy="or limits, for the joints' own")
    return JointWeights(factors, np.zeros(count), "as given", speeds=False)


def limit_weights(robot: Robot, joints: Sequence[Joint], q: Array) -> JointWeights:
    """Return weights by the limits of joints: velocity limit times distance from position limits.

        a_i = qdot_max_i / sqrt(1 + abs(dH/dq_i)),   H = sum (u - l)^2 / (4 (u - q)(q - l))

    H is the criterion of M. Zghal, R. Dubey and J. Euler (ICRA 1990) with which T. Chan and R. Dubey weigh joints, "A
    weighted least-norm solution based scheme for avoiding joint limits for redundant joint manipulators", IEEE Trans.
    Robotics and Automation 11(2), 1995; they count it towards a limit alone, an index of all directions counts it
    always. To scale the columns by it is after N. Vahrenkamp et al., "Manipulability analysis", Humanoids 2012. Beside
    them a penalty that multiplies an index, M. Tsai's ("Workspace geometric characterization and manipulability of
    industrial robots", 1986) with his factor k = 4^n,

        P = (1 - exp(-prod t_i)) / (1 - exp(-1)),   t_i = 4 (q - l)(u - q) / (u - l)^2

    divided by its value at the middle of the limits. Joints without position limits count as at their middle; a joint
    whose limits are one position cannot move, and weighs nothing. At the middle of a joint's limits its weight has a
    kink: abs(dH/dq) turns, and the derivative is NaN.

    Args:
        robot: the robot, for where positions are.
        joints: the joints of the columns, each with one coordinate.
        q: configurations (..., nq).

    Raises:
        UsageError: a joint has several coordinates, or no velocity limit.
    """
    count = len(joints)
    factors, slopes = np.empty((2, *q.shape[:-1], count))
    nearness, nearness_slopes = np.ones((2, *q.shape[:-1], count))
    outside = []
    for i, joint in enumerate(joints):
        speed, remedy = joint.limit.velocity, "give numbers: --weights a,b,c, one for each column"
        if joint.type.nq != 1:
            raise UsageError(
                f"joint {quote(joint.name)} has several coordinates, and no weight of its own", remedy=remedy
            )
        if speed is None or not 0 < speed < math.inf:
            raise UsageError(f"joint {quote(joint.name)} has no velocity limit to weigh it by", remedy=remedy)
        position = q[..., robot.position_slices[joint.name].start]
        lower, upper = joint.limit.range
        if not math.isfinite(upper - lower):
            factors[..., i], slopes[..., i], nearness_slopes[..., i] = speed, 0.0, 0.0
            continue
        # With x in (-1, 1) across the range, the joint's part of H is 1 / (1 - x^2).
        half = max((upper - lower) / 2, _SMALLEST)
        x = (position - (lower + upper) / 2) / half
        inside = (np.abs(x) < 1) & (upper > lower)  # a locked joint weighs nothing
        if not np.all(inside):
            outside.append(joint.name)
        gap = np.where(inside, 1 - x * x, np.inf)
        first = 2 * x / gap**2 / half
        second = (2 / gap**2 + 8 * x * x / gap**3) / half**2
        root = 1 / np.sqrt(1 + np.abs(first))
        factors[..., i] = np.where(inside, speed * root, 0.0)
        slopes[..., i] = np.where(first == 0, np.nan, -0.5 * speed * root**3 * np.sign(first) * second)
        slopes[..., i] = np.where(inside, slopes[..., i], 0.0)
        nearness[..., i] = np.where(inside, 1 - x * x, 0.0)
        nearness_slopes[..., i] = np.where(inside, -2 * x / half, 0.0)
    product = np.prod(nearness, axis=-1)
    others = np.stack([np.prod(np.delete(nearness, i, axis=-1), axis=-1) for i in range(count)], -1)
    whole = 1 - math.exp(-1)
    return JointWeights(
        factors,
        slopes,
        "velocity limit / sqrt(1 + |dH/dq|)",
        True,
        (1 - np.exp(-product)) / whole,
        np.exp(-product)[..., None] * others * nearness_slopes / whole,
        tuple(outside),
    )
