"""What the rules of the tree share: which joint hangs which link on which, as far as the file says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from kinetostat.lint.subject import Subject, first, name_of, once
from kinetostat.urdf.document import Element

__all__ = ["Graph", "Loop", "graph_of", "tied"]


@dataclass(frozen=True)
class Loop:
    """Links that hang on each other in a circle, in its order; how many hang on them; the first of all in the file."""

    links: tuple[str, ...]
    hanging: int
    first: str


@dataclass(frozen=True)
class Graph:
    """The links and joints of a file, as far as they fit together.

    Attributes:
        links: the first element of each name, in file order.
        above: for each link the first joint that names it as its child, and the link above; self-joints left out.
        again: the joints that name a link as their child that has a parent already, with the first joint.
        broken: how many joints lack an end, name one that is not there, or name the same link twice.
    """

    links: Mapping[str, Element]
    above: Mapping[str, tuple[Element, str]]
    again: Sequence[tuple[Element, str, Element]]
    broken: int

    @cached_property
    def roots(self) -> tuple[str, ...]:
        """The links without a parent."""
        return tuple(name for name in self.links if name not in self.above)

    @cached_property
    def depth(self) -> Mapping[str, int]:
        """How many links deep each link is that hangs on a root."""
        return {name: depth for name, depth in self._walked[0].items() if depth > 0}

    @cached_property
    def loops(self) -> tuple[Loop, ...]:
        """The circles, in file order."""
        return self._walked[1]

    @cached_property
    def _walked(self) -> tuple[dict[str, int], tuple[Loop, ...]]:
        """Walk up from each link until something known: depths (not positive: which loop it ends in) and loops."""
        depth, circles = dict.fromkeys(self.roots, 1), list[tuple[tuple[str, ...], str]]()
        hanging = list[int]()
        for start in self.links:
            trail, here = dict[str, None](), start
            while here not in depth and here not in trail:
                trail[here] = None
                here = self.above[here][1]
            walked = list(trail)
            if here in trail:  # a new circle; its order is that of the joints, from parent to child
                circle = walked[walked.index(here) :]
                circles.append((tuple(reversed(circle)), start))
                hanging.append(-len(circle))
                depth[here] = 1 - len(circles)
            known = depth[here]
            for steps, link in enumerate(reversed(walked), 1):
                depth[link] = known + steps if known > 0 else known
            if known <= 0:
                hanging[-known] += len(walked)
        loops = tuple(Loop(c, hanging[i], start) for i, (c, start) in enumerate(circles))
        return depth, loops


@once
def graph_of(subject: Subject) -> Graph:
    """Return how the links and joints of a file fit together; found once for each subject."""
    links = {name_of(element): element for element in reversed(subject.links) if name_of(element)}
    links = dict(reversed(links.items()))
    above = dict[str, tuple[Element, str]]()
    again = list[tuple[Element, str, Element]]()
    broken = 0
    for joint in subject.joints:
        parent, child = tied(joint, "parent"), tied(joint, "child")
        if parent not in links or child not in links or parent == child:
            broken += 1
        elif child in above:
            again.append((joint, child, above[child][0]))
        else:
            above[child] = (joint, parent)
    return Graph(links, above, again, broken)


def tied(joint: Element, end: str) -> str | None:
    """Return the link that a joint names as its "parent" or "child"; None where it names none."""
    found = first(joint, end)
    return found.attributes.get("link") if found is not None else None
