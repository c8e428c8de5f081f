"""Views and JSON of the kinds of expectations: their list below that of rules, the page of one (`explain holds`)."""

from __future__ import annotations

from collections.abc import Sequence

from kinetostat.policy.manual import Key, Page
from kinetostat.report.json import Json
from kinetostat.report.view import Cell, Table, View

__all__ = ["expectation_result", "expectation_view", "expectations_table", "key_text", "listed_expectations"]


def expectations_table(pages: Sequence[Page]) -> Table:
    """Return the list of kinds of expectations."""
    rows = tuple((page.name, page.aim) for page in pages)
    return Table(("kind", "aim"), rows, title="Expectations, tables [[robots.expect]] of kinetostat.toml", words=True)


def expectation_view(page: Page) -> View:
    """Return the view of one kind: what it means, each key, and an example."""
    tables = [_paragraphs(page.why)] if page.why else []
    tables.append(Table(("", ""), tuple((key.name, key_text(key)) for key in page.keys), title="Keys", words=True))
    tables.append(
        Table(("",), tuple((f"  {line}",) for line in page.example.splitlines()), title="Example", words=True)
    )
    flat = Table(("key", "type", "unit", "default", "description", "examples"), tuple(map(_row, page.keys)), words=True)
    note = "a file of it: 'kinetostat init ROBOT'; all kinds: 'kinetostat rules'; the settings: docs/policy.md"
    return View(f"{page.name} (expectation)\n{page.aim}", tuple(tables), (note,), flat=flat)


def _paragraphs(text: str) -> Table:
    rows = tuple((" ".join(part.split()),) for part in text.split("\n\n"))
    return Table(("",), rows, title="What it means", words=True)


def key_text(key: Key) -> str:
    """Return what is told of a key in a paragraph: what it takes, whether it may be left out, what it says."""
    unit = f", in {key.unit}" if key.unit else ""
    left_out = "; required" if key.required else f"; default {key.default}" if key.default else ""
    text = f"{key.type}{unit}{left_out}. {key.description}"
    return text + (f" For instance {' · '.join(key.examples)}" if key.examples else "")


def _row(key: Key) -> tuple[Cell, ...]:
    default = "required" if key.required else key.default
    return key.name, key.type, key.unit, default, key.description, " | ".join(key.examples)


def listed_expectations(pages: Sequence[Page]) -> list[Json]:
    """Return the kinds of expectations as JSON."""
    return [{"kind": page.name, "aim": page.aim} for page in pages]


def expectation_result(page: Page) -> Json:
    """Return the result object of `explain` for a kind of expectation."""
    keys = [
        {
            "key": key.name,
            "type": key.type,
            "unit": key.unit or None,
            "required": key.required,
            "default": key.default or None,
            "description": key.description,
            "examples": list(key.examples),
        }
        for key in page.keys
    ]
    return {"kind": page.name, "aim": page.aim, "why": page.why, "keys": keys, "example": page.example}
