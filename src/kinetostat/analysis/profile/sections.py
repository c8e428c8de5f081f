"""Sections of a limb's workspace: two joints move, all others are held; with the curves where it is singular."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.coordinates import coordinates
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.analysis.kernels import chain_kernel
from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.analysis.profile.cells import covered_around
from kinetostat.analysis.profile.section import Section
from kinetostat.analysis.profile.section_curves import runs, singular_curves
from kinetostat.analysis.profile.section_views import View, views_of_limb
from kinetostat.analysis.profile.two_joints import TwoJoints, ends_of, grid_of
from kinetostat.analysis.singular.find import SingularFamilies
from kinetostat.analysis.singular.mechanism import mechanism
from kinetostat.analysis.singular.slices import Curve, positions_in_words
from kinetostat.analysis.skeleton import skeleton
from kinetostat.analysis.sweeping.certifying import RowWitness, row_witness
from kinetostat.analysis.task import Task
from kinetostat.conventions import Array, Velocity
from kinetostat.engines.model import Model

__all__ = ["sections"]

_POINTS = 181
_COMPARED = 61  # places of a section that Pinocchio computes again
_NOTHING = 1e-12  # singular value that is rounding


def sections(
    model: Model,
    limb: Limb,
    q: Array,
    name: str,
    *,
    task: Task,
    length: float | None,
    families: SingularFamilies | None,
) -> tuple[Section, ...]:
    """Return where two joints of a limb bring its tool, how well it moves there, and where it is singular.

    The two joints run through their ranges (whole turns where nothing limits them, see `Coordinates.limits`), all
    others are held. From the side is the upright plane in which the arm mainly moves; from above, up being the root's
    z. The smallest singular value is s_r, r the rank at almost every configuration, of the rows of `task`, made
    comparable by `length` as in a sweep. Singular curves are zeros of the determinant, traced to rounding, where as
    many rows count as joints move them; else, families of which one of the two joints decides. No curve is given that
    is not singular.

    Args:
        model: the robot.
        limb: the limb.
        q: the configuration of the robot in which all other joints are held, (nq,).
        name: what that is called.
        task: the rows that count.
        length: the characteristic length in m; None for none.
        families: the singular families of the limb, if they are known.

    Returns:
        At most one from the side and one from above, the one in whose plane the arm mainly moves first. One alone of an
        arm that moves in a plane, and of one that moves equally well all over the section from above; none where no two
        joints move the tool over an area.

    Raises:
        UsageError: the limb has no joint, or a floating one; its joints never move the tool along the rows.
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    rest = checked(model.robot, q)
    joints = coordinates(model, limb.frame, limb.base)
    ends = ends_of(joints)
    up = model.engine.placement(rest, model.robot.root, limb.base)[:3, 2]
    views = views_of_limb(joints, rest, up, ends)
    if not views:
        return ()
    kernel = chain_kernel(joints, ("placement", "jacobian", "singular_values"), rest, task=task, length=length)
    kernel = replace(kernel, rank=_rank(model, limb, task, families))
    arm, held = skeleton(model, limb.frame, rest, limb.base).points, rest[list(joints.indices)]
    velocity = Velocity(limb.frame, relative_to=limb.base, expressed_in=limb.base)
    witness = row_witness(joints, kernel, rest, velocity, np.array(ends))
    both = [(view, TwoJoints(joints, kernel, view.pair, held, ends)) for view in views]
    found = [_section(view, two, name, arm, families, witness) for view, two in both]
    return tuple(one for one in found if one.view == "side" or len(found) == 1 or not one.same_everywhere)


def _rank(model: Model, limb: Limb, task: Task, families: SingularFamilies | None) -> int:
    """Return the rank of the rows that count at almost every configuration."""
    if families is not None and families.mechanism.task.rows == task.rows:
        return families.mechanism.generic_rank
    return mechanism(model, limb.frame, relative_to=limb.base, axes=task.row_names).generic_rank


def _section(
    view: View, two: TwoJoints, name: str, arm: Array, families: SingularFamilies | None, witness: RowWitness
) -> Section:
    x, y = (np.linspace(two.ends[0][index], two.ends[1][index], _POINTS) for index in two.pair)
    grid = grid_of(x, y)
    found = two.computed(grid)
    points, smallest = found["placement"][..., :3, 3] @ view.directions.T, found["singular_values"][..., -1]
    inside, unlimited = singular_curves(two, view.directions, families)
    return Section(
        view.view,
        view.directions,
        two.names,
        two.held,
        name,
        points,
        np.where(smallest < _NOTHING, 0.0, smallest),
        (*inside, *_limit_curves(two, points)),
        tuple(unlimited),
        arm @ view.directions.T,
        _certificate(witness, two, grid, found),
    )


def _certificate(witness: RowWitness, two: TwoJoints, grid: Array, found: dict[str, Array]) -> Certificate:
    """Return what Pinocchio says of places all over a grid, and of the least and the most dexterous of all.

    Args:
        witness: who computes them again.
        two: the joints that move.
        grid: their coordinates, (b, a, 2).
        found: what the kernel has found there, each (b, a, ...).
    """
    smallest = found["singular_values"][..., -1].ravel()
    spread = np.linspace(0, smallest.size - 1, _COMPARED).astype(int)
    rows = np.unique([*spread, np.argmin(smallest), np.argmax(smallest)])
    q = two.coordinates(grid.reshape(-1, 2)[rows])
    outputs = {name: part.reshape(-1, *part.shape[2:])[rows] for name, part in found.items()}
    if not two.joints.model.crosscheck:
        return combined([witness.certificate(name, None) for name in outputs])
    proofs = list[Certificate]()
    for name, apart in witness.differences(q, outputs).items():
        worst = float(np.max(apart))
        values = () if worst <= witness.tolerances[name] else (witness.again(q)[name], outputs[name])
        proofs.append(witness.certificate(name, worst, values, len(rows) * witness.row_size(name)))
    return combined(proofs)


def _limit_curves(two: TwoJoints, points: Array) -> list[Curve]:
    """Return the edges of the grid (b, a, 2) where one of the two joints is at a limit that the file states.

    Only as far as they bound what the section covers: elsewhere another posture gets beyond them.
    """
    edges = ((points[:, 0], points[:, -1]), (points[0], points[-1]))
    curves = []
    for joint, index, both in zip(two.names, two.pair, edges, strict=True):
        stated = [ends[index] for ends in two.joints.stated_limits]
        for end, edge in zip(stated, both, strict=True):
            if np.isfinite(end) and not two.whole(index):
                label = positions_in_words(two.joints, {joint: float(end)})
                curves += [Curve(label, edge[run].copy(), "limit") for run in runs(~covered_around(points, edge))]
    return curves
