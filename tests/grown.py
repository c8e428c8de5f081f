"""Robots grown from a few words: the tree and the lengths count, nothing else.

A line is `LINK: JOINT JOINT ...`, a way down from a link that is there already; the root is `base`. A joint `knee`
moves a link of the same name. Marks behind the name: `~` continuous, `|` prismatic, `#` planar, `^` floating, `=`
fixed, `*LEADER` follows it, `@0.3` is so far from the joint before (0.1 m if not said).
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import kinetostat as ks
from trees import load_text

__all__ = ["grown", "grown_text"]

_WORD = re.compile(r"(?P<name>[\w.]+?)(?P<kind>[~|#^=]?)(?:\*(?P<leader>[\w.]+))?(?:@(?P<far>[\d.]+))?$")
_KINDS = {"": "revolute", "~": "continuous", "|": "prismatic", "#": "planar", "^": "floating", "=": "fixed"}
_AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0")
_MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def grown(text: str) -> ks.Model:
    """Return the robot that some lines describe."""
    return load_text(grown_text(text))


def grown_text(text: str) -> str:
    """Return the URDF of the robot that some lines describe."""
    return f'<robot name="grown"><link name="base"/>{"".join(_joints(text))}</robot>'


def _joints(text: str) -> Iterator[str]:
    count = 0
    for line in filter(None, map(str.strip, text.splitlines())):
        link, _, way = line.partition(":")
        for word in way.split():
            part = _WORD.match(word)
            assert part, word
            mimic = f'<mimic joint="{part["leader"]}"/>' if part["leader"] else ""
            yield (
                f'<link name="{part["name"]}">{_MASS}</link>'
                f'<joint name="{part["name"]}" type="{_KINDS[part["kind"]]}"><parent link="{link}"/>'
                f'<child link="{part["name"]}"/><origin xyz="{part["far"] or 0.1} 0 0"/>'
                f'<axis xyz="{_AXES[count % 4]}"/><limit lower="-1" upper="2" effort="9" velocity="1"/>{mimic}</joint>'
            )
            link, count = part["name"], count + 1
