"""What a robot is made of."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from kinetostat.policy import words
from kinetostat.policy.kinds.common import Kind, NotNegative, OfFrame, measured_in

__all__ = ["Follower", "Mass", "Mobility"]


class Mobility(OfFrame, frozen=True, kw_only=True, tag="degrees-of-freedom"):
    """The degrees of freedom of a chain, or (without a frame) of the whole robot.

    A joint that becomes fixed, or stops following its leader, changes their number. `of = "frame"` asks for the rank of
    the Jacobian at almost every configuration instead: it falls where two axes become parallel by mistake.
    """

    example: ClassVar[str] = 'frame = "tool0"\nequals = 6'

    equals: Annotated[int, Meta(ge=0, le=1000, description="How many there are.")]
    of: Annotated[
        Literal["joints", "frame"],
        Meta(
            description="joints: coordinates of independent joints on the chain, followers (mimic) not counted; frame: "
            "independent motions of the frame at almost every configuration, 6 at most.",
            examples=["joints", "frame"],
        ),
    ] = "joints"

    @property
    def title(self) -> str:
        """Of what."""
        what = "degrees of freedom" if self.of == "joints" else "independent motions"
        whole = not self.frame and self.of == "joints"
        return f"{what} of {'the robot' if whole else words.frame(self.frame, self.relative_to)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return str(self.equals)


class Mass(Kind, frozen=True, kw_only=True, tag="mass"):
    """The total mass of the robot, its base link's too, is between two ends; one of them may be left out."""

    about: ClassVar[str] = "total mass"
    unit: ClassVar[str] = "kg"
    example: ClassVar[str] = "at-least = 18.0\nat-most = 19.0"

    at_least: Annotated[NotNegative | None, Meta(description="The smallest that is accepted.")] = None
    at_most: Annotated[NotNegative | None, Meta(description="The largest that is accepted.")] = None

    def __post_init__(self) -> None:
        """Refuse a range that cannot be."""
        words.check_range(self.at_least, self.at_most)

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(self.at_least, self.at_most, "kg")


class Follower(Kind, frozen=True, kw_only=True, tag="mimic"):
    """A joint follows another one: its position is multiplier times the leader's, plus offset.

    It is not met where the joint follows none any more, follows another one, or follows it otherwise.
    """

    example: ClassVar[str] = 'joint = "right_finger"\nleader = "left_finger"\nmultiplier = -1.0'

    joint: Annotated[str, Meta(description="The joint that follows.")]
    leader: Annotated[str, Meta(description="The joint that it follows, at once or through others that follow.")]
    multiplier: Annotated[float, Meta(description="Positions of the follower to those of the leader.")] = 1.0
    offset: Annotated[
        float, Meta(description="Where it is when its leader is at zero.", extra=measured_in("rad, m"))
    ] = 0.0
    tolerance: Annotated[float, Meta(ge=0, description="What the two numbers may differ by.")] = 1e-9

    @property
    def title(self) -> str:
        """Which joint follows which."""
        return f"{words.name(self.joint)} follows {words.name(self.leader)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.law(self.leader, self.multiplier, self.offset)
