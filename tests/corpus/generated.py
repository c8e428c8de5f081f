"""Robot texts made on the spot: too big or too odd to store."""

from __future__ import annotations

from collections.abc import Iterable


def robot(parts: Iterable[str], *, head: str = '<?xml version="1.0"?>\n') -> bytes:
    """Return a robot file with these elements."""
    return (head + '<robot name="made">\n' + "\n".join(parts) + "\n</robot>\n").encode()


def link(name: str) -> str:
    """Return a link."""
    return f'<link name="{name}"/>'


def joint(name: str, parent: str, child: str, kind: str = "fixed", extra: str = "") -> str:
    """Return a joint 0.1 m up, about or along the z axis where it moves."""
    axis = "" if kind == "fixed" else '<axis xyz="0 0 1"/>'
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="0 0 0.1"/><parent link="{parent}"/><child link="{child}"/>'
        f"{axis}{limit}{extra}</joint>"
    )


def chain(depth: int, kind: str = "fixed", extra: str = "") -> bytes:
    """Return a chain of so many links, every joint of one kind; the last link is `l{depth - 1}`."""
    return robot(
        [link(f"l{i}") for i in range(depth)]
        + [joint(f"j{i}", f"l{i - 1}", f"l{i}", kind, extra) for i in range(1, depth)]
    )


def star(links: int, kind: str = "fixed") -> bytes:
    """Return so many links, all but the first hanging on it; the last one is `l{links - 1}`."""
    return robot([link(f"l{i}") for i in range(links)] + [joint(f"j{i}", "l0", f"l{i}", kind) for i in range(1, links)])


def arm(before: str = "", inside: str = "", head: str = '<?xml version="1.0"?>\n') -> bytes:
    """Return an ordinary robot of two links `a` and `b` with something put before its links or inside link `b`."""
    return robot([before, link("a"), f'<link name="b">{inside}</link>', joint("j1", "a", "b", "revolute")], head=head)
