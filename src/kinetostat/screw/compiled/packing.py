"""Chains and trees of screws as the compiled code takes them: one placement between every two joints, z along the axis.

Frame i has its z axis along screw i, and turns and advances with it. Then

    T_i = T_parent A_i Rot_z(turn t) Trans_z(slide t),    t = ratio q[driver] + offset

with constant A_i: the same product of exponentials as in `chain` and `tree`, in local form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from kinetostat.conventions import Array, Flags
from kinetostat.screw import se3, so3
from kinetostat.screw.chain import Chain
from kinetostat.screw.tree import Tree

__all__ = ["PackedMasses", "PackedScrews", "pack_chain", "pack_tree"]


class PackedScrews(NamedTuple):
    """Screws as arrays.

    Attributes:
        steps: the upper rows of A_i, row by row; after them those of the tool in the last frame. (s + 1, 12).
        parents: the frame before each, -1 for none. (s,).
        turns: 1 for a screw that turns, 0 for a slide. (s,).
        slides: how far it advances, m per rad, or per unit of a slide. (s,).
        ratios: how far it moves for its coordinate. (s,).
        offsets: where it is at q = 0. (s,).
        drivers: its coordinate. (s,).
        first: whether it is the first screw of its coordinate. (s,).
    """

    steps: Array
    parents: npt.NDArray[np.int64]
    turns: Array
    slides: Array
    ratios: Array
    offsets: Array
    drivers: npt.NDArray[np.int64]
    first: Flags


class PackedMasses(NamedTuple):
    """Masses on the frames of packed screws.

    Attributes:
        own: the mass of each body times its centre in its frame, and the mass itself. (s, 4), kg m, kg.
        beyond: the mass of each body and of all beyond it. (s,), kg.
    """

    own: Array
    beyond: Array


def pack_chain(chain: Chain) -> PackedScrews:
    """Return a chain packed."""
    count = chain.screws.shape[1]
    packed, _ = _pack(chain.screws, tuple(range(-1, count - 1)), chain.fold, chain.offset, chain.home)
    return packed


def pack_tree(tree: Tree) -> tuple[PackedScrews, PackedMasses]:
    """Return a tree and its masses packed."""
    packed, frames = _pack(tree.screws, tree.parents, tree.fold, tree.offset, np.eye(4))
    own, beyond = np.zeros((len(tree.masses), 4)), tree.masses.astype(np.float64)
    for k, (mass, centre) in enumerate(zip(tree.masses, tree.centres, strict=True)):
        own[k, :3], own[k, 3] = mass * se3.transform(se3.inverse(frames[k]), centre), mass
    for k in reversed(range(len(tree.parents))):
        if tree.parents[k] >= 0:
            beyond[tree.parents[k]] += beyond[k]
    return packed, PackedMasses(own, beyond)


def _pack(
    screws: Array, parents: tuple[int, ...], fold: Array, offset: Array, home: Array
) -> tuple[PackedScrews, list[Array]]:
    """Return screws packed, and their frames at t = 0 in the coordinates of the screws."""
    if np.any(np.count_nonzero(fold, axis=1) > 1):
        raise ValueError("a screw has one coordinate")
    count, frames, steps = screws.shape[1], list[Array](), list[Array]()
    turns, slides = np.ones(count), np.zeros(count)
    for i, parent in enumerate(parents):
        before = np.eye(4) if parent < 0 else frames[parent]
        v, w = screws[:3, i], screws[3:, i]
        if np.linalg.norm(w) > 0.5:
            slides[i] = v @ w
            foot = np.cross(w, v)  # of the perpendicular from the origin; then the point nearest to the frame before
            origin, axis = foot + w * (w @ (before[:3, 3] - foot)), w
        else:
            turns[i], slides[i] = 0.0, np.linalg.norm(v)
            origin, axis = before[:3, 3], v / slides[i]
        frames.append(se3.placement(so3.carry_z_to(axis), origin))
        steps.append(se3.inverse(before) @ frames[i])
    steps.append((se3.inverse(frames[-1]) if frames else np.eye(4)) @ home)
    drivers = _drivers(fold)
    packed = PackedScrews(
        np.array(steps)[:, :3, :].reshape(-1, 12),
        np.array(parents, dtype=np.int64),
        turns,
        slides,
        np.take_along_axis(fold, drivers[:, None], axis=1)[:, 0] if count else np.zeros(0),
        np.asarray(offset, dtype=np.float64),
        drivers,
        np.array([driver not in drivers[:i] for i, driver in enumerate(drivers)], dtype=np.bool_),
    )
    return packed, frames


def _drivers(fold: Array) -> npt.NDArray[np.int64]:
    """Return the coordinate of each screw, (s, n) -> (s,). Every coordinate has one, if need be an idle one.

    A coordinate without a screw is the leader of followers that never move (multiplier 0); its columns are zero.
    """
    drivers = np.argmax(np.abs(fold), axis=1) if len(fold) else np.zeros(0, dtype=np.int64)
    idle, lost = np.flatnonzero(~np.any(fold, axis=1)), np.flatnonzero(~np.any(fold, axis=0))
    pairs = min(len(idle), len(lost))
    drivers[idle[:pairs]] = lost[:pairs]
    return drivers.astype(np.int64)
