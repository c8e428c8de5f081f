"""`kinetostat jacobian`: the Jacobian of a frame."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat.conventions import Order, Reference
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, triple, write_answer
from kinetostat_cli.options import (
    ConfigurationOptions,
    ExpressedInOption,
    FrameOption,
    OrderOption,
    OutputOptions,
    PointOption,
    ReferenceOption,
    RelativeToOption,
    RobotOptions,
    grouped,
)

__all__ = ["register"]


@grouped
def jacobian(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    relative_to: RelativeToOption = None,
    expressed_in: ExpressedInOption = None,
    point: PointOption = None,
    joints: Annotated[
        str,
        typer.Option(
            metavar="path|all|J1,J2",
            help="Columns: joints between the two frames, all, or these.",
            autocompletion=completion.joints,
        ),
    ] = "path",
    order: OrderOption = Order.LINEAR_FIRST,
    rates: Annotated[
        str | None,
        typer.Option(
            metavar="SEQUENCE",
            help="Analytic Jacobian: rates of rpy, of zyz, zyx, ... (intrinsic, 12 of them) or fixed-xyz, ...",
            autocompletion=completion.sequences,
        ),
    ] = None,
    qdot: Annotated[
        str | None,
        typer.Option(
            metavar="RATES", help="Also give the time derivative along these joint rates: j1=0.1,... or a list."
        ),
    ] = None,
) -> None:
    """Show the Jacobian of a frame.

    Its columns are the velocities of the frame (m/s, rad/s) for unit rates of the joints (rad/s, m/s).

    Example: kinetostat jacobian example:panda -f panda_hand -q mid
    """
    import kinetostat
    from kinetostat.report.json import jacobian_result
    from kinetostat.report.view import jacobian_view

    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    q = configuration(model, at)
    chosen: str | list[str] = joints
    if joints not in ("path", "all"):  # a joint's own name may hold a comma
        chosen = [joints] if joints in model.robot.joint_by_name else [name.strip() for name in joints.split(",")]
    result = kinetostat.jacobian(
        model,
        tip,
        q.q,
        reference=reference,
        relative_to=relative_to,
        expressed_in=expressed_in,
        point=triple(point, "--point"),
        joints=chosen,
        rates=rates,
        qdot=None if qdot is None else kinetostat.joint_rates(model, qdot, degrees=at.deg),
    )
    write_answer(
        Answer(
            "jacobian",
            lambda: jacobian_view(result, q, order=order, degrees=at.deg),
            lambda: jacobian_result(result, order),
            model,
            q,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(jacobian)
