"""`kinetostat frames`: the frames of a robot."""

from __future__ import annotations

import typer

from kinetostat_cli.console import Answer, load, write_answer
from kinetostat_cli.options import OutputOptions, RobotOptions, grouped

__all__ = ["register"]


@grouped
def frames(robot: RobotOptions, output: OutputOptions) -> None:
    """List the frames of a robot.

    A frame is a link; each is shown with its parent and the joint between them.

    Example: kinetostat frames example:ur5_robot -F csv
    """
    from kinetostat.report.json import frames_result
    from kinetostat.report.view import frames_view

    model = load(robot, output)
    write_answer(Answer("frames", lambda: frames_view(model.robot), lambda: frames_result(model.robot), model), output)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(frames)
