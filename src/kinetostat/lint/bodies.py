"""The inertials of a robot file as far as they can be read, and the bodies that fixed joints make of its links."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar, cast

import numpy as np

from kinetostat.errors import quote
from kinetostat.lint.subject import Subject, end_of, first, name_of, number, once, vector
from kinetostat.lint.tensors import MOMENTS, NO_MASS, Flaw, flaw_of, matrix, rounding_of
from kinetostat.screw import so3
from kinetostat.urdf.document import Element

__all__ = ["LARGEST", "Bodies", "Body", "LinkInertia", "bodies_of", "mass_of"]

LARGEST = 1e30  # beyond it a number is no mass and no moment, and its square may overflow
_T = TypeVar("_T")


@dataclass(frozen=True)
class LinkInertia:
    """The mass and the tensor of a link, all of whose numbers parse.

    Attributes:
        link, element: the `<link>` and its `<inertia>`.
        mass: kg; any sign.
        centre: of mass, in the link's frame, m.
        rpy: of the tensor's axes in the link's frame.
        entries: ixx, ixy, ixz, iyy, iyz, izz as written, kg m2.
        principal: the principal moments, ascending.
        flaw: what is wrong with the tensor in itself; None if nothing is, or if there is no mass.
    """

    link: Element
    element: Element
    mass: float
    centre: tuple[float, ...]
    rpy: tuple[float, ...]
    entries: tuple[float, ...]
    principal: tuple[float, ...]
    flaw: Flaw | None

    @property
    def name(self) -> str:
        """The link's."""
        return name_of(self.link)

    @property
    def gyration(self) -> float:
        """The largest radius of gyration, m; 0 without mass."""
        return math.sqrt(max(self.principal[2], 0.0) / self.mass) if self.mass > NO_MASS else 0.0

    @property
    def isotropic(self) -> bool:
        """Whether the tensor is a multiple of the identity, to the last digit."""
        ixx, ixy, ixz, iyy, iyz, izz = self.entries
        return ixx == iyy == izz and ixy == ixz == iyz == 0 and ixx > 0

    def in_link_frame(self) -> np.ndarray:
        """Return the tensor about the centre of mass, along the axes of the link's frame."""
        if not any(self.rpy):
            return matrix(self.entries)
        rotation = so3.from_rpy(np.array(self.rpy))
        return cast("np.ndarray", rotation @ matrix(self.entries) @ rotation.T)


@dataclass(frozen=True)
class Body:
    """Links that fixed joints make one body.

    Attributes:
        links: their names, from the one nearest to the root.
        carrier: the joint that moves the body; None for the root's.
        parent: the first link of the body that it is moved against; empty for the root's.
        mass: of all links whose mass parses, kg.
    """

    links: tuple[str, ...]
    carrier: Element | None
    parent: str
    mass: float

    @property
    def moved_by(self) -> str:
        """The joint that moves it, in words."""
        assert self.carrier is not None
        return f"moved by joint {quote(name_of(self.carrier), 40)}"


@dataclass(frozen=True)
class Bodies:
    """All that the rules on inertia share.

    Attributes:
        inertias: by link, in file order; only those whose numbers all parse.
        bodies: by their first link, in file order.
        head: the first link of the body that a link belongs to.
        reach: the longest way from the root along joint origins, m.
    """

    inertias: Mapping[str, LinkInertia]
    bodies: Mapping[str, Body]
    head: Mapping[str, str]
    reach: float

    @property
    def moving(self) -> list[Body]:
        """The bodies that a joint moves."""
        return [body for body in self.bodies.values() if body.carrier is not None]

    @property
    def mass(self) -> float:
        """The mass of the robot, kg."""
        return sum(body.mass for body in self.bodies.values())

    def of(self, link: str) -> Body:
        """Return the body that a link belongs to."""
        return self.bodies[self.head[link]]

    def negligible(self, inertia: LinkInertia) -> bool:
        """Return whether a link is fixed to others that weigh a hundred times as much."""
        return inertia.mass < 0.01 * self.of(inertia.name).mass


@once
def bodies_of(subject: Subject) -> Bodies:
    """Return the inertials and bodies of a robot file; they are found once for each subject."""
    return _bodies(subject)


# --- reading ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Written:
    link: Element
    element: Element
    mass: float
    centre: tuple[float, ...]
    rpy: tuple[float, ...]
    entries: tuple[float, ...]


def _bodies(subject: Subject) -> Bodies:
    carriers = {end_of(joint, "child"): joint for joint in reversed(subject.joints)}
    head = _heads(subject, carriers)
    members: dict[str, list[str]] = {}
    for name, top in head.items():
        members.setdefault(top, []).append(name)
    bodies = {}
    for top, links in members.items():
        carrier = carriers.get(top)
        parent = head.get(end_of(carrier, "parent"), "") if carrier is not None else ""
        ordered = (top, *(link for link in links if link != top))
        masses = (mass_of(subject.link_elements[link]) for link in links)
        total = sum(mass for mass in masses if mass is not None and 0 < mass < LARGEST)
        bodies[top] = Body(ordered, carrier if parent and parent != top else None, parent, total)
    return Bodies(_inertias(subject), bodies, head, _reach(subject, carriers))


def mass_of(link: Element) -> float | None:
    """Return the mass that a link states; None if it states none that parses."""
    return number(first(link, "inertial", "mass"), "value")


def _heads(subject: Subject, carriers: Mapping[str, Element]) -> dict[str, str]:
    """Return for each link the first of those that fixed joints make one body with it; cycles end anywhere."""

    def above(link: str) -> str | None:
        joint = carriers.get(link)
        fixed = joint is not None and joint.attributes.get("type") == "fixed"
        parent = end_of(joint, "parent") if joint is not None and fixed else ""
        return parent if parent in subject.link_elements else None

    return _folded(_names(subject), above, lambda link: link, lambda top, _: top)


def _reach(subject: Subject, carriers: Mapping[str, Element]) -> float:
    """Return the longest way from a root along joint origins."""

    def above(link: str) -> str | None:
        joint = carriers.get(link)
        parent = end_of(joint, "parent") if joint is not None else ""
        return parent if parent in subject.link_elements else None

    def longer(way: float, link: str) -> float:
        xyz = vector(first(carriers[link], "origin"), "xyz", 3)
        return way + (math.hypot(*xyz) if xyz is not None else 0.0)

    return max(_folded(_names(subject), above, lambda _: 0.0, longer).values(), default=0.0)


def _names(subject: Subject) -> dict[str, None]:
    """Return the names of the links, in file order."""
    return dict.fromkeys(name_of(link) for link in subject.links if name_of(link))


def _folded(
    links: Iterable[str],
    above: Callable[[str], str | None],
    start: Callable[[str], _T],
    step: Callable[[_T, str], _T],
) -> dict[str, _T]:
    """Return a value for each link from that of the link above it; each link is looked at once, cycles are cut."""
    values: dict[str, _T] = {}
    for link in links:
        way, here, on_way = list[str](), link, set[str]()
        while here not in values:
            way.append(here)
            on_way.add(here)
            upper = above(here)
            if upper is None or upper in on_way:
                values[way.pop()] = start(here)
                break
            here = upper
        for each in reversed(way):
            values[each] = step(values[above(each) or each], each)
    return {link: values[link] for link in links}


def _inertias(subject: Subject) -> dict[str, LinkInertia]:
    written = [found for name in _names(subject) if (found := _written(subject.link_elements[name])) is not None]
    if not written:
        return {}
    moments = np.linalg.eigvalsh(matrix([each.entries for each in written])).tolist()
    inertias = dict[str, LinkInertia]()
    for each, principal in zip(written, moments, strict=True):
        rounding = rounding_of([each.element.attributes[key] for key in MOMENTS])
        flaw = flaw_of(each.mass, each.entries, principal, rounding)
        inertias[name_of(each.link)] = LinkInertia(
            each.link, each.element, each.mass, each.centre, each.rpy, each.entries, tuple(principal), flaw
        )
    return inertias


def _written(link: Element) -> _Written | None:
    """Return the inertial of a link, if all that is in it can be read."""
    inertial = first(link, "inertial")
    element, mass = first(inertial, "inertia"), mass_of(link)
    if element is None or mass is None:
        return None
    entries = tuple(value for key in MOMENTS if (value := number(element, key)) is not None)
    origin = first(inertial, "origin")
    centre, rpy = (_placed(origin, key) for key in ("xyz", "rpy"))
    if len(entries) < len(MOMENTS) or centre is None or rpy is None or max(map(abs, (mass, *entries))) > LARGEST:
        return None
    return _Written(link, element, mass, centre, rpy, entries)


def _placed(origin: Element | None, key: str) -> tuple[float, ...] | None:
    """Return xyz or rpy of an origin, zero by default; None if it does not parse, or is a quaternion."""
    if origin is None or (key not in origin.attributes and "quat_xyzw" not in origin.attributes):
        return (0.0, 0.0, 0.0)
    if key == "xyz" and key not in origin.attributes:
        return (0.0, 0.0, 0.0)
    return vector(origin, key, 3)
