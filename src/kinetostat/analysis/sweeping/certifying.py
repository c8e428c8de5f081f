"""The certificate of a batch: some of its rows computed again by Pinocchio, output by output."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.crosscheck import Certificate, length_scale
from kinetostat.analysis.loads import Payload, carried, force_scale, load_scale
from kinetostat.conventions import PLANAR_POSITION, Array, Load, Velocity, tolerance
from kinetostat.screw.kernel import Kernel, effort_use
from kinetostat.urdf.description import JointType

__all__ = ["UNCHECKED", "RowWitness", "row_witness"]

UNCHECKED = ("limit_distance",)  # a question of coordinates and limits, not of an engine
_TORQUES = ("gravity_torque", "effort_use")
_GRADIENTS = ("yoshikawa_gradient", "minimum_gradient")
_GAP = 1e-6  # of the largest singular value: gradients of one that is so near to zero, or to the next, have no digits
_ONE_AT_A_TIME = threading.Lock()  # an engine has one workspace


@dataclass(frozen=True, repr=False)
class RowWitness:
    """Pinocchio's word on a kernel's numbers. It is picklable.

    Differences are brought to a common scale, so that one tolerance does for all rows: singular values are as exact as
    the Jacobian; their product is compared after division by the k s_1^(k-1) by which it magnifies differences of them,
    gradients by what the gaps between singular values magnify, effort use by the smallest effort limit.

    Attributes:
        coordinates: the chain.
        kernel: what computes the batch.
        rest: where all other joints are. (nq,).
        velocity: whose Jacobian it is.
        loads: what is carried.
        tolerances: the largest difference that counts as agreement, for each of the kernel's outputs that is compared.
    """

    coordinates: Coordinates
    kernel: Kernel
    rest: Array
    velocity: Velocity
    loads: tuple[Load, ...]
    tolerances: dict[str, float]

    def differences(self, q: Array, outputs: Mapping[str, Array]) -> dict[str, Array]:
        """Return how far apart the kernel's outputs and Pinocchio's are, in each row. (k, n), {(k, ...)} -> {(k,)}."""
        again = self.again(q)
        found = {}
        for name in self.tolerances:
            ours, theirs, scale = outputs[name], again[name], again[f"{name} scale"]
            with np.errstate(invalid="ignore"):
                apart = np.abs(ours - theirs) / scale.reshape(-1, *(1,) * (ours.ndim - 1))
            apart = np.where(np.isnan(ours) & np.isnan(theirs), 0.0, np.where(np.isnan(apart), np.inf, apart))
            apart = apart.reshape(len(q), -1)
            found[name] = np.where(np.isinf(scale), 0.0, np.max(apart, axis=1, initial=0.0))
        return found

    def certificate(self, name: str, difference: float | None, values: tuple[Array, ...] = ()) -> Certificate:
        """Return what the two engines say of an output, given the largest difference; None if nothing was compared."""
        engines = ("screw",) if difference is None else ("pinocchio", "screw")
        return Certificate(engines, difference, self.tolerances[name], values)

    def again(self, q: Array) -> dict[str, Array]:
        """Return the kernel's outputs by Pinocchio, and by how much each row magnifies ("NAME scale"). (k, n)."""
        with _ONE_AT_A_TIME:
            return self._again(q)

    def _again(self, q: Array) -> dict[str, Array]:
        engine, wanted = self.coordinates.model.engine, set(self.tolerances)
        whole, one = self.coordinates.configuration(q, self.rest), np.ones(len(q))
        found: dict[str, Array] = {f"{name} scale": one for name in wanted}
        if "placement" in wanted:
            placement = engine.placement(whole, self.velocity.of, self.velocity.relative_to).copy()
            point = np.array([*(self.velocity.point or (0.0, 0.0, 0.0)), 1.0])
            placement[..., :3, 3] = (placement @ point)[..., :3]
            found["placement"] = placement[..., :3, :]
        if wanted - {"placement", *_TORQUES}:
            found |= self._jacobians(whole, q)
        if wanted & set(_TORQUES):
            rates, _ = self._rates(q)
            gravity = np.zeros(3) if self.kernel.gravity is None else self.kernel.gravity
            torques = engine.holding_torques(whole, gravity, self.loads)[..., self._columns]
            found["gravity_torque"] = np.einsum("kij,ki->kj", rates, torques)
            limits = self.kernel.effort_limits
            if "effort_use" in wanted and limits is not None:
                found["effort_use"] = effort_use(found["gravity_torque"], limits)
                found["effort_use scale"] = one / np.nanmin(np.abs(limits), initial=1.0)
        return found

    @property
    def _columns(self) -> list[int]:
        """Where the chain's columns are among those of the whole robot."""
        return self.coordinates.model.robot.velocity_columns(list(dict.fromkeys(self.coordinates.joints)))

    def _jacobians(self, whole: Array, q: Array) -> dict[str, Array]:
        """Return Jacobian, singular values and their product, and gradients where they are compared."""
        rates, turned = self._rates(q)
        own = self.coordinates.model.engine.jacobian(whole, self.velocity)[..., self._columns]
        jacobian = own @ rates
        u, s, vt = np.linalg.svd(self.kernel.weighed(jacobian), full_matrices=False)
        count = s.shape[-1]
        magnified = np.maximum(1.0, count * s[:, 0] ** (count - 1))
        found = {"jacobian": jacobian, "singular_values": s, "yoshikawa": np.prod(s, axis=-1)}
        if set(_GRADIENTS) & set(self.tolerances):
            everything = np.zeros((*q.shape, self.coordinates.model.robot.nv))
            everything[..., self._columns] = np.swapaxes(rates, -1, -2)
            along = self.coordinates.model.engine.jacobian_rate(whole[:, None, :], everything, self.velocity)
            # d(J W)/dq_j = dJ/dq_j W + J dW/dq_j; (k, j, 6, n) -> (k, 6, n, j)
            derivative = np.moveaxis(along[..., self._columns] @ rates[:, None] + own[:, None] @ turned, 1, -1)
            slopes = np.einsum("kri,krcj,kic->kij", u, self.kernel.weighed(derivative, columns_at=-2), vt)
            found |= _gradients(s, slopes, magnified)
        return {**found, "yoshikawa scale": magnified}

    def _rates(self, q: Array) -> tuple[Array, Array]:
        """Return W with (rates of the engine's columns) = W dq/dt, (k, n, n), and dW/dq_j, (k, j, n, n).

        They are the same but for planar joints, whose rates are a twist in the moved link's axes: (vx, vy) = R(-theta)
        d(x, y)/dt.
        """
        n = len(self.coordinates.names)
        rates, turned = np.tile(np.eye(n), (len(q), 1, 1)), np.zeros((len(q), n, n, n))
        j = 0
        for joint in dict.fromkeys(self.coordinates.joints):
            if joint.type is JointType.PLANAR:
                angle = q[:, j + len(PLANAR_POSITION) - 1]
                c, s = np.cos(angle), np.sin(angle)
                block = slice(j, j + 2)
                rates[:, block, block] = np.moveaxis(np.array([[c, s], [-s, c]]), -1, 0)
                turned[:, j + 2, block, block] = np.moveaxis(np.array([[-s, c], [-c, -s]]), -1, 0)
            j += joint.type.nq
        return rates, turned


def _gradients(values: Array, slopes: Array, magnified: Array) -> dict[str, Array]:
    """Return both gradients, and by how much each magnifies: infinitely, where it has no digits.

    From singular values (k, s), their slopes (k, s, n), and by how much their product magnifies, (k,).
    """
    count, smallest = values.shape[-1], values[:, -1]
    others = np.stack([np.prod(np.delete(values, i, axis=-1), axis=-1) for i in range(count)], -1)
    steep = np.max(np.abs(slopes), axis=(1, 2), initial=1.0)
    gap = smallest if count == 1 else np.minimum(smallest, values[:, -2] - smallest)
    nothing = _GAP * values[:, 0]
    with np.errstate(divide="ignore"):
        least, product = 1 + steep / gap, magnified * (1 + count * steep / smallest)
    return {
        "minimum_gradient": slopes[:, -1, :],
        "minimum_gradient scale": np.where(gap <= nothing, np.inf, least),
        "yoshikawa_gradient": np.einsum("ki,kij->kj", others, slopes),
        "yoshikawa_gradient scale": np.where(smallest <= nothing, np.inf, product),
    }


def row_witness(
    coordinates: Coordinates,
    kernel: Kernel,
    rest: Array,
    velocity: Velocity,
    bounds: Array,
    payload: Payload | None = None,
) -> RowWitness:
    """Return who checks the rows of a batch.

    Args:
        coordinates: the chain.
        kernel: what computes the batch.
        rest: where all other joints are, (nq,).
        velocity: whose Jacobian the kernel gives.
        bounds: lower and upper ends, which no row is outside; tolerances grow with them. (2, n).
        payload: what the kernel's tree carries besides the links.

    Raises:
        UnknownNameError: no such frame.
        UsageError: a payload that cannot be.
    """
    model, robot = coordinates.model, coordinates.model.robot
    gravity = np.zeros(3) if kernel.gravity is None else kernel.gravity
    loads, farthest = tuple(carried(robot, payload, gravity)), np.max(np.abs(bounds), axis=0)
    whole = coordinates.configuration(farthest, rest)
    geometric = tolerance(length_scale(robot, whole, velocity.point), robot.largest_multiplier)
    factors = [np.ones(1) if part is None else part for part in (kernel.row_factors, kernel.column_factors)]
    weighed = geometric * max(1.0, float(np.max(factors[0]))) * max(1.0, float(np.max(factors[1])))
    tolerances = {}
    for name in kernel.outputs:
        if name in _TORQUES:
            tolerances[name] = tolerance(load_scale(robot, whole, loads), force_scale(model, gravity, loads))
        elif name not in UNCHECKED:
            tolerances[name] = geometric if name in ("placement", "jacobian") else weighed
    return RowWitness(coordinates, kernel, rest, velocity, loads, tolerances)
