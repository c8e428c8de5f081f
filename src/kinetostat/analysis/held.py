"""Where joints are held that do not move, while others are moved by a file, a sample or a grid."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from kinetostat.analysis.configuration import Configuration, neutral
from kinetostat.errors import quote

__all__ = ["Held", "held_joints"]


@dataclass(frozen=True)
class Held(Configuration):
    """Where those joints are that do not move; of the others nothing is told.

    Attributes:
        joints: names of the joints that are held.
    """

    joints: frozenset[str] = frozenset()

    def by_joint(self) -> dict[str, float | list[float]]:
        """Return {joint: position} of the joints that are held."""
        return {name: position for name, position in super().by_joint().items() if name in self.joints}


def held_joints(rest: Configuration, moved: Collection[str]) -> Held:
    """Return what is held of a configuration, with its warnings; `moved` are the coordinates that something else says.

    A joint that moves is told of by nothing: its position stands at zero, and a limit that it, or what follows it,
    exceeds in `rest` is no warning.
    """
    robot, q = rest.robot, rest.q.copy()
    places = [i for i, name in enumerate(robot.position_names) if name in moved]
    q[places] = neutral(robot)[places]
    free = {joint.name for joint in robot.independent if set(joint.position_names) <= set(moved)}
    about = free | {name for name, law in robot.followers.items() if law.joint in free}
    starts = tuple(f"joint {quote(name)} is at " for name in about)
    warnings = tuple(line for line in rest.warnings if not line.startswith(starts))
    return Held(robot, q, warnings, frozenset(joint.name for joint in robot.independent) - free)
