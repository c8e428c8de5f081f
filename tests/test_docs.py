"""The page of singular configurations, and that of the report, are what their commands make."""

import importlib.util
import re
from pathlib import Path

import kinetostat as ks
from kinetostat.report.fleet.schema import schema
from kinetostat.report.fleet.table import CHAIN_COLUMNS, ROBOT_COLUMNS

DOCS = Path(__file__).parents[1] / "docs"


def script(name="singularities"):
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_has_ten_arms_and_what_is_complete_of_them():
    page, made = (DOCS / "singularities.md").read_text(encoding="utf-8"), script()
    assert len(made.ARMS) == 10
    for name, frame, observer in made.ARMS:
        assert f"\n## {name}\n" in page
        section = page.split(f"\n## {name}\n")[1].split("\n## ")[0]
        found = ks.singular_find(ks.load(f"example:{name}"), frame, relative_to=observer, starts=30)
        for family in found.families:
            if family.complete:
                (joint,) = family.support
                lines = [line for line in section.splitlines() if f"| {joint} = " in line]
                assert any(f"| {family.codimension} |" in line for line in lines), (name, family.positions)


def test_the_page_names_its_command():
    assert "make singularities" in script().HEAD
    assert "\nsingularities: " in (DOCS.parent / "Makefile").read_text(encoding="utf-8")


def report_page():
    return (DOCS / "report.md").read_text(encoding="utf-8")


def test_the_page_of_the_report_is_up_to_date():
    assert report_page() == script("report").page(), "renew it: make report"
    assert "\nreport: " in (DOCS.parent / "Makefile").read_text(encoding="utf-8")


def test_the_page_of_the_report_tells_every_key_under_its_type():
    made = schema()
    for name, table in {"FleetDocument": made, **made["$defs"]}.items():
        section = report_page().split(f"\n### {name}\n")[1].split("\n##")[0]
        rows = re.findall(r"^\| `(\w+)` \| (.+?) \| (.*?) \| (.+) \|$", section, re.MULTILINE)
        assert [key for key, *_ in rows] == list(table["properties"])
        assert [unit for _, _, unit, _ in rows] == [told.get("unit", "") for told in table["properties"].values()]


def test_the_page_of_the_report_tells_every_column():
    section = report_page().split("\n## robots.csv\n")[1]
    told = re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)
    assert told == [column.name for column in (*ROBOT_COLUMNS, *CHAIN_COLUMNS)]


def test_every_link_of_the_page_of_the_report_leads_somewhere():
    page = report_page()
    headings = {heading.lower() for heading in re.findall(r"^#+ (\w+)$", page, re.MULTILINE)}
    links = re.findall(r"\]\(([^)]+)\)", page)
    assert links
    for link in links:
        assert link[1:] in headings if link.startswith("#") else (DOCS / link).is_file(), link
