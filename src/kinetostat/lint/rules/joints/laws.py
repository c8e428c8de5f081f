"""Who follows whom, and by which law, as far as the file says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kinetostat.lint.rules.joints.common import moves
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.urdf.document import Element

__all__ = ["Law", "factors", "followers", "laws", "leader_of"]


@dataclass(frozen=True)
class Law:
    """What a joint's position is: multiplier x (position of the joint `leader`, which follows none) + offset."""

    leader: str
    multiplier: float = 1.0
    offset: float = 0.0


def followers(subject: Subject) -> Iterator[tuple[Element, Element]]:
    """Yield each joint that can follow another and does, with its `<mimic>`."""
    for joint in filter(moves, subject.joints):
        mimic = first(joint, "mimic")
        if mimic is not None:
            yield joint, mimic


def leader_of(subject: Subject, joint: Element) -> Element | None:
    """Return the joint that a joint follows; None if it follows none, or one that does not exist."""
    mimic = first(joint, "mimic")
    return subject.joint_elements.get(mimic.attributes.get("joint", "")) if mimic is not None else None


def factors(mimic: Element) -> tuple[float, float] | None:
    """Return multiplier and offset of a mimic; None if one of them does not parse."""
    multiplier = number(mimic, "multiplier") if "multiplier" in mimic.attributes else 1.0
    offset = number(mimic, "offset") if "offset" in mimic.attributes else 0.0
    return None if multiplier is None or offset is None else (multiplier, offset)


def laws(subject: Subject) -> Mapping[str, Law | None]:
    """Return the law of each joint that moves; None in a circle, or where a leader is missing or has no position."""
    found = dict[str, Law | None]()
    for joint in filter(moves, subject.joints):
        trail, name = list[tuple[str, Element]](), name_of(joint)
        while name not in found:
            element = subject.joint_elements.get(name)
            mimic = first(element, "mimic")
            if element is None or not moves(element) or mimic is None:
                found[name] = Law(name) if element is not None and moves(element) else None
            else:
                found[name] = None  # until its leader's is known: in a circle it never is
                trail.append((name, mimic))
                name = mimic.attributes.get("joint", "")
        above = found[name]
        for follower, mimic in reversed(trail):
            above = found[follower] = _composed(above, mimic)
    return found


def _composed(above: Law | None, mimic: Element) -> Law | None:
    """Return the law of a joint whose leader has the law `above`."""
    own = factors(mimic)
    if above is None or own is None:
        return None
    multiplier, offset = own
    return Law(above.leader, multiplier * above.multiplier, multiplier * above.offset + offset)
