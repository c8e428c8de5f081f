"""What `-q` takes: words, lists, names, SRDF states, files."""

import json

import pytest

PANDA = ("fk", "example:panda", "-f", "panda_hand", "-F", "json")


def positions(answer):
    return answer.json["configuration"]


def test_zero_is_the_default(cli):
    assert set(positions(cli(*PANDA)).values()) == {0.0}


def test_mid_is_the_middle_of_the_limits(cli):
    assert positions(cli(*PANDA, "-q", "mid"))["panda_joint4"] == pytest.approx((-3.0718 - 0.0698) / 2, abs=1e-15)


def test_random_is_inside_limits_and_the_same_for_a_seed(cli):
    first, again, other = (cli(*PANDA, "-q", f"random:{seed}") for seed in (7, 7, 8))
    assert positions(first) == positions(again) != positions(other)
    assert first.json["warnings"] == []


def test_an_srdf_state_is_found_beside_the_robot(cli):
    assert positions(cli(*PANDA, "-q", "default"))["panda_joint2"] == -0.785398


def test_an_srdf_can_be_named(cli, arm, tmp_path):
    srdf = tmp_path / "other.srdf"
    srdf.write_text("""<robot name="arm">
        <group name="all"><chain base_link="base" tip_link="tip"/></group>
        <group_state name="bent" group="all">
          <joint name="shoulder" value="0.4"/><joint name="elbow" value="9"/>
        </group_state>
        </robot>""")
    answer = cli("fk", arm, "-q", "bent", "--srdf", srdf, "-F", "json")
    assert positions(answer) == {"shoulder": 0.4, "slide": 0.0}  # the follower goes its own way
    assert cli("info", arm, "--srdf", srdf, "-F", "json").json["result"]["groups"] == {
        "all": ["shoulder", "elbow", "slide"]
    }


def test_names_and_lists_mean_the_same(cli, arm):
    named, listed, negative = (
        positions(cli("fk", arm, "-F", "json", "-q", q)) for q in ("slide=0.2,shoulder=-0.3", "-0.3,0.2", "-0.3 0.2")
    )
    assert named == listed == negative == {"shoulder": -0.3, "slide": 0.2}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("q.json", '{"shoulder": -0.3, "slide": 0.2}'),
        ("q.json", "[-0.3, 0.2]"),
        ("q.csv", "shoulder,slide\n-0.3,0.2\n"),
        ("q.csv", "slide, shoulder\r\n0.2, -0.3\r\n"),
        ("q.csv", "-0.3,0.2"),
    ],
)
def test_files_of_values(cli, arm, tmp_path, name, text):
    (tmp_path / name).write_text(text)
    assert positions(cli("fk", arm, "-F", "json", "-q", f"@{tmp_path / name}")) == {"shoulder": -0.3, "slide": 0.2}


def test_a_result_is_read_back_in_radians_even_with_degrees(cli, arm, tmp_path):
    result = tmp_path / "result.json"
    cli("fk", arm, "-q", "random:3", "-F", "json", "-o", result)
    expected = json.loads(result.read_text())["configuration"]
    assert positions(cli("fk", arm, "-q", f"@{result}", "--deg", "-F", "json")) == expected


@pytest.mark.parametrize(
    "text", ["", "{", "[[1, 2]]", '{"shoulder": "a"}', '"zero"', "[true, false]", "[1e999, 0]", "[" * 100_000]
)
def test_a_file_without_a_configuration_is_refused(cli, arm, tmp_path, text):
    (tmp_path / "q.json").write_text(text)
    answer = cli("fk", arm, "-q", f"@{tmp_path / 'q.json'}")
    assert answer.code == 2
    assert len(answer.err.splitlines()) == 1


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n3,4\n", "a\n1,2\n", "x,y\n"])
def test_a_csv_without_one_configuration_is_refused(cli, arm, tmp_path, text):
    (tmp_path / "q.csv").write_text(text)
    answer = cli("fk", arm, "-q", f"@{tmp_path / 'q.csv'}")
    assert answer.code == 2
    assert len(answer.err.splitlines()) == 1
