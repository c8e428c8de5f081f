"""What is too big or too odd to store: chains, stars, bombs, and things that are not files. As the real command."""

from __future__ import annotations

import gzip
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

import kinetostat as ks
from corpus.generated import arm, chain, joint, link, robot, star
from corpus.measured import Run, assert_clean, assert_one_line, assert_refused, kinetostat
from kinetostat_cli import main

MB = 1024 * 1024
QUESTIONS = ("info", "jacobian")


def ask(question: str, path: Path | str, frame: str = "b", **more: object) -> Run:
    """Ask `info`, or the Jacobian of a frame."""
    extra = [f"--frame={frame}"] if question == "jacobian" else []
    return kinetostat(question, path, *extra, **more)


def written(folder: Path, data: bytes, name: str = "robot.urdf") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


# --- deep and wide ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("depth", "kind", "limit"),
    [
        (401, "fixed", "401 links deep; at most 400 are read"),
        (500, "fixed", "500 links deep; at most 400 are read"),
        (500, "revolute", "500 links deep; at most 400 are read"),
        (1_000, "revolute", "1000 links deep; at most 400 are read"),
        (5_000, "fixed", "5000 links deep; at most 400 are read"),
        (5_000, "revolute", "5000 links deep; at most 400 are read"),
        (20_000, "fixed", "at most 400 are read"),
        (20_000, "revolute", "at most 400 are read"),
        (150_000, "fixed", "at most"),
        (150_000, "revolute", "at most"),
    ],
)
def test_a_chain_too_deep_is_refused_with_the_limit_named(tmp_path, depth, kind, limit):
    path = written(tmp_path, chain(depth, kind))
    assert_refused(ask("jacobian", path, f"l{depth - 1}"), str(path), limit)


@pytest.mark.parametrize("links", [5_000, 20_000])
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_star_is_answered(tmp_path, links, question):
    path = written(tmp_path, star(links))
    run = ask(question, path, f"l{links - 1}")
    assert_clean(run)
    assert run.exit_code == 0, run.err
    assert "agree" in run.out


def test_a_star_of_20000_links_is_read_in_3_seconds(tmp_path):
    path = written(tmp_path, star(20_000))
    start = time.process_time()
    loaded = ks.load(path)
    assert time.process_time() - start < 3
    assert len(loaded.robot.links) == 20_000


@pytest.mark.parametrize(
    ("data", "limit"),
    [
        pytest.param(star(20_001), "20001 links; at most 20000 are read", id="one link more than the limit"),
        pytest.param(star(100_000), "at most", id="star of 100,000"),
        pytest.param(robot(link(f"l{i}") for i in range(100_000)), "at most", id="100,000 links without joints"),
        pytest.param(
            star(302, "revolute"), "301 degrees of freedom; at most 300 are read", id="one degree of freedom too many"
        ),
        pytest.param(star(52, "floating"), "306 degrees of freedom; at most 300 are read", id="51 floating joints"),
    ],
)
def test_a_robot_beyond_a_limit_is_refused_with_the_limit_named(tmp_path, data, limit):
    path = written(tmp_path, data)
    assert_refused(ask("info", path), str(path), limit)


@pytest.mark.parametrize(
    ("data", "frame"),
    [
        pytest.param(chain(400), "l399", id="400 links deep, fixed"),
        pytest.param(chain(301, "revolute"), "l300", id="300 revolute joints in a chain"),
        pytest.param(chain(301, "continuous"), "l300", id="300 continuous joints in a chain"),
        pytest.param(star(301, "prismatic"), "l300", id="300 prismatic joints in a star"),
        pytest.param(chain(51, "floating"), "l50", id="50 floating joints in a chain"),
    ],
)
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_robot_just_inside_the_limits_is_answered(tmp_path, data, frame, question):
    run = ask(question, written(tmp_path, data), frame)
    assert_clean(run)
    assert run.exit_code == 0, run.err


def followers(links: int, deep: bool) -> bytes:
    """Return one revolute joint and followers of followers of it, in a chain or a star."""
    follow = [
        joint(f"j{i}", f"l{i - 1}" if deep else "l0", f"l{i}", "revolute", f'<mimic joint="j{i - 1}"/>')
        for i in range(2, links)
    ]
    return robot([link(f"l{i}") for i in range(links)] + [joint("j1", "l0", "l1", "revolute"), *follow])


@pytest.mark.parametrize(
    ("links", "deep"), [pytest.param(399, True, id="398 in a chain"), pytest.param(2_000, False, id="1,999 in a star")]
)
def test_followers_by_the_hundred_stay_in_time_and_memory(tmp_path, links, deep):
    """Pinocchio loads followers as independent joints, and what it allocates grows with the cube of their number."""
    run = ask("jacobian", written(tmp_path, followers(links, deep)), f"l{links - 1}")
    assert_clean(run)
    assert run.exit_code == 0 or "at most" in run.err


def test_20000_tips_at_the_end_of_the_longest_chain_stay_in_time_and_memory(tmp_path):
    """Every chain from root to tip is listed by `info`: their number times their length must not get out of hand."""
    links = [link(f"l{i}") for i in range(20_000)]
    joints = [joint(f"j{i}", f"l{i - 1}", f"l{i}", "revolute") for i in range(1, 301)]
    joints += [joint(f"j{i}", "l300", f"l{i}") for i in range(301, 20_000)]
    run = ask("info", written(tmp_path, robot(links + joints)))
    assert_clean(run, seconds=30.0)  # 4 on a machine that does nothing else; what gets out of hand takes minutes
    assert run.exit_code == 0, run.err


# --- big pieces ------------------------------------------------------------------------------------------------

ENTITIES = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 10))
EXPONENTIAL = f'<!DOCTYPE robot [<!ENTITY e0 "boom">{ENTITIES}]>\n'
QUADRATIC = f'<!DOCTYPE robot [<!ENTITY e "{"x" * 100_000}">]>\n'

BIG_BUT_FINE = [
    pytest.param(arm(f"<!--{'x' * 10 * MB}-->"), id="10 MB comment"),
    pytest.param(arm(f'<gazebo reference="{"x" * 10 * MB}"/>'), id="10 MB attribute"),
    pytest.param(arm("x" * 11 * MB), id="11 MB text"),
    pytest.param(arm(f"<![CDATA[{'<' * 10 * MB}]]>"), id="10 MB character data"),
    pytest.param(arm(f"<?note {'x' * 10 * MB}?>"), id="10 MB processing instruction"),
    pytest.param(arm("<t>" * 20_000 + "</t>" * 20_000), id="20,000 nested unknown elements"),
    pytest.param(arm("", "<t>" * 20_000 + "</t>" * 20_000), id="20,000 nested unknown elements in a link"),
    pytest.param(arm().replace(b"0 0 0.1", b"0 0 0." + b"1" * 10 * MB), id="10 MB of digits"),
    pytest.param(arm() + b"\n" * 10 * MB, id="10 MB of blank lines after the end"),
    pytest.param(b"\n" * 10 * MB + arm(head=""), id="10 MB of blank lines before the start"),
]

BIG_AND_REFUSED = [
    pytest.param(arm("&e9;", head=EXPONENTIAL), "DOCTYPE", id="exponential entities"),
    pytest.param(arm(f'<g a="{"&e;" * 10_000}"/>', head=QUADRATIC), "DOCTYPE", id="quadratic entities"),
    pytest.param(arm("&e9;"), "undefined entity", id="entity that is not defined"),
    pytest.param(arm(head='<!DOCTYPE robot SYSTEM "file:///etc/passwd">\n'), "DOCTYPE", id="outside entity"),
    pytest.param(gzip.compress(b" " * 200 * MB), "gzip archive", id="gzip bomb"),
    pytest.param(arm().replace(b"0 0 0.1", b"0 " * 5 * MB), "5242880 numbers, not 3", id="five million numbers"),
    pytest.param(arm().replace(b"0 0 0.1", b"0 0 " + b"1" * 10 * MB), "too large", id="number of ten million digits"),
    pytest.param(arm("<t>" * 200_000), "not well-formed", id="200,000 elements that never end"),
    pytest.param(arm().replace(b"revolute", b"r" * 10 * MB), "joint type", id="10 MB joint type"),
    pytest.param(
        arm().replace(b'child link="b"', b'child link="' + b"b" * 10 * MB + b'"'),
        "does not exist",
        id="10 MB link reference",
    ),
    pytest.param(arm(head='<?xml version="1.0" encoding="' + "x" * 100 + '"?>'), "encoding", id="100 letter encoding"),
    pytest.param(b"\0" * 10 * MB, "NUL", id="10 MB of zeros"),
    pytest.param(b"\xff" * 10 * MB, "0xff", id="10 MB of ones"),
    pytest.param(b" " * 10 * MB, "empty", id="10 MB of blanks"),
    pytest.param(b" " * 65 * MB, "more than 67108864 bytes", id="larger than the limit"),
]

# However they end: in time, in memory, in one line.
BIG_AND_ODD = [
    pytest.param(arm(head='<?xml version="1.0" encoding="' + "x" * 10 * MB + '"?>'), id="10 MB encoding"),
    pytest.param(arm("<a/>" * 4 * MB), id="four million elements"),
    pytest.param(arm("", "<visual/>" * 2 * MB), id="two million visuals"),
    pytest.param(arm("<t>" * 2_500_000 + "</t>" * 2_500_000), id="2.5 million nested elements"),
    pytest.param(arm("<a " + " ".join(f'a{i}=""' for i in range(2_000_000)) + "/>"), id="two million attributes"),
    pytest.param(arm().replace(b'<axis xyz="0 0 1"/>', b'<axis xyz="0 0 1"/>' * MB), id="a million axes"),
    pytest.param(
        arm("", "".join(f'<visual><geometry><mesh filename="m{i}"/></geometry></visual>' for i in range(100_000))),
        id="100,000 meshes",
    ),
    pytest.param(
        arm("", f'<visual><geometry><mesh filename="{"x" * 10 * MB}"/></geometry></visual>'), id="10 MB mesh name"
    ),
    pytest.param(
        arm("", f'<visual><geometry><mesh filename="{"x/" * 5_000}"/></geometry></visual>'),
        id="mesh 5,000 folders deep",
    ),
    pytest.param(
        arm("", f'<visual><geometry><mesh filename="package://{"x" * 5_000}/m.stl"/></geometry></visual>'),
        id="5,000 letter package",
    ),
    pytest.param(arm().replace(b'"made"', b'"' + b"r" * 10 * MB + b'"'), id="10 MB robot name"),
    pytest.param(arm().replace(b'"b"', b'"' + b"b" * MB + b'"'), id="1 MB link name"),
    pytest.param(arm().replace(b'"j1"', b'"' + b"j" * MB + b'"'), id="1 MB joint name"),
]


@pytest.mark.parametrize("data", BIG_BUT_FINE)
def test_a_big_piece_that_bears_on_nothing_is_fine(tmp_path, data):
    run = ask("jacobian", written(tmp_path, data))
    assert_clean(run)
    assert run.exit_code == 0, run.err


@pytest.mark.parametrize(("data", "why"), BIG_AND_REFUSED)
def test_a_bomb_is_refused_soon(tmp_path, data, why):
    path = written(tmp_path, data)
    assert_refused(ask("jacobian", path), str(path), why)


@pytest.mark.parametrize("data", BIG_AND_ODD)
def test_a_big_odd_file_stays_in_time_and_memory(tmp_path, data):
    path = written(tmp_path, data)
    run = ask("info", path)
    assert_clean(run)
    assert len(run.out) < 5 * MB
    if run.exit_code == 3:
        assert_one_line(run.err, str(path))


def test_a_megabyte_of_joint_name_does_not_hold_up_a_jacobian(tmp_path):
    path = written(tmp_path, arm().replace(b'"j1"', b'"' + b"j" * MB + b'"'))
    assert_clean(ask("jacobian", path, alarm=15))


# --- not files -------------------------------------------------------------------------------------------------


def folder(path: Path) -> None:
    path.mkdir()


def fifo(path: Path) -> None:
    os.mkfifo(path)


def nothing(path: Path) -> None:
    assert not path.exists()


def dangling_link(path: Path) -> None:
    path.symlink_to("gone.urdf")


def looping_link(path: Path) -> None:
    path.symlink_to(path.name)


def two_links_in_a_loop(path: Path) -> None:
    path.symlink_to("other.urdf")
    path.with_name("other.urdf").symlink_to(path.name)


def device_without_end(path: Path) -> None:
    path.symlink_to("/dev/zero")


def empty_device(path: Path) -> None:
    path.symlink_to("/dev/null")


def link_to_fifo(path: Path) -> None:
    os.mkfifo(path.with_suffix(".fifo"))
    path.symlink_to(path.with_suffix(".fifo"))


def empty_file(path: Path) -> None:
    path.touch()


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (folder, "a folder"),
        (fifo, "not a regular file"),
        (nothing, "no such file"),
        (dangling_link, "which is not there"),
        (looping_link, "symbolic links"),
        (two_links_in_a_loop, "symbolic links"),
        (device_without_end, "not a regular file"),
        (empty_device, "not a regular file"),
        (link_to_fifo, "not a regular file"),
        (empty_file, "empty"),
    ],
)
def test_what_is_not_a_robot_file_is_refused_at_once(tmp_path, make, why):
    path = tmp_path / "robot.urdf"
    make(path)
    run = ask("jacobian", path, alarm=10)
    assert run.elapsed < 5  # a FIFO would wait, not compute
    assert_refused(run, str(path), why)


def test_a_file_that_may_not_be_read_is_refused():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        fine, locked = written(Path(folder), arm(), "fine.urdf"), written(Path(folder), arm(), "locked.urdf")
        locked.chmod(0)
        program = "import os, sys; from kinetostat_cli import main; main.run(['info', sys.argv[1]]);"
        if os.geteuid() == 0:
            # Root reads everything, so it becomes nobody, when all that nobody could not import has been imported.
            program += "os.setgroups([]); os.setgid(65534); os.setuid(65534);"
        program += "sys.exit(main.run(['info', sys.argv[2]]))"
        done = subprocess.run(
            [sys.executable, "-c", program, fine, locked], capture_output=True, text=True, timeout=60, check=False
        )
    assert done.returncode == 3, done.stderr
    assert_one_line(done.stderr, str(locked))
    assert "may not be read" in done.stderr


@pytest.mark.parametrize(
    "name", ["", "\x1b[31m.urdf", "a\nb.urdf", "x" * 5_000, "no/such/folder.urdf", "a\0b", "é" * 300]
)
def test_an_impossible_name_is_refused_in_one_line(name, capsys):
    assert main.run(["info", name]) == 3
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "\x1b" not in err


@pytest.mark.parametrize(
    "name",
    [
        "with space.urdf",
        "accents éüñ 机器人.urdf",
        "UPPER.URDF",
        "none",
        "robot.xml",
        "quote'\".urdf",
        "a:b.urdf",
        "$(echo).urdf",
        "[red].urdf",
    ],
)
def test_any_name_of_a_file_is_fine(tmp_path, name):
    path = written(tmp_path, arm(), name)
    assert main.run(["info", str(path)]) == 0


@pytest.mark.parametrize("arguments", [["info", "--", "-dash.urdf"], ["info", "./-dash.urdf"]])
def test_a_name_with_a_leading_dash_is_fine(tmp_path, arguments):
    written(tmp_path, arm(), "-dash.urdf")
    run = kinetostat(*arguments, cwd=tmp_path)
    assert run.exit_code == 0, run.err


def test_a_name_in_another_encoding_is_fine(tmp_path):
    path = written(tmp_path, arm(), os.fsdecode(b"caf\xe9.urdf"))
    run = kinetostat("info", path)
    assert run.exit_code == 0, run.err


def test_a_link_to_a_robot_file_is_fine(tmp_path):
    written(tmp_path, arm())
    (tmp_path / "link.urdf").symlink_to("robot.urdf")
    assert main.run(["info", str(tmp_path / "link.urdf")]) == 0


# --- standard input --------------------------------------------------------------------------------------------


def test_a_robot_on_standard_input_is_answered():
    run = ask("jacobian", "-", stdin=arm())
    assert_clean(run)
    assert run.exit_code == 0, run.err


@pytest.mark.parametrize(
    ("data", "why"),
    [
        pytest.param(b"", "empty", id="empty"),
        pytest.param(b"hello", "not well-formed", id="not XML"),
        pytest.param(arm() + b" " * 64 * MB, "more than 67108864 bytes", id="too large"),
        pytest.param(gzip.compress(arm()), "gzip", id="gzip"),
    ],
)
def test_rubbish_on_standard_input_is_refused(data, why):
    assert_refused(ask("info", "-", stdin=data), "-", why)


def test_standard_input_without_end_is_refused():
    assert_refused(ask("info", "-", stdin=Path("/dev/zero")), "standard input", "more than 67108864 bytes")


def test_standard_input_larger_than_asked_for_is_refused():
    assert_refused(kinetostat("info", "-", "--max-bytes=100", stdin=arm()), "standard input", "more than 100 bytes")


def test_a_closed_standard_input_is_refused():
    """Started by cron or a daemon, a process may have no standard input at all."""
    shell = shutil.which("sh")
    assert shell is not None
    command = f'exec "{sys.executable}" -m kinetostat_cli info - <&-'
    done = subprocess.run([shell, "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr.count("\n"), "Traceback" in done.stderr) == (3, 1, False), done.stderr


def test_meshes_of_a_robot_on_standard_input_lead_nowhere_without_a_fault():
    data = arm("", '<visual><geometry><mesh filename="meshes/a.stl"/></geometry></visual>')
    run = ask("info", "-", stdin=data)
    assert run.exit_code == 0, run.err
    assert "nothing is odd about the file" in run.out  # there is no folder to look in
