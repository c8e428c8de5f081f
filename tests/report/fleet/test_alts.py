"""What pictures show, in sentences."""

import msgspec

from kinetostat.report.fleet import alts
from report.fleet import fleet_documents as made


def test_the_end_of_a_chain_that_is_called_as_it_is_not_named_twice():
    assert "tool of arm" in alts.reach_alt(made.chain())
    named = made.chain("r1-1", "tool")
    assert "tool of tool" not in alts.reach_alt(named)
    assert "two joints" in alts.reach_alt(named)
    assert "two joints" not in alts.reach_alt(made.chain(joints=("a", "b")))


def test_a_use_of_effort_is_in_percent_as_in_the_picture():
    assert "gravity use, median 40.0 %" in alts.distributions_alt(made.chain())


def test_where_no_ellipsoid_is_drawn_none_is_told():
    assert "ellipsoids" in alts.poses_alt(made.chain())
    assert "ellipsoids" not in alts.poses_alt(made.chain(turns_only=True))


def test_a_unit_is_told_where_there_is_one():
    told = alts.poses_alt(msgspec.structs.replace(made.chain(), singular_value_unit="m/rad"))
    assert "Smallest singular value (m/rad): " in told
    assert "(1)" not in alts.poses_alt(made.chain())
