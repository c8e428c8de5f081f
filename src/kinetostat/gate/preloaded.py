"""What the process loads and does that checking processes are forked from; it is imported there, and nowhere else."""

import os
import signal
import sys

sys.excepthook = lambda *_: None  # one that cannot start, for the parent stops meanwhile, is told by the parent

# Many processes with small matrices: threads of the linear algebra would only wait for each other.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import kinetostat.engines.pinocchio  # noqa: E402
import kinetostat.engines.screw  # noqa: E402
import kinetostat.engines.third  # noqa: E402
import kinetostat.gate.checking  # noqa: E402
import kinetostat.lint.linting  # noqa: E402
import kinetostat.policy.judging  # noqa: E402

kinetostat.engines.third.warm_up()

# Whoever asked may be killed. Then this process ends, and with it those that it has forked (see gate.pool); it would
# not otherwise, for they hold the pipe that tells it.
_ASKING = os.getppid()


def _end_with_the_asking(*_: object) -> None:
    if os.getppid() != _ASKING:
        os._exit(1)


signal.signal(signal.SIGALRM, _end_with_the_asking)
signal.setitimer(signal.ITIMER_REAL, 1, 1)
