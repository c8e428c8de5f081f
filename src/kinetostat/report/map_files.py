"""Capability maps to files, whole or not at all: NPZ for programs, VTK image data (.vti) for viewers like ParaView."""

from __future__ import annotations

import json
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetostat.analysis.capability.directions import centres
from kinetostat.errors import UsageError, quote
from kinetostat.report.map import map_about
from kinetostat.report.row_files.npz import array_member
from kinetostat.report.writing import open_whole

if TYPE_CHECKING:
    from kinetostat.analysis.capability.capability_map import CapabilityMap

__all__ = ["ENDINGS", "write_map"]

ENDINGS = (".npz", ".vti")


def write_map(result: CapabilityMap, path: Path, opening: dict[str, Any]) -> None:
    """Write a map by the file's ending: arrays (a, b, c) along x, y, z by name.

    Both have `reach_count`, `best_singular_value`, `mean_singular_value` (NaN where nothing reaches),
    `orientation_coverage` (a share) and `directions`: bit i, counted from the lowest, is set where the tool's z axis
    arrives from about row i of `direction_axes` (58, 3), unit vectors in the observer's axes; row 0 is +z, row 57 -z.
    NPZ has also these, the middles of voxels `x`, `y`, `z` in m, and `about`, a JSON text with units and all that the
    map was asked for.

        with np.load("map.npz") as file:
            down = (file["directions"] >> np.uint64(57)) & np.uint64(1) == 1  # (a, b, c)

    Args:
        result: the map.
        path: where to.
        opening: what comes first in `about`: schema and robot.

    Raises:
        UsageError: another ending than .npz or .vti; it cannot be written.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        message = f"cannot write a map to {quote(str(path))}: a file's format is told by its ending"
        raise UsageError(message, remedy=f"name it {' or '.join(ENDINGS)}")
    if ending == ".npz":
        _write_npz(result, path, opening)
    else:
        _write_vti(result, path)


def _fields(result: CapabilityMap) -> dict[str, Any]:
    return {
        "reach_count": result.reach_count,
        "best_singular_value": result.best_singular_value,
        "mean_singular_value": result.mean_singular_value,
        "orientation_coverage": result.orientation_coverage,
        "directions": result.directions,
    }


def _write_npz(result: CapabilityMap, path: Path, opening: dict[str, Any]) -> None:
    x, y, z = result.grid.axes
    about = json.dumps({**opening, **map_about(result)}, ensure_ascii=False)
    arrays = _fields(result) | {
        "direction_axes": centres(),
        "x": x,
        "y": y,
        "z": z,
        "voxel_size": np.array(result.grid.size),
        "about": np.array(about),
    }
    with open_whole(path) as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            with array_member(archive, name) as member:
                np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)


def _write_vti(result: CapabilityMap, path: Path) -> None:
    from pyevtk.hl import imageToVTK

    # pyevtk writes a file of its own, and ends its name with .vti: there first, then whole to where it belongs.
    with tempfile.TemporaryDirectory() as folder:
        try:
            written = imageToVTK(
                str(Path(folder) / "map"),
                origin=tuple(result.grid.origin.tolist()),  # it writes repr, which NumPy's own numbers do not suit
                spacing=(result.grid.size,) * 3,
                cellData={name: np.asfortranarray(values) for name, values in _fields(result).items()},
            )
        except OSError as error:
            raise UsageError(f"no room for a map in {quote(folder)}: {error.strerror}", remedy="set TMPDIR") from None
        with open_whole(path) as file, Path(written).open("rb") as content:
            while block := content.read(1 << 20):
                file.write(block)
