"""The chains that are measured, written out for peers: nothing but the joints on the path, all others locked.

Peers get less work so than from the whole file: a chain of n joints and the tool, no meshes, no branches. The numbers
are Pinocchio's, of the robot's file.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import kinetostat as ks
from kinetostat.analysis.coordinates import Coordinates, coordinates

BODY = '<inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'


@dataclass(frozen=True)
class Measured:
    """A chain and the configurations that all compute.

    Attributes:
        title: what is printed.
        coordinates: the chain as we know it.
        reduced: the chain as Pinocchio knows it.
        tool: the number of the tool's frame there.
        q: configurations inside limits, (m, n).
    """

    title: str
    coordinates: Coordinates
    reduced: Any
    tool: int
    q: np.ndarray

    @cached_property
    def steps(self) -> list[tuple[str, np.ndarray, Any]]:
        """Kind, axis and placement of each joint on the link before."""
        found = []
        for joint, placement in zip(list(self.reduced.joints)[1:], list(self.reduced.jointPlacements)[1:], strict=True):
            screw = np.asarray(joint.createData().S).reshape(6)
            turns = bool(np.any(screw[3:]))
            found.append(("revolute" if turns else "prismatic", screw[3:] if turns else screw[:3], placement))
        return found

    @property
    def offset(self) -> Any:
        """The tool in the last joint's frame."""
        return self.reduced.frames[self.tool].placement

    def write_numbers(self, path: Path) -> None:
        """Write the chain as `loop.hpp` reads it."""
        lines = [str(len(self.steps))]
        for kind, axis, placement in [*self.steps, ("tool", np.zeros(3), self.offset)]:
            numbers = [*axis, *placement.rotation.ravel(), *placement.translation]
            lines.append(" ".join([kind, *(repr(float(x)) for x in numbers)]))
        path.write_text("\n".join(lines))

    def write_urdf(self, path: Path, count: int | None = None) -> None:
        """Write the chain, or its first joints, as URDF; the tool is a link of its own."""
        steps = self.steps[:count]
        parts = ['<robot name="chain">', f'<link name="l0">{BODY}</link>']
        for i, (kind, axis, placement) in enumerate(steps):
            limit = '<limit lower="-100" upper="100" effort="1" velocity="1"/>'
            inside = f'<axis xyz="{numbers(axis)}"/>{limit}'
            parts.append(f'<link name="l{i + 1}">{BODY}</link>')
            parts.append(joint(f"j{i + 1}", kind, f"l{i}", f"l{i + 1}", placement, inside))
        last = joint("tool_joint", "fixed", f"l{len(steps)}", "tool", self.offset)
        parts.append(f'<link name="tool"/>{last}</robot>')
        path.write_text("\n".join(parts))


def numbers(values: np.ndarray) -> str:
    """Return numbers with spaces between, every digit."""
    return " ".join(repr(float(x)) for x in values)


def joint(name: str, kind: str, parent: str, child: str, placement: Any, inside: str = "") -> str:
    """Return a joint's element."""
    origin = (
        f'<origin xyz="{numbers(placement.translation)}" rpy="{numbers(pin.rpy.matrixToRpy(placement.rotation))}"/>'
    )
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{origin}{inside}</joint>'


def measured(title: str, source: str, frame: str, count: int) -> Measured:
    """Return a robot's chain from its root to a frame, with random configurations inside limits."""
    model = ks.load(source)
    chain = coordinates(model, frame, model.robot.root)
    whole = pin.buildModelFromUrdf(str(model.loaded.source.path))
    locked = [i for i, name in enumerate(whole.names) if i and name not in chain.names]
    reduced = pin.buildReducedModel(whole, locked, pin.neutral(whole))
    if list(reduced.names)[1:] != list(chain.names) or reduced.nq != reduced.nv:
        raise ValueError(f"{source}: not a plain chain of joints with limits")
    q = chain.draw(np.random.default_rng(0), (count,), limited=True)
    return Measured(title, chain, reduced, reduced.getFrameId(frame), q)
