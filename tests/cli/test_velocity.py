"""`kinetostat velocity`: pages, keys, CSV, refusals, and what stands where a screw has no axis."""

import csv
import io
import json
import re

import pytest

from textbook_support import assert_same

PLANAR = ("textbook:planar_2r", "-q", "0.3,0.7", "--qdot", "1,0.5")
HELICAL = ("textbook:helical", "-q", "1", "--qdot", "3")
PUMA = ("textbook:puma560", "-q", "random:1", "--qdot", "1,-2,3,0.4,0.5,-0.6")
TALOS = ("example:talos_full_v2", "--base", "floating", "-q", "random:3")
PUSHED = ("--qddot", "0.1,-0.2")


@pytest.fixture
def ask(cli):
    """Return the result that is written, read strictly: no NaN, no Infinity."""

    def call(*words):
        answer = cli("velocity", *words, "-F", "json")
        assert answer.code == 0, answer.err
        payload = json.loads(answer.out, parse_constant=pytest.fail)
        assert payload["schema"] == "kinetostat/velocity/1"
        assert payload["crosscheck"]["agree"] is True
        return payload["result"]

    return call


@pytest.fixture
def refused(cli):
    """Return the one line that refuses a command line."""

    def call(*words):
        answer = cli("velocity", *words)
        assert (answer.code, answer.out) == (2, "")
        (line,) = answer.err.splitlines()
        assert line.startswith("kinetostat: error: ")
        return line

    return call


def table(cli, *words):
    answer = cli("velocity", *words)
    assert answer.code == 0, answer.err
    return answer.out


# --- JSON ----------------------------------------------------------------------------------------------------------


def test_the_documented_keys(ask):
    result = ask(*PLANAR)
    assert (result["relative_to"], result["expressed_in"]) == ("base", "base")
    assert result["rows"] == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert result["row_units"] == ["m/s"] * 3 + ["rad/s"] * 3
    assert (result["columns"], result["rates"]) == (["joint1", "joint2"], [1, 0.5])
    assert list(result["links"]) == ["base", "link1", "link2", "tool"]
    for link in result["links"].values():
        assert set(link) == {"twist", "body_twist", "origin", "screw"}
        assert len(link["twist"]) == len(link["body_twist"]) == 6
        assert set(link["screw"]) >= {"motion", "axis", "point", "pitch", "rate", "speed"}
    pushed = ask(*PLANAR, *PUSHED)
    assert pushed["accelerations"] == [0.1, -0.2]
    for link in pushed["links"].values():
        assert len(link["spatial_acceleration"]) == len(link["classical_acceleration"]) == 6


def test_nulls_have_reasons(ask):
    links = ask("textbook:planar_2r", "--qdot", "1,-1")["links"]
    rest, turn, slide = (links[name]["screw"] for name in ("base", "link1", "tool"))
    assert [screw["motion"] for screw in (rest, turn, slide)] == ["rest", "rotation", "translation"]
    assert (rest["axis"], rest["point"], rest["pitch"]) == (None, None, None)
    assert "at rest" in rest["reason"]
    assert "reason" not in turn
    assert None not in (turn["axis"], turn["point"], turn["pitch"])
    assert (slide["axis"], slide["point"], slide["pitch"]) == ([0, 1, 0], None, None)
    assert "infinite" in slide["reason"]
    assert slide["speed"] == 1


def test_the_order_of_rows(ask):
    plain, turned = (
        ask(*PUMA, "--qddot", "1,2,3,4,5,6"),
        ask(*PUMA, "--qddot", "1,2,3,4,5,6", "--order", "angular-first"),
    )
    assert turned["rows"] == ["wx", "wy", "wz", "vx", "vy", "vz"]
    assert turned["acceleration_rows"][0] == "alphax"
    for name, link in plain["links"].items():
        for key in ("twist", "body_twist", "spatial_acceleration", "classical_acceleration"):
            assert turned["links"][name][key] == link[key][3:] + link[key][:3]
        assert turned["links"][name]["screw"] == link["screw"]


def test_degrees_are_read_for_rates_and_accelerations(ask):
    plain = ask("textbook:planar_2r", "-q", "0.5235987755982988,0", "--qdot", "3.141592653589793,0", "--qddot", "0,1")
    same = ask("textbook:planar_2r", "-q", "30,0", "--qdot", "180,0", "--qddot", "0,57.29577951308232", "--deg")
    for name, link in plain["links"].items():
        assert_same(same["links"][name]["twist"], link["twist"])
        assert_same(same["links"][name]["classical_acceleration"], link["classical_acceleration"])
    slid = ask("textbook:rp", "--qdot", "0,2", "--deg")  # a slide's rate stays in m/s
    assert_same(slid["links"]["tool"]["twist"], [2.0, 0, 0, 0, 0, 0])


def test_a3_through_the_command_line(ask):
    """The tip's velocity in the tip's frame with the elbow at a right angle: (l1 qd1, l2 (qd1 + qd2), 0)."""
    result = ask("textbook:planar_2r", "-q", "77,90", "--deg", "--qdot", "joint1=10,joint2=5")
    one, two = 0.17453292519943295, 0.08726646259971647
    assert_same(result["links"]["tool"]["body_twist"], [one, 0.8 * (one + two), 0, 0, 0, one + two])


def test_a14_through_the_command_line(ask):
    screw = ask(*HELICAL)["links"]["tool"]["screw"]
    assert_same(screw["axis"], [3 / 7, 2 / 7, 6 / 7])
    assert screw["pitch"] == pytest.approx(0.05 / 6.283185307179586, abs=1e-15)
    assert screw["motion"] == "screw"


def test_one_frame_seen_from_another_in_the_axes_of_a_third(ask):
    words = ("--relative-to", "link2", "--expressed-in", "link4")
    every, alone = ask(*PUMA, *words), ask(*PUMA, *words, "-f", "link6")
    assert list(alone["links"]) == ["link6"]
    assert alone["links"]["link6"] == every["links"]["link6"]
    assert (alone["relative_to"], alone["expressed_in"]) == ("link2", "link4")
    assert every["links"]["link2"]["screw"]["motion"] == "rest"
    assert every["links"]["base"]["screw"]["motion"] != "rest"  # it moves, for who sits on link_2


def test_there_is_no_minus_before_a_zero(cli):
    for words in (PLANAR, ("textbook:planar_2r", "--qdot", "-1,1"), HELICAL):
        for form in ("json", "table"):
            out = table(cli, *words, "--qddot", "0,0" if "planar" in words[0] else "0", "-F", form)
            assert not re.search(r"-0(\.0*)?[\s,\]]", out)


# --- pages ---------------------------------------------------------------------------------------------------------

PAGES = (
    PLANAR,
    (*PLANAR, *PUSHED, "-f", "tool", "--deg"),
    (*PLANAR[:3], "--qdot", "0,0"),
    ("textbook:planar_2r", "--qdot", "1e12,1e-9", "-f", "tool", "--qddot", "1e-3,1e12"),
    (*HELICAL, "-f", "tool", "--qddot", "1"),
    (*PUMA, "--order", "angular-first", "--relative-to", "link3"),
    ("example:pr2", "-q", "random:2", "--qdot", "torso_lift_joint=0.1,l_shoulder_pan_joint=1"),
    (
        "example:pr2",
        "--qdot",
        "torso_lift_joint=0.1",
        "-f",
        "l_gripper_motor_accelerometer_link",
        "--qddot",
        "r_wrist_roll_joint=1",
    ),
    (*TALOS, "--qdot", "root_joint=1 2 3 4 5 6,arm_left_1_joint=1"),
    (*TALOS, "--qdot", "root_joint.vx=1000", "--qddot", "root_joint.wz=1", "--relative-to", "head_2_link"),
    ("example:icub", "--qdot", "r_hip_pitch=1", "-f", "r_foot"),
)


@pytest.mark.parametrize("question", PAGES, ids=" ".join)
def test_tables_fit_80_columns(cli, question):
    text = table(cli, *question)
    assert max(map(len, text.splitlines())) <= 80
    assert not re.search(r"\b(nan|inf)\b", text)
    assert "agree: largest difference" in text


def test_a_humanoid_stays_readable(cli):
    """A link a line in each table; of what is at rest, a few are named and the rest counted."""
    arm = table(cli, *TALOS, "--qdot", "arm_left_1_joint=1")
    assert len(re.findall(r"^gripper_left", arm, re.MULTILINE)) == 2 * 8
    assert not re.search(r"^gripper_right", arm, re.MULTILINE)
    assert re.search(r"at rest, and left out: [^()]* and\s+\d+\s+more\n", arm)
    assert len(arm.splitlines()) < 100
    whole = table(cli, *TALOS, "--qdot", "root_joint.wx=1")
    assert len(re.findall(r"^gripper_right", whole, re.MULTILINE)) == 2 * 8


def test_cut_names_are_told_apart_where_they_can_be(cli):
    text = table(cli, "example:pr2", "--qdot", "torso_lift_joint=1")
    rows = [line[:26].strip() for line in text.splitlines() if line.startswith(("l_gripper", "r_gripper"))]
    assert len(rows) == 2 * len(set(rows))  # once in each of the two tables
    assert any(".." in row for row in rows)
    assert "long names are cut" in text


def test_a_page_says_what_it_is_of_and_in_which_axes_and_units(cli):
    text = table(cli, *PLANAR, *PUSHED, "-f", "tool", "--relative-to", "link1", "--expressed-in", "base")
    for part in (
        "velocity of the origin of tool,\nrelative to link1",
        "twist, in the axes of tool (body twist) and of base",
        "m/s",
        "rad/s",
        "acceleration: spatial in the axes of tool, classical in the axes of base",
        "m/s2",
        "rad/s2",
        "instantaneous screw, in the coordinates of base",
        "centre of rotation",
        "m/rad",
        "differ by w x v",
        "joint rates joint1 1, joint2 0.5 (m/s, rad/s; others zero)",
        "joint accelerations joint1 0.1, joint2 -0.2",
        "at joint1 0.3, joint2 0.7",
    ):
        assert part in text, part
    links = table(cli, *PLANAR, *PUSHED)
    for part in (
        "velocity of the origins of all links",
        "each in the link's own axes (body twists)",
        "twists, in the axes of base",
        "spatial accelerations, each in the link's own axes",
        "classical accelerations, in the axes of base",
        "at rest, and left out: base",
    ):
        assert part in links, part
    assert "acceleration" not in table(cli, *PLANAR)


def test_screws_are_named_in_words(cli):
    assert "point of the axis" in table(cli, *HELICAL, "-f", "tool")
    assert "0.00795775 m/rad" in table(cli, *HELICAL, "-f", "tool")
    slide = table(cli, "textbook:planar_2r", "--qdot", "1,-1", "-f", "tool")
    assert "translation" in slide
    assert "centre" not in slide
    rest = table(cli, *PLANAR, "-f", "base")
    assert "at rest: there is no screw" in rest
    centre = table(cli, "textbook:pr", "-q", "0.25,0", "--qdot", "0.3,-0.5", "-f", "tool")
    assert re.search(r"centre of rotation +\(0\.25, -0\.6, 0\) m", centre)  # a wheel's point of contact


def test_a_link_at_rest_that_starts_is_shown(cli):
    text = table(cli, "textbook:planar_2r", "--qdot", "0,0", "--qddot", "0,1")
    assert "at rest, and left out: base, link1" in text
    assert re.search(r"^tool .*1\.00000$", text, re.MULTILINE)
    assert "every link is at rest" in table(cli, "textbook:planar_2r", "--qdot", "0,0", "--qddot", "0,0")


def test_a_page_shows_the_numbers_of_the_json(cli, ask):
    link = ask(*PUMA)["links"]["link4"]
    rows = [line.split()[1:] for line in table(cli, *PUMA).splitlines() if line.startswith("link4 ")]
    for shown, exact in zip(rows, (link["body_twist"], link["twist"]), strict=True):
        assert_same([float(x) for x in shown], exact, atol=5.1e-6)


# --- CSV -----------------------------------------------------------------------------------------------------------


def test_csv_has_a_row_a_link_in_full_precision(cli, ask):
    words = (*PUMA, "--qddot", "1,2,3,4,5,6")
    rows = list(csv.DictReader(io.StringIO(table(cli, *words, "-F", "csv"))))
    links = ask(*words)["links"]
    assert [row["link"] for row in rows] == list(links)
    for row, link in zip(rows, links.values(), strict=True):
        assert [float(row[f"v{c} [m/s]"]) for c in "xyz"] == link["twist"][:3]
        assert [float(row[f"body_w{c} [rad/s]"]) for c in "xyz"] == link["body_twist"][3:]
        assert [float(row[f"spatial_a{c} [m/s2]"]) for c in "xyz"] == link["spatial_acceleration"][:3]
        assert [float(row[f"classical_alpha{c} [rad/s2]"]) for c in "xyz"] == link["classical_acceleration"][3:]
        assert row["motion"] == link["screw"]["motion"]
        if row["motion"] == "rest":
            assert row["pitch [m/rad]"] == row["axis_x"] == ""
        else:
            assert float(row["pitch [m/rad]"]) == link["screw"]["pitch"]
            assert [float(row[f"point_{c} [m]"]) for c in "xyz"] == link["screw"]["point"]


# --- refusals ------------------------------------------------------------------------------------------------------


def test_rates_are_needed(refused):
    assert "--qdot" in refused("textbook:planar_2r")


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("--qdot", "1"), "2 are needed"),
        (("--qdot", "1,x"), "'x' is not a number"),
        (("--qdot", "1,nan"), "not a finite number"),
        (("--qdot", "1e13,0"), "beyond 1e+12"),
        (("--qdot", "elbow=1"), "no joint 'elbow'"),
        (("--qdot", "1,1", "--qddot", "1"), "acceleration is given"),
        (("--qdot", "1,1", "--qddot", "fast"), "accelerations"),
        (("--qdot", "1,1", "-f", "tol"), "no frame 'tol'"),
        (("--qdot", "1,1", "--relative-to", "joint1"), "is a joint, not a frame"),
        (("--qdot", "1,1", "--expressed-in", "x"), "no frame 'x'"),
    ],
)
def test_what_cannot_be_asked_is_refused(refused, words, part):
    assert part in refused("textbook:planar_2r", *words)


def test_rates_of_followers_are_refused(refused, arm, ask):
    assert "use 'shoulder', its leader" in refused(arm, "--qdot", "elbow=1")
    # The elbow follows backwards at half the rate: the lower arm turns at the other half.
    assert_same(ask(arm, "--qdot", "shoulder=1")["links"]["lower"]["twist"][5], 0.5)


def test_names_are_made_printable(cli, arm):
    arm.write_text(arm.read_text().replace('"tip"', '"=tip\u202e"'), encoding="utf-8")
    for words in (("-f", "=tip\u202e"), ()):
        text = table(cli, arm, "--qdot", "1,1", *words)
        assert "\u202e" not in text
        assert "=tip\\u202e" in text
    assert "'=tip" in table(cli, arm, "--qdot", "1,1", "-F", "csv")
