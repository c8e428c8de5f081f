"""The figure of a robot's joints as a tree: the root at the left, a row for each chain, limbs in their own colours."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from kinetostat.analysis.profile.anatomy import Limb
from kinetostat.report.figures.sheet import (
    BLUE,
    GREY,
    INK,
    MARGINS,
    PURPLE,
    SKY,
    VERMILION,
    WIDTH,
    Entry,
    house_style,
    named,
    sheet,
    text_width,
)
from kinetostat.report.figures.symbols import GROUND, marker_of
from kinetostat.urdf.description import Joint, JointType, Robot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["tree_figure"]

_SYMBOLS = {
    JointType.REVOLUTE: ("turns", "turns"),
    JointType.CONTINUOUS: ("endless", "turns without end"),
    JointType.PRISMATIC: ("slides", "slides"),
    JointType.SCREW: ("screws", "turns and slides"),
    JointType.PLANAR: ("free", "moves in a plane, or floats"),
    JointType.FLOATING: ("free", "moves in a plane, or floats"),
}
_FOLDED = ("folded", "several joints of no limb")
_COLOURS = (BLUE, VERMILION, PURPLE, SKY)
_DASHES = ("-", (0, (4, 1.4)), (0, (1.2, 1.2)))  # where colours come again
_FEWEST = 4  # joints of no limb that are folded into one node
_MOST = 24  # rows of joints of no limb, however few they are at each place
_STEP, _LEAST_STEP, _CROWDED = 76.0, 17.0, 36.0  # pt, from a joint to the next; names take turns where it is crowded
_NAME, _LINE = 6.5, 7.6  # pt, of a joint's name: size of letters, from line to line
_END = 7.5  # pt, size of letters at the end of a row
_OUT, _ROOM = 34.0, 462.0  # pt, how far left of the panel the root is; from there to the right edge of a sheet
_WIDER = 150.0  # pt, that a sheet is wider than others where long chains want it
_ABOVE = 11.0  # pt, from the line of a row to what is written above it
_ROOT = 44.0  # pt, for the name of the root, which is near the edge
_UNUSED = 0.4  # in, below a panel, where others have the label of an axis
_ENDINGS = ("_joint", "-joint", "_Joint", "Joint")
_WRAPPED = 4  # lines of a joint's name


@dataclass(eq=False)
class _Node:
    """A joint that moves, or several that are folded, with what it moves.

    Attributes:
        joints: one; several where they are folded; none at the root.
        links: the links that are fixed to each other here, in file order.
        below: what they carry.
        depth: joints from the root.
        row: its row, from 0.
        tips: of those that are folded.
    """

    joints: tuple[Joint, ...]
    links: list[str]
    below: list[_Node] = field(default_factory=list)
    depth: int = 0
    row: int = 0
    tips: int = 1

    def all(self) -> Iterator[_Node]:
        """Yield the node and all below it, from above to below in the figure."""
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            stack += reversed(node.below)


@dataclass(frozen=True)
class _Above:
    """What is written above the line of a row that goes on: where it begins, and how far above, in points."""

    text: str
    left: float
    up: float


def tree_figure(robot: Robot, limbs: Sequence[Limb]) -> Figure:
    """Return the joints that move a robot's links as a tree, from the root at the left.

    Links that are fixed to each other are one. A joint's symbol says how it moves; a follower's is hollow. The joints
    of each limb are in a colour, or a dash, of their own, followers between them too; what several limbs share
    is black. Four joints or more beside each other that belong to no limb, as in a hand, are folded into one symbol.
    """
    root = _tree(robot)
    _fold(root, {joint.name for limb in limbs for joint in robot.moving_path(limb.base, limb.frame)})
    _place(root)
    with house_style():
        return _drawn(robot, list(root.all()), limbs)


def _drawn(robot: Robot, nodes: Sequence[_Node], limbs: Sequence[Limb]) -> Figure:
    """Return the figure of the nodes."""
    words = {id(node): 72 * text_width(_end(robot, node, limbs), _END, "bold") + 14 for node in nodes if not node.below}
    wanted = max((_STEP * node.depth + words[id(node)] for node in nodes if not node.below), default=0.0)
    room = min(max(wanted, _ROOM), _ROOM + _WIDER)
    step = _step(nodes, words, room)
    ending = _shared_ending(nodes)
    labels = {id(node): _name(node, step, ending) for node in nodes}
    tops, height, above = _rows(robot, nodes, labels, step, limbs, room)
    over = max((step * node.depth + words[id(node)] - room for node in nodes if not node.below), default=0.0)
    width = WIDTH - MARGINS + (room - _ROOM + max(0.0, over)) / 72
    title = _counted(robot, sum(len(node.joints) for node in nodes))
    figure, (ax,) = sheet([(width, height / 72 - _UNUSED)], title, [], _entries(robot, nodes))
    ax.set(xlim=(0, 72 * width), ylim=(height - 72 * _UNUSED, 0))
    ax.set_axis_off()
    places = {id(node): (step * node.depth - _OUT, tops[node.row]) for node in nodes}
    styles = _styles(robot, limbs)
    for node in nodes:
        _draw_branches(ax, node, places, step, styles)
        _draw_node(ax, robot, node, places[id(node)], styles)
        _write_name(ax, labels[id(node)], places[id(node)], node, step)
    _write_ends(ax, robot, nodes, places, limbs, above)
    return figure


# --- the tree


def _tree(robot: Robot) -> _Node:
    """Return the root; links that are fixed to each other are one node's."""
    root = _Node((), [robot.root])
    stack = [root]
    while stack:
        node = stack.pop()
        for link in node.links:  # grows by those that are fixed to it
            for joint in robot.child_joints[link]:
                if joint.type is JointType.FIXED:
                    node.links.append(joint.child)
                else:
                    node.below.append(_Node((joint,), [joint.child], depth=node.depth + 1))
        stack += node.below
    return root


def _fold(root: _Node, ours: set[str]) -> None:
    """Fold what belongs to no limb, whose joints are `ours`: many joints at a place, or of many rows in all."""
    for node in reversed(list(root.all())):  # what carries others comes after them
        free = [child for child in node.below if not any(one.name in ours for sub in child.all() for one in sub.joints)]
        joints = tuple(one for child in free for sub in child.all() for one in sub.joints)
        rows = sum(child.tips if len(child.joints) > 1 else sum(not s.below for s in child.all()) for child in free)
        if len(joints) >= _FEWEST and (ours or rows > _MOST):
            tips = sum(sub.tips for child in free for sub in child.all() if not sub.below)
            folded = _Node(joints, [], depth=node.depth + 1, tips=tips)
            node.below = [child for child in node.below if child not in free] + [folded]


def _place(root: _Node) -> None:
    """Give each node its row: the first of what it carries goes on in its own."""
    last = 0
    for node in root.all():
        for i, child in enumerate(node.below):
            child.row = -1 if i else node.row
        if node.row < 0:
            last += 1
            node.row = last
            for child in node.below[:1]:
                child.row = last


# --- words


def _counted(robot: Robot, moving: int) -> str:
    followers = len(robot.followers)
    follow = f", {followers} of them followers" if followers else ""
    if not moving:
        return "no joint moves"
    joints = "1 joint that moves" if moving == 1 else f"{moving} joints that move"
    return f"{joints}{follow}; {len(robot.links)} links"


def _shared_ending(nodes: Sequence[_Node]) -> str:
    """Return what says "joint" at the end of all names that are shown; nothing if one does not say so."""
    shown = [node.joints[0].name for node in nodes if len(node.joints) == 1]
    endings = (ending for ending in _ENDINGS if all(len(n) > len(ending) and n.endswith(ending) for n in shown))
    return next(endings, "") if len(shown) > 1 else ""


def _name(node: _Node, step: float, ending: str) -> list[str]:
    """Return a joint's name, or the root link's, in lines that have room below its symbol."""
    names = [joint.name.removesuffix(ending) for joint in node.joints] or node.links[:1]
    text = names[0] if len(names) == 1 else ""
    if not text:
        return []
    room = (2 * step if step < _CROWDED else step) - 5 if node.joints else _ROOT
    lines = list[str]()
    for part in _parts(named(text, 60).replace(r"\$", "$")):
        if lines and text_width(lines[-1] + part, _NAME) * 72 <= room:
            lines[-1] += part
        else:
            lines += _cut(part, room)
    lines = [*lines[: _WRAPPED - 1], "..."] if len(lines) > _WRAPPED else lines
    return [line.replace("$", r"\$") for line in lines]


def _parts(text: str) -> list[str]:
    """Return the text cut behind what separates the words of a name, and before a capital behind a small letter."""
    parts, last = [""], ""
    for letter in text:
        if last in "_-./: " or (last.islower() and letter.isupper()):
            parts.append("")
        parts[-1] += letter
        last = letter
    return [part for part in parts if part]


def _cut(word: str, room: float) -> list[str]:
    """Return a word in lines of a width in points."""
    lines = [""]
    for letter in word:
        if lines[-1] and text_width(lines[-1] + letter, _NAME) * 72 > room:
            lines.append("")
        lines[-1] += letter
    return lines


def _end(robot: Robot, node: _Node, limbs: Sequence[Limb]) -> str:
    """Return what stands at the end of a row."""
    if len(node.joints) > 1:
        tips = f", {node.tips} tips" if node.tips > 1 else ""
        return f"{len(node.joints)} joints{tips}"
    if here := _limbs_at(node, limbs):
        return "; ".join(map(_limb_words, here))
    ends = [link for link in node.links if not robot.child_joints[link]] if node.joints else []
    more = f" and {len(ends) - 1} more" if len(ends) > 1 else ""
    return f"{named(ends[0])}{more}" if ends else ""


def _limb_words(limb: Limb) -> str:
    return named(limb.name) if limb.name == limb.frame else f"{named(limb.name)}: {named(limb.frame)}"


def _limbs_at(node: _Node, limbs: Sequence[Limb]) -> list[Limb]:
    """Return the limbs that end at a node."""
    return [limb for limb in limbs if limb.frame in node.links and node.joints]


# --- layout, in points


def _rows(
    robot: Robot, nodes: Sequence[_Node], labels: dict[int, list[str]], step: float, limbs: Sequence[Limb], room: float
) -> tuple[list[float], float, dict[int, _Above]]:
    """Return the height of each row's middle from above, the height of all, and what is written above the lines."""
    count = max(node.row for node in nodes) + 1
    above, below = [_ABOVE] * count, [12.0] * count
    for node in nodes:
        high = (11 if node.joints else 16) + _LINE * len(labels[id(node)])  # the ground is higher than a joint
        sides = below if _below(node, step) else above
        sides[node.row] = max(sides[node.row], high)
    written, last, highest = dict[int, _Above](), [-_OUT] * count, list(above)
    for node in nodes:
        if node.below and _limbs_at(node, limbs):
            text = _end(robot, node, limbs)
            width = 72 * text_width(text, _END, "bold")
            left = min(step * node.depth - _OUT + 4, max(room, step * node.depth) - _OUT - width - 4)
            up = above[node.row] if left >= last[node.row] else highest[node.row]
            written[id(node)] = _Above(text, left, up)
            last[node.row], highest[node.row] = left + width + 4, up + _END + 2
    middles, y = list[float](), 0.0
    for up, down in zip(highest, below, strict=True):
        middles.append(y + up + 2)
        y += up + 2 + down
    return middles, y, written


def _step(nodes: Sequence[_Node], words: dict[int, float], room: float) -> float:
    """Return the distance from joint to joint that leaves room for the words at the ends, whose widths are given."""
    steps = [(room - words[id(node)]) / node.depth for node in nodes if not node.below and node.depth]
    return max(_LEAST_STEP, min([_STEP, *steps]))


def _below(node: _Node, step: float) -> bool:
    """Tell whether a name stands below its symbol: names of neighbours take turns where it is crowded."""
    return step >= _CROWDED or node.depth % 2 == 0


# --- drawing


def _styles(robot: Robot, limbs: Sequence[Limb]) -> dict[str, tuple[str, Any]]:
    """Return colour and dash of each joint's branch by its name; of those that are in no limb, none."""
    found = dict[str, tuple[str, Any]]()
    for i, limb in enumerate(limbs):
        style = (_COLOURS[i % len(_COLOURS)], _DASHES[i // len(_COLOURS) % len(_DASHES)])
        for joint in robot.moving_path(limb.base, limb.frame):
            found[joint.name] = (INK, "-") if joint.name in found else style
    return found


def _style(node: _Node, styles: dict[str, tuple[str, Any]]) -> tuple[str, Any]:
    return styles.get(node.joints[0].name, (GREY, "-")) if node.joints else (INK, "-")


def _draw_branches(
    ax: Any, node: _Node, places: dict[int, tuple[float, float]], step: float, styles: dict[str, tuple[str, Any]]
) -> None:
    """Draw the lines from a node to what it carries, the later ones below the first."""
    x, y = places[id(node)]
    for child in reversed(node.below):
        right, low = places[id(child)]
        bend = x + 0.5 * step
        line = [(x, y), (right, low)] if low == y else [(x, y), (bend, y), (bend, low), (right, low)]
        colour, dash = _style(child, styles)
        width = 1.2 if colour == GREY else 2.2
        ax.plot(*zip(*line, strict=True), color=colour, linestyle=dash, linewidth=width, clip_on=False, zorder=2)


def _draw_node(
    ax: Any, robot: Robot, node: _Node, place: tuple[float, float], styles: dict[str, tuple[str, Any]]
) -> None:
    """Draw the symbol."""
    colour = _style(node, styles)[0]
    fill = "white" if _hollow(robot, node) else colour
    symbol = GROUND if not node.joints else _symbol(node)[0]
    look: dict[str, Any] = {"markerfacecolor": fill, "markeredgecolor": colour, "markeredgewidth": 1.2}
    if symbol == GROUND:
        look = {"markerfacecolor": "none", "markeredgecolor": "#555555", "markeredgewidth": 0.9}
    ax.plot([place[0]], [place[1]], **marker_of(symbol, 0.9), **look, clip_on=False, zorder=3)


def _symbol(node: _Node) -> tuple[str, str]:
    return _SYMBOLS[node.joints[0].type] if len(node.joints) == 1 else _FOLDED


def _hollow(robot: Robot, node: _Node) -> bool:
    return len(node.joints) == 1 and node.joints[0].name in robot.followers


def _write_name(ax: Any, lines: Sequence[str], place: tuple[float, float], node: _Node, step: float) -> None:
    """Write a joint's name below its symbol, or above it."""
    text: dict[str, Any] = {"ha": "center", "va": "baseline", "fontsize": _NAME, "color": "#444444", "zorder": 4}
    if step < _CROWDED:  # lines pass behind it
        text["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
    below = 14 if node.joints else 19
    first = place[1] + below if _below(node, step) else place[1] - 9 - _LINE * (len(lines) - 1)
    for i, line in enumerate(lines):
        ax.text(place[0], first + _LINE * i, line, **text)


def _write_ends(
    ax: Any,
    robot: Robot,
    nodes: Sequence[_Node],
    places: dict[int, tuple[float, float]],
    limbs: Sequence[Limb],
    above: dict[int, _Above],
) -> None:
    """Write where limbs and chains end: behind the last joint of a row, above the line of one that goes on."""
    bold: dict[str, Any] = {"fontsize": _END, "color": INK, "weight": "bold", "zorder": 4}
    plain = bold | {"color": "#444444", "weight": "normal"}
    for node in nodes:
        x, y = places[id(node)]
        if not node.below:
            look = bold if _limbs_at(node, limbs) else plain
            ax.text(x + 11, y, _end(robot, node, limbs), va="center_baseline", **look)
        elif one := above.get(id(node)):
            ax.text(one.left, y - one.up, one.text, va="baseline", **bold)


def _entries(robot: Robot, nodes: Sequence[_Node]) -> list[list[Entry]]:
    """Return the legend: the symbols that are shown, in two columns; none where all joints turn."""
    from matplotlib.lines import Line2D

    shown = Counter(_symbol(node) for node in nodes if node.joints and not _hollow(robot, node))
    look: dict[str, Any] = {"markerfacecolor": GREY, "markeredgecolor": GREY}
    entries: list[Entry] = [(Line2D([], [], **marker_of(symbol, 0.8), **look), words) for symbol, words in shown]
    hollow = list(dict.fromkeys(_symbol(node) for node in nodes if _hollow(robot, node)))
    if hollow:
        look = {"markerfacecolor": "white", "markeredgecolor": GREY}
        entries.append((Line2D([], [], **marker_of(hollow[0][0], 0.8), **look), "hollow: follows another joint"))
    if [words for _, words in entries] == [_SYMBOLS[JointType.REVOLUTE][1]]:  # as everybody expects
        return [[]]
    half = -(-len(entries) // 2)
    return [entries[:half], entries[half:]] if len(entries) > 1 else [entries]
