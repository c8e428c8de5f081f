"""The difference of two robots, for people and for machines: view, JSON result, Markdown for a pull request."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinetostat.errors import cut
from kinetostat.report.diff_json import diff_result
from kinetostat.report.diff_markdown import diff_markdown
from kinetostat.report.diff_sections import headline_of, plain, sections
from kinetostat.report.view import Table, View

if TYPE_CHECKING:
    from kinetostat.analysis.difference.difference import Difference

__all__ = ["diff_markdown", "diff_result", "diff_view", "headline"]


def headline(result: Difference) -> str:
    """Return the difference in a line: how many changes, and the largest displacement."""
    return plain(headline_of(result))


def diff_view(result: Difference) -> View:
    """Return the view of a difference."""
    title = f"{cut(result.before)} -> {cut(result.after)}\n{headline(result)}"
    tables = tuple(
        Table(s.header, tuple(tuple(map(plain, row)) for row in s.rows), title=s.title, words=True)
        for s in sections(result)
    )
    return View(title, tables, (*result.consequences.unchanged, *result.notes))
