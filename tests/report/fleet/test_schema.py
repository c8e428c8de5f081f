"""The JSON schema of report.json: up to date, and of the same mind as what is written."""

from __future__ import annotations

import json
import math

import jsonschema
import pytest

from kinetostat.report.fleet import schema
from kinetostat.report.fleet.files import json_text
from report.fleet.fleet_reports import arm, described, described_text, failed, fleet_of
from trees import random_urdf

SHIPPED = json.loads(schema.SHIPPED.read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SHIPPED)
NAMES = ("textbook:planar_2r_6_3", "textbook:rigid_body", "textbook:helical", "example:panda", "example:so101")


def written(*robots):
    return json.loads(json_text(fleet_of(*robots)))


def tables():
    return {"the report": SHIPPED, **SHIPPED["$defs"]}.items()


def test_the_one_that_ships_is_up_to_date():
    assert schema.SHIPPED.read_text(encoding="utf-8") == schema.text(), "renew it: make report"


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SHIPPED)


@pytest.mark.parametrize("name", NAMES)
def test_it_takes_what_is_written(name):
    VALIDATOR.validate(written(described(name), failed()))


def test_it_takes_odd_robots():
    for text in (
        arm("planar 0 0 1", "revolute 0 1 0"),
        arm("prismatic 1 0 0", mass=0),
        arm("floating 0 0 1", "revolute 0 1 0"),
        '<robot name=""><link name="a"/></robot>',
    ):
        VALIDATOR.validate(written(described_text(text)))


@pytest.mark.parametrize("seed", range(8))
def test_it_takes_random_robots(seed):
    VALIDATOR.validate(written(described_text(random_urdf(seed))))


@pytest.mark.parametrize("name", [name for name, _ in tables()])
def test_every_key_is_described_and_required(name):
    table = dict(tables())[name]
    assert table["description"].endswith(".")
    assert all(told["description"].endswith(".") for told in table["properties"].values())
    assert set(table["required"]) == set(table["properties"])


def test_every_number_that_may_have_a_unit_has_one_or_says_where_it_is():
    bare = {
        f"{name}.{key}"
        for name, table in tables()
        for key, told in table["properties"].items()
        if {"type": "number"} in (*told.get("anyOf", ()), {"type": told.get("type")}) and "unit" not in told
    }
    # Those whose unit is another key's value, or differs from one answer to the next.
    assert bare == {
        "Agreed.max_difference", "Agreed.tolerance", "CertificateRow.max_difference", "CertificateRow.tolerance",
        "DistributionRow.maximum", "DistributionRow.mean", "DistributionRow.minimum",
        "PoseRow.smallest_singular_value", "PoseRow.yoshikawa",
    }  # fmt: skip


def test_it_takes_keys_that_a_later_report_of_this_version_adds():
    later = written(described("textbook:planar_2r_6_3"))
    later["robots"][0]["chains"][0]["stiffness"] = 3.0
    VALIDATOR.validate(later)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda r: r.pop("schema"),
        lambda r: r.update(schema="kinetostat/report/2"),
        lambda r: r["robots"][0].pop("left"),
        lambda r: r["robots"][0].update(mass="4 kg"),
        lambda r: r["robots"][0]["chains"][0].update(found="guessed"),
        lambda r: r["robots"][0]["joints"][0]["gravity"].update(torque=None),
    ],
)
def test_it_refuses_what_is_not_a_report(spoil):
    report = written(described("textbook:planar_2r_6_3"))
    spoil(report)
    assert list(VALIDATOR.iter_errors(report))


@pytest.mark.parametrize("name", NAMES)
def test_every_key_is_written_and_every_number_is_finite(name):
    def walk(value, table):
        assert set(value) == set(table["properties"])
        for key, told in table["properties"].items():
            parts = value[key] if isinstance(value[key], list) else [value[key]]
            kinds = [told, told.get("items", {}), *told.get("anyOf", ())]
            reference = next((kind["$ref"].rpartition("/")[2] for kind in kinds if "$ref" in kind), None)
            for part in parts:
                if reference and part is not None:
                    walk(part, SHIPPED["$defs"][reference])
                if isinstance(part, float):
                    assert math.isfinite(part)

    walk(written(described(name), failed()), SHIPPED)
