"""`kinetostat explain`: why a rule matters, with a bad and a good example."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat_cli.console import Answer, write_answer
from kinetostat_cli.options import OutputOptions, grouped

__all__ = ["register"]


@grouped
def explain(
    output: OutputOptions,
    code: Annotated[str, typer.Argument(metavar="CODE", help="The code, or the name, of a rule.")],
) -> None:
    """Show why a rule matters, and a bad and a good example.

    Example: kinetostat explain J103
    """
    from kinetostat.report.rules import explain_result, explain_view

    from kinetostat.lint.registry import rule

    found = rule(code)
    write_answer(Answer("explain", lambda: explain_view(found), lambda: explain_result(found)), output)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(explain)
