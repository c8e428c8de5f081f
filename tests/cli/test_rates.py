"""`kinetostat rates`: spellings, pages, keys, lists, refusals, and what is said near a singular configuration."""

import csv
import io
import json
import math
import re

import numpy as np
import pytest

import kinetostat as ks
from textbook_support import assert_same

TWO = ("textbook:planar_2r", "-q", "0.3,0.7")
THREE = ("textbook:planar_3r", "-q", "0.3,0.7,-0.4")
PANDA = ("example:panda", "-f", "panda_hand", "-q", "default", "--twist", "0.1,0,0,0,0,0")
UR5 = ("example:ur5_robot", "-f", "tool0", "-q", "0.1,-1,1.2,0.3,0.5,0", "--twist", "0.1,0.2,0.3,0,0,0.1")
SCARA = ("textbook:scara", "-q", "0.3,0.4,0.1,0.2", "--twist", "0.1,0.2,0.3,0,0,1")
KEYS = {
    "frame",
    "relative_to",
    "reference",
    "expressed_in",
    "point",
    "rows",
    "twist",
    "columns",
    "column_units",
    "rates",
    "null_space_rates",
    "utilisation",
    "binding_joint",
    "residual",
    "exact",
    "rank",
    "usual_rank",
    "singular_values",
    "singular_values_unit",
    "characteristic_length",
    "characteristic_length_reference",
    "amplification",
    "smallest_singular_value_rate",
    "damping",
    "weights",
    "secondary",
}


@pytest.fixture
def ask(cli):
    """Return the result that is written, read strictly: no NaN, no Infinity."""

    def call(*words):
        answer = cli("rates", *words, "-F", "json")
        assert answer.code == 0, answer.err
        payload = json.loads(answer.out, parse_constant=pytest.fail)
        assert payload["schema"] == "kinetostat/rates/1"
        assert payload["crosscheck"]["agree"] is True
        return payload["result"]

    return call


@pytest.fixture
def refused(cli):
    """Return the one line that refuses a command line."""

    def call(*words):
        answer = cli("rates", *words)
        assert (answer.code, answer.out) == (2, "")
        (line,) = answer.err.splitlines()
        assert line.startswith("kinetostat: error: ")
        assert line.isprintable()
        return line

    return call


@pytest.fixture
def page(cli):
    """Return the page that a person reads, as it stands and with its lines joined."""

    def call(*words):
        answer = cli("rates", *words)
        assert answer.code == 0, answer.err
        assert max(map(len, answer.out.splitlines())) <= 80
        return answer.out, " ".join(answer.out.split())

    return call


def values(by_joint):
    return np.array(list(by_joint.values()))


# --- JSON ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("question", [PANDA, UR5, SCARA, (*THREE, "--axes", "xy", "--twist", "1,0")], ids=" ".join)
def test_the_documented_keys(ask, question):
    result = ask(*question)
    assert set(result) >= KEYS
    assert set(result) - KEYS <= {"utilisation_reason", "point_reason"}
    n, m = len(result["columns"]), len(result["rows"])
    for key in ("rates", "null_space_rates", "utilisation"):
        assert list(result[key]) == result["columns"]
    assert len(result["column_units"]) == n
    assert len(result["twist"]) == len(result["residual"]) == m
    assert len(result["singular_values"]) == min(m, n)
    assert 0 < result["rank"] <= min(m, n)
    assert result["singular_values"] == sorted(result["singular_values"], reverse=True)
    assert result["weights"] is result["secondary"] is None
    assert result["damping"] == 0
    largest = max(result["utilisation"].values())
    assert result["utilisation"][result["binding_joint"]] == largest


def test_the_numbers_are_the_librarys(ask):
    result = ask(*UR5, "--damping", "0.1", "--weights", "1,2,3,4,5,6", "--secondary", "mid-limits")
    model = ks.load("example:ur5_robot")
    q = np.array([0.1, -1, 1.2, 0.3, 0.5, 0])
    found = ks.resolved_rates(
        model, "tool0", q, [0.1, 0.2, 0.3, 0, 0, 0.1], damping=0.1, weights=range(1, 7), secondary="mid-limits"
    )
    assert_same(values(result["rates"]), found.rates)
    assert_same(values(result["utilisation"]), found.utilisation)
    assert_same(result["residual"], found.residual)
    assert result["weights"] == [1, 2, 3, 4, 5, 6]
    assert result["secondary"] == "mid-limits"
    assert (result["damping"], result["exact"], result["rank"]) == (0.1, False, 6)
    assert result["smallest_singular_value_rate"] == pytest.approx(float(found.approach))


def test_a_joint_without_a_velocity_limit_has_no_share(ask, cli, tmp_path):
    path = tmp_path / "free.urdf"
    path.write_text(
        '<robot name="free"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
        '<joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/></joint></robot>'
    )
    result = ask(path, "--axes", "rz", "--twist", "1")
    assert result["utilisation"] == {"j": None, "k": None}
    assert "no velocity limit" in result["utilisation_reason"]
    assert result["binding_joint"] is None
    assert "no joint has a velocity limit" in cli("rates", path, "--axes", "rz", "--twist", "1").out


def test_the_rows_and_the_frame_are_told(ask):
    result = ask(*THREE, "--axes", "y rz", "--twist", "1,2", "--reference", "local", "--point", "0.1,0,0")
    assert result["rows"] == ["vy", "wz"]
    assert result["twist"] == [1, 2]
    assert (result["frame"], result["relative_to"], result["expressed_in"]) == ("tool", "base", "tool")
    assert result["point"] == [0.1, 0, 0]
    world = ask(*THREE, "--axes", "xy", "--twist", "1,2", "--reference", "world")
    assert world["point"] is None
    assert "point_reason" in world


def test_without_crosscheck_one_engine_answers(cli):
    payload = cli("rates", *UR5, "--no-crosscheck", "-F", "json").json
    assert payload["crosscheck"]["agree"] is None
    assert payload["crosscheck"]["reason"]


# --- the twist -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spelling", ["0.1,-0.2", "0.1 -0.2", " 0.1 , -0.2 ", "1e-1,-2e-1", "0.1,-0.2,0,0,-0,0"])
def test_spellings_of_a_short_twist(ask, spelling):
    given = ask(*THREE, "--axes", "xy", "--twist", spelling)
    assert given["twist"] == [0.1, -0.2]
    assert given["rates"] == ask(*THREE, "--axes", "xy", "--twist", "0.1,-0.2,0,0,0,0")["rates"]


def test_a_twist_that_starts_with_a_minus(ask):
    plus, minus = (ask(*TWO, "--axes", "xy", "--twist", twist) for twist in ("1,2", "-1,-2"))
    assert_same(values(minus["rates"]), -values(plus["rates"]))


def test_angular_rows_first_are_read_and_written_so(ask):
    linear = ask(*SCARA)
    angular = ask(*SCARA[:-1], "0,0,1,0.1,0.2,0.3", "--order", "angular-first")
    assert angular["rates"] == linear["rates"]
    assert angular["rows"] == ["wx", "wy", "wz", "vx", "vy", "vz"]
    assert angular["twist"] == [0, 0, 1, 0.1, 0.2, 0.3]
    assert angular["residual"] == linear["residual"][3:] + linear["residual"][:3]
    short = ask(*THREE, "--axes", "x y rz", "--twist", "3,1,2", "--order", "angular-first")
    assert short["rows"] == ["wz", "vx", "vy"]
    assert short["rates"] == ask(*THREE, "--axes", "x y rz", "--twist", "1,2,3")["rates"]


def test_axes_as_words_without_quotation_marks(ask):
    assert ask(*THREE, "--axes", "x", "y", "rz", "--twist", "1,2,3")["rows"] == ["vx", "vy", "wz"]


# --- the page ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "question",
    [
        PANDA,
        UR5,
        SCARA,
        (*PANDA, "--secondary", "mid-limits", "--deg"),
        (*PANDA, "--secondary", "manipulability", "--weights", "limits", "--damping", "0.1"),
        (*THREE, "--axes", "xy", "--twist", "1e12,-1e12"),
        (*THREE, "--axes", "xy", "--twist", "1.23456789e-7,-1e-300", "--secondary", "-1.234567e-5,1.2345678e8,1"),
        ("textbook:planar_2r", "-q", "0.3,1e-7", "--axes", "xy", "--twist", "-1.234567,0.123456"),
        (
            "example:talos_full_v2",
            "-f",
            "gripper_left_fingertip_1_link",
            "--base",
            "floating",
            "--twist",
            "1,2,3,4,5,6",
        ),
        ("example:talos_full_v2", "-f", "gripper_left_fingertip_1_link", "--twist", "1,2,3,4,5,6", "--deg"),
    ],
    ids=" ".join,
)
def test_pages_fit_80_columns_and_say_their_units(page, question):
    text, joined = page(*question)
    assert "rad/s" in text or "deg/s" in text
    assert "m/s" in text
    assert "pinocchio and screw agree: largest difference" in joined


def test_long_names_fit_80_columns(page, tmp_path):
    long = "a_joint_whose_name_is_longer_than_what_a_table_has_room_for_in_eighty_columns"
    path = tmp_path / "long.urdf"
    path.write_text(
        f'<robot name="long"><link name="base_{long}"/><link name="tip_{long}"/>'
        f'<joint name="{long}" type="revolute"><parent link="base_{long}"/><child link="tip_{long}"/>'
        '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="0.001"/></joint></robot>'
    )
    page(path, "--axes", "rz", "--twist", "-123.456789", "--secondary", "-1.234567")


def test_degrees_are_of_rates_and_limits_of_angles_alone(page, ask):
    text, _ = page("textbook:scara", "-q", "10,20,0.1,30", "--deg", *SCARA[3:])
    exact = ask("textbook:scara", "-q", "10,20,0.1,30", "--deg", *SCARA[3:])
    rows = {line.split()[0]: line.split() for line in text.splitlines() if line.startswith("joint") and "/s" in line}
    for name, unit in zip(exact["columns"], exact["column_units"], strict=True):
        turns = unit == "rad/s"
        assert rows[name][2] == ("deg/s" if turns else "m/s")
        factor = 180 / math.pi if turns else 1
        assert float(rows[name][1]) == pytest.approx(exact["rates"][name] * factor, rel=1e-5, abs=1e-12)
        assert float(rows[name][4]) == pytest.approx(100 * exact["utilisation"][name], abs=0.051)


def test_degrees_are_read_where_they_are_shown(page, ask):
    """`--deg`: joint angles and rates are read and shown in degrees, those of --secondary, too."""
    at = ("textbook:planar_3r", "-q", "30,60,20", "--deg", "--axes", "xy", "--twist", "0,0")
    free = ask(*at, "--secondary", "10,0,0")["rates"]
    again = ",".join(repr(math.degrees(rate)) for rate in free.values())
    assert_same(values(ask(*at, f"--secondary={again}")["rates"]), values(free))
    in_radians = ask(*at[:1], "-q", "0.5235987755982988,1.0471975511965976,0.3490658503988659", *at[4:], "--secondary",
                     "0.17453292519943295,0,0")["rates"]  # fmt: skip
    assert_same(values(in_radians), values(free))


def test_rounding_is_shown_as_zero(page):
    for question in (
        (*THREE, "--axes", "xy", "--twist", "0.1,0"),
        (*THREE, "--axes", "xy", "--twist", "0,0", "--secondary", "1,0,0"),
        (*PANDA, "--secondary", "manipulability"),
    ):
        text, _ = page(*question)
        assert not re.search(r"\de-1\d", text.partition("pinocchio")[0]), text


def test_what_kind_of_answer_it_is(page):
    asked = ("--axes", "xy", "--twist", "0.1,0.2")
    assert "exact, and the only rates that give it" in page(*TWO, *asked)[1]
    assert "exact, with the least norm of a 1-parameter family" in page(*THREE, *asked)[1]
    assert "the least weighted norm" in page(*THREE, *asked, "--weights", "1,2,3")[1]
    assert "least squares: the joints give 4 of the 6 directions" in page(*SCARA[:-1], "0,0,0,1,0,0")[1]
    assert "damping 0.1" in page(*TWO, *asked, "--damping", "0.1")[1]
    assert "null space" in page(*THREE, *asked, "--secondary", "mid-limits")[0].splitlines()[3]


def test_the_joint_that_binds_and_what_it_would_do(page, ask):
    twist = ("--axes", "xy", "--twist", "10,0")
    text = page(*TWO, *twist)[1]
    share = float(re.search(r"at ([\d.e-]+) of this velocity it would just do", text)[1])
    slower = ask(*TWO, "--axes", "xy", "--twist", f"{10 * share!r},0")
    assert max(slower["utilisation"].values()) == pytest.approx(1, rel=1e-3)
    assert "would just do" not in page(*TWO, "--axes", "xy", "--twist", "0.1,0")[1]


def test_a_secondary_task_does_not_slow_down_with_the_velocity(page, ask):
    """What is said of a slower velocity has to hold with the rates of the null space added, or not to be said."""
    asked = ("--axes", "xy", "--secondary", "9,0,0")
    found = re.search(r"at ([\d.e-]+) of this velocity it would just do", page(*THREE, "--twist", "3,0", *asked)[1])
    if found is not None:
        slower = ask(*THREE, "--twist", f"{3 * float(found[1])!r},0", *asked)
        assert max(slower["utilisation"].values()) == pytest.approx(1, rel=1e-3)


# --- near a singular configuration ---------------------------------------------------------------------------------


def test_near_a_singular_configuration_the_growth_is_told(page, ask):
    near = ("textbook:planar_2r", "-q", "-0.01,0.02", "--axes", "xy", "--twist", "1,0")
    text, result = page(*near)[1], ask(*near)
    assert "near a singular configuration" in text
    assert f"{result['amplification']:.4g} times" in text
    assert result["smallest_singular_value_rate"] < 0
    left = re.search(r"these rates reach the singular configuration in about ([\d.e-]+) s", text)[1]
    falls = re.search(r"the smallest singular value falls by ([\d.e-]+) per second", text)[1]
    assert float(falls) == pytest.approx(-result["smallest_singular_value_rate"], rel=1e-3)
    assert float(left) == pytest.approx(result["singular_values"][-1] / float(falls), rel=1e-2)
    away = page(*near[:-1], "-1,0")[1]
    assert "near a singular configuration" in away
    assert "falls by" not in away
    assert "reach the singular configuration" not in away


def test_rates_that_are_kept_up_do_come_to_the_singular_configuration(page, ask):
    """After nine tenths of the time that the page tells, a tenth of the smallest singular value is left."""
    asked = ("--axes", "xy", "--twist", "1,0")
    start = ("textbook:planar_2r", "-q", "-0.01,0.02", *asked)
    text, result = page(*start)[1], ask(*start)
    time = float(re.search(r"in about ([\d.e-]+) s", text)[1])
    one, two = np.array([-0.01, 0.02]) + 0.9 * time * values(result["rates"])
    then = ask("textbook:planar_2r", "-q", f"{float(one)!r},{float(two)!r}", *asked)
    assert then["singular_values"][-1] == pytest.approx(0.1 * result["singular_values"][-1], rel=0.02)


def test_at_a_singular_configuration_it_is_told(page, ask):
    text = page("textbook:planar_2r", "-q", "0.3,0", "--axes", "xy", "--twist", "1,0")[1]
    assert "singular here" in text
    assert "least squares: the joints give 1 of the 2 directions" in text
    damped = page("textbook:planar_2r", "-q", "0.3,0", "--axes", "xy", "--twist", "1,0", "--damping", "0.1")[1]
    assert "singular here" in damped
    assert "without bound" not in damped
    result = ask("textbook:planar_2r", "-q", "0.3,0", "--axes", "xy", "--twist", "1,0")
    assert (result["rank"], result["usual_rank"]) == (1, 2)
    assert result["smallest_singular_value_rate"] is None
    assert "singular" in result["smallest_singular_value_rate_reason"]


def test_far_from_one_nothing_is_told(page):
    for question in (UR5, PANDA, (*TWO, "--axes", "xy", "--twist", "1,0")):
        assert "singular configuration" not in page(*question)[1]
        assert "singular here" not in page(*question)[1]


def test_an_arm_that_never_had_a_direction_is_not_singular_for_that(page):
    """Three parallel axes never move anything out of their plane: no configuration of this arm is singular for that."""
    text = page(*THREE, "--axes", "xyz", "--twist", "0.1,0,0")[1]
    assert "singular here" not in text
    near = page("textbook:planar_3r", "-q", "-0.01,0.02,0.001", "--axes", "xyz", "--twist", "1,0,0")[1]
    assert "near a singular configuration" in near
    assert "falls by" in near
    lost = page("textbook:planar_3r", "-q", "0.3,0,0", "--axes", "xyz", "--twist", "1,0,0")[1]
    assert "singular here: the joints give 1 of the 2 directions" in lost


def test_damped_rates_do_not_grow_without_bound(page):
    """With damping rates stay below |V| / (2 l): that they grow as 1 / s would be wrong."""
    text = page("textbook:planar_2r", "-q", "0.3,1e-5", "--axes", "xy", "--twist", "1,0", "--damping", "0.01")[1]
    assert "grow as 1 / the smallest" not in text
    assert "|V| / (2 l)" in text
    assert "falls by" not in text


@pytest.mark.parametrize("twist", ["0.1,0.2", "0,0"])
def test_rates_with_a_part_in_the_null_space_have_not_the_least_norm(page, twist):
    inside = page(*THREE, "--axes", "xy", "--twist", twist, "--secondary", "1,0,0")[1]
    assert "one of a 1-parameter family of rates: those with the least norm, plus the null space's" in inside
    assert "with the least norm of a" not in inside
    nothing = page(*THREE, "--axes", "xy", "--twist", "0.1,0.2", "--secondary", "0,0,0")[1]
    assert "exact, with the least norm of a 1-parameter family" in nothing


def test_a_secondary_task_alone_tells_of_no_best_direction(page):
    text = page("textbook:planar_3r", "-q", "0,0.01,0", "--axes", "xy", "--twist", "0,0", "--secondary", "1,0,0")[1]
    assert "near a singular configuration" in text
    assert "best direction" not in text


def test_singular_values_say_their_unit(page):
    """Where lengths have no unit of their own: rows in metres, columns in radians."""
    text = page(*TWO, "--axes", "xy", "--twist", "1,0")[1]
    assert re.search(r"singular values [\d. ]+ m/rad\b", text), text
    shares = page(*TWO, "--axes", "xy", "--twist", "1,0", "--weights", "limits")[1]
    assert re.search(r"singular values [\d. ]+ m/s \(columns weighted\)", shares), shares


def test_where_there_is_no_length_it_is_said(ask):
    own = ask(*SCARA)
    assert own["characteristic_length_reference"].startswith("auto")
    none = ask("example:panda", "-f", "panda_leftfinger", "--relative-to", "panda_hand", "--twist", "0,1,0,0,0,0")
    assert none["characteristic_length"] == 1
    assert "no joint turns" in none["characteristic_length_reference"]


# --- lists ---------------------------------------------------------------------------------------------------------


@pytest.fixture
def listed(tmp_path):
    path = tmp_path / "q.csv"
    path.write_text("0.3,0.7,-0.4\n0,0,0\n1,2,3\n")
    return path


def test_a_list_of_configurations(cli, ask, listed):
    asked = ("--axes", "xy", "--twist", "0.1,0.2")
    answer = cli("rates", "textbook:planar_3r", *asked, "--qs", listed)
    assert answer.code == 0
    assert "agree" in answer.err
    rows = list(csv.DictReader(io.StringIO(answer.out)))
    assert [row["row"] for row in rows] == ["1", "2", "3"]
    for row, q in zip(rows, ("0.3,0.7,-0.4", "0,0,0", "1,2,3"), strict=True):
        one = ask("textbook:planar_3r", *asked, "-q", q)
        for name in one["columns"]:
            assert float(row[f"{name} [rad/s]"]) == pytest.approx(one["rates"][name], abs=1e-12)
        for name, left in zip(one["rows"], one["residual"], strict=True):
            assert float(row[f"left_{name} [m/s]"]) == pytest.approx(left, abs=1e-12)
        assert row["binding_joint"] == one["binding_joint"]
        assert float(row["utilisation"]) == pytest.approx(max(one["utilisation"].values()), abs=1e-12)
        assert float(row["smallest_singular_value"]) == pytest.approx(one["singular_values"][-1], abs=1e-12)


@pytest.mark.parametrize(
    "options",
    [("--weights", "limits"), ("--damping", "0.1"), ("--secondary", "manipulability"), ("--secondary", "1,0,0")],
)
def test_a_list_with_options(cli, listed, options):
    answer = cli(
        "rates", "textbook:planar_3r", "--axes", "xy", "--twist", "0.1,0.2", "--qs", listed, *options, "-F", "json"
    )
    payload = json.loads(answer.out, parse_constant=pytest.fail)
    assert payload["schema"] == "kinetostat/rates.rows/1"
    assert payload["crosscheck"]["agree"] is True
    assert len(payload["result"]["rows"]) == 3
    assert len(payload["result"]["units"]) == len(payload["result"]["columns"])


def test_rows_that_cannot_be_answered_say_why(cli, tmp_path):
    path = tmp_path / "q.csv"
    path.write_text("0.3,0.7\nx,1\n0.1,nan\n0.2,0.4\n")
    answer = cli("rates", "textbook:planar_2r", "--axes", "xy", "--twist", "1,0", "--qs", path)
    rows = list(csv.DictReader(io.StringIO(answer.out)))
    assert [bool(row["reason"]) for row in rows] == [False, True, True, False]
    assert [bool(row["joint1 [rad/s]"]) for row in rows] == [True, False, False, True]


def test_a_list_is_refused_with_a_configuration(refused, listed):
    assert "--qs" in refused("textbook:planar_3r", "--axes", "xy", "--twist", "1,0", "--qs", listed, "-q", "mid")


def test_csv_of_one_configuration(cli, ask):
    question = (*THREE, "--axes", "xy", "--twist", "0.1,0.2")
    rows = list(csv.DictReader(io.StringIO(cli("rates", *question, "-F", "csv").out)))
    exact = ask(*question)
    assert {row["joint"]: float(row["rate"]) for row in rows} == exact["rates"]
    assert {row["joint"]: float(row["utilisation"]) for row in rows} == exact["utilisation"]
    assert [row["unit"] for row in rows] == exact["column_units"]


# --- refusals ------------------------------------------------------------------------------------------------------

EVIL = "evil\x1b[31m\nline\u202e"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "no velocity"),
        (("--twist", ""), "--twist"),
        (("--twist", "1,2"), "6 finite numbers"),
        (("--twist", "1,2,3,4,5,6,7"), "6 finite numbers"),
        (("--twist", "1,0,0,0,0,nan"), "finite"),
        (("--twist", "1,0,0,0,0,inf"), "finite"),
        (("--twist", "1e13,0,0,0,0,0"), "1e+12"),
        (("--twist", EVIL), "--twist"),
        (("--axes", "xy", "--twist", "1"), "2 finite numbers"),
        (("--axes", "xy", "--twist", "1,2,3"), "2 finite numbers"),
        (("--axes", "xy", "--twist", "1,2,0,0,0,3"), "leaves out"),  # asked for, and silently dropped
        (("--axes", "xy", "--twist", "1,0,0,0,0,0", "--order", "angular-first"), "leaves out"),
        (("--axes", "q", "--twist", "1"), "axis"),
        (("--axes", "", "--twist", "1"), "axes"),
        (("--axes", EVIL, "--twist", "1"), "axis"),
        (("--damping", "nan"), "damping"),
        (("--damping", "inf"), "damping"),
        (("--damping", "-1"), "damping"),
        (("--damping", "x"), "damping"),
        (("--weights", ""), "--weights"),
        (("--weights", "1"), "--weights"),
        (("--weights", "1,2,3"), "--weights"),
        (("--weights", "1,0"), "weights"),
        (("--weights", "-1,1"), "weights"),
        (("--weights", "1,nan"), "weights"),
        (("--weights", "1e300,1"), "weights"),
        (("--weights", "mid-limits"), "weights"),
        (("--weights", EVIL), "weights"),
        (("--secondary", ""), "--secondary"),
        (("--secondary", "1"), "--secondary"),
        (("--secondary", "1,2,3"), "--secondary"),
        (("--secondary", "nan,1"), "rate"),
        (("--secondary", "1e300,1"), "rate"),
        (("--secondary", "limits"), "secondary"),
        (("--secondary", EVIL), "secondary"),
        (("-f", "nowhere"), "nowhere"),
        (("-f", "base"), "no joint moves"),
        (("--reference", "world", "--point", "0,0,1"), "world"),
        (("--point", "0,0"), "--point"),
        (("--relative-to", "tool"), "no joint moves"),
        (("--order", "backwards"), "order"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_a_line(refused, words, said):
    asked = () if "--twist" in words or not words else ("--twist", "1,0,0,0,0,0")
    assert said in refused(*TWO, *asked, *words)


def test_weights_by_limits_of_a_floating_base_are_refused(cli):
    answer = cli(
        "rates", "example:talos_full_v2", "-f", "gripper_left_fingertip_1_link", "--base", "floating",
        "--weights", "limits", "--twist", "1,0,0,0,0,0",
    )  # fmt: skip
    assert (answer.code, answer.out) == (2, "")
    line = answer.err.splitlines()[-1]
    assert "root_joint" in line
    assert "--weights" in line


def test_a_limit_that_no_joint_has_is_no_crash(cli, tmp_path):
    for velocity in ("1e-300", "1e300", "1e-20", "1e20"):
        path = tmp_path / "odd.urdf"
        path.write_text(
            '<robot name="odd"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>'
            '<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
            f'<limit lower="-1" upper="1" effort="1" velocity="{velocity}"/></joint>'
            '<joint name="k" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>'
            '<origin xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
            '<joint name="t" type="fixed"><parent link="c"/><child link="d"/><origin xyz="1 0 0"/></joint></robot>'
        )
        with np.errstate(all="ignore"):
            answer = cli(
                "rates", path, "-q", "0.3,0.7", "--axes", "xy", "--twist", "1,0", "--weights", "limits", "-F", "json"
            )
        assert answer.code in (0, 2), (velocity, answer.err)
        if answer.code == 0:
            assert json.loads(answer.out, parse_constant=pytest.fail)["result"]["exact"] is True


def test_what_rounding_leaves_of_a_jacobian_is_not_divided_by(ask):
    """A finger that slides along y: along x its Jacobian is 2.5e-17 for 0."""
    result = ask(
        "example:panda", "-f", "panda_leftfinger", "--relative-to", "panda_hand", "--axes", "x", "--twist", "1"
    )
    assert result["exact"] is False
    assert abs(result["rates"]["panda_finger_joint1"]) < 1
    assert result["rank"] == result["usual_rank"] == 0
