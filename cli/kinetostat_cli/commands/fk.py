"""`kinetostat fk`: where a frame is."""

from __future__ import annotations

import typer

from kinetostat_cli.console import Answer, configuration, load, write_answer
from kinetostat_cli.options import (
    ConfigurationOptions,
    FrameOption,
    OutputOptions,
    RelativeToOption,
    RobotOptions,
    grouped,
)

__all__ = ["register"]


@grouped
def fk(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    relative_to: RelativeToOption = None,
) -> None:
    """Show where a frame is.

    Position, rotation and matrix of the frame, relative to the root link or to another frame.

    Example: kinetostat fk example:panda -f panda_hand -q mid
    """
    import kinetostat
    from kinetostat.report.json import fk_result
    from kinetostat.report.view import fk_view

    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    q = configuration(model, at)
    result = kinetostat.fk(model, tip, q.q, relative_to=relative_to)
    write_answer(
        Answer(
            "fk", lambda: fk_view(result, q, degrees=at.deg), lambda: fk_result(result), model, q, result.certificate
        ),
        output,
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(fk)
