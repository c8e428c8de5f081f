"""What the rules about named files share: each file is judged once, and many alike are one finding."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinetostat.errors import LONGEST_QUOTE, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import FEW, times
from kinetostat.lint.meshes import NamedFile, named_files
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
            if len(group) > FEW:
                yield self._together(group)
            else:
                for file, found in group:
                    message = f"{shown(file.name)}: {found.text}{times(len(file.uses))}"
                    yield self._at(file, message, found)

    def _together(self, group: Sequence[tuple[NamedFile, Verdict]]) -> Finding:
        file, found = group[0]
        what = "textures" if all(each.is_texture for each, _ in group) else "meshes"
        return self._at(file, f"{len(group)} {what}, {shown(file.name)} the first: {found.text}", found)

    def _at(self, file: NamedFile, message: str, found: Verdict) -> Finding:
        return self.finding(file.first, message, hint=found.hint, severity=found.severity, attribute="filename")
