"""Where robot files are found, and how they are opened."""

from __future__ import annotations

import hashlib
import io
import os
import sys
from pathlib import Path

import pytest

from kinetostat.errors import AmbiguousNameError, SourceError, UnknownNameError
from kinetostat.urdf import files
from kinetostat.urdf.files import (
    MAX_BYTES,
    Source,
    example_robots,
    locate,
    open_source,
    read_file,
    short_names,
    textbook_robots,
)

DATA = b"<robot/>"


@pytest.fixture
def robots(monkeypatch):
    """Stand in for example-robot-data: two robots of one stem, and two that stand alone."""
    found = {
        "one_description/arm": Path("/1"),
        "two_description/arm": Path("/2"),
        "two_description/hand": Path("/3"),
        "leg_description/leg": Path("/4"),
    }
    monkeypatch.setattr(files, "example_robots", lambda: found)
    monkeypatch.setattr(files, "textbook_robots", lambda: {"planar2r": Path("/5")})
    return found


# --- names -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("example:hand", "/3"),
        ("example:two_description/hand", "/3"),
        ("example:one_description/arm", "/1"),
        ("example:two_description/arm", "/2"),
        ("textbook:planar2r", "/5"),
        ("arm.urdf", "arm.urdf"),
        ("./example:hand", "./example:hand"),
        ("C:robot.urdf", "C:robot.urdf"),
        ("Example:hand", "Example:hand"),
    ],
)
def test_a_name_leads_to_a_path(robots, name, path):
    assert locate(name) == Path(path)


def test_a_stem_of_two_robots_is_ambiguous_and_both_are_listed(robots):
    with pytest.raises(AmbiguousNameError) as caught:
        locate("example:arm")
    assert caught.value.remedy == "use example:one_description/arm or example:two_description/arm"
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("example:hnd", "did you mean 'hand'?"),
        ("example:HAND", "did you mean 'hand'?"),
        ("example:han", "did you mean 'hand'?"),
        ("example:arms", "'one_description/arm'"),
        ("textbook:planar3r", "did you mean 'planar2r'?"),
        ("example:", "there are"),
        ("example:../../etc/passwd", "there are"),
        ("textbook:zzz", "there are 'planar2r'"),
    ],
)
def test_an_unknown_robot_is_answered_with_the_nearest(robots, name, remedy):
    with pytest.raises(UnknownNameError) as caught:
        locate(name)
    assert remedy in caught.value.remedy


def test_robots_that_are_not_installed_are_said_to_be(monkeypatch):
    monkeypatch.setattr(files, "example_robots", dict)
    with pytest.raises(UnknownNameError, match=r"no example robots are installed .*pip install example-robot-data"):
        locate("example:panda")


def test_short_names_are_stems_where_those_are_unique(robots):
    assert short_names(robots) == ["one_description/arm", "two_description/arm", "hand", "leg"]


def test_every_robot_that_ships_answers_to_its_short_name():
    for scheme, found in (("example", example_robots()), ("textbook", textbook_robots())):
        assert len(found) >= 3
        for short, path in zip(short_names(found), found.values(), strict=True):
            assert locate(f"{scheme}:{short}") == path
            assert path.is_file()


def test_example_robots_are_found_in_any_prefix_of_the_path(tmp_path, monkeypatch):
    folder = tmp_path / "cmeel.prefix" / "share" / "example-robot-data" / "robots" / "my_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "urdf" / "my.urdf").touch()
    (folder / "notes.urdf").touch()  # not where a robot lies
    monkeypatch.setattr(sys, "path", ["", str(tmp_path)])
    assert example_robots() == {"my_description/my": folder / "urdf" / "my.urdf"}


# --- opening ---------------------------------------------------------------------------------------------------


def test_a_source_knows_its_bytes_and_their_digest(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_bytes(DATA)
    source = open_source(str(path))
    assert source == Source(str(path), path, DATA)
    assert source.sha256 == hashlib.sha256(DATA).hexdigest()


def test_standard_input_is_a_source_without_a_path():
    assert open_source("-", stdin=io.BytesIO(DATA)) == Source("-", None, DATA)


def test_standard_input_is_read_to_the_limit_and_no_further():
    stream = io.BytesIO(b"x" * 1000)
    with pytest.raises(SourceError, match="standard input: more than 10 bytes"):
        open_source("-", max_bytes=10, stdin=stream)
    assert stream.tell() == 11


@pytest.mark.parametrize(("size", "fits"), [(9, True), (10, True), (11, False)])
def test_a_file_is_read_up_to_the_limit(tmp_path, size, fits):
    path = tmp_path / "r.urdf"
    path.write_bytes(b"x" * size)
    if fits:
        assert len(read_file(path, "r.urdf", 10)) == size
    else:
        with pytest.raises(SourceError, match=r"more than 10 bytes .*--max-bytes"):
            read_file(path, "r.urdf", 10)


def test_the_limit_is_64_mebibytes():
    assert MAX_BYTES == 64 * 1024 * 1024


def test_a_file_that_grows_while_it_is_read_does_not_pass_the_limit(tmp_path, monkeypatch):
    """What `stat` says of the size is not asked: /proc files say 0, and files grow."""
    path = tmp_path / "r.urdf"
    path.write_bytes(b"x" * 100)
    real = os.stat
    monkeypatch.setattr(os, "stat", lambda *a, **k: os.stat_result([*real(*a, **k)[:6], 0, *real(*a, **k)[7:10]]))
    with pytest.raises(SourceError, match="more than 10 bytes"):
        read_file(path, "r.urdf", 10)


def test_a_file_that_becomes_a_fifo_meanwhile_does_not_block(tmp_path, monkeypatch):
    """Between looking and opening, a file can be replaced: opening a FIFO without a writer would wait for ever."""
    regular, fifo = tmp_path / "r.urdf", tmp_path / "fifo"
    regular.touch()
    os.mkfifo(fifo)
    real = os.open
    monkeypatch.setattr(
        os, "open", lambda path, flags, *rest: real(fifo if Path(path) == regular else path, flags, *rest)
    )
    assert read_file(regular, "r.urdf") == b""


ODD_NAMES = {
    "a NUL": "a\0b",
    "too long": "x" * 300,
    "too deep": "x/" * 3000,
    "below a file": "r.urdf/r.urdf",
    "a lone surrogate": "\udc80.urdf",
    "empty": "",
}


@pytest.mark.parametrize("name", ODD_NAMES.values(), ids=ODD_NAMES)
def test_an_odd_name_is_a_source_error_in_one_line(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    Path("r.urdf").touch()
    with pytest.raises(SourceError) as caught:
        open_source(name)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("asked", "hint"),
    [
        ("robt.urdf", "did you mean 'robot.urdf'?"),
        ("Robot.urdf", "did you mean 'robot.urdf'?"),
        ("x", "check the path"),
        ("gone/robot.urdf", "check the path"),
    ],
)
def test_a_missing_file_is_answered_with_a_robot_file_of_nearly_its_name(tmp_path, asked, hint):
    for name in ("robot.urdf", "robt.txt", "secrets"):
        (tmp_path / name).touch()
    with pytest.raises(SourceError, match="there is no such file") as caught:
        open_source(str(tmp_path / asked))
    assert caught.value.remedy == hint
