"""What it means that the two engines agree, and the questions that they are asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import kinetostat as ks
from kinetostat.conventions import Reference, Velocity, WrenchOrTwist
from kinetostat.engines.protocol import Engine

__all__ = ["assert_agreement", "assert_masses_agree", "by_reference", "difference", "labels"]


def difference(model: ks.Model, evaluate: Callable[[Engine], np.ndarray]) -> float:
    """Return the largest difference of any number of the two engines' answers; infinite if their shapes differ."""
    assert model.witness is not None
    first, second = evaluate(model.engine), evaluate(model.witness)
    if first.shape != second.shape or not np.all(np.isfinite(first)):
        return float("inf")
    return float(np.max(np.abs(first - second), initial=0.0))


def assert_agreement(
    model: ks.Model, q: np.ndarray, velocity: Velocity, qdot: np.ndarray | None = None, *, placements: bool = True
) -> None:
    """Ask both engines for everything about one velocity: placement, frame changes, Jacobian, its rate along qdot.

    They must agree to 1e-12 times the robot's reach, or 1e-12 if it is shorter than a metre.
    """
    of, observer = velocity.of, velocity.relative_to
    questions: dict[str, Callable[[Engine], np.ndarray]] = {"jacobian": lambda e: e.jacobian(q, velocity)}
    if placements:
        questions["placement"] = lambda e: e.placement(q, of, observer)
        questions["twists"] = lambda e: e.frame_change(q, of, observer, WrenchOrTwist.TWIST)
        questions["wrenches"] = lambda e: e.frame_change(q, of, observer, WrenchOrTwist.WRENCH)
    if qdot is not None:
        questions["jacobian rate"] = lambda e: e.jacobian_rate(q, qdot, velocity)
    allowed = 1e-12 * max(1.0, model.robot.reach)
    apart = {
        name: found for name, evaluate in questions.items() if not (found := difference(model, evaluate)) <= allowed
    }
    assert not apart, f"the engines differ on {velocity}: {apart}, more than {allowed:g}"


def assert_masses_agree(model: ks.Model) -> None:
    """Ask both engines for the masses of the base and of the rest."""
    total = sum(abs(link.inertial.mass) for link in model.robot.links if link.inertial)
    assert difference(model, lambda engine: np.array(engine.masses())) <= 1e-12 * max(1.0, total)


def by_reference(frame: str, observer: str) -> list[Velocity]:
    """Return the labels of the three shorthand references."""
    return [Velocity.by_reference(reference, frame, observer) for reference in Reference]


def labels(robot: ks.Robot, seed: int, count: int) -> Iterator[Velocity]:
    """Yield random labels: any frame, observer, axes; of F's origin, any point, or the one at the observer's origin."""
    random = np.random.default_rng(seed)
    for i in range(count):
        of, observer, axes = (robot.links[int(k)].name for k in random.integers(len(robot.links), size=3))
        point = [(0.0, 0.0, 0.0), tuple(random.uniform(-1, 1, 3).tolist()), None][i % 3]
        yield Velocity(of, observer, axes, point)
