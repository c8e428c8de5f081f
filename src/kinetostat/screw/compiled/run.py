"""Run a kernel, compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinetostat.conventions import Array

if TYPE_CHECKING:
    from kinetostat.screw.kernel import Kernel

__all__ = ["run"]


def run(kernel: Kernel, q: Array) -> dict[str, Array]:
    """Return what a kernel is asked for. (m, n) -> {output: (m, ...)}."""
    return kernel.definition(q)
