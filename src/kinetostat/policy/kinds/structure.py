"""What a robot is made of."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from kinetostat.policy import words
from kinetostat.policy.kinds.common import Kind, NotNegative, OfFrame

__all__ = ["Mass", "Mobility"]


class Mobility(OfFrame, frozen=True, kw_only=True, tag="degrees-of-freedom"):
    """The degrees of freedom of a chain, or (without a frame) of the whole robot."""

    equals: Annotated[int, Meta(ge=0, le=1000, description="How many there are.")]
    of: Annotated[
        Literal["joints", "frame"],
        Meta(
            description="joints: coordinates of independent joints on the chain, followers (mimic) not counted; frame: "
            "independent motions of the frame at almost every configuration, 6 at most."
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
    """The total mass of the robot, its base link's too."""

    at_least: Annotated[NotNegative | None, Meta(description="The smallest that is accepted, kg.")] = None
    at_most: Annotated[NotNegative | None, Meta(description="The largest that is accepted, kg.")] = None
    about: ClassVar[str] = "total mass"

    def __post_init__(self) -> None:
        """Refuse a range that cannot be."""
        words.check_range(self.at_least, self.at_most)

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(self.at_least, self.at_most, "kg")
