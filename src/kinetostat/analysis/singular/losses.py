"""What a singular configuration loses, and what moves inside: null spaces as screws and as joint rates, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.singular.kind import second_order_forms
from kinetostat.analysis.singular.mechanism import MODEL, Mechanism
from kinetostat.conventions import Array
from kinetostat.errors import cut
from kinetostat.screw import so3

__all__ = ["LostWrench", "SelfMotion", "lost_space", "lost_wrenches", "motion_space", "self_motions"]

_NOTHING = 1e-8  # size of a form that is rounding
_PURE = 1e-6  # relative size below which a part of a screw is nothing
_FIRST_STEP = 1e-3  # rad or L, of a walk
_STEP = 0.02
_STEPS = 8
_STAYED = 1e-11  # how far the tool may have moved, in rad and L
_FLAT = 1e-7  # singular value along which the tool cannot be put back


@dataclass(frozen=True)
class LostWrench:
    """A wrench that no joint feels: the motion along it is lost.

    Attributes:
        wrench: (f ; m) in the observer's axes, moment about the tool point, |f| = 1 or, where f = 0, |m| = 1. (6,).
        axis: unit direction of its screw, in the observer's axes. (3,).
        point: the point of the screw's axis next to the tool point, in the observer's coordinates; None for a couple.
        pitch: f.m / f.f in m per rad; infinite for a couple.
        words: what it means for the tool.
    """

    wrench: Array
    axis: Array
    point: Array | None
    pitch: float
    words: str


@dataclass(frozen=True)
class SelfMotion:
    """Joint rates that do not move the tool.

    Attributes:
        rates: rate of each coordinate, the largest being 1. (n,), rad/s and m/s.
        finite: whether the arm can walk along them, the tool at rest; else the motion is only instantaneous.
    """

    rates: Array
    finite: bool


def motion_space(mechanism: Mechanism, q: Array, rank: int) -> Array:
    """Return an orthonormal basis of the rates that move nothing at q, as columns. (n,) -> (n, n - rank)."""
    _, _, right = np.linalg.svd(mechanism.jacobian(q))
    basis: Array = right[rank:].T
    return basis


def lost_space(mechanism: Mechanism, q: Array, rank: int) -> Array:
    """Return an orthonormal basis of the wrenches that are lost at q and not everywhere, as columns. (m, r - rank).

    Where the structure leaves no wrench unfelt (r = m) that is the left null space. Where it does, the part of the null
    space that nearby configurations can move along: that of dJ v for the rates v that move nothing at q.
    """
    left, _, right = np.linalg.svd(mechanism.jacobian(q))
    unfelt, lost = left[:, rank:], mechanism.generic_rank - rank
    if unfelt.shape[1] == lost:
        return unfelt
    _, along = mechanism.derivatives(q)
    regained = unfelt.T @ np.einsum("rij,ik->rjk", along, right[rank:].T).reshape(len(left), -1)
    directions, sizes, _ = np.linalg.svd(regained)
    if sizes[lost - 1] < MODEL:  # no first-order motion brings it back: look a little away
        near = q + 1e-3 * mechanism.units * np.random.default_rng(0).normal(size=(32, len(q)))
        beside = np.linalg.svd(mechanism.jacobian(near))[0][..., rank : mechanism.generic_rank]
        directions = np.linalg.svd(unfelt.T @ np.concatenate(list(beside), axis=-1))[0]
    taken: Array = unfelt @ directions[:, :lost]
    return _plainest(mechanism, taken, unfelt @ directions[:, lost:])


def _plainest(mechanism: Mechanism, lost: Array, everywhere: Array) -> Array:
    """Return lost wrenches plus such as are unfelt everywhere, so as to be plain couples or forces if they can."""
    rows = np.array(mechanism.task.rows)
    plain = lost.copy()
    everywhere = np.where(np.abs(everywhere) < np.finfo(float).eps, 0.0, everywhere)  # columns of length 1: rounding
    for unwanted in (rows >= 3, rows < 3):  # forces through the tool point first, couples win
        share, *_ = np.linalg.lstsq(everywhere[unwanted], -lost[unwanted], rcond=None)
        candidate = lost + everywhere @ share
        clean = np.linalg.norm(candidate[unwanted], axis=0) < MODEL
        plain[:, clean] = (candidate / np.linalg.norm(candidate, axis=0))[:, clean]
    return plain


def lost_wrenches(mechanism: Mechanism, q: Array, basis: Array) -> tuple[LostWrench, ...]:
    """Return the wrenches of a basis (m, k), forces before couples, as few components in each as possible."""
    rows = np.zeros((6, basis.shape[1]))
    rows[list(mechanism.task.rows)] = basis
    rows[:3] /= mechanism.length  # back to metres: power is the same in both
    _, placement = mechanism.chain.columns(q)
    if mechanism.local:
        rows = np.concatenate([placement[:3, :3] @ rows[:3], placement[:3, :3] @ rows[3:]])
    tool = mechanism.tool(q)
    arm = placement[:3, 3] - tool
    rows[3:] += np.cross(arm, rows[:3].T).T
    size = mechanism.length + float(np.linalg.norm(arm))
    in_size = np.repeat([1.0, size], 3)  # forces and moments of one size, as long as they are compared
    noise = max(_PURE, 10 * mechanism.tolerance if mechanism.rounded else 0.0)
    return tuple(_lost_wrench(mechanism, row * in_size, tool, size, noise) for row in _plain_basis(rows.T / in_size))


def _lost_wrench(mechanism: Mechanism, wrench: Array, tool: Array, reach: float, noise: float) -> LostWrench:
    """Return a wrench with its screw and its meaning; `reach` is the size of moments for unit forces, in m."""
    body = cut(mechanism.velocity.of)
    force, moment = wrench[:3], wrench[3:]
    size = float(np.linalg.norm(force)) * reach
    if size <= _PURE * float(np.linalg.norm(moment)):
        wrench = _signed(np.concatenate([np.zeros(3), moment / np.linalg.norm(moment)]))
        words = f"{body} cannot turn about {_direction(mechanism, wrench[3:])}; it resists any moment about it"
        return LostWrench(wrench, wrench[3:], None, math.inf, words)
    wrench = _signed(wrench / np.linalg.norm(force))
    force, moment = wrench[:3], wrench[3:]
    pitch, arm = float(force @ moment), np.cross(force, moment)
    pitch = pitch if abs(pitch) > noise * mechanism.length else 0.0
    through = float(np.linalg.norm(arm)) <= _PURE * mechanism.length
    point = tool if through else tool + arm
    along = _direction(mechanism, force)
    at = f"({', '.join(f'{c:.4g}' for c in np.where(np.abs(point) < _PURE * reach, 0.0, point))})"
    if pitch:
        words = (
            f"{body} moves along the line through {at} along {along} only as it turns about it: "
            f"v = {-pitch:.4g} m/rad w"
        )
    elif through:
        words = f"{body} cannot move along {along}; it resists any force along this line"
    else:
        words = f"the point {at} of {body} cannot move along {along}; it resists any force on this line"
    return LostWrench(wrench, force, point, pitch, words)


def _plain_basis(rows: Array) -> Array:
    """Return a basis of wrenches that are plain to read: few components, or plain forces where two span a pencil."""
    plain = _sparse(rows)
    pitches = np.einsum("ai,bi->ab", plain[:, :3], plain[:, 3:])
    if len(plain) != 2 or float(np.max(np.abs(np.diag(pitches)))) < _PURE:
        return plain
    forces = _isotropic((pitches + pitches.T) / 2)
    return plain if forces is None else forces @ plain


def _isotropic(form: Array) -> Array | None:
    """Return the two vectors x with x^T F x = 0 of a symmetric form (2, 2), as rows; None where F is of one sign or 0.

    Of a x^2 + 2 b x y + c y^2, with t = -(b + sign(b) sqrt(b^2 - a c)): (t, a) and (c, t), which lose no digits.
    """
    (a, b), (_, c) = form
    size, discriminant = float(np.max(np.abs(form))), b * b - a * c
    if size < _NOTHING or discriminant <= _PURE * size * size:
        return None
    t = -(b + math.copysign(math.sqrt(discriminant), b))
    return np.array([[t, a], [c, t]])


def _direction(mechanism: Mechanism, direction: Array) -> str:
    frame = cut(mechanism.velocity.relative_to)
    nearest = int(np.argmax(np.abs(direction)))
    if abs(direction[nearest]) > 1 - 1e-9:
        return f"{'xyz'[nearest]} of {frame}"
    return f"({', '.join(f'{round(float(part), 4) + 0.0:g}' for part in direction)}) of {frame}"


def self_motions(mechanism: Mechanism, q: Array, basis: Array, lost: Array) -> tuple[SelfMotion, ...]:
    """Return rates that span a basis (n, k), each walked to see whether it is finite.

    Where one direction is lost (m, 1) and two motions remain, they are those of which the second-order form is zero, if
    there are such: the others cannot be finite. Else as few joints in each as possible.
    """
    rows = _sparse((basis * mechanism.units[:, None]).T)
    if len(rows) == 2 and lost.shape[1] == 1:
        forms = second_order_forms(mechanism, q, lost, (rows / mechanism.units).T)[0]
        free = _isotropic(forms)
        rows = rows if free is None else free @ rows
    found = []
    for row in rows:
        rates = _signed(row / np.max(np.abs(row)))
        found.append(SelfMotion(rates, _walks(mechanism, q, rates) or _walks(mechanism, q, -rates)))
    return tuple(found)


def _walks(mechanism: Mechanism, start: Array, rates: Array) -> bool:
    """Return whether the arm can move along the rates for a while with the tool at rest.

    The first step is short and must go where the rates point; then the way may bend.
    """
    direction = rates / mechanism.units / np.linalg.norm(rates / mechanism.units)
    q = start
    for size, straight in ((_FIRST_STEP, 0.999), *((_STEP, 0.9),) * _STEPS):
        there = _held_still(mechanism, q + size * direction * mechanism.units, start)
        if there is None:
            return False
        moved = (there - q) / mechanism.units
        length = float(np.linalg.norm(moved))
        if length < size / 2 or float(moved @ direction) < straight * length:
            return False
        q, direction = there, moved / length
    return True


def _held_still(mechanism: Mechanism, q: Array, start: Array) -> Array | None:
    """Return a configuration next to q with the tool where it is at `start`, by Gauss-Newton; None if none is found."""
    rows = list(mechanism.task.rows)
    _, home = mechanism.chain.columns(start)
    to_axes = home[:3, :3].T
    for _ in range(12):
        _, placement = mechanism.chain.columns(q)
        gap = _gap(placement, home, mechanism.length)
        gap = (np.concatenate([to_axes @ gap[:3], to_axes @ gap[3:]]) if mechanism.local else gap)[rows]
        if float(np.max(np.abs(gap))) < _STAYED:
            return q
        left, values, right = np.linalg.svd(mechanism.jacobian(q), full_matrices=False)
        kept = values > _FLAT
        q = q - mechanism.units * (right[kept].T @ (left[:, kept].T @ gap / values[kept]))
    return None


def _gap(placement: Array, home: Array, length: float) -> Array:
    """Return how far a placement is from home: displacement in units of L, rotation vector in rad. (6,)."""
    turn = so3.log(placement[:3, :3] @ home[:3, :3].T)
    return np.concatenate([(placement[:3, 3] - home[:3, 3]) / length, turn])


def _sparse(rows: Array) -> Array:
    """Return another basis of the row space with as many zeros as elimination gives. (k, n) -> (k, n)."""
    reduced = rows.copy()
    row = 0
    for column in range(rows.shape[1]):
        if row == len(reduced):
            break
        pivot = row + int(np.argmax(np.abs(reduced[row:, column])))
        if abs(reduced[pivot, column]) < 1e-4 * float(np.max(np.abs(reduced[row:]))):
            continue
        reduced[[row, pivot]] = reduced[[pivot, row]]
        reduced[row] /= reduced[row, column]
        others = np.arange(len(reduced)) != row
        reduced[others] -= np.outer(reduced[others, column], reduced[row])
        row += 1
    cleaned: Array = np.where(np.abs(reduced) < 1e-9 * np.max(np.abs(reduced), axis=1, keepdims=True), 0.0, reduced)
    return cleaned


def _signed(vector: Array) -> Array:
    """Return the vector with the sign that makes its largest entry positive."""
    largest = vector[int(np.argmax(np.abs(vector).round(9)))]
    return vector if largest > 0 else -vector
