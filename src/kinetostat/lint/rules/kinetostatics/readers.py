"""K201, K202: what the readers say of a robot, turned into findings. The gate asks them; a file alone cannot."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator

from kinetostat.analysis.agreement import Disagreement
from kinetostat.engines.third import ThirdReader
from kinetostat.errors import cut, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.subject import Subject

__all__ = ["EnginesDisagree", "ReadersRule", "ThirdReaderDisagrees"]

_SHOWN = 8  # coordinates of a configuration
_FINE = """
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="continuous">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
        </joint>"""


class ReadersRule(Rule):
    """A rule about what the readers say. No file can make them disagree, so its examples are the same sound robot."""

    needs = Needs.MODEL
    by_gate = True
    bad = good = Example(_FINE)

    def check(self, subject: Subject) -> Iterator[Finding]:  # noqa: ARG002
        """Yield nothing: `lint` asks `of`, of what `analysis.agreement` has found."""
        yield from ()

    @abstractmethod
    def takes(self, disagreement: Disagreement) -> bool:
        """Return whether a disagreement is this rule's."""

    def of(self, disagreement: Disagreement, subject: Subject) -> Finding:
        """Return the finding for a disagreement."""
        frame = disagreement.frame
        element = subject.link_elements.get(frame, subject.root) if frame else subject.root
        return self.finding(element, _message(disagreement))


class EnginesDisagree(ReadersRule):
    """The two engines do not agree on a number of this robot.

    Every number is computed by Pinocchio and by an engine that shares nothing with it. Where they differ, one of them
    reads the file in another way than is written, or is wrong: no number of this robot can be relied on until it is
    known which. The message says on what, where, by how much, and which of them the witnesses contradict.
    """

    code = "K201"
    name = "engines-disagree"
    severity = Severity.ERROR
    hint = "please report it with the file: it is a bug, of kinetostat or of Pinocchio"

    def takes(self, disagreement: Disagreement) -> bool:
        """Return whether a disagreement is this rule's: one of an engine."""
        return disagreement.odd_one != ThirdReader.name


class ThirdReaderDisagrees(ReadersRule):
    """yourdfpy puts a link elsewhere than both engines do.

    Two readers outvote one, so the numbers here stand; but whoever visualises the robot with yourdfpy, or with what is
    built on it, sees another robot. What yourdfpy is known to read differently (slides along axes that have not length
    1, followers of followers, quaternions, screws) is left out, and is not the reason.
    """

    code = "K202"
    name = "third-reader-disagrees"
    severity = Severity.WARNING
    hint = "look at what is unusual about the joints before that link; please report it with the file"

    def takes(self, disagreement: Disagreement) -> bool:
        """Return whether a disagreement is this rule's: one of the third reader alone."""
        return disagreement.odd_one == ThirdReader.name


def _message(found: Disagreement) -> str:
    readers = " and ".join(found.readers)
    verdict = f"; {found.odd_one} is the odd one out" if found.odd_one else "; which of them is wrong is not known"
    size = f"{found.size:.3g} {found.unit}" if found.unit != "1" else f"{found.size:.3g}"
    of = f" of {quote(found.frame)}" if found.frame else ""
    moved = [(name, value) for name, value in found.configuration.items() if value]
    shown = ",".join(f"{cut(name, 40)}={value:.4g}" for name, value in moved[:_SHOWN]) or "zero"
    more = f" and {len(moved) - _SHOWN} more" if len(moved) > _SHOWN else ""
    where = f", at {shown}{more}" if found.configuration else ""
    return f"{readers} differ on the {found.quantity}{of} by {size} (tolerance {found.tolerance:.1e}){verdict}{where}"
