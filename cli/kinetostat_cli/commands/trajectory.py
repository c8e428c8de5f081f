"""`kinetostat trajectory`: what is to be said of a joint trajectory."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from kinetostat_cli import completion
from kinetostat_cli.console import (
    Answer,
    asked_configuration,
    exit_if_apart,
    load,
    opened,
    progress_bar,
    say,
    triple,
    warn,
    write_answer,
)
from kinetostat_cli.endings import refuse_ending
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    Format,
    FrameOption,
    OutputOptions,
    PointOption,
    RelativeToOption,
    RobotOptions,
    TaskAxes,
    TaskReferenceOption,
    grouped,
)
from kinetostat_cli.payloads import PayloadOption, payload_of

if TYPE_CHECKING:
    from kinetostat.analysis.held import Held
    from kinetostat.analysis.trajectory.trajectory import Trajectory
    from kinetostat.report.trajectory_rows import FileRows
    from kinetostat_cli.recording import Recording

__all__ = ["register"]

_SAID = 10  # bad rows that are named one by one
_NO_NPZ = {".npz": "rows go to .csv or .parquet"}


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
    reference: TaskReferenceOption = TaskAxes.ALIGNED,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    length: Annotated[
        str,
        typer.Option(
            metavar="L|auto|none",
            help="Length in m that makes metres and radians comparable; auto: the arm's own, over all its limits; "
            "none: mix them.",
        ),
    ] = "auto",
    near: Annotated[
        float | None,
        typer.Option(metavar="X", help="Near singular: smallest / largest singular value is below X. Default: 0.01."),
    ] = None,
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

    At every sample: tool pose, indices, static effort, distance to a limit (100 % amid a joint's range, 0 % at an end);
    with time, rates and the tool's twist. Stretches near a singular configuration are told with their cause, and those
    beyond limits. -F csv, and -o FILE.csv or .parquet, give a row for each row.

    Example: kinetostat trajectory textbook:planar_2r motion.csv -f tool
    """
    from kinetostat.analysis.held import held_joints
    from kinetostat.analysis.trajectory.trajectory import trajectory as analysed
    from kinetostat_cli.recording import read_recording
    from kinetostat_cli.values import by_joint

    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    rows = _rows_wanted(output)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    down: Any = triple(gravity_vector, "--gravity-vector")
    held, limits = payload_of(payload, tip), by_joint(effort_limits, "--effort-limits")
    rest = asked_configuration(model, at)
    recording = read_recording(file, model, rest.q, degrees=at.deg)
    still = held_joints(rest, recording.names)
    warn(still.warnings)
    _tell(recording)
    with progress_bar() as tell:
        result = analysed(
            model,
            tip,
            recording.q,
            recording.time,
            relative_to=relative_to,
            point=triple(point, "--point"),
            reference=reference.value,
            axes=axes,
            length=cast("Any", length),
            gravity=True if down is None else down,
            payload=held,
            limits=limits,
            **({} if near is None else {"near": near}),
            progress=tell,
        )
    if plot is not None:
        from kinetostat.report.figures import save, timeline_figure

        save(timeline_figure(result, recording.rows, degrees=at.deg), plot)
    if rows:
        _write_rows(result, recording.rows, still, output)
        exit_if_apart(result.certificate, model)
        return
    from kinetostat.report.trajectory import trajectory_result, trajectory_view

    write_answer(
        Answer(
            "trajectory",
            lambda: trajectory_view(result, recording.rows, still, degrees=at.deg),
            lambda: trajectory_result(result, recording.rows, still),
            model,
            still,
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


def _rows_wanted(output: OutputOptions) -> bool:
    """Return whether a row for each row is asked for: by the format, or by the file's ending.

    Raises:
        UsageError: the ending says another format than what would be written; pyarrow is needed and missing.
    """
    ending, form = "" if output.output is None else output.output.suffix.lower(), output.format
    if form is Format.JSON:
        refuse_ending(output.output, dict.fromkeys((".csv", ".parquet"), "leave out -F json") | _NO_NPZ)
        return False
    if form is Format.TABLE and ending not in (".csv", ".parquet"):
        refuse_ending(output.output, {".json": "-F json"} | _NO_NPZ)
        return False
    explicit = {} if form is Format.TABLE else {".parquet": "leave out -F csv"}
    refuse_ending(output.output, {".json": "-F json"} | explicit | _NO_NPZ)
    if ending == ".parquet":
        from kinetostat.report.row_files import check_row_file

        check_row_file(cast("Path", output.output))
    return True


def _write_rows(result: Trajectory, rows: FileRows, held: Held, output: OutputOptions) -> None:
    """Write a row for each row of the file."""
    from kinetostat.report.json import closing, opening
    from kinetostat.report.trajectory import asked_json
    from kinetostat.report.trajectory_rows import sample_lines, write_parquet
    from kinetostat.report.view import certificate_note

    warn(result.warnings)
    if output.output is not None and output.output.suffix.lower() == ".parquet":
        about = opening("trajectory.rows", result.mechanism.model) | {"asked": asked_json(result, held)}
        write_parquet(output.output, result, rows, about | closing(result.certificate, result.warnings))
    else:
        with opened(output) as write:
            for text in sample_lines(result, rows):
                if not write(text):  # nobody reads any more
                    return
    say("note", f"{rows.count} rows; {certificate_note(result.certificate)}")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(trajectory)
