"""M201 to M203: scales of meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.meshes import last_name, scaled_meshes
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.files.named import shown
from kinetostat.lint.subject import Subject, vector
from kinetostat.urdf.document import Element

__all__ = ["SCALES"]

_APART = 99.0  # two scales of one mesh that differ by such a factor: metres and millimetres


def _example(scale: str, mark: str = "") -> Example:
    end = f" <!-- {mark} -->" if mark else ""
    return Example(f"""
        <link name="base">
          <collision>
            <geometry>
              <mesh filename="package://arm/base.stl" scale="{scale}"/>{end}
            </geometry>
          </collision>
        </link>""")


@dataclass(frozen=True)
class _Scaled:
    mesh: Element
    kind: str
    scale: tuple[float, ...]

    @property
    def shown(self) -> str:
        return " ".join(f"{s:g}" for s in self.scale)


def _scales(subject: Subject) -> Iterator[_Scaled]:
    """Yield the meshes; the scale is 1 where there is none. A scale that cannot be read is another rule's."""
    for _, mesh, kind in scaled_meshes(subject):
        scale = vector(mesh, "scale", 3) if "scale" in mesh.attributes else (1.0, 1.0, 1.0)
        if scale is not None:
            yield _Scaled(mesh, kind, scale)


class ZeroScale(Rule):
    """A mesh is scaled to nothing.

    A mesh without thickness has no volume: simulators refuse it or collide with nothing.
    """

    code = "M201"
    name = "scale-zero"
    severity = Severity.WARNING
    hint = "write 1 1 1, or 0.001 0.001 0.001 for millimetres"
    bad = _example("1 1 0", "M201")
    good = _example("0.001 0.001 0.001")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each scale with a zero in it."""
        for each in _scales(subject):
            if not all(each.scale):
                yield self.finding(each.mesh, f"scale {each.shown} leaves no volume", attribute="scale")


class NegativeScale(Rule):
    """A mesh is mirrored by a negative scale, which turns it inside out.

    Where one or all three numbers are negative, the faces of the file look inwards. Many robots use one mesh for both
    sides so, and tools know it: MuJoCo puts the facets in order, Drake and PyBullet collide rightly, a convex hull has
    no inside. A renderer that leaves out the back of faces shows the far wall of the part. Two negative numbers are
    half a turn, and harmless.
    """

    code = "M202"
    name = "scale-negative"
    severity = Severity.INFO
    hint = "export a mirrored mesh, if it is shown inside out"
    bad = _example("1 -1 1", "M202")
    good = _example("-1 -1 1")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield one finding for the mirrored meshes of a robot."""
        mirrored: dict[str, _Scaled] = {}
        for each in _scales(subject):
            if sum(s < 0 for s in each.scale) in (1, 3) and all(each.scale):
                mirrored.setdefault(each.mesh.attributes.get("filename", ""), each)
        found = [
            Found(each.mesh, last_name(name), f"{shown(name)}: scale {each.shown} mirrors it", "scale")
            for name, each in mirrored.items()
        ]
        yield from grouped(self, found, what="mesh", few=1)


class TwoScales(Rule):
    """One mesh file is used in metres here and in millimetres there.

    The same file at two scales that differ by a factor of hundreds: one of the two is wrong, mostly the collision mesh,
    which nobody sees.
    """

    code = "M203"
    name = "scale-differs"
    severity = Severity.WARNING
    hint = "use one scale for one file"
    bad = Example("""
        <link name="base">
          <visual>
            <geometry>
              <mesh filename="package://arm/base.stl" scale="0.001 0.001 0.001"/>
            </geometry>
          </visual>
          <collision>
            <geometry>
              <mesh filename="package://arm/base.stl"/> <!-- M203 -->
            </geometry>
          </collision>
        </link>""")
    good = Example("""
        <link name="base">
          <visual>
            <geometry>
              <mesh filename="package://arm/base.dae"/>
            </geometry>
          </visual>
          <collision>
            <geometry>
              <mesh filename="package://arm/base.stl" scale="0.001 0.001 0.001"/>
            </geometry>
          </collision>
        </link>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first use of each file whose scale does not go with that of its first."""
        seen: dict[str, _Scaled] = {}
        told = set[str]()
        for each in _scales(subject):
            name = each.mesh.attributes.get("filename", "")
            largest = max(abs(s) for s in each.scale)
            if not name or not largest or name in told:
                continue
            first = seen.setdefault(name, each)
            ratio = largest / max(abs(s) for s in first.scale)
            if ratio > _APART or ratio < 1 / _APART:
                told.add(name)
                message = f"{quote(name)} at scale {each.shown} here and {first.shown} at line {first.mesh.line}"
                yield self.finding(each.mesh, message, attribute="scale")


SCALES: tuple[Rule, ...] = (ZeroScale(), NegativeScale(), TwoScales())
