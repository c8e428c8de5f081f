"""`kinetostat explain`: why a rule matters, with a bad and a good example; what an expectation means, key by key."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat_cli.console import Answer, write_answer
from kinetostat_cli.options import OutputOptions, grouped

__all__ = ["register"]


@grouped
def explain(
    output: OutputOptions,
    code: Annotated[
        str, typer.Argument(metavar="CODE", help="The code or name of a rule, or a kind of expectation such as holds.")
    ],
) -> None:
    """Show why a rule matters, or what an expectation means.

    A rule with a bad and a good example; a kind of expectation of kinetostat.toml with all its keys and an example.

    Example: kinetostat explain J103
    """
    write_answer(_answer(code), output)


def _answer(word: str) -> Answer:
    """Return what is told of a rule, or of a kind of expectation.

    Raises:
        UnknownNameError: it is neither.
    """
    from kinetostat.errors import unknown_name
    from kinetostat.lint.registry import RULES, rule
    from kinetostat.policy.expectations import KINDS
    from kinetostat.policy.manual import page
    from kinetostat.report.expectations import expectation_result, expectation_view
    from kinetostat.report.rules import explain_result, explain_view

    if word.lower() in KINDS:
        told = page(word.lower())
        return Answer("explain", lambda: expectation_view(told), lambda: expectation_result(told))
    names = [name for known in RULES for name in (known.code, known.name)]
    if word not in names and word.upper() not in names:
        raise unknown_name("rule or expectation", word, [*names, *KINDS], listing="'kinetostat rules' lists them")
    found = rule(word)
    return Answer("explain", lambda: explain_view(found), lambda: explain_result(found))


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(explain)
