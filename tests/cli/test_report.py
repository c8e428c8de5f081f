"""`kinetostat report`: what is written, said and answered; Ctrl-C and SIGTERM leave nothing half."""

import json
import os
import signal
import subprocess
import sys

import msgspec
import pytest

import kinetostat as ks
from kinetostat.report.fleet import fleet as module
from processes import descendants, runs, wait_for
from report.fleet.robots import chain

FILES = ["index.html", "report.json", "report.md", "robots.csv"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    (tmp_path / "arm.urdf").write_text(chain("revolute", 2))
    return tmp_path


def robots_end(file):
    """Return the only tip of a robot."""
    return ks.load(file).robot.default_tip()


def robots(folder):
    return json.loads((folder / "report.json").read_text())["robots"]


def test_the_four_files_are_written_and_the_page_is_named(cli, here):
    found = cli("report", "arm.urdf", "-o", "out/deep", "--samples", "20", "--payload", "0.5", "--seed", "3")
    assert found.code == 0, found.err
    assert found.out == "out/deep/index.html\n"
    assert sorted(path.name for path in (here / "out" / "deep").iterdir()) == FILES
    (line,) = found.err.splitlines()
    assert line.startswith("kinetostat: note: out/deep: 1 robot, 1 chain; ")
    assert "numbers computed twice, in " in line
    written = json.loads((here / "out" / "deep" / "report.json").read_text())
    assert (written["samples"], written["seed"], written["payload"]) == (20, 3, 0.5)


def test_findings_and_unmet_expectations_do_not_count(cli, here):
    (here / "kinetostat.toml").write_text(
        '[[robots]]\npath = "arm.urdf"\n[[robots.expect]]\nkind = "mass"\nat-most = 0.5\n'
    )
    found = cli("report", "-o", "out", "--samples", "20")
    assert found.code == 0, found.err
    assert robots(here / "out")[0]["verdict"] == "fail"
    assert "1 fails check" in found.err
    assert cli("report", "-o", "out", "--samples", "20", "--no-settings").code == 0
    assert robots(here / "out")[0]["verdict"] == "pass"


def test_a_robot_that_cannot_be_read_is_in_it_and_is_exit_3(cli, here):
    (here / "text.urdf").write_text("no XML")
    found = cli("report", "text.urdf", "arm.urdf", "-o", "out", "--samples", "20")
    assert found.code == 3
    assert found.out == "out/index.html\n"
    assert found.err.startswith("kinetostat: error: text.urdf:1: ")
    assert [robot["status"] for robot in robots(here / "out")] == ["unreadable", "done"]


def test_a_chain_that_a_robot_does_not_have_is_told_with_its_line_and_is_exit_2(cli, here):
    entry = '[[robots]]\npath = "arm.urdf"\n[[robots.chains]]\nframe = "{}"\n[[robots.chains]]\nframe = "{}"\n'
    end = robots_end(here / "arm.urdf")
    (here / "kinetostat.toml").write_text(entry.format(end, "el\\u001bbow"))
    found = cli("report", "-o", "out", "--samples", "20")
    assert found.code == 2
    assert found.out == "out/index.html\n"
    slip, _ = found.err.splitlines()
    assert slip.startswith("kinetostat: error: arm.urdf: chain 'el\\x1bbow' (kinetostat.toml:5): there is no frame ")
    (robot,) = robots(here / "out")
    assert (robot["status"], [chain["frame"] for chain in robot["chains"]]) == ("done", [end])
    assert [left["place"] for left in robot["left"] if left["place"]] == ["kinetostat.toml:5"]
    (here / "text.urdf").write_text("no XML")
    assert cli("report", "-o", "out", "--samples", "20").code == 3


def test_a_robot_that_takes_too_long_is_exit_3(cli, here):
    found = cli("report", "example:talos_full_v2", "-o", "out", "--samples", "1000k", "--timeout", "0.1")
    assert found.code == 3
    assert "example:talos_full_v2: no answer within 0.1 s (--timeout)" in found.err
    assert robots(here / "out")[0]["status"] == "crashed"


def test_engines_that_disagree_are_exit_4_even_where_a_robot_is_missing(cli, here, monkeypatch):
    fleet = module.fleet

    def apart(*given, **asked):
        found = fleet(*given, **asked)
        one, other = found.document.robots
        certificate = msgspec.structs.replace(one.certificate, agree=False)
        document = msgspec.structs.replace(
            found.document, robots=(msgspec.structs.replace(one, certificate=certificate), other)
        )
        return module.Fleet(document, found.drawings)

    monkeypatch.setattr(module, "fleet", apart)
    (here / "text.urdf").write_text("no XML")
    found = cli("report", "arm.urdf", "text.urdf", "-o", "out", "--samples", "20")
    assert found.code == 4
    assert "arm.urdf: the engines disagree" in found.err
    assert "text.urdf" in found.err
    assert (here / "out" / "index.html").exists()


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["arm.urdf"], "for instance -o report"),
        (["arm.urdf", "-o", ""], "for instance -o report"),
        (["arm.urdf", "-o", "-"], "for instance -o report"),
        (["arm.urdf", "-o", "arm.urdf"], "not a folder"),
        (["arm.urdf", "-o", "arm.urdf/below"], "arm.urdf"),
        (["arm.urdf", "-o", "out", "--samples", "few"], "--samples"),
        (["arm.urdf", "-o", "out", "--samples", "2M"], "samples"),
        (["arm.urdf", "-o", "out", "--payload", "-1"], "--payload"),
        (["arm.urdf", "-o", "out", "--settings", "gone.toml"], "gone.toml"),
    ],
)
def test_what_cannot_be_asked_is_exit_2_in_a_line(cli, here, arguments, word):
    found = cli("report", *arguments)
    assert found.code == 2
    assert word in found.err
    assert len(found.err.splitlines()) == 1
    assert found.out == ""
    assert not list(here.rglob("index.html"))


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--srdf", "gone.srdf"], "gone.srdf: there is no such file"),
        (["--srdf", "."], "a folder, not a file"),
        (["--package-dir", "gone"], "gone: there is no such folder"),
    ],
)
def test_what_is_named_and_not_there_is_exit_3_before_anything_is_computed(cli, here, arguments, word):
    for command in (["report", "arm.urdf", "-o", "out"], ["check", "arm.urdf"]):
        found = cli(*command, *arguments)
        assert found.code == 3
        assert word in found.err
        assert found.out == ""
    assert not list(here.rglob("index.html"))


@pytest.mark.skipif(sys.platform == "win32", reason="a shell closes standard output")
def test_where_its_path_cannot_be_printed_it_is_said_that_the_report_is_there(here):
    command = f'{sys.executable} -c "from kinetostat_cli.main import main; main()" report arm.urdf -o out --samples 20'
    found = subprocess.run(["/bin/sh", "-c", f"{command} >&-"], stderr=subprocess.PIPE, text=True, check=False)
    assert found.returncode == 2
    assert "'out/index.html' is written, but not its path: cannot write to standard output" in found.stderr
    assert (here / "out" / "index.html").exists()


def test_nothing_to_report_is_exit_3(cli, here):
    assert cli("report", "gone.urdf", "-o", "out").code == 3
    assert not list(here.rglob("index.html"))


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
def test_ctrl_c_while_its_processes_start_is_told_once(here):
    program = "from kinetostat_cli.main import main; main()"
    asking = subprocess.Popen(
        [sys.executable, "-c", program, "report", "textbook:planar_2r", "-o", "out"],
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert wait_for(lambda: len(descendants(asking.pid)) >= 2)  # the tracker, and the processes' parent
    os.killpg(asking.pid, signal.SIGINT)  # as a terminal does: all of them
    _, told = asking.communicate(timeout=60)
    assert (asking.returncode, told.decode()) == (130, "kinetostat: interrupted\n")


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
@pytest.mark.parametrize(("stop", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_when_it_is_stopped_its_processes_end_and_nothing_is_written(here, stop, code):
    program = "from kinetostat_cli.main import main; main()"
    words = ["report", "example:talos_full_v2", "example:icub", "-o", "out", "--samples", "1000k", "-j", "2"]
    asking = subprocess.Popen([sys.executable, "-c", program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    started = wait_for(lambda: len(descendants(asking.pid)) >= 4)  # the processes' parent, a tracker, and two
    assert started, asking.communicate(timeout=1)
    children = descendants(asking.pid)
    asking.send_signal(stop)
    out, told = asking.communicate(timeout=60)
    assert asking.returncode == code
    assert out == b""
    assert told.decode().strip() == ("kinetostat: interrupted" if stop is signal.SIGINT else "")
    assert wait_for(lambda: not any(map(runs, children)))
    assert list((here / "out").iterdir()) == []
