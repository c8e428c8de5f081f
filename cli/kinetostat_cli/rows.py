"""Configurations of a list all at once, for what is asked of all of them together; what is wrong with a row is told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kinetostat_cli.console import warn
from kinetostat_cli.options import ConfigurationOptions
from kinetostat_cli.reading import batches, configuration_rows, list_file

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


def sound_rows(model: Model, file: Path, rest: Array, at: ConfigurationOptions) -> SoundRows:
    """Read a list of configurations; warn of each row that is none.

    .json and .jsonl are lists, in which joints that are not named are zero; .npz what `sweep` has written; all else is
    read as `trajectory` reads it. There, joints that are not named stay where `rest`, (nq,), has them.

    Raises:
        UsageError: the file cannot be read, is no list, or holds no configuration.
    """
    ending = file.suffix.lower()
    if ending in (".json", ".jsonl"):
        return _of_list(model, file, at)
    if ending == ".npz":
        return _of_arrays(model, file, rest)
    from kinetostat_cli.recording import read_recording

    found = read_recording(file, model, rest, degrees=at.deg)
    _warn_of_lost([str(one) for one in found.rows.bad])
    return SoundRows(found.q, found.rows.numbers)


def _of_list(model: Model, file: Path, at: ConfigurationOptions) -> SoundRows:
    import numpy as np

    from kinetostat.errors import ConfigurationError

    kind = configuration_rows(model, at)
    values, numbers, lost = [kind.blank[:0]], list[int](), list[str]()
    for batch in batches(file, kind):
        values.append(batch.values)
        pairs = list(zip(batch.numbers, batch.reasons, strict=True))
        numbers += [number for number, reason in pairs if reason is None]
        lost += [f"row {number}: {reason}" for number, reason in pairs if reason is not None]
    _warn_of_lost(lost)
    if not numbers:
        raise ConfigurationError("no configuration in it", file=str(file), remedy="write a row of joint values a line")
    return SoundRows(np.concatenate(values), np.array(numbers, dtype=np.int64))


def _of_arrays(model: Model, file: Path, rest: Array) -> SoundRows:
    """Return the configurations of an archive that `sweep` has written: its array `q`, whose columns `about` names.

    Raises:
        ConfigurationError: it is none.
    """
    import json
    import zipfile

    import numpy as np

    from kinetostat.analysis.configuration import from_rows
    from kinetostat.errors import ConfigurationError

    try:
        with np.load(list_file(file)) as found:
            fields = {field["name"]: field["columns"] for field in json.loads(str(found["about"]))["fields"]}
            names, values, numbers = list(map(str, fields["q"])), np.asarray(found["q"], dtype=np.float64), found["row"]
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
        message = "these are no rows that sweep has written"
        raise ConfigurationError(message, file=str(file), remedy="give what sweep -o FILE.npz writes") from None
    if values.shape != (len(numbers), len(names)) or not len(values):
        raise ConfigurationError("no row in it", file=str(file))
    q = from_rows(model, values, names)
    others = [i for i, name in enumerate(model.robot.position_names) if name not in names]
    q[:, others] = rest[others]
    return SoundRows(q, numbers.astype(np.int64))


def _warn_of_lost(lost: Sequence[str]) -> None:
    """Say which rows are left out, the first of them one by one."""
    warn([f"left out: {one}" for one in lost[:_TOLD]])
    if len(lost) > _TOLD:
        warn([f"{len(lost) - _TOLD} more rows are left out"])


def warn_of_held(model: Model, listed: SoundRows, indices: Sequence[int]) -> None:
    """Warn of joints that a list moves and that are held all the same: those that `indices` has no place of."""
    import numpy as np

    from kinetostat.errors import quoted

    moved = np.any(listed.values != listed.values[0], axis=0)
    moved[list(indices)] = False
    names = [name for name, moves in zip(model.robot.position_names, moved, strict=True) if moves]
    if names:
        warn([f"the list moves {quoted(names)}, which --frame does not depend on: held as --config says"])
