"""What all kinds of expectations have in common: keys that are alike everywhere, and what an expectation is.

Lengths are in m, angles in rad, forces in N, moments in Nm, masses in kg. A key of the file is a field's name with
hyphens. `frame` is a link (it may be left out where the robot has one tip), `relative-to` the observer (else the root
link), `point` one of the frame (else its origin), `at` says at which configurations.
"""

from __future__ import annotations

from typing import Annotated, ClassVar

from msgspec import Meta, Struct

from kinetostat.policy import words

__all__ = [
    "PLACE",
    "At",
    "Efforts",
    "Frame",
    "Joints",
    "Kind",
    "NotNegative",
    "Observer",
    "OfFrame",
    "Percent",
    "Point",
    "Positive",
    "Range",
    "Seed",
    "Six",
    "Start",
    "Vector",
    "measured_in",
]

PLACE = "place"


def measured_in(unit: str) -> dict[str, str]:
    """Return what a key's `Meta` says of its unit."""
    return {"unit": unit}


Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]
Positive = Annotated[float, Meta(gt=0)]
NotNegative = Annotated[float, Meta(ge=0)]

Frame = Annotated[str, Meta(description="The frame, a link. Default: the only tip of the robot.", examples=["tool0"])]
Observer = Annotated[str, Meta(description="The observer's link. Default: the root link.", examples=["torso_link"])]
Point = Annotated[
    Vector | None,
    Meta(
        description="The point of the frame, in its coordinates. Default: its origin.",
        examples=[(0.0, 0.0, 0.12)],
        extra=measured_in("m"),
    ),
]
At = Annotated[
    str | tuple[float | str, ...],
    Meta(
        description="zero, mid, random:SEED, an SRDF state, 'j1=0.3,j2=-1.2' (others zero), a list of numbers in file "
        "order; states: every SRDF state that moves the frame; or a list of such words: all of them.",
        examples=["zero", "mid", "random:7", "home", "j1=0.3,j2=-1.2", (0.3, -1.2), "states", ("home", "mid")],
        extra=measured_in("rad, m"),
    ),
]
Start = Annotated[
    str | tuple[float, ...],
    Meta(
        description="One configuration: zero, mid, an SRDF state, 'j1=0.3', or a list.",
        examples=["mid", "j1=0.3", (0.3, -1.2)],
        extra=measured_in("rad, m"),
    ),
]
Percent = Annotated[
    float, Meta(gt=0, description="The largest share of any effort limit, in percent.", extra=measured_in("%"))
]
Joints = Annotated[
    tuple[str, ...],
    Meta(description="The joints that count. Default: all that the question is about.", examples=[("j1", "j2")]),
]
Efforts = Annotated[
    dict[str, Positive],
    Meta(
        description="Effort limits of joints instead of those of the file.",
        examples=[{"elbow": 54.0}],
        extra=measured_in("Nm, N"),
    ),
]
Seed = Annotated[int, Meta(ge=0, le=2**32, description="Of the random numbers: the same seed gives the same answer.")]


class Kind(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab", tag_field="kind"):
    """What all kinds have in common.

    `title` says what it is about and `wanted` what is wanted of it, each in one line. `example` is a table of it as a
    settings file has it, without its header and its kind.
    """

    about: ClassVar[str] = ""
    example: ClassVar[str] = ""
    unit: ClassVar[str] = ""  # of its bounds, where they have none of their own

    place: str = ""  # where it is written, such as kinetostat.toml:12; its reader knows, no file says so

    @property
    def kind(self) -> str:
        """The name of its kind."""
        return str(self.__struct_config__.tag)

    @property
    def title(self) -> str:
        """What it is about."""
        return self.about

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return ""


class OfFrame(Kind, frozen=True, kw_only=True):
    """Something about a frame."""

    frame: Frame = ""
    relative_to: Observer = ""

    @property
    def title(self) -> str:
        """What it is about, and of which frame."""
        return f"{self.about} of {words.frame(self.frame, self.relative_to)}"


class Range(OfFrame, frozen=True, kw_only=True):
    """A number between two ends, one of which may be left out."""

    at_least: Annotated[float | None, Meta(description="The smallest that is accepted.")] = None
    at_most: Annotated[float | None, Meta(description="The largest that is accepted.")] = None

    def __post_init__(self) -> None:
        """Refuse a range that cannot be."""
        words.check_range(self.at_least, self.at_most)

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return words.bounds(self.at_least, self.at_most, self.unit)
