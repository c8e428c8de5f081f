"""What the process loads that a report's processes are forked from: what `check` loads, and what profiles and draws."""

import kinetostat.gate.preloaded  # noqa: I001 (first: it says how many threads the linear algebra gets)

import contourpy  # noqa: F401
import matplotlib.backends.backend_svg  # noqa: F401
import scipy.optimize
import scipy.spatial  # noqa: F401

import kinetostat.analysis.profile.limbs
import kinetostat.analysis.profile.profiling
import kinetostat.report.figures.distributions
import kinetostat.report.figures.embedding
import kinetostat.report.figures.poses
import kinetostat.report.figures.reach_maps
import kinetostat.report.figures.trees
import kinetostat.report.fleet.drawings
import kinetostat.report.fleet.working
import kinetostat.report.figures.sheet
import kinetostat.screw.compiled.run

# Fonts are listed once, here: where no folder can keep the list, every process would make its own.
kinetostat.report.figures.sheet.text_width("a")
