"""Bytes to a document: safe XML with line numbers.

Robot files are untrusted. There is no DOCTYPE (so no entity and no outside reference), no namespace processing (real
files carry unbound prefixes such as `drake:`), no recovery mode and no recursion over depth.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from kinetostat.errors import LimitError, XmlError, cut, quote

__all__ = ["Comment", "Document", "Element", "decoded", "parse"]

MAX_PARTS = 1_000_000  # elements and attributes: some 50 for each of 20,000 links

_DECLARATION = re.compile(r"""\s*<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_SINGLE_BYTE = re.compile(r"((?:us-?)?ascii|latin-?1|iso-?8859-?\d+|windows-?125\d|cp125\d)$", re.IGNORECASE)
_LINE_END = re.compile(r"\r\n|\r|\n")
# Each character is looked at once or twice: a hostile file must not make the search quadratic.
_BROKEN_VALUE = re.compile(rb"""=[ \t\r\n]*("[^"<>\t\r\n]*[\t\r\n][^"<>]*"|'[^'<>\t\r\n]*[\t\r\n][^'<>]*')""")
_KEY = re.compile(rb"([^\s=<>\"']+)\s*\Z")
_LONGEST_KEY = 64
_DEEPEST_LABEL = 4
_NAMED = ("link", "joint", "drake:joint", "inertial")
_NOT_ROBOT_FILES = (
    (b"\x1f\x8b", "is a gzip archive", "unpack it with gunzip first"),
    (b"PK\x03\x04", "is a zip archive", "unpack it first"),
    (b"version https://git-lfs", "is a git-lfs pointer, not the file itself", "run 'git lfs pull'"),
)


@dataclass(slots=True)
class Element:
    """One XML element: its name, attributes, the line where it starts, the element around it, those inside it.

    `column` (from 0) is where it starts in its line, `last_line` and `last_column` where its end tag is.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    parent: Element | None = field(default=None, repr=False)
    children: list[Element] = field(default_factory=list, repr=False)
    column: int = 0
    last_line: int = 0
    last_column: int = 0

    def all(self, tag: str) -> list[Element]:
        """Return the child elements of that name, in file order."""
        return [child for child in self.children if child.tag == tag]

    def label(self) -> str:
        """Return the element as a reader would look for it: `<joint name='elbow'>`, `<joint name='elbow'><axis>`."""
        parts, element = [self._mark()], self
        while "name" not in element.attributes and element.parent is not None and element.parent.tag in _NAMED:
            element = element.parent
            parts.append(element._mark())
            if len(parts) == _DEEPEST_LABEL:  # a hostile file may nest them without end
                break
        return "".join(reversed(parts))

    def _mark(self) -> str:
        tag = cut(self.tag)
        return f"<{tag} name={quote(self.attributes['name'], 40)}>" if "name" in self.attributes else f"<{tag}>"


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment: the line and the column (from 0) where it starts, and its text."""

    line: int
    column: int
    text: str


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed file.

    Attributes:
        file: where it came from.
        root: its root element.
        remarks: what was odd on the level of bytes, by line.
        comments: in file order.
        instructions: lines and targets of the processing instructions inside the root element.
        broken: attributes with a tab or a line break between their quotation marks: element, key, value as written.
            XML says that they count as blanks, and so they are in `attributes`; not every reader of robots does it.
    """

    file: str
    root: Element
    remarks: tuple[tuple[int, str], ...]
    comments: tuple[Comment, ...] = ()
    instructions: tuple[tuple[int, str], ...] = ()
    broken: tuple[tuple[Element, str, str], ...] = ()


def parse(data: bytes, file: str) -> Document:
    """Parse XML bytes.

    Args:
        data: the whole file.
        file: its name, for errors.

    Raises:
        XmlError: not XML, not well-formed, not decodable, or with a DOCTYPE.
        LimitError: more than a million elements and attributes.
    """
    for magic, what, remedy in _NOT_ROBOT_FILES:
        if data.startswith(magic):
            raise XmlError(f"the file {what}", file=file, remedy=remedy)
    remarks: list[tuple[int, str]] = []
    text = _decode(data, file, remarks)
    stripped = text.lstrip("\ufeff \t\r\n")
    if not stripped:
        raise XmlError("the file is empty", file=file, remedy="is this the file that you mean?")
    if stripped[:200].lower().startswith(("<!doctype html", "<html")):
        raise XmlError("the file is an HTML page, not a robot", file=file, remedy="download the raw file")
    skipped = _line_ends(text[: len(text) - len(stripped)])
    if skipped and stripped.startswith("<?xml"):
        remarks.append((1, "blank lines before the XML declaration: strict parsers refuse the file"))
    return _build(stripped, file, skipped, tuple(remarks))


def decoded(data: bytes, file: str) -> str:
    """Return the text of a file as `parse` reads it; what cannot be decoded is marked."""
    try:
        return _decode(data, file, [])
    except XmlError:
        return data.decode(errors="replace")


def _line_ends(text: str) -> int:
    """Return how many lines end in a text: a carriage return alone ends one, too, as it does for expat."""
    return len(_LINE_END.findall(text))


def _decode(data: bytes, file: str, remarks: list[tuple[int, str]]) -> str:
    """Return the text: UTF-8, or what a byte-order mark or the XML declaration says."""
    encoding = "utf-8"
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    else:
        declared = _DECLARATION.match(data[:200].removeprefix(codecs.BOM_UTF8).decode("latin-1"))
        if declared and declared[1].lower().replace("_", "-") not in ("utf-8", "utf8"):
            encoding = declared[1]
            # Only plain character sets: Python also calls "rot13" or "unicode_escape" encodings.
            if not _SINGLE_BYTE.match(encoding):
                raise XmlError(
                    f"the encoding {quote(encoding)} is not read", file=file, remedy="save the file as UTF-8"
                )
    if encoding != "utf-8":
        remarks.append((1, f"the file is encoded as {encoding}: it was decoded, but UTF-8 is what other tools expect"))
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        line = _line_ends(data[: error.start].decode(encoding, "replace")) + 1
        raise XmlError(
            f"byte 0x{data[error.start]:02x} is not {encoding} text",
            file=file,
            line=line,
            remedy="save the file as UTF-8, or declare its encoding",
        ) from None
    except LookupError:
        raise XmlError(
            f"the encoding {quote(encoding)} is unknown", file=file, remedy="save the file as UTF-8"
        ) from None
    if "\0" in text:  # expat would guess UTF-16 from it
        line = _line_ends(text[: text.index("\0")]) + 1
        raise XmlError("the text holds a NUL character", file=file, line=line, remedy="save the file as UTF-8 text")
    return text


def _encoded(text: str, file: str) -> bytes:
    try:
        return text.encode()
    except UnicodeEncodeError:
        raise XmlError("the text has a lone surrogate", file=file, remedy="save the file as UTF-8") from None


def _build(text: str, file: str, skipped: int, remarks: tuple[tuple[int, str], ...]) -> Document:
    """Run expat over the text and return the document."""
    parser = expat.ParserCreate("UTF-8")
    top = Element("", {}, 0)
    open_elements = [top]
    comments, instructions, starts = list[Comment](), list[tuple[int, str]](), list[tuple[int, Element]]()
    count = 0
    data = _encoded(text, file)
    is_broken = _BROKEN_VALUE.search(data) is not None

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1 + len(attributes)
        if count > MAX_PARTS:
            raise LimitError(
                f"too many elements and attributes; at most {MAX_PARTS:,} are read",
                file=file,
                line=parser.CurrentLineNumber + skipped,
                remedy="leave out what you do not ask for",
            )
        line, column = parser.CurrentLineNumber + skipped, parser.CurrentColumnNumber
        element = Element(tag, attributes, line, open_elements[-1], column=column)
        open_elements[-1].children.append(element)
        open_elements.append(element)
        if is_broken:
            starts.append((parser.CurrentByteIndex, element))

    def end(_tag: str) -> None:
        element = open_elements.pop()
        element.last_line, element.last_column = parser.CurrentLineNumber + skipped, parser.CurrentColumnNumber

    def comment(text: str) -> None:
        comments.append(Comment(parser.CurrentLineNumber + skipped, parser.CurrentColumnNumber, text))

    def instruction(target: str, _content: str) -> None:
        if len(open_elements) > 1:
            instructions.append((parser.CurrentLineNumber + skipped, target))

    def doctype(*_: object) -> None:
        raise XmlError(
            "a DOCTYPE is refused: it can pull in other files and expand without end",
            file=file,
            line=parser.CurrentLineNumber + skipped,
            remedy="delete the <!DOCTYPE ...> part; no URDF needs one",
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CommentHandler = comment
    parser.ProcessingInstructionHandler = instruction
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "syntax error")
        line = error.lineno + skipped
        raise XmlError(f"not well-formed XML: {reason}", file=file, line=line, remedy="correct the XML there") from None
    broken = tuple(_broken(data, starts))
    return Document(file, top.children[0], remarks, tuple(comments), tuple(instructions), broken)


def _broken(data: bytes, starts: list[tuple[int, Element]]) -> Iterator[tuple[Element, str, str]]:
    """Yield the attributes whose values are broken by tabs or line ends, of elements by the bytes where they start."""
    if not starts:
        return
    matches = _BROKEN_VALUE.finditer(data)
    match = next(matches, None)
    ends = [start for start, _ in starts[1:]] + [len(data)]
    for (start, element), following in zip(starts, ends, strict=True):
        end = data.find(b">", start, following)
        while match is not None and match.start() < following:
            before = _KEY.search(data, max(start, match.start() - _LONGEST_KEY), match.start())
            key = before[1].decode("utf-8", "replace") if before else ""
            if start < match.start() < end and key in element.attributes:
                yield element, key, match[1][1:-1].decode("utf-8", "replace")
            match = next(matches, None)
