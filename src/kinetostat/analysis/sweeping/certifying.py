"""The certificate of a batch: some of its rows computed again by Pinocchio, output by output."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.crosscheck import Certificate, length_scale
from kinetostat.analysis.loads import Payload, carried, force_scale, load_scale
from kinetostat.analysis.planar import by_coordinates, planar_places, rotated
from kinetostat.conventions import Array, Load, Velocity, tolerance
from kinetostat.screw.kernel import Kernel, effort_use

__all__ = ["UNCHECKED", "RowWitness", "row_witness"]

UNCHECKED = ("limit_distance",)  # by an engine: a question of coordinates and limits, computed again in plain Python
_TORQUES = ("gravity_torque", "effort_use")
_GRADIENTS = ("yoshikawa_gradient", "minimum_gradient")
_GAP = 1e-6  # of the largest singular value: gradients of one that is so near to zero, or to the next, have no digits
_SHORT = 16  # coordinates: derivatives along each of them are compared,
_DIRECTIONS, _SIGNS_SEED = 4, 0x51675  # and along so many directions where there are more
_LIMITS = 1e-8  # of half a range: limits are not known as exactly as arithmetic is
_NARROW = 1e7  # size of numbers over half a range, from which on too few digits are left
_ONE_AT_A_TIME = threading.Lock()  # an engine has one workspace


@dataclass(frozen=True, repr=False)
class RowWitness:
    """Pinocchio's word on a kernel's numbers, and plain Python's on the distance to limits. It is picklable.

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
        """Return how far apart the kernel's outputs and Pinocchio's are, in each row. (k, n), {(k, ...)} -> {(k,)}.

        Gradients of more than 16 coordinates are compared along four directions, whose entries are 1 or -1 by chance,
        instead of entry by entry, with sqrt(n) times the tolerance: a wrong entry shows in each of them.
        """
        along = self._directions
        with _ONE_AT_A_TIME:
            again = self._again(q, along)
        found = {}
        for name in self.tolerances:
            ours, theirs, scale = outputs[name], again[name], again[f"{name} scale"]
            if name in _GRADIENTS and along is not None:
                ours, scale = ours @ along.T, scale * np.sqrt(along.shape[1])
            with np.errstate(invalid="ignore"):
                apart = np.abs(ours - theirs) / scale.reshape(-1, *(1,) * (ours.ndim - 1))
            apart = np.where(np.isnan(ours) & np.isnan(theirs), 0.0, np.where(np.isnan(apart), np.inf, apart))
            apart = apart.reshape(len(q), -1)
            found[name] = np.where(np.isinf(scale), 0.0, np.max(apart, axis=1, initial=0.0))
        return found

    def certificate(
        self, name: str, difference: float | None, values: tuple[Array, ...] = (), numbers: int = 0
    ) -> Certificate:
        """Return what the two engines say of an output, given the largest difference; None if nothing was compared.

        `numbers`: of how many numbers.
        """
        second = "python" if name in UNCHECKED else "pinocchio"
        engines = ("screw",) if difference is None else (second, "screw")
        return Certificate(engines, difference, self.tolerances[name], values, 0 if difference is None else numbers)

    def row_size(self, name: str) -> int:
        """Return how many numbers an output has in a row; of gradients, how many are compared."""
        n = len(self.coordinates.names)
        if name in _GRADIENTS and self._directions is not None:
            return _DIRECTIONS
        sizes = {"placement": 12, "jacobian": 6 * n, "singular_values": self.kernel.values}
        return sizes.get(name, 1 if name in ("yoshikawa", "limit_distance") else n)

    def again(self, q: Array) -> dict[str, Array]:
        """Return the kernel's outputs by Pinocchio, and by how much each row magnifies ("NAME scale"). (k, n)."""
        with _ONE_AT_A_TIME:
            return self._again(q)

    @property
    def _directions(self) -> Array | None:
        """Along which derivatives of a long chain are compared, (d, n); None: along each coordinate."""
        n = len(self.coordinates.names)
        if n <= _SHORT:
            return None
        signs = np.random.Generator(np.random.Philox(key=_SIGNS_SEED)).integers(2, size=(_DIRECTIONS, n))
        return np.where(signs == 1, 1.0, -1.0)

    def _again(self, q: Array, along: Array | None = None) -> dict[str, Array]:
        engine, wanted = self.coordinates.model.engine, set(self.tolerances)
        whole, one = self.coordinates.configuration(q, self.rest), np.ones(len(q))
        found: dict[str, Array] = {f"{name} scale": one for name in wanted}
        if "placement" in wanted:
            placement = engine.placement(whole, self.velocity.of, self.velocity.relative_to).copy()
            point = np.array([*(self.velocity.point or (0.0, 0.0, 0.0)), 1.0])
            placement[..., :3, 3] = (placement @ point)[..., :3]
            found["placement"] = placement[..., :3, :]
        if wanted - {"placement", *_TORQUES, *UNCHECKED}:
            found |= self._jacobians(whole, q, along)
        if "limit_distance" in wanted:
            found |= self._limit_distance(q)
        if wanted & set(_TORQUES):
            gravity = np.zeros(3) if self.kernel.gravity is None else self.kernel.gravity
            torques = engine.holding_torques(whole, gravity, self.loads)[..., self._columns]
            found["gravity_torque"] = by_coordinates(torques, q, self.coordinates)
            limits = self.kernel.effort_limits
            if "effort_use" in wanted and limits is not None:
                found["effort_use"] = effort_use(found["gravity_torque"], limits)
                found["effort_use scale"] = one / np.nanmin(np.abs(limits), initial=1.0)
        return found

    @property
    def _columns(self) -> list[int]:
        """Where the chain's columns are among those of the whole robot."""
        return self.coordinates.model.robot.velocity_columns(list(dict.fromkeys(self.coordinates.joints)))

    def _jacobians(self, whole: Array, q: Array, along: Array | None) -> dict[str, Array]:
        """Return Jacobian, singular values and their product, and gradients, along directions (d, n), if compared."""
        own = self.coordinates.model.engine.jacobian(whole, self.velocity)[..., self._columns]
        jacobian = by_coordinates(own, q, self.coordinates)
        u, s, vt = np.linalg.svd(self.kernel.weighed(jacobian), full_matrices=False)
        count = self.kernel.values
        magnified = np.maximum(1.0, count * s[:, 0] ** (count - 1))
        found = {"jacobian": jacobian, "singular_values": s[:, :count], "yoshikawa": np.prod(s[:, :count], axis=-1)}
        if set(_GRADIENTS) & set(self.tolerances):
            along = np.eye(q.shape[1]) if along is None else along
            # d(J W)/dt = dJ/dt W + J dW/dt; (k, d, 6, n) -> (k, 6, n, d)
            rates = self._jacobian_rates(whole, q, along)
            derivative = by_coordinates(rates, q, self.coordinates) + self._turned(own, q, along)
            weighed = self.kernel.weighed(np.moveaxis(derivative, 1, -1), columns_at=-2)
            slopes = np.einsum("kri,krcj,kic->kij", u, weighed, vt)
            found |= _gradients(s, slopes, magnified)
        return {**found, "yoshikawa scale": magnified}

    def _jacobian_rates(self, whole: Array, q: Array, along: Array) -> Array:
        """Return how the engine's columns change while coordinates move along directions. (d, n) -> (k, d, 6, n)."""
        rates = np.zeros((len(q), len(along), self.coordinates.model.robot.nv))
        moved = np.tile(along, (len(q), 1, 1))
        for j in planar_places(self.coordinates):
            moved[..., j : j + 2] = rotated(moved[..., j : j + 2], -q[:, j + 2])
        rates[..., self._columns] = moved
        found: Array = self.coordinates.model.engine.jacobian_rate(whole[:, None, :], rates, self.velocity)
        return found[..., self._columns]

    def _turned(self, columns: Array, q: Array, along: Array) -> Array:
        """Return M dW/dt of engine's columns M while coordinates move along directions. (d, n) -> (k, d, 6, n)."""
        found = np.zeros((len(q), len(along), *columns.shape[1:]))
        for j in planar_places(self.coordinates):
            turned = rotated(columns[..., j : j + 2], q[:, j + 2] + np.pi / 2)  # dR/dtheta is R, a quarter turn on
            found[..., j : j + 2] = along[:, j + 2, None, None] * turned[:, None]
        return found

    def _limit_distance(self, q: Array) -> dict[str, Array]:
        """Return the distance to limits, and by how much its rounding is magnified, from the file's numbers alone.

        A follower's limits count as its leader's. Ranges that are hardly any are not compared.
        """
        robot = self.coordinates.model.robot
        distance, scale = np.ones(len(q)), np.ones(len(q))
        for joint, value in zip(self.coordinates.joints, q.T, strict=True):
            if joint.type.nq != 1:
                continue
            low, high = joint.limit.range
            laws = [(robot.joint_by_name[name], law) for name, law in robot.followers.items()]
            for follower, law in laws:
                if law.joint == joint.name and law.multiplier:
                    a, b = ((end - law.offset) / law.multiplier for end in follower.limit.range)
                    low, high = max(low, min(a, b)), min(high, max(a, b))
            if low >= high:
                low, high = joint.limit.range  # no follower can be anywhere
            if np.isfinite(low) and np.isfinite(high):
                with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
                    half = high / 2 - low / 2
                    distance = np.fmin(distance, np.fmin((value - low) / half, (high - value) / half))
                    scale = np.fmax(scale, (abs(low) + abs(high) + np.abs(value)) / half)
        return {"limit_distance": distance, "limit_distance scale": np.where(scale < _NARROW, scale, np.inf)}


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
        elif name in UNCHECKED:
            tolerances[name] = _LIMITS
        else:
            tolerances[name] = geometric if name in ("placement", "jacobian") else weighed
    return RowWitness(coordinates, kernel, rest, velocity, loads, tolerances)
