"""What the first bytes of a mesh or a picture, and its size, say about it. Nothing is parsed beyond its header."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from kinetostat.errors import cut

__all__ = ["HEAD", "MESHES", "PICTURES", "Fault", "Kind", "fault_of"]

MOST_FACETS = 200_000  # of an STL, in MuJoCo
HEAD = 8192  # bytes that are read of a file

# What some robot tool reads as a mesh (assimp, OGRE, trimesh, MuJoCo, Isaac), and as a picture.
MESHES = frozenset(
    {"stl", "stla", "stlb", "dae", "zae", "obj", "ply", "off", "gltf", "glb", "mesh", "msh", "3ds", "ac", "x3d", "wrl"}
    | {"vrml", "fbx", "blend", "lwo", "lws", "dxf", "ase", "ifc", "xgl", "zgl", "usd", "usda", "usdc", "usdz", "3mf"}
    | {"amf", "vtk", "vtp", "vtu", "vtm", "sdf", "iv", "x", "ms3d", "bvh"}
)
PICTURES = frozenset(
    {"png", "jpg", "jpeg", "bmp", "tga", "tif", "tiff", "gif", "dds", "webp", "exr", "hdr", "ktx", "ktx2", "ppm", "pgm"}
    | {"pcx", "psd", "svg"}
)


class Kind(Enum):
    """What sort of fault it is; each is another rule's."""

    POINTER = "pointer"  # git-lfs has not fetched it
    UNREADABLE = "unreadable"
    LEFTOVER = "leftover"  # more bytes than the header says
    LARGE = "large"  # more facets than some tools take
    SOLID = "solid"  # a binary STL that begins as a text one


@dataclass(frozen=True)
class Fault:
    """What is wrong with a file: the kind, and a few words that say it."""

    kind: Kind
    text: str

    @classmethod
    def unreadable(cls, text: str) -> Fault:
        """Return a fault for which no tool can read the file."""
        return cls(Kind.UNREADABLE, text)


def fault_of(head: bytes, size: int, extension: str, *, texture: bool = False) -> Fault | None:
    """Return what is wrong with a file; None if nothing is seen, or if its format is not known here.

    Args:
        head: its first bytes (`HEAD` of them, or the whole file).
        size: its size in bytes.
        extension: the end of its name, in lower case, without the dot.
        texture: whether it is a picture, not a mesh.
    """
    if size == 0:
        return Fault.unreadable("it is empty")
    if head.startswith(b"version https://git-lfs"):
        return Fault(Kind.POINTER, "it is a git-lfs pointer, not the file itself")
    if not texture and head.lstrip()[:200].lower().startswith((b"<!doctype html", b"<html")):
        return Fault.unreadable("it is an HTML page")
    check = (_PICTURE_CHECKS if texture else _MESH_CHECKS).get(extension)
    return check(head, size) if check is not None else None


# --- meshes ------------------------------------------------------------------------------------------------------

_STL_START, _STL_FACET = 84, 50  # bytes before the first facet, and of each facet


def _stl(head: bytes, size: int) -> Fault | None:
    """Judge an STL: readers such as assimp take it as binary if its size is just what its count of facets says."""
    solid = head.lstrip(b"\xef\xbb\xbf \t\r\n")[:5].lower() == b"solid"
    count = struct.unpack_from("<I", head, 80)[0] if len(head) >= _STL_START else -1
    wanted = _STL_START + _STL_FACET * count
    if count > MOST_FACETS and size == wanted:
        return Fault(
            Kind.LARGE, f"it has {count:,} facets in {size / 1e6:.0f} MB; MuJoCo takes {MOST_FACETS:,} at most"
        )
    if count > 0 and size == wanted:
        return Fault(Kind.SOLID, "it is binary, but begins with 'solid' as a text STL does") if solid else None
    if solid and b"\0" not in head[:_STL_START]:
        whole = size <= len(head)
        if b"facet" not in head.lower() and whole:
            return Fault.unreadable("it is an STL without a facet")
        return None
    if size < _STL_START:
        return Fault.unreadable(f"an STL of {size} bytes: shorter than its header")
    if count == 0:
        return Fault.unreadable("it is an STL without a facet")
    if size > wanted:
        return Fault(Kind.LEFTOVER, f"an STL of {count} facets has {wanted} bytes, this one {size}")
    if wanted > 100 * size:  # such a count is no count
        return Fault.unreadable("it is neither a binary STL nor a text one")
    return Fault.unreadable(f"an STL of {count} facets has {wanted} bytes, this one {size}: it is cut short")


_ELEMENT = re.compile(r"<(?![?!])\s*(?:[\w.-]+:)?([\w.-]+)")
_SKIPPED = re.compile(r"<!--.*?(?:-->|\Z)|<\?.*?(?:\?>|\Z)", re.DOTALL)


def _collada(head: bytes, _size: int) -> Fault | None:
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = head.decode("utf-16", "replace")
    else:
        text = head.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    if not text.lstrip().startswith("<"):
        return Fault.unreadable("it does not begin as COLLADA, which is XML")
    text = _SKIPPED.sub("", text)
    if re.search(r"<!(DOCTYPE|ENTITY)", text):
        return Fault.unreadable("a DOCTYPE, which can pull in other files and expand without end")
    root = _ELEMENT.search(text)
    if root is not None and root[1] != "COLLADA":
        return Fault.unreadable(f"its root element is <{cut(root[1])}>, not <COLLADA>")
    return None


def _wavefront(head: bytes, _size: int) -> Fault | None:
    if b"\0" in head and not head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return Fault.unreadable("it is not text, as OBJ is")
    if head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"<", b"{"):
        return Fault.unreadable("it does not begin as OBJ")
    return None


def _gltf(head: bytes, size: int) -> Fault | None:
    if head.startswith(b"glTF"):
        return _glb(head, size)
    if head.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] != b"{":
        return Fault.unreadable("it does not begin as glTF, which is JSON")
    return None


def _glb(head: bytes, size: int) -> Fault | None:
    if not head.startswith(b"glTF") or len(head) < 12:
        return Fault.unreadable("it does not begin as binary glTF")
    length = struct.unpack_from("<I", head, 8)[0]
    if length > size:
        return Fault.unreadable(f"its header says {length} bytes, but it has {size}: it is cut short")
    return None


def _begins(*starts: bytes, name: str) -> Callable[[bytes, int], Fault | None]:
    """Return a check that a file begins in one of some ways."""

    def check(head: bytes, _size: int) -> Fault | None:
        return None if head.startswith(starts) else Fault.unreadable(f"it does not begin as {name}")

    return check


_MESH_CHECKS: dict[str, Callable[[bytes, int], Fault | None]] = {
    "stl": _stl,
    "dae": _collada,
    "obj": _wavefront,
    "gltf": _gltf,
    "glb": _glb,
    "ply": _begins(b"ply\n", b"ply\r", name="PLY"),
    "3mf": _begins(b"PK\x03\x04", name="3MF"),
    "usdz": _begins(b"PK\x03\x04", name="USDZ"),
    "usdc": _begins(b"PXR-USDC", name="binary USD"),
}
_JPEG = _begins(b"\xff\xd8\xff", name="JPEG")
_PICTURE_CHECKS: dict[str, Callable[[bytes, int], Fault | None]] = {
    "png": _begins(b"\x89PNG\r\n\x1a\n", name="PNG"),
    "jpg": _JPEG,
    "jpeg": _JPEG,
    "gif": _begins(b"GIF8", name="GIF"),
    "bmp": _begins(b"BM", name="BMP"),
}
