"""Is a configuration singular, why, what is lost, what moves inside, of what kind, and how far is the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified, length_scale
from kinetostat.analysis.singular.complete import single_joint_families
from kinetostat.analysis.singular.families import Group, codimension_at, group_of, held_sets
from kinetostat.analysis.singular.geometry import Cause, geometry
from kinetostat.analysis.singular.kind import kind
from kinetostat.analysis.singular.losses import (
    LostWrench,
    SelfMotion,
    lost_space,
    lost_wrenches,
    motion_space,
    self_motions,
)
from kinetostat.analysis.singular.mechanism import MODEL, STRICT, Mechanism, mechanism
from kinetostat.analysis.singular.nearest import Nearest, nearest
from kinetostat.analysis.singular.search import converge
from kinetostat.conventions import Array, Reference
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import ConfigurationError, quote

__all__ = ["Condition", "SingularAt", "certified_values", "remarks", "singular_at"]

_SEED = 4
_FEW_DIGITS = 1e-3  # rad or L: how far off a configuration typed with few digits may be


@dataclass(frozen=True)
class Condition:
    """Positions of one or two joints that make the arm singular whatever the others do."""

    positions: dict[str, float]
    name: str | None


@dataclass(frozen=True, repr=False)
class SingularAt:
    """What is to be said of a configuration.

    Attributes:
        mechanism: the chain, its task, its unit of length and its generic rank.
        q: the coordinates of the chain (n,), in rad and m.
        singular_values: of the length-scaled Jacobian, pure numbers, (min(m, n),).
        rank: how many are above the model tolerance.
        singular: whether the rank is below the generic rank.
        tolerance: which tolerance the vanishing ones meet: "strict" (1e-9), "model" (1e-5: a file with rounded angles),
            or None if the configuration is not singular.
        lost: the wrenches that no joint feels here, and does elsewhere.
        self_motions: joint rates that move nothing here, those of a redundant arm included.
        kind: fold, boundary, traversable or tangential (see `kind`); None if not singular.
        causes: why, by the geometry of the axes.
        conditions: joints whose positions alone make it singular.
        name: shoulder, elbow, wrist, or several; None where custom has no name.
        distance: the nearest singular configuration; distance 0 if this is one.
        certificate: what the two engines say of the Jacobian and the singular values.
        warnings: what is to be said of it.
    """

    mechanism: Mechanism
    q: Array
    singular_values: Array
    rank: int
    singular: bool
    tolerance: str | None
    lost: tuple[LostWrench, ...]
    self_motions: tuple[SelfMotion, ...]
    kind: str | None
    causes: tuple[Cause, ...]
    conditions: tuple[Condition, ...]
    name: str | None
    distance: Nearest
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        verdict = f"singular, {self.name or 'without a name'}, {self.kind}" if self.singular else "not singular"
        return f"<SingularAt {quote(self.mechanism.velocity.of)}: {verdict}, rank {self.rank}>"


def singular_at(
    model: Model,
    frame: str,
    q: Array,
    *,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
) -> SingularAt:
    """Say whether a configuration is singular, and everything about it.

    J = U diag(s) V^T, (m, n), with linear rows (and slides) in units of the arm's length L, is compared with the rank r
    that it has almost everywhere: the configuration is singular if s_r < 1e-5 ("model"; "strict" if s_r < 1e-9). The
    wrenches w with J^T w = 0 are what is lost, the rates v with J v = 0 move nothing. A structure that never has full
    rank, such as an arm of five joints, is not singular for that. K. Hunt, "Kinematic Geometry of Mechanisms",
    1978, on reciprocal screws; B. Roth, "Screws, motors, and wrenches that cannot be bought in a hardware store", 1984.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        q: one configuration (nq,).
        relative_to: the observer's link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        axes: the rows that count, such as "x y rz"; default all, see `mechanism`.
        reference: aligned, rows in the observer's axes; or local, in the axes of the tool's frame.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames, or a floating one; axes that cannot be.
        ConfigurationError: q is not one configuration of numbers.
    """
    arm = mechanism(model, frame, relative_to=relative_to, point=point, axes=axes, reference=reference)
    whole = checked(model.robot, q)
    if whole.ndim != 1:
        raise ConfigurationError("one configuration is asked about", remedy="ask about each")
    given = whole[list(arm.indices)]
    values, certificate = certified_values(arm, whole)
    rank = int(np.sum(values > MODEL))
    singular = rank < arm.generic_rank
    here = _settled(arm, given) if singular else given
    motions = motion_space(arm, here, rank)
    space = lost_space(arm, here, rank) if singular else np.zeros((len(arm.task.rows), 0))
    found = self_motions(arm, here, motions, space)
    if not singular:
        singles = tuple((single.index, p) for single in single_joint_families(arm, _SEED) for p in single.positions)
        distance = nearest(arm, here, singles)
        return SingularAt(
            arm, given, values, rank, False, None, (), found, None, (), (), None, distance, certificate, remarks(arm)
        )
    tolerance = "strict" if values[rank] <= STRICT else "model"
    lost = lost_wrenches(arm, here, space)
    shape = geometry(arm)
    held = _conditions(arm, here)
    names = [shape.name(group.held, here, lost, motions) for group in held]
    if len(lost) != 1 or not held:  # what the conditions do not tell
        names.append(shape.name((), here, lost, motions))
    conditions = tuple(
        Condition(dict(zip((arm.names[i] for i in group.held), group.positions, strict=True)), name)
        for group, name in zip(held, names, strict=False)
    )
    return SingularAt(
        arm,
        given,
        values,
        rank,
        True,
        tolerance,
        lost,
        found,
        kind(arm, here, space, motions),
        shape.causes(here, lost, motions),
        conditions,
        _joined(names),
        Nearest(0.0, 0.0, given, arm.within(given)),
        certificate,
        remarks(arm),
    )


def certified_values(arm: Mechanism, whole: Array) -> tuple[Array, Certificate]:
    """Return the singular values of the length-scaled Jacobian at configurations (..., nq), and the certificate."""
    columns = arm.model.robot.velocity_columns(dict.fromkeys(arm.joints))

    def both(engine: Engine) -> Array:
        matrix = arm.scaled(engine.jacobian(whole, arm.velocity)[..., columns])
        values = np.linalg.svd(matrix, compute_uv=False)
        padded = np.zeros((*matrix.shape[:-2], 1, matrix.shape[-1]))
        padded[..., 0, : values.shape[-1]] = values
        return np.concatenate([matrix, padded], -2)

    scale = length_scale(arm.model.robot, whole, arm.velocity.point, arm.length)
    value, certificate = certified(arm.model, both, scale)
    return value[..., -1, : min(len(arm.task.rows), len(arm.names))], certificate


def _settled(arm: Mechanism, q: Array) -> Array:
    """Return the exactly singular configuration next to one that was given with few digits; else the same again."""
    found, smallest = converge(arm, q[None])
    close = smallest[0] < STRICT and float(np.max(np.abs(arm.difference(found[0], q)))) < _FEW_DIGITS
    return found[0] if close else q


def _conditions(arm: Mechanism, q: Array) -> list[Group]:
    """Return the smallest sets of one or two joints, with their positions, that keep the arm singular by themselves."""
    generator = np.random.default_rng(_SEED)
    singles = held_sets(arm, q[None], 1, generator, MODEL)[0]
    pairs = held_sets(arm, q[None], 2, generator, MODEL)[0]
    alone = [pair for pair in pairs if not any(single[0] in pair for single in singles)]
    # A point of a curve in two joints keeps the arm singular, too, but that is a relation and no position.
    sets = singles + (alone if codimension_at(arm, q) > 1 else [])
    return [group_of(arm, held, q[list(held)], generator) for held in sets]


def _joined(names: Sequence[str | None]) -> str | None:
    """Return the names of several singularities at once, each word once."""
    words = {word for name in names if name for word in name.split(" and ")}
    return " and ".join(word for word in ("shoulder", "elbow", "wrist") if word in words) or None


def remarks(arm: Mechanism) -> tuple[str, ...]:
    """Return what is to be said of an arm whatever its configuration."""
    said = []
    if arm.generic_rank < len(arm.task.rows) and arm.task.name == "full":
        said.append(
            f"the structure has rank {arm.generic_rank} of 6 at almost every configuration; that is no singularity "
            "(--axes chooses the rows that count)"
        )
    if arm.rounded:
        said.append("the file rounds angles (such as 1.5708 for pi/2): what is below 1e-5 is judged to be zero")
    return tuple(said)
