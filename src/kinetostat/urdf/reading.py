"""What the reading of any element needs: numbers that are checked, errors that say where, remarks that are kept."""

from __future__ import annotations

import math
import re

from kinetostat.errors import NumberError, RobotError, StructureError, quote
from kinetostat.urdf.description import Remark
from kinetostat.urdf.document import Document, Element

__all__ = ["Reading", "as_number", "words"]

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_INFINITY = re.compile(r"[+-]?inf(?:inity)?", re.IGNORECASE)
_BLANKS = " \t\r\n"


def words(text: str) -> list[str]:
    """Return the words between white space. Not str.split: a no-break space is no white space to other readers."""
    stripped = text.strip(_BLANKS)
    return re.split(f"[{_BLANKS}]+", stripped) if stripped else []


def as_number(word: str) -> float | None:
    """Return the number that a word is, perhaps infinite; None if it is none."""
    word = word.strip(_BLANKS)
    return float(word) if _NUMBER.fullmatch(word) or _INFINITY.fullmatch(word) else None


class Reading:
    """One file being read: its document, and the remarks on it so far."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.remarks = [Remark(line, "", text) for line, text in document.remarks]

    def error(self, element: Element, message: str, remedy: str, kind: type[RobotError] = StructureError) -> RobotError:
        """Return an error about an element, to be raised."""
        return kind(message, file=self.document.file, line=element.line, element=element.label(), remedy=remedy)

    def remark(self, element: Element, text: str) -> None:
        """Note something odd about an element that does not stop the reading."""
        self.remarks.append(Remark(element.line, element.label(), text))

    def single(self, element: Element, tag: str) -> Element | None:
        """Return the child element of that name; the first, with a remark, if there are several."""
        found = element.all(tag)
        if len(found) > 1:
            self.remark(element, f"{len(found)} <{tag}> elements: the first, at line {found[0].line}, counts")
        return found[0] if found else None

    def vector(self, element: Element, key: str, size: int, largest: float = math.inf) -> tuple[float, ...]:
        """Return the finite numbers of an attribute, separated by white space.

        Raises:
            NumberError: the attribute is missing, has another count of numbers, or one that is not finite.
        """
        remedy = f'write {key}="{" ".join("0" * size)}" with your numbers'
        if key not in element.attributes:
            raise self.error(element, f"no {key}", remedy, NumberError)
        found = words(element.attributes[key])
        if len(found) != size:
            text = quote(element.attributes[key].strip(_BLANKS))
            raise self.error(element, f"{key}={text} has {len(found)} numbers, not {size}", remedy, NumberError)
        return tuple(self._parse(element, key, word, largest) for word in found)

    def number(self, element: Element, key: str, largest: float = math.inf, *, infinite: bool = False) -> float:
        """Return the number of an attribute that is there; an infinite one only where that means "none".

        Raises:
            NumberError: it does not parse, is not finite, or is larger than `largest`.
        """
        word = element.attributes[key].strip(_BLANKS)
        if infinite and _INFINITY.fullmatch(word):
            return float(word)
        return self._parse(element, key, word, largest)

    def _parse(self, element: Element, key: str, word: str, largest: float) -> float:
        if not _NUMBER.fullmatch(word):
            remedy = "write a plain decimal number"
            if "," in word:
                remedy = "write a decimal point, and spaces between numbers"
            if "$" in word:
                remedy = "this is xacro that is not expanded"
            raise self.error(element, f"{key}: {quote(word)} is not a finite number", remedy, NumberError)
        value = float(word)
        if math.isinf(value) or abs(value) > largest:
            bound = f"; at most {largest:g} is read" if largest < math.inf else ""
            raise self.error(element, f"{key}: {quote(word)} is too large{bound}", "check the unit", NumberError)
        return value
