"""What pictures of singularities show: the smallest singular value over two joints, and curves in the workspace."""

from __future__ import annotations

from dataclasses import dataclass

from kinetostat.conventions import Array

__all__ = ["Curve", "Mark", "Slice", "Workspace"]


@dataclass(frozen=True)
class Mark:
    """Where a family meets a slice: a line x = value, a line y = value, or a point.

    Attributes:
        label: the family's condition, such as "joint3 = 0".
        x: the value on the first axis, or None for a horizontal line.
        y: the value on the second axis, or None for a vertical line.
        inside: whether it is inside the joint limits.
    """

    label: str
    x: float | None
    y: float | None
    inside: bool


@dataclass(frozen=True)
class Slice:
    """The smallest singular value over the positions of two joints, all others held.

    Attributes:
        joints: names of the two joints, first axis first.
        units: "rad" or "m" for each.
        x: positions of the first, (a,).
        y: positions of the second, (b,).
        smallest: smallest singular value of the length-scaled Jacobian, (b, a).
        signed: its determinant where it is square, (b, a), zero on singular curves; None where it is not.
        limits: lower and upper limit of each, infinite where there is none.
        marks: the families with one or two fixed joints.
        at: positions of the two joints in the configuration in which the others are held.
    """

    joints: tuple[str, str]
    units: tuple[str, str]
    x: Array
    y: Array
    smallest: Array
    signed: Array | None
    limits: tuple[tuple[float, float], tuple[float, float]]
    marks: tuple[Mark, ...]
    at: tuple[float, float]


@dataclass(frozen=True)
class Curve:
    """A curve of the tool in the plane of a planar arm.

    Attributes:
        label: what it is, such as "joint2 = 0".
        points: (k, 2), m.
        kind: "singular" or "limit" (a joint at one of its limits).
    """

    label: str
    points: Array
    kind: str


@dataclass(frozen=True)
class Workspace:
    """Where the tool of a planar arm gets, and its singular curves.

    Attributes:
        axes: names of the two directions of the plane, such as ("x", "y"), in the axes of `observer`.
        observer: the observer's frame.
        reached: tool positions at random configurations inside limits, (N, 2), m.
        smallest: smallest singular value there, (N,).
        curves: where the arm is singular with the joints inside limits, and where a joint is at a limit.
        unlimited: the singular curves when limits are left out of account.
    """

    axes: tuple[str, str]
    observer: str
    reached: Array
    smallest: Array
    curves: tuple[Curve, ...]
    unlimited: tuple[Curve, ...]
