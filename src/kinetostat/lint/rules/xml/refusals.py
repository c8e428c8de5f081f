"""X101 to X104: do the bytes of the file become XML at all?"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Needs, Rule
from kinetostat.lint.subject import Subject

__all__ = ["REFUSALS"]


class _Refused(Rule):
    """Speaks when the bytes do not become a document for one of its reasons: beginnings of `urdf.document`'s errors."""

    severity = Severity.ERROR
    needs = Needs.BYTES
    good = Example("""
        <robot name="example">
          <link name="base"/>
        </robot>""")
    reasons: ClassVar[tuple[str, ...]]

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield why the file is no document, if that is this rule's."""
        refusal = subject.refusal
        if subject.document is None and refusal is not None and refusal.message.startswith(self.reasons):
            hint, file = self._hint(refusal.message) or refusal.remedy, subject.file_of(refusal)
            yield self.finding(refusal.line or 0, refusal.message, hint=hint, file=file)

    def _hint(self, _message: str) -> str:
        return ""


class NotARobotFile(_Refused):
    """The file is something else: an archive, a web page, a git-lfs pointer, or empty.

    What was saved from a web site is often the page around the file; a repository that was cloned without git-lfs holds
    pointers of three lines; some tools unpack archives silently and others refuse them.
    """

    code = "X101"
    name = "not-a-robot-file"
    hint = "put the robot file itself there"
    reasons = tuple(f"the file is {what}" for what in ("a gzip", "a zip", "a git-lfs", "an HTML", "empty"))
    bad = Example("""
        <!DOCTYPE html> <!-- X101 -->
        <html><body>404: there is no file <robot.urdf> here</body></html>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield what the file is, at its first line."""
        for found in super().check(subject):
            yield self.finding(1, found.message, hint=found.hint, file=found.file)


class NotWellFormed(_Refused):
    """The file is not well-formed XML.

    Nothing in it can be trusted: a strict parser refuses the file, and one that recovers (yourdfpy's) drops what it
    does not understand, which may be half of the robot.
    """

    code = "X102"
    name = "not-well-formed"
    hint = "correct the XML there"
    reasons = ("not well-formed XML", "the text has a lone surrogate")
    bad = Example("""
        <robot name="example">
          <link name="base">
        </robot> <!-- X102 -->""")

    _HINTS: ClassVar = {
        "mismatched tag": "an element before it is not closed, or closed by another name",
        "junk after document element": "one <robot> is all that a file may hold: remove what comes after </robot>",
        "duplicate attribute": "an attribute is given twice in this element: keep one",
        "no element found": "the file ends before </robot>: is it complete?",
        "unclosed token": "the file ends inside a tag: is it complete?",
        "undefined entity": "write &amp; for an ampersand; only &amp; &lt; &gt; &quot; &apos; are known",
        "reference to invalid character number": "no character has this number: remove the &#...;",
        "not well-formed (invalid token)": "look for a bare & or <, an attribute without quotation marks, "
        "or a control character",
        "syntax error": "a robot file starts with <robot>",
    }

    def _hint(self, message: str) -> str:
        return self._HINTS.get(message.partition(": ")[2], "")


class HasDoctype(_Refused):
    """The file has a DOCTYPE, with which it could declare entities.

    No robot needs one. It can make a reader open other files and addresses (XXE) or expand a few lines to gigabytes.
    Most tools read the file all the same; kinetostat does not, and nothing after it was looked at.
    """

    code = "X103"
    name = "doctype"
    hint = "delete the <!DOCTYPE ...> part"
    reasons = ("a DOCTYPE is refused",)
    bad = Example("""
        <!DOCTYPE robot [<!ENTITY mass "1.5">]> <!-- X103 -->
        <robot name="example">
          <link name="base"/>
        </robot>""")


class OddEncoding(_Refused):
    """The file is not UTF-8 text.

    UTF-8 is what every XML reader takes, and what bytes mean if nothing else is said. Other encodings are read by some
    tools only, and names with accents then differ from tool to tool.
    """

    code = "X104"
    name = "encoding"
    hint = "save the file as UTF-8"
    reasons = ("byte 0x", "the encoding ", "the text holds a NUL")
    bad = Example("""
        <?xml version="1.0" encoding="ISO-8859-1"?> <!-- X104 -->
        <robot name="example">
          <link name="base"/>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield what cannot be decoded, or what was decoded as something else than UTF-8."""
        yield from super().check(subject)
        for line, text in subject.document.remarks if subject.document is not None else ():
            if text.startswith("the file is encoded as"):
                yield self.finding(line, text, severity=Severity.WARNING)


REFUSALS: tuple[Rule, ...] = (NotARobotFile(), NotWellFormed(), HasDoctype(), OddEncoding())
