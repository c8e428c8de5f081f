"""The named states of a robot's SRDF, as configurations of joints that can be set."""

from __future__ import annotations

from dataclasses import dataclass

from kinetostat.engines.model import Model

__all__ = ["NamedState", "named_states"]


@dataclass(frozen=True)
class NamedState:
    """A state: its name, and the positions of the joints that it sets and that can be set, in rad and m."""

    name: str
    positions: dict[str, tuple[float, ...]]


def named_states(model: Model) -> list[NamedState]:
    """Return the states in file order; those of groups under one name are joined.

    Where two groups contradict each other under one name, each is a state of its own, `GROUP/NAME`.
    """
    settable = {joint.name for joint in model.robot.independent}
    found = []
    for name in model.semantics.state_names():
        groups = [state for state in model.semantics.states if state.name == name]
        joined: dict[str, tuple[float, ...]] = {}
        alone = any(joined.setdefault(joint, at) != at for state in groups for joint, at in state.positions.items())
        several = [(f"{s.group}/{s.name}", s.positions) for s in groups] if alone else [(name, joined)]
        found += [
            NamedState(label, {joint: at for joint, at in positions.items() if joint in settable})
            for label, positions in several
        ]
    return found
