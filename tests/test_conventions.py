"""Words that name a convention."""

import numpy as np
import pytest

import kinetostat as ks


@pytest.mark.parametrize("words", [ks.Reference, ks.Order, ks.WrenchOrTwist])
def test_words_stand_for_themselves_and_others_are_refused(words):
    for word in words:
        assert words(word.value) is word
    with pytest.raises(ks.UsageError, match="'sideways'"):
        words("sideways")


def test_functions_take_the_words():
    arm, q = ks.load("textbook:planar_2r"), np.array([0.3, 0.7])
    twist, wrench = (ks.adjoint(arm, "tool", "base", q, kind=kind).matrix for kind in ("twist", "wrench"))
    assert np.abs(twist - wrench).max() > 0.1
    assert np.allclose(wrench, np.linalg.inv(twist).T, atol=1e-14)
    with pytest.raises(ks.UsageError, match="reference 'body'"):
        ks.jacobian(arm, "tool", q, reference="body")
    with pytest.raises(ks.UsageError, match="kind 'force'"):
        ks.adjoint(arm, "tool", "base", q, kind="force")


def test_the_order_of_rows_is_its_own_inverse():
    rows = ks.Order.ANGULAR_FIRST.rows
    assert [rows[i] for i in rows] == list(range(6))
