"""One robot of the report: what is told of it, whatever it is, and which pictures there are."""

import pickle
import re
from xml.etree import ElementTree as ET

import pytest

import kinetostat as ks
from kinetostat.analysis.profile import profiling
from kinetostat.analysis.profile.anatomy import ChosenChain
from kinetostat.gate.baseline import baseline_text, read_baseline
from kinetostat.gate.checking import Task
from kinetostat.gate.pool import run_all
from kinetostat.report.fleet import drawings as module
from kinetostat.report.fleet.working import FleetTask, crashed_robot, report_robot
from report.fleet.robots import EDGES, LIMIT, chain, misbehave

SAMPLES = 50


def reported(path, chains=(), **asked):
    return report_robot(FleetTask("r1", Task(str(path), samples=2, chains=chains), samples=SAMPLES, **asked))


@pytest.fixture(scope="module", params=EDGES)
def edge(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("edge") / "robot.urdf"
    path.write_text(EDGES[request.param], encoding="utf-8")
    return reported(path, payload=1.0)


def test_every_robot_is_done_and_its_engines_agree(edge):
    assert (edge.document.status, edge.document.reason) == ("done", "")
    assert edge.document.certificate is None or edge.document.certificate.agree is not False


def test_pictures_are_of_what_there_is(edge):
    chains = {chain.id for chain in edge.document.chains}
    assert "r1/tree" in edge.drawings
    assert {key.partition("/")[0] for key in edge.drawings} <= {"r1", *chains}
    for chain_ in edge.document.chains:
        same = any(row.what == "histograms" for row in chain_.left)
        assert (f"{chain_.id}/distributions" in edge.drawings) == (bool(chain_.distributions) and not same)
        assert not same or all(row.maximum - row.minimum <= 0.01 * abs(row.maximum) for row in chain_.distributions)
        assert (f"{chain_.id}/poses" in edge.drawings) == bool(chain_.poses)
        assert (f"{chain_.id}/reach" in edge.drawings) == (f"{chain_.id}/thumbnail" in edge.drawings)


def test_a_picture_is_an_svg_with_a_sentence_that_says_what_it_shows(edge):
    for key, drawing in edge.drawings.items():
        assert ET.fromstring(drawing.svg).tag.endswith("svg")
        assert drawing.alt.endswith(".")
        assert drawing.alt.isprintable()
        assert len(drawing.alt) < 600
        assert (drawing.metres > 0) == key.endswith("/thumbnail")


def test_ids_are_unique_in_the_page(edge):
    ids = [one for drawing in edge.drawings.values() for one in re.findall(r'\bid="([^"]*)"', drawing.svg)]
    assert len(ids) == len(set(ids))


def test_a_page_travels(edge):
    again = pickle.loads(pickle.dumps(edge))
    assert again.document == edge.document
    assert again.drawings == edge.drawings


def test_the_same_robot_gives_the_same_page():
    one, other = reported("textbook:planar_2r"), reported("textbook:planar_2r")
    assert one.document == other.document
    assert one.drawings == other.drawings


@pytest.mark.parametrize(
    ("text", "line", "word"),
    [
        ("no XML", 1, "XML"),
        ("<robot>\n<link/></robot>", 2, "name"),
        ('<robot name="r">\n<link name="a"/><link name="b"/>\n</robot>', 1, "parent"),
        (chain("revolute", limit=LIMIT.replace("1.5", "nan")), 2, "nan"),
    ],
)
def test_a_file_that_cannot_be_read_is_told_with_file_line_and_findings(tmp_path, text, line, word):
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    page = reported(path)
    assert page.document.status == "unreadable"
    assert page.document.reason.startswith(f"{path}:{line}: ")
    assert word in page.document.reason
    assert "\n" not in page.document.reason
    assert page.document.verdict == "fail"
    assert page.document.findings
    assert not page.document.chains
    assert not page.drawings


def test_a_file_that_is_not_there(tmp_path):
    page = reported(tmp_path / "gone.urdf")
    assert page.document.status == "unreadable"
    assert "gone.urdf" in page.document.reason


def test_a_robot_that_an_engine_refuses_is_told_with_the_reason(monkeypatch):
    def refuse(*_, **__):
        raise ks.EngineError("too many joints", file="arm.urdf")

    monkeypatch.setattr(profiling, "profile", refuse)
    page = reported("textbook:planar_2r")
    assert (page.document.status, page.document.reason) == ("unreadable", "arm.urdf: too many joints")
    assert page.document.verdict == "fail"


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (ChosenChain("link9", place="k.toml:7"), "there is no frame 'link9' (did you mean 'link2'"),
        (ChosenChain("link2", "bass", place="k.toml:7"), "did you mean 'base'"),
        (ChosenChain("base", "base", place="k.toml:7"), "no joint moves 'base' relative to 'base'"),
        (ChosenChain("link2", name="tool", place="k.toml:7"), "two chains are called 'tool'"),
    ],
)
def test_a_chain_of_the_settings_that_cannot_be_costs_itself_alone(wrong, why):
    page = reported("textbook:planar_2r", chains=(ChosenChain("tool"), wrong))
    assert page.document.status == "done"
    assert [(chain.frame, chain.found) for chain in page.document.chains] == [("tool", "settings")]
    (slip,) = (left for left in page.document.left if left.place)
    assert slip.what == f"chain '{wrong.name or wrong.frame}' (k.toml:7)"
    assert why in slip.why


def test_where_no_chain_of_the_settings_can_be_limbs_are_found_and_that_is_said():
    page = reported("textbook:planar_2r", chains=(ChosenChain("link9"), ChosenChain("base")))
    assert [chain.found for chain in page.document.chains] == ["tip"]
    assert [left.what for left in page.document.left][:3] == ["chain 'link9'", "chain 'base'", "chains of the settings"]
    assert "found instead" in page.document.left[2].why


def test_a_picture_that_fails_is_a_bug_and_takes_nothing_down_in_silence(monkeypatch):
    def fail(*_):
        raise ValueError("no picture")

    monkeypatch.setattr(module, "robot_drawings", fail)
    with pytest.raises(ValueError, match="no picture"):
        reported("textbook:planar_2r")
    (page,) = run_all([FleetTask("r1", Task("bug.urdf"))], misbehave, crashed_robot, jobs=1, timeout=60)
    assert page.document.status == "crashed"
    assert page.document.verdict == "crashed"
    assert page.document.reason == "a bug in kinetostat: ValueError: no figure\\x1b[31m"
    assert not page.drawings


def test_findings_that_a_baseline_knows_do_not_count(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(chain("revolute", limit='<limit lower="1" upper="-1" effort="1" velocity="1"/>'))
    before = ks.check([path])
    (tmp_path / "known.json").write_text(baseline_text(before.files, tmp_path))
    known = read_baseline(tmp_path / "known.json")
    assert reported(path).document.verdict == "fail"
    page = reported(path, known=known, known_from=tmp_path)
    assert page.document.verdict == "pass"
    assert not page.document.findings
    assert any("baseline" in left.why for left in page.document.left)
