"""The conventions that hold everywhere: rows, reference frames, labels, tolerances. Units are SI and radians.

A velocity is always a velocity *of* a frame F (of a point P fixed in it), *relative to* an observer's frame A,
*expressed in* the axes of a frame E. `Velocity` is that label; engines compute for it and results carry it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from kinetostat.errors import UsageError, unknown_name

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Array = npt.NDArray[np.float64]
    Flags = npt.NDArray[np.bool_]
else:
    Array = Flags = Any  # a name in annotations only: --help takes its words from here, and should not wait for NumPy

__all__ = [
    "GRAVITY",
    "Array",
    "Flags",
    "Load",
    "On",
    "Order",
    "Reference",
    "Velocity",
    "WrenchOrTwist",
    "tolerance",
]

TWIST_ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")
TWIST_UNITS = ("m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s")
WRENCH_ROWS = ("fx", "fy", "fz", "mx", "my", "mz")
WRENCH_UNITS = ("N", "N", "N", "Nm", "Nm", "Nm")

# The names of what `--base floating` adds above the file's root link. They are Pinocchio's own.
WORLD_LINK = "universe"
FLOATING_BASE_JOINT = "root_joint"

# Coordinates of one joint by type: position, then velocity (a body twist where there are several).
FLOATING_POSITION = ("x", "y", "z", "qx", "qy", "qz", "qw")
PLANAR_POSITION = ("x", "y", "theta")
PLANAR_VELOCITY = ("vx", "vy", "wz")

AGREEMENT = 1e-12
GRAVITY = (0.0, 0.0, -9.81)  # m/s2, in the root link's axes: what Pinocchio and most simulators take for the Earth's


_WORDS = {"WrenchOrTwist": "kind", "On": "side that a wrench acts on"}


class Word(StrEnum):
    """A choice among words. Any other word is a UsageError that lists them."""

    @classmethod
    def _missing_(cls, value: object) -> Word:
        raise unknown_name(_WORDS.get(cls.__name__, cls.__name__.lower()), str(value), cls)


class Reference(Word):
    """Shorthand for the point and the axes of a Jacobian.

    aligned: velocity of F's origin (or of `point`), observer's axes (Pinocchio LOCAL_WORLD_ALIGNED, Corke jacob0).
    local: velocity of F's origin (or of `point`), F's axes (body Jacobian, LOCAL, jacobe).
    world: velocity of the point of F that lies at the observer's origin, observer's axes (spatial Jacobian, WORLD).
    """

    ALIGNED = "aligned"
    LOCAL = "local"
    WORLD = "world"


class Order(Word):
    """Which half of a six-vector comes first."""

    LINEAR_FIRST = "linear-first"
    ANGULAR_FIRST = "angular-first"

    @property
    def rows(self) -> list[int]:
        """Indices that take a linear-first six-vector to this order (and back: the swap is its own inverse)."""
        return [0, 1, 2, 3, 4, 5] if self is Order.LINEAR_FIRST else [3, 4, 5, 0, 1, 2]


class On(Word):
    """Whom a given wrench acts on, and so the sign of the torques that hold the robot still.

    environment: the robot exerts it on its surroundings; tau = +J^T F.
    robot: the surroundings exert it on the robot; tau = -J^T F.
    """

    ENVIRONMENT = "environment"
    ROBOT = "robot"


class WrenchOrTwist(Word):
    """What a 6x6 frame change carries."""

    TWIST = "twist"
    WRENCH = "wrench"

    @property
    def rows(self) -> tuple[str, ...]:
        """Names of the six components, linear first."""
        return TWIST_ROWS if self is WrenchOrTwist.TWIST else WRENCH_ROWS

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the six components, linear first."""
        return TWIST_UNITS if self is WrenchOrTwist.TWIST else WRENCH_UNITS


@dataclass(frozen=True)
class Velocity:
    """Which velocity: of `point` of frame `of`, relative to `relative_to`, expressed in `expressed_in`.

    `point` is in metres in the coordinates of `of`; `None` stands for the point of `of` that lies at the observer's
    origin (the spatial Jacobian).
    """

    of: str
    relative_to: str
    expressed_in: str
    point: tuple[float, float, float] | None = (0.0, 0.0, 0.0)

    @classmethod
    def by_reference(
        cls,
        reference: Reference,
        of: str,
        relative_to: str,
        *,
        point: tuple[float, float, float] | None = None,
        expressed_in: str | None = None,
    ) -> Velocity:
        """Return the label that a shorthand reference stands for, with its point and axes replaced where given.

        Raises:
            UsageError: a point is given with `world`, whose point is the observer's origin.
        """
        if reference is Reference.WORLD:
            if point is not None:
                raise UsageError(
                    "reference world has its point at the observer's origin",
                    remedy="leave out the point, or use reference aligned or local",
                )
            return cls(of, relative_to, expressed_in or relative_to, None)
        axes = expressed_in or (of if reference is Reference.LOCAL else relative_to)
        return cls(of, relative_to, axes, (0.0, 0.0, 0.0) if point is None else point)


@dataclass(frozen=True)
class Load:
    """A wrench (f, m) that the robot exerts on what it touches.

    `at` says where and how it is given: by which link (`of`), through which point, in which axes. It is the dual of the
    velocity with that label: the power given to the surroundings is `wrench . velocity`, so tau = J^T wrench.
    `wrench` is (6,) or (..., 6), N and Nm, force first; the moment is about the point.
    """

    at: Velocity
    wrench: Array


def quarter_turns(angle: float) -> str | None:
    """Return an angle in [-pi, pi] in words, if it is a multiple of a quarter turn: -pi, -pi/2, 0, pi/2, pi."""
    quarters = round(angle / (math.pi / 2))
    if abs(quarters) > 2 or abs(angle - quarters * math.pi / 2) >= 1e-12:
        return None
    return ("-pi", "-pi/2", "0", "pi/2", "pi")[quarters + 2]


def tolerance(length: float, speed: float = 1.0) -> float:
    """Return the largest difference between the engines that counts as agreement.

    `1e-12 max(1, length) max(1, speed)`: rounding grows with the size of the numbers, so `length` is the robot's reach
    in metres at the configuration and `speed` the size of the rates that a derivative is contracted with.
    """
    return AGREEMENT * max(1.0, length) * max(1.0, speed)
