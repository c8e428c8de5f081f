"""Arguments of `check` that cannot be are refused in a line, before anything is checked."""

import pytest

import kinetostat as ks

WRONG = {
    "a path alone": (("arm.urdf",), {}),
    "a level that is none": ((["textbook:planar_2r"],), {"fail_on": "fatal"}),
    "no process": ((["textbook:planar_2r"],), {"jobs": 0}),
    "no time": ((["textbook:planar_2r"],), {"jobs": 1, "timeout": float("nan")}),
    "negative time": ((["textbook:planar_2r"],), {"jobs": 1, "timeout": -5.0}),
    "too many samples": ((["textbook:planar_2r"],), {"samples": 1_000_000}),
    "negative samples": ((["textbook:planar_2r"],), {"samples": -1}),
    "a negative seed": ((["textbook:planar_2r"],), {"seed": -1}),
    "a rule that is none": ((["textbook:planar_2r"],), {"select": ["Q"]}),
}


@pytest.mark.parametrize("name", WRONG)
def test_an_argument_that_cannot_be(name):
    paths, options = WRONG[name]
    with pytest.raises(ks.UsageError) as found:
        ks.check(*paths, **options)
    assert "\n" not in str(found.value)


def test_in_this_process_and_in_others_the_same_is_found():
    here = ks.check(["textbook:planar_2r", "textbook:puma560"])
    there = ks.check(["textbook:planar_2r", "textbook:puma560"], jobs=2)
    assert [file.findings for file in here.files] == [file.findings for file in there.files]
    assert [file.agreement for file in here.files] == [file.agreement for file in there.files]
