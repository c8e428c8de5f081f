"""What a figure says, where: for tests that nothing is cut, and nothing covered."""

from itertools import combinations

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from kinetostat.report.figures.sheet import house_style


def texts(figure):
    """Return every text that is shown, with its box in pixels."""
    with house_style():  # in which it is saved, too
        FigureCanvasAgg(figure).draw()
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        hidden = {t for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) for t in _hidden(ax, axis)}
        return [(t.get_text(), t.get_window_extent()) for t in shown if t not in hidden]


def _hidden(ax, axis):
    """Yield the texts of an axis that are not drawn: of ticks outside, or all of them."""
    drawn = [] if not ax.axison else [t.label1 if t.label1.get_visible() else t.label2 for t in axis._update_ticks()]
    ticks = {label for tick in axis.get_major_ticks() for label in (tick.label1, tick.label2)}
    yield from (set(axis.findobj(Text)) if not ax.axison else ticks) - set(drawn)


def cut_texts(figure, slack=1.0):
    """Return what is not all on the figure."""
    found = [(text, box.extents) for text, box in texts(figure)]
    wide, high = figure.bbox.max
    return [text for text, (x0, y0, x1, y1) in found if min(x0, y0) < -slack or x1 > wide + slack or y1 > high + slack]


def covered_texts(figure, slack=1.0):
    """Return pairs of texts that lie on each other."""
    boxes = [(text, box.extents) for text, box in texts(figure)]
    return [
        (a, b)
        for (a, (x0, y0, x1, y1)), (b, (u0, v0, u1, v1)) in combinations(boxes, 2)
        if min(x1, u1) - max(x0, u0) > slack and min(y1, v1) - max(y0, v0) > slack
    ]
