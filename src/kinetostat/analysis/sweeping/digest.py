"""What identifies a question: a digest of all that its numbers depend on."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

__all__ = ["digest"]


def digest(*parts: Any) -> str:
    """Return the SHA-256 of values: numbers, texts, None, arrays, and tuples, dicts and dataclasses of them."""
    found = hashlib.sha256()
    _feed(found, parts)
    return found.hexdigest()


def _feed(found: Any, value: Any) -> None:
    # Each value is preceded by its kind and size, so that no two sequences of values have the same bytes.
    if isinstance(value, np.ndarray):
        found.update(f"array {value.dtype.str} {value.shape};".encode())
        found.update(np.ascontiguousarray(value).tobytes())
    elif isinstance(value, (tuple, list)):
        found.update(f"list {len(value)};".encode())
        for item in value:
            _feed(found, item)
    elif isinstance(value, dict):
        _feed(found, [item for pair in value.items() for item in pair])
    elif is_dataclass(value) and not isinstance(value, type):
        found.update(f"object {type(value).__name__};".encode())
        for part in fields(value):
            _feed(found, getattr(value, part.name))
    elif value is None or isinstance(value, (bool, int, float, str)):
        text = f"{type(value).__name__} {value!r}".encode()
        found.update(f"{len(text)};".encode() + text)
    else:
        raise TypeError(f"no digest of {type(value).__name__}")
