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
    """List the rules that check asks, and the kinds of expectations that a policy has.

    Example: kinetostat rules --select K
    """
    from kinetostat.lint.registry import chosen
    from kinetostat.policy.manual import kind_pages
    from kinetostat.report.rules import rules_result, rules_view

    found = chosen([code for word in select or [] for code in word.split(",")])
    kinds = () if select else kind_pages()
    write_answer(Answer("rules", lambda: rules_view(found, kinds), lambda: rules_result(found, kinds)), output)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(rules)
