"""What a check may do to its process: answer, raise, die, hang, take all memory. They travel to it by name."""

import os
import signal
import time

from kinetostat.gate.result import FileCheck, Verdict


def behave(task):
    """Do what the name of the robot says."""
    what = task.name
    if what == "raise":
        raise RuntimeError("a broken analysis\x1b[31m")
    if what == "die":
        os.kill(os.getpid(), signal.SIGSEGV)
    if what == "leave":
        os._exit(7)
    if what == "hang":
        time.sleep(600)
    if what == "eat":
        return len(bytearray(1 << 45))
    return FileCheck(what, Verdict.PASS, seconds=float(os.getpid()))


def leave_politely(task):
    """End the process by an exception that is no error."""
    raise SystemExit(0)


def squared(number):
    """Return the square of a number from 0 on; die, hang, raise, or return what cannot travel for others."""
    if number == -1:
        os.kill(os.getpid(), signal.SIGSEGV)
    if number == -2:
        time.sleep(600)
    if number == -3:
        raise ValueError("no square")
    if number == -4:
        return lambda: number
    time.sleep(0.3)
    return number**2


def no_square(number, reason):
    """Return what stands for a square that there is not."""
    return f"{number}: {reason}"
