"""Expectations as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import msgspec

from kinetostat.errors import printable
from kinetostat.policy.expectations import Expectation
from kinetostat.policy.kinds.common import PLACE

__all__ = ["comment", "table", "value"]


def comment(text: str) -> str:
    """Return a text as a comment of one line."""
    return f"# {printable(text)}"


def table(expectation: Expectation) -> list[str]:
    """Return the lines of a table `[[robots.expect]]`; keys with their default value are left out."""
    lines = ["[[robots.expect]]", f"kind = {value(expectation.kind)}"]
    for part in msgspec.structs.fields(expectation):
        given = getattr(expectation, part.name)
        if part.encode_name != PLACE and given != _default(part):
            lines.append(f"{part.encode_name} = {value(given)}")
    return lines


def _default(part: msgspec.structs.FieldInfo) -> Any:
    return part.default if part.default_factory is msgspec.NODEFAULT else part.default_factory()


def value(given: Any) -> str:
    """Return a value as TOML writes it."""
    if isinstance(given, str):  # as in JSON, but for DEL, which TOML wants escaped
        return json.dumps(given, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, Mapping):
        inner = ", ".join(f"{value(str(key))} = {value(part)}" for key, part in given.items())
        return f"{{ {inner} }}" if inner else "{}"
    if isinstance(given, (list, tuple)):
        return f"[{', '.join(value(part) for part in given)}]"
    return repr(given)
