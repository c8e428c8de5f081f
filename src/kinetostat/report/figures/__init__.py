"""Results to pictures: the one place that draws. Pure functions of results, in one style, for print and for SVG.

Sheets are laid out by hand, in inches, so that nothing overlaps and the same result always gives the same bytes. What
comes from a robot file is untrusted text: it is made printable, cut, and never read as mathematics. Matplotlib is
imported where something is drawn, not here.
"""

from kinetostat.report.figures.approaches import approach_figure
from kinetostat.report.figures.arm import manipulability_figure
from kinetostat.report.figures.distributions import distributions_figure
from kinetostat.report.figures.fleets import scatter_figure
from kinetostat.report.figures.histograms import histogram_figure
from kinetostat.report.figures.maps import capability_figure, placement_figure
from kinetostat.report.figures.polytopes import polytope_figure
from kinetostat.report.figures.poses import ellipses_figure, poses_figure
from kinetostat.report.figures.reach_maps import reach_figure, reach_thumbnail
from kinetostat.report.figures.saving import check_suffix, save
from kinetostat.report.figures.slices import slice_figure
from kinetostat.report.figures.timelines import timeline_figure
from kinetostat.report.figures.trees import tree_figure
from kinetostat.report.figures.workspaces import workspace_figure

__all__ = [
    "approach_figure",
    "capability_figure",
    "check_suffix",
    "distributions_figure",
    "ellipses_figure",
    "histogram_figure",
    "manipulability_figure",
    "placement_figure",
    "polytope_figure",
    "poses_figure",
    "reach_figure",
    "reach_thumbnail",
    "save",
    "scatter_figure",
    "slice_figure",
    "timeline_figure",
    "tree_figure",
    "workspace_figure",
]
