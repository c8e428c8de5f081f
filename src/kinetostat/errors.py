"""One exception tree; every error is one clear line and knows its exit code.

    KinetostatError                     70  (never raised itself)
    +-- UsageError                       2  the question cannot be asked like that
    |   +-- UnknownNameError             2  no such frame, joint, robot, state ("did you mean")
    |   +-- AmbiguousNameError           2  several candidates: they are listed
    |   +-- ConfigurationError           2  a joint value that cannot be
    |   +-- RepresentationError          2  Euler angles that have no rates here
    +-- RobotError                       3  the robot cannot be read, or is not a robot
    |   +-- SourceError                  3  no such file, not a regular file, too big
    |   +-- XmlError                     3  not well-formed, forbidden or undecodable XML
    |   +-- StructureError               3  not a tree of links and joints
    |   +-- NumberError                  3  a number that does not parse or is not finite
    |   +-- LimitError                   3  bigger than the reader's stated limits
    |   +-- EngineError                  3  Pinocchio refuses what the reader accepted
    +-- DisagreementError                4  the two engines disagree

Robot files are untrusted, so whatever a message quotes from one goes through `quote`: control characters and
terminal escapes come out as text, and long names are cut.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

__all__ = [
    "AmbiguousNameError",
    "ConfigurationError",
    "DisagreementError",
    "EngineError",
    "KinetostatError",
    "LimitError",
    "NumberError",
    "RepresentationError",
    "RobotError",
    "SourceError",
    "StructureError",
    "UnknownNameError",
    "UsageError",
    "XmlError",
    "cut",
    "printable",
    "quote",
    "quoted",
]

LONGEST_QUOTE = 60


def printable(text: str) -> str:
    r"""Return the text with every character that is not printable written as an escape (`\n`, `\x1b`)."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def cut(text: str, longest: int = LONGEST_QUOTE) -> str:
    """Return the text printable, cut to `longest` characters."""
    shown = printable(text)
    return shown if len(shown) <= longest else f"{shown[: longest - 3]}..."


def quote(text: str, longest: int = LONGEST_QUOTE) -> str:
    """Return the text in quotation marks, printable, cut to `longest` characters."""
    return f"'{cut(text, longest)}'"


def quoted(names: Sequence[str], most: int = 3) -> str:
    """Return some names in quotation marks, and how many more there are: 'a', 'b', 'c' and 4 more."""
    return ", ".join(map(quote, names[:most])) + (f" and {len(names) - most} more" if len(names) > most else "")


class KinetostatError(Exception):
    """An error that a user can act on.

    Attributes:
        message: what is wrong, in one line.
        file: the file or source that it is about, if any.
        line: the line in that file, from 1, if known.
        element: the XML element, for instance `<joint name="elbow">`, if any.
        remedy: what to do about it, if there is something to do.
    """

    exit_code = 70

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        element: str | None = None,
        remedy: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.file = file
        self.line = line
        self.element = element
        self.remedy = remedy

    def __str__(self) -> str:
        place = printable(self.file) if self.file is not None else ""
        if self.line is not None:
            place += f":{self.line}" if place else f"line {self.line}"
        parts = [part for part in (place, self.element, self.message) if part]
        text = ": ".join(parts)
        return f"{text} ({self.remedy})" if self.remedy else text

    def __reduce__(self) -> tuple[object, ...]:
        # Exceptions are rebuilt from positional arguments when pickled; keyword-only state needs this, or a
        # process pool dies on the first error that crosses it.
        return (_rebuild, (type(self), self.message, self.__dict__.copy()))


def _rebuild(kind: type[KinetostatError], message: str, state: dict[str, object]) -> KinetostatError:
    error = kind(message)
    error.__dict__.update(state)
    return error


class UsageError(KinetostatError):
    """The question cannot be asked like that."""

    exit_code = 2


class UnknownNameError(UsageError):
    """There is no such frame, joint, robot or state."""


class AmbiguousNameError(UsageError):
    """Several things answer to the name, or several would do as the default."""


class ConfigurationError(UsageError):
    """A configuration that cannot be: wrong length, not finite, a value for a follower joint."""


class RepresentationError(UsageError):
    """Euler angles at their own singularity, where they have no rates."""


class RobotError(KinetostatError):
    """The robot cannot be read, or is not a robot."""

    exit_code = 3


class SourceError(RobotError):
    """The file is missing, is not a regular file, is too big, or cannot be read."""


class XmlError(RobotError):
    """The text is not well-formed XML, not decodable, or uses XML that is refused (DOCTYPE)."""


class StructureError(RobotError):
    """The elements do not make one tree of uniquely named links and joints."""


class NumberError(RobotError):
    """A number does not parse, is not finite, or a vector has the wrong length."""


class LimitError(RobotError):
    """The robot is bigger than the reader's stated limits."""


class EngineError(RobotError):
    """Pinocchio refuses, or fails on, a robot that the reader accepted."""


class DisagreementError(KinetostatError):
    """The two engines do not agree on a number."""

    exit_code = 4


def unknown_name(kind: str, name: str, known: Iterable[str], *, listing: str = "") -> UnknownNameError:
    """Return the error for a name that does not exist, with the nearest names that do.

    Args:
        kind: what the name should have been, for instance "frame".
        name: the name that was asked for.
        known: the names that exist.
        listing: the command that lists them, for the case that nothing is near.
    """
    from difflib import get_close_matches

    names = list(known)
    lowered = {n.lower(): n for n in names}
    near = [n for n in names if len(name) > 2 and n.lower().startswith(name.lower())]
    near += [n for n in get_close_matches(name, names, n=3, cutoff=0.6) if n not in near]
    near += [lowered[n] for n in get_close_matches(name.lower(), lowered, n=3, cutoff=0.6) if lowered[n] not in near]
    near += [n for n in names if len(name) > 2 and name.lower() in n.lower() and n not in near]
    if near:
        remedy = "did you mean " + ", ".join(quote(n) for n in near[:3]) + "?"
    elif 0 < len(names) <= 8:
        remedy = "there are " + ", ".join(quote(n) for n in names)
    else:
        remedy = listing
    return UnknownNameError(f"there is no {kind} {quote(name)}", remedy=remedy or None)
