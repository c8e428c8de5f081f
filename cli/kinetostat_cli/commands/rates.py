"""`kinetostat rates`: joint rates from a twist."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat.conventions import Array, Order, Reference
from kinetostat_cli.console import Answer, configuration, load, triple, write_answer
from kinetostat_cli.lists import Answers, ListOption, answer_list
from kinetostat_cli.options import (
    AxesOption,
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

if TYPE_CHECKING:
    from kinetostat.urdf.description import Robot

__all__ = ["register"]


@grouped
def rates(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    twist: Annotated[
        str | None,
        typer.Option(
            metavar="VX,VY,VZ,WX,WY,WZ",
            help="The velocity, m/s and rad/s (--deg does not count); three numbers with --axes xyz; see --order.",
        ),
    ] = None,
    frame: FrameOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    relative_to: RelativeToOption = None,
    expressed_in: ExpressedInOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    weights: Annotated[
        str | None,
        typer.Option(
            metavar="limits|A,B,C",
            help="Cost of each joint's motion: a larger one moves less; limits: 1 / velocity limit squared.",
        ),
    ] = None,
    damping: Annotated[
        float,
        typer.Option(
            min=0.0,
            metavar="L",
            help="Damp singular values: s / (s^2 + L^2) stands for 1 / s. Compare L with those that the page shows; it "
            "is in their unit.",
        ),
    ] = 0.0,
    secondary: Annotated[
        str | None,
        typer.Option(
            metavar="mid-limits|manipulability|A,B,C",
            help="What to do in the null space, where rates move the frame by nothing; rates of the joints are in "
            "rad/s (deg/s with --deg) and m/s.",
        ),
    ] = None,
    order: OrderOption = Order.LINEAR_FIRST,
    qs: ListOption = None,
) -> None:
    """Find joint rates that give a frame a velocity.

    Exact where the joints can, least squares where they cannot; with the least motion where there are many. Near a
    singular configuration it is told how the rates grow.

    Example: kinetostat rates textbook:planar_2r -q 0.5,1 --twist 1,0 --axes xy
    """
    import kinetostat
    from kinetostat.report import rates as report

    if twist is None:
        raise kinetostat.UsageError("no velocity is asked for", remedy="for instance --twist 0.1,0,0,0,0,0")
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    wanted = _twist(twist, axes, order)
    options: Any = {
        "reference": reference,
        "relative_to": relative_to,
        "expressed_in": expressed_in,
        "point": triple(point, "--point"),
        "axes": axes,
        "weights": _words_or_numbers(weights, ("limits",)),
        "damping": damping,
        "secondary": _secondary(model.robot, secondary, relative_to, tip, degrees=at.deg),
    }
    if qs is not None:
        answer_list(
            "rates",
            model,
            qs,
            at,
            output,
            lambda q: Answers(*report.rates_columns(kinetostat.resolved_rates(model, tip, q, wanted, **options))),
        )
        return
    q = configuration(model, at)
    result = kinetostat.resolved_rates(model, tip, q.q, wanted, **options)
    write_answer(
        Answer(
            "rates",
            lambda: report.rates_view(result, q, order=order, degrees=at.deg),
            lambda: report.rates_result(result, order),
            model,
            q,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def _twist(text: str, axes: str | None, order: Order) -> Array:
    """Return the six numbers of a twist, linear first, from six, or from one for each row that counts."""
    import numpy as np

    from kinetostat.analysis.task import FULL, Task
    from kinetostat.errors import UsageError
    from kinetostat_cli.values import numbers

    rows = FULL.rows if axes is None else Task.named(axes).rows
    count = len(text.replace(",", " ").split())
    twist = np.zeros(6)
    if count == 6 or len(rows) == 6:
        twist[list(order.rows)] = numbers(text, "--twist", 6)
    else:
        twist[[row for row in order.rows if row in rows]] = numbers(text, "--twist with these --axes", len(rows))
    if np.any(np.delete(twist, rows)):
        message = "--twist has a number that is not 0 in a row that --axes leaves out"
        raise UsageError(message, remedy=f"give {len(rows)} numbers, or 0 for it")
    return twist


def _secondary(robot: Robot, text: str | None, relative_to: str | None, tip: str, *, degrees: bool) -> Any:
    """Return a word that the library knows, or rates in rad/s and m/s."""
    from math import radians

    from kinetostat.analysis.task import turning_columns

    wanted = _words_or_numbers(text, ("mid-limits", "manipulability"))
    if not degrees or not isinstance(wanted, list):
        return wanted
    turning = turning_columns(robot.moving_joints(robot.frame(relative_to or robot.root), tip))
    if len(wanted) != len(turning):
        return wanted  # the library says how many there are
    return [radians(rate) if turns else rate for rate, turns in zip(wanted, turning, strict=True)]


def _words_or_numbers(text: str | None, words: tuple[str, ...]) -> Any:
    """Return a word that the library knows, or the numbers that a text lists; the library refuses other words."""
    if text is None or text in words:
        return text
    try:
        return [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        return text


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(rates)
