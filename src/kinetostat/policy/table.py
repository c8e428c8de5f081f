"""What `kinetostat.toml`, or `[tool.kinetostat]` in pyproject.toml, can say, as types."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct, field

from kinetostat.policy.expectations import Expectation
from kinetostat.policy.kinds.common import NotNegative, measured_in

__all__ = ["ChainSettings", "CheckSettings", "RobotSettings", "Settings"]

Globs = tuple[str, ...]
Codes = tuple[str, ...]


class CheckSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"):
    """How `kinetostat check` checks. What its command line says goes before."""

    select: Annotated[
        Codes,
        Meta(description="Rules that are asked, by code, name or family. Default: all.", examples=[("J", "I208")]),
    ] = ()
    ignore: Annotated[Codes, Meta(description="Rules that are not asked, likewise.")] = ()
    fail_on: Annotated[
        Literal["error", "warning", "info"], Meta(description="A finding so bad, or worse, fails a file.")
    ] = "error"
    samples: Annotated[
        int, Meta(ge=0, le=10_000, description="Configurations at which readers are compared; 0 for none.")
    ] = 20
    seed: Annotated[int, Meta(ge=0, le=2**32, description="Of the random configurations.")] = 0
    timeout: Annotated[
        float, Meta(gt=0, description="After so long a robot counts as crashed.", extra=measured_in("s"))
    ] = 120.0
    baseline: Annotated[
        str, Meta(description="A file of findings that are known, beside this one: only new ones fail.")
    ] = ""
    exclude: Annotated[
        Globs, Meta(description="Files that are not checked, as globs relative to this file's folder: 'old/*.urdf'.")
    ] = ()
    per_path_ignores: Annotated[
        dict[str, Codes], Meta(description="Rules that are not asked of some files: a glob, and a list of codes.")
    ] = field(default_factory=dict)


class ChainSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"):
    """A chain of a robot that `kinetostat report` tells of: an arm, a leg, a finger.

    Where there are such tables, they are the chains of the robot, in this order. Without them, chains are found: by the
    tips of the tree of joints and by the groups of the SRDF; hands and grippers are left out then.
    """

    frame: Annotated[str, Meta(min_length=1, description="The link at its end.", examples=["tool0"])]
    base: Annotated[
        str, Meta(description="The link that it is looked at from. Default: the root link.", examples=["torso_link"])
    ] = ""
    name: Annotated[str, Meta(description="What it is called. Default: its frame.", examples=["left arm"])] = ""
    payload: Annotated[
        NotNegative | None,
        Meta(description="What it is to carry. Default: what the command line says.", extra=measured_in("kg")),
    ] = None
    place: str = ""  # where it is written; its reader knows, no file says so


class RobotSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"):
    """One robot, or all that a glob matches: how it is read, and what is expected of it."""

    path: Annotated[
        str,
        Meta(
            min_length=1,
            description="A .urdf or .xacro file relative to this file's folder (a glob is allowed), example:NAME or "
            "textbook:NAME.",
        ),
    ]
    srdf: Annotated[str, Meta(description="Its SRDF. Default: the one beside it.")] = ""
    package_dirs: Annotated[tuple[str, ...], Meta(description="Folders to look for packages in first.")] = ()
    xacro_args: Annotated[dict[str, str], Meta(description="The arguments of a xacro file.")] = field(
        default_factory=dict
    )
    expect: Annotated[tuple[Expectation, ...], Meta(description="What is expected of it.")] = ()
    chains: Annotated[
        tuple[ChainSettings, ...], Meta(description="Chains that are reported. Default: those that are found.")
    ] = ()


class Settings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"):
    """What `kinetostat check` checks, and what robots are expected to do."""

    check: Annotated[CheckSettings, Meta(description="How it is checked.")] = CheckSettings()
    robots: Annotated[tuple[RobotSettings, ...], Meta(description="Robots and what is expected of each.")] = ()
