"""How well a frame can move."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from kinetostat.policy import words
from kinetostat.policy.kinds.common import At, OfFrame, Point, measured_in

__all__ = ["Dexterity", "InverseCondition", "Manipulability", "SingularDistance", "SmallestSingularValue"]


class Dexterity(OfFrame, frozen=True, kw_only=True):
    """An index of a Jacobian at some configurations: the smallest value counts."""

    at_least: Annotated[float, Meta(ge=0, description="The smallest value that is accepted.")]
    at: At = "zero"
    point: Point = None
    rows: Annotated[
        str,
        Meta(
            description="The rows that count: all, translation, rotation, or some of x y z rx ry rz, such as 'x y rz' "
            "for a planar arm.",
            examples=["all", "translation", "x y rz"],
        ),
    ] = "all"
    length: Annotated[
        Annotated[float, Meta(ge=1e-9, le=1e9)] | Literal["auto", "none"],
        Meta(
            description="Where m and rad are mixed, linear rows are divided by this length in m. auto: the one that "
            "makes both weigh the same at the configuration; none: they are mixed as they are.",
            examples=["auto", 0.5],
            extra=measured_in("m"),
        ),
    ] = "auto"

    def __post_init__(self) -> None:
        """Refuse rows and configurations that cannot be."""
        words.check_at(self.at)
        words.check_rows(self.rows)

    @property
    def title(self) -> str:
        """What it is about, of which frame, where."""
        rows = "" if self.rows == "all" else f" ({self.rows})"
        return f"{super().title}{rows} at {words.at(self.at)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(self.at_least, None)


class SmallestSingularValue(Dexterity, frozen=True, kw_only=True, tag="smallest-singular-value"):
    """The smallest singular value of the Jacobian is large enough: the slowest direction for unit joint rates.

    It is zero at a singular configuration. In m/rad where the rows that count are lengths and the joints turn; where m
    and rad are mixed, by `length`.
    """

    example: ClassVar[str] = 'frame = "tool0"\nrows = "translation"\nat = ["home", "mid"]\nat-least = 0.05'
    about: ClassVar[str] = "smallest singular value"


class Manipulability(Dexterity, frozen=True, kw_only=True, tag="manipulability"):
    """Yoshikawa's manipulability, the product of the singular values, is large enough."""

    example: ClassVar[str] = 'frame = "tool0"\nrows = "translation"\nat = "states"\nat-least = 0.02'
    about: ClassVar[str] = "manipulability"


class InverseCondition(Dexterity, frozen=True, kw_only=True, tag="inverse-condition-number"):
    """The smallest singular value over the largest is large enough: 1 is isotropic, 0 is singular."""

    example: ClassVar[str] = 'frame = "tool0"\nrows = "rotation"\nat = "random:7"\nat-least = 0.1'
    about: ClassVar[str] = "inverse condition number"


class SingularDistance(OfFrame, frozen=True, kw_only=True, tag="distance-to-singularity"):
    """The nearest singular configuration that a search finds is far enough: a nearer one is not excluded."""

    example: ClassVar[str] = 'frame = "tool0"\nat = "home"\nat-least = 0.2\nwithin-limits = true'
    about: ClassVar[str] = "distance to a singularity"

    at_least: Annotated[
        float,
        Meta(
            gt=0,
            description="The smallest distance in joint space; slides in units of the arm's length.",
            extra=measured_in("rad"),
        ),
    ]
    at: At = "zero"
    point: Point = None
    rows: Annotated[
        str,
        Meta(
            description="The rows that count: auto (all; of three joints or fewer, translation), all, translation, "
            "rotation, or some of x y z rx ry rz.",
            examples=["auto", "x y rz"],
        ),
    ] = "auto"
    within_limits: Annotated[
        bool, Meta(description="Count only singular configurations that are inside joint limits.")
    ] = False

    def __post_init__(self) -> None:
        """Refuse rows and configurations that cannot be."""
        words.check_at(self.at)
        words.check_rows("all" if self.rows == "auto" else self.rows)

    @property
    def title(self) -> str:
        """What it is about, of which frame, where."""
        return f"{super().title} at {words.at(self.at)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(self.at_least, None, "rad")
