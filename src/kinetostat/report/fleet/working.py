"""One robot of the report: checked, profiled, described, drawn, in a process of its own; its page travels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from kinetostat.errors import KinetostatError
from kinetostat.gate.baseline import Known, without_known
from kinetostat.gate.checking import Task, check_subject, judged, subject_asked
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.lint.finding import Severity
from kinetostat.lint.subject import Subject
from kinetostat.report.fleet.describing import robot_document
from kinetostat.report.fleet.document import RobotDocument
from kinetostat.report.fleet.drawing import Drawing

__all__ = ["FleetTask", "RobotPage", "crashed_robot", "report_robot"]


@dataclass(frozen=True)
class FleetTask:
    """What is to be found out about one robot, as it travels to the process that does it.

    Attributes:
        id: the robot's place in the page: r1, r2, ... .
        check: which robot, and how it is checked.
        samples: random configurations of each chain.
        seed: of these.
        payload: what a chain is to carry of which the settings say nothing, kg.
        fail_on: the mildest severity that fails the robot.
        known: findings of a baseline, which do not count.
        known_from: the folder that its paths are relative to.
    """

    id: str
    check: Task
    samples: int = 20_000
    seed: int = 0
    payload: float | None = None
    fail_on: Severity = Severity.ERROR
    known: Known = field(default_factory=dict)
    known_from: Path = Path()


@dataclass(frozen=True, repr=False)
class RobotPage:
    """What is told of one robot, and its pictures by their key: `r1/tree`, `r1-1/reach`, ... ."""

    document: RobotDocument
    drawings: Mapping[str, Drawing]

    def __repr__(self) -> str:
        return f"<RobotPage of {self.document.path!r}: {self.document.status}, {len(self.drawings)} drawings>"


def report_robot(task: FleetTask) -> RobotPage:
    """Return what is told of one robot: rules, agreement and policy as of `check`, profile, document, drawings.

    A robot that cannot be read, or that an engine refuses, is told as unreadable, with what the rules found. Anything
    else that goes wrong is a bug, of which whoever asked tells (`crashed_robot`): no robot is shown half.
    """
    subject = subject_asked(task.check)
    check = _judged(check_subject(subject, task.check), task)
    if subject.refusal is not None:
        return _unreadable(task, check, subject.refusal)
    try:
        return _readable(task, check, subject)
    except KinetostatError as error:
        error.file = error.file or task.check.name
        return _unreadable(task, check, error)


def crashed_robot(task: FleetTask, reason: str) -> RobotPage:
    """Return what is told of a robot whose process died, or did not answer."""
    check = FileCheck(task.check.name, Verdict.CRASHED, reason=reason, readable=False)
    return RobotPage(robot_document(task.id, check, None, status="crashed", reason=reason, payload=task.payload), {})


def _readable(task: FleetTask, check: FileCheck, subject: Subject) -> RobotPage:
    """Return what is told of a robot that can be read.

    Raises:
        KinetostatError: an engine refuses it.
    """
    from kinetostat.analysis.profile.chosen import possible
    from kinetostat.analysis.profile.limbs import limbs
    from kinetostat.analysis.profile.profiling import profile
    from kinetostat.report.fleet.drawings import robot_drawings

    chains, refused = possible(subject.model.robot, task.check.chains)
    anatomy = limbs(subject.model, chains)
    anatomy = replace(anatomy, left=(*refused, *anatomy.left))
    found = profile(subject.model, anatomy, samples=task.samples, seed=task.seed, payload=task.payload)
    document = robot_document(task.id, check, found, status="done", reason="", payload=task.payload)
    return RobotPage(document, robot_drawings(document, found))


def _unreadable(task: FleetTask, check: FileCheck, error: KinetostatError) -> RobotPage:
    check = replace(check, verdict=Verdict.FAIL)  # also where no rule found what an engine refuses
    document = robot_document(task.id, check, None, status="unreadable", reason=str(error), payload=task.payload)
    return RobotPage(document, {})


def _judged(check: FileCheck, task: FleetTask) -> FileCheck:
    """Return what was found out, with its verdict: what `check` would say."""
    new = without_known(check, task.known, task.known_from) if task.known else check
    return judged(new, task.fail_on)
