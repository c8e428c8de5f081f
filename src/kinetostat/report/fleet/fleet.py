"""`report`: paths and settings to what is told of a fleet of robots, with pictures."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kinetostat.errors import UsageError
from kinetostat.gate.baseline import read_baseline
from kinetostat.gate.check import baseline_file, tasks_of
from kinetostat.gate.checking import Task
from kinetostat.lint.finding import Severity
from kinetostat.report.check.words import counted
from kinetostat.report.fleet.document import FleetDocument, RobotDocument
from kinetostat.report.fleet.drawing import Drawing
from kinetostat.report.fleet.stamp import stamp
from kinetostat.report.fleet.working import FleetTask, RobotPage, crashed_robot, report_robot
from kinetostat.urdf.files import MAX_BYTES

if TYPE_CHECKING:
    from kinetostat.policy.settings import Settings

__all__ = ["PRELOADED", "TIMEOUT", "Fleet", "fleet"]

PRELOADED = "kinetostat.report.fleet.preloaded"
TIMEOUT = 600.0  # s, for one robot
MOST_SAMPLES = 1_000_000  # of one chain: their positions are kept

Told = Callable[[RobotDocument, int], None]


@dataclass(frozen=True, repr=False)
class Fleet:
    """What is told of a fleet of robots.

    Attributes:
        document: all numbers.
        drawings: the pictures by their key: `r1/tree`, `r1-1/reach`, `fleet/scatter`, ... .
    """

    document: FleetDocument
    drawings: Mapping[str, Drawing]

    def __repr__(self) -> str:
        robots = self.document.robots
        return f"<Fleet: {counted(len(robots), 'robot')}, {counted(sum(len(r.chains) for r in robots), 'chain')}>"

    def write(self, folder: str | Path) -> tuple[Path, ...]:
        """Write report.json, robots.csv, report.md and index.html to a folder, made if it is not there; return them.

        Raises:
            UsageError: they cannot be written there.
        """
        from kinetostat.report.fleet.files import write_fleet

        return write_fleet(Path(folder), self.document, self.drawings)


def fleet(
    paths: Sequence[str | Path] = (),
    *,
    settings: Settings | None = None,
    folder: str | Path = ".",
    samples: int = 20_000,
    seed: int = 0,
    payload: float | None = None,
    jobs: int | None = None,
    timeout: float | None = None,
    srdf: str | Path | None = None,
    package_dirs: Sequence[str | Path] = (),
    xacro_arguments: Mapping[str, str] | None = None,
    max_bytes: int = MAX_BYTES,
    done: Told | None = None,
    at_work: Callable[[tuple[str, ...]], None] | None = None,
) -> Fleet:
    """Return what is told of a fleet of robots: the same numbers and pictures for the same files and seed.

    Each robot is checked as `check` does, and profiled limb by limb. Where one cannot be read, or its process dies, its
    `status` and `reason` say so, and the others are told all the same.

    Args:
        paths: files, folders, globs, `example:*`; none: all in the settings' folder, and what the settings name. A
            robot that is meant twice is told once.
        settings: what `ks.read_settings` returns: chains, expectations, rules; None: the defaults.
        folder: where the settings are: their paths are relative to it.
        samples: random configurations of each chain.
        seed: of these.
        payload: what a chain is to carry of which the settings say nothing, kg.
        jobs: processes, a robot at a time in each; None: in this process, where a crash is this process's.
        timeout: seconds after which a robot counts as hanging, where there are processes; default 600.
        srdf: the SRDF file; default, the one beside each robot.
        package_dirs: folders to look for packages in first.
        xacro_arguments: the arguments of xacro files.
        max_bytes: refuse larger files.
        done: told what is known of each robot as it comes, and how many there will be.
        at_work: told, now and then, which robots are being worked on.

    Raises:
        UsageError: a rule that does not exist; a number, a baseline or SOURCE_DATE_EPOCH that cannot be.
        SourceError: something named is not there; nothing is named.
    """
    from kinetostat.policy.settings import Settings

    settings, folder = settings or Settings(), Path(folder)
    _validate(paths, samples, seed, payload, jobs, timeout)
    made = stamp()
    chosen = replace(
        Task(""),
        select=tuple(settings.check.select),
        ignore=tuple(settings.check.ignore),
        samples=settings.check.samples,
        seed=settings.check.seed,
        folder=folder,
        srdf=None if srdf is None else Path(srdf),
        package_dirs=tuple(Path(d) for d in package_dirs),
        xacro_arguments=dict(xacro_arguments or {}),
        max_bytes=max_bytes,
    )
    known_file = baseline_file(None, settings, folder)
    common = FleetTask(
        "",
        chosen,
        samples,
        seed,
        payload,
        Severity(settings.check.fail_on),
        read_baseline(known_file) if known_file is not None else {},
        known_file.parent if known_file is not None else folder,
    )
    checks = _once(tasks_of([str(path) for path in paths], settings, chosen))
    tasks = [replace(common, id=f"r{number}", check=check) for number, check in enumerate(checks, 1)]
    pages = _pages(tasks, jobs, timeout or TIMEOUT, done, at_work)
    return _together(pages, made, samples, seed, payload)


def _validate(
    paths: object, samples: int, seed: int, payload: float | None, jobs: int | None, timeout: float | None
) -> None:
    """Refuse arguments that cannot be.

    Raises:
        UsageError: one is.
    """
    if isinstance(paths, (str, Path)):
        raise UsageError("paths is a list of paths", remedy='fleet(["arm.urdf"])')
    if not 1 <= samples <= MOST_SAMPLES:
        raise UsageError(f"between 1 and {MOST_SAMPLES:,} samples, not {samples}")
    if seed < 0:
        raise UsageError(f"a seed is not negative, as {seed} is")
    if payload is not None and not 0 <= payload < math.inf:
        raise UsageError(f"a payload is a mass in kg, not {payload:g}")
    if jobs is not None and jobs < 1:
        raise UsageError(f"at least one process, not {jobs}")
    if timeout is not None and not 0 < timeout < math.inf:
        raise UsageError(f"a timeout is a positive number of seconds, not {timeout:g}")


def _once(checks: Sequence[Task]) -> Iterator[Task]:
    """Yield the robots, each once, by whatever path it is meant."""
    seen = set[str]()
    for check in checks:
        shipped = check.name.startswith(("example:", "textbook:"))
        key = check.name if shipped else os.path.abspath(check.name)  # noqa: PTH100 (an SRDF lies beside a link)
        if key not in seen:
            seen.add(key)
            yield check


def _pages(
    tasks: Sequence[FleetTask],
    jobs: int | None,
    timeout: float,
    done: Told | None,
    at_work: Callable[[tuple[str, ...]], None] | None,
) -> tuple[RobotPage, ...]:
    """Return what is told of each robot, in the order of the tasks."""

    def tell(page: RobotPage) -> None:
        if done is not None:
            done(page.document, len(tasks))

    def show(running: tuple[FleetTask, ...]) -> None:
        if at_work is not None:
            at_work(tuple(task.check.name for task in running))

    if jobs is None:
        return tuple(_here(task, show, tell) for task in tasks)
    from kinetostat.gate.pool import run_all

    return run_all(
        tasks,
        report_robot,
        crashed_robot,
        jobs=jobs,
        timeout=timeout,
        done=tell,
        at_work=None if at_work is None else show,
        preload=PRELOADED,
    )


def _here(
    task: FleetTask, show: Callable[[tuple[FleetTask, ...]], None], tell: Callable[[RobotPage], None]
) -> RobotPage:
    """Return what is told of a robot that is worked on in this process."""
    show((task,))
    page = report_robot(task)
    tell(page)
    return page


def _together(pages: Sequence[RobotPage], made: str, samples: int, seed: int, payload: float | None) -> Fleet:
    """Return the robots as one report."""
    from kinetostat import __version__
    from kinetostat.report.fleet.drawings import fleet_drawings

    document = FleetDocument(
        made=made,
        version=__version__,
        samples=samples,
        seed=seed,
        payload=payload,
        robots=tuple(page.document for page in pages),
    )
    drawings = {key: drawing for page in pages for key, drawing in page.drawings.items()}
    return Fleet(document, drawings | fleet_drawings(document))
