"""The command `map`: real robots, files, base placement, and what is refused."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from kinetostat.screw.kernel import Kernel

FEW = ("--samples", "20k")
PLANAR = ("map", "textbook:planar_2r", "--axes", "xy", *FEW)


@pytest.mark.parametrize(
    ("robot", "frame", "rest"),
    [
        ("example:ur5_robot", "tool0", ("--length", "auto")),
        ("example:panda", "panda_hand", ("--axes", "xyz")),
        ("example:pr2", "r_gripper_tool_frame", ("--relative-to", "torso_lift_link", "--length", "0.4")),
        ("example:tiago", "arm_7_link", ("--low-discrepancy", "20k", "--axes", "xyz")),
        ("textbook:scara", "tool", ("--axes", "xyz", "rz", "--length", "auto", "--point", "0,0,0.1")),
    ],
)
def test_real_robots_have_a_map(cli, robot, frame, rest):
    samples = () if "--low-discrepancy" in rest else FEW
    found = cli("map", robot, "-f", frame, *samples, *rest, "-F", "json").json
    result = found["result"]
    assert found["schema"] == "kinetostat/map/1"
    assert found["crosscheck"]["agree"] is True
    assert (result["count"], result["complete"], result["outside"]) == (20_000, True, 0)
    assert 0 < result["voxels_reached"] <= np.prod(result["shape"])
    low, high = result["box"]["low"], result["box"]["high"]
    np.testing.assert_allclose(np.subtract(high, low), np.array(result["shape"]) * result["voxel_size"], atol=1e-8)
    best = result["best_voxel"]
    assert all(a <= x <= b for a, x, b in zip(low, best["position"], high, strict=True))
    assert best["best_singular_value"] >= best["mean_singular_value"] > 0
    assert result["certified"]["count"] > 0


def test_the_best_configuration_is_in_the_best_voxel(cli):
    result = cli("map", "example:ur5_robot", "-f", "tool0", "--axes", "xyz", *FEW, "-F", "json").json["result"]
    best = result["best_voxel"]
    q = ",".join(f"{joint}={value!r}" for joint, value in best["configuration"].items())
    place = cli("fk", "example:ur5_robot", "-f", "tool0", "-q", q, "-F", "json").json["result"]["position"]
    assert np.abs(np.subtract(place, best["position"])).max() <= result["voxel_size"] / 2 + 1e-9
    blocks = cli("manipulability", "example:ur5_robot", "-f", "tool0", "-q", q, "-F", "json").json["result"]["blocks"]
    assert blocks["translation"]["minimum_singular_value"] == pytest.approx(best["best_singular_value"], abs=1e-12)


def test_json_is_the_same_for_any_number_of_threads(cli):
    one, two = (
        cli("map", "example:panda", "-f", "panda_hand", "--samples", "200k", "-F", "json", "-j", j) for j in "13"
    )
    assert one.code == 0
    assert one.out == two.out


def test_the_table_fits_and_says_units(cli):
    done = cli("map", "example:ur5_robot", "-f", "tool0", *FEW, "--deg")
    assert done.code == 0
    assert max(len(line) for line in done.out.splitlines()) <= 80
    for word in ("m3", "voxels reached", "directions reached", "deg", "pinocchio and screw agree"):
        assert word in done.out
    assert "m and rad are mixed" not in done.err
    assert "characteristic length 0.3467" in done.out
    assert "\njoints " in done.out
    assert "a second" in done.err


def test_metres_and_radians_are_mixed_on_demand_alone(cli):
    done = cli("map", "example:ur5_robot", "-f", "tool0", *FEW, "--length", "none")
    assert "m and rad are mixed" in done.err
    assert "no characteristic length: metres and radians as they are" in done.out
    assert "characteristic length" not in cli(*PLANAR).out


def test_a_tool_that_points_one_way_has_no_count_of_directions(cli):
    done = cli(*PLANAR)
    assert "directions reached" not in done.out
    assert "the z axis of tool points about one way only" in done.out


def test_joints_that_are_drawn_are_not_warned_of(cli):
    drawn = cli("map", "example:panda", "-f", "panda_hand", *FEW)
    assert "outside" not in drawn.err
    assert "warning" not in drawn.err
    held = cli("map", "example:panda", "-f", "panda_hand", *FEW, "-q", "panda_finger_joint1=0.5,panda_joint4=0.5")
    assert "'panda_finger_joint1' is at" in held.err
    assert "panda_joint4" not in held.err
    assert "other joints at panda_finger_joint1 0.5 (m, rad; others zero)" in " ".join(held.out.split())


def test_only_what_points_down_is_mapped(cli):
    weld = ("--axes", "xyz", "rx", "ry", "--reference", "local", "--approach", "0,0,-3")
    asked = ("map", "example:ur5_robot", "-f", "tool0", "--samples", "50k", *weld)
    done = cli(*asked)
    said = " ".join(done.out.split())
    assert "in the axes of tool0" in said
    assert "rows that count: vx vy vz wx wy" in said
    assert "only configurations with the z axis of tool0 within 15 degrees of (0, 0, -1)" in said
    result = cli(*asked, "-F", "json").json["result"]
    assert 0 < result["counted"] < 0.03 * result["count"]  # a cone of 15 degrees has 1.7 % of the directions
    assert result["asked"]["approach"] == {"direction": [0.0, 0.0, -1.0], "within_degrees": 15.0}
    assert result["asked"]["reference"] == "local"


def test_csv_has_a_row_for_each_voxel(cli):
    done = cli(*PLANAR, "-F", "csv")
    lines = done.out.splitlines()
    assert lines[0] == (
        "x [m],y [m],z [m],reach_count,best_singular_value [m/rad],mean_singular_value [m/rad],orientation_coverage [1]"
    )
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    assert values[:, 3].sum() == 20_000
    assert len(values) == cli(*PLANAR, "-F", "json").json["result"]["voxels_reached"]
    assert np.all(values[:, 4] >= values[:, 5] - 1e-8)


def test_files_of_the_map_and_a_picture(cli, tmp_path):
    done = cli(*PLANAR, "-o", tmp_path / "map.npz", "--plot", tmp_path / "map.svg", "-F", "json")
    with np.load(tmp_path / "map.npz", allow_pickle=False) as file:
        assert file["reach_count"].sum() == 20_000
        about = json.loads(str(file["about"]))
    assert about["robot"] == done.json["robot"]
    assert about["voxel_size"] == done.json["result"]["voxel_size"]
    assert ET.parse(tmp_path / "map.svg").getroot().tag.endswith("svg")
    assert cli(*PLANAR, "-o", tmp_path / "map.vti").code == 0
    assert (tmp_path / "map.vti").read_bytes().startswith(b'<?xml version="1.0"?>\n<VTKFile type="ImageData"')
    assert cli(*PLANAR, "-o", tmp_path / "map.txt").out == ""
    assert "voxels reached" in (tmp_path / "map.txt").read_text()


def circle(path, header=True):
    turns = 2 * np.pi * np.arange(10) / 10
    rows = [f"{4 + 1.5 * np.cos(t):.6f},{-2 + 1.5 * np.sin(t):.6f},0" for t in turns]
    path.write_text("\n".join((["x,y,z"] if header else []) + rows) + "\n")
    return path


@pytest.mark.parametrize("header", [True, False])
def test_a_base_is_placed_in_the_middle_of_a_circle(cli, tmp_path, header):
    poses = circle(tmp_path / "poses.csv", header)
    result = cli(*PLANAR, "--poses", poses, "-F", "json").json["result"]
    best = result["placements"][0]
    assert (best["reached"], len(result["poses"])) == (10, 10)
    assert np.hypot(best["x"] - 4, best["y"] + 2) < 1.5 * result["voxel_size"]
    assert best["worst_singular_value"] == min(pose["minimum_singular_value"] for pose in best["poses"])


def test_placement_as_a_table_csv_and_picture(cli, tmp_path):
    poses = circle(tmp_path / "poses.csv")
    table = cli(*PLANAR, "--poses", poses, "--plot", tmp_path / "place.png")
    assert max(len(line) for line in table.out.splitlines()) <= 80
    assert "where to place the base (base) for 10 poses of tool" in table.out
    assert (tmp_path / "place.png").stat().st_size > 10_000
    lines = cli(*PLANAR, "--poses", poses, "-F", "csv").out.splitlines()
    assert lines[0].startswith("rank,x [m],y [m],yaw [rad],reached,promised,worst_singular_value [m/rad]")
    assert [line.split(",")[0] for line in lines[1:]] == [str(i + 1) for i in range(len(lines) - 1)]


def test_poses_that_no_place_reaches_are_told(cli, tmp_path):
    poses = tmp_path / "poses.csv"
    poses.write_text("0.6,0.1,3.3,180,0,0\n0.9,-0.2,3.2,180,0,90\n")
    asked = ("map", "example:ur5_robot", "-f", "tool0", *FEW, "--poses", poses, "--deg")
    done = cli(*asked, "--plot", tmp_path / "place.svg")
    said = " ".join(done.out.split())
    assert done.code == 0
    assert "no position of the base is known that reaches any of the 2 poses: they are at z = 3.2 to 3.3 m" in said
    assert "the tool gets to z = " in said
    assert "rank" not in said
    assert "roll, pitch and yaw of the poses were read in degrees" in said
    assert len(cli(*asked, "-F", "csv").out.splitlines()) == 1
    result = cli(*asked, "-F", "json").json["result"]
    assert result["placements"] == []
    assert "z = 3.2 to 3.3 m" in result["placements_reason"]
    assert result["pose_angles_read_in"] == "deg"


def test_oriented_poses_of_a_real_arm(cli, tmp_path):
    poses = tmp_path / "poses.csv"
    poses.write_text("0.6,0.1,0.3,180,0,0\n0.9,-0.2,0.3,180,0,90\n0.7,0.3,0.5,170,0,45\n")
    asked = ("map", "example:ur5_robot", "-f", "tool0", "--length", "auto", "--samples", "100k", "--poses", poses)
    result = cli(*asked, "--deg", "-F", "json").json["result"]
    assert result["placements"][0]["reached"] == 3
    assert result["oriented"] is True


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--voxel", "0"), "voxel"),
        (("--voxel", "nan"), "voxel"),
        (("--voxel", "1e-6"), "would do"),
        (("--samples", "0"), "--samples takes a whole number"),
        (("--samples", "1e300"), "--samples takes a whole number"),
        (("--samples", "10", "--low-discrepancy", "10"), "does not go with"),
        (("--samples", "1e12"), "at most"),
        (("-f", "tol"), "did you mean 'tool'"),
        (("-f", "base"), "no joint moves"),
        (("--axes", "q"), "axis"),
        (("--length", "-1"), "--length"),
        (("--length", "long"), "--length"),
        (("--point", "1,2"), "--point"),
        (("--plot", "map.txt"), "suffix"),
        (("-o", "nowhere/map.npz", "--samples", "10"), "cannot write"),
        (("-o", "nowhere/map.vti", "--samples", "10"), "cannot write"),
        (("--poses", "nowhere.csv"), "no such file"),
        (("--poses", "nowhere.csv", "--approach", "0,0,1"), "poses say it themselves"),
        (("--approach", "0,0,0"), "an approach is a direction"),
        (("--approach", "nan,0,1"), "--approach"),
        (("--approach", "1,0,0", "--samples", "10"), "none of 10 configurations"),
        (("--reference", "world"), "'aligned', 'local'"),
        (("-o", "map.csv"), "-F csv"),
        (("-o", "map.json"), "-F json"),
        (("-o", "map.json", "-F", "csv"), "-F json"),
        (("-o", "map.vtk"), ".vti"),
        (("-o", "map.parquet"), ".npz"),
        (("-q", "joint1=nan"), "finite"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(cli, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    done = cli("map", "textbook:planar_2r", *arguments)
    assert done.code == 2
    assert done.out == ""
    lines = [line for line in done.err.splitlines() if line.startswith("kinetostat: error")]
    assert len(lines) == 1
    assert message in lines[0]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "no pose in it"),
        ("x,y,z\n", "no pose in it"),
        ("1,0,0\n1,oops,0\n", "row 2: 'oops' is not a number"),
        ("1,0,0\n1,0\n", "row 2"),
        ("1,0,0\n1,nan,0\n", "row 2"),
        ("0,0,0\n1e9,0,0\n", "too far apart"),
    ],
)
def test_a_bad_list_of_poses_is_told_by_its_row(cli, tmp_path, content, message):
    path = tmp_path / "poses.csv"
    path.write_text(content)
    done = cli(*PLANAR, "--poses", path)
    assert (done.code, done.out) == (2, "")
    assert message in done.err


def test_positions_alone_need_axes_that_do_not_turn(cli, tmp_path):
    done = cli("map", "textbook:planar_2r", *FEW, "--poses", circle(tmp_path / "poses.csv"))
    assert done.code == 2
    assert "without an orientation" in done.err


def test_engines_that_disagree_end_with_four(cli, monkeypatch):
    right = Kernel.__call__

    def wrong(kernel, q):
        found = right(kernel, q)
        return {**found, "singular_values": found["singular_values"] * (1 + 1e-6)}

    monkeypatch.setattr(Kernel, "__call__", wrong)
    done = cli(*PLANAR)
    assert done.code == 4
    assert "the engines disagree" in done.err


def test_a_map_that_is_interrupted_is_partial(cli, monkeypatch):
    def interrupted(work, chunk):
        if chunk == 2:
            raise KeyboardInterrupt
        return right(work, chunk)

    from kinetostat.analysis.capability.counting import MapWork

    right = MapWork.compute
    monkeypatch.setattr(MapWork, "compute", interrupted)
    done = cli("map", "textbook:planar_2r", "--axes", "xy", "--samples", "400k", "-j", "1")
    assert done.code == 130
    assert "PARTIAL map, interrupted: 131,072 of 400,000 configurations" in done.out
    assert "interrupted: 131072 of 400000 configurations are in the map" in done.err
