"""The JSON schema of report.json. `python -m kinetostat.report.fleet.schema` renews the one that ships."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["SHIPPED", "schema", "text"]

SHIPPED = Path(__file__).with_name("kinetostat-report.schema.json")


def schema() -> dict[str, Any]:
    """Return the schema, made from the types that the report is made of.

    Every key is always there, also one that has a default. Other keys than these are allowed: within a version, keys
    are added.
    """
    import msgspec

    from kinetostat.report.fleet.document import FleetDocument

    made = msgspec.json.schema(FleetDocument)
    report = made["$defs"].pop("FleetDocument")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_required(report),
        "title": "kinetostat report",
        "$defs": {name: _required(made["$defs"][name]) for name in sorted(made["$defs"])},
    }


def _required(table: dict[str, Any]) -> dict[str, Any]:
    return table | {"required": list(table["properties"])}


def text() -> str:
    """Return the schema as text, as it ships."""
    import json

    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SHIPPED.write_text(text(), encoding="utf-8")
