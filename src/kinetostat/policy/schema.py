"""The JSON schema of kinetostat.toml, for editors. `python -m kinetostat.policy.schema` renews the one that ships."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["SHIPPED", "schema", "text"]

SHIPPED = Path(__file__).with_name("kinetostat.schema.json")


def schema() -> dict[str, Any]:
    """Return the schema, made from the types that settings are read into."""
    import msgspec

    from kinetostat.policy.kinds.common import PLACE
    from kinetostat.policy.table import Settings

    made = msgspec.json.schema(Settings)
    table = made["$defs"].pop("Settings")
    for kind in made["$defs"].values():
        kind["properties"].pop(PLACE, None)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "kinetostat.toml",
        **{key: value for key, value in table.items() if key != "title"},
        "$defs": {name: made["$defs"][name] for name in sorted(made["$defs"])},
    }


def text() -> str:
    """Return the schema as text, as it ships."""
    import json

    return json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SHIPPED.write_text(text(), encoding="utf-8")
