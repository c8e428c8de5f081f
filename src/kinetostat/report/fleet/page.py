"""The page of a report: one HTML file with everything in it, that asks for nothing and runs nothing but its own script.

Names in it come from robot files: Jinja2 escapes every one (`autoescape`), what cannot be printed is shown as an
escape, and the page's Content-Security-Policy allows only the style and the script that are in it, by their hashes.
"""

from __future__ import annotations

import base64
import hashlib
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kinetostat.errors import cut
from kinetostat.report.alike import alike
from kinetostat.report.check.words import counted
from kinetostat.report.figures.embedding import THEME
from kinetostat.report.figures.sheet import rounded
from kinetostat.report.fleet import wording
from kinetostat.report.fleet.document import ChainRow, FleetDocument, RobotDocument
from kinetostat.report.fleet.drawing import Drawing
from kinetostat.report.fleet.grid import Grid
from kinetostat.report.fleet.overview import overview
from kinetostat.report.fleet.robot_grids import joints_grid, poses_grid

if TYPE_CHECKING:
    from jinja2 import Environment

__all__ = ["page"]

_LONGEST = 1000  # characters of a text from a robot file
_LONGEST_NAME = 80
_WIDEST = 250  # px, of the widest thumbnail
_ALIKE = 0.01  # limbs whose numbers differ less are one thumbnail
_VALUE = re.compile(r"(?<= = )-?(?:pi\b|\d[\d.]*(?:e-?\d+)?)")
_SAME_SIZE = 5.0  # what is so many times smaller than the largest is shown at a scale of its own
_SIZE = re.compile(r'\s(?:width|height)="[^"]*"')
_VIEW_BOX = re.compile(r'\sviewBox="\S+ \S+ (\S+) (\S+)"')


def page(document: FleetDocument, drawings: Mapping[str, Drawing]) -> str:
    """Return the report as one HTML page that needs no other file: the fleet, then each robot.

    Args:
        document: all numbers.
        drawings: pictures by what they show: ROBOT.id + "/tree"; CHAIN.id + "/poses", "/reach", "/distributions",
            "/thumbnail"; "fleet/scatter". Those that are missing are left out.
    """
    environment = _environment()
    environment.globals["drawings"] = drawings
    style, script = _theme() + _asset(environment, "style.css"), _asset(environment, "script.js")
    return environment.get_template("page.html").render(
        document=document,
        overview=overview(document),
        asides=wording.asides(document),
        thumbnails=_thumbnails(document, drawings),
        unpictured=sum(f"{chain.id}/thumbnail" not in drawings for chain in wording.chains_of(document)),
        robots=_parts(document),
        policy=_policy(style, script),
        style=_trusted(style),
        script=_trusted(script),
    )


def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("kinetostat.report.fleet"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    filters: dict[str, Callable[..., Any]] = {
        "name": lambda text: cut(text, _LONGEST_NAME),
        "counted": counted,
        "breaking": _breaking,
        "facts": wording.chain_facts,
        "mathematical": _mathematical,
        "svg": lambda drawing: _trusted(drawing.svg),
    }
    tests: dict[str, Callable[[RobotDocument], bool]] = {
        "agreeing": lambda robot: wording.engines_agree(robot) is True,
        "disagreeing": lambda robot: wording.engines_agree(robot) is False,
        "erroneous": lambda robot: wording.severities(robot)["error"] > 0,
        "failing": wording.fails_check,
    }
    environment.filters.update(filters)
    environment.tests.update(tests)
    environment.globals["wording"] = wording
    return environment


def _shown(value: Any) -> Any:
    """Return what a template prints: texts printable and not endless; our own markup as it is."""
    return cut(value, _LONGEST) if type(value) is str else value


def _breaking(text: str) -> Any:
    """Return a name as markup that breaks behind an underscore, where it has to."""
    from markupsafe import Markup, escape

    return Markup("_<wbr>").join(map(escape, _shown(text).split("_")))


def _mathematical(text: str) -> str:
    """Return a condition with real signs: pi and minus as one writes them, with no break behind."""
    return _VALUE.sub(lambda value: value[0].replace("-", "\N{MINUS SIGN}").replace("pi", "π"), text)


def _trusted(text: str) -> Any:
    """Return text that is ours, as markup: a figure that we have drawn, the style, the script."""
    from markupsafe import Markup

    return Markup(text)  # noqa: S704


def _asset(environment: Environment, name: str) -> str:
    assert environment.loader is not None
    return environment.loader.get_source(environment, name)[0]


def _theme() -> str:
    """Return the colours of figures, by day and by night."""
    day, night = ("".join(f"{name}:{colours[i]};" for name, colours in THEME.items()) for i in (0, 1))
    return f":root{{{day}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{night}}}}}\n"


def _policy(style: str, script: str) -> str:
    """Return the page's Content-Security-Policy: its own style and script by their hashes, pictures within it."""
    return "; ".join(
        (
            "default-src 'none'",
            f"style-src {_hashed(style)}",
            f"script-src {_hashed(script)}",
            "img-src data:",
            "base-uri 'none'",
            "form-action 'none'",
            "require-trusted-types-for 'script'",
            "trusted-types 'none'",
        )
    )


def _hashed(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


# --- pictures --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Thumbnail:
    """A small picture of a chain; it stands for `alike`, chains of the same robot that are like it, itself too."""

    chain: ChainRow
    alike: tuple[ChainRow, ...]
    robot: RobotDocument
    drawing: Drawing
    svg: Any


@dataclass(frozen=True)
class _Thumbnails:
    """Small pictures of chains at one scale, the largest first; a bar of `metres` is `pixels` long."""

    shown: tuple[_Thumbnail, ...]
    metres: float
    pixels: float


_Small = tuple[RobotDocument, tuple[ChainRow, ...], Drawing]


def _thumbnails(document: FleetDocument, drawings: Mapping[str, Drawing]) -> list[_Thumbnails]:
    """Return the small pictures: at one scale those of a size, so that a hand is seen beside a crane."""
    small = {
        chain.id: drawing
        for chain in wording.chains_of(document)
        if (drawing := drawings.get(f"{chain.id}/thumbnail")) and drawing.metres > 0
    }
    if len(small) < 2:
        return []
    found = [
        (robot, tuple(group), small[group[0].id])
        for robot in document.robots
        for group in alike((chain for chain in robot.chains if chain.id in small), _same)
    ]
    groups = list[list[_Small]]()
    for one in sorted(found, key=lambda one: -one[2].metres):
        if not groups or one[2].metres * _SAME_SIZE < groups[-1][0][2].metres:
            groups.append([])
        groups[-1].append(one)
    return [_at_one_scale(sorted(group, key=lambda one: -(one[1][0].reach or 0.0))) for group in groups]


def _same(one: ChainRow, other: ChainRow) -> bool:
    """Return whether two chains have as many joints, reach as far, and are as dexterous: four legs, two arms."""
    pairs = ((one.reach, other.reach), (wording.dexterity(one, "0.5"), wording.dexterity(other, "0.5")))
    return len(one.joints) == len(other.joints) and all(
        a == b or (a is not None and b is not None and math.isclose(a, b, rel_tol=_ALIKE)) for a, b in pairs
    )


def _at_one_scale(found: Sequence[_Small]) -> _Thumbnails:
    scale = _WIDEST / max(drawing.metres for _, _, drawing in found)  # px/m
    shown = (
        _Thumbnail(chains[0], chains, robot, drawing, _sized(drawing.svg, scale * drawing.metres))
        for robot, chains, drawing in found
    )
    metres = rounded(0.5 * _WIDEST / scale, (1, 2, 5))
    return _Thumbnails(tuple(shown), metres, scale * metres)


def _sized(svg: str, width: float) -> Any:
    """Return a picture of that width in px, as high as its viewBox says."""
    head, end, rest = svg.partition(">")
    head = _SIZE.sub("", head)
    box = _VIEW_BOX.search(head)
    height = f' height="{width * float(box[2]) / float(box[1]):.1f}"' if box else ""
    return _trusted(f'{head} width="{width:.1f}"{height}{end}{rest}')


# --- robots ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Part:
    """A robot, and what is to be shown of it."""

    robot: RobotDocument
    label: str
    joints: Grid
    chains: tuple[tuple[ChainRow, Grid], ...]


def _parts(document: FleetDocument) -> list[_Part]:
    called = wording.labels(document)
    return [
        _Part(
            robot,
            called[robot.id],
            joints_grid(robot),
            tuple((chain, poses_grid(chain)) for chain in robot.chains),
        )
        for robot in document.robots
    ]
