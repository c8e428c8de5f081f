"""How functions of this package are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

from kinetostat.screw.compiled.keeping import FOLDER, KeptCode

__all__ = ["LANES", "compiled"]

LANES = 128  # configurations that are computed side by side: 16 vectors of 8 numbers; their scratch stays in the caches


def compiled(function: Callable[..., Any]) -> Any:
    """Return a function that is compiled when first called, or taken from where compiled code is kept.

    It does not hold Python's lock (nogil): threads run side by side. contract: a product and a sum may be one
    instruction, rounded once; no other liberty: sums keep their order, so that the same processor gives the same bits
    whatever is computed beside. error_model numpy: a division by zero is infinite.
    """
    dispatcher = numba.njit(nogil=True, fastmath={"contract"}, error_model="numpy")(function)
    if FOLDER is not None:
        dispatcher._cache = KeptCode(function, FOLDER)
    return dispatcher
