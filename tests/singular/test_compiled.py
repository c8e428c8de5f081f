"""Singular values by compiled code: the same as by LAPACK, and the same families from them."""

from dataclasses import replace

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.singular import find
from kinetostat.analysis.singular.mechanism import STRICT, mechanism
from kinetostat.analysis.singular.search import converge

ARMS = {
    "six joints": ("example:ur5_robot", "wrist_3_link", {}),
    "seven joints": ("example:panda", "panda_hand", {}),
    "a slide": ("textbook:stanford", None, {}),
    "three joints, three rows": ("textbook:anthropomorphic", None, {}),
    "rows in the tool's axes": ("example:panda", "panda_hand", {"axes": "x z ry", "reference": "local"}),
}


def arm_of(which):
    source, frame, words = ARMS[which]
    model = ks.load(source)
    return mechanism(model, frame or model.robot.links[-1].name, **words)


@pytest.mark.parametrize("which", ARMS)
def test_they_are_those_of_the_jacobian(which):
    arm = arm_of(which)
    compiled = replace(arm, compiled=True)
    q = arm.draw(np.random.default_rng(5), (3, 50))
    assert compiled.smallest(q).shape == (3, 50)
    assert np.allclose(compiled.smallest(q), arm.smallest(q), rtol=0, atol=1e-13)
    assert np.array_equal(compiled.smallest(q[0, :5]), arm.smallest(q[0, :5]))  # so few that it is not asked
    assert compiled.smallest(q[:0]).shape == (0, 50)


def test_zero_is_zero():
    arm = arm_of("six joints")
    singular, values = converge(arm, arm.draw(np.random.default_rng(6), (100,)))
    assert np.all(values < STRICT)
    assert np.allclose(replace(arm, compiled=True).smallest(singular), values, rtol=0, atol=1e-14)


@pytest.mark.parametrize("which", ARMS)
def test_families_are_the_same(which, monkeypatch):
    source, frame, words = ARMS[which]
    model = ks.load(source)
    frame = frame or model.robot.links[-1].name
    plain = ks.singular_find(model, frame, starts=100, **words)
    monkeypatch.setattr(find, "_COMPILED", 100)
    compiled = ks.singular_find(model, frame, starts=100, **words)
    assert not plain.mechanism.compiled
    assert compiled.mechanism.compiled
    assert told(compiled) == told(plain)
    assert compiled.converged == plain.converged


def told(result):
    return [
        (f.support, f.kind, f.name, f.inside_limits, f.complete, f.hits, [round(x, 7) for x in f.positions.values()])
        for f in result.families
    ]
