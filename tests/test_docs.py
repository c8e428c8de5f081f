"""The page of singular configurations is what its command makes."""

import importlib.util
from pathlib import Path

import kinetostat as ks

DOCS = Path(__file__).parents[1] / "docs"


def script():
    spec = importlib.util.spec_from_file_location("singularities", DOCS / "singularities.py")
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
