"""Why an arm is singular: the lines of its joint axes in a special position, and the customary names of that.

Nothing here goes by the numbers of joints. Screws are dependent where their lines are: two that coincide, three in a
plane that meet in a point or are parallel, four that meet in a point, are parallel or lie in a plane; and all of them
where one line meets them all. Those are the positions that an engineer sees; there are others (a regulus, a linear
complex), which are told as dependent motions. (H. Pottmann and J. Wallner, "Computational Line Geometry", 2001; J.-P.
Merlet, "Singular configurations of parallel manipulators and Grassmann geometry", IJRR 8(5), 1989.) Only what is not
so at every configuration is a cause.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinetostat.analysis.singular.dependence import (
    compared_columns,
    dependence_words,
    dependent_sets,
    flats,
    listed,
    of_axes,
)
from kinetostat.analysis.singular.lines import (
    TOUCHING,
    Axis,
    axes_at,
    distance,
    in_one_plane,
    meeting_point,
    parallel,
)
from kinetostat.analysis.singular.losses import LostWrench
from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.conventions import Array

__all__ = ["Cause", "Geometry", "geometry"]


@dataclass(frozen=True)
class Cause:
    """One reason for a singularity: in words, the joints that it is about, and whether it tells of the wrist centre."""

    text: str
    joints: tuple[str, ...]
    at_centre: bool = False


@dataclass(frozen=True)
class Geometry:
    """What holds of the axes at every configuration.

    Attributes:
        mechanism: the chain and its task.
        shoulder: indices of the first joints whose axes always meet in a point, with those before them; or none.
        wrist: indices of the last ones, with those after them.
        centre: indices of those of the wrist whose axes meet.
    """

    mechanism: Mechanism
    shoulder: tuple[int, ...]
    wrist: tuple[int, ...]
    centre: tuple[int, ...]

    def region(self, indices: Sequence[int]) -> str | None:
        """Return the customary name of what the given joints bend: shoulder, elbow, wrist, or several."""
        words = set[str]()
        for i in indices:
            if i in self.wrist:
                words.add("wrist")
            elif i in self.shoulder:
                words.add("shoulder")
            elif self.mechanism.turning[i]:
                words.add("elbow")
        return " and ".join(sorted(words, key=("shoulder", "elbow", "wrist").index)) or None

    @cached_property
    def _always_dependent(self) -> frozenset[tuple[int, ...]]:
        samples = self.mechanism.draw(np.random.default_rng(1), (4,))
        found = [set(dependent_sets(self.mechanism, q)) for q in samples]
        return frozenset(set.intersection(*found))

    def causes(self, q: Array, lost: Sequence[LostWrench], motions: Array) -> tuple[Cause, ...]:
        """Return why the arm is singular at q: (n,), the lost wrenches, and rates (n, k) that move nothing."""
        mechanism = self.mechanism
        axes = axes_at(mechanism, q)
        if axes is None:
            return ()
        matrix = compared_columns(mechanism, q)
        causes = []
        for chosen in flats(matrix, [c for c in dependent_sets(mechanism, q) if self._special(c)]):
            about = [axes[i] for i in chosen]
            words = dependence_words(mechanism, about, matrix[:, list(chosen)])
            causes.append(Cause(words, tuple(axis.joint for axis in about)))
        redundant = len(mechanism.names) > mechanism.generic_rank  # one dependence more is no loss yet
        involved = [i for i, row in enumerate(motions) if float(np.max(np.abs(row))) > 1e-6]
        for wrench in lost:
            told = self._line(wrench, axes, involved)
            said = told is None or any(set(told.joints) == set(cause.joints) for cause in causes)
            if told is not None and not said and (not causes or told.at_centre or redundant):
                causes.append(told)
        return tuple(causes)

    def _special(self, chosen: tuple[int, ...]) -> bool:
        """Return whether a dependent set is not so at every configuration, in whole or in part."""
        return not any(set(smaller) <= set(chosen) for smaller in self._always_dependent)

    def _line(self, wrench: LostWrench, axes: Sequence[Axis], involved: Sequence[int]) -> Cause | None:
        """Return the cause that is a line meeting every axis: the line of a lost force; or another screw."""
        if wrench.point is None or wrench.pitch != 0:
            what = "a couple" if wrench.point is None else "one screw"
            return Cause(f"{what} is reciprocal to all joints", tuple(axis.joint for axis in axes))
        length = self.mechanism.length
        turns = [axes[i] for i in involved if axes[i].point is not None]
        along = [axis for axis in turns if parallel([axis, Axis("", wrench.axis, None)])]
        meets = [axis for axis in turns if axis not in along and _meets(axis, wrench, length)]
        if not meets and not along:
            return None
        centre, name = self._centre(axes, wrench)
        if centre is not None:
            others = [axis for axis in meets if distance(axis, centre) > TOUCHING * length]
            own = {axes[i].joint for i in self.centre}
            on = [axis for axis in meets if axis not in others and axis.joint not in own]
            told = _at_centre(name, others, along, on, in_one_plane(others, length, centre) if others else False)
            if told is not None:
                return told
        if len(meets) == len(axes):
            return Cause("one line meets the axes of all joints", tuple(axis.joint for axis in axes))
        parts = [f"meets the {of_axes(meets)}"] if meets else []
        parts += [f"is parallel to the {of_axes(along)}"] if along else []
        return Cause(f"one line {' and '.join(parts)}", tuple(axis.joint for axis in (*meets, *along)))

    def _centre(self, axes: Sequence[Axis], wrench: LostWrench) -> tuple[Array | None, str]:
        """Return the wrist centre (the tool point, where orientation does not count) if the line passes through it."""
        mechanism = self.mechanism
        if not mechanism.task.angular:
            return wrench.point, "the tool point"
        if not self.centre:
            return None, ""
        centre = meeting_point([axes[i] for i in self.centre], mechanism.length)
        if centre is None or wrench.point is None:
            return None, ""
        away = float(np.linalg.norm(np.cross(centre - wrench.point, wrench.axis)))
        names = listed([axes[i].joint for i in self.centre])
        return (centre if away < TOUCHING * mechanism.length else None), f"the point where the axes of {names} meet"

    def name(self, held: Sequence[int], q: Array, lost: Sequence[LostWrench], motions: Array) -> str | None:
        """Return the customary name of a singularity: by the joints `held` whose positions make it, if they do.

        Else by the line of the lost force: through the wrist centre, it is the shoulder's where the first turning
        joint takes part in the motion inside, and the elbow's where it does not. Else by what is between two axes that
        coincide.
        """
        if held:
            return self.region(held)
        axes = axes_at(self.mechanism, q)
        if axes is None:
            return None
        first = next((i for i, turns in enumerate(self.mechanism.turning) if turns), None)
        for wrench in lost:
            if wrench.pitch == 0 and wrench.point is not None and self._centre(axes, wrench)[0] is not None:
                takes_part = first is not None and bool(np.any(np.abs(motions[first]) > 1e-6))
                return "shoulder" if takes_part else "elbow"
        return self._bent(q, axes)

    def _bent(self, q: Array, axes: Sequence[Axis]) -> str | None:
        """Return the name of what is between two axes that coincide: the joints that bend one against the other."""
        for chosen in dependent_sets(self.mechanism, q):
            if len(chosen) == 2 and self._special(chosen) and all(axes[i].point is not None for i in chosen):
                return self.region(range(chosen[0] + 1, chosen[1]))
        return None


def geometry(mechanism: Mechanism) -> Geometry:
    """Return what holds of a mechanism's axes at every configuration."""
    samples = [axes_at(mechanism, q) for q in mechanism.draw(np.random.default_rng(2), (3,))]
    if any(axes is None for axes in samples):
        return Geometry(mechanism, (), (), ())
    whole = [axes for axes in samples if axes is not None]
    count = len(mechanism.names)
    backwards = list(range(count))[::-1]
    centre = _meeting_run(whole, backwards, mechanism) if mechanism.task.angular else ()
    wrist = tuple(range(min(centre), count)) if centre else ()
    first = _meeting_run(whole, [i for i in range(count) if i not in wrist], mechanism)
    return Geometry(mechanism, tuple(range(max(first) + 1)) if first else (), wrist, centre)


def _meets(axis: Axis, wrench: LostWrench, length: float) -> bool:
    """Return whether a wrench's line meets an axis."""
    assert axis.point is not None
    assert wrench.point is not None
    return abs(float(np.cross(axis.direction, wrench.axis) @ (axis.point - wrench.point))) < TOUCHING * length


def _at_centre(
    name: str, others: Sequence[Axis], along: Sequence[Axis], on: Sequence[Axis], flat: bool
) -> Cause | None:
    """Return what is special about the wrist centre: a line through it meets or follows all other axes.

    `others` meet the line elsewhere (`flat`: in one plane with the centre), `along` are parallel to it, `on` pass
    through the centre without belonging to it.
    """
    joints = tuple(axis.joint for axis in (*others, *along))
    if not others and on:
        return Cause(f"{name} lies on the {of_axes(on)}", tuple(axis.joint for axis in on), at_centre=True)
    if len(others) == 1 and along:
        plane = f"the plane through the axis of {listed([others[0].joint])}"
        return Cause(f"{name} lies in {plane} that is parallel to the {of_axes(along)}", joints, at_centre=True)
    if len(others) > 1 and not along and flat:
        return Cause(f"{name} lies in the plane of the {of_axes(others)}", joints, at_centre=True)
    return None


def _meeting_run(samples: Sequence[Sequence[Axis]], order: Sequence[int], mechanism: Mechanism) -> tuple[int, ...]:
    """Return the longest run of joints from the start of an order whose axes always meet in one point, two at least.

    The first joint of the order may stand aside, as where a flange or a shoulder is offset.
    """
    run = _run_from_start(samples, order, mechanism)
    return run if len(run) > 1 or len(order) < 3 else _run_from_start(samples, order[1:], mechanism)


def _run_from_start(samples: Sequence[Sequence[Axis]], order: Sequence[int], mechanism: Mechanism) -> tuple[int, ...]:
    taken = list[int]()
    for i in order:
        tried = [*taken, i]
        chosen = [[axes[j] for j in tried] for axes in samples]
        if any(axis.point is None for axis in chosen[0]):
            break
        if len(tried) > 1 and any(meeting_point(each, mechanism.length) is None for each in chosen):
            break
        taken = tried
    return tuple(sorted(taken)) if len(taken) > 1 else ()
