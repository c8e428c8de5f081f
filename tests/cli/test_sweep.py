"""`kinetostat sweep`: options, keys, rows of each kind, refusals, Ctrl-C; the same bytes for any number of threads."""

import csv
import io
import json
import re
import signal
from contextlib import contextmanager

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.sweeping.measures import MEASURES
from kinetostat.errors import UsageError
from kinetostat.screw.kernel import Kernel
from kinetostat_cli.counts import count

PANDA = ("example:panda", "-f", "panda_hand")
PLANAR = ("textbook:planar_2r", "--axes", "x", "y")
KEYS = {"count", "measures", "near_singular_share"}
CHUNK = 2**16


@pytest.fixture
def ask(cli):
    """Return the JSON object that is written, read strictly: no NaN, no Infinity."""

    def call(*words):
        answer = cli("sweep", *words, "-F", "json")
        assert answer.code == 0, answer.err
        return json.loads(answer.out, parse_constant=pytest.fail)

    return call


@pytest.fixture
def rows(cli, tmp_path):
    """Return the rows of a sweep by column: of a file with one of the endings."""

    def call(*words, ending=".csv", code=0):
        path = tmp_path / f"rows{ending}"
        path.unlink(missing_ok=True)
        answer = cli("sweep", *words, "-o", path)
        assert (answer.code, answer.out) == (code, ""), answer.err
        return read(path)

    return call


def read(path):
    """Return the columns of a file of rows, without units in their names."""
    if path.suffix == ".csv":
        with path.open(newline="") as text:
            header, *lines = csv.reader(text)
        cells = np.array([[float(cell) if cell else np.nan for cell in line] for line in lines])
        return {re.sub(r" \[.*\]$", "", name): cells[:, i] for i, name in enumerate(header)}
    if path.suffix == ".npz":
        with np.load(path) as found:
            known, columns = json.loads(str(found["about"])), {"row": found["row"].astype(float)}
            for field in known["fields"]:
                values = found[field["name"]].reshape(len(found["row"]), -1)
                columns |= dict(zip(field["columns"], values.T, strict=True))
        return columns
    from pyarrow import parquet

    table = parquet.read_table(path)
    return {name: table[name].to_numpy().astype(float) for name in table.column_names}


def flattened(text):
    return " ".join(text.split())


# --- the summary ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "question",
    [
        (*PANDA, "--samples", "300"),
        (*PANDA, "--low-discrepancy", "300", "--length", "auto", "--measures", "isotropy,singular_values,position"),
        (*PLANAR, "--grid", "joint1=0:1:4,joint2=-1:1:5", "--below", "yoshikawa=0.3"),
        ("example:ur5_robot", "-f", "tool0", "--samples", "200", "--measures", "gravity_torque,effort_use"),
    ],
    ids=" ".join,
)
def test_the_documented_keys(ask, question):
    answer = ask(*question)
    assert answer["schema"] == "kinetostat/sweep/1"
    assert set(answer) == {"schema", "robot", "configuration", "result", "crosscheck", "warnings"}
    assert answer["crosscheck"]["agree"] is True
    result = answer["result"]
    assert set(result) >= KEYS
    assert result["complete"] is True
    assert result["certified"]["count"] > 0
    assert (result["near_singular_share"] is None) == ("near_singular_share_reason" in result)
    for found in result["measures"].values():
        assert set(found) >= {"unit", "quantiles", "mean", "minimum", "maximum", "histogram"}
        assert list(found["minimum"]["configuration"]) == result["coordinates"]
        quantiles = list(found["quantiles"].values())
        assert sorted(quantiles) == quantiles
        assert found["minimum"]["value"] <= quantiles[0] <= quantiles[-1] <= found["maximum"]["value"]
        assert sum(found["histogram"]["counts"]) == found["count"] == result["count"] - found["invalid"]


def test_the_same_bytes_for_any_number_of_threads(cli):
    words = ("sweep", *PLANAR, "--samples", "200k", "--measures", "yoshikawa,position", "--below", "position.x=0.1")
    found = {cli(*words, *more, "-F", "json").out for more in (("-j", "1"), ("-j", "2"), ("-j", "5"), ("-j", "0"), ())}
    (text,) = found
    assert json.loads(text)["result"]["count"] == 200_000


def test_seeds(cli):
    def out(*more):
        return cli("sweep", *PLANAR, "--samples", "100", "-F", "json", *more).out

    assert out() == out("--seed", "0")
    assert out("--seed", "1") != out("--seed", "2")


def test_extremes_of_a_planar_arm_are_the_textbook_ones(ask):
    """w = l1 l2 |sin q2|, and x from l1 + l2 down, at positions that the grid has."""
    grid = ("--grid", "joint1=0:90:3,joint2=-180:180:361", "--deg")
    measures = "yoshikawa,position,minimum_singular_value"
    result = ask(*PLANAR, *grid, "--measures", measures, "--below", "yoshikawa=1e-9", "--near", "1e-3")["result"]
    best, x = result["measures"]["yoshikawa"], result["measures"]["position.x"]
    assert best["maximum"]["value"] == pytest.approx(0.8, rel=1e-12)
    assert abs(best["maximum"]["configuration"]["joint2"]) == pytest.approx(np.pi / 2)
    assert best["mean"] == pytest.approx(0.8 * 2 / np.pi, rel=1e-2)
    assert x["maximum"] == {"value": 1.8, "row": 181, "configuration": {"joint1": 0, "joint2": 0}}
    (below,) = result["below"]
    assert (below["count"], below["share"]) == (9, pytest.approx(9 / 1083))
    assert result["near_singular_share"] == pytest.approx(9 / 1083)


def test_numbers_agree_between_table_csv_and_json(cli, ask):
    words = (*PANDA, "--samples", "500", "--measures", "yoshikawa,position,isotropy")
    result = ask(*words)["result"]
    listed = {row["measure"]: row for row in csv.DictReader(io.StringIO(cli("sweep", *words, "-F", "csv").out))}
    page = cli("sweep", *words).out
    assert list(listed) == list(result["measures"])
    for name, found in result["measures"].items():
        assert float(listed[name]["mean"]) == found["mean"]
        assert float(listed[name]["maximum"]) == found["maximum"]["value"]
        assert float(listed[name]["quantile_0.05"]) == found["quantiles"]["0.05"]
        label = re.escape(name.removeprefix("position."))  # which is the title of a table
        (line,) = re.findall(rf"^{label} +(?!min|max)\S+ +-?\d.*$", page, re.MULTILINE)
        assert f"{found['quantiles']['0.5']:.3g}" in line.split()
        assert line.split()[-1] == f"{found['maximum']['value']:.3g}"


def test_other_joints_are_held(ask):
    words = (*PLANAR, "--grid", "joint2=0.5:0.5:1", "--measures", "position")
    held = ask(*words, "-q", "joint1=0.3")
    assert held["configuration"]["joint1"] == 0.3
    x = held["result"]["measures"]["position.x"]["mean"]
    assert x == pytest.approx(np.cos(0.3) + 0.8 * np.cos(0.8))


def test_a_payload_gravity_and_effort_limits_as_torque_has_them(ask, cli):
    joints = {f"panda_joint{i + 1}": x for i, x in enumerate((0.1, -0.5, 0.3, -1.5, 0.2, 1.2, 0.4))}
    grid, q = (",".join(form.format(name, x) for name, x in joints.items()) for form in ("{0}={1}:{1}:1", "{0}={1}"))
    bearing = ("--payload", "2@0.1,0,0.2", "--effort-limits", "panda_joint2=50,panda_joint4=-1000:20")
    result = ask(
        *(*PANDA, "--grid", grid, "--measures", "gravity_torque,effort_use"),
        *(*bearing, "--gravity-vector", "1,0,-9"),
    )["result"]
    single = cli("torque", *PANDA, "-q", q, *bearing, "--gravity-vector", "1,0,-9", "-F", "json").json["result"]
    for name, torque in single["total"].items():
        if name not in result["coordinates"]:
            continue
        assert result["measures"][f"gravity_torque.{name}"]["mean"] == pytest.approx(torque, rel=1e-10, abs=1e-10)
        use = result["measures"][f"effort_use.{name}"]["mean"]
        assert use == pytest.approx(single["utilisation"][name], rel=1e-10)
    assert result["measures"]["effort_use"]["mean"] == pytest.approx(max(single["utilisation"].values()), rel=1e-10)


def test_what_has_no_number_is_null_with_a_reason_and_a_warning(cli):
    """Effort limits that a file does not state: as `torque`, the rest is answered."""
    answer = cli(
        "sweep", "example:solo12", "-f", "FL_FOOT", "--samples", "50", "--measures", "effort_use", "-F", "json"
    )
    limited = cli(
        *("sweep", "textbook:planar_2r", "--samples", "50", "--measures", "effort_use"),
        *("--gravity-vector", "0,-9.81,0", "-F", "json"),
    )
    assert limited.json["result"]["measures"]["effort_use"]["invalid"] == 0
    result = answer.json["result"]["measures"]
    for name, found in result.items():
        assert (found["mean"] is None) == (found["count"] == 0) == ("reason" in found), name


# --- pages ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "question",
    [
        (*PANDA, "--samples", "300", "--below", "minimum_singular_value=0.05"),
        (*PANDA, "--samples", "300", "--measures", ",".join(m for m in MEASURES if MEASURES[m].summary)),
        (*PANDA, "--samples", "300", "--measures", "yoshikawa", "--deg", "--length", "0.3"),
        ("example:talos_full_v2", "-f", "arm_left_7_link", "--samples", "100", "-q", "random:3"),
        ("textbook:scara", "--low-discrepancy", "100", "--measures", "gravity_torque,effort_use,limit_distance"),
        (*PLANAR, "--grid", "joint1=0:0:1", "--measures", "yoshikawa"),
        ("tests/corpus/files/nm_10k.urdf", "--samples", "10"),
    ],
    ids=" ".join,
)
def test_pages_fit_and_say_units(cli, question, request):
    if question[0].startswith("tests/"):
        question = (request.config.rootpath / question[0], *question[1:])
    answer = cli("sweep", *question)
    assert answer.code == 0, answer.err
    assert max(map(len, answer.out.splitlines())) <= 80
    assert "unit" in answer.out
    assert "agree: largest difference" in flattened(answer.out)
    assert "a second" in answer.err  # how fast it was differs from run to run
    assert "a second" not in answer.out


def test_the_page_in_words(cli):
    page = flattened(cli("sweep", *PANDA, "--samples", "2k", "--seed", "7", "--below", "yoshikawa=0.05").out)
    assert "sweep of 2,000 configurations: random" in page
    assert "seed 7" in page
    assert "of the origin of panda_hand, relative to panda_link0" in page
    assert "yoshikawa below 0.05" in page
    assert "near-singular" in page
    assert "smallest singular value" in page
    assert "smallest / largest" in page
    assert "characteristic length 0.375" in page
    assert "configurations of the extremes" in page
    assert "computed again by Pinocchio" in page


def test_degrees_are_shown_in_degrees(cli):
    page = cli("sweep", *PLANAR, "--grid", "joint2=0:90:2", "--deg", "--measures", "yoshikawa").out
    assert "90.00000" in page
    assert "deg" in page


def test_help_names_every_measure(cli):
    said = cli("sweep", "--help").out
    assert [name for name in MEASURES if not re.search(rf"\b{name}\b", said)] == []


# --- rows ----------------------------------------------------------------------------------------------------------

ALL = ",".join(MEASURES)


@pytest.mark.parametrize("ending", [".csv", ".npz", ".parquet"])
def test_rows_are_the_same_numbers_in_every_file(rows, ending):
    words = (*PLANAR, "--samples", "66k", "--measures", "yoshikawa")  # two chunks
    first, other = rows(*words, "-j", "1"), rows(*words, "-j", "3", ending=ending)
    assert list(first) == list(other)
    for name, column in first.items():
        assert column.tobytes() == other[name].tobytes(), name
    assert first["row"].tolist() == list(range(1, 66_001))


@pytest.mark.parametrize("ending", [".csv", ".npz", ".parquet"])
def test_rows_are_the_numbers_of_the_library(rows, ending):
    found = rows(*PANDA, "--low-discrepancy", "60", "--measures", ALL, "--length", "0.4", ending=ending)
    model = ks.load("example:panda")
    joints = [f"panda_joint{i}" for i in range(1, 8)]
    for i in range(0, 60, 7):
        q = ks.configuration(model, {name: float(found[name][i]) for name in joints}).q
        jacobian = ks.jacobian(model, "panda_hand", q).matrix
        mine = [[found[f"jacobian.{row}.{name}"][i] for name in joints] for row in ("vx", "vy", "vz", "wx", "wy", "wz")]
        np.testing.assert_allclose(mine, jacobian, rtol=0, atol=1e-12)
        block = ks.manipulability(model, "panda_hand", q, length=0.4).blocks["full"]
        values = [found[f"singular_values.s{k}"][i] for k in range(1, 7)]
        np.testing.assert_allclose(values, block.singular_values, rtol=0, atol=1e-11)
        assert found["yoshikawa"][i] == pytest.approx(float(block.yoshikawa), rel=1e-9)
        assert found["isotropy"][i] == pytest.approx(float(block.isotropy), rel=1e-9)
        assert found["inverse_condition_number"][i] == pytest.approx(float(block.inverse_condition_number), rel=1e-9)
        placed = ks.fk(model, "panda_hand", q)
        assert [found[f"position.{x}"][i] for x in "xyz"] == pytest.approx(placed.position.tolist(), abs=1e-12)
        held = ks.torque(model, q, gravity=True)
        torques = dict(zip(held.columns, held.total.tolist(), strict=True))
        assert [found[f"gravity_torque.{n}"][i] for n in joints] == pytest.approx(
            [torques[n] for n in joints], abs=1e-9
        )


def test_shapes_of_arrays(cli, tmp_path):
    cli("sweep", *PANDA, "--samples", "10", "--measures", "yoshikawa,jacobian,position", "-o", tmp_path / "rows.npz")
    with np.load(tmp_path / "rows.npz") as found:
        shapes = {name: found[name].shape for name in found.files if name != "about"}
        known = json.loads(str(found["about"]))
    expected = {"row": (10,), "q": (10, 7), "yoshikawa": (10,), "jacobian": (10, 6, 7), "position": (10, 3)}
    assert shapes == expected
    assert known["schema"] == "kinetostat/sweep.rows/1"
    assert known["robot"]["name"] == "panda"


def test_rows_on_standard_output(cli):
    words = ("sweep", *PLANAR, "--grid", "joint1=0:1:3", "--measures", "yoshikawa", "-o", "-")
    answer = cli(*words)
    lines = answer.out.splitlines()
    assert answer.code == 0
    assert lines[0].startswith("row,joint1 [rad],joint2 [rad],yoshikawa")
    assert [line.split(",")[:2] for line in lines[1:]] == [["1", "0.0"], ["2", "0.5"], ["3", "1.0"]]
    assert "3 rows" in answer.err
    assert "agree" in answer.err


def test_a_summary_goes_to_a_file_when_it_is_asked_for(cli, tmp_path):
    words = ("sweep", *PLANAR, "--samples", "20")
    for name, more in (("a.txt", ("--summary",)), ("a.json", ("-F", "json")), ("a.csv", ("--summary", "-F", "csv"))):
        answer = cli(*words, *more, "-o", tmp_path / name)
        assert (answer.code, answer.out) == (0, ""), answer.err
        assert "yoshikawa" in (tmp_path / name).read_text()
    assert json.loads((tmp_path / "a.json").read_text())["result"]["count"] == 20


# --- lists ---------------------------------------------------------------------------------------------------------


def test_a_trajectory_with_bad_rows(cli, rows, tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("joint1,joint2\n0,0.5\n0,x\n0,1.5\n0\n0,2.5\n")
    words = (*PLANAR, "--trajectory", path, "--measures", "yoshikawa")
    found = rows(*words)
    assert found["row"].tolist() == [1, 3, 5]
    assert found["joint2"].tolist() == [0.5, 1.5, 2.5]
    np.testing.assert_allclose(found["yoshikawa"], 0.8 * np.sin([0.5, 1.5, 2.5]), rtol=1e-12)
    answer = cli("sweep", *words, "-F", "json")
    assert "(line 3): joint2: 'x' is not a number" in answer.err
    assert "(line 5): 1 cells, 2 are needed" in answer.err
    extremes = answer.json["result"]["measures"]["yoshikawa"]
    assert (extremes["maximum"]["row"], extremes["minimum"]["row"]) == (3, 1)


def test_a_list_that_moves_other_joints_too(cli, tmp_path):
    path = tmp_path / "way.json"
    path.write_text('[{"panda_joint1": 0.1, "panda_finger_joint1": 0.02}, {"panda_joint2": 0.3}]')
    answer = cli("sweep", *PANDA, "--trajectory", path)
    assert answer.code == 0
    assert "'panda_finger_joint1'" in answer.err
    assert "held" in answer.err


def test_many_bad_rows_are_counted(cli, tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("0,0\n" + "x,0\n" * 20)
    said = cli("sweep", *PLANAR, "--trajectory", path).err
    assert said.count("left out: row") == 5
    assert "15 more rows are left out" in said
    path.write_text("x,0\n" * 2)
    answer = cli("sweep", *PLANAR, "--trajectory", path)
    assert answer.code == 2
    assert "no row can be used" in answer.err


# --- refusals ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "give one of --samples, --low-discrepancy, --grid, --trajectory"),
        (("--samples", "10", "--grid", "joint1=0:1:2"), "--samples does not go with --grid"),
        (("--samples", "0"), "whole number from 1"),
        (("--samples", "1e13"), "whole number from 1"),
        (("--samples", "1.5"), "whole number from 1"),
        (("--low-discrepancy", "many"), "--low-discrepancy takes a whole number"),
        (("--grid", "joint1=0:1"), "is no axis of a grid"),
        (("--grid", "joint1=0:1:2:3"), "is no axis of a grid"),
        (("--grid", "joint1=0:1:0"), "is no axis of a grid"),
        (("--grid", "joint1=a:1:2"), "is no axis of a grid"),
        (("--grid", "joint9=0:1:2"), "did you mean 'joint2', 'joint1'?"),
        (("--grid", "joint1=0:1:1e9,joint2=0:1:1e9"), "1e+12"),
        (("--trajectory", "nowhere.csv"), "there is no such file"),
        (("--samples", "10", "--measures", "yoshikava"), "did you mean 'yoshikawa'"),
        (("--samples", "10", "--measures", ""), "measure"),
        (("--samples", "10", "--below", "yoshikawa"), "measure=number"),
        (("--samples", "10", "--below", "yoshikawa=1,yoshikawa=2"), "twice"),
        (("--samples", "10", "--below", "yoshikava=1"), "yoshikawa"),
        (("--samples", "10", "--measures", "jacobian"), "rows"),
        (("--grid", "joint1=0:1:2", "--seed", "3"), "--seed"),
        (("--samples", "10", "--seed", "-1"), "seed"),
        (("--samples", "10", "-o", "rows.xlsx"), ".csv, .npz or .parquet; or add --summary"),
        (("--samples", "10", "--summary", "-o", "rows.npz"), "no .npz file (leave out --summary for rows)"),
        (("--samples", "10", "-F", "json", "-o", "rows.parquet"), "no .parquet file (leave out -F json for rows)"),
        (("--samples", "10", "--summary", "-o", "z.json"), "no .json file (-F json)"),
        (("--samples", "10", "-o", "z.json"), "no .json file (-F json for the summary"),
        (("--samples", "10", "--summary", "-o", "z.csv"), "--summary -F csv for the summary"),
        (("--samples", "10", "--summary", "-F", "csv", "-o", "z.json"), "(-F json)"),
        (("--samples", "10", "-F", "csv", "-o", "z.npz"), "(leave out -F csv)"),
        (("--samples", "10", "--above", "yoshikawa"), "--above: 'yoshikawa' is not of the form measure=number"),
        (("--samples", "10", "--above", "isotropy=1", "--above", "isotropy=2"), "twice"),
        (("--samples", "10", "--below", "jacobian.vx.joint1=2"), "no measured column"),
        (("--samples", "10", "--measures", "isotropy", "--measures", "isotropy"), "named twice"),
        (("--grid", "joint1=0:1:2", "--grid", "joint1=0:1:2"), "in the grid twice"),
        (("--samples", "10", "--near", "2"), "between 0 and 1"),
        (("--trajectory", "nowhere.npz"), "there is no such file"),
        (("--trajectory", "nowhere.parquet"), "there is no such file"),
        (("--samples", "10", "-o", "rows.csv", "--checkpoint", "x"), "--checkpoint"),
        (("--samples", "10", "--plot", "x.gif"), ".svg"),
        (("--samples", "10", "-j", "2", "--scheduler", "tcp://127.0.0.1:1"), "--jobs"),
        (("--samples", "10", "--measures", "effort_use", "--payload", "heavy"), "--payload takes KG"),
        (("--samples", "10", "--payload", "2"), "--payload belongs to weight"),
        (("--samples", "10", "--effort-limits", "joint1=3"), "--effort-limits belongs to weight"),
        (("--samples", "10", "-f", "base"), "no joint moves"),
        (("--samples", "10", "-f", "tol"), "did you mean 'tool'"),
        (("--samples", "10", "--point", "1,2"), "--point"),
        (("--samples", "10", "--length", "-1"), "length"),
        (("--samples", "10", "--axes", "q"), "axis"),
    ],
    ids=lambda part: " ".join(part) if isinstance(part, tuple) else None,
)
def test_refusals_are_one_line_and_leave_nothing(cli, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    answer = cli("sweep", "textbook:planar_2r", *words)
    assert (answer.code, answer.out) == (2, "")
    (line,) = answer.err.splitlines()
    assert line.startswith("kinetostat: error: ")
    assert said in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "value"), [("1", 1), ("100k", 10**5), ("10M", 10**7), ("1e8", 10**8), ("2.5k", 2500), ("1G", 10**9)]
)
def test_counts(text, value):
    assert count(text, "--samples") == value


@pytest.mark.parametrize(
    "text", ["", "k", "-1", "0", "1e999999999", "nan", "inf", "1.5", "10 M x", "0.0001k", "1e400k"]
)
def test_what_is_no_count(text):
    with pytest.raises(UsageError, match="whole number"):
        count(text, "--samples")


# --- what goes wrong -----------------------------------------------------------------------------------------------


@pytest.fixture
def interrupted(monkeypatch):
    """Press Ctrl-C when the first chunks are done."""
    from kinetostat.analysis.sweeping import running
    from kinetostat_cli import runs

    @contextmanager
    def bar():
        pressed = []

        def tell(_what, share):
            if share > 0 and not pressed:
                pressed.append(share)
                signal.raise_signal(signal.SIGINT)

        yield tell

    monkeypatch.setattr(running, "_TOLD_EVERY", 0.0)
    monkeypatch.setattr(runs, "progress_bar", bar)


def test_a_summary_that_is_interrupted_is_told_and_partial(cli, interrupted):
    answer = cli("sweep", *PLANAR, "--samples", "10M", "-j", "2")
    assert answer.code == 130
    assert answer.out.startswith("PARTIAL sweep, interrupted: ")
    assert "of 10,000,000 configurations" in flattened(answer.out)
    assert "interrupted" in answer.err
    assert "Traceback" not in answer.err
    as_json = cli("sweep", *PLANAR, "--samples", "10M", "-F", "json")
    result = json.loads(as_json.out)["result"]
    assert (as_json.code, result["complete"], result["requested"]) == (130, False, 10**7)
    assert 0 < result["count"] < 10**7
    assert result["count"] % CHUNK == 0


@pytest.mark.parametrize("ending", [".csv", ".npz", ".parquet"])
def test_rows_that_are_interrupted_leave_no_file(cli, interrupted, tmp_path, ending):
    answer = cli("sweep", *PLANAR, "--samples", "10M", "-o", tmp_path / f"rows{ending}")
    assert (answer.code, answer.out) == (130, "")
    assert "no file is left" in answer.err
    assert list(tmp_path.iterdir()) == []


def test_a_checkpoint_goes_on_where_a_summary_was_interrupted(cli, interrupted, tmp_path, monkeypatch):
    words = ("sweep", *PLANAR, "--samples", "500k", "-F", "json")
    first = cli(*words, "--checkpoint", tmp_path)
    assert first.code == 130
    monkeypatch.undo()
    assert cli(*words, "--checkpoint", tmp_path).out == cli(*words).out


@pytest.mark.parametrize("ending", [None, ".csv"])
def test_a_kernel_that_is_wrong_is_found_out(cli, tmp_path, monkeypatch, ending):
    """The screws of the compiled kernel against Pinocchio: one wrong digit, and nobody is to trust the numbers."""
    right = Kernel.__call__

    def wrong(self, q):
        return {name: values * (1 + 1e-7) for name, values in right(self, q).items()}

    monkeypatch.setattr(Kernel, "__call__", wrong)
    answer = cli("sweep", *PANDA, "--samples", "100", *(() if ending is None else ("-o", tmp_path / "rows.csv")))
    assert answer.code == 4
    assert "the engines disagree" in answer.err


def test_without_cross_check(cli, ask):
    answer = ask(*PLANAR, "--samples", "10", "--no-crosscheck")
    assert answer["crosscheck"]["max_difference"] is None
    assert "not cross-checked" in cli("sweep", *PLANAR, "--samples", "10", "--no-crosscheck").out


def test_a_scheduler_that_is_not_there(cli, monkeypatch):
    from kinetostat.analysis.sweeping import cluster

    monkeypatch.setattr(cluster, "_PATIENCE", 0.3)
    answer = cli("sweep", *PLANAR, "--samples", "10", "--scheduler", "tcp://127.0.0.1:1")
    assert answer.code == 2
    assert "no Dask scheduler at 'tcp://127.0.0.1:1'" in answer.err


def test_a_plot(cli, tmp_path):
    answer = cli("sweep", *PANDA, "--samples", "500", "--plot", tmp_path / "how_often.svg")
    assert answer.code == 0
    assert "smallest singular value" in (tmp_path / "how_often.svg").read_text()
    answer = cli("sweep", *PLANAR, "--grid", "joint1=0:1:3,joint2=-1:1:4", "--plot", tmp_path / "map.svg")
    assert answer.code == 0
    assert "where it is smallest" in (tmp_path / "map.svg").read_text()


# --- what is asked for, and what is said of it ---------------------------------------------------------------------


def test_options_that_are_given_twice_are_added(ask):
    """The last one alone would be an answer to another question."""
    once = ask(*PLANAR, "--grid", "joint1=0:1:3,joint2=0:1:5", "--measures", "yoshikawa,isotropy")["result"]
    twice = ask(
        *(*PLANAR, "--grid", "joint1=0:1:3", "--grid", "joint2=0:1:5"),
        *("--measures", "yoshikawa", "--measures", "isotropy"),
    )["result"]
    assert twice == once
    assert twice["count"] == 15
    limits = ("--effort-limits", "joint1=5", "--effort-limits", "joint2=6", "--measures", "effort_use")
    result = ask(*PLANAR, "--samples", "9", *limits, "--below", "effort_use=1", "--below", "isotropy=1")["result"]
    assert result["asked"]["effort_limits"] == {"joint1": 5, "joint2": 6}
    assert [one["measure"] for one in result["below"]] == ["effort_use", "isotropy"]


def test_a_measure_that_only_a_threshold_names_is_measured(ask, cli):
    words = (*PLANAR, "--samples", "400", "--measures", "yoshikawa", "--above", "position.x=0.5", "--payload", "2")
    result = ask(*words, "--below", "effort_use=0.2", "--gravity-vector", "0,-9.81,0")["result"]
    assert {"yoshikawa", "position.x", "effort_use"} <= set(result["measures"])
    (above,) = [one for one in result["above"] if one["measure"] == "position.x"]
    assert 0 < above["share"] < 1
    refused = cli("sweep", *words)
    assert "--payload belongs to weight" in refused.err


def test_how_often_an_effort_limit_is_exceeded(ask, cli, rows):
    words = (*PANDA, "--low-discrepancy", "3000", "--measures", "effort_use", "--payload", "9@0,0,0.1")
    result = ask(*words, "--above", "effort_use=0.5")["result"]
    uses = rows(*words)
    shares = {(one["measure"], one["threshold"]): one["share"] for one in result["above"]}
    assert shares["effort_use", 0.5] == pytest.approx(np.mean(uses["effort_use"] > 0.5))
    for name in result["measures"]:
        assert shares[name, 1.0] == pytest.approx(np.mean(uses[name] > 1))
    page = flattened(cli("sweep", *words).out)
    largest = max((max(values), name) for name, values in uses.items() if name.startswith("effort_use."))
    joint = largest[1].removeprefix("effort_use.")
    assert f"largest effort use: {joint}, {100 * largest[0]:.3g} %; over its limit in" in page
    assert "payload 9 kg at (0, 0, 0.1) m of panda_hand" in page
    (line,) = re.findall(r"effort use +% +.*? ([\d.]+)(?= )", page)[:1]
    assert float(line) < 100 * largest[0]


def test_the_answer_says_what_it_was_computed_for(ask, cli):
    weight = ("--measures", "gravity_torque", "--payload", "3", "--gravity-vector", "0,0,-1.62")
    words = (*PANDA, "--grid", "panda_joint2=0:0.5:3", "-q", "panda_joint1=0.3,panda_joint4=-1", *weight)
    answer = ask(*words, "--point", "0,0,0.1", "--axes", "xyz")
    asked = answer["result"]["asked"]
    assert asked["payload"] == {"mass": 3, "frame": "panda_hand", "point": [0, 0, 0]}
    assert asked["gravity"] == [0, 0, -1.62]
    assert (asked["frame"], asked["relative_to"], asked["point"]) == ("panda_hand", "panda_link0", [0, 0, 0.1])
    assert (asked["reference"], asked["rows"]) == ("aligned", ["vx", "vy", "vz"])
    assert asked["characteristic_length"] is None  # nothing mixes
    assert asked["held"]["panda_joint1"] == 0.3
    assert "panda_joint2" not in asked["held"]
    assert "panda_joint2" not in answer["configuration"]
    assert answer["configuration"]["panda_joint4"] == -1
    assert answer["result"]["source"]["grid"] == [
        {"coordinate": "panda_joint2", "unit": "rad", "from": 0, "to": 0.5, "count": 3}
    ]
    page = flattened(cli("sweep", *words).out)
    assert "gravity (0, 0, -1.62) m/s2" in page
    assert "payload 3 kg" in page
    assert "other joints at panda_joint1 0.3, panda_joint4 -1 (m, rad; others zero)" in page
    drawn = ask(*PANDA, "--samples", "10")
    assert [name for name in drawn["configuration"] if "finger" not in name] == []
    assert drawn["result"]["asked"]["gravity"] is None  # nothing weighs


@pytest.mark.parametrize("ending", [".npz", ".parquet"])
def test_files_of_rows_say_what_they_are(cli, tmp_path, ending):
    path = tmp_path / f"rows{ending}"
    words = (
        "--grid",
        "joint1=0:1:3",
        "--grid",
        "joint2=-1:1:5",
        "--point",
        "0.1,0,0",
        "--measures",
        "yoshikawa,effort_use",
    )
    assert cli("sweep", "textbook:planar_2r", *words, "--axes", "x", "y", "--payload", "2", "-o", path).code == 0
    if ending == ".npz":
        with np.load(path) as found:
            known = json.loads(str(found["about"]))
            assert found["grid.joint1"].tolist() == [0, 0.5, 1]
            assert found["grid.joint2"].tolist() == [-1, -0.5, 0, 0.5, 1]
            shape = [axis["count"] for axis in known["source"]["grid"]]
            assert np.array_equal(found["q"].reshape(*shape, 2)[:, 2, 0], found["grid.joint1"])
    else:
        from pyarrow import parquet

        known = json.loads(parquet.read_metadata(path).metadata[b"kinetostat"])
        early = json.loads(parquet.read_schema(path).metadata[b"kinetostat"])
        assert early["asked"] == known["asked"]
    assert known["asked"]["point"] == [0.1, 0, 0]
    assert known["asked"]["rows"] == ["vx", "vy"]
    assert known["asked"]["payload"]["mass"] == 2
    assert known["crosscheck"]["agree"] is True
    assert known["certified"]["count"] > 0
    assert [axis["coordinate"] for axis in known["source"]["grid"]] == ["joint1", "joint2"]
    assert {unit for field in known["fields"] for unit in field["units"]} == {"rad", "(m/rad)^2", "1"}


@pytest.mark.parametrize("ending", [".csv", ".npz", ".parquet"])
def test_rows_are_read_again(cli, rows, tmp_path, ending):
    first = rows(*PLANAR, "--samples", "20", ending=ending)
    source = (tmp_path / f"rows{ending}").rename(tmp_path / f"before{ending}")
    again = rows(*PLANAR, "--trajectory", source)
    assert list(again) == list(first)
    for name, column in first.items():
        assert column.tobytes() == again[name].tobytes(), name


def test_what_is_no_archive_of_rows_is_refused(cli, tmp_path):
    (tmp_path / "x.npz").write_bytes(b"PK nothing")
    np.savez(tmp_path / "y.npz", q=np.zeros((3, 2)))
    for name in "xy":
        answer = cli("sweep", *PLANAR, "--trajectory", tmp_path / f"{name}.npz")
        assert (answer.code, "no rows that sweep has written" in answer.err) == (2, True)
    cli("sweep", *PLANAR, "--samples", "3", "-o", tmp_path / "z.npz")
    answer = cli("sweep", *PANDA, "--trajectory", tmp_path / "z.npz")
    assert (answer.code, "there is no joint 'joint1'" in answer.err) == (2, True)


def test_a_trajectory_with_time_and_units_is_read(cli, rows, tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("time [s],joint2 [deg]\n0,30\n0.1,90\n")
    found = rows(*PLANAR, "--trajectory", path, "-q", "joint1=0.2", "--measures", "position")
    assert found["joint1"].tolist() == [0.2, 0.2]
    np.testing.assert_allclose(found["joint2"], np.radians([30, 90]), rtol=1e-15)


# --- limits --------------------------------------------------------------------------------------------------------


def test_a_grid_that_leaves_limits_says_so_once(cli):
    said = cli("sweep", *PANDA, "--grid", "panda_joint2=-500:500:3", "--deg").err
    assert said.count("warning") == 1
    assert "3 of 3 configurations are outside limits: of 'panda_joint2', 'panda_joint4'" in said  # 4: at zero
    said = cli("sweep", *PANDA, "--grid", "panda_joint2=-120:0:3", "--deg", "-q", "panda_joint4=-60").err
    assert "1 of 3 configurations are outside limits: of 'panda_joint2'" in said
    assert said.count("outside") == 1


def test_joints_that_are_swept_are_not_said_to_be_outside(cli):
    said = cli("sweep", *PANDA, "--samples", "10", "-q", "panda_joint1=0.2").err  # which puts joint 4 at zero
    assert "outside" not in said
    said = cli("sweep", *PANDA, "--samples", "10", "-q", "panda_finger_joint1=2").err
    assert "joint 'panda_finger_joint1' is at 2 m, outside" in said


def test_a_list_that_leaves_limits_says_so(cli, tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("panda_joint4\n-1\n-9\n0\n")
    said = cli("sweep", *PANDA, "--trajectory", path).err
    assert "2 of 3 configurations are outside limits: of 'panda_joint4'" in said


# --- pages that say all --------------------------------------------------------------------------------------------


def test_names_are_never_cut(cli):
    for words in (("--axes", "xyz"), ("--measures", ",".join(m for m in MEASURES if MEASURES[m].summary))):
        page = cli("sweep", *PANDA, "--samples", "500", *words).out
        assert ".." not in page
        assert max(map(len, page.splitlines())) <= 80


def test_what_is_left_out_is_told(cli):
    page = flattened(cli("sweep", *PANDA, "--samples", "500", "--measures", "gravity_torque,effort_use,position").out)
    assert "the same everywhere: gravity torque panda_joint1 0, effort use panda_joint1 0" in page
    assert "extremes of 8 of 16 columns are shown; -F json has all" in page
    assert "gravity torque panda_joint2 min" in page
    assert "gravity torque panda_joint7 min" not in page  # the smallest by far


def test_a_run_from_a_checkpoint_says_so(cli, tmp_path):
    words = ("sweep", *PLANAR, "--samples", "1000", "--checkpoint", tmp_path)
    assert "done before" not in cli(*words).err
    assert "were done before: the checkpoint has them" in cli(*words).err


def test_lengths(ask):
    default, auto = ask(*PANDA, "--samples", "50"), ask(*PANDA, "--samples", "50", "--length", "auto")
    assert default == auto
    assert default["warnings"] == []
    assert default["result"]["measures"]["yoshikawa"]["unit"] == "1"
    mixed = ask(*PANDA, "--samples", "50", "--length", "none")
    assert "m and rad are mixed" in mixed["warnings"][0]
    rows = ("--axes", "xyz", "rx", "ry", "rz")
    slides = ask("textbook:skew_1p", "--samples", "50", *rows)  # no joint turns: there is no length
    assert slides["result"]["asked"]["characteristic_length"] is None
    assert "no turn moves a linear row that counts" in slides["result"]["asked"]["characteristic_length_reference"]
    assert slides["result"]["measures"]["yoshikawa"]["unit"] == "1"
    assert not any("mixed" in line for line in slides["warnings"])
