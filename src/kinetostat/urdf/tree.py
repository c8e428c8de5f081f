"""Do the joints make one tree over the links, and does every follower have a leader?"""

from __future__ import annotations

from dataclasses import replace

from kinetostat.errors import LimitError, quote
from kinetostat.urdf.description import Joint, Link
from kinetostat.urdf.document import Element
from kinetostat.urdf.reading import Reading

__all__ = ["root_of", "with_leaders"]

MAX_DEPTH = 400


def root_of(reading: Reading, links: list[Link], joints: list[Joint]) -> str:
    """Return the name of the root link.

    Raises:
        StructureError: two parents, a cycle, no root or several.
        LimitError: a chain of more than 400 links.
    """
    above: dict[str, Joint] = {}
    below: dict[str, list[str]] = {}
    for joint in joints:
        if joint.parent == joint.child:
            message = f"parent and child are the same link {quote(joint.child)}"
            raise reading.error(_at("joint", joint), message, "a joint connects two links")
        if joint.child in above:
            other = above[joint.child]
            message = f"link {quote(joint.child)} already has a parent: joint {quote(other.name)}, line {other.line}"
            raise reading.error(_at("joint", joint), message, "a link has one parent: remove one of the two joints")
        above[joint.child] = joint
        below.setdefault(joint.parent, []).append(joint.child)
    top = reading.document.root
    roots = [link for link in links if link.name not in above]
    if not roots:
        raise reading.error(top, "every link has a parent: the joints form a cycle", "one link must be the root")
    if len(roots) > 1:
        named = ", ".join(quote(link.name) for link in roots[:4]) + (", ..." if len(roots) > 4 else "")
        raise reading.error(top, f"{len(roots)} links have no parent: {named}", "join them, so that one root remains")
    depth = _depths(roots[0].name, below)
    if len(depth) < len(links):
        lost = next(link for link in links if link.name not in depth)
        message = "the link hangs in a cycle of joints, apart from the root"
        raise reading.error(_at("link", lost), message, "break the cycle")
    deepest = max(depth.values())
    if deepest > MAX_DEPTH:
        message = f"a chain is {deepest} links deep; at most {MAX_DEPTH} are read"
        raise reading.error(top, message, "leave out the links that you do not ask for", LimitError)
    return roots[0].name


def _depths(root: str, below: dict[str, list[str]]) -> dict[str, int]:
    """Return how many links deep each link is that hangs on the root."""
    depth = {root: 1}
    stack = [root]
    while stack:
        link = stack.pop()
        for child in below.get(link, ()):
            depth[child] = depth[link] + 1
            stack.append(child)
    return depth


def with_leaders(reading: Reading, joints: list[Joint]) -> list[Joint]:
    """Return the joints; followers of joints that do not exist become independent, with a remark.

    Raises:
        StructureError: followers in a circle, or of a joint without a single position.
    """
    names = {joint.name for joint in joints}
    kept = []
    for joint in joints:
        if joint.mimic is None or joint.mimic.joint in names:
            kept.append(joint)
        else:
            missing = quote(joint.mimic.joint)
            text = f"it mimics {missing}, which does not exist: it counts as independent"
            reading.remark(_at("joint", joint), text)
            kept.append(replace(joint, mimic=None))
    _check_leaders(reading, {joint.name: joint for joint in kept})
    return kept


def _check_leaders(reading: Reading, joints: dict[str, Joint]) -> None:
    settled: set[str] = set()
    for joint in joints.values():
        trail: dict[str, None] = {}
        while joint.mimic is not None and joint.name not in settled:
            trail[joint.name] = None
            leader = joints[joint.mimic.joint]
            if leader.name in trail:
                message = f"its mimics lead back to joint {quote(leader.name)}"
                raise reading.error(_at("joint", joint), message, "a circle has no leader: remove one <mimic>")
            if leader.type.nq != 1:
                message = f"it mimics the {leader.type} joint {quote(leader.name)}, which has no single position"
                raise reading.error(_at("joint", joint), message, "follow a joint with one position")
            joint = leader  # noqa: PLW2901 (walking up the chain of leaders)
        settled.update(trail)


def _at(tag: str, thing: Link | Joint) -> Element:
    """Return an element that stands for a link or joint in errors."""
    return Element(tag, {"name": thing.name}, thing.line)
