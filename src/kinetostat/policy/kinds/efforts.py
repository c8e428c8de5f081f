"""What the joints bear, and what they may give."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, field

from kinetostat.policy import words
from kinetostat.policy.kinds.common import (
    At,
    Efforts,
    Frame,
    Joints,
    Kind,
    NotNegative,
    OfFrame,
    Percent,
    Point,
    Seed,
    Six,
    Vector,
)

__all__ = ["Holds", "JointLimits", "WorstGravity"]


class Holds(OfFrame, frozen=True, kw_only=True, tag="holds"):
    """The joints hold a payload, a wrench, or the links' weight alone, with so much of their effort limits at most."""

    at_most_percent: Percent
    at: At = "zero"
    point: Point = None
    payload: Annotated[float, Meta(ge=0, le=1e9, description="A mass that the frame holds at the point, kg.")] = 0.0
    wrench: Annotated[
        Six | None, Meta(description="fx fy fz mx my mz at the point of the frame, N and Nm. Default: none.")
    ] = None
    on: Annotated[
        Literal["environment", "robot"],
        Meta(description="environment: the robot exerts the wrench; robot: it acts on the robot."),
    ] = "environment"
    axes: Annotated[
        str, Meta(description="Whose axes the wrench is written in: world (the root's), local, or a frame's.")
    ] = "world"
    gravity: Annotated[
        bool | Vector,
        Meta(description="true: the links' weight counts, 9.81 m/s2 down the root's z; a vector in its axes; false."),
    ] = True
    joints: Joints = ()
    effort_limits: Efforts = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse configurations that cannot be, and nothing to hold."""
        words.check_at(self.at)
        if not self.payload and self.wrench is None and not self.gravity:
            raise ValueError("nothing is to be held: give payload, wrench or gravity")

    @property
    def title(self) -> str:
        """What is held, by which frame, where."""
        return f"{words.load(self.payload, self.wrench)} held by {words.frame(self.frame)} at {words.at(self.at)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(None, self.at_most_percent, "% of any effort limit")


class WorstGravity(Kind, frozen=True, kw_only=True, tag="worst-gravity-torque"):
    """The worst torque of weight (and of a payload) inside joint limits stays within so much of the effort limits."""

    at_most_percent: Percent = 100.0
    payload: Annotated[float, Meta(ge=0, le=1e9, description="A mass that the frame holds at the point, kg.")] = 0.0
    frame: Frame = ""
    point: Point = None
    gravity: Annotated[
        Vector | None, Meta(description="Gravity in the root's axes, m/s2. Default: 9.81 down the root's z.")
    ] = None
    joints: Joints = ()
    effort_limits: Efforts = field(default_factory=dict)
    samples: Annotated[int, Meta(ge=1, le=1_000_000, description="Random configurations to climb from.")] = 2000
    seed: Seed = 0

    @property
    def title(self) -> str:
        """What it is about."""
        held = f" with {self.payload:g} kg held by {words.frame(self.frame)}" if self.payload else ""
        return f"worst gravity torque{held} over all configurations inside limits"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(None, self.at_most_percent, "% of any effort limit")


class JointLimits(Kind, frozen=True, kw_only=True, tag="joint-limits"):
    """The limits of joints are large enough, or small enough."""

    joints: Annotated[tuple[str, ...], Meta(min_length=1, description="The joints; each is to meet all of it.")]
    effort_at_least: Annotated[NotNegative | None, Meta(description="Nm, or N for slides.")] = None
    effort_at_most: Annotated[NotNegative | None, Meta(description="Nm, or N for slides.")] = None
    velocity_at_least: Annotated[NotNegative | None, Meta(description="rad/s, or m/s for slides.")] = None
    velocity_at_most: Annotated[NotNegative | None, Meta(description="rad/s, or m/s for slides.")] = None
    lower_at_most: Annotated[
        float | None, Meta(description="The lower end of the range is there or below, rad or m.")
    ] = None
    upper_at_least: Annotated[
        float | None, Meta(description="The upper end of the range is there or above, rad or m.")
    ] = None

    def __post_init__(self) -> None:
        """Refuse an expectation that expects nothing, and ranges that cannot be."""
        if not self.bounds:
            raise ValueError("expects nothing: give effort-at-least, velocity-at-least, ...")
        words.check_order(self.effort_at_least, self.effort_at_most)
        words.check_order(self.velocity_at_least, self.velocity_at_most)

    @property
    def bounds(self) -> dict[str, float]:
        """What is given, by its key."""
        keys = zip(self.__struct_fields__, self.__struct_encode_fields__, strict=True)
        given = ((key, getattr(self, part)) for part, key in keys if "-at-" in key)
        return {key: value for key, value in given if value is not None}

    @property
    def title(self) -> str:
        """Of which joints."""
        return f"limits of {words.names(self.joints)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return ", ".join(f"{key.replace('-', ' ')} {value:g}" for key, value in self.bounds.items())
