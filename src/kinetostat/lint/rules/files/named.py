"""What the rules about named files share: each file is judged once, and many alike are one finding."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

from kinetostat.errors import LONGEST_QUOTE, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import FEW, Found, grouped, times
from kinetostat.lint.meshes import NamedFile, last_name, named_files
from kinetostat.lint.rule import Rule
from kinetostat.lint.subject import Subject

__all__ = ["FileRule", "Verdict", "shown"]


def shown(name: str) -> str:
    """Return the name of a file, quoted; of a long one the end, which tells more than its beginning."""
    return quote(name if len(name) <= LONGEST_QUOTE else f"...{name[3 - LONGEST_QUOTE :]}")


@dataclass(frozen=True)
class Verdict:
    """What a rule says of one file.

    Attributes:
        text: what is wrong, after the name of the file; of many files, the first one's is shown.
        severity, hint: where they are not the rule's.
        group: only files of one group are told together.
    """

    text: str
    severity: Severity | None = None
    hint: str | None = None
    group: str = ""


class FileRule(Rule):
    """A rule that judges the named files one by one."""

    @abstractmethod
    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return what is wrong with a file; None if nothing."""

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a finding for each file, or one for all that are alike if they are many."""
        groups: dict[tuple[Severity | None, str], list[tuple[NamedFile, Verdict]]] = {}
        for file in named_files(subject).values():
            found = self.verdict(file)
            if found is not None:
                groups.setdefault((found.severity, found.group), []).append((file, found))
        for group in groups.values():
            what = "texture" if all(file.is_texture for file, _ in group) else "mesh"
            _, verdict = group[0]
            told = [self._told(file, each, alone=len(group) <= FEW) for file, each in group]
            yield from grouped(self, told, what=what, hint=verdict.hint, severity=verdict.severity)

    def _told(self, file: NamedFile, verdict: Verdict, *, alone: bool) -> Found:
        message = f"{shown(file.name)}: {verdict.text}"
        uses = times(len(file.uses)) if alone else ""
        return Found(file.first, last_name(file.name), message + uses, "filename")
