"""`kinetostat map`: where a tool gets and how well it moves there, by voxels; where to place the base for poses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat_cli import runs
from kinetostat_cli.console import (
    INTERRUPTED,
    Answer,
    held_configuration,
    load,
    progress_bar,
    refuse,
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
    RelativeToOption,
    RobotOptions,
    RunOptions,
    TaskAxes,
    TaskReferenceOption,
    grouped,
)

if TYPE_CHECKING:
    from kinetostat import Configuration, Model, Pose
    from kinetostat.analysis.capability.capability_map import CapabilityMap
    from kinetostat.analysis.capability.placing import BasePlacement

__all__ = ["register"]

_SAMPLES = "1M"


@grouped
def map_(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    run: RunOptions,
    frame: FrameOption = None,
    samples: Annotated[
        str | None,
        typer.Option(metavar="N", help="N random configurations inside limits: 100000, 1e8, 10M. Default: 1M."),
    ] = None,
    low_discrepancy: Annotated[
        str | None, typer.Option(metavar="N", help="N configurations that fill the limits evenly (Halton's sequence).")
    ] = None,
    voxel: Annotated[
        float | None,
        typer.Option(metavar="SIZE", help="Edge of a voxel in m. Default: near a twentieth of the reach."),
    ] = None,
    axes: AxesOption = None,
    reference: TaskReferenceOption = TaskAxes.ALIGNED,
    length: Annotated[
        str,
        typer.Option(
            metavar="L|auto|none", help="Length in m that makes metres and radians comparable; none: mix them."
        ),
    ] = "auto",
    approach: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z",
            help="Map only configurations whose tool z axis is within 15 degrees of this direction of the observer's "
            "axes: 0,0,-1 for a torch that points down.",
        ),
    ] = None,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    poses: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Find positions of the base, in the plane z = 0 and turned about z, for a list of tool poses in the "
            "world: rows of numbers as of ik --poses, roll, pitch, yaw in rad, or with --deg in degrees.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, metavar="S", help="Of what is drawn.")] = 0,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Draw slices of the map, or the base's positions: .svg, .png or .pdf.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Map where a tool gets, and how well it moves there.

    Voxel by voxel: how many configurations reach it, the best and the mean smallest singular value, and from how many
    of 58 directions the tool's z axis arrives. The same numbers, to the bit, for any number of threads.

    With -o FILE.npz the map for programs, with -o FILE.vti for a 3-D viewer such as ParaView: arrays (a, b, c) along x,
    y, z: reach_count, best_singular_value, mean_singular_value, orientation_coverage, directions. Bit i of directions
    is row i of direction_axes (58, 3), of the .npz as x, y, z (middles of voxels) and about (JSON) are.

    Example: kinetostat map example:ur5_robot -f tool0 --axes xyz
    """
    from kinetostat.analysis.capability.capability_map import capability_map
    from kinetostat.analysis.held import held_joints

    refuse(poses is not None, {"--approach": approach}, "does not go with --poses", "poses say it themselves")
    refuse(low_discrepancy is not None, {"--samples": samples}, "does not go with --low-discrepancy", "choose one")
    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    runs.check(run)
    _check_output(output)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    rest = held_configuration(model, at)
    wanted = None if poses is None else _poses(poses, at, axes)
    with runs.running(run) as how:
        result = capability_map(
            model,
            tip,
            rest.q,
            **_counts(samples, low_discrepancy),
            voxel=voxel,
            seed=seed,
            axes=axes,
            reference=reference.value,
            length=length,  # type: ignore[arg-type]
            approach=triple(approach, "--approach"),
            relative_to=relative_to,
            point=triple(point, "--point"),
            checkpoint=run.checkpoint,
            **how,
        )
    names = model.robot.position_names
    q = held_joints(rest, [names[i] for i in result.coordinates.indices])
    warn(q.warnings)
    runs.say_rate(result)
    output = _map_written(result, model, output)
    if wanted is None:
        _answer_map(result, model, q, at, output, plot)
    else:
        _answer_placement(result, wanted, model, q, at, output, plot, seed)
    if not result.complete:
        raise typer.Exit(INTERRUPTED)


def _counts(samples: str | None, low_discrepancy: str | None) -> dict[str, Any]:
    from kinetostat_cli.counts import count

    if low_discrepancy is not None:
        return {"low_discrepancy": count(low_discrepancy, "--low-discrepancy")}
    return {"samples": count(samples or _SAMPLES, "--samples")}


def _poses(file: Path, at: ConfigurationOptions, axes: str | None) -> Pose:
    """Return the poses of a file, all of them sound: one that is left out would change which place is the best."""
    import numpy as np

    from kinetostat import Pose
    from kinetostat.analysis.task import Task
    from kinetostat.errors import ConfigurationError
    from kinetostat_cli.reading import batches, pose_rows

    oriented = axes is None or bool(Task.named(axes).angular)
    found = [np.zeros((0, 4, 4))]
    for batch in batches(file, pose_rows(at, oriented=oriented)):
        for number, reason in zip(batch.numbers, batch.reasons, strict=True):
            if reason is not None:
                raise ConfigurationError(f"row {number}: {reason}", file=str(file))
        found.append(batch.values)
    poses = np.concatenate(found)
    if not len(poses):
        raise ConfigurationError("no pose in it", file=str(file), remedy="write rows x,y,z,roll,pitch,yaw")
    return Pose(poses, oriented)


def _check_output(output: OutputOptions) -> None:
    """Refuse a file whose ending says another format than what would be written to it.

    Raises:
        UsageError: it does.
    """
    from kinetostat_cli.endings import refuse_ending

    map_files = "a map is written to .npz, or to .vti for viewers"
    wrong = {".vtk": map_files, ".npy": map_files, ".parquet": map_files}
    wrong |= {f".{form}": f"-F {form}" for form in (Format.CSV, Format.JSON) if form is not output.format}
    refuse_ending(output.output, wrong)


def _map_written(result: CapabilityMap, model: Model, output: OutputOptions) -> OutputOptions:
    """Write the map where -o names a file for one; return where the rest goes."""
    from kinetostat.report.json import opening
    from kinetostat.report.map_files import ENDINGS, write_map

    if output.output is None or output.output.suffix.lower() not in ENDINGS:
        return output
    write_map(result, output.output, opening("map", model))
    return replace(output, output=None)


def _answer_map(
    result: CapabilityMap,
    model: Model,
    q: Configuration,
    at: ConfigurationOptions,
    output: OutputOptions,
    plot: Path | None,
) -> None:
    from kinetostat.report import map as report

    if plot is not None:
        from kinetostat.report.figures import capability_figure, save

        save(capability_figure(result), plot)
    rows = output.format is Format.CSV
    answer = Answer(
        "map",
        lambda: report.map_view(result, q, degrees=at.deg, voxels=rows),
        lambda: report.map_result(result, q),
        model,
        q,
        result.certificate,
        result.warnings,
    )
    write_answer(answer, output)


def _answer_placement(
    result: CapabilityMap,
    wanted: Pose,
    model: Model,
    q: Configuration,
    at: ConfigurationOptions,
    output: OutputOptions,
    plot: Path | None,
    seed: int,
) -> None:
    from kinetostat.analysis.capability.placing import base_placement
    from kinetostat.analysis.crosscheck import combined
    from kinetostat.report import map as report

    with progress_bar() as tell:
        found: BasePlacement = base_placement(model, result, wanted, q.q, seed=seed, progress=tell)
    if plot is not None:
        from kinetostat.report.figures import placement_figure, save

        save(placement_figure(found), plot)
    answer = Answer(
        "map",
        lambda: report.placement_view(found, q, degrees=at.deg),
        lambda: report.placement_result(found, q, degrees=at.deg),
        model,
        q,
        combined([result.certificate, found.certificate]),
        result.warnings,
    )
    write_answer(answer, output)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("map")(map_)
