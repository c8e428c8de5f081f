"""`kinetostat adjoint`: carry twists and wrenches between frames."""

from __future__ import annotations

from typing import Annotated

import typer

from kinetostat.conventions import Order, WrenchOrTwist
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, write_answer
from kinetostat_cli.options import ConfigurationOptions, OrderOption, OutputOptions, RobotOptions, grouped

__all__ = ["register"]


@grouped
def adjoint(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            "--frame",
            "-f",
            metavar="FRAME",
            help="The frame that it is given in. Default: the only tip.",
            autocompletion=completion.frames,
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(
            "--to",
            metavar="FRAME",
            help="The frame that it is wanted in. Default: the root link.",
            autocompletion=completion.frames,
        ),
    ] = None,
    wrench: Annotated[bool, typer.Option("--wrench", help="Carry wrenches (force, moment), not twists.")] = False,
    inverse: Annotated[bool, typer.Option("--inverse", help="Go the other way round.")] = False,
    apply: Annotated[
        str | None, typer.Option(metavar="SIX", help="Carry this twist or wrench: six numbers in the given order.")
    ] = None,
    order: OrderOption = Order.LINEAR_FIRST,
) -> None:
    """Carry twists and wrenches between frames.

    The 6x6 matrix takes the twist (or wrench) of a body, given in one frame, to another frame at a configuration.

    Example: kinetostat adjoint textbook:puma560 --wrench --apply 0,0,5,0,0,0
    """
    import numpy as np

    import kinetostat
    from kinetostat.report.json import adjoint_result
    from kinetostat.report.view import adjoint_view
    from kinetostat_cli.values import numbers

    model = load(robot, output)
    kind = WrenchOrTwist.WRENCH if wrench else WrenchOrTwist.TWIST
    a, b = (model.robot.frame(name) for name in (start or model.robot.default_tip(), end or model.robot.root))
    q = configuration(model, at)
    result = kinetostat.adjoint(model, a, b, q.q, kind=kind, inverse=inverse)
    given = None if apply is None else np.array(numbers(apply, "--apply", 6))[order.rows]
    applied = None if given is None else result.apply(given)
    write_answer(
        Answer(
            "adjoint",
            lambda: adjoint_view(result, q, given, applied, order=order, degrees=at.deg),
            lambda: adjoint_result(result, given, applied, order),
            model,
            q,
            result.certificate,
        ),
        output,
    )


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(adjoint)
