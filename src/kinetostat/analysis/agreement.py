"""Do all readers agree on a robot: both engines and yourdfpy, on all frames at many configurations?"""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Agreement", "Disagreement"]


@dataclass(frozen=True)
class Disagreement:
    """The worst of one kind of number on which readers differ.

    Attributes:
        quantity: "placement", "Jacobian", "gravity torque" ...
        odd_one: the reader that two others outvote; empty where it is one against one.
        readers: the two that are furthest apart.
        frame: the link; empty where it is about none.
        configuration: positions of joints at which it is so, rad and m.
        size: the difference, in `unit`.
        tolerance: what counts as agreement.
        unit: of the two.
    """

    quantity: str
    odd_one: str
    readers: tuple[str, ...]
    frame: str
    configuration: dict[str, float]
    size: float
    tolerance: float
    unit: str


@dataclass(frozen=True)
class Agreement:
    """How far apart the readers of one file come.

    Attributes:
        readers: their names: "pinocchio", "screw", "yourdfpy".
        frames, configurations: how many of each were compared.
        max_difference: the largest between the two engines, placements and Jacobians, m and 1.
        tolerance: what counts as agreement between the two engines.
        disagreements: the worst of each kind; empty if all agree.
        notes: what was left out and why, such as a known limit of the third reader.
    """

    readers: tuple[str, ...]
    frames: int
    configurations: int
    max_difference: float
    tolerance: float
    disagreements: tuple[Disagreement, ...] = ()
    notes: tuple[str, ...] = field(default=())

    @property
    def agree(self) -> bool:
        """Whether nothing disagrees."""
        return not self.disagreements
