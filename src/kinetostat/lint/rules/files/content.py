"""M108 to M112: is what the names of meshes and textures lead to a mesh, or a picture? Only its beginning is read."""

from __future__ import annotations

from pathlib import Path

from kinetostat.lint.finding import Severity
from kinetostat.lint.headers import MESHES, PICTURES, Kind
from kinetostat.lint.meshes import NamedFile
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.files.named import FileRule, Verdict

__all__ = ["CONTENT"]

_FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
_TEXT_STL = f"solid a\n{_FACET}endsolid a\n"
_BINARY_STL = "made by hand".ljust(80) + "\1\0\0\0" + "\0" * 50  # one facet
_LINK = """
        <link name="base">
          <visual>
            <geometry>
              <mesh filename="{}"/>{}
            </geometry>
          </visual>
        </link>"""


def _bad(name: str, mark: str, text: str) -> Example:
    return Example(_LINK.format(name, f" <!-- {mark} -->"), files={name: text})


def _good(name: str, text: str) -> Example:
    return Example(_LINK.format(name, ""), files={name: text})


class LfsPointer(FileRule):
    """A mesh is a git-lfs pointer: the file itself was not fetched.

    A clone without git-lfs holds a few lines of text in place of every mesh, and tools complain of a broken mesh. No
    more can be said of such a file.
    """

    code = "M108"
    name = "mesh-pointer"
    severity = Severity.WARNING
    hint = "run 'git lfs pull', in CI check out with lfs: true"
    bad = _bad("meshes/base.stl", "M108", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 684\n")
    good = _good("meshes/base.stl", _TEXT_STL)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a file is a pointer."""
        return Verdict(file.fault.text) if file.fault and file.fault.kind is Kind.POINTER else None


class UnreadableMesh(FileRule):
    """A mesh is empty, cut short, too large, or not of the format that its name says.

    Readers choose the format by the end of the name and give up. MuJoCo refuses an STL of more than 200,000 facets, and
    others become slow: that is a warning. Only the size and the first bytes are looked at: what passes here may still
    be broken further on.
    """

    code = "M109"
    name = "mesh-unreadable"
    severity = Severity.ERROR
    hint = "export the file again, or give it the ending of its format"
    bad = _bad("meshes/base.stl", "M109", "")
    good = _good("meshes/base.stl", _TEXT_STL)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return why a file cannot be read; a robot without a texture is still usable."""
        if file.fault is None or file.fault.kind not in (Kind.UNREADABLE, Kind.LARGE):
            return None
        if file.fault.kind is Kind.LARGE:
            return Verdict(file.fault.text, Severity.WARNING, "simplify the mesh", "large")
        return Verdict(file.fault.text, Severity.WARNING if file.is_texture else None)


class LeftoverBytes(FileRule):
    """A binary STL is longer than its count of facets says.

    Some readers take the count; assimp, which RViz and Gazebo use, takes a file for a binary STL only if its size is
    exactly what the count says, and refuses this one.
    """

    code = "M110"
    name = "mesh-leftover"
    severity = Severity.WARNING
    hint = "export the file again"
    bad = _bad("meshes/base.stl", "M110", _BINARY_STL + "\0" * 50)
    good = _good("meshes/base.stl", _BINARY_STL)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return the two sizes."""
        return Verdict(file.fault.text) if file.fault and file.fault.kind is Kind.LEFTOVER else None


class SolidBinary(FileRule):
    """A binary STL begins with the word that marks a text one.

    Readers that look at the first word alone take it for text and find nothing, or warn at every start.
    """

    code = "M111"
    name = "mesh-solid"
    severity = Severity.INFO
    hint = "change the first five bytes of the file, which are free text"
    bad = _bad("meshes/base.stl", "M111", "solid" + _BINARY_STL[5:])
    good = _good("meshes/base.stl", _BINARY_STL)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a file is not what it begins as."""
        return Verdict(file.fault.text) if file.fault and file.fault.kind is Kind.SOLID else None


class OddExtension(FileRule):
    """The end of a mesh's name is that of no mesh format.

    Tools choose the reader by it. STL, COLLADA (.dae), OBJ and glTF are what most of them read; a part of a CAD program
    is read by none.
    """

    code = "M112"
    name = "mesh-extension"
    severity = Severity.WARNING
    hint = "export it as .stl, .dae or .obj"
    bad = _bad("meshes/base.sldprt", "M112", "a part")
    good = _good("meshes/base.STL", _TEXT_STL)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a file is of no known format."""
        if not isinstance(file.found, Path) or file.extension in (PICTURES if file.is_texture else MESHES):
            return None
        kind = "picture" if file.is_texture else "mesh"
        shown = f"'.{file.extension[:20]}'" if file.extension.isalnum() else "such a name"
        hint = "save it as .png or .jpg" if file.is_texture else None
        return Verdict(f"{shown} is no {kind} format that robot tools read", hint=hint, group=f"{kind} {shown}")


CONTENT: tuple[Rule, ...] = (LfsPointer(), UnreadableMesh(), LeftoverBytes(), SolidBinary(), OddExtension())
