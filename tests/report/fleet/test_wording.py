"""What the page and the Markdown of a report say in the same words."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetostat.report.fleet import wording
from report.fleet import fleet_documents as made


@given(st.floats(1e-11, 1e15), st.sampled_from((1, -1)))
def test_a_number_is_shown_to_three_significant_digits(size, sign):
    shown = wording.number_text(sign * size)
    assert float(shown) == pytest.approx(sign * size, rel=5.001e-3)
    assert len(shown) <= 10


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0.0, "0"), (-0.0, "0"), (1e-17, "0"), (0.9999, "1.00"), (999.9, "1000"), (12345.6, "12346"), (-0.5, "-0.500"),
     (1e-5, "1.00e-5"), (2.5e7, "2.50e7"), (math.inf, "infinite"), (math.nan, ""), (None, "")],
)  # fmt: skip
def test_numbers_at_the_edges(value, shown):
    assert wording.number_text(value) == shown


@pytest.mark.parametrize(
    ("unit", "shown"),
    [("1", ""), ("m", "m"), ("(m/rad)^2", "(m/rad)²"), ("m^-12", "m⁻¹²"), ("a^b", "a^b"), ("^", "^"), ("", "")],
)
def test_powers_of_units_are_raised(unit, shown):
    assert wording.unit_text(unit) == shown


@pytest.mark.parametrize(
    ("certificate", "readers", "agree"),
    [(None, None, None), (True, None, True), (None, True, True), (True, True, True), (True, False, False),
     (False, True, False), (False, None, False)],
)  # fmt: skip
def test_engines_agree_if_they_do_wherever_they_were_compared(certificate, readers, agree):
    robot = made.robot(
        certificate=made.certificate(agree=certificate),
        agreement=None if readers is None else made.agreed(engines_agree=readers),
    )
    assert wording.engines_agree(robot) is agree


def test_each_robot_is_called_by_what_tells_it_from_the_others():
    robots = [made.robot("r1", "arm"), made.robot("r2", "panda"), made.robot("r3", "arm", path="b/arm.urdf")]
    robots.append(made.failed("r4", path=""))
    assert wording.labels(made.document(*robots)) == {
        "r1": "example:arm",
        "r2": "panda",
        "r3": "b/arm.urdf",
        "r4": "r4",
    }


def test_a_chain_is_called_as_its_robot_and_by_name_where_that_has_several():
    one, two = made.robot("r1", "panda"), made.loaded_robot("r2")
    called = wording.chain_labels(made.document(one, two, made.without_chains("r3")))
    assert called == {"r1-1": "panda", "r2-1": "two-armed: left_arm", "r2-2": "two-armed: right_arm"}


def test_a_path_stands_beside_a_name_that_does_not_say_it_or_that_others_have():
    told, alike = made.robot("r1", "arm", path="a/arm.urdf"), made.robot("r2", "arm", path="b/arm.urdf")
    alone, other = made.robot("r3", "two-arms", path="a/two_arms.urdf"), made.robot("r4", "ur", path="a/left.urdf")
    unnamed = made.robot("r5", "", path="a/nothing.urdf"), made.robot("r6", "", path="a/empty.urdf")
    assert wording.asides(made.document(told, alone, other, *unnamed)) == {
        "r1": "", "r3": "", "r4": "a/left.urdf", "r5": "", "r6": "",
    }  # fmt: skip
    assert wording.asides(made.document(told, alike)) == {"r1": "a/arm.urdf", "r2": "b/arm.urdf"}


def test_a_payload_says_what_sets_it_or_why_there_is_none():
    def told(**fields):
        payload = made.PayloadRow(**{"mass": None, "binding_joint": "", "least": None, "unbounded": False} | fields)
        return wording.payload_text(payload, 2.0)

    assert told(mass=7.314, binding_joint="elbow") == "7.31 kg, set by elbow"
    assert told(binding_joint="elbow", least=1.0) == "none, set by elbow: joints are overloaded"
    assert told(unbounded=True) == "no limit: no joint feels it"
    doubted = "set by hip (placeholder limits, or a load in line with the joints?)"
    assert told(mass=1700.0, binding_joint="hip").endswith(doubted)
    assert "placeholders" not in told(mass=19.9)
    assert wording.payload_text(None) == ""
