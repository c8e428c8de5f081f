"""Screws that no coordinate moves, coordinates that move no screw: followers with multiplier 0, in compiled code."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kinetostat.analysis.configuration import configuration
from kinetostat.analysis.sweeping.sweep import sweep
from kinetostat.screw import se3
from kinetostat.screw.chain import Chain, screw
from kinetostat.screw.compiled.packing import pack_chain
from kinetostat.screw.kernel import Kernel
from trees import load_text

OUTPUTS = ("placement", "jacobian", "singular_values", "yoshikawa")


def chain(idle: tuple[int, ...], screws: int = 7) -> Chain:
    """Return a chain whose coordinates are its screws', of which some are not moved by theirs."""
    random = np.random.default_rng(len(idle))
    lines = random.normal(size=(screws, 2, 3))
    columns = np.stack([screw(d / np.linalg.norm(d), p) for d, p in lines], -1)
    fold = np.eye(screws)
    fold[list(idle)] = 0
    return Chain(columns, se3.exp(random.uniform(-1, 1, 6)), fold, random.uniform(-1, 1, screws))


@pytest.mark.parametrize("idle", [(), (0,), (6,), (2, 3), (0, 5, 6), tuple(range(6))])
def test_every_coordinate_has_a_screw_and_numbers_as_defined(idle: tuple[int, ...]) -> None:
    kernel = Kernel(chain(idle), OUTPUTS)
    assert sorted(pack_chain(kernel.chain).drivers) == list(range(7))
    q = np.random.default_rng(1).uniform(-3, 3, (50, 7))
    expected = kernel.definition(q)
    for _ in range(3):  # what is left in memory by others would differ from time to time
        found = kernel(q)
        for name in OUTPUTS:
            np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-11)
        replace(kernel, chain=chain(()))(1e3 * q)
    assert np.all(kernel(q)["jacobian"][..., list(idle)] == 0)


def test_a_sweep_of_a_chain_with_a_follower_that_never_moves_is_what_pinocchio_says() -> None:
    turn = '<axis xyz="0 {y} {z}"/><limit lower="-2" upper="2" effort="1" velocity="1"/>'
    robot = load_text(
        '<robot name="idle"><link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="elsewhere"/>'
        f'<joint name="one" type="revolute"><parent link="base"/><child link="a"/>{turn.format(y=0, z=1)}</joint>'
        f'<joint name="two" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.5 0 0"/>'
        f'{turn.format(y=1, z=0)}<mimic joint="leader" multiplier="0" offset="0.3"/></joint>'
        f'<joint name="three" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.5 0.1 0"/>'
        f"{turn.format(y=1, z=0)}</joint>"
        f'<joint name="leader" type="revolute"><parent link="base"/><child link="elsewhere"/>'
        f"{turn.format(y=0, z=1)}</joint></robot>"
    )
    measures = "singular_values,yoshikawa,position"
    result = sweep(robot, "c", configuration(robot).q, samples=200, measures=measures)
    assert result.names == ("one", "leader", "three")
    assert all(certificate.agree for certificate in result.certificates.values())
