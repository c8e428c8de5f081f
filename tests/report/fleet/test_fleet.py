"""A fleet: which robots, in which order, in how many processes; what is written."""

import json

import pytest

import kinetostat as ks
from kinetostat.policy.settings import read_settings
from kinetostat.report.fleet import fleet as module
from kinetostat.report.fleet.fleet import fleet
from report.fleet.robots import chain, misbehave, robot

TEXTBOOK = ["textbook:rp", "textbook:planar_2r"]


@pytest.fixture(autouse=True)
def stamped(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.urdf").write_text(chain("revolute", 2))
    (tmp_path / "b.urdf").write_text(chain("prismatic"))
    return tmp_path


def paths_of(found):
    return [robot.path for robot in found.document.robots]


def test_robots_come_in_the_order_in_which_they_are_asked_for():
    found = fleet(TEXTBOOK, samples=20)
    assert paths_of(found) == TEXTBOOK
    assert [robot.id for robot in found.document.robots] == ["r1", "r2"]
    assert [chain.id for robot in found.document.robots for chain in robot.chains] == ["r1-1", "r2-1"]
    assert found.document.made == "2023-11-14T22:13:20Z"
    assert found.document.version == ks.__version__
    assert repr(found) == "<Fleet: 2 robots, 2 chains>"
    assert repr(fleet(TEXTBOOK[:1], samples=20)) == "<Fleet: 1 robot, 1 chain>"


def test_the_number_of_processes_changes_nothing(tmp_path):
    names = [*TEXTBOOK, "example:nobody"]
    texts = []
    for jobs in (None, 1, 2):
        files = fleet(names, samples=20, jobs=jobs).write(tmp_path / str(jobs))
        texts.append({file.name: file.read_bytes() for file in files})
    assert texts[0] == texts[1] == texts[2]
    assert set(texts[0]) == {"index.html", "report.json", "robots.csv", "report.md"}


def test_a_robot_that_is_meant_twice_is_told_once(here):
    (here / "link.urdf").symlink_to(here / "a.urdf")
    found = fleet(["a.urdf", "./a.urdf", str(here / "a.urdf"), "b.urdf", "link.urdf", "a.urdf"], samples=20)
    assert paths_of(found) == ["a.urdf", "b.urdf", "link.urdf"]


def test_what_dies_hangs_or_has_a_bug_is_told_and_the_others_are_reported(here, monkeypatch):
    for name in ("dies", "hangs", "bug"):
        (here / f"{name}.urdf").write_text(robot())
    monkeypatch.setattr(module, "report_robot", misbehave)
    told, seen = [], set()
    found = fleet(
        ["dies.urdf", "a.urdf", "hangs.urdf", "bug.urdf", "b.urdf"],
        samples=20,
        jobs=2,
        timeout=8,
        done=lambda robot, count: told.append((robot.path, count)),
        at_work=seen.update,
    )
    assert [robot.status for robot in found.document.robots] == ["crashed", "done", "crashed", "crashed", "done"]
    reasons = [robot.reason for robot in found.document.robots]
    assert "SIGSEGV" in reasons[0]
    assert "no answer within 8 s" in reasons[2]
    assert "no figure" in reasons[3]
    assert sorted(told) == sorted((path, 5) for path in paths_of(found))
    assert "hangs.urdf" in seen
    assert told[-1] == ("hangs.urdf", 5)
    found.write(here / "out")
    assert [robot["status"] for robot in json.loads((here / "out" / "report.json").read_text())["robots"]] == [
        robot.status for robot in found.document.robots
    ]


def test_without_a_path_it_is_all_in_the_folder_and_what_the_settings_name(here):
    (here / "kinetostat.toml").write_text(
        '[[robots]]\npath = "textbook:planar_2r"\n[[robots.chains]]\nframe = "link2"\nname = "lower arm"\n'
    )
    found = fleet(settings=read_settings(here / "kinetostat.toml"), samples=20)
    assert paths_of(found) == ["a.urdf", "b.urdf", "textbook:planar_2r"]
    (lower,) = found.document.robots[2].chains
    assert (lower.name, lower.frame, lower.found) == ("lower arm", "link2", "settings")


def test_the_settings_say_what_fails(here):
    (here / "kinetostat.toml").write_text(
        '[[robots]]\npath = "a.urdf"\n[[robots.expect]]\nkind = "mass"\nat-most = 0.5\n'
    )
    (found,) = fleet(["a.urdf"], settings=read_settings(here / "kinetostat.toml"), samples=20).document.robots
    assert found.verdict == "fail"
    assert found.expectations[0].met is False


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        ({"samples": 0}, "samples"),
        ({"samples": 10_000_000}, "samples"),
        ({"seed": -1}, "seed"),
        ({"payload": -1.0}, "payload"),
        ({"payload": float("nan")}, "payload"),
        ({"jobs": 0}, "process"),
        ({"timeout": 0.0}, "timeout"),
    ],
)
def test_what_cannot_be_asked_is_refused(wrong, word):
    with pytest.raises(ks.UsageError, match=word):
        fleet(TEXTBOOK, **wrong)


def test_one_path_that_is_no_list_is_refused():
    with pytest.raises(ks.UsageError, match="list of paths"):
        fleet("textbook:planar_2r")


def test_nothing_is_no_fleet(tmp_path):
    with pytest.raises(ks.SourceError, match="no robot"):
        fleet([tmp_path])
