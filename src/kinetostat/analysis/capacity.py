"""What effort limits allow: the largest force, or payload, in a direction, and all forces together; certified."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.jacobian import labelled
from kinetostat.analysis.statics import Torques
from kinetostat.analysis.task import TRANSLATION, Task
from kinetostat.conventions import Array, On, Reference, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import UsageError, quote

__all__ = ["ForcePolytope", "Strongest", "force_polytope", "strongest"]

_DIRECTIONS = "x, -z, three numbers x,y,z, or payload"
_NO_TORQUE = 1e-9  # of a unit force's largest possible torque: below it a joint does not feel the force


@dataclass(frozen=True)
class Strongest:
    """The largest force along a line (or payload) that the effort limits allow, everything else counted.

    Attributes:
        velocity: at which point, and in which axes.
        direction: unit vector of the force, in those axes, (3,); down along gravity for a payload.
        quantity: "force" or "payload".
        unit: N or kg.
        on: whom the force acts on.
        value: the largest, (...); infinite where no joint feels it, NaN where none is possible.
        least: the least that is needed, (...): above 0 where the joints are overloaded without it.
        binding: index into the columns of the joint that stops it, -1 where none does. (...).
        columns: names of the coordinates.
        torques: torque for one unit of it, (..., n).
        certificate: what the two engines say of the torques for a unit.
    """

    velocity: Velocity
    direction: Array
    quantity: str
    unit: str
    on: On
    value: Array
    least: Array
    binding: Array
    columns: tuple[str, ...]
    torques: Array
    certificate: Certificate

    @property
    def binding_joint(self) -> str | None:
        """The joint that stops it, of one configuration; None where none does."""
        index = int(self.binding)
        return None if index < 0 else self.columns[index]


def strongest(
    model: Model,
    frame: str,
    q: Array,
    direction: Sequence[float] | str,
    rest: Torques,
    *,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
) -> Strongest:
    """Return the largest force in a direction, or payload, that the effort limits allow at q.

        lower_i <= rest_i + s a_i <= upper_i,   a = J^T u (minus for a force on the robot)

    so s is bounded by the joint whose margin ends first. What else loads the robot (`rest`) shifts the margins, which
    are thus not the same in both directions. A joint for which |a_i| is below 1e-9 of what a unit force could do does
    not feel it; where none does, the force needs no torque (a singular configuration, infinite mechanical advantage).

    Args:
        model: the robot.
        frame: the link that exerts the force, or holds the payload.
        q: configurations (..., nq).
        direction: (3,); "x", "-z" and the like; or "payload": what is held up against gravity, in kg.
        rest: what loads the robot besides, and the effort limits: a result of `torque` at the same q.
        expressed_in: in whose axes the direction is; default the root link's.
        point: the point of the frame that it passes through, in m; default the frame's origin.

    Raises:
        UnknownNameError: no such frame.
        UsageError: a direction without length; a joint that feels the force has no effort limit.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot, q = model.robot, checked(model.robot, q)
    velocity = labelled(robot, frame, Reference.ALIGNED, None, expressed_in, point)
    unit, size, quantity = _unit(rest, direction)
    sign = -1.0 if rest.on is On.ROBOT and quantity == "force" else 1.0

    def per_unit(engine: Engine) -> Array:
        rows = np.swapaxes(engine.jacobian(q, velocity)[..., :3, :], -1, -2)
        torques: Array = sign * size * (rows @ unit)
        return torques

    scale = length_scale(robot, q, velocity.point)
    torques, certificate = certified(model, per_unit, scale, size)
    felt = np.abs(torques) > _NO_TORQUE * size * scale
    names = [name for i, name in enumerate(rest.columns) if np.any(felt[..., i])]
    rest.limits.refuse(names, f"the largest {quantity}")
    value, least, binding = _interval(np.where(felt, torques, 0.0), rest)
    return Strongest(
        velocity,
        unit,
        quantity,
        "kg" if quantity == "payload" else "N",
        rest.on,
        value,
        least,
        binding,
        rest.columns,
        torques,
        certificate,
    )


def _unit(rest: Torques, direction: Sequence[float] | str) -> tuple[Array, float, str]:
    """Return the unit vector of a force, its size in N for one unit of the quantity, and what the quantity is."""
    if isinstance(direction, str) and direction.lstrip("+-") in ("x", "y", "z"):
        direction = [(-1.0 if direction[0] == "-" else 1.0) * (direction[-1] == axis) for axis in "xyz"]
    if isinstance(direction, str):
        if direction != "payload":
            raise UsageError(f"there is no direction {quote(direction)}", remedy=_DIRECTIONS)
        size = float(np.linalg.norm(rest.payload_gravity))
        if size == 0:
            raise UsageError("without gravity a payload has no weight", remedy="leave out --gravity-vector 0,0,0")
        return -rest.payload_gravity / size, size, "payload"  # the robot holds it up
    vector = np.asarray(direction, dtype=np.float64)
    if vector.shape != (3,) or not np.all(np.isfinite(vector)) or not np.any(vector):
        raise UsageError("a direction has three finite numbers that are not all zero", remedy=_DIRECTIONS)
    vector = vector / np.max(np.abs(vector))
    return vector / np.linalg.norm(vector), 1.0, "force"


def _interval(torques: Array, rest: Torques) -> tuple[Array, Array, Array]:
    """Return the largest s, the least (0 where none is needed), and the column that stops s."""
    limits, felt = rest.limits, torques != 0
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(limits.lower - rest.total) / torques, (limits.upper - rest.total) / torques])
    highest = np.where(felt, np.max(ends, axis=0), np.inf)
    lowest = np.where(felt, np.min(ends, axis=0), -np.inf)
    # A joint that does not feel the force, but is overloaded without it, makes every force impossible.
    over = ~felt & ((rest.total > limits.upper) | (rest.total < limits.lower))
    value, least = np.min(highest, axis=-1, initial=np.inf), np.max(lowest, axis=-1, initial=-np.inf)
    if not torques.shape[-1]:  # nothing moves, nothing stops it
        return value, np.maximum(least, 0.0), np.full(value.shape, -1)
    stopped, overloaded = np.argmin(highest, axis=-1), np.any(over, axis=-1)
    binding = np.where(overloaded, np.argmax(over, axis=-1), np.where(np.isinf(value), -1, stopped))
    impossible = overloaded | (value < np.maximum(least, 0.0))
    return np.where(impossible, np.nan, value), np.maximum(least, 0.0), binding


@dataclass(frozen=True, repr=False)
class ForcePolytope:
    """All forces (or moments) that the effort limits allow at a configuration: a polytope, or a prism on one.

    Attributes:
        velocity: at which point, and in which axes.
        task: the rows that count, all linear or all angular.
        unit: N or Nm.
        on: whom the forces act on.
        vertices: corners, (k, m), in the task's rows; where lines are unbounded, of its section across them.
        lines: directions that need no torque, (r, m): along them every force is possible, both ways.
        columns: names of the coordinates.
        face_joints: for each facet of the hull, the column whose limit it is. (facets,).
        facets: indices of the corners of each facet of the hull (triangles in space, edges in a plane). (facets, ...).
        every_way: the force that is possible in every bounded direction, in `unit`; 0 where nothing is, or an effort
            limit is exceeded without any force.
        certificate: what the two engines say of the Jacobian's rows.
        warnings: what is to be said of it.
    """

    velocity: Velocity
    task: Task
    unit: str
    on: On
    vertices: Array
    lines: Array
    columns: tuple[str, ...]
    face_joints: tuple[int, ...]
    facets: Array
    every_way: float
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<ForcePolytope {quote(self.velocity.of)}: {len(self.vertices)} vertices, {len(self.lines)} lines>"


def force_polytope(
    model: Model,
    frame: str,
    q: Array,
    rest: Torques,
    *,
    axes: str | Sequence[str] | None = None,
    expressed_in: str | None = None,
    point: Sequence[float] | None = None,
) -> ForcePolytope:
    """Return every force that the effort limits allow at one configuration.

        {F : lower <= rest + J^T F <= upper}

    a polytope with a pair of faces for each joint (P. Chiacchio, Y. Bouffard-Vercelli and F. Pierrot, "Force polytope
    and force ellipsoid for redundant manipulators", J. Robotic Systems 14(8), 1997). Forces in the null space of J^T
    need no torque: they are its `lines`, and the corners are those of its section across them. Corners by Qhull (C.
    Barber, D. Dobkin and H. Huhdanpaa, 1996), by SciPy.

    Args:
        model: the robot.
        frame: the link that exerts the force.
        q: one configuration, (nq,).
        rest: what loads the robot besides, and the effort limits: a result of `torque` at the same q.
        axes: the rows that count, of one kind: "xyz" (default), "x y", "rx ry rz"; others are zero.
        expressed_in: in whose axes; default the root link's.
        point: the point of the frame that it passes through, in m; default the frame's origin.

    Raises:
        UnknownNameError: no such frame.
        UsageError: forces and moments mixed; a joint that feels them has no effort limit; the limits are exceeded
            without any force, and no force relieves them.
        ConfigurationError: q is not one configuration, or holds a number that is not finite.
    """
    robot, q = model.robot, checked(model.robot, q)
    task = TRANSLATION if axes is None else Task.named(axes)
    if task.mixed:
        raise UsageError("forces and moments have no common scale", remedy="choose --axes xyz, or rx ry rz")
    if q.ndim != 1:
        raise UsageError("a force polytope is of one configuration", remedy="take them one by one")
    velocity = labelled(robot, frame, Reference.ALIGNED, None, expressed_in, point)
    sign = -1.0 if rest.on is On.ROBOT else 1.0
    scale = length_scale(robot, q, velocity.point)
    rows, certificate = certified(model, lambda engine: engine.jacobian(q, velocity)[..., task.rows, :], scale)
    felt = [i for i in range(rows.shape[-1]) if np.max(np.abs(rows[:, i])) > _NO_TORQUE * scale]
    rest.limits.refuse([rest.columns[i] for i in felt], "the force polytope")
    from kinetostat.analysis.polytope import polytope

    lower, upper = rest.limits.lower - rest.total, rest.limits.upper - rest.total
    over = [i for i in range(len(lower)) if i not in felt and not lower[i] <= 0 <= upper[i] and lower[i] < upper[i]]
    found = None if over else polytope(sign * rows[:, felt].T, lower[felt], upper[felt])
    if found is None:
        which = f"the effort limit of joint {quote(rest.columns[over[0]])} is" if over else "effort limits are"
        message = f"{which} exceeded without any force, and no force relieves that"
        raise UsageError(message, remedy="change the configuration, the loads, or --effort-limits")
    return ForcePolytope(
        velocity,
        task,
        "N" if task.linear else "Nm",
        rest.on,
        found.vertices,
        found.lines,
        rest.columns,
        tuple(felt[i] for i in found.facet_rows),
        found.facets,
        found.radius,
        certificate,
        () if found.holds_zero else ("an effort limit is exceeded without any force: zero is not in the polytope",),
    )
