"""What the joints bear, and what they may give."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

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
    measured_in,
)

__all__ = ["Holds", "JointLimits", "WorstGravity"]


_Effort = Annotated[
    NotNegative | None, Meta(description="Of the effort limit; slides have forces.", extra=measured_in("Nm, N"))
]
_Speed = Annotated[
    NotNegative | None, Meta(description="Of the velocity limit; slides have m/s.", extra=measured_in("rad/s, m/s"))
]


class Holds(OfFrame, frozen=True, kw_only=True, tag="holds"):
    """The joints hold a payload, a wrench, or the links' weight alone, with so much of their effort limits at most.

    Static: the torques that both engines compute, over the effort limits of the file or of `effort-limits`. A joint
    that bears something and has no limit leaves it open: not judged, which is not met.
    """

    example: ClassVar[str] = 'frame = "tool0"\npayload = 5.0\nat = "states"\nat-most-percent = 80'

    at_most_percent: Percent
    at: At = "zero"
    point: Point = None
    payload: Annotated[
        float, Meta(ge=0, le=1e9, description="A mass that the frame holds at the point.", extra=measured_in("kg"))
    ] = 0.0
    wrench: Annotated[
        Six | None,
        Meta(
            description="Forces and moments fx fy fz mx my mz at the point of the frame. Default: none.",
            examples=[(0.0, 0.0, -20.0, 0.0, 0.0, 0.0)],
            extra=measured_in("N, Nm"),
        ),
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
        Meta(
            description="true: the links' weight counts, 9.81 m/s2 down the root's z; a vector in its axes; false.",
            examples=[True, (0.0, 0.0, -1.62)],
            extra=measured_in("m/s2"),
        ),
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
    """The worst torque of weight (and of a payload) inside joint limits stays within so much of the effort limits.

    Searched from random configurations: a lower bound of the true one.
    """

    example: ClassVar[str] = 'frame = "tool0"\npayload = 5.0\nat-most-percent = 90'

    at_most_percent: Percent = 100.0
    payload: Annotated[
        float, Meta(ge=0, le=1e9, description="A mass that the frame holds at the point.", extra=measured_in("kg"))
    ] = 0.0
    frame: Frame = ""
    point: Point = None
    gravity: Annotated[
        Vector | None,
        Meta(
            description="Gravity in the root's axes. Default: 9.81 down the root's z.",
            examples=[(0.0, 0.0, -1.62)],
            extra=measured_in("m/s2"),
        ),
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
    """The limits of joints are large enough, or small enough.

    `lower-at-most` and `upper-at-least` together say which range a joint has to cover. A limit that the file does not
    state is not met, nor is one of a joint that is fixed, or that follows another.
    """

    example: ClassVar[str] = (
        'joints = ["shoulder_pan", "shoulder_lift"]\neffort-at-least = 150\n'
        "lower-at-most = -3.14\nupper-at-least = 3.14"
    )

    joints: Annotated[
        tuple[str, ...],
        Meta(min_length=1, description="The joints; each is to meet all of it.", examples=[("j1", "j2")]),
    ]
    effort_at_least: _Effort = None
    effort_at_most: _Effort = None
    velocity_at_least: _Speed = None
    velocity_at_most: _Speed = None
    lower_at_most: Annotated[
        float | None,
        Meta(description="The range begins there or below.", examples=[-3.14], extra=measured_in("rad, m")),
    ] = None
    upper_at_least: Annotated[
        float | None, Meta(description="The range ends there or above.", examples=[3.14], extra=measured_in("rad, m"))
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
