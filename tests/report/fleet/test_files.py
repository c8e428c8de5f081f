"""The files of a report: the same bytes for the same report, whole or not at all, and nowhere else."""

from __future__ import annotations

import errno
import io
import json
from contextlib import contextmanager

import msgspec
import pytest

from kinetostat.errors import UsageError
from kinetostat.report.fleet import files, markdown, page
from kinetostat.report.fleet.document import FleetDocument
from kinetostat.report.fleet.files import NAMES, json_text, prepared, write_fleet
from report.check_reports import HOSTILE
from report.fleet.fleet_reports import described, failed, fleet_of


def report():
    return fleet_of(described("textbook:planar_2r_6_3"), failed())


# --- report.json ---------------------------------------------------------------------------------------------------


def test_the_json_reads_back_as_the_document():
    assert msgspec.json.decode(json_text(report()), type=FleetDocument) == report()


def test_numbers_that_there_are_not_become_null():
    robot = msgspec.structs.replace(described("textbook:planar_2r_6_3"), mass=float("nan"), reach=float("inf"))
    text = json_text(fleet_of(robot))
    assert "NaN" not in text
    assert "Infinity" not in text
    assert json.loads(text)["robots"][0]["mass"] is None


def test_hostile_names_are_text():
    name = HOSTILE.encode("utf-8", "replace").decode()
    text = json_text(fleet_of(msgspec.structs.replace(described("textbook:planar_2r_6_3"), name=name)))
    assert all(line.isprintable() for line in text.split("\n"))
    assert json.loads(text)["robots"][0]["name"] == name


def test_it_is_indented_and_ends_with_a_line():
    lines = json_text(report()).split("\n")
    assert lines[:2] == ["{", ' "schema": "kinetostat/report/1",']
    assert lines[-2:] == ["}", ""]


# --- the folder ----------------------------------------------------------------------------------------------------


def test_all_four_files_are_written_the_page_last(tmp_path, monkeypatch):
    order, whole = [], files.open_whole

    @contextmanager
    def noted(path):
        with whole(path) as file:
            yield file
        order.append(path.name)

    monkeypatch.setattr(files, "open_whole", noted)
    folder = tmp_path / "new" / "deeper"
    written = write_fleet(folder, report(), {})
    assert sorted(path.name for path in folder.iterdir()) == sorted(NAMES) == sorted(path.name for path in written)
    assert order[-1] == "index.html"
    assert (folder / "report.json").read_text(encoding="utf-8") == json_text(report())
    assert (folder / "index.html").read_text(encoding="utf-8").lower().startswith("<!doctype html>")


@pytest.mark.parametrize("full", NAMES)
def test_where_one_does_not_fit_on_the_disk_all_stay_as_they_were(tmp_path, monkeypatch, full):
    for name in NAMES:
        (tmp_path / name).write_text("old")
    whole = files.open_whole

    class Full(io.BytesIO):
        def flush(self):
            raise OSError(errno.ENOSPC, "No space left on device")

    @contextmanager
    def filling(path):
        with whole(path) as file:
            yield Full() if path.name == full else file

    monkeypatch.setattr(files, "open_whole", filling)
    with pytest.raises(UsageError, match="No space left"):
        write_fleet(tmp_path, report(), {})
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == dict.fromkeys(NAMES, "old")


def test_the_same_report_gives_the_same_bytes_over_an_old_one(tmp_path):
    first, second = tmp_path / "a", tmp_path / "b"
    write_fleet(first, report(), {})
    write_fleet(second, fleet_of(failed()), {})
    write_fleet(second, report(), {})
    for name in NAMES:
        assert (first / name).read_bytes() == (second / name).read_bytes()


@pytest.mark.parametrize("module", [page, markdown])
def test_nothing_is_written_where_a_text_cannot_be_made(tmp_path, monkeypatch, module):
    def broken(*_):
        raise RuntimeError("no")

    monkeypatch.setattr(module, module.__name__.rpartition(".")[2], broken)
    with pytest.raises(RuntimeError):
        write_fleet(tmp_path, report(), {})
    assert not list(tmp_path.iterdir())


def test_other_files_of_the_folder_stay(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    write_fleet(tmp_path, report(), {})
    assert (tmp_path / "notes.txt").read_text() == "mine"


def a_file(folder):
    folder.write_text("mine")


def a_file_above(folder):
    folder.parent.write_text("mine")


@pytest.mark.parametrize("spoil", [a_file, a_file_above])
def test_a_file_in_the_way_is_refused_and_stays(tmp_path, spoil):
    folder = tmp_path / "above" / "report" if spoil is a_file_above else tmp_path / "report"
    spoil(folder)
    with pytest.raises(UsageError, match=r"folder|directory") as refused:
        write_fleet(folder, report(), {})
    assert "\n" not in str(refused.value)
    assert refused.value.remedy
    kept = folder.parent if spoil is a_file_above else folder
    assert kept.read_text() == "mine"


@pytest.mark.parametrize("folder", ["/proc", "/proc/report"])
def test_a_folder_that_takes_no_files_is_refused_before_anything_is_made(folder, monkeypatch):
    from pathlib import Path

    monkeypatch.setattr(files, "json_text", lambda _: pytest.fail("it was made"))
    with pytest.raises(UsageError, match="cannot write into '/proc"):
        write_fleet(Path(folder), report(), {})


def test_a_name_that_no_file_system_takes_is_refused(tmp_path):
    for name in ("a\0b", "n" * 5000):
        with pytest.raises(UsageError, match="cannot write into"):
            prepared(tmp_path / name)


@pytest.mark.parametrize("name", NAMES)
def test_a_folder_or_a_link_under_one_of_the_names_is_refused(tmp_path, name):
    elsewhere = tmp_path / "elsewhere.txt"
    elsewhere.write_text("mine")
    linked, nested, dangling = tmp_path / "linked", tmp_path / "nested", tmp_path / "dangling"
    for folder in (linked, nested, dangling):
        folder.mkdir()
    (linked / name).symlink_to(elsewhere)
    (nested / name).mkdir()
    (dangling / name).symlink_to(tmp_path / "nothing")
    for folder in (linked, nested, dangling):
        with pytest.raises(UsageError, match="folder, a link or a device"):
            write_fleet(folder, report(), {})
        assert [path.name for path in folder.iterdir()] == [name]
    assert elsewhere.read_text() == "mine"
    assert not (tmp_path / "nothing").exists()


def test_a_link_to_a_folder_is_a_folder(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_fleet(tmp_path / "link", report(), {})
    assert sorted(path.name for path in (tmp_path / "real").iterdir()) == sorted(NAMES)
