"""`kinetostat sweep`: measures over many configurations: a summary of them all, or a row for each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat_cli import completion, runs
from kinetostat_cli.console import held_configuration, load, refuse, say, triple, warn
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
    RunOptions,
    TaskAxes,
    TaskReferenceOption,
    grouped,
)
from kinetostat_cli.payloads import PayloadOption, payload_of
from kinetostat_cli.sweeping import Question

if TYPE_CHECKING:
    from kinetostat import Configuration, Model
    from kinetostat.analysis.sweeping.sweep import Sweep, SweepWork
    from kinetostat_cli.rows import SoundRows

__all__ = ["register"]

_WEIGHED = {"gravity_torque", "effort_use"}


@grouped
def sweep(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    run: RunOptions,
    frame: FrameOption = None,
    samples: Annotated[
        str | None, typer.Option(metavar="N", help="N random configurations inside limits: 100000, 1e8, 100k, 10M.")
    ] = None,
    low_discrepancy: Annotated[
        str | None, typer.Option(metavar="N", help="N configurations that fill the limits evenly (Halton's sequence).")
    ] = None,
    grid: Annotated[
        list[str] | None,
        typer.Option(
            metavar="J=LO:HI:N,...",
            help="All combinations of N positions a joint, from LO to HI; other joints as -q says. May be repeated.",
            autocompletion=completion.joints,
        ),
    ] = None,
    trajectory: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="The configurations of a file that trajectory reads (.csv, .parquet; -: CSV on stdin; time does not "
            "count), of rows that sweep has written (.npz too), or of a list (.json, .jsonl).",
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(metavar="S", help="Of what is drawn. Default: 0.")] = None,
    measures: Annotated[
        list[str] | None,
        typer.Option(
            metavar="A,B,...",
            help="What to compute, see above. May be repeated. Default: yoshikawa,minimum_singular_value,"
            "inverse_condition_number.",
        ),
    ] = None,
    below: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MEASURE=X,...",
            help="Also count configurations where a measure is below X; effort_use and limit_distance are shares, 0.1 "
            "is 10 %. May be repeated.",
        ),
    ] = None,
    above: Annotated[
        list[str] | None, typer.Option(metavar="MEASURE=X,...", help="The same, above X. May be repeated.")
    ] = None,
    near: Annotated[
        float,
        typer.Option(metavar="X", help="Near-singular: smallest / largest singular value is below X."),
    ] = 0.01,
    axes: AxesOption = None,
    length: Annotated[
        str,
        typer.Option(
            metavar="L|auto|none",
            help="Length in m that makes metres and radians comparable; auto: over its joint range; none: mix them.",
        ),
    ] = "auto",
    relative_to: RelativeToOption = None,
    point: PointOption = None,
    reference: TaskReferenceOption = TaskAxes.ALIGNED,
    payload: PayloadOption = None,
    gravity_vector: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z", help="Gravity in m/s2 in the root's axes. Default: 0,0,-9.81."),
    ] = None,
    effort_limits: Annotated[
        list[str] | None,
        typer.Option(
            metavar="J=E,J=LO:HI",
            help="Effort limits in Nm or N instead of the file's. May be repeated.",
            autocompletion=completion.joints,
        ),
    ] = None,
    summary: Annotated[
        bool, typer.Option("--summary", help="Give the summary, which -o writes to a file then; no rows.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Draw how often each measure has which value; of a grid of two joints, maps: .svg, .png, .pdf.",
        ),
    ] = None,
) -> None:
    """Compute measures over many configurations.

    A summary says how each is distributed, where its extremes are, and how many configurations are near-singular. With
    -o FILE.csv, .npz or .parquet (-: CSV on standard output), a row for each configuration instead. The same numbers,
    to the bit, for any number of threads. Some configurations of each chunk are computed again by Pinocchio.

    Effort use is gravity torque over effort limit, and limit distance is 1 in the middle of the range of the joint
    nearest to a limit, 0 at its end: shares in files and thresholds, percent in tables.

    Measures: yoshikawa, minimum_singular_value, inverse_condition_number, isotropy, singular_values, position,
    yoshikawa_gradient, minimum_gradient, gravity_torque, effort_use, limit_distance; in rows also pose, jacobian.

    Example: kinetostat sweep example:panda -f panda_hand --samples 100k --deg
    """
    axes_of_grid = _joined(grid)
    _check_sources(
        {"--samples": samples, "--low-discrepancy": low_discrepancy, "--grid": axes_of_grid, "--trajectory": trajectory}
    )
    refuse(samples is None and low_discrepancy is None, {"--seed": seed}, "is of what is drawn", "leave it out")
    rows = _rows_wanted(output, summary=summary)
    refuse(rows, {"--checkpoint": run.checkpoint}, "keeps summaries, not rows", "leave out -o or --checkpoint")
    runs.check(run)
    lower, upper = _thresholds(below, "--below"), _thresholds(above, "--above")
    names = _measures(_joined(measures), rows=rows)
    weight = {"--payload": payload, "--gravity-vector": gravity_vector, "--effort-limits": effort_limits}
    weighed = {name.partition(".")[0] for name in (*(names or ()), *(lower or {}), *(upper or {}))}
    refuse(not _WEIGHED & weighed, weight, "belongs to weight", "--measures gravity_torque,effort_use")
    if plot is not None:
        from kinetostat.report.figures import check_suffix

        check_suffix(plot)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip())
    q = held_configuration(model, at)
    listed = _listed(model, trajectory, q, at)
    work = _work(
        model,
        tip,
        q.q,
        **_source(samples, low_discrepancy, axes_of_grid, listed, degrees=at.deg),
        seed=seed or 0,
        measures=names,
        below=lower,
        above=upper,
        near=near,
        axes=axes,
        length=length,
        relative_to=relative_to,
        point=triple(point, "--point"),
        reference=reference.value,
        payload=payload_of(payload, tip),
        gravity=triple(gravity_vector, "--gravity-vector") or True,
        limits=_limits(_joined(effort_limits)),
        rows=rows,
    )
    if listed is not None:
        from kinetostat_cli.rows import warn_of_held

        warn_of_held(model, listed, work.coordinates.indices)
    held = _of_held(work, q)
    question = Question(work, model, held, listed, output, degrees=at.deg)
    with runs.running(run) as how:
        if how["executor"] is None:
            question.compiled(how["progress"])
        result = question.written(**how) if rows else question.summed_up(**how, checkpoint=run.checkpoint)
    if result is None:  # nobody reads any more
        return
    if plot is not None:
        _draw(work, result, plot, degrees=at.deg)
    if rows:
        question.say_of_rows(result)
    else:
        question.write_summary(result)


def _of_held(work: SweepWork, q: Configuration) -> Configuration:
    """Return where joints are held, without those that are swept; warn of what is odd about them."""
    from kinetostat.report.sweep import held_joints

    held = held_joints(work, q.warnings)
    warn(held.warnings)
    return held


def _joined(given: list[str] | None) -> str | None:
    """Return what an option says, whether in one text or in several."""
    return None if given is None else ",".join(given)


def _check_sources(sources: Mapping[str, object]) -> None:
    """Refuse none, or more than one, of the options that say which configurations."""
    from kinetostat.errors import UsageError

    given = [name for name, value in sources.items() if value is not None]
    if not given:
        raise UsageError("nothing says which configurations", remedy=f"give one of {', '.join(sources)}")
    if len(given) > 1:
        raise UsageError(f"{given[0]} does not go with {given[1]}", remedy="leave one of the two out")


def _rows_wanted(output: OutputOptions, *, summary: bool) -> bool:
    """Return whether -o asks for rows.

    Raises:
        UsageError: a file of rows is asked for along with a summary, or its ending is none of theirs.
    """
    from kinetostat.errors import UsageError, quote
    from kinetostat.report.row_files import ENDINGS, check_row_file

    if output.output is None:
        return False
    form = {"json": ".json", "csv": ".csv"}.get(output.format.value, "")
    if summary or output.format is Format.JSON:
        remedies = {
            ".json": "-F json",
            ".csv": "--summary -F csv for the summary, without both for rows",
            ".npz": f"leave out {'--summary' if summary else '-F json'} for rows",
        }
        remedies[".parquet"] = remedies[".npz"]
        refuse_ending(output.output, {ending: remedy for ending, remedy in remedies.items() if ending != form})
        return False
    if output.output == Path("-"):
        return True
    refuse_ending(output.output, {".json": "-F json for the summary; rows go to .csv, .npz or .parquet"})
    if output.format is Format.CSV:
        refuse_ending(output.output, dict.fromkeys((".npz", ".parquet"), "leave out -F csv"))
    if output.output.suffix.lower() not in ENDINGS:
        remedy = f"name it {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}; or add --summary"
        message = f"{quote(str(output.output))}: the ending of a file of rows tells its format"
        raise UsageError(message, remedy=remedy)
    check_row_file(output.output)
    return True


def _listed(model: Model, trajectory: Path | None, q: Configuration, at: ConfigurationOptions) -> SoundRows | None:
    if trajectory is None:
        return None
    from kinetostat_cli.rows import sound_rows

    return sound_rows(model, trajectory, q.q, at)


def _source(
    samples: str | None, low_discrepancy: str | None, grid: str | None, listed: SoundRows | None, *, degrees: bool
) -> dict[str, Any]:
    """Return which configurations, as the library takes them."""
    from kinetostat_cli.counts import count

    if samples is not None:
        return {"samples": count(samples, "--samples")}
    if low_discrepancy is not None:
        return {"low_discrepancy": count(low_discrepancy, "--low-discrepancy")}
    if listed is not None:
        return {"configurations": listed.values}
    return {"grid": grid, "degrees": degrees}


def _work(model: Model, frame: str, q: Any, **question: Any) -> SweepWork:
    from kinetostat.analysis.sweeping.sweep import sweep_work

    return sweep_work(model, frame, q, **{name: value for name, value in question.items() if value is not None})


def _measures(text: str | None, *, rows: bool) -> tuple[str, ...] | None:
    """Return the names of measures.

    Raises:
        UsageError: one is for rows, and a summary is asked for.
    """
    if text is None:
        return None
    from kinetostat.analysis.sweeping.measures import MEASURES
    from kinetostat.errors import UsageError

    names = tuple(word.strip() for word in text.split(","))
    single = [name for name in names if name in MEASURES and not MEASURES[name].summary]
    if single and not rows:
        raise UsageError(f"{single[0]} has no summary, only rows", remedy="add -o rows.npz, .csv or .parquet")
    return names


def _thresholds(given: list[str] | None, option: str) -> dict[str, float] | None:
    """Return the thresholds of --below, or of --above, by measure."""
    if given is None:
        return None
    from kinetostat.errors import UsageError, quote

    found = dict[str, float]()
    for part in ",".join(given).split(","):
        name, _, value = part.strip().rpartition("=")
        try:
            threshold = float(value)
        except ValueError:
            name = ""
        if not name or name in found:
            message = f"{option}: {quote(part)} is not of the form measure=number, or a measure is given twice"
            raise UsageError(message, remedy=f"for instance {option} minimum_singular_value=0.05")
        found[name] = threshold
    return found


def _limits(text: str | None) -> dict[str, Any] | None:
    from kinetostat_cli.values import by_joint

    return None if text is None else by_joint(text, "--effort-limits")


def _draw(work: SweepWork, result: Sweep, plot: Path, *, degrees: bool) -> None:
    from kinetostat.report.figures import histogram_figure, save
    from kinetostat.report.figures.heat_maps import MOST_POINTS, axes_of_map, heat_map_figure, is_map

    if axes_of_map(work.source) is not None and work.rows > MOST_POINTS:
        say("note", f"the grid has more than {MOST_POINTS:,} points: the plot is of histograms, not of maps")
    if is_map(work.source) and result.complete:
        save(heat_map_figure(result, work.summed_values(), degrees), plot)
    else:
        save(histogram_figure(result), plot)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(sweep)
