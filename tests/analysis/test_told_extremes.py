"""What is told of an extreme is held against its configuration: a number that was damaged on its way is found out."""

from __future__ import annotations

import numpy as np
import pytest

import kinetostat
from kinetostat.analysis.configuration import neutral
from kinetostat.screw.kernel import Kernel

ROW = 12_345


@pytest.fixture
def damaged(monkeypatch):
    """Damage one row amid a batch, in a way that the row computed alone does not show."""
    right = Kernel.__call__

    def wrong(value):
        def call(self, q):
            found = right(self, q)
            if len(q) > ROW:
                values = found["singular_values"].copy()
                values[ROW, -1] = value
                found["singular_values"] = values
            return found

        monkeypatch.setattr(Kernel, "__call__", call)

    return wrong


@pytest.mark.parametrize("value", [1e-30, 0.0, 99.0, np.inf])
def test_a_damaged_extreme_of_a_sweep_is_no_answer(damaged, value):
    model = kinetostat.load("example:ur5_robot")
    question = {"samples": 20_000, "axes": "xyz", "measures": ("minimum_singular_value",)}
    sound = kinetostat.sweep(model, "tool0", neutral(model.robot), **question)
    assert sound.certificate.agree
    damaged(value)
    result = kinetostat.sweep(model, "tool0", neutral(model.robot), **question)
    assert result.certificate.agree is False


def test_a_damaged_best_voxel_is_no_answer(damaged):
    model = kinetostat.load("example:ur5_robot")
    question = {"samples": 20_000, "axes": "xyz"}
    assert kinetostat.capability_map(model, "tool0", neutral(model.robot), **question).certificate.agree
    damaged(99.0)
    assert kinetostat.capability_map(model, "tool0", neutral(model.robot), **question).certificate.agree is False
