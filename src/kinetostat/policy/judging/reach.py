"""The largest distance between two frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kinetostat.analysis.configuration import neutral, position_range, random_configurations
from kinetostat.analysis.kinematics import fk
from kinetostat.conventions import Array, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.screw import ScrewEngine
from kinetostat.errors import UsageError, quote
from kinetostat.policy.judging.found import Found, above, agreed, below, ends, witness
from kinetostat.policy.kinds.poses import Reach
from kinetostat.urdf.description import Joint

__all__ = ["reach"]

_CLIMBED = 8  # of the samples, the farthest of which are starts
_OPTIONS = {"maxiter": 200, "ftol": 1e-14, "gtol": 1e-10}


def reach(model: Model, asked: Reach, folder: Path) -> Found:  # noqa: ARG001 (all judges alike)
    """Judge the largest distance that is found: random configurations, then climbs from the farthest of them.

    What a search finds is a lower bound. The distance at the witness is computed by both engines.
    """
    robot = model.robot
    frame, observer = ends(robot, asked)
    joints = robot.moving_joints(observer, frame)
    if any(joint.type.nq > 1 for joint in joints):
        raise UsageError("a joint with several coordinates is on the way: there is no largest distance")
    endless = next((j for j in joints if not j.type.is_angle and not np.all(np.isfinite(j.limit.range))), None)
    if endless is not None:
        raise UsageError(f"joint {quote(endless.name)} slides without a limit: there is no largest distance")
    q = _farthest(model, frame, observer, joints, asked)
    placed = fk(model, frame, q, relative_to=observer)
    agreed(placed.certificate)
    found = float(np.linalg.norm(placed.position))
    low = asked.at_least is None or above(found, asked.at_least)
    high = asked.at_most is None or below(found, asked.at_most)
    return Found(low and high, f"{found:.6g} m", witness(robot, q, joints))


def _farthest(model: Model, frame: str, observer: str, joints: list[Joint], asked: Reach) -> Array:
    """Return the configuration at which the frame is farthest, (nq,)."""
    from scipy.optimize import minimize

    robot, engine = model.robot, ScrewEngine(model.robot)
    where = [robot.position_slices[joint.name].start for joint in joints]
    q = np.tile(neutral(robot), (asked.samples, 1))
    q[:, where] = random_configurations(robot, asked.seed, asked.samples)[:, where]
    far = np.linalg.norm(engine.placement(q, frame, observer)[:, :3, 3], axis=-1)
    columns = robot.velocity_columns(joints)
    velocity = Velocity(frame, observer, observer, (0.0, 0.0, 0.0))
    starts = q[np.argsort(-far, kind="stable")[:_CLIMBED]]

    def descent(x: Array, start: Array) -> tuple[float, Array]:
        """Return minus half the square of the distance, and its gradient."""
        here = start.copy()
        here[where] = x
        position = engine.placement(here, frame, observer)[:3, 3]
        return -float(position @ position) / 2, -position @ engine.jacobian(here, velocity)[:3, columns]

    bounds = [position_range(robot, joint) for joint in joints]
    climbed = [
        minimize(descent, start[where], args=(start,), jac=True, method="L-BFGS-B", bounds=bounds, options=_OPTIONS)
        for start in starts
    ]
    best = min(range(len(starts)), key=lambda i: float(climbed[i].fun))
    found: Array = starts[best].copy()
    found[where] = climbed[best].x
    return found
