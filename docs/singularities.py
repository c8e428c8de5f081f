"""`make singularities`: write docs/singularities.md, the singular configurations of ten real arms."""

import time
from pathlib import Path

import kinetostat as ks
from kinetostat.report.singular import condition_words

ARMS = (
    ("ur5_robot", "tool0", None),
    ("z1", "gripperStator", None),
    ("kinova", "j2s6s200_end_effector", None),
    ("so101", "gripper_frame_link", None),
    ("talos_left_arm", "gripper_left_base_link", None),
    ("panda", "panda_hand", None),
    ("xarm7", "link_eef", None),
    ("baxter", "left_gripper_base_link", None),
    ("pr2", "l_gripper_palm_link", "torso_lift_link"),
    ("tiago", "arm_tool_link", "torso_lift_link"),
)
HEAD = """# Singular configurations of ten real arms

From example-robot-data, as `kinetostat singular find example:ARM -f FRAME` finds them (1,000 searches, seed 0); made
by `make singularities`. Angles are those of the URDF, in degrees. Conditions on one joint alone are complete; the
others are those that searches ended on. *Rounded*: it holds but for the rounding of the file's own numbers. A condition
with "a relation of" some joints is a surface on which their positions depend on each other.

- *fold*: a barrier seen from one side, where branches of inverse kinematics meet; *boundary*: the same for a redundant
  arm; *traversable*: the arm can pass, or leave by moving inside; *tangential*: it moves inside without leaving it.
- *codim*: how many independent equations. A 7-joint arm loses rank where two hold, unless one joint does it alone.
"""


def row(arm: ks.SingularFamilies, family: ks.Family) -> str:
    """Return a line of an arm's table."""
    condition = condition_words(arm.mechanism, family.positions, family.support, family.codimension, degrees=True)
    rounded = " (rounded)" if family.tolerance == "model" else ""
    why = family.causes[0].text if family.causes else ""
    where = "yes" if family.inside_limits else "no"
    cells = family.name or "-", f"{condition}{rounded}", str(family.codimension), family.kind, where, why
    return f"| {' | '.join(cells)} |"


def section(name: str, frame: str, observer: str | None) -> str:
    """Return what is said of one arm."""
    begun = time.perf_counter()
    found = ks.singular_find(ks.load(f"example:{name}"), frame, relative_to=observer)
    print(f"{name:<16} {len(found.families):>3} families {time.perf_counter() - begun:>6.1f} s", flush=True)
    arm, coverage = found.mechanism, found.coverage
    frames = f"`{frame}` relative to `{arm.velocity.relative_to}`"
    lines = [
        f"## {name}",
        "",
        f"{frames}: {len(arm.names)} joints, rank {arm.generic_rank} almost everywhere; "
        f"{found.converged} of {found.starts} searches converged, families seen once: {coverage.seen_once}.",
        "",
        "| name | condition | codim | kind | inside limits | why, at the witness |",
        "|---|---|---|---|---|---|",
        *(row(found, family) for family in found.families),
    ]
    return "\n".join(lines)


def main() -> None:
    """Write the page."""
    page = "\n".join([HEAD, *(f"{section(*arm)}\n" for arm in ARMS)])
    Path(__file__).with_suffix(".md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
