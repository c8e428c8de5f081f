"""What may have happened to a tensor: an order of entries, a point, a unit that is not URDF's."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from kinetostat.lint.tensors import MOMENTS, deficit, principal_moments

__all__ = ["densest_moment", "likely_units", "reordered"]

SMALL_PRODUCTS = 0.3  # of the least moment: the products of a tensor in its right order are as a rule smaller
DENSEST = 22_600.0  # kg/m3: osmium
USUAL = 0.1  # of the robot's size: the radius of gyration of a link
UNITS = (("kg cm2", 1e-4), ("lb in2", 2.926e-4), ("kg mm2", 1e-6), ("g cm2", 1e-7), ("g mm2", 1e-9))

_DIAGONAL, _PRODUCTS = (0, 3, 5), (1, 2, 4)
_MOMENTS_FIRST = "the three moments stand first, the products after them"
_ORDERS = (
    (_MOMENTS_FIRST, (0, 3, 4, 1, 5, 2)),
    (_MOMENTS_FIRST, (0, 5, 4, 1, 3, 2)),
)


def reordered(entries: Sequence[float]) -> str | None:
    """Return which slip in the order of ixx, ixy, ixz, iyy, iyz, izz would explain a tensor that cannot be.

    None unless just one slip makes it a tensor with positive moments, the triangle inequality and small products.
    """
    found = dict[tuple[float, ...], str]()
    for what, candidate in _candidates(tuple(entries)):
        if _settled(candidate):
            found.setdefault(candidate, what)
    slips = set(found.values())
    if len(slips) == 1:
        return slips.pop()
    return "the first six numbers of a 3 x 3 matrix, row by row" if not slips and _by_rows(entries) else None


def _candidates(entries: tuple[float, ...]) -> Iterator[tuple[str, tuple[float, ...]]]:
    for what, order in _ORDERS:
        yield what, tuple(entries[i] for i in order)
    for i in _DIAGONAL:
        for j in _PRODUCTS:
            exchanged = list(entries)
            exchanged[i], exchanged[j] = entries[j], entries[i]
            yield f"{MOMENTS[i]} and {MOMENTS[j]} are exchanged", tuple(exchanged)


def _settled(entries: tuple[float, ...]) -> bool:
    """Return whether a tensor could be one, clearly."""
    least = min(entries[i] for i in _DIAGONAL)
    if least <= 0 or max(abs(entries[i]) for i in _PRODUCTS) > SMALL_PRODUCTS * least:
        return False
    principal = principal_moments(entries)
    return principal[0] > 0 and deficit(principal) <= 0


def _by_rows(entries: Sequence[float]) -> bool:
    """Return whether the entries look like xx xy xz yx yy yz: izz is lost."""
    xx, xy, xz, yx, yy, yz = entries
    least = min(xx, yy)
    return bool(xy == yx and least > 0 and max(map(abs, (xy, xz, yz))) <= SMALL_PRODUCTS * least)


def densest_moment(mass: float) -> float:
    """Return the moment of a ball of osmium, kg m2: the mean of a body's principal moments cannot be less.

    Of all bodies of a mass and a greatest density the ball has the least moment.
    """
    radius = (3 * mass / (4 * math.pi * DENSEST)) ** (1 / 3)
    return float(0.4 * mass * radius**2)


def likely_units(gyration: float, size: float) -> list[str]:
    """Return the units, two at most, in which a radius of gyration far too large in kg m2 would fit a robot's size."""
    fits = {unit: gyration * math.sqrt(factor) / size for unit, factor in UNITS}
    close = sorted(fits, key=lambda unit: abs(math.log(fits[unit] / USUAL)))
    return [unit for unit in close[:2] if 0.003 < fits[unit] < 1]
