"""`python docs/report.py`: write docs/report.md, what report.json and robots.csv hold, from what they are made of."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from kinetostat.report.fleet.schema import SHIPPED, schema
from kinetostat.report.fleet.table import CHAIN_COLUMNS, ROBOT_COLUMNS, TableColumn

PAGE = Path(__file__).with_name("report.md")
SOURCE = Path(__file__).parents[1]
HEAD = f"""# The report: its files, and what its numbers mean

`kinetostat report PATHS... -o DIR` writes four files. Made by `make report` from the types that they are made of.

| file | |
|---|---|
| `index.html` | to look at: one page that needs nothing else, and asks nothing of any network |
| `report.json` | all numbers |
| `robots.csv` | a row for each chain of each robot |
| `report.md` | the overview, for a merge request or a wiki |

Each is written whole or not at all, `index.html` last. What stood under these four names is replaced; if one of them
is a folder or a link, or `DIR` cannot be written, the command says so.

The same files and options give the same bytes, but for when the report was made; `SOURCE_DATE_EPOCH` (seconds since
1970) sets that, too.

## report.json

The schema (JSON Schema, draft 2020-12) ships with the package:
[`{SHIPPED.name}`](../{SHIPPED.relative_to(SOURCE).as_posix()}).
A unit stands in it as `"unit"`.

- **Version.** `schema` is `kinetostat/report/1`. Within version 1, keys are added, but none is renamed, removed or
  given another meaning, type or unit: a reader that ignores keys it does not know can read all reports of version 1. A
  change of any other kind makes version 2.
- **Units.** m, rad, kg, N, Nm, s, whatever the page shows; 1 is a pure number, and shares are from 0 to 1.
- **No number.** What is not known, or not finite, is `null`; there is no NaN. The reason is with the key, or in
  `left` of the chain or the robot.
- **Precision.** Numbers have as many digits as it takes to read the same float back.
- **Names** are as in the robot file. What a terminal would not print is escaped (`\\u001b`), and file names that are
  not UTF-8 have `\\udc80` and the like written out.

"""
MEANING = """## What the numbers mean

What is asked of one configuration comes from Pinocchio, and our screw engine, which shares no code with it, computes it
again. Measures of thousands of random configurations, and of the places of a map of the reach, come from our compiled
code; of those Pinocchio computes some rows, and all extremes, again. `certificate` counts the numbers that were
computed twice, and no others, and tells how far the two came apart.

**Random configurations** are uniform inside limits, those of followers too. An angle without limits makes a whole turn;
a slide without limits goes 1 m to either side (`left` says so: numbers depend on it). Joints that are not the chain's
stay at the middle of their limits.

**Singular values** are those of the rows of the tool's Jacobian that count (`rows`), relative to the chain's base: all
six, or the three linear ones of an arm with three joints or fewer that moves its tool by them. Where metres and radians
meet, linear rows are divided by the chain's `length` L, and a slide counts as an angle q / L. L^2 = (sum of squares of
the linear rows) / (sum of squares of the angular rows), of the columns of joints that turn, over 4,096 low-discrepancy
configurations inside limits (Halton's sequence). Those that are zero at almost every configuration do not count:
s_1 >= ... >= s_r, r = `rank`.

**Poses** are of the whole robot: `zero` has all joints at zero, `mid` all at the middle of their limits (left
out where that is zero for the chain), a state of the SRDF those at zero that it does not set. Effort use at a pose is
that of the robot there.

| number | what it is |
|---|---|
"""
NUMBERS = (
    ("`yoshikawa` (manipulability)", "s_1 s_2 ... s_r"),
    ("`minimum_singular_value`", "s_r: the slowest motion that unit joint rates make"),
    ("`inverse_condition_number` (dexterity)", "s_r / s_1: 1 where all directions are alike, 0 where it is singular"),
    ("`near_singular_share`", "the share of random configurations with s_r / s_1 below `near`"),
    (
        "`effort_use`",
        "the largest of abs(gravity torque) / effort limit among the chain's joints; joints without a limit do not "
        "count",
    ),
    (
        "`reach` of a chain",
        "the largest distance, inside limits, of the tool's origin from that of the chain's first joint (as that is "
        "with all joints at the middle of their limits). From the farthest random configurations it is climbed by "
        "L-BFGS-B with the exact gradient. A lower bound: a farther place is not excluded",
    ),
    (
        "`reach` of a robot",
        "the longest path from the root to a link, stretched out: the sum of all lengths on the way, and of how far "
        "slides with limits go, max(abs(lower), abs(upper)). An upper bound of how far any point gets, bends and turns "
        "left out of account",
    ),
    (
        "`payload_at_mid`",
        "the largest point mass at the tool's origin that the effort limits of the chain's own joints hold still with "
        "all joints at the middle of their limits: `binding_joint` is the first whose gravity torque, with it, is at "
        "its limit. `unbounded` where no joint of the chain feels it; none is possible where a joint of the chain is "
        "beyond its limit without it; null where a joint of the chain that feels it has no effort limit, or where no "
        "joint moves the tool along (`turns_only`). Strength alone: no structure, no dynamics, and not what the trunk "
        "or other limbs can bear",
    ),
    (
        "`worst_gravity_use`",
        "the largest abs(gravity torque) / effort limit of the chain's joints in all configurations of the whole robot "
        "that were looked at: random ones inside limits, and from the worst of them a climb for each joint. A lower "
        "bound: a worse one is not excluded",
    ),
    ("`worst_loaded_use`", "the same with `asked_payload` as a point mass at the tool's origin"),
    (
        "`families`",
        "what `kinetostat singular find` finds: conditions on one joint alone from common roots of polynomials, which "
        "are complete; all others from `starts` searches. `unseen` is the chance that one more search finds another",
    ),
    ("`mass`", "the sum over all links"),
    (
        "`gravity` of a joint",
        "as `worst_gravity_use`, of this joint: what holds it still. 0 where it is within the tolerance between the "
        "engines, as on an upright axis",
    ),
)
GRAVITY = """
Gravity is 9.81 m/s2 down the root link's z axis. An effort limit of 0, or below, counts as not stated. Joints with
several coordinates (floating, planar) are where the middle of limits has them whenever weight counts.

"""
KEYS = """## Keys

`null` where the type says so; every key is always there.

"""
TABLE = """## robots.csv

A row for each chain of each robot; a robot without chains, or one that failed, has one row whose cells of chains are
empty. UTF-8, RFC 4180 with line feeds; the unit is in the header, in brackets; numbers are in full precision, and an
empty cell is a number that is not known. A name that begins with `=`, `+`, `-`, `@` is led by an apostrophe, so that no
spreadsheet takes it for a formula; what is not printable is escaped. Within a version of the report, columns are added
at the end.

"""


def page() -> str:
    """Return the page."""
    columns = [*map(_column, ROBOT_COLUMNS), *map(_column, CHAIN_COLUMNS)]
    listed = "| column | unit | |\n|---|---|---|\n" + "\n".join(columns) + "\n"
    numbers = "".join(f"| {name} | {told} |\n" for name, told in NUMBERS)
    return HEAD + MEANING + numbers + GRAVITY + KEYS + "\n".join(_tables()) + "\n" + TABLE + listed


def _column(column: TableColumn[Any]) -> str:
    return f"| `{column.name}` | {column.unit} | {_inline(column.about)} |"


# --- keys ----------------------------------------------------------------------------------------------------------


def _tables() -> Iterator[str]:
    """Yield a table of keys for each type, the whole before its parts, with the places where it stands."""
    made = schema()
    kinds = {"FleetDocument": made, **made["$defs"]}
    for name, places in _places(kinds).items():
        rows = "\n".join(_row(key, told) for key, told in kinds[name]["properties"].items())
        at = "the whole file" if places == [""] else " and ".join(f"`{place}`" for place in places)
        yield f"### {name}\n\n{_inline(kinds[name]['description'])} Here: {at}.\n\n{_HEADER}{rows}\n"


_HEADER = "| key | type | unit | |\n|---|---|---|---|\n"


def _places(kinds: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return where each type stands, such as `robots[].chains[]`; types in the order in which they are met."""
    found, waiting = dict[str, list[str]](), [("FleetDocument", "")]
    for name, place in waiting:  # which grows as it is walked
        found.setdefault(name, []).append(place)
        for key, told in kinds[name]["properties"].items():
            part = _part(told)
            if part:
                step = f"{key}[]" if told.get("type") == "array" else key
                waiting.append((part, f"{place}.{step}".lstrip(".")))
    return found


def _part(told: Mapping[str, Any]) -> str:
    """Return the type that a key holds, or holds a list of; empty for numbers and texts."""
    every = [told, told.get("items", {}), *told.get("anyOf", ())]
    return next((one["$ref"].rpartition("/")[2] for one in every if "$ref" in one), "")


def _row(key: str, told: Mapping[str, Any]) -> str:
    return f"| `{key}` | {_type(told)} | {told.get('unit', '')} | {_inline(told.get('description', ''))} |"


_WORDS = {"string": "text", "integer": "whole number", "number": "number", "boolean": "true or false", "null": "null"}


def _type(told: Mapping[str, Any]) -> str:
    """Return what a key holds, in words."""
    if "$ref" in told:
        name = told["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "anyOf" in told:
        return _either([_type(one) for one in told["anyOf"]])
    if "enum" in told:
        return _either([f'`"{one}"`' for one in told["enum"]])
    if told["type"] == "array":
        return f"list of {_several(_type(told['items']))}"
    if told["type"] == "object":
        return f"{_several(_type(told['additionalProperties']))} by name"
    return _WORDS[told["type"]]


def _either(words: Sequence[str]) -> str:
    """Return alternatives, null last."""
    return " or ".join(sorted(words, key=lambda word: word == "null"))


def _several(words: str) -> str:
    return words if words.startswith("[") else f"{words}s"


def _inline(text: str) -> str:
    """Return a text that Markdown takes as it is, in a cell of a table too."""
    return re.sub(r"([|<*])", r"\\\1", text)


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE.name}: {len(schema()['$defs']) + 1} tables of keys")


if __name__ == "__main__":
    main()
