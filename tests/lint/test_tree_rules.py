"""Laws of the rules of the tree: they and the reader agree on what is a tree; nothing is quadratic."""

import random
import time
from itertools import pairwise

import pytest

from kinetostat.lint.registry import RULES, chosen
from kinetostat.lint.rule import Example
from kinetostat.lint.rules.tree import TREE
from kinetostat.lint.subject import subject_of
from lint.examples import linted

TREE_ERRORS = tuple(rule for rule in TREE if rule.severity == "error" or rule.name == "no-joint")


def robot(links, joints):
    """Return the text of a robot: names of links, pairs of parent and child."""
    lines = [f'<link name="{name}"/>' for name in links]
    lines += [
        f'<joint name="j{i}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
        for i, (parent, child) in enumerate(joints)
    ]
    return '<robot name="r">\n' + "\n".join(lines) + "\n</robot>\n"


def is_tree(links, joints):
    """Return whether pairs make one tree over links, by the definition: n - 1 joints that connect all of them."""
    if len(set(links)) < len(links) or len(joints) != len(links) - 1:
        return False
    children = [child for _, child in joints]
    if len(set(children)) < len(children) or not {link for pair in joints for link in pair} <= set(links):
        return False
    group = {link: {link} for link in links}
    for parent, child in joints:
        if group[parent] is group[child]:
            return False
        group[parent] |= group[child]
        for link in group[child]:
            group[link] = group[parent]
    return True


def spoken(text, folder, rules=RULES):
    return linted(Example(text), folder, rules).findings


@pytest.mark.parametrize("seed", range(60))
def test_the_rules_find_an_error_where_there_is_no_tree_and_nowhere_else(seed, tmp_path):
    rng = random.Random(seed)
    links = [f"l{i}" for i in range(rng.randint(1, 6))]
    joints = [(rng.choice(links[:i]), links[i]) for i in range(1, len(links))]
    rng.shuffle(joints)
    for _ in range(rng.choice((0, 1, 1, 2, 4))):
        what = rng.random()
        if what < 0.2 and joints:
            joints.pop(rng.randrange(len(joints)))
        elif what < 0.4:
            links.append(rng.choice([*links, "new"]))
        elif what < 0.6 and joints:
            joints[rng.randrange(len(joints))] = (rng.choice(links), rng.choice(links))
        else:
            joints.append((rng.choice(links), rng.choice([*links, "lost"])))
    found = spoken(robot(links, joints), tmp_path)
    errors = [f for f in found if f.severity == "error"]
    assert bool(errors) is not is_tree(links, joints)
    assert not [f for f in errors if f.code == "X001"], "the reader refuses it for another reason"


@pytest.mark.parametrize("count", [2, 3, 7])
def test_every_cycle_and_every_lost_link_is_named(count, tmp_path):
    links = ["base"] + [f"{c}{i}" for c in range(count) for i in "abc"]
    joints = [(f"{c}{i}", f"{c}{k}") for c in range(count) for i, k in ("ab", "bc", "ca")]
    found = [f for f in spoken(robot(links, joints), tmp_path) if f.code == "T107"]
    assert [f.line for f in found] == [3 + 3 * c for c in range(count)]
    joints = [("base", f"lost{i}") for i in range(count)]
    found = [f for f in spoken(robot(links, joints), tmp_path) if f.code == "T102"]
    assert len(found) == count


@pytest.mark.parametrize("shape", ["star", "chain", "backwards", "circle", "pairs", "lost", "twice"])
def test_20_000_links_take_no_longer_than_their_number(shape, tmp_path):
    count = 20_000
    links = [f"l{i}" for i in range(count)]
    joints = {
        "star": [("l0", link) for link in links[1:]],
        "chain": list(pairwise(links)),
        "backwards": list(zip(links[1:], links, strict=False)),
        "circle": [*pairwise(links), (links[-1], "l0")],
        "pairs": [(link, links[i ^ 1]) for i, link in enumerate(links)],
        "lost": [(link, f"m{i}") for i, link in enumerate(links)],
        "twice": [(link, "l1") for link in links],
    }[shape]
    (tmp_path / "robot.urdf").write_text(robot(links, joints), encoding="utf-8")
    subject = subject_of(str(tmp_path / "robot.urdf"))
    start = time.perf_counter()
    for rule in chosen(["X", "T"]):
        list(rule.check(subject))
    assert time.perf_counter() - start < 10


def test_the_depth_is_that_of_the_deepest_link(tmp_path):
    links = [f"l{i}" for i in range(402)]
    joints = list(pairwise(links))
    random.Random(1).shuffle(joints)
    found = [f for f in spoken(robot(links, joints), tmp_path, TREE_ERRORS) if f.code == "T114"]
    assert len(found) == 1
    assert "402 links deep; at most 400" in found[0].message
