"""Files of rows: what is read was written, to the bit, in any blocks; whole or not at all; memory stays flat."""

import csv
import json
import math
import sys
import tracemalloc

import numpy as np
import pytest

from kinetostat import UsageError
from kinetostat.report.row_files import CsvRows, RowField, check_row_file, open_rows

FIELDS = (
    RowField("q", ("elbow", "slide"), ("rad", "m"), (2,)),
    RowField("yoshikawa", ("yoshikawa",), ("m3",)),
    RowField("jacobian", tuple(f"jacobian.{r}.{c}" for r in "xyz" for c in "ab"), ("m/rad",) * 6, (3, 2)),
)
EDGES = [0.0, -0.0, 5e-324, -2.5e-310, 1.7976931348623157e308, 0.1, 1 / 3, 1e16, 1e22, 123456789.0, -1e-7, 2.0**53 + 2]
BLOCKS = [(11,), (1,) * 11, (4, 7), (10, 1)]
ENDINGS = [".csv", ".npz", ".parquet"]


def arrays(count, seed=0):
    """Return the arrays of the fields with the configurations' axis contiguous, as kernels give them."""
    generator = np.random.default_rng(seed)
    values = np.exp(generator.uniform(-300, 300, (9, count))) * generator.choice([-1, 1], (9, count))
    values[:, : min(count, len(EDGES))] = EDGES[:count]
    return [values[:2].T, values[2], np.moveaxis(values[3:].reshape(3, 2, count), -1, 0)]


def write(path, parts, blocks, about=None):
    with open_rows(path, FIELDS, about or {"robot": "arm"}, len(parts[0])) as rows:
        start = 0
        for size in blocks:
            stop = start + size
            assert rows.write(np.arange(start, stop) + 1, [part[start:stop] for part in parts])
            start = stop


def write_and_stop(path, parts, stop):
    with open_rows(path, FIELDS, {}, len(parts[0])) as rows:
        rows.write(np.arange(4), [part[:4] for part in parts])
        raise stop


def read(path):
    """Return row numbers, names of columns, and numbers (m, k) of a file of any kind."""
    if path.suffix == ".csv":
        with path.open(newline="") as text:
            header, *rows = csv.reader(text)
        cells = [[float(cell) if cell else np.nan for cell in row] for row in rows]
        return [int(row[0]) for row in rows], header[1:], np.array(cells).reshape(len(rows), len(header))[:, 1:]
    if path.suffix == ".npz":
        with np.load(path) as found:  # which refuses pickles
            known = json.loads(str(found["about"]))["fields"]
            parts = [found[field["name"]] for field in known]
            numbers = found["row"]
        columns = [column for field in known for column in field["columns"]]
        assert [part.shape[1:] for part in parts] == [field.shape for field in FIELDS]
        return numbers.tolist(), columns, flat(parts)
    from pyarrow import parquet

    table = parquet.read_table(path)
    values = np.stack([table[name].to_numpy() for name in table.column_names[1:]], axis=1)
    return table["row"].to_pylist(), table.column_names[1:], values


def flat(parts):
    return np.concatenate([part.reshape(len(part), math.prod(part.shape[1:])) for part in parts], axis=1)


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("blocks", BLOCKS, ids=str)
def test_what_is_read_is_what_was_written_to_the_bit(tmp_path, ending, blocks):
    path, parts = tmp_path / f"rows{ending}", arrays(11)
    write(path, parts, blocks)
    numbers, columns, values = read(path)
    assert numbers == list(range(1, 12))
    assert [column.partition(" [")[0] for column in columns] == [name for field in FIELDS for name in field.columns]
    assert values.tobytes() == flat(parts).tobytes()


@pytest.mark.parametrize("ending", [".csv", ".npz"])
def test_blocks_do_not_change_the_bytes(tmp_path, ending):
    parts, found = arrays(11), set()
    for i, blocks in enumerate(BLOCKS):
        path = tmp_path / f"{i}{ending}"
        write(path, parts, blocks)
        found.add(path.read_bytes())
    assert len(found) == 1


@pytest.mark.parametrize("ending", ENDINGS)
def test_no_rows_are_a_file_of_columns(tmp_path, ending):
    path = tmp_path / f"rows{ending}"
    write(path, arrays(0), ())
    numbers, columns, _ = read(path)
    assert numbers == []
    assert len(columns) == 9


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_is_not_finite(tmp_path, ending):
    path, parts = tmp_path / f"rows{ending}", arrays(11)
    parts[1][:3] = np.nan, np.inf, -np.inf
    write(path, parts, (5, 6))
    _, _, values = read(path)
    expected = flat(parts)
    if ending == ".csv":
        expected[~np.isfinite(expected)] = np.nan  # an empty cell
    np.testing.assert_array_equal(values, expected)


def test_units(tmp_path):
    write(tmp_path / "rows.csv", arrays(3), (3,))
    header = (tmp_path / "rows.csv").read_text().splitlines()[0].split(",")
    assert header[:4] == ["row", "elbow [rad]", "slide [m]", "yoshikawa [m3]"]
    write(tmp_path / "rows.parquet", arrays(3), (3,), {"seed": 7})
    from pyarrow import parquet

    schema = parquet.read_schema(tmp_path / "rows.parquet")
    assert schema.field("slide").metadata == {b"unit": b"m"}
    assert json.loads(schema.metadata[b"kinetostat"])["seed"] == 7
    assert parquet.ParquetFile(tmp_path / "rows.parquet").metadata.num_row_groups == 1


@pytest.mark.parametrize("ending", [".npz", ".parquet"])
def test_what_the_rows_have_told_is_in_the_file(tmp_path, ending):
    path, parts, about = tmp_path / f"rows{ending}", arrays(3), {"seed": 7}
    with open_rows(path, FIELDS, about, 3, {"grid.elbow": np.arange(4.0)}) as rows:
        rows.write(np.arange(3), parts)
        about["agree"] = True
    if ending == ".npz":
        with np.load(path) as found:
            assert found["grid.elbow"].tolist() == [0, 1, 2, 3]
            known = json.loads(str(found["about"]))
    else:
        from pyarrow import parquet

        known = json.loads(parquet.read_metadata(path).metadata[b"kinetostat"])
    assert (known["seed"], known["agree"]) == (7, True)


def test_a_row_group_a_block(tmp_path):
    write(tmp_path / "rows.parquet", arrays(11), (4, 7))
    from pyarrow import parquet

    known = parquet.ParquetFile(tmp_path / "rows.parquet").metadata
    assert [known.row_group(i).num_rows for i in range(known.num_row_groups)] == [4, 7]


@pytest.mark.parametrize("ending", ENDINGS)
def test_joints_may_be_called_anything(tmp_path, ending):
    """Every column can be told from the others, and no name is a formula."""
    fields = (
        RowField("q", ("row", "yoshikawa", "=1+1", "yoshikawa_2"), ("rad",) * 4, (4,)),
        RowField("yoshikawa", ("yoshikawa",), ("",)),
    )
    path = tmp_path / f"rows{ending}"
    with open_rows(path, fields, {}, 1) as rows:
        rows.write(np.array([1]), [np.array([[1.0, 2.0, 3.0, 4.0]]), np.array([5.0])])
    if ending == ".npz":
        assert np.load(path)["q"].tolist() == [[1, 2, 3, 4]]
        return
    _, columns, values = read(path)
    assert len({"row", *columns}) == 6
    assert values.tolist() == [[1, 2, 3, 4, 5]]
    if ending == ".csv":
        assert columns[2].startswith("'=")


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit, ValueError])
def test_a_file_that_is_not_finished_is_not_there(tmp_path, ending, stop):
    path, parts = tmp_path / f"rows{ending}", arrays(11)
    for before in (None, b"as it was"):
        if before is not None:
            path.write_bytes(before)
        with pytest.raises(stop):
            write_and_stop(path, parts, stop)
        left = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
        assert left == ({} if before is None else {path.name: before})


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_full_disk_is_one_line(tmp_path, ending):
    path, parts = tmp_path / f"rows{ending}", arrays(11)
    path.symlink_to("/dev/full")
    with pytest.raises(UsageError, match="No space left on device"):
        write(path, parts, (11,))


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_folder_that_is_not_there(tmp_path, ending):
    with pytest.raises(UsageError, match="cannot write"):
        write(tmp_path / "none" / f"rows{ending}", arrays(2), (2,))


@pytest.mark.parametrize("ending", ENDINGS)
def test_memory_does_not_grow_with_the_rows(tmp_path, ending):
    parts = arrays(5_000)
    with open_rows(tmp_path / "warm.csv", FIELDS, {}, 5_000) as rows:
        rows.write(np.arange(5_000), parts)
    peaks = []
    for blocks in (5, 20):
        tracemalloc.start()
        with open_rows(tmp_path / f"rows{ending}", FIELDS, {}, blocks * 5_000) as rows:
            for _ in range(blocks):
                rows.write(np.arange(5_000), parts)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < peaks[0] + flat(parts).nbytes


def test_what_is_larger_than_the_disk_is_refused_before_it_is_made(tmp_path):
    with pytest.raises(UsageError, match=r"these rows are 8e\+10 GB, and the disk has room for"):
        write_as_if(tmp_path / "rows.npz", 10**18)
    assert list(tmp_path.iterdir()) == []


def write_as_if(path, count):
    with open_rows(path, FIELDS, {}, count):
        pass


def test_a_reader_that_has_gone_is_told(tmp_path):
    written = []

    def write_once(text):
        written.append(text)
        return len(written) < 3

    rows = CsvRows(write_once, FIELDS)
    assert rows.write(np.arange(5), [part[:5] for part in arrays(11)])
    assert not rows.write(np.arange(9000), [np.tile(part[:1], (9000,) + (1,) * (part.ndim - 1)) for part in arrays(1)])
    assert len(written) == 3


def test_endings(tmp_path, monkeypatch):
    for name in ("rows.json", "rows", "rows.npz.gz", "csv"):
        with pytest.raises(UsageError, match=r"name it \.csv, \.npz or \.parquet"):
            check_row_file(tmp_path / name)
    check_row_file(tmp_path / "ROWS.CSV")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    check_row_file(tmp_path / "rows.npz")
    with pytest.raises(UsageError, match=r"pip install 'kinetostat\[parquet\]'"):
        check_row_file(tmp_path / "rows.parquet")
