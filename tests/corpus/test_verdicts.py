"""`check` gives every stored hostile or odd file the verdict that a careful engineer gives, or says why not."""

import json
from pathlib import Path

import pytest

from kinetostat.gate.checking import Task, check_robot
from kinetostat.lint.finding import Severity

HERE = Path(__file__).parent
MANIFEST = json.loads((HERE / "manifest.json").read_text(encoding="utf-8"))

# Where we judge otherwise than the manifest: what `check` says, and why.
OTHERWISE: dict[str, tuple[str, str]] = {
    "dtd_external.urdf": ("error", "every DOCTYPE is refused: it can name other files (design, section 6)"),
    "mesh_empty.urdf": ("warn", "the mesh that would be empty is not there, and a mesh that is missing is a warning"),
    "mesh_bomb_dae.urdf": ("warn", "the mesh that would be a bomb is not there, and a missing mesh is a warning"),
    "root_is_last.urdf": ("warn", "its two joints turn about one line (K101): one of them adds nothing"),
}


def verdict(path: Path) -> str:
    """Return error, warn or ok, as the manifest does."""
    severities = {finding.severity for finding in check_robot(Task(str(path), samples=2)).findings}
    if Severity.ERROR in severities:
        return "error"
    return "warn" if Severity.WARNING in severities else "ok"


@pytest.mark.parametrize("entry", MANIFEST, ids=lambda entry: entry["name"])
def test_the_verdict_on_a_hostile_or_odd_file(entry):
    name = entry["name"]
    expected = OTHERWISE[name][0] if name in OTHERWISE else entry["expected"]
    assert verdict(HERE / "files" / name) == expected, entry["wrong"]


def test_we_judge_as_the_manifest_does_in_97_of_100():
    assert all(OTHERWISE[e["name"]][0] != e["expected"] for e in MANIFEST if e["name"] in OTHERWISE)
    assert len(OTHERWISE) <= 0.03 * len(MANIFEST)
