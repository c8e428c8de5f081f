"""N101 to N106: names of links and joints that ROS, USD or MJCF cannot carry."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterator

from kinetostat.errors import cut, quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped, listed
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.subject import Subject, name_of
from kinetostat.urdf.document import Element

__all__ = ["WORDS"]

LONGEST = 255  # bytes: the longest name of a topic in DDS, and of a file
_ODD = frozenset("\"'`$;|&<>\\*?!{}[]")  # of shells, markup, quotations
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def _example(link: str, mark: str = "") -> Example:
    end = f" <!-- {mark} -->" if mark else ""
    return Example(f"""
        <link name="{link}"/>{end}
        <link name="arm"/>
        <joint name="shoulder" type="fixed">
          <parent link="{link}"/><child link="arm"/>
        </joint>""")


def _named(subject: Subject) -> list[Element]:
    """Return the links and joints that have a name."""
    return [element for element in (*subject.links, *subject.joints) if name_of(element)]


class _NameRule(Rule):
    """A rule that judges the names one by one; many alike are one finding."""

    @abstractmethod
    def fault(self, name: str) -> str:
        """Return what is wrong with a name; empty if nothing."""

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each name that is wrong, or one finding for all if they are many."""
        found = [
            Found(element, name_of(element), fault, "name")
            for element in _named(subject)
            if (fault := self.fault(name_of(element)))
        ]
        yield from grouped(self, found, what="name")


class BlankInName(_NameRule):
    """A name holds white space.

    ROS has no topic or parameter of such a name, launch files and shells cut it in two, and parsers differ in whether
    blanks at its ends count: `'a '` is `'a'` in one and another link in the next.
    """

    code = "N101"
    name = "name-blank"
    severity = Severity.WARNING
    hint = "write an underscore"
    bad = _example("base plate", "N101")
    good = _example("base_plate")

    def fault(self, name: str) -> str:
        """Return where the blank is."""
        if name != name.strip():
            return "the name begins or ends with white space"
        return "white space in the name" if any(c.isspace() for c in name) else ""


class SlashInName(_NameRule):
    """A name holds a slash.

    tf2 refuses a frame that begins with one; in USD a slash leads from a prim to its child, in dm_control's MJCF into
    another model, and in ROS into another namespace.
    """

    code = "N102"
    name = "name-slash"
    severity = Severity.WARNING
    hint = "write an underscore"
    bad = _example("left/base", "N102")
    good = _example("left_base")

    def fault(self, name: str) -> str:
        """Return where the slash is."""
        if name.startswith("/"):
            return "the name begins with a slash, which tf2 refuses"
        return "a slash in the name" if "/" in name else ""


class OddCharacter(_NameRule):
    """A name holds a quotation mark, a character of shells or markup, or one that cannot be seen.

    Such names break the files and commands that are made from them: MJCF and USD text, launch files, shells, web
    pages. What cannot be seen makes two names look the same.
    """

    code = "N103"
    name = "name-character"
    severity = Severity.WARNING
    hint = "use letters, digits and underscores"
    bad = _example("base[1]", "N103")
    good = _example("base_1")

    def fault(self, name: str) -> str:
        """Return the characters; control characters and blanks are other rules'."""
        odd = dict.fromkeys(c for c in name if c in _ODD or not (c.isprintable() or c.isspace() or _is_control(c)))
        return f"the name holds {cut(' '.join(odd))}" if odd else ""


def _is_control(character: str) -> bool:
    return ord(character) < 32 or 0x7F <= ord(character) < 0xA0


class LongName(_NameRule):
    """A name is longer than 255 bytes.

    No topic of ROS 2 and no file can be called so: what is made from the name is refused, or cut to another name.
    """

    code = "N104"
    name = "name-long"
    severity = Severity.WARNING
    hint = "shorten it"
    bad = _example("base_" + 60 * "plate", "N104")
    good = _example("base_" + 20 * "plate")

    def fault(self, name: str) -> str:
        """Return how long the name is."""
        size = len(name.encode())
        return f"a name of {size} bytes; at most {LONGEST} are carried everywhere" if size > LONGEST else ""


class SameButForCase(Rule):
    """Two names differ by upper and lower case only.

    Whoever writes one means the other before long; where names become file names or SQL columns, they become one.
    """

    code = "N105"
    name = "name-case"
    severity = Severity.WARNING
    hint = "give one of them another name"
    bad = Example("""
        <link name="arm"/>
        <link name="Arm"/> <!-- N105 -->
        <joint name="shoulder" type="fixed"><parent link="arm"/><child link="Arm"/></joint>""")
    good = Example("""
        <link name="Arm"/>
        <link name="Arm_2"/>
        <joint name="arm" type="fixed"><parent link="Arm"/><child link="Arm_2"/></joint>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the later one of each two."""
        for elements in (subject.links, subject.joints):
            lowered: dict[str, str] = {}
            for element in elements:
                name = name_of(element)
                other = lowered.setdefault(name.lower(), name)
                if other != name:
                    message = f"differs from {quote(other)} by upper and lower case only"
                    yield self.finding(element, message, attribute="name")


class NoIdentifier(Rule):
    """A name is no identifier: it holds a dash, a dot or a letter beyond ASCII, or begins with a digit.

    ROS carries most of them. Converters to USD write an underscore in place of such a character, and a name in a
    script then has to be written otherwise than here.
    """

    code = "N106"
    name = "name-identifier"
    severity = Severity.INFO
    hint = "use letters, digits and underscores, and begin with a letter"
    bad = _example("base-plate", "N106")
    good = _example("base_plate")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for the robot, with the names on which no other rule speaks."""
        others = (BlankInName(), SlashInName(), OddCharacter())
        found = [
            element
            for element in _named(subject)
            if not _IDENTIFIER.fullmatch(name_of(element)) and not any(rule.fault(name_of(element)) for rule in others)
        ]
        if found:
            names = listed([name_of(element) for element in found])
            message = (
                "the name is no identifier" if len(found) == 1 else f"{len(found)} names are no identifiers: {names}"
            )
            yield self.finding(found[0], message, attribute="name")


WORDS: tuple[Rule, ...] = (
    BlankInName(),
    SlashInName(),
    OddCharacter(),
    LongName(),
    SameButForCase(),
    NoIdentifier(),
)
