"""`kinetostat velocity`: twists, screws and accelerations from joint rates."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat.conventions import Order
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, write_answer
from kinetostat_cli.options import (
    ConfigurationOptions,
    ExpressedInOption,
    OrderOption,
    OutputOptions,
    RelativeToOption,
    RobotOptions,
    grouped,
)

__all__ = ["register"]


@grouped
def velocity(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    qdot: Annotated[
        str, typer.Option(metavar="RATES", help="Joint rates: j1=0.1,... (others zero) or a list; rad/s and m/s.")
    ],
    qddot: Annotated[
        str | None,
        typer.Option(metavar="RATES", help="Joint accelerations, likewise; then accelerations are given too."),
    ] = None,
    frame: Annotated[
        str | None,
        typer.Option(
            "--frame",
            "-f",
            metavar="FRAME",
            help="Show this frame alone, with its screw. Default: all links.",
            autocompletion=completion.frames,
        ),
    ] = None,
    relative_to: RelativeToOption = None,
    expressed_in: ExpressedInOption = None,
    order: OrderOption = Order.LINEAR_FIRST,
) -> None:
    """Show how links move: twists, instantaneous screws, accelerations.

    A twist is the velocity of a frame's origin (m/s) and its angular velocity (rad/s), as the observer sees them; in
    the frame's own axes and in the observer's (or those of --expressed-in).

    Example: kinetostat velocity textbook:planar_2r -q 0.5,1 --qdot 1,2 -f tool
    """
    import kinetostat
    from kinetostat.report.velocity import velocity_result, velocity_view

    model = load(robot, output)
    tip = None if frame is None else model.robot.frame(frame)
    q = configuration(model, at)
    pushed = None
    if qddot is not None:
        pushed = kinetostat.joint_rates(model, qddot, degrees=at.deg, quantity="acceleration")
    result = kinetostat.velocity(
        model,
        q.q,
        kinetostat.joint_rates(model, qdot, degrees=at.deg),
        frames=tip,
        relative_to=relative_to,
        expressed_in=expressed_in,
        qddot=pushed,
    )
    write_answer(
        Answer(
            "velocity",
            lambda: velocity_view(result, q, tip, order=order, degrees=at.deg),
            lambda: velocity_result(result, order),
            model,
            q,
            result.certificate,
        ),
        output,
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(velocity)
