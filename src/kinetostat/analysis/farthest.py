"""The largest distance of a frame from a point that is found inside limits, certified at the place where it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked, position_range
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.kinematics import fk
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import NO_LIMIT, Joint

__all__ = ["Farthest", "bounded_joints", "farthest"]

_CLIMBED = 8  # of the configurations, the farthest of which are starts
_NO_PITCH = 1e-12  # m per rad
_OPTIONS = {"maxiter": 200, "ftol": 1e-14, "gtol": 1e-10}


@dataclass(frozen=True, repr=False)
class Farthest:
    """Where a frame is farthest from a point. A lower bound: a farther place is not excluded.

    Attributes:
        distance: from the point, m.
        q: the configuration, (nq,).
        certificate: what the two engines say of the frame's placement there.
    """

    distance: float
    q: Array
    certificate: Certificate

    def __repr__(self) -> str:
        return f"<Farthest: {self.distance:.6g} m>"


def farthest(
    model: Model,
    frame: str,
    observer: str,
    drawn: Array,
    *,
    point: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Farthest:
    """Return the largest distance of a frame's origin p(q) from a point a at rest that is found inside limits.

    From those of the given configurations where it is farthest, |p - a|^2 / 2 is climbed along the joints between the
    two frames by a bounded quasi-Newton method (L-BFGS-B: C. Zhu, R. Byrd, P. Lu and J. Nocedal, 1997, by SciPy), whose
    gradient is J^T (p - a), J the linear rows of the frame's Jacobian.

    Args:
        model: the robot.
        frame: the frame, a link.
        observer: the link that the point is fixed in.
        drawn: configurations inside limits, one at least. (k, nq).
        point: the point in the observer's coordinates, in m.

    Raises:
        UnknownNameError: no such frame.
        UsageError: nothing moves the frame, or there is no largest distance: see `bounded_joints`.
        ConfigurationError: configurations of another shape, or with a number that is not finite.
    """
    from scipy.optimize import minimize

    robot = model.robot
    frame, observer, drawn = robot.frame(frame), robot.frame(observer), checked(robot, drawn)
    joints, arm = bounded_joints(model, frame, observer), coordinates(model, frame, observer)
    where, chain, origin = list(arm.indices), arm.chain, np.array(point)

    def descent(x: Array) -> tuple[float, Array]:
        """Return minus half the square of the distance, and its gradient."""
        columns, placement = chain.columns(x)
        away = placement[:3, 3] - origin
        return -float(away @ away) / 2, -away @ (columns[:3] @ chain.fold)

    far = np.linalg.norm(chain.columns(drawn[:, where])[1][..., :3, 3] - origin, axis=-1)
    starts = drawn[np.argsort(-far, kind="stable")[:_CLIMBED]]
    bounds = [position_range(robot, joint) for joint in joints]
    climbed = [
        minimize(descent, start[where], jac=True, method="L-BFGS-B", bounds=bounds, options=_OPTIONS)
        for start in starts
    ]
    best = min(range(len(starts)), key=lambda i: float(climbed[i].fun))
    q: Array = starts[best].copy()
    q[where] = climbed[best].x
    placed = fk(model, frame, q, relative_to=observer)
    return Farthest(float(np.linalg.norm(placed.position - origin)), q, placed.certificate)


def bounded_joints(model: Model, frame: str, observer: str) -> list[Joint]:
    """Return the joints between two frames, if these cannot get away from each other any distance.

    Raises:
        UsageError: there is none; one of them has several coordinates, or advances without a limit.
    """
    joints = model.robot.moving_joints(observer, frame)
    if any(joint.type.nq > 1 for joint in joints):
        raise UsageError("a joint with several coordinates is on the way: there is no largest distance")
    arm = coordinates(model, frame, observer)
    along, turn = arm.chain.screws[:3], arm.chain.screws[3:]
    advances = ~np.any(turn, axis=0) | (np.abs(np.sum(along * turn, axis=0)) > _NO_PITCH)
    driven = np.any(advances[:, None] & (arm.chain.fold != 0), axis=0)
    ends = np.abs(np.stack(arm.stated_limits))
    for joint, moves, far in zip(joints, driven, np.max(ends, axis=0), strict=True):
        if moves and far > NO_LIMIT:
            how = "advances" if joint.type.is_angle else "slides"
            raise UsageError(f"joint {quote(joint.name)} {how} without a limit: there is no largest distance")
    return joints
