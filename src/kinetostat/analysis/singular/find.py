"""Where the singular configurations are: families, each with its condition, kind and a certified witness."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinetostat.analysis.configuration import neutral
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.singular.at import certified_values, remarks
from kinetostat.analysis.singular.complete import SingleJoint, single_joint_families
from kinetostat.analysis.singular.families import Group, group_of, grouped
from kinetostat.analysis.singular.geometry import Cause, Geometry, geometry
from kinetostat.analysis.singular.kind import kind
from kinetostat.analysis.singular.losses import LostWrench, lost_space, lost_wrenches, motion_space
from kinetostat.analysis.singular.mechanism import MODEL, STRICT, Mechanism, mechanism
from kinetostat.analysis.singular.search import converge
from kinetostat.analysis.singular.surfaces import surfaces
from kinetostat.conventions import Array, Reference
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, quote

__all__ = ["Coverage", "Family", "SingularFamilies", "singular_find"]

STARTS = 1000
_MOST_STARTS = 1_000_000
_BATCH = 250
_COMPILED = 3000  # searches from which on compiled code saves more than its loading takes: some tenths of a second
_CANDIDATES = 256  # among which the witness that is farthest from other families is chosen
_KINDS = 7  # configurations of a family of which the kind is taken


@dataclass(frozen=True)
class Family:
    """Singular configurations with one condition.

    Attributes:
        positions: {joint: position} that all of them have, in rad or m.
        support: names of the joints that the condition is about; more than in `positions` where it is a surface.
        codimension: how many independent equations the condition is.
        kind: fold, boundary, traversable or tangential; several where its members differ.
        name: shoulder, elbow, wrist, or several; None where custom has no name.
        causes: why, by the geometry of the axes at the witness.
        tolerance: "strict" if it holds in exact numbers, "model" if but for the rounding of the file.
        inside_limits: whether members inside joint limits exist (for a surface: were found).
        complete: whether it is one of those that the polynomial finds completely.
        hits: how many searches ended on it.
        witness: a member, coordinates of the chain (n,).
        singular_values: of the length-scaled Jacobian at the witness.
    """

    positions: dict[str, float]
    support: tuple[str, ...]
    codimension: int
    kind: str
    name: str | None
    causes: tuple[Cause, ...]
    tolerance: str
    inside_limits: bool
    complete: bool
    hits: int
    witness: Array
    singular_values: Array

    @property
    def implicit(self) -> bool:
        """Whether it is a surface, whose positions depend on each other."""
        return set(self.positions) != set(self.support)


@dataclass(frozen=True)
class Coverage:
    """What is complete, and what is statistical.

    Attributes:
        complete: joints whose single-joint families are all found, to the model tolerance; of those whose turns do not
            repeat (slides, screws), inside their range and as far again on both sides.
        incomplete: joints for which that cannot be said.
        seen_once: families that one search alone has found.
        unseen: Good-Turing estimate of the chance that a further search ends on a family not in the list:
            `seen_once` / searches that converged (I. Good, "The population frequencies of species", 1953); None
            without any.
    """

    complete: tuple[str, ...]
    incomplete: tuple[str, ...]
    seen_once: int
    unseen: float | None


@dataclass(frozen=True, repr=False)
class SingularFamilies:
    """The singular configurations of an arm.

    Attributes:
        mechanism: the chain, its task, its unit of length and its generic rank.
        families: those inside joint limits first, conditions of fewer joints first, surfaces last.
        starts: how many searches were made.
        converged: how many of them ended in a singular configuration (s_r < 1e-9).
        unclassified: how many of those belong to no family.
        coverage: what is complete, and what is statistical.
        certificate: what the two engines say of all witnesses.
        warnings: what is to be said of the arm.
    """

    mechanism: Mechanism
    families: tuple[Family, ...]
    starts: int
    converged: int
    unclassified: int
    coverage: Coverage
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        where = f"{self.converged} of {self.starts} searches converged"
        return f"<SingularFamilies {quote(self.mechanism.velocity.of)}: {len(self.families)} families, {where}>"


def singular_find(
    model: Model,
    frame: str,
    *,
    relative_to: str | None = None,
    point: Sequence[float] | None = None,
    axes: str | Sequence[str] | None = None,
    reference: Reference | str = Reference.ALIGNED,
    starts: int = STARTS,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
) -> SingularFamilies:
    """Return the families of singular configurations of an arm, those where s_r = 0 with J = U diag(s) V^T, (m, n).

    Families that one joint makes alone come from common roots of polynomials (`complete`); all others from searches
    (`search`), one half of which start inside joint limits and the other anywhere, sorted by what they have in common
    (`families`). Equal arguments give equal results.

    Args:
        model: the robot.
        frame: the tool's frame, a link.
        relative_to: the observer's link; default the root link.
        point: the tool point in the frame's coordinates, in m; default its origin.
        axes: the rows that count, such as "x y rz"; default all, see `mechanism`.
        reference: aligned, rows in the observer's axes; or local, in the axes of the tool's frame.
        starts: how many searches.
        seed: of the random numbers.
        progress: called with what is being done and the share of it that is done.

    Raises:
        UnknownNameError: no such frame.
        UsageError: no joint between the frames, or a floating one; axes or starts that cannot be.
    """
    if not 1 <= starts <= _MOST_STARTS:
        raise UsageError(f"--starts is between 1 and {_MOST_STARTS}", remedy="for instance 1000")
    tell = progress or (lambda _what, _share: None)
    arm = mechanism(model, frame, relative_to=relative_to, point=point, axes=axes, reference=reference)
    arm = replace(arm, compiled=starts >= _COMPILED)
    generator = np.random.default_rng(seed)
    tell("single joints", 0.0)
    singles = single_joint_families(arm, seed)
    known = [group_of(arm, (s.index,), np.array([p]), generator) for s in singles for p in s.positions]
    anywhere = arm.draw(generator, (starts // 2,))
    inside = arm.draw(generator, (starts - len(anywhere),), limited=True)
    begun = np.concatenate([anywhere, inside])
    ended = []
    for first in range(0, starts, _BATCH):
        tell("searching", first / starts)
        q, smallest = converge(arm, begun[first : first + _BATCH])
        ended.append(q[smallest < STRICT])
    singular = np.concatenate(ended)
    tell("sorting", 0.0)
    groups, left = grouped(arm, singular, known, generator)
    implicit, unclassified = surfaces(arm, left, generator)
    groups += implicit
    shape, families = geometry(arm), list[Family]()
    for i, group in enumerate(groups):
        tell("families", i / len(groups))
        families.append(_family(arm, shape, group, i < len(known), generator))
    families.sort(key=lambda family: _reading_order(arm, family))
    witnesses = np.array([family.witness for family in families]).reshape(len(families), len(arm.names))
    values, certificate = certified_values(arm, arm.configuration(witnesses, neutral(model.robot)))
    certain = [replace(family, singular_values=value) for family, value in zip(families, values, strict=True)]
    coverage = _coverage(arm, singles, groups, len(singular))
    tell("families", 1.0)
    return SingularFamilies(
        arm, tuple(certain), starts, len(singular), len(unclassified), coverage, certificate, remarks(arm)
    )


def _reading_order(arm: Mechanism, family: Family) -> tuple[object, ...]:
    """Return the key that sorts families: inside limits first, then by how many joints, which ones, positions."""
    support = [arm.names.index(name) for name in family.support]
    where = [abs(value) for value in family.positions.values()], list(family.positions.values())
    return not family.inside_limits, family.implicit, len(support), family.codimension, support, where


def _coverage(arm: Mechanism, singles: Sequence[SingleJoint], groups: Sequence[Group], converged: int) -> Coverage:
    once = sum(len(group.members) == 1 for group in groups)
    return Coverage(
        tuple(arm.names[single.index] for single in singles if single.degree is not None),
        tuple(arm.names[single.index] for single in singles if single.degree is None),
        once,
        once / converged if converged else None,
    )


def _family(arm: Mechanism, shape: Geometry, group: Group, complete: bool, generator: np.random.Generator) -> Family:
    members = _members(arm, group, generator)
    values = np.linalg.svd(arm.jacobian(members), compute_uv=False)
    # The member farthest from other families, inside limits if any is: the largest of the values that do not vanish.
    second = values[:, arm.generic_rank - 2] if arm.generic_rank > 1 else np.ones(len(members))
    inside = np.all(arm.inside(members), axis=-1)
    order = np.lexsort((-second, ~inside))
    witness = members[order[0]]
    told = [_kind(arm, q) for q in members[order[:_KINDS]]]
    rank = _rank(arm, witness)
    motions, space = motion_space(arm, witness, rank), lost_space(arm, witness, rank)
    lost = lost_wrenches(arm, witness, space)
    return Family(
        {arm.names[i]: position for i, position in zip(group.held, group.positions, strict=True)},
        tuple(arm.names[i] for i in group.support),
        group.codimension,
        _kinds(told),
        _name(shape, group, witness, lost, motions),
        shape.causes(witness, lost, motions),
        "strict" if group.exact else "model",
        bool(np.any(inside)),
        complete,
        len(group.members),
        witness,
        values[order[0]],
    )


def _kinds(told: Sequence[str]) -> str:
    """Return the kind of most members, then others that are no exception, or that the first, the witness, has."""
    first, *others = Counter(told).most_common()
    return " or ".join([first[0], *(name for name, count in others if count > 1 or name == told[0])])


def _name(shape: Geometry, group: Group, witness: Array, lost: Sequence[LostWrench], motions: Array) -> str | None:
    """Return the customary name: by one or two joints whose positions make it, else by its geometry."""
    held = group.held if not group.implicit and len(group.held) < 3 else ()
    return shape.name(held, witness, lost, motions)


def _members(arm: Mechanism, group: Group, generator: np.random.Generator) -> Array:
    """Return members of a group, as many as there are or can be made, angles turned into their limits."""
    if group.implicit:
        return arm.into_limits(group.members)
    q = arm.draw(generator, (_CANDIDATES,), limited=True)
    q[:, list(group.held)] = group.positions
    if not group.exact:  # to the singular configurations that the rounded file has instead
        near, smallest = converge(arm, q)
        close = (smallest < STRICT) & (np.max(np.abs(near - q)[:, list(group.held)], axis=-1) < 1e-2)
        q = near[close] if np.any(close) else q
    return arm.into_limits(q)


def _rank(arm: Mechanism, q: Array) -> int:
    return min(int(np.sum(np.linalg.svd(arm.jacobian(q), compute_uv=False) > MODEL)), arm.generic_rank - 1)


def _kind(arm: Mechanism, q: Array) -> str:
    rank = _rank(arm, q)
    return kind(arm, q, lost_space(arm, q, rank), motion_space(arm, q, rank))
