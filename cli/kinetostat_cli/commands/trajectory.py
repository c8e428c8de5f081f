"""`kinetostat trajectory`: what is to be said of a joint trajectory."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from kinetostat.conventions import Reference
from kinetostat_cli import completion
from kinetostat_cli.console import (
    Answer,
    configuration,
    exit_if_apart,
    load,
    opened,
    progress_bar,
    say,
    triple,
    warn,
    write_answer,
)
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    Format,
    FrameOption,
    OutputOptions,
    PointOption,
    ReferenceOption,
    RelativeToOption,
    RobotOptions,
    grouped,
)
from kinetostat_cli.payloads import PayloadOption, payload_of

if TYPE_CHECKING:
    from kinetostat.analysis.trajectory.trajectory import Trajectory
    from kinetostat.report.trajectory_rows import FileRows
    from kinetostat_cli.recording import Recording

__all__ = ["register"]

_SAID = 10  # bad rows that are named one by one


@grouped
def trajectory(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="CSV (-: standard input) or .parquet: a header of joints in any order, perhaps time [s]; joints that "
            "it does not name stay at -q.",
        ),
    ],
    frame: FrameOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    length: Annotated[
        str,
        typer.Option(
            metavar="L|auto|none",
            help="Length in m that makes metres and radians comparable; auto: the arm's own; none: mix them.",
        ),
    ] = "auto",
    near: Annotated[
        float,
        typer.Option(metavar="X", help="Near singular: smallest / largest singular value is below X."),
    ] = 0.01,
    gravity_vector: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="Gravity in m/s2 in the root's axes, not 0,0,-9.81; 0,0,0: no efforts."),
    ] = None,
    payload: PayloadOption = None,
    effort_limits: Annotated[
        str | None,
        typer.Option(
            metavar="J=E,J=LO:HI",
            help="Effort limits in Nm or N instead of the file's.",
            autocompletion=completion.joints,
        ),
    ] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the time lines: .svg, .png or .pdf.")] = None,
) -> None:
    """Show what is to be said of a joint trajectory.

    At every sample: tool pose, indices, static effort, limits; with time, rates and the tool's twist. Stretches near
    a singular configuration are told with their cause, and those beyond limits. -F csv gives a row for each row.

    Example: kinetostat trajectory textbook:planar_2r motion.csv -f tool
    """
    from kinetostat.analysis.trajectory.trajectory import trajectory as analysed
    from kinetostat_cli.recording import read_recording
    from kinetostat_cli.values import by_joint

    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    down: Any = triple(gravity_vector, "--gravity-vector")
    held, limits = payload_of(payload, tip), by_joint(effort_limits, "--effort-limits")
    rest = configuration(model, at)
    recording = read_recording(file, model, rest.q, degrees=at.deg)
    _tell(recording)
    with progress_bar() as tell:
        result = analysed(
            model,
            tip,
            recording.q,
            recording.time,
            relative_to=relative_to,
            point=triple(point, "--point"),
            reference=reference,
            axes=axes,
            length=cast("Any", length),
            gravity=True if down is None else down,
            payload=held,
            limits=limits,
            near=near,
            progress=tell,
        )
    if plot is not None:
        from kinetostat.report.figures import save, timeline_figure

        save(timeline_figure(result, recording.rows, degrees=at.deg), plot)
    if output.format is Format.CSV:
        _write_rows(result, recording.rows, output)
        exit_if_apart(result.certificate, model)
        return
    from kinetostat.report.trajectory import trajectory_result, trajectory_view

    write_answer(
        Answer(
            "trajectory",
            lambda: trajectory_view(result, recording.rows, rest, degrees=at.deg),
            lambda: trajectory_result(result, recording.rows),
            model,
            rest,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def _tell(recording: Recording) -> None:
    """Say which rows and columns of the file are left out."""
    from kinetostat.errors import cut

    bad = recording.rows.bad
    warn([str(one) for one in bad[:_SAID]])
    if bad:
        warn([f"{len(bad)} of {recording.rows.count} rows are left out (-F csv and -F json say why)"])
    if recording.ignored:
        some = ", ".join(cut(name) for name in recording.ignored[:6])
        more = f" and {len(recording.ignored) - 6} more" if len(recording.ignored) > 6 else ""
        say("note", f"columns that are no positions are left out: {some}{more}")


def _write_rows(result: Trajectory, rows: FileRows, output: OutputOptions) -> None:
    """Write a row for each row of the file."""
    from kinetostat.report.trajectory_rows import sample_lines
    from kinetostat.report.view import certificate_note

    warn(result.warnings)
    with opened(output) as write:
        for text in sample_lines(result, rows):
            if not write(text):  # nobody reads any more
                return
    say("note", f"{rows.count} rows; {certificate_note(result.certificate)}")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(trajectory)
