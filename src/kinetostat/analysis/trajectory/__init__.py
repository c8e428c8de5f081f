"""A joint trajectory: indices, motion, torques, limits at every sample, and the stretches to look at."""
