"""`kinetostat diff`: exit codes, formats, revisions; hostile names; a pull request's three mistakes are said."""

import json
import os
import re
import shutil
import subprocess
from xml.etree import ElementTree as ET

import pytest

from difference_support import document, joint, put
from kinetostat.urdf.files import locate

PLANAR, PANDA = "textbook:planar_2r", "example:panda"


@pytest.fixture
def write(tmp_path):
    """Write a robot that ships, changed, beside nothing; return its path."""

    def call(source, change, name="after.urdf"):
        root = document(source)
        change(root)
        path = tmp_path / name
        path.write_text(ET.tostring(root, encoding="unicode"))
        return path

    return call


def longer(root):
    put(joint(root, "tool_joint"), "origin", xyz="0.802 0 0")


def test_nothing_changed_is_exit_0_and_a_few_lines(cli):
    answer = cli("diff", PANDA, "example:panda_collision")
    assert (answer.code, answer.err) == (0, "")
    assert "no change beyond the tolerance" in answer.out
    assert len(answer.out.splitlines()) < 12


def test_a_change_is_exit_1_and_said(cli, write):
    answer = cli("diff", PLANAR, write(PLANAR, longer))
    assert (answer.code, answer.err) == (1, "")
    text = " ".join(answer.out.split())
    assert "1 change; tips move by up to 0.002 m (tool)" in text
    assert "tool_joint joint position 0.8 0 0 -> 0.802 0 0 (by 0.002 m)" in text
    assert "at every joint position" in text
    assert "pinocchio and screw agree" in text


def test_the_tolerance_decides(cli, write):
    path = write(PLANAR, longer)
    assert cli("diff", PLANAR, path, "--tolerance", "0.003").code == 0
    assert cli("diff", PLANAR, path, "--tolerance", "0.001").code == 1
    assert cli("diff", PLANAR, path, "--tolerance", "-1").code == 2


@pytest.mark.parametrize("source", [("example:ur5_robot", "example:ur10_robot"), (PANDA, "example:solo12")])
def test_text_fits_the_page(cli, source):
    answer = cli("diff", *source)
    assert answer.code == 1
    assert max(map(len, answer.out.splitlines())) <= 80


def test_the_documented_keys(cli, write):
    answer = cli("diff", PLANAR, write(PLANAR, longer), "-F", "json")
    assert answer.code == 1
    payload = json.loads(answer.out, parse_constant=pytest.fail)
    assert payload["schema"] == "kinetostat/diff/1"
    assert payload["robot"]["source"] == PLANAR
    assert payload["other"]["source"].endswith("after.urdf")
    assert len(payload["other"]["sha256"]) == 64
    assert payload["crosscheck"]["agree"] is True
    result = payload["result"]
    assert result["exceeds"] is True
    (change,) = result["changes"]
    assert set(change) == {"kind", "element", "name", "attribute", "before", "after", "size", "unit"}
    assert (change["before"], change["after"], change["unit"]) == ([0.8, 0, 0], [0.802, 0, 0], "m")
    what = result["consequences"]
    assert set(what) == {
        "tips",
        "reach",
        "manipulability",
        "singular_families",
        "worst_gravity",
        "unchanged",
    }
    assert what["tips"]["tool"]["translation"]["value"] == pytest.approx(0.002)
    assert what["reach"]["tool"]["change"] == pytest.approx(0.002)
    assert what["worst_gravity"] == {}


def test_json_of_everything_at_once_is_sound(cli):
    for pair in (("example:ur5_robot", "example:ur10_robot"), (PANDA, "example:hyq_no_sensors")):
        answer = cli("diff", *pair, "-F", "json")
        assert answer.code == 1
        json.loads(answer.out, parse_constant=pytest.fail)


def test_results_go_to_a_file(cli, write, tmp_path):
    answer = cli("diff", PLANAR, write(PLANAR, longer), "-F", "markdown", "-o", tmp_path / "comment.md")
    assert (answer.code, answer.out) == (1, "")
    assert (tmp_path / "comment.md").read_text().startswith("### kinetostat diff: changed\n")


def test_standard_input_is_one_of_the_two(cli):
    text = locate(PLANAR).read_bytes()
    assert cli("diff", "-", PLANAR, stdin=text).code == 0
    assert cli("diff", PLANAR, "-", stdin=text).code == 0
    assert cli("diff", "-", "-", stdin=text).code == 2


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ((PLANAR, "nowhere.urdf"), 3),
        (("nowhere.urdf", PLANAR), 3),
        ((PLANAR,), 2),
        ((PLANAR, PLANAR, "-f", "nothing"), 2),
        ((PLANAR, PLANAR, "-F", "csv"), 2),
        ((PLANAR, "example:nothing"), 2),
        ((PLANAR, "nowhere:r.urdf"), 3),
    ],
)
def test_refusals(cli, words, code):
    answer = cli("diff", *words)
    assert (answer.code, answer.out) == (code, "")
    (line,) = answer.err.splitlines()
    assert line.startswith("kinetostat: error: ")


# --- a pull request --------------------------------------------------------------------------------------------------


def test_a_broken_mimic_is_said(cli, write):
    path = write(PANDA, lambda root: put(joint(root, "panda_finger_joint2"), "mimic", multiplier="-1"))
    text = " ".join(cli("diff", PANDA, path, "--tolerance", "1e-6").out.split())
    assert "mimic multiplier 1 -> -1 (by 2)" in text
    assert "panda_rightfinger 0.08 m" in text


def test_a_lowered_effort_limit_is_said(cli, write):
    path = write(PANDA, lambda root: put(joint(root, "panda_joint2"), "limit", effort="50"))
    text = " ".join(cli("diff", PANDA, path).out.split())
    assert "effort 87 -> 50 (by 37 Nm)" in text
    assert "weight alone now takes more than the effort limit of panda_joint2" in text
    assert re.search(r"65\.\d % -> 114 %", text)


def test_a_tool_moved_by_two_millimetres_is_said(cli, write):
    text = " ".join(cli("diff", PLANAR, write(PLANAR, longer)).out.split())
    assert "tips move by up to 0.002 m (tool)" in text


# --- revisions -------------------------------------------------------------------------------------------------------


@pytest.fixture
def repository(tmp_path, monkeypatch):
    if shutil.which("git") is None:
        pytest.skip("needs git")
    folder = tmp_path / "robots"
    folder.mkdir()
    identity = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    clean = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")} | identity

    def git(*words):
        subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True, env=clean)

    git("init", "-q")
    (folder / "arm.urdf").write_bytes(locate(PLANAR).read_bytes())
    (folder / "arm.srdf").write_text(
        '<robot name="planar_2r"><group_state name="home" group="arm"><joint name="joint1" value="1"/></group_state>'
        "</robot>"
    )
    (folder / "broken.urdf").write_text("<robot>")
    git("add", "-A")
    git("commit", "-q", "-m", "x")
    monkeypatch.chdir(folder)
    return folder


def test_a_revision_against_the_working_tree(cli, repository):
    assert cli("diff", "HEAD:arm.urdf", "arm.urdf").code == 0
    root = document(PLANAR)
    longer(root)
    (repository / "arm.urdf").write_text(ET.tostring(root, encoding="unicode"))
    answer = cli("diff", "HEAD:arm.urdf", "arm.urdf", "-F", "json")
    assert answer.code == 1
    payload = json.loads(answer.out)
    assert payload["robot"]["source"] == "HEAD:arm.urdf"
    assert [c["element"] for c in payload["result"]["changes"]] == ["joint"]  # the state is in both SRDFs


def test_an_error_at_a_revision_names_the_revision(cli, repository):
    answer = cli("diff", "HEAD:broken.urdf", "arm.urdf")
    assert answer.code == 3
    assert answer.err.startswith("kinetostat: error: HEAD:broken.urdf:1")
    assert "kinetostat-" not in answer.err


def test_verbose_names_what_was_read_at_a_revision(cli, repository):
    answer = cli("diff", "-v", "HEAD:arm.urdf", "arm.urdf")
    assert answer.code == 0
    assert "read: HEAD:arm.urdf, sha256 " in answer.err
    assert "read: HEAD:arm.srdf" in answer.err
    assert "kinetostat-" not in answer.err


# --- Markdown --------------------------------------------------------------------------------------------------------


def test_a_rename_is_seen_first_and_not_folded(cli, write):
    def change(root):
        joint(root, "joint2").set("name", "elbow_2")
        longer(root)

    out = cli("diff", PLANAR, write(PLANAR, change), "-F", "markdown").out
    assert out.index("| `joint2` | joint | `elbow_2` |") < out.index("**changes**") < out.index("<details>")
    assert "2 changes (1 rename); tips move by up to 0.002 m (`tool`)" in out


def test_units_and_parentheses_are_no_code(cli, write):
    def change(root):
        put(joint(root, "joint1"), "limit", effort="50")
        put(root.find("link[@name='link2']"), "inertial/inertia", izz="0.4")

    out = cli("diff", PLANAR, write(PLANAR, change), "-F", "markdown").out
    assert re.search(r"joint effort \| [\d.]+ → 50 \(by [\d.]+ Nm\) \|", out)
    assert re.search(r"\(by [\d.]+ kg m2\) \|", out)
    assert "`(" not in out
    assert ")`" not in out


def test_what_is_not_compared_is_said_in_every_format(cli, write):
    for form, where in (("table", "not compared: visuals"), ("markdown", "- not compared: visuals")):
        assert where in cli("diff", PLANAR, PLANAR, "-F", form).out
    notes = json.loads(cli("diff", PLANAR, PLANAR, "-F", "json").out)["result"]["notes"]
    assert any(note.startswith("not compared: visuals") for note in notes)


def test_numbers_in_a_row_are_told_apart_and_slight_ones_counted(cli, write):
    path = write(PANDA, lambda root: put(joint(root, "panda_joint2"), "limit", effort="87.00001"))
    out = " ".join(cli("diff", PANDA, path).out.split())
    assert "effort 87 -> 87.00001" in out
    assert "changed by less than 0.0001 of themselves" in out or "worst gravity torque: unchanged" in out
    for before, after in re.findall(r"(\S+) -> (\S+)", out):
        assert before != after


def test_tips_that_move_alike_are_one_row_with_all_names_in_json(cli, write):
    path = write(PANDA, lambda root: put(joint(root, "panda_joint7"), "origin", xyz="0.09 0 0"))
    out = " ".join(cli("diff", PANDA, path).out.split())
    assert "3 tips 0.002 m 0 rad at every joint position: panda_" in out
    tips = json.loads(cli("diff", PANDA, path, "-F", "json").out)["result"]["consequences"]["tips"]
    assert set(tips) == {"panda_hand_tcp", "panda_leftfinger", "panda_rightfinger"}


# --- hostile names ---------------------------------------------------------------------------------------------------

HOSTILE = (
    "a|b",
    "a`b",
    "``x``",
    "a\\|b",
    "<img src=x onerror=alert(1)>",
    "</details><script>",
    "@everyone",
    "[a](http://evil.example)",
    "![a](http://evil.example/x.png)",
    "http://evil.example",
    "www.evil.example",
    "# head",
    "**bold** _it_ ~~s~~",
    "line\nbreak",
    "| x | y |",
    "&lt;b&gt;",
    "&#124;",
    "<!-- -->",
    "$x$",
    "-->",
    "\u202eevil",
    "x" * 5000,
)


@pytest.fixture
def hostile(tmp_path):
    """Two robots with hostile names of links and joints, moved and renamed."""

    def text(x, last):
        robot = ET.Element("robot", name=HOSTILE[4])
        ET.SubElement(robot, "link", name="base")
        for i, name in enumerate((*HOSTILE, last)):
            element = ET.SubElement(robot, "joint", name=name, type="revolute")
            ET.SubElement(robot, "link", name=name)
            put(element, "parent", link="base")
            put(element, "child", link=name)
            put(element, "origin", xyz=f"{i} 0 {x}")
            put(element, "axis", xyz="0 1 0")
            put(element, "limit", lower="-1", upper="1", effort="1", velocity="1")
        put(robot[3], "mimic", joint=HOSTILE[0], multiplier=str(0.5 + x))
        return ET.tostring(robot, encoding="unicode")

    paths = tmp_path / "a.urdf", tmp_path / "b|`<b>.urdf"
    paths[0].write_text(text(0, "`|<i>"))
    paths[1].write_text(text(0.5, "|`</td>"))
    return paths


def test_hostile_names_are_no_markup(cli, hostile):
    markdown_it = pytest.importorskip("markdown_it")
    answer = cli("diff", *hostile, "-F", "markdown")
    assert answer.code == 1
    reader = markdown_it.MarkdownIt("commonmark").enable(["table", "strikethrough"])
    tokens = reader.parse(answer.out)
    inline = [child for token in tokens for child in token.children or ()]
    assert not {child.type for child in inline} & {"link_open", "image", "em_open", "s_open"}
    assert {child.content for child in inline if child.type == "html_inline"} == {"<code>", "</code>"}
    blocks = {token.content.strip() for token in tokens if token.type == "html_block"}
    assert all(re.fullmatch(r"</details>|<details><summary>[\w ,:()]*</summary>", block) for block in blocks)
    # Outside code nothing is left that GitHub would turn into a mention, a link, an issue or a formula.
    plain, in_code = [], False
    for child in inline:
        if child.type == "html_inline":
            in_code = child.content == "<code>"
        elif child.type != "code_inline" and not in_code:
            plain.append(child.content)
    assert not re.search(r"[@$<>~]|://|www\.|#", "".join(plain))
    assert len(answer.out) < 65_536


def test_every_row_of_a_table_has_its_columns(cli, hostile):
    """GFM drops cells that are too many: a name that held a column's end would show by its row's code being cut."""
    markdown_it = pytest.importorskip("markdown_it")
    answer = cli("diff", *hostile, "-F", "markdown")
    tokens = markdown_it.MarkdownIt("commonmark").enable("table").parse(answer.out)
    cells = [tokens[i + 1].content for i, token in enumerate(tokens) if token.type == "td_open"]
    rows = [line for line in answer.out.splitlines() if line.startswith("|")]
    tables = sum(token.type == "table_open" for token in tokens)
    assert len(rows) - 2 * tables == sum(token.type == "tr_open" for token in tokens) - tables
    assert len(rows) > len(HOSTILE)
    assert all(cell.count("`") % 2 == 0 and cell.count("<code>") == cell.count("</code>") for cell in cells)
    assert all(re.fullmatch(r"\| .*\|", line) for line in rows)


def test_hostile_names_on_a_terminal(cli, hostile):
    answer = cli("diff", *hostile)
    assert answer.code == 1
    assert all(line.isprintable() for line in answer.out.splitlines())
    assert max(map(len, answer.out.splitlines())) <= 80


def test_help_says_what_it_is(cli):
    answer = cli("diff", "--help")
    assert "Example: kinetostat diff example:panda example:panda_collision" in answer.out
