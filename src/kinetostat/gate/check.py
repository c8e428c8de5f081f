"""`check`: paths and a policy to one report."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

from kinetostat.analysis.profile.anatomy import ChosenChain
from kinetostat.errors import SourceError, UsageError, quote
from kinetostat.gate.baseline import read_baseline, without_known
from kinetostat.gate.changed import touched
from kinetostat.gate.checking import Task, check_robot, judged
from kinetostat.gate.result import CheckReport, FileCheck
from kinetostat.gate.targets import from_folder, robot_files
from kinetostat.lint.finding import Severity
from kinetostat.urdf.files import MAX_BYTES, read_file

if TYPE_CHECKING:
    from kinetostat.policy.settings import RobotSettings, Settings

__all__ = ["baseline_file", "check", "tasks_of", "without_baseline"]

MOST_SAMPLES = 10_000


def check(
    paths: Sequence[str | Path] = (),
    *,
    settings: Settings | None = None,
    folder: str | Path = ".",
    select: Sequence[str] | None = None,
    ignore: Sequence[str] = (),
    fail_on: Severity | str | None = None,
    samples: int | None = None,
    seed: int | None = None,
    baseline: str | Path | None = None,
    changed_since: str | None = None,
    jobs: int | None = None,
    timeout: float | None = None,
    srdf: str | Path | None = None,
    package_dirs: Sequence[str | Path] = (),
    xacro_arguments: Mapping[str, str] | None = None,
    max_bytes: int = MAX_BYTES,
    done: Callable[[FileCheck, int], None] | None = None,
) -> CheckReport:
    """Check robot files: rules, agreement of three readers, and a policy.

    Args:
        paths: files, folders, globs, `example:*`; none: all in the settings' folder, and what the settings name.
        settings: what `policy.settings.read_settings` returns; None: no policy, the defaults.
        folder: where the settings are: their paths are relative to it.
        select: rules to ask, by code, name or beginning of a code; default the settings', else all.
        ignore: rules to leave out, besides those that the settings leave out.
        fail_on: the mildest severity that fails a file; default the settings', else error.
        samples: configurations at which the readers are compared, 0 for none; default the settings', else 20.
        seed: of the random ones.
        baseline: a file of known findings, which do not count.
        changed_since: a revision of git: only robots that differ from it are checked.
        jobs: processes, a robot at a time in each; None: in this process, where a crash is this process's.
        timeout: seconds after which a robot counts as hanging, where there are processes.
        srdf: the SRDF file; default, the one beside each robot.
        package_dirs: folders to look for packages in first.
        xacro_arguments: the arguments of xacro files.
        max_bytes: refuse larger files.
        done: told each result, and how many there will be.

    Raises:
        UsageError: a rule that does not exist; a number, a baseline or a revision that cannot be.
        SourceError: something named is not there; nothing is named.
    """
    from kinetostat.policy.settings import Settings

    settings, folder = settings or Settings(), Path(folder)
    _validate(paths, fail_on, samples, seed, jobs, timeout)
    # What the command line says goes before what the settings say.
    chosen = replace(
        Task(""),
        select=tuple(settings.check.select if select is None else select),
        ignore=(*settings.check.ignore, *ignore),
        samples=settings.check.samples if samples is None else samples,
        seed=settings.check.seed if seed is None else seed,
        folder=folder,
        srdf=None if srdf is None else Path(srdf),
        package_dirs=tuple(Path(d) for d in package_dirs),
        xacro_arguments=dict(xacro_arguments or {}),
        max_bytes=max_bytes,
    )
    known_file = baseline_file(baseline, settings, folder)
    tasks = tasks_of([str(path) for path in paths], settings, chosen)
    if changed_since is not None:
        tasks = _changed(tasks, changed_since, folder, known_file)
    known = read_baseline(known_file) if known_file is not None else {}
    mildest = Severity(settings.check.fail_on if fail_on is None else fail_on)

    def finished(file: FileCheck) -> FileCheck:
        new = without_known(file, known, known_file.parent) if known_file is not None else file
        return judged(new, mildest)

    if jobs is None:
        results = [check_robot(task) for task in tasks]
    elif tasks:
        from kinetostat.gate.pool import check_all

        tell = None if done is None else lambda file: done(file, len(tasks))
        limit = timeout or settings.check.timeout
        results = list(check_all(tasks, jobs=jobs, timeout=limit, done=tell))
    else:
        results = []
    return CheckReport(tuple(map(finished, results)), mildest)


def _changed(tasks: Sequence[Task], revision: str, folder: Path, known_file: Path | None) -> tuple[Task, ...]:
    """Return the tasks that a change touches; a change of the settings, or of what they name, touches all."""
    named = {getattr(one, "file", "") for task in tasks for one in task.expectations} - {""}
    everything = [*folder.glob("*.toml"), *(folder / name for name in named), *filter(None, [known_file])]
    srdfs = {task.name: task.srdf for task in tasks if task.srdf is not None}
    kept = set(touched([task.name for task in tasks], revision, everything, srdfs))
    return tuple(task for task in tasks if task.name in kept)


def _validate(
    paths: object,
    fail_on: str | None,
    samples: int | None,
    seed: int | None,
    jobs: int | None,
    timeout: float | None,
) -> None:
    """Refuse arguments that cannot be.

    Raises:
        UsageError: one is.
    """
    if isinstance(paths, (str, Path)):
        raise UsageError("paths is a list of paths", remedy='check(["arm.urdf"])')
    if fail_on is not None and fail_on not in list(Severity):
        raise UsageError(f"fail_on is one of {', '.join(Severity)}, not {quote(str(fail_on))}")
    if samples is not None and not 0 <= samples <= MOST_SAMPLES:
        raise UsageError(f"between 0 and {MOST_SAMPLES:,} samples, not {samples}")
    if seed is not None and seed < 0:
        raise UsageError(f"a seed is not negative, as {seed} is")
    if jobs is not None and jobs < 1:
        raise UsageError(f"at least one process, not {jobs}")
    if timeout is not None and not 0 < timeout < float("inf"):
        raise UsageError(f"a timeout is a positive number of seconds, not {timeout:g}")


def tasks_of(paths: Sequence[str], settings: Settings, chosen: Task) -> tuple[Task, ...]:
    """Return what is to be checked of each robot: what the settings say of all, of its path, and of it.

    Raises:
        SourceError: something named is not there; nothing is named.
        UsageError: there is no such rule.
    """
    from kinetostat.lint.registry import chosen as rules

    rules(chosen.select, chosen.ignore)  # a wrong name is said once, before anything is checked
    if chosen.srdf is not None:
        read_file(chosen.srdf, str(chosen.srdf))
    missing = next((folder for folder in chosen.package_dirs if not folder.is_dir()), None)
    if missing is not None:
        raise SourceError("there is no such folder", file=str(missing), remedy="check where packages are")
    for ignored in settings.check.per_path_ignores.values():
        rules((), ignored)
    listed = _listed(settings, chosen.folder)
    names = (
        robot_files(paths, settings.check.exclude, chosen.folder)
        if paths
        else _everything(listed, settings, chosen.folder)
    )
    entries: dict[str, list[RobotSettings]] = {}
    for name, found in listed.items():
        entries.setdefault(_key(name), []).extend(found)
    return tuple(_task(name, settings, entries.get(_key(name), []), chosen) for name in names)


def _everything(listed: Mapping[str, object], settings: Settings, folder: Path) -> tuple[str, ...]:
    """Return all robots in the settings' folder, and those that the settings name: a new one is not overlooked."""
    try:
        found = robot_files([str(folder)], settings.check.exclude, folder)
    except SourceError:
        if not listed:
            raise
        found = ()
    keys = {_key(name) for name in found}
    return (*found, *(name for name in listed if _key(name) not in keys))


def without_baseline(settings: Settings | None) -> Settings | None:
    """Return settings that know no findings: what a new baseline is made with."""
    if settings is None:
        return None
    import msgspec

    return msgspec.structs.replace(settings, check=msgspec.structs.replace(settings.check, baseline=""))


def _listed(settings: Settings, folder: Path) -> dict[str, list[RobotSettings]]:
    """Return what the settings say of each robot that they name, in their order."""
    listed: dict[str, list[RobotSettings]] = {}
    for entry in settings.robots:
        try:
            names = robot_files([_beside(entry.path, folder)])
        except SourceError as error:
            error.message += ", though the settings name it"
            raise
        for name in names:
            listed.setdefault(name, []).append(entry)
    return listed


def _beside(path: str, folder: Path) -> str:
    """Return a path of the settings as it is from here; what ships with us stays."""
    return path if path.startswith(("example:", "textbook:")) else os.path.normpath(folder / path)


def _key(name: str) -> str:
    """Return what two names of the same robot have in common."""
    return name if name.startswith(("example:", "textbook:")) else os.path.realpath(name)


def _task(name: str, settings: Settings, entries: Sequence[RobotSettings], chosen: Task) -> Task:
    folder = chosen.folder
    ignored = [
        code
        for pattern, codes in settings.check.per_path_ignores.items()
        if fnmatchcase(from_folder(name, folder), pattern)
        for code in codes
    ]
    srdf = next((folder / entry.srdf for entry in entries if entry.srdf), None)
    return replace(
        chosen,
        name=name,
        ignore=(*chosen.ignore, *ignored),
        expectations=tuple(expectation for entry in entries for expectation in entry.expect),
        srdf=chosen.srdf or srdf,
        package_dirs=(*chosen.package_dirs, *(folder / d for entry in entries for d in entry.package_dirs)),
        xacro_arguments={k: v for entry in entries for k, v in entry.xacro_args.items()} | dict(chosen.xacro_arguments),
        chains=tuple(
            ChosenChain(chain.frame, chain.base, chain.name, chain.payload, chain.place)
            for entry in entries
            for chain in entry.chains
        ),
    )


def baseline_file(given: str | Path | None, settings: Settings, folder: Path) -> Path | None:
    """Return the file of known findings: the one that is given, else the settings'; None without one."""
    if given is not None:
        return Path(given)
    return folder / settings.check.baseline if settings.check.baseline else None
