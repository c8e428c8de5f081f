"""robots.csv: a row for each chain, numbers that read back, names that nothing takes for more than text."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import msgspec
import pytest

from kinetostat.report.fleet.describing import robot_document
from kinetostat.report.fleet.table import CHAIN_COLUMNS, ROBOT_COLUMNS, robots_csv
from report.check_reports import BAD, HOSTILE, MET, UNMET
from report.fleet import fleet_documents as made
from report.fleet.fleet_reports import checked, described, failed, fleet_of, profiled

NAMES = ("textbook:planar_2r_6_3", "textbook:rigid_body", "example:panda", "example:ur5_robot")


def read(*robots):
    return list(csv.DictReader(io.StringIO(robots_csv(fleet_of(*robots)))))


def renamed(robot, **changes):
    return msgspec.structs.replace(robot, **changes)


def test_a_row_for_each_chain_and_one_for_a_robot_without():
    robots = [described(name) for name in NAMES] + [failed()]
    rows = read(*robots)
    assert len(rows) == sum(max(1, len(robot.chains)) for robot in robots)
    assert [row["chain_id"] for row in rows if row["chain_id"]] == [c.id for r in robots for c in r.chains]


@pytest.mark.parametrize("name", NAMES)
def test_numbers_read_back_to_the_last_digit(name):
    robot = described(name)
    for row, chain in zip(read(robot), robot.chains, strict=False):
        assert float(row["mass [kg]"]) == robot.mass
        assert float(row["reach [m]"]) == chain.reach
        assert float(row["near_singular_share"]) == chain.near_singular_share
        quantiles = {one.measure: one.quantiles for one in chain.distributions}
        assert float(row["yoshikawa_median"]) == quantiles["yoshikawa"]["0.5"]
        assert float(row["dexterity_10_percent"]) == quantiles["inverse_condition_number"]["0.1"]
        assert (row["payload_at_mid [kg]"] == "") == (chain.payload_at_mid is None or chain.payload_at_mid.mass is None)


def test_a_robot_that_failed_has_a_reason_and_no_numbers():
    (row,) = read(failed(reason="line 3: not XML"))
    assert (row["status"], row["reason"], row["verdict"]) == ("unreadable", "line 3: not XML", "fail")
    filled = {key for key, cell in row.items() if cell}
    assert filled <= {
        "robot_id", "path", "status", "reason", "verdict", "errors", "warnings", "infos",
        "expectations", "expectations_unmet",
    }  # fmt: skip


def test_findings_and_expectations_are_counted():
    told = replace(BAD, outcomes=(MET, UNMET))
    found = robot_document("r1", told, profiled("textbook:planar_2r"), status="done", reason="", payload=None)
    (row,) = read(found)
    assert (row["errors"], row["warnings"], row["infos"]) == tuple(
        str(sum(f.severity == s for f in told.findings)) for s in ("error", "warning", "info")
    )
    assert (row["expectations"], row["expectations_unmet"]) == ("2", "1")


@pytest.mark.parametrize("name", ["=1+1", "+1+1", "-1+cmd", "@SUM(A1)", "\t=1", "\r=1", "\n=1"])
def test_no_name_is_a_formula(name):
    robot = described("textbook:planar_2r")
    chain = msgspec.structs.replace(robot.chains[0], name=name, worst_gravity_joint=name)
    text = robots_csv(fleet_of(renamed(robot, name=name, path=name, reason=name, chains=(chain,))))
    for row in csv.reader(io.StringIO(text)):
        assert not any(cell[:1] in ("=", "+", "@", "\t", "\r") for cell in row)
        assert not any(cell.startswith("-1+") for cell in row)


def test_a_hostile_name_stays_in_its_cell_and_shows_as_text():
    name = HOSTILE.encode("utf-8", "replace").decode()
    robot = described("textbook:planar_2r")
    text = robots_csv(fleet_of(renamed(robot, name=name)))
    assert text.replace("\n", "").isprintable()
    (row,) = csv.DictReader(io.StringIO(text))
    assert "<script>alert(1)</script>" in row["robot"]
    assert row["chain_id"] == "r1-1"
    assert len(text.splitlines()) == 2


def test_columns_have_names_of_their_own_and_say_what_they_are():
    names = [column.name for column in (*ROBOT_COLUMNS, *CHAIN_COLUMNS)]
    assert len(set(names)) == len(names)
    assert all(column.about.endswith(".") for column in (*ROBOT_COLUMNS, *CHAIN_COLUMNS))


def test_no_robots_is_a_header():
    assert robots_csv(fleet_of()).count("\n") == 1


def test_verdicts_are_those_of_check():
    (row,) = read(described("textbook:planar_2r_6_3"))
    assert row["verdict"] == checked("textbook:planar_2r_6_3").verdict.value
    assert (row["readers_agree"], row["engines_agree"]) == ("true", "true")


def test_what_died_has_no_counts_of_findings_and_a_payload_without_limit_says_so():
    free = made.PayloadRow(mass=None, binding_joint="", least=0.0, unbounded=True)
    chains = made.chain(payload_at_mid=free), made.chain("r1-2"), made.chain("r1-3", payload_at_mid=None)
    text = robots_csv(made.document(made.robot(chains=chains), made.failed("r2", status="crashed", verdict="crashed")))
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [row["payload_unbounded"] for row in rows] == ["true", "false", "", ""]
    assert [row["payload_at_mid [kg]"] for row in rows[:2]] == ["", "7.31"]
    assert [row["errors"] for row in rows] == ["1", "1", "1", ""]
