"""How many numbers a certificate is of."""

import numpy as np
import pytest

import kinetostat as ks
from kinetostat.analysis.crosscheck import Certificate, combined
from kinetostat.report.json import closing
from textbook_support import textbook

AT = np.array([0.3, -1.1])


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 5)])
def test_it_is_of_as_many_as_the_answer_has(shape):
    result = ks.fk(textbook("planar_2r"), "tool", np.broadcast_to(AT, (*shape, 2)))
    assert result.certificate.numbers == result.matrix.size


def test_what_one_engine_computes_alone_does_not_count():
    alone = ks.load("textbook:planar_2r", crosscheck=False)
    assert ks.fk(alone, "tool", AT).certificate.numbers == 0
    swept = ks.sweep(alone, "tool", AT, samples=100)
    assert [one.numbers for one in swept.certificates.values()] == [0, 0]


def test_several_together_have_those_of_all():
    near, far = Certificate(("a", "b"), 1e-13, 1e-12, (), 5), Certificate(("a", "b"), 1e-15, 1e-12, (), 7)
    both = combined([far, near])
    assert both.max_difference == near.max_difference
    assert both.numbers == 12


def test_they_are_no_part_of_what_is_compared_or_printed():
    one, other = (Certificate(("a", "b"), 0.0, 1.0, (), numbers) for numbers in (1, 2))
    assert one == other
    assert set(closing(one, ())["crosscheck"]) == {"engines", "max_difference", "tolerance", "agree"}


@pytest.mark.parametrize(
    ("measures", "sizes"),
    [
        ("position", {"placement": 12}),
        ("singular_values,yoshikawa", {"singular_values": 2, "yoshikawa": 1}),
        ("gravity_torque,effort_use", {"gravity_torque": 2, "effort_use": 2}),
        ("minimum_gradient,limit_distance", {"minimum_gradient": 2, "limit_distance": 1}),
    ],
)
def test_a_sweep_s_are_rows_times_numbers_of_a_row(measures, sizes):
    blocks = []
    swept = ks.sweep(textbook("planar_2r"), "tool", AT, samples=300, measures=measures, axes="x y", sink=blocks.append)
    rows = swept.certified_rows
    assert rows > 4
    assert {name: one.numbers for name, one in swept.certificates.items()} == {k: rows * n for k, n in sizes.items()}
    assert swept.certificate.numbers == rows * sum(sizes.values())


def test_of_a_long_chain_s_gradients_as_many_count_as_are_compared():
    model = ks.load("example:human")
    chain = ks.sweep(
        model, "right_hand", np.array(ks.configuration(model).q), samples=20, relative_to="left_foot",
        measures="minimum_gradient",
    )  # fmt: skip
    assert len(chain.names) > 16
    assert chain.certificate.numbers == 4 * chain.certified_rows
