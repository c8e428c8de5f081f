"""A limb of a robot as a row of the report: its distributions, poses, singular families, payload."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from kinetostat.analysis.capacity import Strongest
from kinetostat.analysis.indices import NEAR
from kinetostat.analysis.manipulability import Block
from kinetostat.analysis.profile.result import LimbPose, LimbProfile, RobotProfile
from kinetostat.analysis.singular.find import Family, SingularFamilies
from kinetostat.analysis.sweeping.result import QUANTILES, Distribution
from kinetostat.errors import quote, quoted
from kinetostat.report.check.words import counted
from kinetostat.report.fleet.document import ChainRow, DistributionRow, FamilyRow, LeftRow, PayloadRow, PoseRow
from kinetostat.report.fleet.joint_rows import worst_use
from kinetostat.report.fleet.numbers import finite
from kinetostat.report.measured import reading
from kinetostat.report.singular import condition_words

__all__ = ["chain_row"]

_SHARES = sorted({*QUANTILES, 0.1, 0.9})


def chain_row(id: str, profile: LimbProfile, robot: RobotProfile, asked: float | None) -> ChainRow:  # noqa: A002
    """Return a limb's row.

    Args:
        id: its place in the page.
        profile: what is known of the limb.
        robot: what is known of the robot that it belongs to.
        asked: the payload that is asked for where the settings say nothing of the limb, kg.
    """
    limb, sweep, families = profile.limb, profile.sweep, profile.families
    gravity_use, gravity_joint = worst_use(robot.worst, limb.joints)
    loaded_use, loaded_joint = worst_use(profile.loaded, limb.joints)
    smallest = None if sweep is None else sweep.measures.get("minimum_singular_value")
    return ChainRow(
        id=id,
        name=limb.name,
        base=limb.base,
        frame=limb.frame,
        found=limb.found,
        joints=limb.joints,
        rows=_rows(profile),
        rank=_rank(profile),
        length=None if sweep is None else finite(sweep.length),
        length_reference="" if sweep is None else sweep.length_reference,
        turns_only=_turns_only(profile),
        singular_value_unit="" if smallest is None else smallest.unit,
        samples=0 if sweep is None else sweep.count,
        reach=finite(profile.reach),
        payload_at_mid=_payload(profile),
        asked_payload=_asked(profile, asked),
        distributions=() if sweep is None else tuple(map(_distribution, _wholes(sweep.measures.values()))),
        near=NEAR if sweep is None else sweep.near,
        near_singular_share=None if sweep is None else finite(sweep.near_singular_share),
        worst_gravity_use=gravity_use,
        worst_gravity_joint=gravity_joint,
        worst_loaded_use=loaded_use,
        worst_loaded_joint=loaded_joint,
        poses=tuple(_pose(pose, profile) for pose in profile.poses),
        families=() if families is None else tuple(_family(families, family) for family in families.families),
        starts=0 if families is None else families.starts,
        converged=0 if families is None else families.converged,
        unseen=None if families is None else finite(families.coverage.unseen),
        left=tuple(_left(profile)),
    )


def _rows(profile: LimbProfile) -> tuple[str, ...]:
    if profile.sweep is not None:
        return profile.sweep.task.row_names
    return () if profile.families is None else profile.families.mechanism.task.row_names


def _rank(profile: LimbProfile) -> int | None:
    if profile.families is not None:
        return profile.families.mechanism.generic_rank
    return _block(profile.poses[0]).usual_rank if profile.poses else None


def _turns_only(profile: LimbProfile) -> bool:
    """Return whether no joint moves the tool along at almost any configuration: its linear velocity has rank 0."""
    return bool(profile.poses) and profile.poses[0].manipulability.blocks["translation"].usual_rank == 0


def _asked(profile: LimbProfile, asked: float | None) -> float | None:
    if profile.loaded is not None and profile.loaded.payload is not None:
        return finite(profile.loaded.payload.mass)
    return finite(asked if profile.limb.payload is None else profile.limb.payload)


def _wholes(measures: Iterable[Distribution]) -> Iterator[Distribution]:
    """Yield the measures that are about the limb, not about one of its joints."""
    return (one for one in measures if one.column.name == one.column.measure)


def _distribution(found: Distribution) -> DistributionRow:
    shares = {f"{share:g}": finite(found.quantile(share)) for share in _SHARES} if found.count else {}
    return DistributionRow(
        measure=found.column.name,
        title=reading(found.column).name,
        unit=found.unit,
        count=found.count,
        mean=finite(found.mean),
        minimum=None if found.minimum is None else finite(found.minimum.value),
        maximum=None if found.maximum is None else finite(found.maximum.value),
        quantiles={share: value for share, value in shares.items() if value is not None},
    )


def _pose(pose: LimbPose, profile: LimbProfile) -> PoseRow:
    robot, block = pose.at.robot, _block(pose)
    positions = {
        name: float(value) + 0.0
        for joint in profile.limb.joints
        for name, value in zip(
            robot.joint_by_name[joint].position_names, pose.at.q[robot.position_slices[joint]], strict=True
        )
    }
    return PoseRow(
        name=pose.name,
        configuration=positions,
        inside=bool(pose.inside),
        rank=int(block.rank),
        dimension=block.task_dimension,
        yoshikawa=finite(pose.values.get("yoshikawa")),
        smallest_singular_value=finite(pose.values.get("minimum_singular_value")),
        inverse_condition_number=finite(pose.values.get("inverse_condition_number")),
        effort_use=finite(pose.values.get("effort_use")),
    )


def _block(pose: LimbPose) -> Block:
    blocks = pose.manipulability.blocks
    return blocks.get("task", blocks["full"])


def _family(found: SingularFamilies, family: Family) -> FamilyRow:
    words = condition_words(found.mechanism, family.positions, family.support, family.codimension, degrees=False)
    return FamilyRow(
        name=family.name or "",
        condition=words,
        codimension=int(family.codimension),
        kind=family.kind,
        inside_limits=bool(family.inside_limits),
        complete=bool(family.complete),
        tolerance=family.tolerance,
        hits=int(family.hits),
        causes=tuple(cause.text for cause in family.causes),
    )


def _payload(profile: LimbProfile) -> PayloadRow | None:
    found = profile.payload
    if found is None or _turns_only(profile):
        return None
    return PayloadRow(
        mass=finite(found.value),
        binding_joint=found.binding_joint or "",
        least=finite(found.least),
        unbounded=bool(np.isposinf(found.value)),
    )


# --- what is not there, and why ----------------------------------------------------------------------------------


def _left(profile: LimbProfile) -> Iterator[LeftRow]:
    """Yield what the profile leaves out, and the reasons of nulls that only the row has."""
    from kinetostat.report.figures.distributions import varies

    yield from (LeftRow(what=left.what, why=left.why) for left in profile.left)
    if profile.payload is not None and _turns_only(profile):
        yield LeftRow(what="payload", why="no joint moves the tool along: they only turn it")
    elif profile.payload is not None:
        yield from _no_payload(profile.payload)
    if profile.families is not None:
        yield from _unsure(profile.families)
    if profile.sweep is not None and not varies(profile):
        yield LeftRow(what="histograms", why="every measure is the same at all configurations")


def _no_payload(found: Strongest) -> Iterator[LeftRow]:
    mass = float(found.value)
    if math.isinf(mass):
        yield LeftRow(what="payload", why="no limit: no joint of the chain feels it at the middle of limits")
    elif math.isnan(mass):
        whose = f" of {quote(found.binding_joint)}" if found.binding_joint else ""
        yield LeftRow(what="payload", why=f"none is possible: the effort limit{whose} is exceeded without it")


def _unsure(found: SingularFamilies) -> Iterator[LeftRow]:
    """Yield what the search for singular configurations leaves open."""
    if found.coverage.incomplete:
        names = quoted(found.coverage.incomplete)
        what = f"whether all singular positions of {names} are listed"
        yield LeftRow(what=what, why="they come from searches, which may miss one: no equation gives them all")
    if found.unclassified:
        what = counted(found.unclassified, "singular configuration")
        yield LeftRow(what=f"the family of {what}", why="close to where families meet")
