"""What a rule finds: a frozen value that says what is wrong, where, and what to do."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Finding", "Severity"]


class Severity(StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"

    @property
    def rank(self) -> int:
        """0 for the worst."""
        return list(Severity).index(self)


@dataclass(frozen=True)
class Finding:
    """Something wrong, or worth knowing, about a robot file.

    Attributes:
        code, name: the rule's.
        severity: error, warning or info.
        message: one line with the offending values; what it quotes from a file is printable.
        line: in the file, from 1; 0 if it is about no line. `column`, from 0: where the element starts in it.
        element: such as `<joint name='elbow'>`; may be empty.
        hint: what to do.
        attribute: the attribute that it is about, for the caret; may be empty.
        file: the file, if it is not the robot's own (an SRDF); else empty.
        several: whether it stands for several things found, of which `element` is only the first.
    """

    code: str
    name: str
    severity: Severity
    message: str
    line: int
    element: str
    hint: str
    attribute: str = ""
    file: str = ""
    column: int = 0
    several: bool = False

    @property
    def place(self) -> tuple[str | int, ...]:
        """What findings are sorted by: file, line, code, message, then all that may differ: the order is total."""
        rest = (self.column, self.element, self.attribute, self.severity.rank, self.hint, self.several)
        return self.file, self.line, self.code, self.message, *rest
