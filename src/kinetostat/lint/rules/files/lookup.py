"""M101 to M107: do the names of meshes and textures lead to a file, in the package, on every machine?"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator

from kinetostat.errors import quote
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.headers import MESHES, PICTURES
from kinetostat.lint.meshes import MANY, NamedFile, named_files
from kinetostat.lint.rule import Example, Rule, RuleSkippedError
from kinetostat.lint.rules.files.named import FileRule, Verdict
from kinetostat.lint.subject import Subject
from kinetostat.urdf.packages import Reason

__all__ = ["LOOKUP"]

_WINDOWS = re.compile(r"[A-Za-z]:[\\/]|\\")
_FILE = re.compile(r"file://", re.IGNORECASE)
_SPECIAL = ("/dev/", "/proc/", "/sys/")
_PERCENT = re.compile(r"%[0-9A-Fa-f]{2}")
_LOST = (Reason.MISSING, Reason.UNFOLLOWED, Reason.NUL)


def _example(name: str, mark: str = "") -> str:
    """Return the lines of a link with one mesh."""
    end = f" <!-- {mark} -->" if mark else ""
    return f"""
        <link name="base">
          <visual>
            <geometry>
              <mesh filename="{name}"/>{end}
            </geometry>
          </visual>
        </link>"""


_FACET = (
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
)
_THERE = {"meshes/base.stl": _FACET}


def _is_asset(file: NamedFile) -> bool:
    """Return whether a name is that of a mesh or a picture, not of a device or of any other file."""
    return file.extension in MESHES | PICTURES and not _FILE.sub("", file.name).startswith(_SPECIAL)


class MissingMesh(FileRule):
    """A mesh or a texture is not there.

    Viewers and simulators show or collide with nothing in its place, and some refuse the robot. Whoever wrote the file
    may have it: a file that was never committed, or a folder that was renamed.
    """

    code = "M101"
    name = "mesh-missing"
    severity = Severity.WARNING
    hint = "add the file, or correct the name"
    bad = Example(_example("meshes/base.stl", "M101"))
    good = Example(_example("meshes/base.stl"), files=_THERE)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a file is lost."""
        if file.found not in _LOST or file.twin is not None:
            return None
        hint = None
        if "\\" in file.name:
            hint = "write / between folders: \\ is a part of the name outside Windows"
        elif file.name.startswith("package:"):
            hint = "write package:// with two strokes" if not file.name.startswith("package://") else None
        return Verdict(str(file.found), hint=hint, group=hint or "")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield what is lost.

        Raises:
            RuleSkippedError: the file came from standard input, which has no folder to look in.
        """
        files = named_files(subject).values()
        if any(file.found is Reason.NO_FOLDER for file in files):
            raise RuleSkippedError(str(Reason.NO_FOLDER))
        yield from super().check(subject)
        if len(files) > MANY:
            over = list(files)[MANY]
            message = f"only the first {MANY} of {len(files)} names of meshes and textures were looked for"
            yield self.finding(over.first, message, hint="split the robot", severity=Severity.INFO)


class WrongCase(FileRule):
    """The name of a mesh differs from that of the file by upper and lower case only.

    It is found on Windows and macOS and is missing on Linux, where robots run: the classic slip of a file that was
    written by a CAD program.
    """

    code = "M102"
    name = "mesh-case"
    severity = Severity.WARNING
    hint = "write the name as the file has it"
    bad = Example(_example("meshes/Base.STL", "M102"), files=_THERE)
    good = Example(_example("meshes/base.stl"), files=_THERE)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return how the file is really called."""
        if file.twin is None:
            return None
        return Verdict(f"the file is called {quote('/'.join(file.twin.parts[-2:]))}")


class OutsideMesh(FileRule):
    """The path of a mesh leads out of the package that the robot file is in.

    An installed package holds its own files only, so the mesh is lost there; and a robot file from elsewhere must not
    make a tool read any file of the machine. Where no package.xml says what the package is, a mesh in the neighbour
    folder (`../meshes`) is only worth knowing, one further away a warning; in neither case is it looked for.
    """

    code = "M103"
    name = "mesh-outside"
    severity = Severity.ERROR
    hint = "move the file into the package, or name the package that holds it: package://NAME/..."
    bad = Example(_example("../../etc/base.cfg", "M103"))
    good = Example(_example("meshes/../meshes/base.stl"), files=_THERE)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a path leads out."""
        scheme = file.name.startswith("package://")
        if file.found is Reason.PACKAGE and file.name[len("package://") :].split("/")[0] in ("..", "."):
            return Verdict(str(Reason.OUTSIDE))
        if file.found is not Reason.OUTSIDE:
            return None
        if scheme or not _is_asset(file) or file.in_package:
            return Verdict(str(Reason.OUTSIDE))
        text = "the path leads out of the robot file's folder, and no package.xml says that they belong together"
        near = not posixpath.normpath(file.name).startswith("../../")
        return Verdict(text, Severity.INFO if near else Severity.WARNING, "add a package.xml above both")


class AbsoluteMesh(FileRule):
    """The path of a mesh is absolute.

    It is right on one machine only. A path to a device, or to what is no mesh at all, is an error: a tool that opens
    it may hang, or show what it should not.
    """

    code = "M104"
    name = "mesh-absolute"
    severity = Severity.WARNING
    hint = "write it relative to the robot file, or as package://NAME/..."
    bad = Example(_example("/home/me/robot/meshes/base.stl", "M104"))
    good = Example(_example("meshes/base.stl"), files=_THERE)

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a path is absolute; not in expanded xacro, where `$(find ...)` may have made it so."""
        if file.found is not Reason.ABSOLUTE or (file.expanded and _is_asset(file)):
            return None
        if _WINDOWS.match(file.name):
            return Verdict("an absolute path of Windows")
        if not _is_asset(file):
            return Verdict("an absolute path, and not to a mesh", Severity.ERROR)
        return Verdict(str(Reason.ABSOLUTE))


class ForeignScheme(FileRule):
    """A mesh is named by a URI other than package://.

    `file://`, which RViz, Gazebo and Drake follow, names a place on one machine; `http://` needs a network; `model://`
    is known to Gazebo alone. What most tools follow is `package://` (not MuJoCo, which reads plain paths). A name that
    is that of no mesh is an error, as for an absolute path.
    """

    code = "M105"
    name = "mesh-scheme"
    severity = Severity.WARNING
    hint = "write package://NAME/..., or a path relative to the robot file"
    bad = Example(_example("file:///home/me/base.stl", "M105"))
    good = Example(_example("package://arm/meshes/base.stl"), files={**_THERE, "arm/package.xml": "<package/>"})

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return what is odd about a scheme; not in expanded xacro, where `$(find ...)` may have made a file://."""
        if file.found is not Reason.SCHEME:
            return None
        scheme = file.name.partition("://")[0].lower()
        if scheme == "file":
            if file.expanded and _is_asset(file):
                return None
            if not _is_asset(file):
                return Verdict("file:// names a place on one machine, and no mesh", Severity.ERROR, group=scheme)
            return Verdict("file:// names a place on one machine", group=scheme)
        known = {"http": "it is fetched over a network", "https": "it is fetched over a network"}
        known["model"] = "model:// is known to Gazebo alone"
        return Verdict(known.get(scheme, f"{quote(scheme + '://')} is not known to robot tools"), group=scheme)


class UnresolvedPackage(Rule):
    """A package that meshes are named by is not found.

    Its meshes cannot be looked for here. That is so where the package is another one, which is not installed; it is a
    defect where the name of the package is wrong.
    """

    code = "M106"
    name = "package-unresolved"
    severity = Severity.WARNING
    hint = "name its folder with --package-dir, or correct the name"
    bad = Example(_example("package://arm_descripton/meshes/base.stl", "M106"))
    good = Example(
        _example("package://arm/meshes/base.stl"),
        files={"arm/package.xml": "<package/>", "arm/meshes/base.stl": _FACET},
    )

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each package that is not found, with how many files are in it."""
        packages: dict[str, list[NamedFile]] = {}
        for file in named_files(subject).values():
            if file.found is Reason.PACKAGE:
                package = file.name.removeprefix("package://").partition("/")[0]
                if package not in (".", ".."):
                    packages.setdefault(package, []).append(file)
        for package, files in packages.items():
            what = "a file" if len(files) == 1 else f"{len(files)} files"
            message = f"package {quote(package)} is not found" if package else "package:/// names no package"
            message += f": {what} could not be looked for"
            hint = None if package else "write package://NAME/...: two slashes, then the name of the package"
            yield self.finding(files[0].first, message, hint=hint, attribute="filename")


class EncodedName(FileRule):
    """The name of a mesh holds percent codes such as %20.

    ROS decodes them, as in any URI; pybullet, MuJoCo and yourdfpy look for a file that is called just so. One of them
    does not find it.
    """

    code = "M107"
    name = "mesh-encoded"
    severity = Severity.WARNING
    hint = "rename the file without blanks and special characters"
    bad = Example(_example("meshes/base%20plate.stl", "M107"), files={"meshes/base plate.stl": _FACET})
    good = Example(_example("meshes/base_plate.stl"), files={"meshes/base_plate.stl": _FACET})

    def verdict(self, file: NamedFile) -> Verdict | None:
        """Return that a name is encoded; a lost one is another rule's."""
        if file.found in _LOST or not _PERCENT.search(file.name):
            return None
        return Verdict("some tools decode % codes and some do not")


LOOKUP: tuple[Rule, ...] = (
    MissingMesh(),
    WrongCase(),
    OutsideMesh(),
    AbsoluteMesh(),
    ForeignScheme(),
    UnresolvedPackage(),
    EncodedName(),
)
