"""The tables of a robot: its joints, and each chain at its named poses."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.report.check.words import configuration_text
from kinetostat.report.fleet.document import ChainRow, JointRow, PoseRow, RobotDocument, UseRow
from kinetostat.report.fleet.grid import Cell, Column, Grid, grid, quantity, share, words
from kinetostat.report.fleet.wording import distribution

__all__ = ["joints_grid", "poses_grid"]

_JOINTS = (
    Column("joint", "words"),
    Column("type", "words"),
    Column("limb", "words"),
    Column("from"),
    Column("to"),
    Column("velocity limit"),
    Column("effort limit"),
    Column("worst gravity load", about="The largest torque (or force) that holds the weight, of all that was tried."),
    Column("of the limit"),
)
_LOADED = (
    Column("with the payload", about="The same with the payload that was asked for."),
    Column("of the limit"),
)
_POSES = (
    Column("pose", "words"),
    Column("configuration (rad, m)", "words"),
    Column("inside limits", "words"),
    Column("rank", "words", about="Here, of how many rows that count."),
    Column("manipulability", about="Yoshikawa's: the product of the singular values."),
    Column("smallest singular value"),
    Column("dexterity", about="Smallest over largest singular value."),
    Column("gravity use", about="The largest share of an effort limit that the weight takes."),
)


def joints_grid(robot: RobotDocument) -> Grid:
    """Return the joints: limits, and the worst that the weight takes of them."""
    loaded = any(joint.loaded for joint in robot.joints)
    return grid([*_JOINTS, *(_LOADED if loaded else ())], (list(_joint(joint, loaded)) for joint in robot.joints))


def _joint(joint: JointRow, loaded: bool) -> Iterator[Cell]:
    rate = "" if joint.unit == "mixed" else f"{joint.unit}/s"
    yield words(joint.name)
    yield words(f"{joint.type}, follows {_law(joint.follows)}" if joint.follows else joint.type)
    yield words(joint.limb)
    yield quantity(joint.lower, joint.unit)
    yield quantity(joint.upper, joint.unit)
    yield quantity(joint.velocity, rate)
    yield quantity(joint.effort, joint.effort_unit)
    yield from _use(joint.gravity, joint.effort_unit)
    if loaded:
        yield from _use(joint.loaded, joint.effort_unit)


def _law(law: str) -> str:
    """Return a follower's law, 'leader * -1 + 0', as one writes it."""
    leader, _, factor = law.removesuffix(" + 0").rpartition(" * ")
    signed = factor.replace("-", "\N{MINUS SIGN}")
    return leader if factor == "1" else f"{leader} \N{MULTIPLICATION SIGN} {signed}"


def _use(use: UseRow | None, unit: str) -> Iterator[Cell]:
    yield quantity(use.torque if use else None, unit)
    yield share(use.use if use else None)


def poses_grid(chain: ChainRow) -> Grid:
    """Return a chain at its named poses."""
    return grid(_POSES, (list(_pose(chain, pose)) for pose in chain.poses))


def _pose(chain: ChainRow, pose: PoseRow) -> Iterator[Cell]:
    yoshikawa = distribution(chain, "yoshikawa")
    yield words(pose.name)
    yield words(configuration_text(pose.configuration, digits=3).removeprefix("at "))
    yield Cell("yes" if pose.inside else "no", sign="" if pose.inside else "bad")
    yield words(f"{pose.rank} of {pose.dimension}")
    yield quantity(pose.yoshikawa, yoshikawa.unit if yoshikawa else "")
    yield quantity(pose.smallest_singular_value, chain.singular_value_unit)
    yield quantity(pose.inverse_condition_number, full=1)
    yield share(pose.effort_use)
