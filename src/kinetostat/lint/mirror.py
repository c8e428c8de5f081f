"""Whether the inertials of a left and a right link can be mirror images, or the same part turned over."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinetostat.lint.bodies import LinkInertia

__all__ = ["Comparison", "Signed", "compared", "in_words"]

SAME = 0.01  # relative: equal, but for rounding
COUNTS = 0.05  # of the largest coordinate of the centre of mass; of the mean moment: less says nothing of a sign
SMALL = 1e-3  # m: a coordinate below it says nothing of a sign

_AXES = "xyz"
_PRODUCTS = ((0, 1), (0, 2), (1, 2))
_Turn = tuple[int, ...]  # the sign that each axis takes from the left link to the right one


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
        turn: the signs of the axes that explain the most; None if others do as well and find other numbers wrong.
    """

    mass: bool
    differing: tuple[str, ...]
    wrong: tuple[Signed, ...]
    joints: bool = False
    turn: _Turn | None = None


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
    wrong, turn = _wrong(signed, fixed)
    return Comparison(mass, (), wrong, bool(wrong) and not _wrong(signed, ())[0], turn)


def in_words(turn: _Turn) -> str:
    """Return which numbers change their sign from the left link to the right one, when these axes do."""
    axes = [_AXES[i] for i in range(3) if turn[i] < 0]
    products = [f"i{_AXES[i]}{_AXES[j]}" for i, j in _PRODUCTS if turn[i] * turn[j] < 0]
    if not axes:
        return "as the same part, mounted alike, no sign changes"
    centre = f"the centre's {_and(axes)}"
    if not products:
        return f"mirrored in a point, {centre} change sign, and the tensor stays as it is"
    across = f"mirrored in {axes[0]}" if len(axes) == 1 else f"turned about {(set(_AXES) - set(axes)).pop()}"
    return f"{across}, {_and([centre, *products])} change sign, and no others"


def _and(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _near(left: float, right: float, slack: float) -> bool:
    return abs(left - right) <= max(SAME * max(abs(left), abs(right)), slack)


def _coordinates(what: str, left: Sequence[float], right: Sequence[float]) -> Iterator[Signed]:
    """Yield the coordinates of a point that tell a sign and are equal in size."""
    reach = max(map(abs, (*left, *right)))
    for i in range(3):
        if min(abs(left[i]), abs(right[i])) > max(COUNTS * reach, SMALL) and _near(abs(left[i]), abs(right[i]), 0.0):
            yield Signed(f"{_AXES[i]} of the {what}", left[i], right[i], (i,))


def _wrong(signed: Sequence[Signed], fixed: Sequence[Signed]) -> tuple[tuple[Signed, ...], _Turn | None]:
    """Return the numbers whose signs no choice of axes turned over explains, the fewest that can be, and that choice.

    What is fixed to the links has a say in the choice, unless no choice explains that alone. Of choices that find the
    same numbers wrong, that which turns the fewest axes is returned; None if it is not clear what is wrong: the fewest
    numbers, or rather products than the centre of mass, which is easier to get right.
    """
    turns = sorted(itertools.product((1, -1), repeat=3), key=sum, reverse=True)
    able = [turn for turn in turns if all(_explains(turn, each) for each in fixed)] or turns
    wrong = {turn: tuple(each for each in signed if not _explains(turn, each)) for turn in able}
    counts = {turn: (len(found), sum(len(each.axes) == 1 for each in found)) for turn, found in wrong.items()}
    best = min(able, key=lambda turn: counts[turn])
    least = counts[best], min(count[::-1] for count in counts.values())[::-1]
    rivals = {wrong[turn] for turn in able if counts[turn] in least}
    return wrong[best], best if len(rivals) == 1 else None


def _explains(turn: Sequence[int], each: Signed) -> bool:
    sign = 1
    for axis in each.axes:
        sign *= turn[axis]
    return sign * each.left * each.right > 0
