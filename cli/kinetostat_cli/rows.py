"""Configurations of a list all at once, for what is asked of all of them together; what is wrong with a row is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kinetostat_cli.console import warn
from kinetostat_cli.options import ConfigurationOptions
from kinetostat_cli.reading import batches, configuration_rows

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from kinetostat import Model
    from kinetostat.conventions import Array

__all__ = ["SoundRows", "sound_rows", "warn_of_held"]

_TOLD = 5  # rows that cannot be used, each with its reason


@dataclass(frozen=True)
class SoundRows:
    """The configurations of a list that can be: (m, nq), and the number of each in the list, (m,)."""

    values: Array
    numbers: NDArray[np.int64]


def sound_rows(model: Model, file: Path, at: ConfigurationOptions) -> SoundRows:
    """Read a list of configurations; warn of each row that is none.

    Raises:
        UsageError: the file cannot be read, is no list, or holds no configuration.
    """
    import numpy as np

    from kinetostat.errors import ConfigurationError

    kind = configuration_rows(model, at)
    values, numbers, lost = [kind.blank[:0]], list[int](), list[str]()
    for batch in batches(file, kind):
        values.append(batch.values)
        pairs = list(zip(batch.numbers, batch.reasons, strict=True))
        numbers += [number for number, reason in pairs if reason is None]
        lost += [f"row {number} is left out: {reason}" for number, reason in pairs if reason is not None]
    warn(lost[:_TOLD])
    if len(lost) > _TOLD:
        warn([f"{len(lost) - _TOLD} more rows are left out"])
    if not numbers:
        raise ConfigurationError("no configuration in it", file=str(file), remedy="write a row of joint values a line")
    return SoundRows(np.concatenate(values), np.array(numbers, dtype=np.int64))


def warn_of_held(model: Model, listed: SoundRows, indices: Sequence[int]) -> None:
    """Warn of joints that a list moves and that are held all the same: those that `indices` has no place of."""
    import numpy as np

    from kinetostat.errors import quote

    moved = np.any(listed.values != listed.values[0], axis=0)
    moved[list(indices)] = False
    names = [quote(name) for name, moves in zip(model.robot.position_names, moved, strict=True) if moves]
    if names:
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        warn([f"the list moves {', '.join(names[:3])}{more}, which --frame does not depend on: held as --config says"])
