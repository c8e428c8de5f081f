"""`kinetostat explain` and `rules`: rules, and kinds of expectations."""

import pytest

from kinetostat.policy.expectations import KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_of_expectation_is_explained_as_a_rule_is(cli, kind):
    answer = cli("explain", kind)
    assert answer.code == 0
    assert f'kind = "{kind}"' in answer.out
    assert cli("explain", kind, "-F", "json").json["result"]["kind"] == kind


@pytest.mark.parametrize(
    ("word", "near"),
    [
        ("hold", "'holds'"),
        ("J1O3", "'J103'"),
        ("limits-swaped", "'limits-swapped'"),
        ("joint_limits", "'joint-limits'"),
    ],
)
def test_the_nearest_of_codes_names_and_kinds_is_told(cli, word, near):
    answer = cli("explain", word)
    assert answer.code == 2
    assert near in answer.err


@pytest.mark.parametrize("word", ["J103", "j103", "limits-swapped", "HOLDS"])
def test_case_does_not_matter(cli, word):
    assert cli("explain", word).code == 0


def test_rules_end_with_the_kinds_unless_rules_are_selected(cli):
    assert cli("rules").out.index("worst-gravity-torque") > cli("rules").out.index("K202")
    assert "worst-gravity-torque" not in cli("rules", "--select", "K1").out
    listed = cli("rules", "-F", "json").json["result"]["expectations"]
    assert [one["kind"] for one in listed] == list(KINDS)
