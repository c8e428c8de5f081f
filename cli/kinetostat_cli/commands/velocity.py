"""`kinetostat velocity`: twists, screws and accelerations from joint rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat.conventions import Order
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, write_answer
from kinetostat_cli.lists import Answers, ListOption, answer_list
from kinetostat_cli.options import (
    ConfigurationOptions,
    ExpressedInOption,
    OrderOption,
    OutputOptions,
    RelativeToOption,
    RobotOptions,
    grouped,
)

if TYPE_CHECKING:
    from kinetostat import FrameMotions
    from kinetostat.conventions import Array

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
    qs: ListOption = None,
) -> None:
    """Show how links move: twists, instantaneous screws, accelerations.

    A twist is the velocity of a frame's origin (m/s) and its angular velocity (rad/s), as the observer sees them; in
    the frame's own axes and in the observer's (or those of --expressed-in).

    Example: kinetostat velocity textbook:planar_2r -q 0.5,1 --qdot 1,2 -f tool
    """
    import kinetostat
    from kinetostat.report.velocity import velocity_columns, velocity_result, velocity_view

    model = load(robot, output)
    rates, pushed = kinetostat.joint_rates(model, qdot, degrees=at.deg), None
    if qddot is not None:
        pushed = kinetostat.joint_rates(model, qddot, degrees=at.deg, quantity="acceleration")

    def answer(q: Array, tip: str | None) -> FrameMotions:
        observer = {"relative_to": relative_to, "expressed_in": expressed_in}
        return kinetostat.velocity(model, q, rates, frames=tip, qddot=pushed, **observer)

    if qs is not None:
        only = model.robot.frame(frame or model.robot.default_tip())
        answer_list("velocity", model, qs, at, output, lambda q: Answers(*velocity_columns(answer(q, only), order)))
        return
    tip = None if frame is None else model.robot.frame(frame)
    q = configuration(model, at)
    result = answer(q.q, tip)
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
