"""What can be written into a settings file, told from the types it is read into: there is no other list of keys."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from kinetostat.policy.draft.toml import value
from kinetostat.policy.expectations import KINDS
from kinetostat.policy.kinds.common import PLACE
from kinetostat.policy.table import ChainSettings, CheckSettings, RobotSettings

__all__ = ["Key", "Page", "chain_page", "check_page", "kind_pages", "page", "robot_page"]

_TABLES = ("expect", "chains")  # lists of tables, which have pages of their own
_WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}


@dataclass(frozen=True)
class Key:
    """One key of a table.

    Attributes:
        name: as it is written.
        type: what it takes, in words.
        unit: of its numbers; empty where there is none.
        default: what it is where it is left out, as TOML; empty where nothing is.
        required: whether it may not be left out.
        description: what it says.
        examples: values that it takes, as TOML.
    """

    name: str
    type: str
    unit: str
    default: str
    required: bool
    description: str
    examples: tuple[str, ...] = ()


@dataclass(frozen=True)
class Page:
    """What is told of a table: of a kind of expectation, of [check], [[robots]] or [[robots.chains]].

    Attributes:
        name: the kind, or the table.
        aim: one line.
        why: what else is to be said, paragraphs apart.
        keys: its keys.
        example: it in TOML, complete.
    """

    name: str
    aim: str
    why: str
    keys: tuple[Key, ...]
    example: str


def page(kind: str) -> Page:
    """Return what is told of a kind of expectation.

    Args:
        kind: one of `KINDS`.
    """
    struct = KINDS[kind]
    return _page(kind, struct, f'[[robots.expect]]\nkind = "{kind}"\n{struct.example}')


def kind_pages() -> tuple[Page, ...]:
    """Return what is told of all kinds of expectations."""
    return tuple(page(kind) for kind in KINDS)


def check_page() -> Page:
    """Return what is told of the table [check]."""
    return _page("[check]", CheckSettings, _CHECK)


def robot_page() -> Page:
    """Return what is told of a table [[robots]]."""
    return _page("[[robots]]", RobotSettings, _ROBOT)


def chain_page() -> Page:
    """Return what is told of a table [[robots.chains]]."""
    return _page("[[robots.chains]]", ChainSettings, _CHAIN)


_CHECK = """\
[check]
fail-on = "warning"
ignore = ["N101"]
baseline = "baseline.json"

[check.per-path-ignores]
"vendor/*" = ["M", "N"]"""
_ROBOT = """\
[[robots]]
path = "robots/arm.urdf.xacro"
package-dirs = [".."]
xacro-args = { prefix = "left_" }"""
_CHAIN = """\
[[robots]]
path = "robots/humanoid.urdf"

[[robots.chains]]
name = "left arm"
base = "torso_link"
frame = "left_tool"
payload = 2.5"""


def _page(name: str, struct: type[msgspec.Struct], example: str) -> Page:
    aim, _, why = inspect.cleandoc(struct.__doc__ or "").partition("\n\n")
    return Page(name, " ".join(aim.split()), why.strip(), tuple(_keys(struct)), example)


def _keys(struct: type[msgspec.Struct]) -> Iterator[Key]:
    """Yield the keys of a table, those that may not be left out first."""
    hints = get_type_hints(struct, include_extras=True)
    for part in sorted(msgspec.structs.fields(struct), key=lambda part: not part.required):
        if part.encode_name not in (PLACE, *_TABLES):
            yield _key(struct, part, hints[part.name])


def _key(struct: type[msgspec.Struct], part: msgspec.structs.FieldInfo, hint: Any) -> Key:
    metas = list(_metas(hint))
    units = (meta.extra["unit"] for meta in metas if meta.extra and "unit" in meta.extra)
    unit = next(units, getattr(struct, "unit", "") if part.encode_name in ("at-least", "at-most") else "")
    described = next((meta.description for meta in metas if meta.description), "")
    examples = next((meta.examples for meta in metas if meta.examples), [])
    shown = tuple(value(one) for one in examples)
    return Key(part.encode_name, _type(hint), unit, _default(part), part.required, described or "", shown)


def _metas(hint: Any) -> Iterator[msgspec.Meta]:
    """Yield what is said of a type, the outermost first."""
    if get_origin(hint) is Annotated:
        yield from (meta for meta in reversed(get_args(hint)[1:]) if isinstance(meta, msgspec.Meta))


def _default(part: msgspec.structs.FieldInfo) -> str:
    given = None if part.default is msgspec.NODEFAULT else part.default
    if part.default_factory is not msgspec.NODEFAULT:
        given = part.default_factory()
    empty = given is None or (isinstance(given, (str, Sequence, Mapping)) and not given)
    return "" if empty else value(given)


def _type(hint: Any) -> str:
    """Return what a key takes, in words."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _type(inner[0]) + "".join(map(_bounds, reversed(list(_metas(hint)))))
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_type(one) for one in inner if one is not NoneType))
    if origin is Literal:
        return " or ".join(value(one) for one in inner)
    if origin is tuple:
        return f"list of {_several(inner[0])}" if inner[-1] is Ellipsis else f"list of {len(inner)} numbers"
    if origin is dict:
        return f"table of {_several(inner[1])}"
    return _WORDS[hint]


def _several(hint: Any) -> str:
    """Return the plural of what a list or a table holds."""
    words = _type(hint)
    if words == "text":
        return "texts"
    if get_origin(hint) is tuple:
        return words.replace("list ", "lists ", 1)
    if get_origin(hint) in (Union, UnionType):
        return " or ".join(dict.fromkeys(_several(one) for one in get_args(hint)))
    return words.replace("number", "numbers", 1)


def _bounds(meta: msgspec.Meta) -> str:
    """Return what a number is to be, in words."""
    limits = (("above", meta.gt), ("from", meta.ge), ("below", meta.lt), ("up to", meta.le))
    given = [f"{word} {limit:.12g}" for word, limit in limits if limit is not None]
    return f" {' '.join(given)}" if given else ""
