"""Whether the inertials of a left and a right link can be mirror images, or the same part turned over."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinetostat.lint.bodies import LinkInertia

__all__ = ["Comparison", "Signed", "compared"]

SAME = 0.01  # relative: equal, but for rounding
COUNTS = 0.05  # of the largest coordinate of the centre of mass; of the mean moment: less says nothing of a sign
SMALL = 1e-3  # m: a coordinate below it says nothing of a sign

_AXES = "xyz"
_PRODUCTS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class Signed:
    """A number of the left link and of the right one, which change sign with these axes."""

    what: str
    left: float
    right: float
    axes: tuple[int, ...]


@dataclass(frozen=True)
class Comparison:
    """How a right link's inertial stands to the left one's.

    Attributes:
        mass: whether they weigh the same.
        differing: what differs in size: "mass", "centre of mass", "moments".
        wrong: where nothing differs in size, what has the wrong sign whatever axes are turned over.
        joints: whether it is wrong only beside what is fixed to the links.
    """

    mass: bool
    differing: tuple[str, ...]
    wrong: tuple[Signed, ...]
    joints: bool = False


def compared(
    left: LinkInertia, right: LinkInertia, points: Sequence[tuple[Sequence[float], Sequence[float]]]
) -> Comparison:
    """Compare two inertials.

    Mirror images, and one part mounted both ways, agree in the sizes of all numbers; which axes change their sign
    depends on how the frames were laid. So the signs are wrong only if no choice of axes explains them all.

    Args:
        left: the inertial of one.
        right: the inertial of the other.
        points: what else is fixed to the two, in the frames of their links: the origins of the joints that they carry.
    """
    a, b = left.in_link_frame().tolist(), right.in_link_frame().tolist()
    scale = max(sum(each[i][i] for i in range(3)) for each in (a, b)) / 3
    reach = max(map(abs, (*left.centre, *right.centre)))
    differing = []
    mass = _near(left.mass, right.mass, 0.0)
    if not mass:
        differing.append("mass")
    if any(
        not _near(abs(p), abs(q), max(COUNTS * reach, SMALL)) for p, q in zip(left.centre, right.centre, strict=True)
    ):
        differing.append("centre of mass")
    if any(not _near(abs(a[i][j]), abs(b[i][j]), COUNTS * scale) for i in range(3) for j in range(i, 3)):
        differing.append("moments")
    if differing:
        return Comparison(mass, tuple(differing), ())
    signed = [
        *_coordinates("centre of mass", left.centre, right.centre),
        *(
            Signed(f"i{_AXES[i]}{_AXES[j]}", a[i][j], b[i][j], (i, j))
            for i, j in _PRODUCTS
            if abs(a[i][j]) > COUNTS * scale
        ),
    ]
    fixed = [each for p, q in points for each in _coordinates("joint", p, q)]
    wrong = _wrong(signed, fixed)
    return Comparison(mass, (), wrong, bool(wrong) and not _wrong(signed, ()))


def _near(left: float, right: float, slack: float) -> bool:
    return abs(left - right) <= max(SAME * max(abs(left), abs(right)), slack)


def _coordinates(what: str, left: Sequence[float], right: Sequence[float]) -> Iterator[Signed]:
    """Yield the coordinates of a point that tell a sign and are equal in size."""
    reach = max(map(abs, (*left, *right)))
    for i in range(3):
        if min(abs(left[i]), abs(right[i])) > max(COUNTS * reach, SMALL) and _near(abs(left[i]), abs(right[i]), 0.0):
            yield Signed(f"{_AXES[i]} of the {what}", left[i], right[i], (i,))


def _wrong(signed: Sequence[Signed], fixed: Sequence[Signed]) -> tuple[Signed, ...]:
    """Return the numbers whose signs no choice of axes turned over explains; the fewest that can be.

    What is fixed to the links has a say in the choice, unless no choice explains that alone.
    """
    turns = list(itertools.product((1, -1), repeat=3))
    able = [turn for turn in turns if all(_explains(turn, each) for each in fixed)] or turns
    wrong = (tuple(each for each in signed if not _explains(turn, each)) for turn in able)
    return min(wrong, key=len)


def _explains(turn: Sequence[int], each: Signed) -> bool:
    sign = 1
    for axis in each.axes:
        sign *= turn[axis]
    return sign * each.left * each.right > 0
