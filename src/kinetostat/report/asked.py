"""What an answer was computed for, as JSON: what sweeps, maps and trajectories all are asked of a tool."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from kinetostat.analysis.loads import Payload
from kinetostat.analysis.task import Task
from kinetostat.conventions import Array, Velocity
from kinetostat.report.json import nested

__all__ = ["asked_load", "asked_tool"]


def asked_tool(velocity: Velocity, task: Task, length: float | None, length_reference: str) -> dict[str, Any]:
    """Return of which tool point, relative to what, which rows count, and the length that makes them comparable, m."""
    return {
        "frame": velocity.of,
        "point": None if velocity.point is None else list(velocity.point),
        "relative_to": velocity.relative_to,
        "reference": "local" if velocity.expressed_in == velocity.of else "aligned",
        "expressed_in": velocity.expressed_in,
        "rows": list(task.row_names),
        "characteristic_length": length,
        "characteristic_length_reference": length_reference,
    }


def asked_load(
    gravity: Array | None, payload: Payload | None, limits: Mapping[str, float | tuple[float, float]]
) -> dict[str, Any]:
    """Return what weighs, and the effort limits that were given instead of the file's: m/s2, kg, m, Nm and N."""
    return {
        "gravity": None if gravity is None else nested(gravity),
        "payload": payload and {"mass": payload.mass, "frame": payload.frame, "point": list(payload.point)},
        "effort_limits": {name: nested(np.array(limit)) for name, limit in limits.items()},
    }
