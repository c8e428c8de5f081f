"""`python docs/policy.py`: write docs/policy.md, what kinetostat.toml can say, from the types that it is read into."""

from __future__ import annotations

from pathlib import Path

from kinetostat.policy.manual import Key, Page, chain_page, check_page, kind_pages, robot_page

PAGE = Path(__file__).with_name("policy.md")
HEAD = """# The policy: kinetostat.toml

What `kinetostat check` checks, and what robots are expected to do. `kinetostat init ROBOT...` writes a first one, of
what is true of robots now; `kinetostat explain KIND` shows what is said here of one kind of expectation. Made by
`python docs/policy.py` from the types that the file is read into.

The file is `kinetostat.toml` in the folder of what is checked, or in one above it, up to the root of the repository; or
the same under `[tool.kinetostat]` in `pyproject.toml`, where the tables are `[tool.kinetostat.check]`,
`[[tool.kinetostat.robots]]` and `[[tool.kinetostat.robots.expect]]`. Files and globs in it are relative to its folder.
A key that there is not, or a value that cannot be, is refused with its line. Lengths are in m, angles in rad, forces in
N, moments in Nm, masses in kg.

An expectation is met, not met, or not judged (no such frame, no effort limit, a file that is not there, engines that
disagree); only the first lets the robot pass. Below it stand what was wanted, what is, and the configuration at which
it is so.

## In an editor

Editors that know TOML schemas (Taplo; Even Better TOML for VS Code) complete the keys and mark what is wrong.
`kinetostat init --schema -o kinetostat.schema.json` writes the schema; the first line of `kinetostat.toml` names it:

```toml
#:schema ./kinetostat.schema.json
```
"""
ROBOTS = """\
Several tables may name the same robot: all their expectations are asked. Each expectation is a table
`[[robots.expect]]` below the table of its robot, with its kind and the keys of that kind."""
KINDS = """## Expectations

{count} kinds. An expectation about a frame takes `frame` and mostly `relative-to`; one about configurations takes `at`:

| at | |
|---|---|
| `"zero"` | all joints at zero (the default) |
| `"mid"` | the middle of the limits |
| `"random:7"` | a random configuration inside the limits, by its seed |
| `"home"` | a state of the SRDF; `"arm/home"` where several groups have one of that name |
| `"j1=0.3,j2=-1.2"` | these joints there, the others at zero |
| `[0.3, -1.2]` | all independent joints, in the order of the file |
| `"states"` | every SRDF state that moves the frame; the worst one counts |
| `["home", "mid"]` | all of these; the worst one counts |

"""


def page() -> str:
    """Return the page."""
    kinds = kind_pages()
    listed = "\n".join(f"- [`{kind.name}`](#{kind.name}): {_inline(kind.aim)}" for kind in kinds)
    parts = [
        HEAD,
        f"## {check_page().name}\n\n{_told(check_page())}",
        f"## {robot_page().name}\n\n{_told(robot_page())}\n{ROBOTS}\n",
        f"## {chain_page().name}\n\n{_told(chain_page())}",
        KINDS.format(count=len(kinds)) + listed + "\n",
        *(f"### {kind.name}\n\n{_told(kind)}" for kind in kinds),
    ]
    return "\n".join(parts)


def _told(table: Page) -> str:
    """Return what is told of a table: its aim, its keys, an example."""
    rows = "\n".join(map(_row, table.keys))
    why = f"{table.why}\n\n" if table.why else ""
    keys = f"| key | takes | default | |\n|---|---|---|---|\n{rows}\n"
    return f"{_inline(table.aim)}\n\n{why}{keys}\n```toml\n{table.example}\n```\n"


def _row(key: Key) -> str:
    unit = f", in {key.unit}" if key.unit else ""
    default = "*required*" if key.required else f"`{key.default}`" if key.default else ""
    examples = f" For instance {', '.join(f'`{one}`' for one in key.examples)}." if key.examples else ""
    return f"| `{key.name}` | {_inline(key.type)}{unit} | {default} | {_inline(key.description)}{examples} |"


def _inline(text: str) -> str:
    """Return a text that Markdown takes as it is, in a cell of a table too."""
    return text.replace("|", "\\|").replace("<", "\\<")


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE.name}: {len(kind_pages())} kinds of expectations")


if __name__ == "__main__":
    main()
