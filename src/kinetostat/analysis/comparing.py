"""How far readers are apart: the largest difference of each kind of number, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis import witness
from kinetostat.analysis.loads import effort_units, force_scale
from kinetostat.analysis.panel import GRAVITY, Panel
from kinetostat.analysis.task import turning_columns
from kinetostat.analysis.witness import ACCURACY
from kinetostat.conventions import Array, Reference, tolerance
from kinetostat.engines.protocol import Engine
from kinetostat.engines.third import ThirdReader

__all__ = ["Gap", "gravity", "jacobians", "loads", "masses", "placements", "slips", "third"]

WITNESSED = 5  # configurations at which witnesses and the third reader are asked
_CHUNK = 400_000  # numbers of Jacobians that are held at once


@dataclass(frozen=True)
class Gap:
    """The largest difference of one kind of number.

    Attributes:
        quantity: what is compared.
        size: the largest difference; infinite where one is not a number, or their counts differ.
        allowed: what counts as agreement.
        unit: of the two.
        q: the configuration there, (nq,).
        frame: the link there; empty where it is about none.
        reference: of a Jacobian.
    """

    quantity: str
    size: float
    allowed: float
    unit: str
    q: Array
    frame: str = ""
    reference: Reference = Reference.ALIGNED

    @property
    def closed(self) -> bool:
        """Whether it counts as agreement."""
        return bool(self.size <= self.allowed)


def placements(panel: Panel) -> Gap:
    """Return how far the engines are apart on where all frames are."""
    one, other = (engine.placements(panel.q, panel.frames) for engine in panel.engines)
    return _placement_gap(panel, one, other, panel.q, panel.frames)


def third(panel: Panel, reader: ThirdReader) -> Gap:
    """Return how far the third reader is from the first engine, on the frames on which the engines agree.

    Raises:
        EngineError: it fails.
    """
    q = reader.settled(panel.q[:WITNESSED])
    one, other = (engine.placements(q, reader.frames) for engine in panel.engines)
    same = np.abs(one - other).max((-1, -2), keepdims=True) <= panel.tolerance
    foreign = reader.placements(q)
    return _placement_gap(panel, np.where(same, one, 0.0), np.where(same, foreign, 0.0), q, reader.frames)


def _placement_gap(panel: Panel, one: Array, other: Array, q: Array, frames: Sequence[str]) -> Gap:
    size, where = _largest(one, other)
    unit = "m" if where[-1:] == (3,) else "1"
    frame = frames[where[1]] if where else ""
    return Gap("placement", size, panel.tolerance, unit, q[where[0] if where else 0], frame)


def jacobians(panel: Panel) -> Gap:
    """Return how far the engines are apart on the Jacobians of frames, in the three references."""
    worst = Gap("Jacobian", 0.0, panel.tolerance, "1", panel.q[0], panel.frames[0])
    turning = turning_columns(panel.robot.independent)
    for frames in _chunks(panel, len(panel.q)):
        for reference in Reference:
            one, other = (engine.jacobians(panel.q, frames, reference) for engine in panel.engines)
            size, where = _largest(one, other)
            if size > worst.size:
                i, k, row, column = where or (0, 0, 0, 0)
                unit = _jacobian_unit(row < 3, turning[column])
                worst = Gap("Jacobian", size, panel.tolerance, unit, panel.q[i], frames[k], reference)
    return worst


def masses(panel: Panel) -> Gap:
    """Return how far the engines are apart on the masses of the base link and of the others."""
    one, other = (np.array(engine.masses()) for engine in panel.engines)
    size, _ = _largest(one, other)
    total = sum(abs(mass) for mass, _ in witness.weights(panel.robot).values())
    return Gap("mass", size, tolerance(total), "kg", panel.q[0])


def gravity(panel: Panel) -> Gap:
    """Return how far the engines are apart on the torques that hold the links against their weight."""
    return _torque_gap(panel, "gravity torque", _held_weight, gravity_force(panel))


def loads(panel: Panel) -> Gap:
    """Return how far the engines are apart on the torques that wrenches at some tips take."""
    return _torque_gap(panel, "torque of a wrench", _held_loads(panel), load_force(panel))


def gravity_force(panel: Panel) -> float:
    """Return the sum of the weights, which rounding of torques grows with, N."""
    return force_scale(panel.model, GRAVITY, ())


def load_force(panel: Panel) -> float:
    """Return the sum of the wrenches, N and Nm."""
    return force_scale(panel.model, np.zeros(3), panel.loads)


def _torque_gap(panel: Panel, quantity: str, torques: Callable[[Engine, Array], Array], force: float) -> Gap:
    one, other = (torques(engine, panel.q) for engine in panel.engines)
    size, where = _largest(one, other)
    units = [unit for joint in panel.robot.independent for unit in effort_units(joint)]
    unit = units[where[1]] if where else "Nm"
    return Gap(quantity, size, tolerance(panel.load_length, force), unit, panel.q[where[0] if where else 0])


def _held_weight(engine: Engine, q: Array) -> Array:
    return engine.holding_torques(q, GRAVITY, ())


def _held_loads(panel: Panel) -> Callable[[Engine, Array], Array]:
    return lambda engine, q: engine.holding_torques(q, np.zeros(3), panel.loads)


def slips(panel: Panel, engine: Engine, *, weight: bool) -> list[Gap]:
    """Return how far one engine is from the differences of its own placements, along random joint rates.

    Its Jacobians from the rates of placements, its gravity torques (if `weight`) from the rate of the potential energy,
    its torques of wrenches from their power: tau . qdot = F . V.
    """
    robot, q = panel.robot, panel.q[:WITNESSED]
    rates = np.random.default_rng(1).uniform(-1, 1, (len(q), robot.nv))
    rates /= np.sum(np.abs(rates), -1, keepdims=True)
    found = [_jacobian_slip(panel, engine, q, rates)]
    if weight:
        power = witness.energy_rate(robot, engine.placements, witness.weights(robot), GRAVITY, q, rates)
        own = np.sum(_held_weight(engine, q) * rates, -1)
        found.append(_power_slip(panel, "gravity torque", own, power, gravity_force(panel)))
    if panel.loads:
        twists = witness.along(robot, engine.placements, q, rates, [load.at.of for load in panel.loads])
        power = np.sum(twists * np.array([load.wrench for load in panel.loads]), (-1, -2))
        own = np.sum(_held_loads(panel)(engine, q) * rates, -1)
        found.append(_power_slip(panel, "torque of a wrench", own, power, load_force(panel)))
    return found


def _jacobian_slip(panel: Panel, engine: Engine, q: Array, rates: Array) -> Gap:
    allowed = ACCURACY * panel.length
    worst = Gap("Jacobian", 0.0, allowed, "1", q[0], panel.frames[0])
    for frames in _chunks(panel, len(q)):
        own = (engine.jacobians(q, frames, Reference.ALIGNED) @ rates[:, None, :, None])[..., 0]
        size, where = _largest(own, witness.along(panel.robot, engine.placements, q, rates, frames))
        if size > worst.size:
            i, k, row = where or (0, 0, 0)
            worst = Gap("Jacobian", size, allowed, "m/s" if row < 3 else "rad/s", q[i], frames[k])
    return worst


def _power_slip(panel: Panel, quantity: str, own: Array, power: Array, force: float) -> Gap:
    size, where = _largest(own, power)
    allowed = ACCURACY * panel.load_length * force
    return Gap(quantity, size, allowed, "W", panel.q[where[0] if where else 0])


def _chunks(panel: Panel, count: int) -> Iterator[tuple[str, ...]]:
    """Yield the frames of which Jacobians are compared, as many at a time as memory is spent on."""
    size = max(1, _CHUNK // (6 * count * max(1, panel.robot.nv)))
    for start in range(0, len(panel.twisted), size):
        yield panel.twisted[start : start + size]


def _largest(one: Array, other: Array) -> tuple[float, tuple[int, ...]]:
    """Return the largest difference of two arrays and where it is; infinite where one is not a number."""
    if one.shape != other.shape:
        return float("inf"), ()
    if one.size == 0:
        return 0.0, ()
    difference = np.abs(one - other)
    difference[~np.isfinite(difference)] = np.inf
    where = np.unravel_index(int(np.argmax(difference)), difference.shape)
    return float(difference[where]), tuple(int(i) for i in where)


def _jacobian_unit(linear: bool, turning: bool) -> str:
    """Return the unit of an entry: of a linear or angular row, and of a column that turns or slides."""
    return {(True, True): "m/rad", (False, False): "rad/m"}.get((linear, turning), "1")
