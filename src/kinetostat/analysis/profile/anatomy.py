"""The limbs of a robot, as a report is divided: which chains there are, and what is left out of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Anatomy", "ChosenChain", "Left", "Limb"]


@dataclass(frozen=True)
class ChosenChain:
    """A chain that the user asks for by name, in the settings.

    Attributes:
        frame: the link at its end.
        base: the link that it is looked at from; empty: the root.
        name: what it is called; empty: its frame.
        payload: what it is to carry, kg.
        place: where it is written: kinetostat.toml:12.
    """

    frame: str
    base: str = ""
    name: str = ""
    payload: float | None = None
    place: str = ""


@dataclass(frozen=True)
class Limb:
    """A chain: an arm, a leg, a finger of a hand that is a robot by itself.

    Attributes:
        name: as the settings call it, or the SRDF group; else its frame.
        base: the link that its tool is looked at from: where the limb leaves the trunk, or the root.
        frame: the link at its end.
        joints: the independent joints that move the frame relative to the base, in path order; one at least.
        found: how it was found: named by the settings, a group of the SRDF, or a tip of the tree.
        payload: what it is to carry, kg, as the settings say; None where they do not.
    """

    name: str
    base: str
    frame: str
    joints: tuple[str, ...]
    found: Literal["settings", "group", "tip"]
    payload: float | None = None


@dataclass(frozen=True)
class Left:
    """Something that is not computed, or not shown, and why: no gap is silent.

    Attributes:
        what: what it is.
        why: the reason.
        place: where the settings ask for what the robot cannot have, kinetostat.toml:12; else empty.
    """

    what: str
    why: str
    place: str = ""


@dataclass(frozen=True)
class Anatomy:
    """The limbs of a robot, and what belongs to none: hands, wheels, the trunk, followers, joints that float."""

    limbs: tuple[Limb, ...]
    left: tuple[Left, ...]
