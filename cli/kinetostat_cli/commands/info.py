"""`kinetostat info`: what is in a robot file."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat_cli.console import Answer, load, write_answer
from kinetostat_cli.options import OutputOptions, RobotOptions, grouped

__all__ = ["register"]


@grouped
def info(
    robot: RobotOptions,
    output: OutputOptions,
    deg: Annotated[bool, typer.Option("--deg", help="Show limits of angles in degrees.")] = False,
) -> None:
    """Show what is in a robot file.

    The tree, joints, limits, chains and masses of the robot, and what is odd about the file.

    Example: kinetostat info example:panda
    """
    import kinetostat
    from kinetostat.lint.linting import oddities
    from kinetostat.report.json import info_result
    from kinetostat.report.view import info_view

    model = load(robot, output)
    result, odd = kinetostat.summary(model), oddities(model)
    write_answer(
        Answer(
            "info",
            lambda: info_view(result, odd, degrees=deg),
            lambda: info_result(result, odd),
            model,
            certificate=result.certificate,
        ),
        output,
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(info)
