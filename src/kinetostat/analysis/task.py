"""Tasks: which rows of a twist count, and the length that makes metres and radians comparable."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.jacobian import velocity_units
from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Joint

__all__ = [
    "FULL",
    "ROTATION",
    "TRANSLATION",
    "Task",
    "characteristic_length",
    "length_scaled",
    "pointing_up",
    "turning_columns",
]

_WORD = re.compile(r"[rvw]?[xyz]+")


@dataclass(frozen=True)
class Task:
    """Some of the six rows of a twist.

    Attributes:
        name: full, translation, rotation, or task.
        rows: their indices, linear rows being 0, 1, 2.
    """

    name: str
    rows: tuple[int, ...]

    @classmethod
    def named(cls, axes: str | Sequence[str]) -> Task:
        """Return the task of some axes: `xyz`, `x y rz`, `xyz,rx`, `vx wz`; r... or w... are turns.

        Raises:
            UsageError: a word is none of that, or none is given.
        """
        text = " ".join(map(str, axes)) if isinstance(axes, (list, tuple)) else str(axes)
        words = text.replace(",", " ").split()
        wrong = next((word for word in words if "".join(_WORD.findall(word)) != word), None)
        if wrong is not None or not words:
            raise UsageError(
                "a task needs axes" if wrong is None else f"there is no axis {quote(wrong)}",
                remedy="x, y, z translate, rx, ry, rz turn: for instance x,y,rz for a planar arm, xyz for a point",
            )
        rows = set[int]()
        for word in _WORD.findall(text):
            rows |= {"xyz".index(letter) + 3 * (word[0] in "rw") for letter in word.lstrip("rvw")}
        return cls("task", tuple(sorted(rows)))

    @property
    def linear(self) -> tuple[int, ...]:
        """The linear rows."""
        return tuple(row for row in self.rows if row < 3)

    @property
    def angular(self) -> tuple[int, ...]:
        """The angular rows."""
        return tuple(row for row in self.rows if row >= 3)

    @property
    def mixed(self) -> bool:
        """Whether it mixes metres and radians."""
        return bool(self.linear and self.angular)

    def mixes(self, turning: Sequence[bool]) -> bool:
        """Return whether metres and radians meet: in the rows, or in the columns of rows that slides move.

        `turning` says which columns are of joints that turn.
        """
        return self.mixed or (bool(self.linear) and len(set(turning)) > 1)

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names of its rows."""
        return tuple(TWIST_ROWS[row] for row in self.rows)

    @property
    def row_units(self) -> tuple[str, ...]:
        """Units of its rows."""
        return tuple(TWIST_UNITS[row] for row in self.rows)


FULL = Task("full", (0, 1, 2, 3, 4, 5))
TRANSLATION = Task("translation", (0, 1, 2))
ROTATION = Task("rotation", (3, 4, 5))


def characteristic_length(matrix: Array, turning: Sequence[bool], task: Task) -> Array:
    """Return the length L in m for which the linear and the angular rows of a task weigh the same.

    L^2 = (sum of squares of linear rows / their number) / (sum of squares of angular rows / their number), over the
    columns of joints that turn. For all six rows that is the root mean square distance of the joints' axes from the
    point. Where the Jacobian of an arm without slides can be isotropic, L makes it so (J. Angeles, "Fundamentals of
    Robotic Mechanical Systems", on the characteristic length).

    Args:
        matrix: Jacobians (..., 6, n), linear rows first.
        turning: which columns are of joints that turn. (n,).
        task: the rows; all six count where it does not mix lengths and angles.

    Returns:
        (...), m; 0 where no joint turns, or every axis passes through the point.
    """
    task = task if task.mixed else FULL
    turns = matrix[..., np.asarray(turning, dtype=bool)]
    linear = np.mean(np.sum(turns[..., task.linear, :] ** 2, axis=-1), axis=-1)
    angular = np.mean(np.sum(turns[..., task.angular, :] ** 2, axis=-1), axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(angular > 0, np.sqrt(linear / angular), 0.0)


def length_scaled(matrix: Array, turning: Sequence[bool], length: Array | float) -> Array:
    """Return diag(1/L, 1) J diag(1 or L): linear rows in units of L, and so are the positions of joints that slide.

    Every entry is then a pure number. Shapes (..., 6, n), (n,), (...) -> (..., 6, n).
    """
    size = np.asarray(length, dtype=np.float64)[..., None, None]
    scaled = matrix * np.where(np.asarray(turning, dtype=bool), 1.0, size)
    scaled[..., :3, :] /= size
    return scaled


def turning_columns(joints: Sequence[Joint]) -> tuple[bool, ...]:
    """Return for each velocity coordinate of the joints whether it is an angle's."""
    return tuple(unit == "rad/s" for joint in joints for unit in velocity_units(joint))


def pointing_up(axes: Array) -> Array:
    """Return directions, the columns of (..., m, m), with the sign that makes the largest entry of each positive."""
    largest = np.take_along_axis(axes, np.argmax(np.abs(axes).round(9), axis=-2)[..., None, :], -2)
    signed: Array = axes * np.where(largest < 0, -1.0, 1.0)
    return signed
