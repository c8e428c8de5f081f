"""The numbers of all samples, by the batch kernel in chunks; a part of them again by both engines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.crosscheck import Certificate, certified, combined, length_scale
from kinetostat.analysis.loads import Payload, carried, force_scale, load_scale
from kinetostat.analysis.planar import by_coordinates
from kinetostat.conventions import Array, Velocity
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.screw import se3, so3
from kinetostat.screw.kernel import Kernel

__all__ = ["Timeline", "certificate", "timeline"]

_CHUNK = 1 << 14
_FEW = 4000  # samples for which the definition is there sooner than compiled code is loaded
_KERNEL = "kernel"  # the name of the third number in a certificate


@dataclass(frozen=True)
class Timeline:
    """What is computed of every sample.

    Attributes:
        position: of the tool point in the observer's coordinates, m. (m, 3).
        quaternion: xyzw, of the tool's frame relative to the observer's. (m, 4).
        singular_values: descending. (m, k).
        twist: of the tool point, m/s and rad/s, or None without time. (m, 6).
        torque: that holds the robot still, Nm and N, or None without gravity. (m, n).
        limit_distance: of the joint nearest to a position limit, its own or a follower's: 1 amid its range, 0 at its
            end. (m,).
    """

    position: Array
    quaternion: Array
    singular_values: Array
    twist: Array | None
    torque: Array | None
    limit_distance: Array


def timeline(
    tool: Kernel, joints: Kernel, q: Array, rates: Array | None, progress: Callable[[int], None] | None = None
) -> Timeline:
    """Return the numbers of m samples.

    Args:
        tool: the kernel of the chain, of its c coordinates: placement, singular values, and the Jacobian for a twist.
        joints: the kernel of all n joints that move, those of the chain first: distance to limits, gravity torque.
        q: (m, n).
        rates: (m, n), or None without time.
        progress: told how many samples are done.
    """
    count, chain = len(q), tool.chain.fold.shape[1]
    whole: dict[str, Array] = {}
    for start in range(0, count, _CHUNK):
        part = slice(start, min(start + _CHUNK, count))
        of_tool, of_joints = _evaluated(tool, q[part, :chain], count), _evaluated(joints, q[part], count)
        moved = of_tool.pop("placement")
        found = {
            "position": moved[..., 3],
            "quaternion": so3.to_quaternion(moved[..., :3]),
            "singular_values": of_tool["singular_values"],
            **of_joints,
        }
        if rates is not None:
            found["twist"] = np.einsum("kij,kj->ki", of_tool["jacobian"], rates[part, :chain])
        for name, values in found.items():
            if name not in whole:
                whole[name] = np.empty((count, *values.shape[1:]))
            whole[name][part] = values
        if progress is not None:
            progress(part.stop)
    return Timeline(
        whole["position"],
        whole["quaternion"],
        whole["singular_values"],
        whole.get("twist"),
        whole.get("gravity_torque"),
        whole["limit_distance"],
    )


def certificate(
    model: Model,
    tool: Kernel,
    joints: Kernel,
    coordinates: Coordinates,
    label: Velocity,
    q: Array,
    count: int,
    payload: Payload | None,
) -> Certificate:
    """Return what both engines say of the kernels' numbers at some samples: Jacobian, pose, torques, singular values.

    The largest difference is the largest of any two of the three. Without cross-check nothing is compared.

    Args:
        model: the robot.
        tool: the kernel of the chain.
        joints: the kernel of all joints.
        coordinates: these joints, those of the chain first.
        label: of which point the Jacobian is, relative to what and in which axes.
        q: configurations of the whole robot, (k, nq).
        count: of how many samples they are a part.
        payload: the mass that is held, or None.
    """
    robot, scale = model.robot, length_scale(model.robot, q, label.point)
    if model.witness is None:
        return certified(model, lambda _: np.zeros(()), scale)[1]
    columns = robot.velocity_columns(dict.fromkeys(coordinates.joints))
    mine, chain = q[:, list(coordinates.indices)], tool.chain.fold.shape[1]
    offset = np.eye(4) if label.point is None else se3.placement(np.eye(3), np.array(label.point))

    def of_tool(engine: Engine) -> Array:
        matrix = by_coordinates(engine.jacobian(q, label)[..., columns], mine, coordinates)[..., :chain]
        placed = (engine.placement(q, label.of, label.relative_to) @ offset)[..., :3, :]
        values = np.linalg.svd(tool.weighed(matrix), compute_uv=False).astype(np.float64)
        return _flat(placed, matrix, values)

    found = _evaluated(tool, mine[:, :chain], count)
    by_kernel = _flat(found["placement"], found["jacobian"], found["singular_values"])
    factor = 1.0 if tool.row_factors is None else float(np.max(tool.row_factors))
    slides = 1.0 if tool.column_factors is None else float(np.max(tool.column_factors))
    proofs = [_with(by_kernel, *certified(model, of_tool, scale * max(1.0, factor) * max(1.0, slides)))]
    gravity = joints.gravity
    if joints.tree is not None and gravity is not None:
        loads = carried(robot, payload, gravity)

        def torques(engine: Engine) -> Array:
            return by_coordinates(engine.holding_torques(q, gravity, loads)[..., columns], mine, coordinates)

        both = certified(model, torques, load_scale(robot, q, loads), force_scale(model, gravity, loads))
        proofs.append(_with(_evaluated(joints, mine, count)["gravity_torque"], *both))
    return combined(proofs)


def _evaluated(kernel: Kernel, q: Array, count: int) -> dict[str, Array]:
    """Return what a kernel gives for some of `count` configurations."""
    return kernel.definition(q) if count <= _FEW else kernel(q)


def _flat(*parts: Array) -> Array:
    return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=-1)


def _with(by_kernel: Array, by_engines: Array, proof: Certificate) -> Certificate:
    """Return a certificate in which the kernel's numbers count, too."""
    apart = np.abs(by_kernel - by_engines)
    difference = float(np.max(apart, initial=0.0)) if np.all(np.isfinite(apart)) else float("inf")
    largest = max(difference, proof.max_difference or 0.0)
    values = () if largest <= proof.tolerance else (by_engines, by_kernel)
    return Certificate((*proof.engines, _KERNEL), largest, proof.tolerance, values, proof.numbers)
