"""Random robots as URDF text: every joint type, odd names, odd axes, chains of mimics, any order in the file.

One writer serves both the plain generator (`random_urdf(seed)`) and hypothesis (`urdf_texts()`): it draws from a
`random.Random`, which hypothesis can replace by one that it steers and shrinks.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from random import Random
from xml.sax.saxutils import quoteattr

from hypothesis import strategies as st

import kinetostat as ks

__all__ = ["ALL_KINDS", "load_text", "random_tree", "random_urdf", "urdf_texts"]

ALL_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "screw")
_ONE_COORDINATE = ("revolute", "continuous", "prismatic", "screw")

# Stems of names: blanks (inside, leading, trailing), accents, other scripts, quotes, XML's own characters, line breaks,
# slashes, what looks like an escape, an entity or a number. A number is appended where a name must be new.
_STEMS = (
    "link",
    "Link",
    "upper arm",
    " leading",
    "trailing ",
    "\u00e9paule",
    "\u5173\u8282",
    '"quoted"',
    "it's",
    "both \"and' ",
    "<angle>",
    "a&b",
    "&amp;",
    "&#65;",
    "]]>",
    "<!--",
    "line\nbreak",
    "tab\tstop",
    "a/b",
    "a.x",
    "%20",
    "1e3",
    "-",
)

_HALF_TURNS = (0.0, math.pi / 2, -math.pi / 2, math.pi, -math.pi, 1.5708, -1.5708, 2 * math.pi)
# Unit, long, short, negative, nearly aligned (far enough for Pinocchio not to snap them to the axis), and skew.
_AXES = (
    "1 0 0",
    "0 1 0",
    "0 0 1",
    "-1 0 0",
    "0 -1 0",
    "0 0 -1",
    "2 0 0",
    "0 0 -5e-3",
    "0.577 0.577 0.577",
    "1e-3 0 1",
    "0 1 -1e-6",
    "1 1e-9 0",
    "1 -2 3",
    "100 0 1",
)
_NORMALS = ("0 0 1", "0 0 -1", "0 0 2.5", "1 0 0", "0 -1 0", "1 -2 3", "1e-3 0 1", "0.3 0.4 -1", "0 1e-9 1")


@dataclass(slots=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    body: list[str]


def random_urdf(seed: int, *, kinds: tuple[str, ...] = ALL_KINDS, most: int = 12) -> str:
    """Return the URDF text of a random tree, the same for the same seed."""
    return _write(Random(seed), kinds, most)


def random_tree(
    seed: int, *, floating_base: bool = False, kinds: tuple[str, ...] = ALL_KINDS, most: int = 12
) -> ks.Model:
    """Return a random tree, loaded."""
    return load_text(random_urdf(seed, kinds=kinds, most=most), floating_base=floating_base)


def urdf_texts(kinds: tuple[str, ...] = ALL_KINDS, most: int = 12) -> st.SearchStrategy[str]:
    """Return a strategy of URDF texts of random trees, which shrink."""
    return st.randoms(use_true_random=False).map(lambda random: _write(random, kinds, most))


def load_text(text: str, *, floating_base: bool = False) -> ks.Model:
    """Return the robot of a URDF text."""
    return ks.load("-", floating_base=floating_base, stdin=io.BytesIO(text.encode()))


# --- writing ---------------------------------------------------------------------------------------------------------


def _write(random: Random, kinds: tuple[str, ...], most: int) -> str:
    count = random.randint(1, most)
    links = _names(random, count + 1, ())
    joints = _names(random, count, links)
    # Long branches: the last link is the likeliest parent of the next.
    parents = [i if random.random() < 0.6 else random.randint(0, i) for i in range(count)]
    made = [_joint(random, kinds, joints[i], links[parents[i]], links[i + 1]) for i in range(count)]
    _add_mimics(random, made)
    elements = [_link(random, name) for name in links] + [_joint_text(joint) for joint in made]
    random.shuffle(elements)  # links after joints, joints in any order, children before parents
    return "\n".join(['<robot name="random" version="1.1">', *elements, "</robot>"])


def _names(random: Random, count: int, others: list[str] | tuple[()]) -> list[str]:
    """Return unique names; some are those of the other kind, because a joint may be called as a link is."""
    names: dict[str, None] = {}
    while len(names) < count:
        name = (
            f"{random.choice(_STEMS)}{len(names)}" if random.random() < 0.8 else f"{len(names)}{random.choice(_STEMS)}"
        )
        if others and random.random() < 0.25:
            name = random.choice(others)
        names[name if name not in names else f"{name} {len(names)}"] = None
    return list(names)


def _joint(random: Random, kinds: tuple[str, ...], name: str, parent: str, child: str) -> _Joint:
    kind = random.choice(kinds)
    body = [_origin(random)] if random.random() < 0.9 else []
    if kind == "planar":
        body.append(f'<axis xyz="{random.choice(_NORMALS)}"/>')
    elif kind not in ("fixed", "floating") and random.random() < 0.95:
        body.append(f'<axis xyz="{_axis(random)}"/>')
    if kind == "screw":
        body.append(f'<drake:screw_thread_pitch value="{random.choice((0.0, 0.02, -0.5, random.uniform(-1, 1)))!r}"/>')
    if random.random() < {"revolute": 0.9, "prismatic": 0.9, "screw": 0.3}.get(kind, 0.0):
        body.append(
            f'<limit lower="{random.uniform(-2, 0)!r}" upper="{random.uniform(0, 2)!r}" effort="1" velocity="1"/>'
        )
    return _Joint(name, kind, parent, child, body)


def _axis(random: Random) -> str:
    if random.random() < 0.7:
        return random.choice(_AXES)
    return f"{random.uniform(0.1, 1)!r} {random.uniform(-1, 1)!r} {random.uniform(-1, 1)!r}"


def _origin(random: Random) -> str:
    lengths = [0.0, 0.0, 0.0] if random.random() < 0.2 else [random.uniform(-1, 1) for _ in range(3)]
    xyz = " ".join(repr(x) for x in lengths)
    how = random.random()
    if how < 0.2:
        quaternion = [1.0 + random.random()] + [random.uniform(-1, 1) for _ in range(3)]
        length = math.hypot(*quaternion)
        return f'<origin xyz="{xyz}" quat_xyzw="{" ".join(repr(c / length) for c in quaternion)}"/>'
    if how < 0.3:
        return f'<origin xyz="{xyz}"/>'
    angles = [random.choice(_HALF_TURNS) if random.random() < 0.5 else random.uniform(-3.2, 3.2) for _ in range(3)]
    return f'<origin rpy="{" ".join(repr(x) for x in angles)}" xyz="{xyz}"/>'


def _add_mimics(random: Random, joints: list[_Joint]) -> None:
    """Make some joints follow others. In a random order each may follow one before it: chains, but no circles."""
    able = [joint for joint in joints if joint.kind in _ONE_COORDINATE]
    random.shuffle(able)
    for i, joint in enumerate(able[1:], 1):
        if random.random() < 0.4:
            leader = quoteattr(able[random.randint(0, i - 1)].name)
            multiplier = random.choice((None, 1.0, -1.0, 0.0, -0.5, 2.0))
            offset = random.choice((None, 0.0, random.uniform(-1, 1)))
            law = "".join(f' {k}="{v!r}"' for k, v in (("multiplier", multiplier), ("offset", offset)) if v is not None)
            joint.body.append(f"<mimic{law} joint={leader}/>")


def _link(random: Random, name: str) -> str:
    how = random.random()
    if how < 0.4:
        return f"<link name={quoteattr(name)}/>"
    mass = f'<mass value="{random.choice((0.0, random.uniform(0, 5)))!r}"/>'
    inertia = '<inertia ixx="0.1" ixy="0.01" ixz="0" iyy="0.1" iyz="-0.02" izz="0.1"/>'
    if how < 0.5:  # not whole: such an inertial counts for nothing
        mass, inertia = random.choice((("", inertia), (mass, ""), (mass, '<inertia ixx="1"/>')))
    return f"<link name={quoteattr(name)}><inertial>{_origin(random)}{mass}{inertia}</inertial></link>"


def _joint_text(joint: _Joint) -> str:
    tag = "drake:joint" if joint.kind == "screw" else "joint"
    ends = f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>"
    return f'<{tag} type="{joint.kind}" name={quoteattr(joint.name)}>{ends}{"".join(joint.body)}</{tag}>'
