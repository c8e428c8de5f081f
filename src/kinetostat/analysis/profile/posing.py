"""A limb at its named poses: zero, the middle of limits, and the states of the SRDF that set its joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import Configuration, configuration
from kinetostat.analysis.coordinates import Coordinates, coordinates
from kinetostat.analysis.manipulability import manipulability
from kinetostat.analysis.named_states import named_states
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.gathering import Gathered
from kinetostat.analysis.profile.measuring import measured_at
from kinetostat.analysis.profile.result import LimbPose
from kinetostat.analysis.statics import torque
from kinetostat.analysis.sweeping.sweep import DEFAULT, Sweep
from kinetostat.conventions import Array
from kinetostat.engines.model import Model
from kinetostat.errors import quote, quoted

__all__ = ["limb_poses"]

_STATES = 6  # of the SRDF, that are looked at
_ALWAYS = ("zero", "mid")


@dataclass(frozen=True)
class _Named:
    name: str
    at: Configuration


def limb_poses(model: Model, limb: Limb, swept: Sweep, gathered: Gathered) -> tuple[LimbPose, ...]:
    """Return a limb at its named poses, measured as its sweep is.

    Effort use at a pose is with all other joints at the pose, too.

    Args:
        model: the robot.
        limb: the limb.
        swept: its sweep.
        gathered: takes certificates, and what is left out.
    """
    arm = coordinates(model, limb.frame, limb.base)
    named = _named(model, limb, arm, gathered)
    q = np.stack([one.at.q for one in named])
    values = _values(model, limb, swept, q, gathered)
    if "effort_use" in swept.measures:
        values["effort_use"] = _effort_uses(model, arm, q, gathered)
    inside = np.all(arm.between(q[:, list(arm.indices)]), axis=-1)
    found = []
    for i, one in enumerate(named):
        here = manipulability(
            model,
            limb.frame,
            one.at.q,
            relative_to=limb.base,
            axes=None if len(swept.task.rows) == 6 else swept.task.row_names,
            length="none" if swept.length is None else swept.length,
        )
        gathered.certify("manipulability at poses", here.certificate)
        own = {name: float(each[i]) for name, each in values.items()}
        found.append(LimbPose(one.name, one.at, bool(inside[i]), here, own))
    return tuple(found)


def _named(model: Model, limb: Limb, arm: Coordinates, gathered: Gathered) -> list[_Named]:
    """Return the poses: zero, mid if that is elsewhere, and the first states that set a joint of the limb."""
    zero, middle = (_Named(name, configuration(model, name)) for name in _ALWAYS)
    where = list(arm.indices)
    poses = [zero] if np.array_equal(zero.at.q[where], middle.at.q[where]) else [zero, middle]
    states = [state for state in named_states(model) if set(limb.joints) & set(state.positions)]
    for state in states[:_STATES]:
        at = gathered.attempt(f"state {quote(state.name)}", lambda: configuration(model, state.positions))  # noqa: B023
        if at is not None:
            poses.append(_Named(f"state {state.name}" if state.name in _ALWAYS else state.name, at))
    if states[_STATES:]:
        told = quoted([state.name for state in states[_STATES:]])
        gathered.leave(f"states {told}", f"the first {_STATES} states of the SRDF are shown")
    return poses


def _values(model: Model, limb: Limb, swept: Sweep, q: Array, gathered: Gathered) -> dict[str, Array]:
    """Return the measures of a sweep at configurations (k, nq), by the sweep itself. {column: (k,)}."""
    again, rows = measured_at(model, limb, swept, q, DEFAULT)
    gathered.certify("manipulability at poses", *again.certificates.values())
    return dict(zip(DEFAULT, rows.T, strict=True))


def _effort_uses(model: Model, arm: Coordinates, q: Array, gathered: Gathered) -> Array:
    """Return the largest gravity torque over its limit of the chain's joints at configurations (k, nq). (k,)."""
    weighed = torque(model, q, gravity=True)
    gathered.certify("gravity torques at poses", weighed.certificate)
    own = weighed.utilisation[:, model.robot.velocity_columns(dict.fromkeys(arm.joints))]
    largest: Array = np.fmax.reduce(own, axis=-1)
    return largest
