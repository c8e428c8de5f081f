"""Who is wrong where two engines differ: a third reader outvotes one of them, or a witness decides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinetostat.analysis import witness
from kinetostat.analysis.panel import GRAVITY, Panel
from kinetostat.analysis.witness import ACCURACY, Places, Weights
from kinetostat.conventions import Array, Reference
from kinetostat.errors import EngineError

__all__ = ["Arbiter"]


@dataclass(frozen=True)
class Arbiter:
    """Names the odd one out of a panel; the empty string where it is one against one.

    Its methods raise an EngineError if the third reader fails.

    Attributes:
        panel: the readers.
        placements_agree: whether the engines agree on all placements: then these are as good as a third reader's.
        masses_agree: whether they agree on masses.
        inconsistent: engines whose own Jacobians are not the rates of their own placements.
    """

    panel: Panel
    placements_agree: bool
    masses_agree: bool
    inconsistent: tuple[str, ...]

    def of_placement(self, frame: str, q: Array) -> str:
        """Return the engine that the third reader outvotes on where a frame is, or the one that contradicts itself."""
        third = self.panel.third
        if third is not None and frame in third.frames:
            at = third.settled(q)
            one, other = (engine.placements(at, [frame])[0] for engine in self.panel.engines)
            if not _near(one, other, self.panel.tolerance):  # else they differ along a joint that it holds
                return self._odd(one, other, self._third(at, [frame])[0], self.panel.tolerance)
        return self.inconsistent[0] if len(self.inconsistent) == 1 else ""

    def of_jacobian(self, frame: str, q: Array, reference: Reference) -> str:
        """Return the engine whose Jacobian is not the rate of the placement."""
        places = self._places(q, [frame])
        if places is None:
            return ""
        wanted = witness.jacobian(self.panel.robot, places, q, frame, reference)
        one, other = (engine.jacobians(q, [frame], reference)[0] for engine in self.panel.engines)
        return self._odd(one, other, wanted, ACCURACY * self.panel.length * self._fastest)

    def of_gravity(self, q: Array, force: float) -> str:
        """Return the engine whose gravity torque is not the gradient of the potential energy."""
        heavy, trusted = self._weights
        places = self._places(q, list(heavy)) if trusted else None
        if places is None:
            return ""
        wanted = witness.energy_torques(self.panel.robot, places, heavy, GRAVITY, q)
        one, other = (engine.holding_torques(q, GRAVITY, ()) for engine in self.panel.engines)
        return self._odd(one, other, wanted, ACCURACY * self.panel.load_length * force * self._fastest)

    def of_loads(self, q: Array, force: float) -> str:
        """Return the engine whose torques give another power than the wrenches that they hold."""
        frames, wrenches = [load.at.of for load in self.panel.loads], [load.wrench for load in self.panel.loads]
        places = self._places(q, frames)
        if places is None:
            return ""
        rates = np.eye(self.panel.robot.nv)
        twists = witness.along(self.panel.robot, places, q, rates, frames)
        wanted = np.einsum("nki,ki->n", twists, np.array(wrenches))
        one, other = (engine.holding_torques(q, np.zeros(3), self.panel.loads) for engine in self.panel.engines)
        return self._odd(one, other, wanted, ACCURACY * self.panel.load_length * force * self._fastest)

    def of_masses(self, allowed: float) -> str:
        """Return the engine that reads another mass than the third reader."""
        if self.panel.third is None:
            return ""
        try:
            masses = {name: mass for name, (mass, _) in self.panel.third.weights().items()}
        except EngineError:
            return ""
        base = masses.pop(self.panel.robot.root, 0.0)
        one, other = (np.array(engine.masses()) for engine in self.panel.engines)
        return self._odd(one, other, np.array([base, sum(masses.values())]), allowed)

    # --- witnesses ---------------------------------------------------------------------------------------------

    @cached_property
    def _fastest(self) -> float:
        return self.panel.robot.largest_multiplier

    @cached_property
    def _weights(self) -> tuple[Weights, bool]:
        """Return masses and centres, and whether they are good: the third reader's, or those that both engines read."""
        if self.panel.third is not None:
            try:
                return self.panel.third.weights(), True
            except EngineError:
                pass
        return witness.weights(self.panel.robot), self.masses_agree

    def _places(self, q: Array, frames: Sequence[str]) -> Places | None:
        """Return placements that may be trusted: the third reader's, or those that both engines give."""
        third = self.panel.third
        if third is not None and not third.held and set(frames) <= set(third.frames):
            return self._third
        if self.placements_agree:
            return self.panel.first.placements
        odd = {self.of_placement(frame, q) for frame in frames} - {""}
        good = [engine for engine in self.panel.engines if {engine.name} != odd] if len(odd) == 1 else []
        return good[0].placements if len(good) == 1 else None

    def _third(self, q: Array, frames: Sequence[str]) -> Array:
        """Return the third reader's placements of frames that it knows.

        Raises:
            EngineError: it fails.
        """
        assert self.panel.third is not None
        where = [self.panel.third.frames.index(frame) for frame in frames]
        return self.panel.third.placements(q)[..., where, :, :]

    def _odd(self, one: Array, other: Array, wanted: Array, allowed: float) -> str:
        near = [_near(found, wanted, allowed) for found in (one, other)]
        names = [engine.name for engine in self.panel.engines]
        return names[near.index(False)] if sum(near) == 1 else ""


def _near(a: Array, b: Array, allowed: float) -> bool:
    """Return whether two arrays are of one shape and no number differs by more; NaN always does."""
    return a.shape == b.shape and bool(np.max(np.abs(a - b), initial=0.0) <= allowed)
