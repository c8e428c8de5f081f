"""The readers of one robot side by side, and what they are asked: frames, configurations, a tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinetostat.analysis.configuration import configuration, random_configurations
from kinetostat.analysis.crosscheck import length_scale
from kinetostat.analysis.loads import load_scale
from kinetostat.conventions import Array, Load, Velocity, tolerance
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.engines.third import ThirdReader
from kinetostat.errors import EngineError
from kinetostat.urdf.description import Robot

__all__ = ["GRAVITY", "Panel", "configurations", "panel", "positions"]

GRAVITY = 9.81 * np.array([0.36, 0.48, -0.8])  # askew, so that weight turns upright axes, too
_TWISTED = 4_000_000  # numbers of Jacobians that are compared at most: a few seconds
_FRAMES = 2_500  # frames of which Jacobians are compared at most
_LOADED = 4  # links that carry a wrench


@dataclass(frozen=True)
class Panel:
    """The readers of one robot, and what they are asked.

    Attributes:
        model: the robot.
        first, second: the two engines.
        third: the third reader, or None.
        q: configurations, (n, nq).
        notes: what is left out and why.
    """

    model: Model
    first: Engine
    second: Engine
    third: ThirdReader | None
    q: Array
    notes: tuple[str, ...]

    @property
    def robot(self) -> Robot:
        """The description."""
        return self.model.robot

    @property
    def engines(self) -> tuple[Engine, Engine]:
        """The two engines."""
        return self.first, self.second

    @cached_property
    def frames(self) -> tuple[str, ...]:
        """All frames."""
        return tuple(self.robot.link_by_name)

    @cached_property
    def twisted(self) -> tuple[str, ...]:
        """The frames of which Jacobians are compared: all, or of a very large robot some, spread over the file."""
        most = min(_FRAMES, max(50, _TWISTED // (6 * len(self.q) * max(1, self.robot.nv))))
        if len(self.frames) <= most:
            return self.frames
        return tuple(self.frames[i] for i in np.linspace(0, len(self.frames) - 1, most).astype(int))

    @cached_property
    def tolerance(self) -> float:
        """What counts as agreement between two readers, m and 1."""
        return tolerance(self.length)

    @cached_property
    def length(self) -> float:
        """The length that rounding grows with at these configurations, m."""
        return length_scale(self.robot, self.q)

    @cached_property
    def loads(self) -> tuple[Load, ...]:
        """Wrenches of some 1 N and 1 Nm on some of the tips that move, in the root's axes about the tips' origins."""
        robot = self.robot
        moved = [tip for tip in robot.tips if robot.movable_path(robot.root, tip)][:200]
        chosen = [moved[i] for i in sorted({len(moved) * k // _LOADED for k in range(_LOADED)})] if moved else []
        wrenches = np.random.default_rng(0).uniform(-1, 1, (len(chosen), 6))
        return tuple(Load(Velocity(tip, robot.root, robot.root), w) for tip, w in zip(chosen, wrenches, strict=True))

    @cached_property
    def load_length(self) -> float:
        """As `length`, for torques."""
        return load_scale(self.robot, self.q, self.loads)


def panel(model: Model, samples: int, seed: int, third: bool) -> Panel:
    """Return the readers of a robot.

    Raises:
        DisagreementError: the engines do not even see the same coordinates.
        RobotError: Pinocchio refuses the robot.
    """
    q = configurations(model, samples, seed)
    second = model.witness
    assert second is not None
    reader, notes = _third(model) if third else (None, ())
    found = Panel(model, model.engine, second, reader, q, notes)
    if len(found.twisted) < len(found.frames):
        note = f"Jacobians of {len(found.twisted)} of {len(found.frames)} frames are compared, placements of all"
        found = Panel(model, model.engine, second, reader, q, (*notes, note))
    return found


def _third(model: Model) -> tuple[ThirdReader | None, tuple[str, ...]]:
    """Return the third reader and what it leaves out, or None and why."""
    if model.floating_base:
        return None, (f"{ThirdReader.name} is left out: it knows no added floating base",)
    try:
        reader = ThirdReader(model.loaded.source.data, model.robot)
    except EngineError as error:
        return None, (f"{ThirdReader.name} is left out: {error.message}",)
    return reader, tuple(f"{ThirdReader.name}: {note}" for note in reader.notes)


def configurations(model: Model, samples: int, seed: int) -> Array:
    """Return zero, the middle of limits, and random configurations inside limits. (samples, nq).

    Limits of one position do not count for the random ones: a file that leaves its limits out locks every joint at
    zero, where half of a robot's numbers vanish.
    """
    robot = model.robot
    fixed = [configuration(robot, word).q for word in ("zero", "mid")][:samples]
    drawn = random_configurations(robot, seed, samples - len(fixed))
    generator = np.random.default_rng([seed, 1])
    for joint in robot.independent:
        lower, upper = joint.limit.range
        if joint.type.nq == 1 and lower == upper:
            half = np.pi if joint.type.is_angle else 1.0
            drawn[:, robot.position_slices[joint.name].start] += generator.uniform(-half, half, len(drawn))
    return np.concatenate([np.array(fixed).reshape(len(fixed), robot.nq), drawn])


def positions(robot: Robot, q: Array) -> dict[str, float]:
    """Return a configuration by the names of its coordinates."""
    return {name: float(value) for name, value in zip(robot.position_names, q, strict=True)}
