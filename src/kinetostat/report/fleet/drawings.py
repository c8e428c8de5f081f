"""The pictures of a report: which there are of a robot, of each of its limbs, and of the fleet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from kinetostat.analysis.profile.result import LimbProfile, RobotProfile
from kinetostat.report.fleet import alts
from kinetostat.report.fleet.document import ChainRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.drawing import Drawing
from kinetostat.report.fleet.wording import chain_labels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["fleet_drawings", "robot_drawings"]


def robot_drawings(document: RobotDocument, profile: RobotProfile) -> dict[str, Drawing]:
    """Return the pictures of a robot, by their keys: those of which there is something to be drawn.

    Args:
        document: what is told of the robot.
        profile: the same as analyses know it; its limbs are the document's chains, in their order.
    """
    from kinetostat.report.figures.trees import tree_figure

    tree = tree_figure(profile.model.robot, [one.limb for one in profile.limbs])
    drawings = {f"{document.id}/tree": _drawing(f"{document.id}/tree", tree, alts.tree_alt(document))}
    for chain, limb in zip(document.chains, profile.limbs, strict=True):
        drawings |= dict(_limb_drawings(chain, limb, profile))
    return drawings


def fleet_drawings(document: FleetDocument) -> dict[str, Drawing]:
    """Return the pictures of the fleet, by their keys."""
    if not any(robot.chains for robot in document.robots):
        return {}
    from kinetostat.report.figures.fleets import scatter_figure

    key, names = "fleet/scatter", chain_labels(document)
    return {key: _drawing(key, scatter_figure(document), alts.scatter_alt(document), names=names)}


def _limb_drawings(chain: ChainRow, limb: LimbProfile, robot: RobotProfile) -> Iterator[tuple[str, Drawing]]:
    """Yield the pictures of a limb with their keys."""
    from kinetostat.report.figures.distributions import distributions_figure, varies
    from kinetostat.report.figures.poses import poses_figure
    from kinetostat.report.figures.reach_maps import reach_figure, reach_thumbnail

    def drawn(what: str, figure: Figure, alt: str, metres: float = 0.0) -> tuple[str, Drawing]:
        key = f"{chain.id}/{what}"
        return key, _drawing(key, figure, alt, metres)

    if limb.poses:
        yield drawn("poses", poses_figure(robot.model, limb), alts.poses_alt(chain))
    if limb.sections:
        yield drawn("reach", reach_figure(limb), alts.reach_alt(chain))
        small, metres = reach_thumbnail(limb)
        yield drawn("thumbnail", small, alts.thumbnail_alt(chain), metres)
    if varies(limb):
        yield drawn("distributions", distributions_figure(limb), alts.distributions_alt(chain))


def _drawing(
    key: str, figure: Figure, alt: str, metres: float = 0.0, names: Mapping[str, str] | None = None
) -> Drawing:
    from kinetostat.report.figures.embedding import embedded

    return Drawing(embedded(figure, key.replace("/", "-"), names), alt, metres)
