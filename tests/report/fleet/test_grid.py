"""Tables of numbers: where their units stand."""

from hypothesis import given
from hypothesis import strategies as st

from kinetostat.report.fleet.grid import Column, grid, quantity, share, words

QUANTITIES = st.builds(quantity, st.none() | st.floats(-10, 10), st.sampled_from(("m", "rad", "1", "m^2")))


@given(st.lists(st.tuples(QUANTITIES, QUANTITIES), max_size=5))
def test_each_number_has_its_unit_in_its_cell_or_in_the_header(rows):
    made = grid((Column("a"), Column("b")), rows)
    assert len(made.rows) == len(rows)
    for before, after in zip(rows, made.rows, strict=True):
        for old, new, column in zip(before, after, made.columns, strict=True):
            assert (new.text, new.value) == (old.text, old.value)
            if old.text:
                assert (new.unit or column.unit) == old.unit
                assert not (new.unit and column.unit)


def test_a_unit_moves_to_the_header_if_all_that_is_known_shares_it():
    made = grid((Column("a"),), [[quantity(1.0, "m")], [quantity(None, "rad")], [quantity(2.0, "m")]])
    assert made.columns[0].unit == "m"
    made = grid((Column("a"),), [[quantity(1.0, "m")], [quantity(2.0, "1")]])
    assert made.columns[0].unit == ""


def test_a_table_without_rows_has_its_columns():
    made = grid((Column("a"), Column("b", "words")), [])
    assert [column.title for column in made.columns] == ["a", "b"]
    assert made.rows == ()


def test_a_share_is_in_percent_and_its_bar_is_the_share():
    assert (share(0.5).text, share(0.5).unit, share(0.5).bar) == ("50.0", "%", 0.5)
    assert share(None).bar is None
    assert words("a").value is None
