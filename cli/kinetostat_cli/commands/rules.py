"""`kinetostat rules`: what `check` looks for."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat_cli.console import Answer, write_answer
from kinetostat_cli.options import OutputOptions, grouped

__all__ = ["register"]


@grouped
def rules(
    output: OutputOptions,
    select: Annotated[
        list[str] | None, typer.Option(metavar="CODES", help="Only these: a family J, a beginning J1, a code.")
    ] = None,
) -> None:
    """List the rules that check asks.

    Example: kinetostat rules --select K
    """
    from kinetostat.report.rules import rules_result, rules_view

    from kinetostat.lint.registry import chosen

    found = chosen([code for word in select or [] for code in word.split(",")])
    write_answer(Answer("rules", lambda: rules_view(found), lambda: rules_result(found)), output)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(rules)
