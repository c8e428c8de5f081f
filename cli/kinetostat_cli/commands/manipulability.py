"""`kinetostat manipulability`: indices and ellipsoids of a frame."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, cast

import typer

from kinetostat.conventions import Reference
from kinetostat_cli.console import Answer, configuration, load, triple, write_answer
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

__all__ = ["register"]


@grouped
def manipulability(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    frame: FrameOption = None,
    reference: ReferenceOption = Reference.ALIGNED,
    relative_to: RelativeToOption = None,
    expressed_in: ExpressedInOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    length: Annotated[
        str,
        typer.Option(
            metavar="L|auto|none",
            help="Length in m that makes metres and radians comparable; auto: equal weight of both; none: mix them.",
        ),
    ] = "none",
    weights: Annotated[
        str | None,
        typer.Option(
            metavar="limits|A,B,C",
            help="Weigh the joints: by their velocity and position limits, or by a number for each column.",
        ),
    ] = None,
    direction: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="Also give how velocity and force pass along this line."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the arm with its ellipsoids: .svg, .png or .pdf.")
    ] = None,
) -> None:
    """Show how well a frame can move.

    Manipulability indices and ellipsoids: singular values s, Yoshikawa's product of them, the smallest, smallest /
    largest, and isotropy; for all six rows, for translation, for rotation, and for the rows that --axes names.

    Example: kinetostat manipulability example:panda -f panda_hand -q default --length auto
    """
    import kinetostat
    from kinetostat.report.manipulability import manipulability_result, manipulability_view

    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    q = configuration(model, at)
    result = kinetostat.manipulability(
        model,
        tip,
        q.q,
        reference=reference,
        relative_to=relative_to,
        expressed_in=expressed_in,
        point=triple(point, "--point"),
        axes=axes,
        length=cast("Any", length),
        weights=_weights(weights),
        direction=triple(direction, "--direction"),
    )
    if plot is not None:
        from kinetostat.report.figures import manipulability_figure, save

        save(manipulability_figure(model, result, q), plot)
    write_answer(
        Answer(
            "manipulability",
            lambda: manipulability_view(result, q, degrees=at.deg),
            lambda: manipulability_result(result),
            model,
            q,
            result.certificate,
            result.warnings,
        ),
        output,
    )


def _weights(text: str | None) -> Any:
    """Return the words that the library knows, or the list of numbers that a text writes."""
    return text if text is None or text == "limits" else text.replace(",", " ").split()


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(manipulability)
