"""Each expectation by its judge; one that cannot be judged says why, and is not met."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from kinetostat.engines.model import Model
from kinetostat.errors import KinetostatError
from kinetostat.policy.expectations import Expectation
from kinetostat.policy.judging.found import Found
from kinetostat.policy.outcome import Outcome

__all__ = ["judge", "unjudged"]

Judge = Callable[[Model, Any, Path], Found]

# By kind: the module of its judge, and the name of the function in it. Each is loaded when it is first asked.
_JUDGES = {
    "smallest-singular-value": ("dexterity", "smallest_singular_value"),
    "manipulability": ("dexterity", "manipulability"),
    "inverse-condition-number": ("dexterity", "inverse_condition_number"),
    "distance-to-singularity": ("dexterity", "distance_to_singularity"),
    "holds": ("efforts", "holds"),
    "worst-gravity-torque": ("efforts", "worst_gravity_torque"),
    "joint-limits": ("efforts", "joint_limits"),
    "reaches": ("poses", "reaches"),
    "reach": ("reach", "reach"),
    "golden": ("golden", "golden"),
    "symmetry": ("symmetry", "symmetry"),
    "degrees-of-freedom": ("structure", "degrees_of_freedom"),
    "mass": ("structure", "mass"),
    "mimic": ("structure", "mimic"),
}


def judge(model: Model, expectations: Sequence[Expectation], *, folder: Path | str = ".") -> tuple[Outcome, ...]:
    """Return what a robot meets of what is expected of it, in the same order.

    What cannot be judged (no such frame, engines that disagree, a file that is not there) is an outcome, too: `met` is
    None, and `found` says why.

    Args:
        model: the robot.
        expectations: what is expected of it.
        folder: that of the settings file; files that expectations name are relative to it.
    """
    return tuple(_judged(model, expectation, Path(folder)) for expectation in expectations)


def unjudged(expectations: Sequence[Expectation], reason: str) -> tuple[Outcome, ...]:
    """Return the outcomes of expectations none of which can be judged, for one reason."""
    return tuple(_outcome(expectation, Found(None, reason)) for expectation in expectations)


def _judged(model: Model, expectation: Expectation, folder: Path) -> Outcome:
    try:
        return _outcome(expectation, _judge(expectation.kind)(model, expectation, folder))
    except KinetostatError as error:
        return _outcome(expectation, Found(None, _reason(error)))


def _judge(kind: str) -> Judge:
    module, name = _JUDGES[kind]
    found: Judge = getattr(import_module(f"kinetostat.policy.judging.{module}"), name)
    return found


def _outcome(expectation: Expectation, found: Found) -> Outcome:
    return Outcome(
        expectation.kind,
        expectation.title,
        found.met,
        expectation.wanted,
        found.text,
        dict(found.witness),
        expectation.place,
        found.remedy,
    )


def _reason(error: KinetostatError) -> str:
    """Return why something cannot be judged: an error's text, which speaks of options, in the words of the file."""
    return re.sub(r"(?<![\w-])--(?=[a-z])", "", str(error))
