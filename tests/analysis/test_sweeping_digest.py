"""Laws of digests: equal questions have equal ones, and nothing that differs is mistaken for the same."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pytest

from kinetostat.analysis.sweeping.digest import digest


@dataclass
class Thing:
    a: int
    b: object


DIFFERENT = [
    (),
    (1,),
    (1.0,),
    (True,),
    ("1",),
    (None,),
    ((1,),),
    ((),),
    (1, 2),
    ((1, 2),),
    (12,),
    ("1", "2"),
    ("1;2",),
    (np.array([1.0]),),
    (np.array([1]),),
    (np.array([[1.0]]),),
    (np.array([1.0, 2.0]),),
    (np.array([0.0]),),
    (np.array([-0.0]),),
    (Thing(1, 2),),
    (Thing(1, (2,)),),
    ({"a": 1},),
    ({"a": 2},),
]


def test_what_differs_has_different_digests():
    for one, other in combinations(DIFFERENT, 2):
        assert digest(*one) != digest(*other), (one, other)


def test_the_layout_of_an_array_does_not_count():
    array = np.arange(6.0).reshape(2, 3)
    assert digest(array) == digest(np.asfortranarray(array)) == digest(array.T.copy().T)


def test_values_without_a_digest_are_refused():
    with pytest.raises(TypeError, match="no digest of object"):
        digest(object())
