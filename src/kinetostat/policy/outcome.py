"""Whether a robot meets what is expected of it: what was wanted, what is, and the witness."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Outcome"]


@dataclass(frozen=True)
class Outcome:
    """One expectation, judged.

    Attributes:
        kind: the expectation's kind, such as "holds".
        title: the expectation in words, one line.
        met: whether it is met; None if it could not be judged.
        wanted: what was wanted, with its unit.
        found: what is, with its unit; or why it could not be judged.
        witness: where it is so: positions of joints, rad and m; empty where there is none.
        place: the file and line of the expectation: `kinetostat.toml:12`.
        remedy: a command, to be pasted, that makes what is now what is wanted; empty where there is none.
    """

    kind: str
    title: str
    met: bool | None
    wanted: str
    found: str
    witness: dict[str, float] = field(default_factory=dict)
    place: str = ""
    remedy: str = ""
