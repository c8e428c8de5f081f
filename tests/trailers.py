"""Chains of joints at whose end a wheel is, or what only looks like one."""

from __future__ import annotations

import kinetostat as ks
from trees import load_text

__all__ = ["HIP", "KNEE", "SWIVEL", "WHEEL", "trailer"]

INERTIAL = (
    '<inertial><origin xyz="{} 0 0"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def trailer(*joints: tuple[str, str, str], centre: float = 0.0) -> ks.Model:
    """Return a robot whose joints, (type, placement, axis), follow one another; its last link has a mass."""
    text = '<robot name="trailer"><link name="base"/>'
    for i, (kind, xyz, axis) in enumerate(joints, 1):
        inertial = INERTIAL.format(centre) if i == len(joints) else ""
        limit = "" if kind in ("continuous", "fixed") else '<limit lower="-1" upper="1" effort="9" velocity="1"/>'
        text += (
            f'<link name="l{i}">{inertial}</link><joint name="j{i}" type="{kind}">'
            f'<parent link="{"base" if i == 1 else f"l{i - 1}"}"/><child link="l{i}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}</joint>'
        )
    return load_text(text + "</robot>")


SWIVEL, WHEEL = ("continuous", "0.2 0 0", "0 0 1"), ("continuous", "-0.05 0 -0.1", "0 1 0")
HIP, KNEE = ("revolute", "0 0 0", "1 0 0"), ("revolute", "0 0 -0.3", "0 1 0")
