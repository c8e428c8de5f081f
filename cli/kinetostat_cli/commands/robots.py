"""`kinetostat robots`: which robots ship with it."""

from __future__ import annotations

import typer

from kinetostat_cli.console import Answer, write_answer
from kinetostat_cli.options import OutputOptions, grouped

__all__ = ["register"]


@grouped
def robots(output: OutputOptions) -> None:
    """List the robots that are at hand.

    The textbook robots of kinetostat, and those of the package example-robot-data.

    Example: kinetostat robots -F json
    """
    from kinetostat.report.json import robots_result
    from kinetostat.report.view import robots_view
    from kinetostat.urdf.files import example_robots, textbook_robots

    textbook, example = textbook_robots(), example_robots()
    write_answer(
        Answer("robots", lambda: robots_view(textbook, example), lambda: robots_result(textbook, example)), output
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(robots)
