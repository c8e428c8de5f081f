"""`kinetostat singular`: is a configuration singular, and where are the singular ones."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat.conventions import Array
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, progress_bar, triple, write_answer
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    FrameOption,
    HeldOptions,
    OutputOptions,
    PointOption,
    RelativeToOption,
    RobotOptions,
    TaskAxes,
    TaskReferenceOption,
    grouped,
)

if TYPE_CHECKING:
    from kinetostat import SingularFamilies

__all__ = ["register"]


@grouped
def at(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    reference: TaskReferenceOption = TaskAxes.ALIGNED,
) -> None:
    """Say whether a configuration is singular, and why.

    Also what is lost there, what moves inside, of what kind it is, and how far the nearest singularity is. Without
    --axes all six rows count; where three joints or fewer move the point independently, x y z.

    Example: kinetostat singular at example:ur5_robot -f tool0 -q elbow_joint=0,wrist_2_joint=1
    """
    import kinetostat
    from kinetostat.report.singular import singular_at_result, singular_at_view

    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    q = configuration(model, at)
    result = kinetostat.singular_at(
        model,
        tip,
        q.q,
        relative_to=relative_to,
        point=triple(point, "--point"),
        axes=axes,
        reference=reference.value,
    )
    write_answer(
        Answer(
            "singular at",
            lambda: singular_at_view(result, q, degrees=at.deg),
            lambda: singular_at_result(result),
            model,
            q,
            result.certificate,
            result.warnings,
        ),
        output,
    )


@grouped
def find(
    robot: RobotOptions,
    at: HeldOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    reference: TaskReferenceOption = TaskAxes.ALIGNED,
    starts: Annotated[int, typer.Option(metavar="N", help="How many searches are made.")] = 1000,
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Seed of the random numbers.")] = 0,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Draw the singular values over two joints, or a planar arm's workspace: .svg, .png or .pdf.",
        ),
    ] = None,
    joints: Annotated[
        str | None,
        typer.Option(
            metavar="J1,J2",
            help="Draw over these two joints, the others held at --config.",
            autocompletion=completion.joints,
        ),
    ] = None,
) -> None:
    """Find all singular configurations, as families.

    Each has a condition, a kind and a witness. Conditions on one joint alone are found completely, others by search.
    --config matters to --plot alone.

    Example: kinetostat singular find example:ur5_robot -f tool0
    """
    import kinetostat
    from kinetostat.report.singular import singular_find_result, singular_find_view

    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    elif joints is not None:
        raise kinetostat.UsageError("--joints chooses what --plot draws", remedy="add --plot FILE")
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    with progress_bar() as progress:
        result = kinetostat.singular_find(
            model,
            tip,
            relative_to=relative_to,
            point=triple(point, "--point"),
            axes=axes,
            reference=reference.value,
            starts=starts,
            seed=seed,
            progress=progress,
        )
    if plot is not None:
        _draw(result, configuration(model, at).q, joints, plot, degrees=at.deg)
    write_answer(
        Answer(
            "singular find",
            lambda: singular_find_view(result, degrees=at.deg),
            lambda: singular_find_result(result),
            model,
            None,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def _draw(result: SingularFamilies, q: Array, joints: str | None, plot: Path, *, degrees: bool) -> None:
    """Draw a planar arm's workspace, or a slice over two joints."""
    from kinetostat.analysis.singular.slices import is_planar, slice_over, workspace
    from kinetostat.report.figures import save, slice_figure, workspace_figure

    arm = result.mechanism
    plane = workspace(result, degrees=degrees) if joints is None and is_planar(arm) else None
    if plane is not None and any(curve.kind == "singular" for curve in (*plane.curves, *plane.unlimited)):
        save(workspace_figure(plane), plot)
        return
    chosen = None if joints is None else [name.strip() for name in joints.split(",")]
    save(slice_figure(slice_over(result, chosen, q[list(arm.indices)], degrees=degrees), degrees=degrees), plot)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    both = typer.Typer(
        no_args_is_help=True,
        rich_markup_mode=None,
        help="Say where, and why, a robot is singular.\n\nExample: kinetostat singular at example:ur5_robot -f tool0",
    )
    both.command("at")(at)
    both.command("find")(find)
    app.add_typer(both, name="singular")
