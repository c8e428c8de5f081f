"""`kinetostat report`: a page, with pictures, of a fleet of robots."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinetostat.errors import UsageError, quote
from kinetostat_cli.console import DISAGREE, opened, say, xacro_arguments
from kinetostat_cli.fleets import (
    JobsOption,
    NoSettingsOption,
    PathsArgument,
    SettingsOption,
    SrdfOption,
    progress,
    settings_of,
)
from kinetostat_cli.options import (
    MAX_BYTES,
    DebugOption,
    MaxBytesOption,
    OutputOptions,
    PackageDirOption,
    XacroArgOption,
)
from kinetostat_cli.runs import cores

if TYPE_CHECKING:
    from kinetostat.report.fleet.document import FleetDocument

__all__ = ["register"]

INCOMPLETE = 3


def report(
    paths: PathsArgument = None,
    output: Annotated[
        str | None,
        typer.Option(
            "--output", "-o", metavar="DIR", help="The folder to write to, made if it is not there. Required."
        ),
    ] = None,
    samples: Annotated[str, typer.Option(metavar="N", help="Random configurations of each chain: 5000, 100k.")] = "20k",
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="Of what is drawn.")] = 0,
    payload: Annotated[
        float | None,
        typer.Option(min=0, metavar="KG", help="What chains are to carry of which the settings say nothing."),
    ] = None,
    settings: SettingsOption = None,
    no_settings: NoSettingsOption = False,
    jobs: JobsOption = None,
    timeout: Annotated[
        float | None, typer.Option(min=0.1, metavar="S", help="Seconds for one robot. Default: 600.")
    ] = None,
    srdf: SrdfOption = None,
    package_dir: PackageDirOption = None,
    xacro_arg: XacroArgOption = None,
    max_bytes: MaxBytesOption = MAX_BYTES,
    debug: DebugOption = False,  # noqa: ARG001 (main reads it)
) -> None:
    """Write a page, with pictures, of robots: how far each limb gets, how well it moves, what it holds.

    Into the folder go index.html (one file, to be opened, mailed or published), report.json (all numbers), robots.csv
    (a row a chain) and report.md. The same robots and seed give the same bytes, but for the time in their heads, which
    SOURCE_DATE_EPOCH sets. Limbs are found; kinetostat.toml may name others. The page's path is printed.

    Exit code 0 if every robot is in it; 2 if the settings name a chain that a robot does not have: its others are in
    it; 3 if a robot cannot be read, or its process died: its row says why (a path that is not there ends all before
    it begins); 4 if the engines disagree on one. What rules find, and expectations that are not met, do not count: that
    is for check.

    Example: kinetostat report textbook:planar_2r -o report
    """
    from kinetostat.gate.pool import warm_up
    from kinetostat.report.fleet.fleet import PRELOADED, fleet

    warm_up(PRELOADED)  # the libraries load in the background meanwhile
    from kinetostat.report.fleet.files import prepared
    from kinetostat_cli.counts import count

    if output is None or output in ("", "-"):
        raise UsageError("a report is written into a folder, and none is named", remedy="for instance -o report")
    into = Path(output)
    chosen, folder = settings_of(settings, paths or [], wanted=not no_settings)
    many = count(samples, "--samples")
    prepared(into)
    began = time.monotonic()
    with progress() as shown:
        found = fleet(
            paths or [],
            settings=chosen,
            folder=folder,
            samples=many,
            seed=seed,
            payload=payload,
            jobs=jobs or cores(),
            timeout=timeout,
            srdf=srdf,
            package_dirs=package_dir or [],
            xacro_arguments=xacro_arguments(xacro_arg),
            max_bytes=max_bytes,
            done=lambda robot, count: shown.done(robot.path, count),
            at_work=shown.at_work,
        )
    *_, page = found.write(into)
    code = _say_of_it(found.document, into, time.monotonic() - began)
    try:
        with opened(OutputOptions()) as write:
            write(f"{page}\n")
    except UsageError as error:
        raise UsageError(f"{quote(str(page))} is written, but not its path: {error.message}") from None
    if code:
        raise typer.Exit(code)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(report)


def _say_of_it(document: FleetDocument, folder: Path, seconds: float) -> int:
    """Say what was written and what is wrong with it; return the exit code."""
    from kinetostat.analysis.sweeping.pace import lasting
    from kinetostat.report.fleet.wording import engines_agree, totals_text

    missing = [robot for robot in document.robots if robot.status != "done"]
    apart = [robot for robot in document.robots if engines_agree(robot) is False]
    slips = [(robot, left) for robot in document.robots for left in robot.left if left.place]
    for robot in missing:
        say("error", robot.reason if robot.path in robot.reason else f"{robot.path}: {robot.reason}")
    for robot in apart:
        say("error", f"{robot.path}: the engines disagree: trust neither number")
    for robot, left in slips:
        say("error", f"{robot.path}: {left.what}: {left.why}")
    say("note", f"{folder}: {totals_text(document)}, in {lasting(seconds)}")
    if apart:
        return DISAGREE
    return INCOMPLETE if missing else UsageError.exit_code if slips else 0
