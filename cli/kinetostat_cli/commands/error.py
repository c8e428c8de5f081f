"""`kinetostat error`: tool error from joint errors, and the joint resolution that an accuracy needs."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat.conventions import Reference
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, refuse, triple, write_answer
from kinetostat_cli.lists import Answers, ListOption, answer_list
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    ExpressedInOption,
    FrameOption,
    OutputOptions,
    PointOption,
    ReferenceOption,
    RelativeToOption,
    RobotOptions,
    grouped,
)

if TYPE_CHECKING:
    from kinetostat import JointResolution, SingularApproach, ToolError
    from kinetostat.conventions import Array

__all__ = ["register"]


@grouped
def error(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    joint_error: Annotated[
        str | None,
        typer.Option(
            metavar="D",
            help="Errors of joints in rad (--deg: degrees) and m: one for all that turn, j1=0.001,..., or a list in "
            "path order.",
            autocompletion=completion.joints,
        ),
    ] = None,
    accuracy: Annotated[
        float | None, typer.Option(metavar="A", help="Position accuracy in m: which joint resolution does it need?")
    ] = None,
    accuracy_angle: Annotated[
        float | None, typer.Option(metavar="A", help="Rotation accuracy in rad (--deg: degrees), likewise.")
    ] = None,
    approach: Annotated[
        str | None,
        typer.Option(
            metavar="nearest|Q",
            help="Follow how precision degrades on the way into the nearest singular configuration, or into this one.",
            autocompletion=completion.configurations,
        ),
    ] = None,
    speed: Annotated[
        float | None,
        typer.Option(metavar="V", help="Tool speed of --approach in m/s (rad/s where --axes only turn). Default: 0.1."),
    ] = None,
    axes: AxesOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    relative_to: RelativeToOption = None,
    expressed_in: ExpressedInOption = None,
    point: PointOption = None,
    qs: ListOption = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the way of --approach: .svg, .png or .pdf.")
    ] = None,
) -> None:
    """Show the tool error that joint errors make.

    In the worst case and for one sigma; the joint resolution that an accuracy of the tool needs; and how precision
    degrades on the way into a singular configuration.

    Example: kinetostat error example:ur5_robot -f tool0 --joint-error 0.001
    """
    import kinetostat
    from kinetostat.analysis.crosscheck import combined
    from kinetostat.report.error import error_columns, error_result, error_view

    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    resolved = accuracy is not None or accuracy_angle is not None
    if joint_error is None and not resolved and approach is None:
        raise kinetostat.UsageError(
            "nothing is asked: the error of the tool, the resolution of joints, or the way into a singularity",
            remedy="give --joint-error, --accuracy, --accuracy-angle or --approach",
        )
    refuse(
        approach is None,
        {"--axes": axes, "--speed": speed, "--plot": plot},
        "belongs to --approach",
        "add --approach nearest",
    )
    remedy = "leave it out, or use --reference local"
    refuse(approach is not None, {"--expressed-in": expressed_in}, "does not go with --approach", remedy)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    errors = None
    if joint_error is not None:
        errors = kinetostat.joint_errors(model, tip, joint_error, relative_to=relative_to, degrees=at.deg)
    where: Any = {"reference": reference, "relative_to": relative_to, "point": triple(point, "--point")}
    angle = math.radians(accuracy_angle) if accuracy_angle is not None and at.deg else accuracy_angle

    def answer(q: Array) -> tuple[ToolError, JointResolution | None]:
        found = kinetostat.tool_error(model, tip, q, errors, expressed_in=expressed_in, **where)
        wanted = {"accuracy": accuracy, "accuracy_angle": angle}
        return found, kinetostat.joint_resolution(found, **wanted) if resolved else None

    if qs is not None:
        refuse(approach is not None, {"--qs": qs}, "does not go with --approach", "leave one of the two out")
        answer_list("error", model, qs, at, output, lambda q: Answers(*error_columns(*answer(q))))
        return
    q = configuration(model, at)
    result, resolution = answer(q.q) if joint_error is not None or resolved else (None, None)
    way = None
    if approach is not None:
        end = None if approach == "nearest" else configuration(model, replace(at, config=approach)).q
        fast = 0.1 if speed is None else speed
        way = kinetostat.singular_approach(model, tip, q.q, end, joint_error=errors, axes=axes, speed=fast, **where)
        _draw(plot, way, degrees=at.deg)
    found = [part for part in (result, way) if part is not None]
    write_answer(
        Answer(
            "error",
            lambda: error_view(result, resolution, way, q, given=joint_error is not None, degrees=at.deg),
            lambda: error_result(result, resolution, way),
            model,
            q,
            combined([part.certificate for part in found]),
            tuple(line for part in (result, resolution, way) if part is not None for line in part.warnings),
        ),
        output,
    )


def _draw(plot: Path | None, way: SingularApproach, *, degrees: bool) -> None:
    if plot is not None:
        from kinetostat.report.figures import approach_figure, save

        save(approach_figure(way, degrees=degrees), plot)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(error)
