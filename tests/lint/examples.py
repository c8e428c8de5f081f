"""Writing the example of a rule, or a case, into a folder, and asking the rules of it."""

from pathlib import Path

from kinetostat.lint.linting import Linted, lint
from kinetostat.lint.registry import RULES
from kinetostat.lint.rule import Example
from kinetostat.lint.subject import subject_of


def linted(example: Example, folder: Path, rules=RULES) -> Linted:
    """Return what the rules say of an example, written into a folder as robot.urdf and robot.srdf."""
    for name, text in example.files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (folder / "robot.urdf").write_text(example.robot_text, encoding="utf-8")
    if example.srdf:
        (folder / "robot.srdf").write_text(example.srdf_text, encoding="utf-8")
    return lint(subject_of(str(folder / "robot.urdf")), rules)


def marked(text: str, code: str) -> list[int]:
    """Return the lines of an example that carry the mark of a rule."""
    return [i for i, line in enumerate(text.splitlines(), 1) if f"<!-- {code} -->" in line]
