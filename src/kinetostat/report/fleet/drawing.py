"""A picture of the report, as it travels from the process that draws it to the page."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Drawing"]


@dataclass(frozen=True)
class Drawing:
    """A picture that stands in a page.

    Attributes:
        svg: an <svg> element without prologue, its ids unique in the page, its colours those of the page's theme.
        alt: what it shows, in a sentence: plain text, not yet escaped.
        metres: how many metres its width is, for pictures that are shown at one scale; else 0.
    """

    svg: str
    alt: str
    metres: float = 0.0
