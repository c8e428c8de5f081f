"""What can be measured of every configuration of a sweep: names, columns, units, and what the kernel has to give."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.coordinates import Coordinates
from kinetostat.analysis.indices import inverse_condition_number, isotropy, powered
from kinetostat.analysis.task import Task
from kinetostat.conventions import TWIST_ROWS, TWIST_UNITS, Array
from kinetostat.errors import UsageError, quote, unknown_name
from kinetostat.screw import so3

__all__ = ["MEASURES", "Asked", "Column", "Measure", "Subject", "asked", "kernel_outputs", "subject"]

Outputs = dict[str, Array]


@dataclass(frozen=True)
class Subject:
    """What the columns of measures depend on.

    Attributes:
        names: names of the n coordinates.
        turning: whether each is an angle.
        task: the rows that count.
        unit: unit of the singular values.
        count: how many singular values there are: the rank at almost every configuration.
    """

    names: tuple[str, ...]
    turning: tuple[bool, ...]
    task: Task
    unit: str
    count: int

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each coordinate."""
        return tuple("rad" if turns else "m" for turns in self.turning)

    @property
    def efforts(self) -> tuple[str, ...]:
        """Unit of what holds each coordinate."""
        return tuple("Nm" if turns else "N" for turns in self.turning)


Part = tuple[str, str]  # name of a column in its measure, unit; an empty name stands for the measure itself


@dataclass(frozen=True)
class Measure:
    """Something that is measured of a configuration, in one or several columns.

    Attributes:
        name: as it is asked for.
        about: what it is, in a line.
        outputs: the kernel's outputs that it comes from.
        parts: its columns.
        values: from the outputs, (m, ...), to the columns, (c, m).
        summary: whether its columns have a distribution worth telling; else it is for rows only.
    """

    name: str
    about: str
    outputs: tuple[str, ...]
    parts: Callable[[Subject], list[Part]]
    values: Callable[[Outputs], Array]
    summary: bool = True


@dataclass(frozen=True)
class Column:
    """A column: of which measure, its full name (`position.x`), its unit ("1" for a pure number)."""

    measure: str
    name: str
    unit: str


@dataclass(frozen=True)
class Asked:
    """A measure that is asked for, of a certain chain. It is picklable: a measure is known by its name."""

    name: str
    columns: tuple[Column, ...]

    @property
    def measure(self) -> Measure:
        """The measure."""
        return MEASURES[self.name]

    def values(self, outputs: Outputs) -> Array:
        """Return the columns from the kernel's outputs, configurations last. (m, ...) -> (c, m)."""
        return self.measure.values(outputs)


def _last(values: Array) -> Array:
    """Return an output with its configurations' axis last and all others flat. (m, ...) -> (c, m)."""
    moved = np.moveaxis(values, 0, -1)
    return moved.reshape(-1, moved.shape[-1])


def _output(name: str) -> Callable[[Outputs], Array]:
    return lambda outputs: _last(outputs[name])


def _position(outputs: Outputs) -> Array:
    return _last(outputs["placement"][..., 3])


def _pose(outputs: Outputs) -> Array:
    return np.concatenate([_position(outputs), _last(so3.to_quaternion(outputs["placement"][..., :3]))])


def _effort_use(outputs: Outputs) -> Array:
    each = _last(outputs["effort_use"])
    return np.concatenate([np.fmax.reduce(each)[None], each])  # a joint without a limit (NaN) does not count


def _one(unit: Callable[[Subject], str]) -> Callable[[Subject], list[Part]]:
    return lambda subject: [("", unit(subject))]


def _by_coordinate(units: Callable[[Subject], Sequence[str]]) -> Callable[[Subject], list[Part]]:
    return lambda subject: list(zip(subject.names, units(subject), strict=True))


def _along(unit: str, subject: Subject) -> list[str]:
    """Return the units of a gradient."""
    return ["mixed" if unit == "mixed" else f"{unit}/{own}" for own in subject.units]


def _jacobian_parts(subject: Subject) -> list[Part]:
    """Return names and units of the entries, row by row: `vx.joint1` in m/s over rad/s, which is m/rad."""
    lengths = [unit.removesuffix("/s") for unit in TWIST_UNITS]
    return [
        (f"{row}.{name}", "1" if length == own else f"{length}/{own}")
        for row, length in zip(TWIST_ROWS, lengths, strict=True)
        for name, own in zip(subject.names, subject.units, strict=True)
    ]


_METRES = [(letter, "m") for letter in "xyz"]
_PURE = _one(lambda _: "1")

_ALL = (
    Measure(
        "yoshikawa",
        "product of the singular values: manipulability (T. Yoshikawa, 1985)",
        ("yoshikawa",),
        _one(lambda s: powered(s.unit, s.count)),
        _output("yoshikawa"),
    ),
    Measure(
        "minimum_singular_value",
        "the slowest motion that unit joint rates make",
        ("singular_values",),
        _one(lambda s: s.unit),
        lambda outputs: _last(outputs["singular_values"][:, -1:]),
    ),
    Measure(
        "inverse_condition_number",
        "smallest over largest singular value, 0 where it is singular",
        ("singular_values",),
        _PURE,
        lambda outputs: inverse_condition_number(outputs["singular_values"])[None],
    ),
    Measure(
        "isotropy",
        "geometric over arithmetic mean of the squared singular values",
        ("singular_values",),
        _PURE,
        lambda outputs: isotropy(outputs["singular_values"])[None],
    ),
    Measure(
        "singular_values",
        "all of them, the largest first",
        ("singular_values",),
        lambda s: [(f"s{i + 1}", s.unit) for i in range(s.count)],
        _output("singular_values"),
    ),
    Measure("position", "of the tool point, in the observer's axes", ("placement",), lambda _: _METRES, _position),
    Measure(
        "pose",
        "position and unit quaternion of the tool (rows only)",
        ("placement",),
        lambda _: [*_METRES, *((part, "1") for part in ("qx", "qy", "qz", "qw"))],
        _pose,
        summary=False,
    ),
    Measure(
        "jacobian",
        "its entries, row by row (rows only)",
        ("jacobian",),
        _jacobian_parts,
        _output("jacobian"),
        summary=False,
    ),
    Measure(
        "yoshikawa_gradient",
        "change of yoshikawa with each coordinate",
        ("yoshikawa_gradient",),
        _by_coordinate(lambda s: _along(powered(s.unit, s.count), s)),
        _output("yoshikawa_gradient"),
    ),
    Measure(
        "minimum_gradient",
        "change of the smallest singular value with each coordinate",
        ("minimum_gradient",),
        _by_coordinate(lambda s: _along(s.unit, s)),
        _output("minimum_gradient"),
    ),
    Measure(
        "gravity_torque",
        "what holds the weight of links and payload, by coordinate",
        ("gravity_torque",),
        _by_coordinate(lambda s: s.efforts),
        _output("gravity_torque"),
    ),
    Measure(
        "effort_use",
        "gravity torque over effort limit: the largest, and by coordinate",
        ("effort_use",),
        lambda s: [("", "1"), *((name, "1") for name in s.names)],
        _effort_use,
    ),
    Measure(
        "limit_distance",
        "of the joint nearest to a position limit, its own or a follower's: 1 amid its range, 0 at its end",
        ("limit_distance",),
        _PURE,
        _output("limit_distance"),
    ),
)
MEASURES = {measure.name: measure for measure in _ALL}


def subject(coordinates: Coordinates, task: Task, rank: int, unit: str) -> Subject:
    """Return what the columns of a chain's measures depend on; `unit` is that of its singular values."""
    return Subject(coordinates.names, coordinates.turning, task, unit, rank)


def asked(names: str | Sequence[str], of: Subject) -> tuple[Asked, ...]:
    """Return the measures of some names, in the order given.

    Args:
        names: of `MEASURES`, or a text with commas or blanks between them.
        of: the chain.

    Raises:
        UnknownNameError: no such measure.
        UsageError: none is named, or one twice.
    """
    words = names.replace(",", " ").split() if isinstance(names, str) else list(names)
    if not words:
        raise UsageError("a sweep measures something", remedy=f"for instance {_ALL[0].name}")
    found = []
    for word in words:
        if words.count(word) > 1:
            raise UsageError(f"measure {quote(word)} is named twice", remedy="once is enough")
        if word not in MEASURES:
            raise unknown_name("measure", word, MEASURES, listing=f"there are {', '.join(map(quote, MEASURES))}")
        parts = MEASURES[word].parts(of)
        columns = tuple(Column(word, f"{word}.{name}" if name else word, unit) for name, unit in parts)
        found.append(Asked(word, columns))
    return tuple(found)


def kernel_outputs(wanted: Sequence[Asked]) -> tuple[str, ...]:
    """Return the kernel's outputs that measures need, each once."""
    return tuple(dict.fromkeys(output for one in wanted for output in one.measure.outputs))
