"""`kinetostat ik`: joints from a pose."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat.analysis.inverse.method import Method
from kinetostat.conventions import Reference
from kinetostat_cli.console import Answer, configuration, load, refuse, triple, write_answer
from kinetostat_cli.lists import Answers, ListOption, answer_list
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    FrameOption,
    OutputOptions,
    PointOption,
    ReferenceOption,
    RelativeToOption,
    RobotOptions,
    grouped,
)
from kinetostat_cli.reading import pose_rows

if TYPE_CHECKING:
    from kinetostat.conventions import Array

__all__ = ["register"]

_TRIES = 100


@grouped
def ik(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    pose: Annotated[
        str | None,
        typer.Option(
            metavar="POSE",
            help="X,Y,Z in m; 6 numbers with roll, pitch, yaw; 7 with a quaternion; 12 or 16 of a matrix; 'X,Y,Z "
            "NOTATION A,B,C' (rpy, xyzw, wxyz, rotvec, axis-angle, zyz, ...); or @FILE.json, a result of fk.",
        ),
    ] = None,
    frame: FrameOption = None,
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    method: Annotated[
        Method,
        typer.Option(
            help="damped: inside limits, with restarts. newton: Newton-Raphson. pseudo-inverse: rates, or --step F."
        ),
    ] = Method.DAMPED,
    step: Annotated[
        float | None, typer.Option(metavar="F", help="Share of the way that a pseudo-inverse step goes, in (0, 1].")
    ] = None,
    trace: Annotated[bool, typer.Option("--trace", help="Show the steps of newton and pseudo-inverse.")] = False,
    every: Annotated[bool, typer.Option("--all", help="List all distinct solutions.")] = False,
    tries: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", help="Starts of method damped at most; the first is -q. Default: 100."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Of the random starts.")] = 0,
    qs: ListOption = None,
    poses: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Solve for each pose of a list: rows of numbers as of --pose, answered as --qs.",
        ),
    ] = None,
) -> None:
    """Find joint positions for a pose.

    From the configuration -q on; every solution is checked by forward kinematics on both engines. An unreachable pose
    is told with what the nearest configuration misses.

    Example: kinetostat ik example:ur5_robot -f tool0 --pose 0.4,0.2,0.5,0,0,0
    """
    import kinetostat
    from kinetostat.analysis.task import Task
    from kinetostat.report import ik as report

    refuse(poses is not None, {"--pose": pose, "--qs": qs}, "does not go with --poses", "choose one")
    other = method if method is not Method.DAMPED else None
    one = {"--method": other, "--qs": qs, "--poses": poses, "--trace": trace or None, "--step": step, "--tries": tries}
    refuse(every, one, "does not go with --all", "leave it out")
    iterated = {"--tries": tries} if method is not Method.DAMPED else {"--step": step}
    refuse(method is not Method.PSEUDO_INVERSE, iterated, f"does not go with method {method}", "leave it out")
    refuse(method is Method.DAMPED, {"--trace": trace or None}, "needs another --method", "newton or pseudo-inverse")
    if pose is None and poses is None:
        raise kinetostat.UsageError("no pose is asked for", remedy="for instance --pose 0.4,0.2,0.5, or --poses FILE")
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    aim: Any = {
        "axes": axes,
        "reference": reference,
        "relative_to": relative_to,
        "point": triple(point, "--point"),
        "seed": seed,
    }
    way: Any = {"method": method, "step": step, "tries": tries or _TRIES}

    def answer(goal: Any, q: Array) -> Answers:
        return Answers(*report.ik_columns(kinetostat.ik(model, tip, goal, q, **aim, **way), model.robot))

    if poses is not None:
        start = configuration(model, at)
        turned = axes is None or bool(Task.named(axes).angular)
        kind = pose_rows(at, oriented=turned)
        answer_list("ik", model, poses, at, output, lambda goals: answer(kinetostat.Pose(goals, turned), start.q), kind)
        return
    goal = _pose(pose or "", at)
    if qs is not None:
        answer_list("ik", model, qs, at, output, lambda q: answer(goal, q))
        return
    q = configuration(model, at)
    if every:
        found = kinetostat.ik_all(model, tip, goal, q.q, **aim)
        write_answer(
            Answer(
                "ik",
                lambda: report.solutions_view(found, q, degrees=at.deg),
                lambda: report.solutions_result(found, q),
                model,
                q,
                found.certificate,
            ),
            output,
        )
        return
    result = kinetostat.ik(model, tip, goal, q.q, **aim, **way)
    write_answer(
        Answer(
            "ik",
            lambda: report.ik_view(result, q, trace=trace, degrees=at.deg),
            lambda: report.ik_result(result, q),
            model,
            q,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def _pose(text: str, at: ConfigurationOptions) -> Any:
    """Return the pose of an option, or of the JSON that fk has written."""
    import kinetostat

    if not text.startswith("@"):
        return kinetostat.pose(text, degrees=at.deg, quaternion_first=at.quat.value[0])
    import json

    from kinetostat_cli.values import read_text

    try:
        return kinetostat.pose(json.loads(read_text(text[1:]))["result"]["matrix"])
    except (ValueError, KeyError, TypeError, RecursionError):
        remedy = "write it by: kinetostat fk ... -F json -o FILE"
        raise kinetostat.UsageError(f"no result of fk in {text[1:]}", remedy=remedy) from None


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(ik)
