"""Ctrl-C as a wish: the first one asks a run to end with what it has, the second one interrupts as always."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType

__all__ = ["Stop", "stop_on_interrupt"]


@dataclass
class Stop:
    """Whether the run is asked to end."""

    wanted: bool = False


@contextmanager
def stop_on_interrupt(stop: Stop, wake: Callable[[], None]) -> Iterator[None]:
    """Let the first Ctrl-C set `stop` and call `wake`, so that nothing is torn out of what is being added up.

    Only Python's own way to answer Ctrl-C is replaced, and only in the main thread, where it is answered; a program
    that has its own keeps it.
    """
    ours = threading.current_thread() is threading.main_thread()
    if not ours or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return

    def first(_number: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        stop.wanted = True
        wake()

    signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
