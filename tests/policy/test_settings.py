"""Settings files: found, read, and refused with the line and a remedy."""

from __future__ import annotations

import pickle
import time

import pytest

from kinetostat import UsageError
from kinetostat.policy.settings import Settings, find_settings, read_settings
from policy.policies import written

ROBOT = '[[robots]]\npath = "arm.urdf"\n\n[[robots.expect]]\n'
CHAIN = '[[robots]]\npath = "arm.urdf"\n\n[[robots.chains]]\n'
WHOLE = """
[check]
select = ["J", "I3"]
ignore = ["J205"]
fail-on = "warning"
samples = 5
seed = 3
timeout = 7.5
baseline = "known.json"
exclude = ["old/*.urdf"]

[check.per-path-ignores]
"left/*" = ["N", "K"]

[[robots]]
path = "arm.urdf"
srdf = "arm.srdf"
package-dirs = ["..", "meshes"]
xacro-args = { side = "left" }

[[robots.expect]]
kind = "mass"
at-most = 12

[[robots.expect]]
kind = "smallest-singular-value"
frame = "tool0"
at = ["home", "mid"]
at-least = 0.05

[[robots.chains]]
frame = "tool0"

[[robots.chains]]
name = "elbow"
base = "shoulder"
frame = "forearm"
payload = 2

[[robots]]
path = "example:panda"
"""


def test_reads_what_is_written(tmp_path):
    settings = read_settings(written(tmp_path, WHOLE))
    check, (arm, panda) = settings.check, settings.robots
    assert (check.select, check.ignore, check.fail_on) == (("J", "I3"), ("J205",), "warning")
    assert (check.samples, check.seed, check.timeout, check.baseline) == (5, 3, 7.5, "known.json")
    assert check.exclude == ("old/*.urdf",)
    assert check.per_path_ignores == {"left/*": ("N", "K")}
    assert (arm.path, arm.srdf, arm.package_dirs, arm.xacro_args) == (
        "arm.urdf", "arm.srdf", ("..", "meshes"), {"side": "left"},
    )  # fmt: skip
    assert [one.kind for one in arm.expect] == ["mass", "smallest-singular-value"]
    assert [one.place for one in arm.expect] == ["kinetostat.toml:21", "kinetostat.toml:25"]
    assert arm.expect[1].at == ("home", "mid")
    assert panda.expect == ()
    assert [(one.frame, one.base, one.name, one.payload) for one in arm.chains] == [
        ("tool0", "", "", None), ("forearm", "shoulder", "elbow", 2),
    ]  # fmt: skip
    assert panda.chains == ()


def test_an_empty_file_is_the_defaults(tmp_path):
    assert read_settings(written(tmp_path, "")) == Settings()


def test_settings_travel_to_other_processes(tmp_path):
    settings = read_settings(written(tmp_path, WHOLE))
    assert pickle.loads(pickle.dumps(settings)) == settings


def test_a_byte_order_mark_is_no_error(tmp_path):
    assert read_settings(written(tmp_path, "\ufeff[check]\nseed = 4\n")).check.seed == 4


def test_pyproject_has_the_same_under_its_table(tmp_path):
    whole = read_settings(written(tmp_path, WHOLE))
    text = WHOLE.replace("[check", "[tool.kinetostat.check").replace("[[robots", "[[tool.kinetostat.robots")
    project = read_settings(written(tmp_path, '[project]\nname = "x"\n' + text, "pyproject.toml"))
    assert project.check == whole.check
    assert [r.path for r in project.robots] == [r.path for r in whole.robots]
    assert [e.place for e in project.robots[0].expect] == ["pyproject.toml:23", "pyproject.toml:27"]
    assert [c.place for c in project.robots[0].chains] == ["pyproject.toml:33", "pyproject.toml:36"]


REFUSED = {
    "a key with a slip": ('[check]\nselct = ["J"]', 2, "check.selct: there is no key 'selct'", "did you mean 'select'"),
    "a table with a slip": ("[chekc]\n", 1, "no key 'chekc'", "did you mean 'check'"),
    "a key of an expectation": (ROBOT + 'kind = "mass"\nat-lest = 3', 6, "no key 'at-lest'", "did you mean 'at-least'"),
    "an underscore": (ROBOT + 'kind = "mass"\nat_least = 3', 6, "no key 'at_least'", "did you mean 'at-least'"),
    "where it is written": (ROBOT + 'kind = "mass"\nat-least = 3\nplace = "x"', 7, "no key 'place'", "there are"),
    "a kind": (ROBOT + 'kind = "smallest-singular"', 5, "no kind of expectation", "'smallest-singular-value'"),
    "no kind": (ROBOT + "at-least = 3", 4, "needs its kind", "golden"),
    "a kind that is no word": (ROBOT + "kind = 3", 5, "needs its kind", "golden"),
    "a missing key": (ROBOT + 'kind = "manipulability"', 4, "the key 'at-least' is missing", ""),
    "a missing path": ('[check]\n[[robots]]\nsrdf = "x"', 2, "the key 'path' is missing", ""),
    "an empty path": ('[[robots]]\npath = ""', 2, "robots[0].path", ""),
    "text for a list": ('[check]\n\nselect = "J"', 3, "expected a list, got text", ""),
    "a number for text": ("[check]\nbaseline = 3", 2, "expected text in quotation marks, got a whole number", ""),
    "true for a number": ("[check]\nsamples = true", 2, "expected a whole number, got true or false", ""),
    "half a sample": ("[check]\nsamples = 1.5", 2, "expected a whole number", ""),
    "a negative count": ("[check]\nsamples = -1", 2, "expected a whole number >= 0", ""),
    "no time at all": ("[check]\ntimeout = 0", 2, "expected a number > 0", ""),
    "a choice": ('[check]\nfail-on = "eror"', 2, "no choice 'eror'", "'error', 'warning', 'info'"),
    "a choice of an expectation": (
        ROBOT + 'kind = "degrees-of-freedom"\nequals = 3\nof = "joint"', 7, "no choice 'joint'", "'joints', 'frame'",
    ),
    "a table for a list": ('[robots]\npath = "x"', 1, "expected a list, got a table", ""),
    "a number for tables": ("robots = 3", 1, "expected a list", ""),
    "expectations that are none": ('[[robots]]\npath = "x"\nexpect = [3]', 3, "expected a table", ""),
    "two coordinates of a point": (
        ROBOT + 'kind = "manipulability"\nat-least = 1\npoint = [1, 2]', 7, "list of length 3, got 2", "",
    ),
    "a negative bound": (ROBOT + 'kind = "manipulability"\n\nat-least = -0.1', 7, "expected a number >= 0", ""),
    "a key of a chain": (CHAIN + 'frame = "a"\npayloda = 1', 6, "no key 'payloda'", "did you mean 'payload'"),
    "a chain without an end": (CHAIN + 'base = "a"', 4, "the key 'frame' is missing", ""),
    "an end without a name": (CHAIN + 'frame = ""', 5, "robots[0].chains[0].frame", ""),
    "a payload that lifts": (CHAIN + 'frame = "a"\npayload = -1', 6, "expected a number >= 0", ""),
    "chains in a chain": (CHAIN + 'frame = "a"\nchains = []', 6, "no key 'chains'", "there are"),
    "a chain that is a name": ('[[robots]]\npath = "x"\nchains = ["tool0"]', 3, "expected a table", ""),
    "nan": (ROBOT + 'kind = "mass"\nat-most = nan', 6, "nan is not a finite number", ""),
    "inf in a list": (ROBOT + 'kind = "reaches"\nposes = [[0, 0, 0], [\n1, -inf, 2]]', 7, "-inf is not a finite", ""),
    "a number that no float holds": (ROBOT + f'kind = "mass"\nat-most = {"9" * 400}', 6, "out of range", ""),
    "no bound": (ROBOT + 'kind = "mass"', 4, "expects nothing", "at-least"),
    "bounds the wrong way round": (ROBOT + 'kind = "mass"\nat-least = 3\nat-most = 2', 4, "nothing is at least 3", ""),
    "limits of nothing": (ROBOT + 'kind = "joint-limits"\njoints = ["a"]', 4, "expects nothing", "effort-at-least"),
    "limits of no joint": (ROBOT + 'kind = "joint-limits"\njoints = []\neffort-at-least = 1', 6, "length >= 1", ""),
    "words and numbers": (ROBOT + 'kind = "manipulability"\nat-least = 1\nat = ["zero", 1]', 7, ".at: this is a", ""),
    "an axis": (ROBOT + 'kind = "manipulability"\nat-least = 1\nrows = "q"', 7, "no axis 'q'", "for instance"),
    "a pose": (ROBOT + 'kind = "reaches"\nposes = [[1, 2, 3], [1, 2]]', 6, "a pose of 2 numbers", "for instance"),
    "poses twice": (ROBOT + 'kind = "reaches"\nposes = [[1, 2, 3]]\nfile = "a.csv"', 4, "either poses or a file", ""),
    "nothing to hold": (ROBOT + 'kind = "holds"\nat-most-percent = 80\ngravity = false', 4, "nothing is to be", ""),
    "no percent": (ROBOT + 'kind = "holds"\nat-most-percent = 0', 6, "expected a number > 0", ""),
    "an effort": (ROBOT + 'kind = "holds"\nat-most-percent = 9\neffort-limits = { a = -3 }', 7, "a number > 0", ""),
    "no TOML": ("[check]\nseed = \n", 2, "not TOML: Invalid value", ""),
    "an open string": ('[check]\nbaseline = "a\n', 2, "not TOML", ""),
    "an end too early": ("[check]\nselect = [", 2, "not TOML", ""),
    "a key twice": ("[check]\nseed = 1\nseed = 2\n", 3, "not TOML: Cannot overwrite a value", ""),
    "a date that is none": ("[check]\nseed = 2024-13-45\n", 2, "not TOML", ""),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_is_said_with_its_line(tmp_path, case):
    text, line, message, remedy = REFUSED[case]
    path = written(tmp_path, text)
    with pytest.raises(UsageError) as caught:
        read_settings(path)
    assert message in str(caught.value)
    assert remedy in str(caught.value)
    assert (caught.value.file, caught.value.line) == (str(path), line)
    assert caught.value.exit_code == 2
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "case", [c for c in REFUSED if REFUSED[c][0].startswith(("[check]", ROBOT)) and "TOML" not in REFUSED[c][2]]
)
def test_pyproject_refuses_the_same_on_its_own_lines(tmp_path, case):
    text, line, message, _ = REFUSED[case]
    text = text.replace("[check]", "[tool.kinetostat.check]").replace("[[robots", "[[tool.kinetostat.robots")
    with pytest.raises(UsageError) as caught:
        read_settings(written(tmp_path, "# ours\n" + text, "pyproject.toml"))
    assert caught.value.line == line + 1
    assert message in str(caught.value)


HOSTILE = {
    "huge": b"#" * (2 << 20),
    "Latin-1": "[check]\n\n# Gr\xf6\xdfe".encode("latin-1"),
    "UTF-16": "[check]".encode("utf-16"),
    "zero bytes": b"[check]\n\0\0",
    "brackets": b"x = " + b"[" * 100_000,
    "tables in tables": b"x = " + b"{a = " * 20_000,
    "quotation marks": b'"' * 500_000,
    "dots": b"a." * 300_000 + b"b = 1",
    "dots and blanks": b"a . " * 200_000 + b"b = 1",
    "quoted dots": b'"a".' * 200_000 + b"b = 1",
    "dots in a table": b"x = { " + b"a." * 300_000 + b"b = 1 }",
    "digits": b"x = " + b"9" * 500_000,
    "a long list": b"x = [" + b"1, " * 300_000 + b"]",
    "a long name": b"[" + b"a" * 900_000 + b"]",
    "escapes": b'"\\u001b[31m\\u202e" = 3',
}


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_settings_are_refused_in_one_short_printable_line_and_soon(tmp_path, case):
    path = tmp_path / "kinetostat.toml"
    path.write_bytes(HOSTILE[case])
    start = time.perf_counter()
    with pytest.raises(UsageError) as caught:
        read_settings(path)
    assert time.perf_counter() - start < 10  # the square of the size takes minutes
    text = str(caught.value)
    assert text.isprintable()
    assert len(text) - len(str(path)) < 400


def test_what_is_no_file_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "missing.toml"):
        with pytest.raises(UsageError):
            read_settings(path)


def test_pyproject_without_our_table_is_refused(tmp_path):
    for text in ("[tool.other]\n", "tool = 3\n", "[tool]\nkinetostat = 3\n"):
        with pytest.raises(UsageError, match="kinetostat"):
            read_settings(written(tmp_path, text, "pyproject.toml"))


class TestFinding:
    def test_the_nearest_one_above(self, tmp_path):
        far, near = tmp_path / "kinetostat.toml", tmp_path / "a" / "kinetostat.toml"
        (tmp_path / "a" / "b" / "c").mkdir(parents=True)
        far.touch()
        assert find_settings(tmp_path / "a" / "b" / "c") == far
        near.touch()
        assert find_settings(tmp_path / "a" / "b" / "c") == near
        assert find_settings(tmp_path) == far

    def test_from_a_file_on(self, tmp_path):
        settings = written(tmp_path, "")
        (tmp_path / "arm.urdf").touch()
        assert find_settings(tmp_path / "arm.urdf") == settings

    @pytest.mark.parametrize("mark", ["folder", "file"])  # a worktree has a file
    def test_not_above_the_repository(self, tmp_path, mark):
        written(tmp_path, "")
        inner = tmp_path / "repository" / "robots"
        inner.mkdir(parents=True)
        git = tmp_path / "repository" / ".git"
        git.mkdir() if mark == "folder" else git.touch()
        assert find_settings(inner) is None
        settings = written(tmp_path / "repository", "")
        assert find_settings(inner) == settings

    def test_pyproject_counts_if_it_has_our_table(self, tmp_path):
        (tmp_path / ".git").mkdir()
        project = written(tmp_path, '[tool.other]\nname = "kinetostat"\n', "pyproject.toml")
        assert find_settings(tmp_path) is None
        project.write_text("[tool.kinetostat.check]\n")
        assert find_settings(tmp_path) == project
        own = written(tmp_path, "")
        assert find_settings(tmp_path) == own

    def test_a_broken_pyproject_is_ours_if_it_says_so(self, tmp_path):
        (tmp_path / ".git").mkdir()
        written(tmp_path, "[tool.kinetostat]\nx = \n", "pyproject.toml")
        assert find_settings(tmp_path) == tmp_path / "pyproject.toml"
        written(tmp_path, '[project]\nname = "kinetostat\n', "pyproject.toml")
        assert find_settings(tmp_path) is None
        (tmp_path / "pyproject.toml").write_bytes(b"\xff\xfe kinetostat")
        assert find_settings(tmp_path) is None
