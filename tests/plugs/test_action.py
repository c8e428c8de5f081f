"""The GitHub Action: valid, and its steps run by bash as a runner would."""

import json
import re
import sys
from pathlib import Path

import jsonschema
import pytest
import yaml

from plugs.repository import BAD, BAD_LINE, GOOD, ROOT, copied, environment, run

ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
STEPS = ACTION["runs"]["steps"]
SARIF = json.loads((ROOT / "tests/report/sarif-2.1.0-rtm.5.json").read_text(encoding="utf-8"))
EXPRESSION = re.compile(r"\$\{\{\s*(\S+)\s*\}\}")


class Runner:
    """What a runner gives to the steps of a composite action."""

    def __init__(self, folder: Path, source: Path) -> None:
        self.workspace, self.temp, self.source = folder / "workspace", folder / "temp", source
        self.workspace.mkdir()
        self.temp.mkdir()
        self.summary, self.output = self.temp / "summary.md", self.temp / "output"
        self.summary.touch()
        self.output.touch()
        self.env = environment(folder / "home") | {
            "RUNNER_TEMP": str(self.temp),
            "GITHUB_STEP_SUMMARY": str(self.summary),
            "GITHUB_OUTPUT": str(self.output),
            "GITHUB_WORKSPACE": str(self.workspace),
        }

    def step(self, number: int, code: int = 0, **inputs: str) -> str:
        """Run a step with what a workflow gives (`fail_on` for fail-on) and return what it says."""
        given = {name: spec["default"] for name, spec in ACTION["inputs"].items()}
        given |= {name.replace("_", "-"): value for name, value in inputs.items()}
        known = {f"inputs.{name}": value for name, value in given.items()} | {"github.action_path": str(self.source)}
        step = STEPS[number]
        own = {key: EXPRESSION.sub(lambda found: known[found[1]], value) for key, value in step["env"].items()}
        script = self.temp / "step.sh"
        script.write_text(step["run"], encoding="utf-8")
        shell = ("bash", "--noprofile", "--norc", "-eo", "pipefail", str(script))
        return run(*shell, folder=self.workspace, env=self.env | own, code=code)

    @property
    def outputs(self) -> dict[str, str]:
        return dict(line.split("=", 1) for line in self.output.read_text(encoding="utf-8").splitlines())


@pytest.fixture
def runner(tmp_path):
    """A runner with kinetostat installed: the one that is tested here."""
    made = Runner(tmp_path, ROOT)
    scripts = made.temp / "kinetostat" / "bin"
    scripts.mkdir(parents=True)
    (scripts / "kinetostat").symlink_to(Path(sys.executable).parent / "kinetostat")
    (made.workspace / "good.urdf").write_text(GOOD, encoding="utf-8")
    return made


def test_it_is_valid():
    check = str(Path(sys.executable).parent / "check-jsonschema")
    env = {"PATH": "/usr/bin:/bin"}
    run(check, "--builtin-schema", "vendor.github-actions", "action.yml", folder=ROOT, env=env)


def test_no_script_holds_what_a_workflow_gives():
    for step in STEPS:
        assert "${{" not in step["run"]
        assert step["shell"] == "bash"


def test_every_input_is_used_and_every_output_is_of_a_step():
    used = {name for step in STEPS for value in step["env"].values() for name in EXPRESSION.findall(value)}
    assert used == {f"inputs.{name}" for name in ACTION["inputs"]} | {"github.action_path"}
    for name, output in ACTION["outputs"].items():
        assert output["value"] == f"${{{{ steps.check.outputs.{name} }}}}"


def test_a_good_robot_passes(runner):
    said = runner.step(1, sarif_file="out/check.sarif")
    assert "::error" not in said
    assert "1 file: 1 passed" in said
    assert "kinetostat check passed" in runner.summary.read_text(encoding="utf-8")
    sarif = runner.outputs["sarif-file"]
    jsonschema.Draft4Validator(SARIF).validate(json.loads((runner.workspace / sarif).read_text(encoding="utf-8")))
    assert runner.outputs["exit-code"] == "0"
    assert Path(runner.outputs["markdown-file"]).read_text(encoding="utf-8").startswith("### kinetostat check")


def test_a_bad_robot_fails_with_an_annotation_at_its_line_and_all_reports(runner):
    (runner.workspace / "bad.urdf").write_text(BAD, encoding="utf-8")
    said = runner.step(1, code=1, sarif_file="check.sarif")
    assert f"::error file=bad.urdf,line={BAD_LINE}," in said
    assert "title=J103" in said
    log = json.loads((runner.workspace / "check.sarif").read_text(encoding="utf-8"))
    assert "J103" in {result["ruleId"] for result in log["runs"][0]["results"]}
    assert "bad.urdf" in runner.summary.read_text(encoding="utf-8")
    assert runner.outputs["exit-code"] == "1"


def test_what_a_workflow_gives_are_words_never_a_script(runner):
    (runner.workspace / "bad.urdf").write_text(BAD, encoding="utf-8")
    name = "$(touch planted) `touch planted` ; touch planted.urdf"
    (runner.workspace / name).write_text(GOOD, encoding="utf-8")
    said = runner.step(1, paths=f"good.urdf\n\n   \n{name}\n", args="--samples=2\n\n  --ignore=N\n", summary="false")
    assert "2 files: 2 passed" in said
    assert not list(runner.workspace.glob("planted*"))
    assert not (runner.temp / "planted").exists()
    assert runner.summary.read_text(encoding="utf-8") == ""


def test_blanks_are_part_of_a_path(runner):
    (runner.workspace / " lead blank.urdf").write_text(GOOD, encoding="utf-8")
    assert "1 file: 1 passed" in runner.step(1, paths=" lead blank.urdf\n", summary="false")


def test_a_gate_writes_no_baseline(runner):
    said = runner.step(1, code=2, args="--samples=2\n--write-baseline=b.json", sarif_file="check.sarif")
    assert said.startswith("::error ")
    assert "--write-baseline" in said
    assert runner.outputs == {"exit-code": "2"}
    assert not (runner.workspace / "b.json").exists()


def test_where_nothing_is_checked_there_is_no_report_and_none_of_an_earlier_use(runner):
    (runner.temp / "kinetostat.md").write_text("of an earlier use", encoding="utf-8")
    runner.step(1, args="--help", sarif_file="check.sarif")
    assert runner.outputs == {"exit-code": "0"}
    assert runner.summary.read_text(encoding="utf-8") == ""


def test_a_file_name_of_two_lines_plants_no_output(runner):
    runner.step(1, sarif_file="check.sarif\nexit-code=7\nplanted=1")
    assert runner.outputs["sarif-file"] == "check.sarif"
    assert runner.outputs["exit-code"] == "0"
    assert "planted" not in runner.outputs


def test_no_module_of_the_repository_is_run(runner):
    for name in ("multiprocessing", "json", "kinetostat"):
        (runner.workspace / f"{name}.py").write_text("open('planted', 'w').close()", encoding="utf-8")
    assert all(step["env"]["PYTHONSAFEPATH"] == "1" for step in STEPS)
    assert "1 file: 1 passed" in runner.step(1, summary="false")
    assert not (runner.workspace / "planted").exists()


def test_a_path_that_looks_like_an_option_is_a_path(runner):
    (runner.workspace / "--debug.urdf").write_text(GOOD, encoding="utf-8")
    assert "1 file: 1 passed" in runner.step(1, paths="--debug.urdf", summary="false")


def test_a_wrong_option_is_said_once_and_reported_as_such(runner):
    said = runner.step(1, code=2, args="--nonsense", sarif_file="check.sarif")
    assert said.count("--nonsense") == 1
    assert runner.outputs == {"exit-code": "2"}
    assert not (runner.workspace / "check.sarif").exists()


def test_its_first_step_installs_what_the_second_runs(tmp_path):
    made = Runner(tmp_path, copied(tmp_path / "source"))
    (made.workspace / "good.urdf").write_text(GOOD, encoding="utf-8")
    made.step(0, python=sys.executable)
    where = "import kinetostat; print(kinetostat.__file__)"
    python = str(made.temp / "kinetostat/bin/python")
    assert str(made.temp) in run(python, "-c", where, folder=made.workspace, env=made.env)
    assert "1 file: 1 passed" in made.step(1)
