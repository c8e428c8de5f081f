"""A checkpoint: whenever a run ends, by kill -9, a full disk or Ctrl-C, the next one goes on, to the same bits."""

from __future__ import annotations

import io
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import sweeping_toys
from kinetostat.analysis.sweeping.checkpoint import open_checkpoint
from kinetostat.analysis.sweeping.chunks import Chunks
from kinetostat.analysis.sweeping.running import run
from kinetostat.errors import UsageError
from sweeping_toys import Toy

TOY = Toy()


@pytest.fixture
def often(monkeypatch):
    """Write after each chunk."""
    monkeypatch.setattr("kinetostat.analysis.sweeping.running._KEPT_EVERY", 0.0)
    monkeypatch.setattr("kinetostat.analysis.sweeping.running._WRITING_SHARE", 1e9)


def started(folder: Path, workers: int = 2, limit: int = 0) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, sweeping_toys.__file__, str(folder), str(workers), str(limit)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finished(process: subprocess.Popen) -> list[str]:
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (0, "")
    return out.splitlines()


def undisturbed() -> str:
    return f"1 300 {int(Toy(chunks=300).expected().total[0])} 1"


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_killed_again_and_again(tmp_path, workers):
    randomly, kills = random.Random(workers), 0
    for _ in range(6):
        process = started(tmp_path, workers)
        assert process.stdout.readline() == "ready\n"
        with suppress(subprocess.TimeoutExpired):
            process.wait(timeout=randomly.uniform(0.0, 0.1))
        process.kill()
        process.communicate()
        kills += process.returncode == -signal.SIGKILL
    assert kills >= 3
    assert finished(started(tmp_path, workers))[1] == undisturbed()
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix != ".part") == ["checkpoint.npz", "lock"]


def test_ctrl_c_of_a_terminal_and_on(tmp_path):
    process = started(tmp_path)
    while not (tmp_path / "checkpoint.npz").exists():
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    complete, done, _, times = map(int, finished(process)[1].split())
    assert (complete, times) == (0, 1)
    assert 0 < done < 300
    assert finished(started(tmp_path))[1] == undisturbed()


@pytest.mark.parametrize("seed", range(4))
def test_interrupted_at_any_chunk(tmp_path, seed):
    places = sorted(random.Random(seed).sample(range(TOY.chunks), 4))
    counted = 0
    for place in places:
        outcome = run(replace(TOY, interrupt=place), workers=1 + seed % 2, checkpoint=tmp_path)
        assert not outcome.complete or place < counted
        assert outcome.continued == counted
        counted = outcome.rows
    outcome = run(TOY, checkpoint=tmp_path)
    assert outcome.complete
    assert outcome.partial == TOY.expected()


def test_a_finished_run_is_there_at_once(tmp_path):
    first = run(TOY, checkpoint=tmp_path)
    again = run(replace(TOY, wrong=0), checkpoint=tmp_path)  # would fail if anything were computed
    assert again.partial == first.partial == TOY.expected()
    assert again.complete
    assert (again.continued, again.rows, again.rate) == (TOY.rows, TOY.rows, 0)


def test_what_was_done_before_an_error_is_kept(tmp_path):
    with pytest.raises(ZeroDivisionError):
        run(replace(TOY, wrong=30), checkpoint=tmp_path)
    outcome = run(TOY, checkpoint=tmp_path)
    assert outcome.continued == 300
    assert outcome.partial == TOY.expected()


def refused(folder: Path, work: Toy = TOY) -> str:
    with pytest.raises(UsageError) as said:
        run(work, checkpoint=folder)
    assert said.value.remedy
    assert "\n" not in str(said.value)
    return str(said.value)


@pytest.mark.parametrize("other", [replace(TOY, digest="another"), replace(TOY, chunks=51)])
def test_another_questions_checkpoint(tmp_path, other):
    run(TOY, checkpoint=tmp_path)
    before = (tmp_path / "checkpoint.npz").read_bytes()
    assert "another question" in refused(tmp_path, other)
    assert (tmp_path / "checkpoint.npz").read_bytes() == before


def rewritten(path: Path, **changes: object) -> None:
    with np.load(path) as loaded:
        kept = dict(loaded)
    np.savez(path, **{name: array for name, array in (kept | changes).items() if array is not None})


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"format": np.array(1)}, "another version"),
        ({"format": None}, "damaged"),
        ({"format": np.array([1, 1])}, "damaged"),
        ({"done": None}, "damaged"),
        ({"done": np.array([[0, 51]])}, "damaged"),
        ({"done": np.array([[5, 3]])}, "damaged"),
        ({"state.total": None}, "damaged"),
        ({"state.total": np.array([1], dtype=np.uint64)}, "damaged"),
        ({"state.total": np.array(np.nan)}, "damaged"),
        ({"state.times": np.ones((50, 0))}, "damaged"),
        ({"done": np.array([[0, 49]])}, "damaged"),
        ({"digest": np.array("another")}, "damaged"),
        ({"chunks": np.array(51)}, "damaged"),
        ({"sum": None}, "damaged"),
        ({"sum": np.array([0.5, 1])}, "damaged"),
        ({"state.more": np.zeros(1)}, "damaged"),
    ],
)
def test_a_foreign_archive(tmp_path, changes, why):
    run(TOY, checkpoint=tmp_path)
    rewritten(tmp_path / "checkpoint.npz", **changes)
    assert why in refused(tmp_path)


def test_an_archive_of_objects_is_not_unpickled(tmp_path):
    class Bomb:
        def __reduce__(self):
            return (os.mkdir, (str(tmp_path / "exploded"),))

    run(TOY, checkpoint=tmp_path)
    objects = np.empty(1, dtype=object)
    objects[0] = Bomb()
    rewritten(tmp_path / "checkpoint.npz", digest=objects)
    assert "damaged" in refused(tmp_path)
    assert not (tmp_path / "exploded").exists()


def test_truncated_anywhere(tmp_path):
    run(TOY, checkpoint=tmp_path)
    path = tmp_path / "checkpoint.npz"
    whole = path.read_bytes()
    for length in [*range(0, len(whole), 37), len(whole) - 1]:
        path.write_bytes(whole[:length])
        assert "damaged" in refused(tmp_path)


def test_a_wrong_byte_is_noticed_or_harmless(tmp_path):
    run(replace(TOY, interrupt=20), checkpoint=tmp_path)
    path = tmp_path / "checkpoint.npz"
    whole, noticed = path.read_bytes(), 0
    places = range(0, len(whole), 17)
    for place in places:
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            outcome = run(TOY, checkpoint=tmp_path)
        except UsageError:
            noticed += 1
        else:
            assert outcome.partial == TOY.expected()
    assert noticed > len(places) / 2


@pytest.mark.parametrize("content", [b"", b"hello", b"\x93NUMPY", b"PK\x03\x04", b"PK\x05\x06" + bytes(18)])
def test_a_foreign_file(tmp_path, content):
    (tmp_path / "checkpoint.npz").write_bytes(content)
    assert "damaged" in refused(tmp_path)


def test_one_array_is_no_checkpoint(tmp_path):
    content = io.BytesIO()
    np.save(content, np.zeros(3))
    (tmp_path / "checkpoint.npz").write_bytes(content.getvalue())
    assert "damaged" in refused(tmp_path)


def test_no_folder_can_be_made(tmp_path):
    (tmp_path / "file").touch()
    assert "cannot keep a checkpoint" in refused(tmp_path / "file")
    assert "cannot keep a checkpoint" in refused(tmp_path / "file" / "deeper")
    assert "cannot keep a checkpoint" in refused(Path("/proc/nothing"))


def odd_things(tmp_path: Path) -> dict[str, Path]:
    """What is no plain file, by name."""
    found = {name: tmp_path / name for name in ("fifo", "endless", "dangling", "folder", "loop")}
    os.mkfifo(found["fifo"])
    found["endless"].symlink_to("/dev/zero")
    found["dangling"].symlink_to(tmp_path / "nowhere")
    found["folder"].mkdir()
    found["loop"].symlink_to(found["loop"])
    return found


@pytest.mark.parametrize("kind", ["fifo", "endless", "dangling", "folder", "loop"])
def test_odd_things_in_the_folder(tmp_path, kind):
    folder = tmp_path / "kept"
    folder.mkdir()
    odd_things(tmp_path)[kind].rename(folder / "checkpoint.npz")
    assert "is damaged, or no checkpoint" in refused(folder)
    (folder / "lock").unlink()
    (folder / "checkpoint.npz").rename(folder / "lock")
    assert "cannot keep a checkpoint" in refused(folder)
    assert not (tmp_path / "nowhere").exists()


def test_a_checkpoint_too_large(tmp_path, monkeypatch):
    run(TOY, checkpoint=tmp_path)
    size = (tmp_path / "checkpoint.npz").stat().st_size
    with (tmp_path / "checkpoint.npz").open("ab") as file:
        file.truncate(2**40)  # a hole
    assert "damaged" in refused(tmp_path)
    with (tmp_path / "checkpoint.npz").open("r+b") as file:
        file.truncate(size)
    with np.load(tmp_path / "checkpoint.npz") as loaded:
        kept = dict(loaded)
    np.savez_compressed(tmp_path / "checkpoint.npz", **kept, more=np.zeros(10**6))
    monkeypatch.setattr("kinetostat.analysis.sweeping.checkpoint._LARGEST", 10**6)
    assert (tmp_path / "checkpoint.npz").stat().st_size < 10**5
    assert "damaged" in refused(tmp_path)


def test_what_a_link_in_place_of_the_draft_leads_to_is_left_alone(tmp_path):
    target, folder = tmp_path / "precious", tmp_path / "kept"
    target.write_text("precious")
    folder.mkdir()
    (folder / "checkpoint.npz.part").symlink_to(target)
    assert run(TOY, checkpoint=folder).warnings == ()
    assert target.read_text() == "precious"
    assert sorted(path.name for path in folder.iterdir()) == ["checkpoint.npz", "lock"]
    assert not (folder / "checkpoint.npz").is_symlink()


def test_a_folder_without_a_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "has no name" in refused("")
    assert list(tmp_path.iterdir()) == []


def test_two_runs_at_once(tmp_path):
    with open_checkpoint(tmp_path):
        assert "in use by another run" in refused(tmp_path)
    process = started(tmp_path / "other", 1)
    process.stdout.readline()
    while not (tmp_path / "other" / "checkpoint.npz").exists():
        time.sleep(0.01)
    assert "in use by another run" in refused(tmp_path / "other")
    process.kill()
    process.communicate()
    assert "another question" in refused(tmp_path / "other")  # no longer in use


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_worker_processes_do_not_hold_the_folder(tmp_path, method):
    with ProcessPoolExecutor(1, mp_context=get_context(method)) as executor:
        with open_checkpoint(tmp_path):
            executor.submit(int).result()  # starts a process while the folder is held
        assert run(TOY, executor=executor, checkpoint=tmp_path).complete


@pytest.fixture
def disk(monkeypatch):
    """A set of chunks after which the disk is full: /dev/full answers as one does."""
    full, real = set[int](), os.open
    at = list[int]()

    def opened(path, flags, *mode):
        return (
            real("/dev/full", os.O_WRONLY)
            if at[-1:] and at[-1] in full and flags & os.O_EXCL
            else real(path, flags, *mode)
        )

    def compute(toy, chunk):
        at.append(chunk)
        return Toy.compute(toy, chunk)

    monkeypatch.setattr(os, "open", opened)
    return full, compute


def test_a_full_disk_for_a_while(tmp_path, often, disk):
    full, counting = disk
    full.update({10, 11, 12})

    class Filled(Toy):
        compute = counting

    outcome = run(Filled(), checkpoint=tmp_path)
    assert outcome.complete
    assert outcome.partial == TOY.expected()
    assert len(outcome.warnings) == 1
    assert outcome.warnings[0].endswith("could not be written for a while: No space left on device")
    assert run(replace(TOY, wrong=0), checkpoint=tmp_path).partial == TOY.expected()


def test_a_full_disk_to_the_end_leaves_the_last_one_whole(tmp_path, disk):
    full, counting = disk
    full.add(49)

    class Filled(Toy):
        compute = counting

    run(replace(TOY, interrupt=20), checkpoint=tmp_path)
    outcome = run(Filled(), checkpoint=tmp_path)
    assert outcome.partial == TOY.expected()
    assert len(outcome.warnings) == 1
    assert outcome.warnings[0].startswith("the checkpoint in ")
    assert outcome.warnings[0].endswith(" has 210 of these 493 configurations: No space left on device")
    last = run(TOY, checkpoint=tmp_path)
    assert last.continued == 210
    assert last.partial == TOY.expected()


def test_no_file_may_be_longer(tmp_path):
    process = started(tmp_path, 2, limit=1000)  # EFBIG, in a process of its own
    _, result, warning = finished(process)
    assert result == undisturbed()
    assert warning.endswith("has 0 of these 2993 configurations: File too large")
    assert [path.name for path in tmp_path.iterdir()] == ["lock"]


def test_a_state_of_objects_is_a_mistake(tmp_path):
    class Wrong(Toy):
        def empty(self):
            return replace(super().empty(), total=np.array([1], dtype=object))

    with pytest.raises(TypeError, match="array of objects"):
        run(Wrong(), checkpoint=tmp_path)


def test_reading_gives_what_was_written(tmp_path):
    done = Chunks(((0, 3), (7, 9)))
    with open_checkpoint(tmp_path) as folder:
        assert folder.read(TOY) is None
        folder.write(TOY, TOY.compute(2).state(), done)
        assert folder.read(TOY) == (TOY.compute(2), done)
        folder.write(TOY, TOY.compute(3).state(), done)
        assert folder.read(TOY) == (TOY.compute(3), done)
