"""Whether a placement or a Jacobian is still what a stored file says."""

from __future__ import annotations

import json
import os
import re
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kinetostat.analysis.configuration import configuration
from kinetostat.analysis.inverse.pose import pose, pose_error
from kinetostat.analysis.jacobian import jacobian
from kinetostat.analysis.joint_values import listed
from kinetostat.analysis.kinematics import fk
from kinetostat.conventions import Array, Order
from kinetostat.engines.model import Model
from kinetostat.errors import UsageError, cut, printable, quote
from kinetostat.policy.judging.files import text_beside
from kinetostat.policy.judging.found import Found, agreed, quiet, witness
from kinetostat.policy.kinds.poses import Golden

__all__ = ["golden"]

_WRITTEN_BY = "it is what kinetostat fk, or jacobian, ROBOT -F json -o FILE writes"


def golden(model: Model, asked: Golden, folder: Path) -> Found:
    """Judge a placement (`kinetostat fk`) or a Jacobian against the file that holds it."""
    stored = _Stored(asked.file, text_beside(folder, asked.file))
    q = configuration(model, stored.positions()).q
    compare = {"kinetostat/fk/1": _placement, "kinetostat/jacobian/1": _jacobian}.get(stored.schema)
    if compare is None:
        raise stored.wrong("this is no placement, and no Jacobian")
    difference, text = compare(model, stored, q)
    met = difference <= asked.tolerance
    at = witness(model.robot, q, model.robot.movable_path(*stored.frames()))
    return Found(met, text, at, "" if met else stored.command(_source(model), folder))


def _source(model: Model) -> str:
    """Return the robot as it was asked for, for a command line."""
    name = model.loaded.source.name
    return "ROBOT" if name == "-" else name


class _Stored:
    """A result that was stored as JSON."""

    def __init__(self, name: str, text: str) -> None:
        self._name = name
        try:
            content = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise UsageError(f"not JSON: {cut(str(error), 100)}", file=name, remedy=_WRITTEN_BY) from None
        self._content = content if isinstance(content, dict) else {}
        result = self._content.get("result")
        self.result: Mapping[str, Any] = result if isinstance(result, dict) else {}

    @property
    def schema(self) -> str:
        return str(self._content.get("schema", ""))

    def wrong(self, message: str) -> UsageError:
        return UsageError(message, file=self._name, remedy=_WRITTEN_BY)

    def word(self, key: str) -> str:
        value = self.result.get(key)
        if not isinstance(value, str):
            raise self.wrong(f"its result has no {quote(key)}")
        return value

    def frames(self) -> tuple[str, str]:
        """Return the observer and the frame."""
        return self.word("relative_to"), self.word("frame")

    def numbers(self, key: str, rows: int) -> Array:
        """Return a matrix with so many rows."""
        try:
            matrix = np.array(self.result.get(key), dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            matrix = np.zeros(0)
        if matrix.ndim != 2 or len(matrix) != rows or not np.all(np.isfinite(matrix)):
            raise self.wrong(f"{quote(key)} is no matrix of {rows} rows of numbers")
        return matrix

    def point(self) -> list[float] | None:
        """Return the point of a Jacobian; None where the file has none, for a reason of its own."""
        point = self.result.get("point")
        if point is None or (isinstance(point, list) and all(type(x) in (int, float) for x in point)):
            return point
        raise self.wrong("its point is no list of numbers")

    def sequence(self) -> str | None:
        """Return the name of the Euler sequence of an analytic Jacobian."""
        rates = self.result.get("rates")
        if rates is None:
            return None
        found = re.match(r"intrinsic ([xyz]{3})\b", str(rates.get("sequence") if isinstance(rates, dict) else ""))
        if found is None:
            raise self.wrong("its rates are of no Euler sequence")
        return found[1]

    def rows(self) -> list[int]:
        """Return the order of its rows."""
        order = self.result.get("order", Order.LINEAR_FIRST.value)
        if order not in [one.value for one in Order]:
            raise self.wrong("its rows are in no order that is known")
        return Order(order).rows

    def positions(self) -> dict[str, Any]:
        found = self._content.get("configuration")
        if not isinstance(found, dict):
            raise self.wrong("it has no configuration")
        return found

    def command(self, robot: str, folder: Path) -> str:
        """Return the command that renews the file: it reads the configuration from it before it writes."""
        observer, frame = self.frames()
        file = Path(os.path.relpath(folder / self._name)).as_posix()  # commands are run from here
        words = ["kinetostat", self.schema.split("/")[1], robot, "-f", frame, "--relative-to", observer]
        if "reference" in self.result:
            words += self._asked()
        return shlex.join(printable(word) for word in [*words, "-q", f"@{file}", "-F", "json", "-o", file])

    def _asked(self) -> list[str]:
        """Return the options that a Jacobian was asked by."""
        reference, point, rates = self.word("reference"), self.point(), self.sequence()
        words = ["--reference", reference]
        if rates is None:  # else the axes are the observer's
            words += ["--expressed-in", self.word("expressed_in")]
        if point is not None and any(point):
            words += ["--point", ",".join(map(repr, point))]
        if rates is not None:
            words += ["--rates", rates]
        order = str(self.result.get("order", Order.LINEAR_FIRST.value))
        return words if order == Order.LINEAR_FIRST else [*words, "--order", order]


def _placement(model: Model, stored: _Stored, q: Array) -> tuple[float, str]:
    """Return the larger of the distance in m and the angle in rad, and both in words."""
    observer, frame = stored.frames()
    now = fk(model, frame, q, relative_to=observer)
    agreed(now.certificate)
    wanted = stored.numbers("matrix", 4)
    if wanted.shape != (4, 4):
        raise stored.wrong("its matrix is not 4 by 4")
    error = pose_error(now.matrix, pose(wanted).matrix)
    position, angle = (quiet(float(np.linalg.norm(part)), model.robot) for part in (error[:3], error[3:]))
    return max(position, angle), f"{quote(frame)} is {position:.4g} m and {angle:.4g} rad off"


def _jacobian(model: Model, stored: _Stored, q: Array) -> tuple[float, str]:
    """Return the largest difference of any entry, and where it is."""
    observer, frame = stored.frames()
    now = jacobian(
        model,
        frame,
        q,
        reference=stored.word("reference"),
        relative_to=observer,
        expressed_in=stored.word("expressed_in"),
        point=stored.point(),
        rates=stored.sequence(),
    )
    agreed(now.certificate)
    rows, matrix = stored.rows(), stored.numbers("matrix", 6)
    columns = stored.result.get("columns")
    if list(now.columns) != columns or matrix.shape[-1] != len(now.columns):
        return float("inf"), f"its columns are now {listed(now.columns)}, in the file {listed(_names(columns))}"
    gap = np.abs(now.matrix[rows] - matrix)
    row, column = np.unravel_index(int(np.argmax(gap)), gap.shape)
    where = f"row {now.rows[rows[row]]}, column {quote(now.columns[column])}"
    largest = quiet(float(gap[row, column]), model.robot)
    return largest, f"differs by {largest:.4g} in {where}"


def _names(columns: Any) -> list[str]:
    return [str(name) for name in columns] if isinstance(columns, list) else []
