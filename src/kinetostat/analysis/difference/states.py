"""What changed of the named states of two robots' SRDFs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kinetostat.analysis.difference.change import Change, Tolerance, Value
from kinetostat.analysis.difference.matching import Matching
from kinetostat.engines.model import Model
from kinetostat.urdf.description import Joint
from kinetostat.urdf.srdf import GroupState

__all__ = ["state_changes"]

_UNTOLD = "under a name that no joint has any more"


def state_changes(a: Model, b: Model, matching: Matching, tolerance: Tolerance) -> Iterator[Change]:
    """Yield what changed of the named states; none where a robot came from standard input, which has no SRDF.

    Args:
        a: the robot before.
        b: the robot after.
        matching: which joint is which.
        tolerance: what does not count.
    """
    if any(model.loaded.source.path is None and not model.semantics.file for model in (a, b)):
        return
    before, after = _by_name(a), _by_name(b)
    for kind, here, there in (("removed", before, after), ("added", after, before)):
        for name in here:
            if name not in there:
                yield Change(kind, "state", name)
    comparison = _Comparison(a.robot.joint_by_name, b.robot.joint_by_name, matching, tolerance)
    for name, state in before.items():
        if name in after:
            yield from comparison.state(name, state, after[name])


def _by_name(model: Model) -> dict[str, GroupState]:
    return {f"{s.group}/{s.name}" if s.group else s.name: s for s in model.semantics.states}


@dataclass(frozen=True)
class _Comparison:
    """The joints of two robots, matched."""

    ours: dict[str, Joint]
    theirs: dict[str, Joint]
    matching: Matching
    tolerance: Tolerance

    def state(self, name: str, before: GroupState, after: GroupState) -> Iterator[Change]:
        """Yield the joints of a state that are elsewhere now, those that it names in one robot only among them."""
        was = {self.matching.joints.get(joint, joint): values for joint, values in before.positions.items()}
        now = dict(after.positions)
        for other in list(was):
            joint = self.matching.joints_back.get(other, other)
            if other not in now and joint in now and joint not in self.theirs:  # renamed, and the state was not told
                values = now.pop(joint)
                same = self._near(was[other], values)
                words = f"{'the same' if same else _words(values)}, {_UNTOLD}"
                yield Change("changed", "state", name, joint, _values(was.pop(other)), words)
        for other in dict.fromkeys((*was, *now)):
            ends = was.get(other, ()), now.get(other, ())
            if not self._near(*ends):
                yield self._moved(name, self.matching.joints_back.get(other, other), *ends)

    def _moved(self, name: str, joint: str, was: tuple[float, ...], now: tuple[float, ...]) -> Change:
        known = self.ours.get(joint)
        unit = "" if known is None or known.type.nq != 1 else "rad" if known.type.is_angle else "m"
        size = max(abs(x - y) for x, y in zip(was, now, strict=True)) if len(was) == len(now) else None
        return Change("changed", "state", name, joint, _values(was), _values(now), size, unit)

    def _near(self, was: tuple[float, ...], now: tuple[float, ...]) -> bool:
        if len(was) != len(now):
            return False
        return all(abs(x - y) <= self.tolerance.absolute for x, y in zip(was, now, strict=True))


def _values(positions: tuple[float, ...]) -> Value:
    return positions[0] if len(positions) == 1 else positions or None


def _words(positions: tuple[float, ...]) -> str:
    return " ".join(f"{value:.6g}" for value in positions)
