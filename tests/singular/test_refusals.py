"""What cannot be asked is refused, in one clear line."""

import numpy as np
import pytest

import kinetostat as ks
from singular.arms import robot
from trees import load_text

FLOATING = """<robot name="f"><link name="a"/><link name="b"/><link name="c"/>
<joint name="free" type="floating"><parent link="a"/><child link="b"/></joint>
<joint name="turn" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/></joint></robot>"""


@pytest.mark.parametrize("ask", [ks.singular_find, lambda m, f, **k: ks.singular_at(m, f, np.zeros(m.robot.nq), **k)])
class TestBoth:
    def test_no_joint_between(self, ask):
        with pytest.raises(ks.UsageError, match="no joint moves 'base'"):
            ask(robot("textbook:puma560"), "base")

    def test_a_rigid_body(self, ask):
        with pytest.raises(ks.UsageError, match="no joint"):
            ask(robot("textbook:rigid_body"), "a")

    def test_an_unknown_frame(self, ask):
        with pytest.raises(ks.UnknownNameError, match="tool"):
            ask(robot("textbook:puma560"), "toool")

    def test_an_unknown_observer(self, ask):
        with pytest.raises(ks.UnknownNameError, match="bse"):
            ask(robot("textbook:puma560"), "tool", relative_to="bse")

    @pytest.mark.parametrize("axes", ["", "q", "xyz rw"])
    def test_axes_that_are_none(self, ask, axes):
        with pytest.raises(ks.UsageError, match="ax"):
            ask(robot("textbook:puma560"), "tool", axes=axes)

    def test_axes_along_which_nothing_moves(self, ask):
        with pytest.raises(ks.UsageError, match="along vz"):
            ask(robot("textbook:planar_2r"), "tool", axes="z")

    def test_a_point_that_is_none(self, ask):
        with pytest.raises(ks.KinetostatError):
            ask(robot("textbook:planar_2r"), "tool", point=(0.0, float("nan"), 0.0))


def test_a_floating_joint_is_refused_and_what_it_carries_is_not():
    model = load_text(FLOATING)
    with pytest.raises(ks.UsageError, match=r"'free'.*\n?.*") as caught:
        ks.singular_find(model, "c")
    assert "--relative-to b" in str(caught.value) or "--relative-to b" in str(caught.value.remedy)
    assert ks.singular_find(model, "c", relative_to="b", starts=10).mechanism.names == ("turn",)


def test_a_floating_base_is_refused():
    model = ks.load("textbook:puma560", floating_base=True)
    with pytest.raises(ks.UsageError, match="floating"):
        ks.singular_find(model, "tool")


@pytest.mark.parametrize("starts", [0, -1, 10**9])
def test_starts_that_cannot_be(starts):
    with pytest.raises(ks.UsageError, match="--starts"):
        ks.singular_find(robot("textbook:planar_2r"), "tool", starts=starts)


def test_one_search_is_enough_for_what_is_complete():
    result = ks.singular_find(robot("textbook:puma560"), "tool", starts=1)
    assert {joint for family in result.families for joint in family.positions} == {"joint3", "joint5"}
    assert result.starts == 1


@pytest.mark.parametrize("q", [np.zeros((2, 6)), np.zeros(5), np.full(6, np.nan), np.full(6, np.inf)])
def test_configurations_that_are_none(q):
    with pytest.raises(ks.KinetostatError):
        ks.singular_at(robot("textbook:puma560"), "tool", q)
