"""What the tests of the policy share: a robot judged by the lines of a settings file."""

from __future__ import annotations

from pathlib import Path

import kinetostat as ks
from kinetostat.policy.judging import judge
from kinetostat.policy.settings import read_settings


def written(folder: Path, text: str, name: str = "kinetostat.toml") -> Path:
    """Write a settings file and return its path."""
    path = folder / name
    path.write_text(text)
    return path


def judged(folder: Path, model: ks.Model, lines: str):
    """Return the outcome of one expectation, written as the lines of its table."""
    text = f'[[robots]]\npath = "any.urdf"\n\n[[robots.expect]]\n{lines}\n'
    settings = read_settings(written(folder, text))
    (outcome,) = judge(model, settings.robots[0].expect, folder=folder)
    assert outcome.place == "kinetostat.toml:4"
    return outcome
