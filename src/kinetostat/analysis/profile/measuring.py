"""The measures of a limb over random configurations inside limits, with the tool's place in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.gathering import Gathered
from kinetostat.analysis.sweeping.sweep import DEFAULT, RowBlock, Sweep, sweep
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import quoted
from kinetostat.urdf.description import NO_LIMIT

__all__ = ["Measured", "measured", "measured_at"]

_PLACE, _SMALLEST = "pose", "minimum_singular_value"


@dataclass(frozen=True, repr=False)
class Measured:
    """A sweep, and of its rows what is drawn.

    Attributes:
        sweep: the distributions.
        coordinates: the chain's coordinates, (N, n).
        positions: the tool in the base's axes, (N, 3), m.
        smallest: the smallest singular value that counts, (N,).
    """

    sweep: Sweep
    coordinates: Array
    positions: Array
    smallest: Array

    def __repr__(self) -> str:
        return f"<Measured: {len(self.positions)} configurations>"


def measured(
    model: Model, limb: Limb, rest: Array, gathered: Gathered, *, effort: bool, samples: int, seed: int
) -> Measured | None:
    """Return the measures of a limb; None where they are refused.

    Args:
        model: the robot.
        limb: the limb.
        rest: where all other joints are, (nq,).
        gathered: takes the certificate, and what is left out.
        effort: whether gravity torques are compared with effort limits.
        samples: how many configurations.
        seed: of the random numbers.
    """
    blocks = list[RowBlock]()
    # The place as a part of the pose: a position would be a measure with a distribution of its own.
    measures = (_PLACE, *DEFAULT, *(["effort_use"] if effort else []))

    def swept() -> Sweep:
        return sweep(
            model,
            limb.frame,
            rest,
            samples=samples,
            seed=seed,
            measures=measures,
            relative_to=limb.base,
            sink=blocks.append,
        )

    # Poses are measured, and the map is drawn, as the sweep says: without it there is neither.
    found = gathered.attempt("manipulability, poses and map of the reach", swept)
    if found is None:
        return None
    gathered.certify("manipulability over configurations", *found.certificates.values())
    _say_what_limits_lack(model, limb, gathered)
    rows = np.concatenate([block.values for block in blocks])
    column = 7 + DEFAULT.index(_SMALLEST)  # after the pose
    return Measured(found, np.concatenate([block.q for block in blocks]), rows[:, :3].copy(), rows[:, column].copy())


def measured_at(model: Model, limb: Limb, swept: Sweep, q: Array, measures: Sequence[str]) -> tuple[Sweep, Array]:
    """Return the sweep of a limb at configurations (k, nq), and its rows (k, c), measured as `swept` is."""
    blocks = list[RowBlock]()
    found = sweep(
        model,
        limb.frame,
        q[0],
        configurations=q,
        measures=measures,
        relative_to=limb.base,
        length="none" if swept.length is None else swept.length,
        sink=blocks.append,
    )
    return found, np.concatenate([block.values for block in blocks])


def _say_what_limits_lack(model: Model, limb: Limb, gathered: Gathered) -> None:
    """Tell for which joints a part of an endless range stands for the whole."""
    arm = coordinates(model, limb.frame, limb.base)
    endless = np.any(np.abs(arm.stated_limits) > NO_LIMIT, axis=0) & ~np.array(arm.periodic)
    for turns, words in ((False, "1 m"), (True, "half a turn")):
        some = [name for name, one, kind in zip(arm.names, endless, arm.turning, strict=True) if one and kind is turns]
        if some:
            gathered.leave(f"the whole range of {quoted(some)}", f"no limit: taken within {words}")
    if arm.locked:
        gathered.leave(f"motion of {quoted(arm.locked)}", "limits are one position: locked there")
