"""What the process loads that checking processes are forked from; it is imported there, and nowhere else."""

import os

# Many processes with small matrices: threads of the linear algebra would only wait for each other.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import kinetostat.engines.pinocchio
import kinetostat.engines.screw
import kinetostat.engines.third
import kinetostat.gate.checking
import kinetostat.lint.linting
import kinetostat.policy.judging

kinetostat.engines.third.warm_up()
