"""Folding many findings of one cause into one: nothing is lost, and each is counted once."""

import re

import pytest

from kinetostat.lint.grouping import FEW, Found, also, grouped, listed
from kinetostat.lint.rules.inertia.tensors import ZeroTensor
from kinetostat.urdf.document import Element


def found(*messages):
    return [Found(Element("link", {"name": f"l{i}"}, i + 1), f"l{i}", text, "name") for i, text in enumerate(messages)]


def counted(findings):
    """Return for how many things findings stand: one each, and what they say that they leave out."""
    more = [re.search(r"; likewise (\d+) more", finding.message) for finding in findings]
    return len(findings) + sum(int(each[1]) for each in more if each)


@pytest.mark.parametrize("count", range(2 * FEW))
@pytest.mark.parametrize("alike", [False, True])
@pytest.mark.parametrize("few", [1, FEW])
def test_whatever_is_folded_all_that_was_found_is_counted(count, alike, few):
    findings = list(grouped(ZeroTensor(), found(*"abacbc"[:count]), what="link", alike=alike, few=few))
    assert counted(findings) == count
    assert len(findings) <= few
    assert [f.line for f in findings] == sorted({f.line for f in findings})
    assert all(f.several == ("likewise" in f.message) for f in findings)


def test_what_has_one_message_is_one_finding_at_the_first():
    findings = list(grouped(ZeroTensor(), found("a", "b", "a"), what="link", alike=True))
    assert [(f.line, f.message) for f in findings] == [(1, "a; likewise 1 more link: 'l2'"), (2, "b")]


def test_names_are_listed_up_to_a_few_and_cut():
    assert also([], "link") == ""
    assert also(["x", "y"], "mesh") == "; likewise 2 more meshes: 'x', 'y'"
    assert listed(list("abcdefgh")) == "'a', 'b', 'c' and 5 more"
    assert len(listed(["n" * 1000] * 1000)) < 200
