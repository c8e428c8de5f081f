"""Figures to files: SVG, PNG and PDF, the same bytes every time."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinetostat.errors import UsageError, cut, quote
from kinetostat.report.figures.sheet import house_style
from kinetostat.report.writing import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["check_suffix", "rendered", "save"]

_UNDATED: dict[str, Any] = {".svg": {"Date": None}, ".png": {}, ".pdf": {"CreationDate": None}}


def check_suffix(path: Path) -> None:
    """Refuse a file that `save` could not write, before anything is computed.

    Raises:
        UsageError: the suffix is not .svg, .png or .pdf.
    """
    if path.suffix.lower() not in _UNDATED:
        raise UsageError(
            f"cannot draw {quote(str(path))}: a picture's format is told by its suffix",
            remedy=f"name it {cut(path.stem.lstrip('.') or 'picture')}.svg, .png or .pdf",
        )


def save(figure: Figure, path: Path) -> None:
    """Write a figure, completely or not at all; the same figure gives the same bytes.

    Args:
        figure: one made by this package.
        path: where to; the suffix tells the format: .svg (text stays text), .png (200 dpi) or .pdf.

    Raises:
        UsageError: another suffix; the file cannot be written.
    """
    check_suffix(path)
    write_whole(path, rendered(figure, path.suffix.lower()))


def rendered(figure: Figure, suffix: str) -> bytes:
    """Return the bytes of a file with one of the suffixes .svg, .png and .pdf."""
    content = io.BytesIO()
    with house_style():
        figure.savefig(content, format=suffix[1:], metadata=_UNDATED[suffix])
    return content.getvalue()
