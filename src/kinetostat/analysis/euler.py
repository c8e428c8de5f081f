"""Euler angles and their rates: the 12 sequences, read as intrinsic or as fixed-axis rotations.

Intrinsic `abc`: turn about a, then about the turned b, then about the twice turned c: R = Ra(t1) Rb(t2) Rc(t3). The
same rotation about fixed axes is `fixed-cba`, the angles in the other order. `rpy` is URDF's fixed-xyz, intrinsic zyx.

    w = E(t) dt/dt,   E = [ e_a,  Ra(t1) e_b,  Ra(t1) Rb(t2) e_c ]

w being the angular velocity in the observer's axes. E is singular at sin t2 = 0 for sequences that end as they begin
(zyz), at cos t2 = 0 for the others. J. Diebel, "Representing attitude: Euler angles, unit quaternions, and rotation
vectors", 2006.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np

from kinetostat.conventions import Array
from kinetostat.errors import UsageError, unknown_name
from kinetostat.screw.so3 import about

__all__ = ["EulerSequence", "sequence_names"]

_AXES = "xyz"
_INTRINSIC = tuple("".join(p) for p in permutations(_AXES)) + tuple(a + b + a for a, b in permutations(_AXES, 2))


def sequence_names() -> list[str]:
    """Return the names that `EulerSequence.named` takes: rpy, the 12 intrinsic and the 12 fixed-axis sequences."""
    return ["rpy", *_INTRINSIC, *(f"fixed-{name}" for name in _INTRINSIC)]


@dataclass(frozen=True)
class EulerSequence:
    """One of the 12 sequences, and whether its angles are listed as fixed-axis rotations."""

    intrinsic: str
    fixed: bool

    @classmethod
    def named(cls, name: str) -> EulerSequence:
        """Return the sequence of a name.

        Raises:
            UsageError: there is no such sequence.
        """
        wanted = "fixed-xyz" if name == "rpy" else name.removeprefix("intrinsic-")
        letters = wanted.removeprefix("fixed-")
        if letters not in _INTRINSIC:
            if set(letters) <= set(_AXES) and len(letters) == 3:
                raise UsageError(
                    f"{name} is no Euler sequence: neighbours must differ", remedy="for instance zyz, zyx or rpy"
                )
            raise unknown_name(
                "Euler sequence", name, sequence_names(), listing="for instance rpy, zyx, zyz or fixed-xyz"
            )
        fixed = wanted.startswith("fixed-")
        return cls(letters[::-1] if fixed else letters, fixed)

    @property
    def reading(self) -> str:
        """Both names of the sequence, the one that the angles are listed by first."""
        names = [f"intrinsic {self.intrinsic}", f"fixed-axis {self.intrinsic[::-1]}"]
        return " = ".join(reversed(names) if self.fixed else names)

    @property
    def angle_names(self) -> tuple[str, str, str]:
        """Names of the angles in the order in which they are listed."""
        if self.fixed and self.intrinsic == "zyx":
            return ("roll", "pitch", "yaw")
        first, second, third = tuple(self.intrinsic[::-1] if self.fixed else self.intrinsic)
        return (f"{first}1", f"{second}2", f"{third}3")

    @property
    def proper(self) -> bool:
        """Whether it ends about the axis that it begins with (zyz)."""
        return self.intrinsic[0] == self.intrinsic[2]

    def angles(self, rotation: Array) -> Array:
        """Return the three angles, in listed order. Shapes (..., 3, 3) -> (..., 3), rad."""
        a, b, c = (_AXES.index(letter) for letter in self.intrinsic)
        k = 3 - a - b
        sign = 1.0 if (b - a) % 3 == 1 else -1.0
        r = rotation
        if self.proper:
            first = np.arctan2(r[..., b, a], -sign * r[..., k, a])
            second = np.arctan2(np.hypot(r[..., b, a], r[..., k, a]), r[..., a, a])
        else:
            first = np.arctan2(-sign * r[..., b, c], r[..., c, c])
            second = np.arctan2(sign * r[..., a, c], np.hypot(r[..., b, c], r[..., c, c]))
        # The third after the first is turned back, so that the three name the rotation near the singularity too:
        # row b of Ra(-t1) R = Rb(t2) Rc(t3) is that of Rc(t3).
        row = np.cos(first)[..., None] * r[..., b, :] + sign * np.sin(first)[..., None] * r[..., k, :]
        d = 3 - b - c
        third = np.arctan2(row[..., d] if (d - c) % 3 == 1 else -row[..., d], row[..., b])
        angles = np.stack([first, second, third], -1)
        return angles[..., ::-1] if self.fixed else angles

    def rotation(self, angles: Array) -> Array:
        """Return the rotation of three angles in listed order. Shapes (..., 3) -> (..., 3, 3), angles in rad."""
        angles = np.asarray(angles, dtype=np.float64)
        angles = angles[..., ::-1] if self.fixed else angles
        first, second, third = (about(_AXES.index(a), angles[..., i]) for i, a in enumerate(self.intrinsic))
        turned: Array = first @ second @ third
        return turned

    def rate_map(self, rotation: Array) -> Array:
        """Return E with w = E (rates in listed order), by the axes that the three turns are about.

        Shapes (..., 3, 3) -> (..., 3, 3). Its determinant is +-sin t2 or +-cos t2.
        """
        axes = self._axes(rotation)
        return axes[..., ::-1] if self.fixed else axes

    def rate_map_rate(self, rotation: Array, rates: Array) -> Array:
        """Return dE/dt for given angle rates in listed order: each axis turns with the rotations before it.

        Shapes (..., 3, 3), (..., 3) -> (..., 3, 3).
        """
        axes = self._axes(rotation)
        first, second, third = (axes[..., i] for i in range(3))
        rates = rates[..., ::-1] if self.fixed else rates
        before_second = rates[..., :1] * first
        before_third = before_second + rates[..., 1:2] * second
        turned = np.stack([np.zeros_like(first), np.cross(before_second, second), np.cross(before_third, third)], -1)
        return turned[..., ::-1] if self.fixed else turned

    def singularity(self, rotation: Array) -> Array:
        """Return abs(det E), which is 0 where the angles have no rates. Shapes (..., 3, 3) -> (...)."""
        determinant: Array = np.abs(np.linalg.det(self._axes(rotation)))
        return determinant

    def _axes(self, rotation: Array) -> Array:
        """Return the columns e_a, Ra e_b, R e_c: the third turn leaves its own axis where R takes it."""
        angles = self.angles(rotation)
        angles = angles[..., ::-1] if self.fixed else angles
        a, b, c = (_AXES.index(letter) for letter in self.intrinsic)
        unit = np.eye(3)
        cosine, sine = np.cos(angles[..., :1]), np.sin(angles[..., :1])
        turned = cosine * unit[b] + sine * np.cross(unit[a], unit[b])
        first = np.broadcast_to(unit[a], turned.shape)
        return np.stack([first, turned, rotation[..., c]], -1)
