"""What the pictures of a report show, each in a sentence: for who cannot see them."""

from __future__ import annotations

from kinetostat.errors import cut
from kinetostat.report.check.words import counted
from kinetostat.report.fleet.document import ChainRow, DistributionRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.wording import compared, distribution, measured, number_text, percent, quantile, unit_text

__all__ = ["distributions_alt", "poses_alt", "reach_alt", "scatter_alt", "thumbnail_alt", "tree_alt"]

_MOST = 6  # names that a sentence lists


def tree_alt(robot: RobotDocument) -> str:
    """Return what the kinematic tree shows."""
    size = f"{counted(robot.links, 'link')}, {counted(len(robot.joints), 'joint')} that move"
    limbs = f"; limbs: {_names([chain.name for chain in robot.chains])}" if robot.chains else ""
    return f"The kinematic tree of {cut(robot.name)}: {size}{limbs}."


def poses_alt(chain: ChainRow) -> str:
    """Return what the stick figures show."""
    values = [
        f"{cut(pose.name)} {number_text(pose.smallest_singular_value)}"
        for pose in chain.poses
        if pose.smallest_singular_value is not None
    ]
    unit = unit_text(chain.singular_value_unit)
    told = f" Smallest singular value{f' ({unit})' if unit else ''}: {_listed(values)}." if values else ""
    drawn = "" if chain.turns_only else ", with ellipsoids"
    return f"{_whose(chain)} as a stick figure at {counted(len(chain.poses), 'named pose')}{drawn}.{told}"


def reach_alt(chain: ChainRow) -> str:
    """Return what the maps of the reach show."""
    inside = sum(family.inside_limits for family in chain.families)
    singular = f"; {inside} singular {'family' if inside == 1 else 'families'} inside limits" if chain.families else ""
    tool = _whose(chain) if chain.frame == chain.name else f"{cut(chain.frame)} of {_whose(chain)}"
    moved = "" if len(chain.joints) < 3 else " by two joints, the others held"
    return (
        f"Where {tool} gets{moved}, coloured by its smallest singular value; of all configurations the median is "
        f"{_median(chain, 'minimum_singular_value')}{_farthest(chain)}{singular}."
    )


def thumbnail_alt(chain: ChainRow) -> str:
    """Return what the small map of the reach shows."""
    return f"The reach of {_whose(chain)}{_farthest(chain)}."


def distributions_alt(chain: ChainRow) -> str:
    """Return what the histograms show."""
    told = [
        f"{row.title}, median {_shown(row, median)}"
        for row in chain.distributions
        if (median := quantile(chain, row.measure, "0.5")) is not None
    ]
    return f"Distributions over {chain.samples:,} configurations of {_whose(chain)} inside limits: {_listed(told)}."


def scatter_alt(document: FleetDocument) -> str:
    """Return what the scatter of all chains shows."""
    reaches = [chain.reach for chain in compared(document) if chain.reach is not None]
    extent = f"; reach from {measured(min(reaches), 'm')} to {measured(max(reaches), 'm')}" if reaches else ""
    return f"The reach of {counted(len(reaches), 'chain')} against how well they move{extent}."


def _whose(chain: ChainRow) -> str:
    return cut(chain.name)


def _farthest(chain: ChainRow) -> str:
    return "" if chain.reach is None else f"; {measured(chain.reach, 'm')} from its first joint at the most"


def _median(chain: ChainRow, measure: str) -> str:
    row, value = distribution(chain, measure), quantile(chain, measure, "0.5")
    return "not known" if row is None or value is None else _shown(row, value)


def _shown(row: DistributionRow, value: float) -> str:
    """Return a value of a measure as the pictures have it: a use of effort in percent."""
    return percent(value) if row.measure == "effort_use" else measured(value, row.unit)


def _names(names: list[str]) -> str:
    return _listed([cut(name) for name in names])


def _listed(parts: list[str]) -> str:
    more = f" and {len(parts) - _MOST} more" if len(parts) > _MOST else ""
    return f"{'; '.join(parts[:_MOST])}{more}"
