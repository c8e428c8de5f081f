"""Maps in files: what is read back by other means is what was computed; a file is there whole or not at all."""

import json
import re
import struct
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.capability.capability_map import capability_map
from kinetostat.errors import UsageError
from kinetostat.report.map_files import write_map

FIELDS = ("reach_count", "best_singular_value", "mean_singular_value", "orientation_coverage", "directions")
OPENING = {"schema": "kinetostat/map/1"}


@pytest.fixture(scope="module")
def result():
    model = ks.load("textbook:stanford")
    return capability_map(model, "tool", ks.configuration(model).q, samples=70_000, length="auto", voxel=0.2)


def vtk_image(path):
    """Return the attributes of a VTK image file and its cell data (a, b, c), read by the format's description.

    "VTK XML File Formats", appended raw data: after `_`, each array with its size in bytes before it.
    """
    content = path.read_bytes()
    head, _, rest = content.partition(b"_")
    while not head.rstrip().endswith(b'encoding="raw">'):
        more, _, rest = rest.partition(b"_")
        head += b"_" + more
    root = ET.fromstring(head.decode() + "</AppendedData></VTKFile>")
    assert (root.get("type"), root.get("byte_order"), root.get("header_type")) == (
        "ImageData",
        "LittleEndian",
        "UInt64",
    )
    image = root.find("ImageData")
    extent = [int(word) for word in image.get("WholeExtent").split()]
    shape = [high - low for low, high in zip(extent[::2], extent[1::2], strict=True)]
    arrays = {}
    for entry in image.iter("DataArray"):
        kind = {"Int64": "<i8", "UInt64": "<u8", "Float64": "<f8"}[entry.get("type")]
        offset = int(entry.get("offset"))
        (size,) = struct.unpack_from("<Q", rest, offset)
        values = np.frombuffer(rest, kind, size // 8, offset + 8)
        arrays[entry.get("Name")] = values.reshape(shape[::-1]).T  # x changes fastest
    return image.attrib, arrays


def test_a_viewer_reads_what_was_computed(result, tmp_path):
    path = tmp_path / "map.vti"
    write_map(result, path, OPENING)
    image, arrays = vtk_image(path)
    assert set(arrays) == set(FIELDS)
    np.testing.assert_array_equal([float(word) for word in image["Origin"].split()], result.grid.origin)
    assert [float(word) for word in image["Spacing"].split()] == [0.2] * 3
    for name in FIELDS:
        np.testing.assert_array_equal(arrays[name], getattr(result, name))


def test_programs_read_what_was_computed(result, tmp_path):
    path = tmp_path / "map.npz"
    write_map(result, path, OPENING)
    with np.load(path, allow_pickle=False) as file:
        for name in FIELDS:
            np.testing.assert_array_equal(file[name], getattr(result, name))
            assert file[name].dtype == getattr(result, name).dtype
        for axis, middles in zip("xyz", result.grid.axes, strict=True):
            np.testing.assert_array_equal(file[axis], middles)
        about = json.loads(str(file["about"]))
        axes, masks = file["direction_axes"], file["directions"]
        assert float(file["voxel_size"]) == 0.2
    assert about["schema"] == "kinetostat/map/1"
    assert about["shape"] == list(result.grid.shape)
    assert about["singular_value_unit"] == "1"
    assert len(axes) == about["directions"]
    np.testing.assert_array_equal(axes[[0, -1]], [[0, 0, 1], [0, 0, -1]])
    # Each voxel's best configuration arrives from a direction whose bit is set, or from just beside it.
    index = np.flatnonzero(result.reached)[::50]
    z = ks.fk(result.coordinates.model, "tool", result.configurations(index, result.held)).matrix[:, :3, 2]
    arrives = (masks.ravel()[index, None] >> np.arange(len(axes), dtype=np.uint64)) & np.uint64(1) == 1
    assert np.all(np.max(np.where(arrives, z @ axes.T, -1), axis=1) > np.cos(np.radians(25)))


def test_about_says_what_the_map_was_asked_for(tmp_path):
    model = ks.load("example:panda")
    q = ks.configuration(model, {"panda_finger_joint1": 0.02}).q
    asked = {"axes": "xyz rx ry", "reference": "local", "point": (0, 0, 0.1), "approach": (0, 0, -2)}
    map_ = capability_map(model, "panda_hand", q, samples=20_000, **asked)
    write_map(map_, tmp_path / "map.npz", OPENING)
    with np.load(tmp_path / "map.npz", allow_pickle=False) as file:
        found = json.loads(str(file["about"]))["asked"]
    assert (found["frame"], found["relative_to"], found["point"]) == ("panda_hand", "panda_link0", [0, 0, 0.1])
    assert (found["reference"], found["expressed_in"]) == ("local", "panda_hand")
    assert found["rows"] == ["vx", "vy", "vz", "wx", "wy"]
    assert found["characteristic_length"] == map_.length
    assert found["approach"] == {"direction": [0, 0, -1], "within_degrees": 15}
    assert found["held"] == {"panda_finger_joint1": 0.02}


@pytest.mark.parametrize("name", ["map.npz", "map.vti", "MAP.VTI", "a map.NPZ"])
def test_the_same_map_gives_the_same_bytes(result, tmp_path, name):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        write_map(result, tmp_path / folder / name, OPENING)
    assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert [path.name for path in (tmp_path / "a").iterdir()] == [name]


@pytest.mark.parametrize("name", ["map.npz", "map.vti"])
def test_a_failure_leaves_what_was_there(result, tmp_path, monkeypatch, name):
    path = tmp_path / name
    path.write_bytes(b"before")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(UsageError, match="No space left"):
        write_map(result, path, OPENING)
    assert path.read_bytes() == b"before"
    assert [each.name for each in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", ["map.vtk", "map", "map.npz.gz"])
def test_other_endings_are_refused(result, tmp_path, name):
    with pytest.raises(UsageError, match=re.escape("name it .npz or .vti")):
        write_map(result, tmp_path / name, OPENING)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["map.npz", "map.vti"])
def test_a_folder_that_is_missing_is_told(result, tmp_path, name):
    with pytest.raises(UsageError, match="cannot write"):
        write_map(result, tmp_path / "nowhere" / name, OPENING)
