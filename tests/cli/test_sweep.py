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
    result = ask(*PLANAR, *grid, "--measures", measures, "--below", "yoshikawa=1e-9")["result"]
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
    assert "row 2 is left out: 'x' is not a number" in answer.err
    assert "row 4 is left out: 1 numbers are given, 2 are needed" in answer.err
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
    assert said.count("is left out") == 5
    assert "15 more rows are left out" in said
    path.write_text("x,0\n" * 2)
    answer = cli("sweep", *PLANAR, "--trajectory", path)
    assert answer.code == 2
    assert "no configuration in it" in answer.err


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
        (("--samples", "10", "--summary", "-o", "rows.npz"), "file of rows"),
        (("--samples", "10", "-F", "json", "-o", "rows.parquet"), "file of rows"),
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
    assert "minimum_singular_value" in (tmp_path / "how_often.svg").read_text()
