"""Which limbs a robot has: those that the settings name, else those that its tree and its SRDF show."""

from __future__ import annotations

from collections.abc import Sequence

from kinetostat.analysis.profile.anatomy import Anatomy, ChosenChain
from kinetostat.analysis.profile.chosen import chosen_limbs
from kinetostat.analysis.profile.found import found
from kinetostat.analysis.profile.groups import named_by_groups
from kinetostat.analysis.profile.leaving import beside_chosen, beside_found
from kinetostat.engines.model import Model

__all__ = ["limbs"]

_MOST = 8


def limbs(model: Model, chosen: Sequence[ChosenChain] = ()) -> Anatomy:
    """Return the limbs of a robot, those with the most joints first, and what belongs to none.

    With `chosen` they are these and no others, in that order. Else the tree of moving joints is cut where it branches.
    A piece that ends in a tip is a limb, and so is one that carries a hand; pieces that carry limbs are the trunk. A
    limb begins where it leaves the trunk and ends in the frame that is called a tool or a foot, if there is one. The
    groups of an SRDF give names, begin and end to the limbs that they share most joints with, and add those that share
    none. Wheels, hands, single joints beside longer limbs, and what is beyond eight limbs are told, not looked at.

    Args:
        model: the robot.
        chosen: chains that the settings name.

    Raises:
        UnknownNameError: a chosen frame or base is no link; the nearest names are told.
        UsageError: no joint moves a chosen frame relative to its base; two chains have the same name.
        EngineError: Pinocchio refuses the robot.
    """
    if chosen:
        named = chosen_limbs(model.robot, chosen)
        return Anatomy(named, beside_chosen(model.robot, named))
    tree = found(model)
    others = {joint for hand in tree.hands for joint in hand.joints}
    others |= {joint for joints in tree.wheels.values() for joint in joints}
    every = sorted(named_by_groups(model, tree.limbs, others), key=lambda limb: -len(limb.joints))
    shown, more = tuple(every[:_MOST]), tuple(every[_MOST:])
    return Anatomy(shown, beside_found(model.robot, tree, shown, more))
