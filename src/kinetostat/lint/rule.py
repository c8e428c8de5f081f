"""What a rule is: a small class with a code, an aim, a check, a hint, a bad and a good example."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from types import MappingProxyType
from typing import ClassVar

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.subject import Subject
from kinetostat.urdf.document import Element

__all__ = ["Example", "Needs", "Rule", "RuleSkippedError"]


class Needs(IntEnum):
    """What has to be there for a rule to be asked; each holds those before it."""

    BYTES = 0
    DOCUMENT = 1  # XML that parses
    ROBOT = 2  # a robot that the reader accepts
    MODEL = 3  # a robot that Pinocchio accepts, too; the analyses may be asked


class RuleSkippedError(Exception):
    """Raised by a rule that cannot be asked of a robot, with the reason. Skipped is not passed: it is reported."""


@dataclass(frozen=True)
class Example:
    """A robot that shows a rule: its text, and the files around it.

    Attributes:
        robot: the text of a robot file, or what stands inside `<robot name="example">`; in a bad example a comment
            `<!-- CODE -->` ends each line that the rule is to point at (of the SRDF, if the rule is about that).
        srdf: the text of the SRDF beside it, or what stands inside its `<robot>`.
        files: texts of further files by their path from the robot's folder.
    """

    robot: str
    srdf: str = ""
    files: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def robot_text(self) -> str:
        """The whole robot file."""
        return _whole(self.robot)

    @property
    def srdf_text(self) -> str:
        """The whole SRDF; empty without one."""
        return _whole(self.srdf) if self.srdf else ""


def _whole(text: str) -> str:
    text = inspect.cleandoc(text) + "\n"
    return text if "<robot" in text or "<?xml" in text else f'<robot name="example">\n{text}</robot>\n'


class Rule(ABC):
    """A rule: the first line of its docstring is its aim, the rest why it matters.

    Attributes:
        code: letter of the family and three digits.
        name: a few words with hyphens.
        severity: of its findings, unless one says otherwise.
        hint: what to do, unless a finding says otherwise.
        needs: what has to be there for it to be asked.
        bad, good: an example on which it fires, and one on which it does not.
        by_gate: whether only the gate can ask it, of more than a file: then its examples show nothing.
    """

    code: ClassVar[str]
    name: ClassVar[str]
    severity: ClassVar[Severity]
    hint: ClassVar[str]
    needs: ClassVar[Needs] = Needs.DOCUMENT
    bad: ClassVar[Example]
    good: ClassVar[Example]
    by_gate: ClassVar[bool] = False

    @abstractmethod
    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield what is found.

        Raises:
            RuleSkippedError: the rule cannot be asked of this robot.
        """

    def finding(
        self,
        at: Element | int,
        message: str,
        *,
        hint: str | None = None,
        severity: Severity | None = None,
        attribute: str = "",
        file: str = "",
        element: str = "",
        several: bool = False,
    ) -> Finding:
        """Return a finding at an element, or at a line (0: no line)."""
        if isinstance(at, int):
            line, column, label = at, 0, element
        else:
            line, column, label = at.line, at.column, element or at.label()
        return Finding(
            self.code,
            self.name,
            severity or self.severity,
            message,
            line,
            label,
            self.hint if hint is None else hint,
            attribute,
            file,
            column,
            several,
        )

    @property
    def aim(self) -> str:
        """What it looks for, in one line."""
        return inspect.cleandoc(self.__doc__ or "").split("\n", 1)[0]

    @property
    def why(self) -> str:
        """Why it matters."""
        return inspect.cleandoc(self.__doc__ or "").partition("\n\n")[2]
