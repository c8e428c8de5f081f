"""`make census`: what `check` finds in the robots of example-robot-data, by rule. Writes census.md."""

from __future__ import annotations

from collections import Counter
from importlib.metadata import version
from pathlib import Path

import kinetostat as ks
from kinetostat.lint.registry import FAMILIES, RULES

PAGE = Path(__file__).with_name("census.md")
HEAD = """# A census of example-robot-data

`kinetostat check 'example:*' --no-settings` over the {count} robot files of example-robot-data {data}, made by
`make census`. {passed} pass, {failed} fail (an error). Three readers (Pinocchio, the screw engine, yourdfpy) agree on
{agree} of the {compared} that can be read, on {frames} frames at 20 configurations each.

An error makes a file unusable, or its numbers meaningless, in common tools. A warning is probably a mistake, or is what
some common tools refuse. An info is worth knowing. `kinetostat explain CODE` says why each matters.

## What fails, and why

{failures}

## Findings by rule

{rules} rules; those that are not in the table found nothing.

{table}
"""


def page(report: ks.CheckReport) -> str:
    """Return the page for what was found."""
    findings = [(file.path, finding) for file in report.files for finding in file.findings]
    counts = Counter((finding.code, finding.severity) for _, finding in findings)
    robots = Counter((code, severity) for code, severity, _ in {(f.code, f.severity, path) for path, f in findings})
    names = {rule.code: rule.name for rule in RULES}
    rows = ["| rule | | severity | findings | robots |", "|---|---|---|---|---|"]
    for family, title in FAMILIES.items():
        mine = sorted((key for key in counts if key[0].startswith(family)), key=lambda key: (key[0], key[1].rank))
        total = sum(counts[key] for key in mine)
        rows.append(f"| **{family}** | **{title}** | | **{total}** | |")
        rows += [
            f"| {code} | {names[code]} | {level} | {counts[code, level]} | {robots[code, level]} |"
            for code, level in mine
        ]
    failures = [
        f"- `{file.path}`: "
        + (file.reason or "; ".join(f"{f.code} {f.message}" for f in file.findings if f.severity is ks.Severity.ERROR))
        for file in report.files
        if file.verdict is not ks.Verdict.PASS
    ]
    compared = [file.agreement for file in report.files if file.agreement is not None]
    return HEAD.format(
        count=len(report.files),
        data=version("example-robot-data"),
        passed=len(report.files) - len(failures),
        failed=len(failures),
        agree=sum(found.agree for found in compared),
        compared=len(compared),
        frames=sum(found.frames for found in compared),
        failures="\n".join(failures),
        rules=len(RULES),
        table="\n".join(rows),
    )


def main() -> None:
    """Check all robots and write the page."""
    report = ks.check(["example:*"], jobs=2)
    PAGE.write_text(page(report), encoding="utf-8")
    print(f"{PAGE.name}: {sum(len(file.findings) for file in report.files)} findings of {len(report.files)} robots")


if __name__ == "__main__":
    main()
