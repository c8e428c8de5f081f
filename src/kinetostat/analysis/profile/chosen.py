"""Chains that are asked for by name: as limbs, and those among them that a robot cannot have."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from kinetostat.analysis.profile.anatomy import ChosenChain, Left, Limb
from kinetostat.errors import UsageError, quote
from kinetostat.urdf.description import Robot

__all__ = ["chosen_limbs", "possible"]


def chosen_limbs(robot: Robot, chosen: Sequence[ChosenChain]) -> tuple[Limb, ...]:
    """Return chosen chains as limbs.

    Raises:
        UnknownNameError: a frame or base is no link.
        UsageError: no joint moves a frame relative to its base; two chains have the same name.
    """
    named = dict[str, Limb]()
    for chain in chosen:
        limb = _limb(robot, chain, named)
        named[limb.name] = limb
    return tuple(named.values())


def possible(robot: Robot, chosen: Sequence[ChosenChain]) -> tuple[tuple[ChosenChain, ...], tuple[Left, ...]]:
    """Return the chosen chains that a robot can have, and of each other one why it cannot: a slip costs itself alone.

    Of chains with the same name the first is kept. Where none is left it is said that limbs are found instead.
    """
    kept, refused = dict[str, ChosenChain](), list[Left]()
    for chain in chosen:
        try:
            kept[_limb(robot, chain, kept).name] = chain
        except UsageError as error:
            place = f" ({chain.place})" if chain.place else ""
            refused.append(Left(f"chain {quote(_name(chain))}{place}", str(error), chain.place))
    if refused and not kept:
        refused.append(Left("chains of the settings", "the robot has none of them: its limbs are found instead"))
    return tuple(kept.values()), tuple(refused)


def _limb(robot: Robot, chain: ChosenChain, taken: Collection[str]) -> Limb:
    """Return a chosen chain as a limb, with none of the names that are taken."""
    frame, base = robot.frame(chain.frame), robot.frame(chain.base or robot.root)
    name = _name(chain)
    joints = tuple(joint.name for joint in robot.movable_path(base, frame))
    if not joints:
        message = f"no joint moves {quote(frame)} relative to {quote(base)}"
        raise UsageError(message, remedy="choose another frame or base under [[robots.chains]]")
    if name in taken:
        remedy = "give each its own name under [[robots.chains]]"
        raise UsageError(f"two chains are called {quote(name)}", remedy=remedy)
    return Limb(name, base, frame, joints, "settings", chain.payload)


def _name(chain: ChosenChain) -> str:
    return chain.name or chain.frame
