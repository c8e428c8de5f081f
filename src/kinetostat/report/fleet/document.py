"""What `report.json` holds, as types. SI units and radians; a number that is not known is null, and `left` says why."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import Meta, Struct

__all__ = [
    "Agreed",
    "CertificateRow",
    "ChainRow",
    "DistributionRow",
    "ExpectationRow",
    "FamilyRow",
    "FindingRow",
    "FleetDocument",
    "JointRow",
    "LeftRow",
    "PayloadRow",
    "PoseRow",
    "RobotDocument",
    "UseRow",
]


def _about(text: str, unit: str = "") -> Meta:
    """Return what is told of a key; the schema tells its unit by a keyword of its own."""
    return Meta(description=text, extra_json_schema={"unit": unit} if unit else None)


class LeftRow(Struct, frozen=True, kw_only=True):
    """Something that is not computed or not shown, and why."""

    what: Annotated[str, _about("What is missing.")]
    why: Annotated[str, _about("The reason.")]
    place: Annotated[
        str, _about("File and line of the settings, where they name a chain that the robot cannot have; else empty.")
    ] = ""


class CertificateRow(Struct, frozen=True, kw_only=True):
    """What the engines say of all numbers of a robot together."""

    engines: Annotated[tuple[str, ...], _about("Who computed: Pinocchio and our screw engine, which share no code.")]
    numbers: Annotated[int, _about("How many numbers were computed by both.")]
    answers: Annotated[int, _about("How many answers they belong to.")]
    max_difference: Annotated[
        float | None,
        _about("Largest difference in the answer that is nearest to its tolerance, in that answer's units."),
    ]
    tolerance: Annotated[float | None, _about("That answer's tolerance.")]
    answer: Annotated[str, _about("Which answer that is.")]
    agree: Annotated[
        bool | None, _about("Whether all answers are within their tolerances; null where nothing was compared.")
    ]


class Agreed(Struct, frozen=True, kw_only=True):
    """How far the three readers of the file agree."""

    readers: Annotated[tuple[str, ...], _about("Who read the file: the two engines, and yourdfpy.")]
    frames: Annotated[int, _about("How many links' frames were compared.")]
    configurations: Annotated[int, _about("At how many configurations: zero, the middle of limits, random ones.")]
    max_difference: Annotated[
        float | None, _about("Largest between the two engines, of placements (m and 1) and Jacobians (m and 1).")
    ]
    tolerance: Annotated[float, _about("What counts as agreement between the two engines.")]
    agree: Annotated[bool, _about("Whether nothing disagrees.")]
    engines_agree: Annotated[bool, _about("Whether the engines do, whatever yourdfpy says alone.")]
    disagreements: Annotated[
        tuple[str, ...], _about("The worst of each kind, in words, and which reader is the odd one out.")
    ]
    notes: Annotated[tuple[str, ...], _about("What was left out of the comparison, and why.")]


class FindingRow(Struct, frozen=True, kw_only=True):
    """What a rule of `check` found."""

    code: Annotated[str, _about("The rule's, such as J103; 'kinetostat explain J103' tells of it.")]
    name: Annotated[str, _about("The rule's.")]
    severity: Annotated[Literal["error", "warning", "info"], _about("How bad it is.")]
    message: Annotated[str, _about("What is wrong, with the values.")]
    file: Annotated[str, _about("The file, if it is not the robot's own (an SRDF); else empty.")]
    line: Annotated[int, _about("In the file, from 1; 0 for the file as a whole.")]
    element: Annotated[str, _about("The XML element; may be empty.")]
    hint: Annotated[str, _about("What to do.")]


class ExpectationRow(Struct, frozen=True, kw_only=True):
    """An expectation of the policy, judged."""

    title: Annotated[str, _about("The expectation in words.")]
    met: Annotated[bool | None, _about("Null where it could not be judged.")]
    wanted: Annotated[str, _about("What was wanted, with its unit.")]
    found: Annotated[str, _about("What is, with its unit; or why it could not be judged.")]
    place: Annotated[str, _about("File and line of the expectation.")]


class UseRow(Struct, frozen=True, kw_only=True):
    """The worst torque (or force) of a joint over all configurations that were looked at: a lower bound."""

    torque: Annotated[float, _about("Signed: what holds the joint still against weight.", "Nm, N")]
    use: Annotated[
        float | None, _about("Of the effort limit in its direction; 1 is all of it. Null without a limit.", "1")
    ]
    configuration: Annotated[
        dict[str, float], _about("Where it acts: positions of the joints that it depends on.", "rad, m")
    ]


class JointRow(Struct, frozen=True, kw_only=True):
    """A joint that moves."""

    name: Annotated[str, _about("As in the file.")]
    type: Annotated[str, _about("revolute, continuous, prismatic, planar, floating or screw.")]
    parent: Annotated[str, _about("The link that it moves another against.")]
    child: Annotated[str, _about("The link that it moves.")]
    unit: Annotated[str, _about("Of its position: rad, m, or mixed where it has several coordinates.")]
    effort_unit: Annotated[str, _about("Nm, N, or mixed.")]
    lower: Annotated[float | None, _about("Position limit; null where there is none.", "rad, m")]
    upper: Annotated[float | None, _about("Position limit; null where there is none.", "rad, m")]
    velocity: Annotated[float | None, _about("Limit; null where the file states none.", "rad/s, m/s")]
    effort: Annotated[
        float | None, _about("Limit; null where the file states none, or 0, which counts as none.", "Nm, N")
    ]
    follows: Annotated[str, _about("A follower's law, 'leader * 2 + 0.1'; empty for an independent joint.")]
    limb: Annotated[str, _about("The chain that it belongs to, by name; empty if none.")]
    gravity: Annotated[
        UseRow | None,
        _about("The worst that weight does to it; null for followers and joints with several coordinates."),
    ]
    loaded: Annotated[UseRow | None, _about("The same with the payload that was asked for, of joints of chains.")]


class DistributionRow(Struct, frozen=True, kw_only=True):
    """How a measure is distributed over configurations inside limits."""

    measure: Annotated[str, _about("yoshikawa, minimum_singular_value, inverse_condition_number or effort_use.")]
    title: Annotated[str, _about("In words.")]
    unit: Annotated[str, _about("Of all numbers here; 1 for a pure number.")]
    count: Annotated[int, _about("How many configurations have a number.")]
    mean: Annotated[float | None, _about("Null where no configuration has a number.")]
    minimum: Annotated[float | None, _about("The smallest.")]
    maximum: Annotated[float | None, _about("The largest.")]
    quantiles: Annotated[
        dict[str, float],
        _about(
            "The number that a share of all is not above, by share: '0.01', '0.05', '0.1', '0.25', '0.5', '0.75', "
            "'0.9', '0.95', '0.99'. Relative error 5e-4 at most."
        ),
    ]


class PoseRow(Struct, frozen=True, kw_only=True):
    """A limb at a named pose."""

    name: Annotated[str, _about("zero, mid (the middle of limits), or a state of the SRDF.")]
    configuration: Annotated[dict[str, float], _about("Positions of the limb's joints.", "rad, m")]
    inside: Annotated[bool, _about("Whether its joints are inside their limits.")]
    rank: Annotated[int, _about("Of the rows that count, here.")]
    dimension: Annotated[int, _about("How many rows count.")]
    yoshikawa: Annotated[float | None, _about("Product of the singular values, in the unit of its distribution.")]
    smallest_singular_value: Annotated[float | None, _about("In the chain's singular_value_unit.")]
    inverse_condition_number: Annotated[float | None, _about("Smallest over largest singular value.", "1")]
    effort_use: Annotated[
        float | None, _about("Largest gravity torque over effort limit; null where there is no limit, or no mass.", "1")
    ]


class FamilyRow(Struct, frozen=True, kw_only=True):
    """A family of singular configurations, as `singular find` tells it."""

    name: Annotated[str, _about("Shoulder, elbow, wrist, or several; empty where custom has no name.")]
    condition: Annotated[str, _about("Such as 'elbow = pi/2', rad and m; of a surface, which joints it relates.")]
    codimension: Annotated[int, _about("How many equations the condition is.")]
    kind: Annotated[str, _about("fold, boundary, traversable or tangential; several where its members differ.")]
    inside_limits: Annotated[bool, _about("Whether members inside limits were found.")]
    complete: Annotated[bool, _about("Whether it is one of those that are all found; others come from searches.")]
    tolerance: Annotated[str, _about("strict: it holds in exact numbers; model: but for the rounding of the file.")]
    hits: Annotated[int, _about("How many searches ended on it.")]
    causes: Annotated[tuple[str, ...], _about("Why, by the geometry of the axes.")]


class PayloadRow(Struct, frozen=True, kw_only=True):
    """The largest payload at the middle of limits, by effort limits alone."""

    mass: Annotated[float | None, _about("Null where no joint feels it, or none is possible.", "kg")]
    binding_joint: Annotated[str, _about("The joint that stops it; empty where none does.")]
    least: Annotated[float | None, _about("Above 0 where joints are overloaded without it.", "kg")]
    unbounded: Annotated[bool, _about("Whether no joint feels it there, so that none stops it.")]


class ChainRow(Struct, frozen=True, kw_only=True):
    """A limb of a robot: an arm, a leg, a finger."""

    id: Annotated[str, _about("Its place in the page.")]
    name: Annotated[str, _about("As the settings call it, or the SRDF group; else its frame.")]
    base: Annotated[str, _about("The link that the tool is looked at from.")]
    frame: Annotated[str, _about("The link at the chain's end: the tool.")]
    found: Annotated[
        Literal["settings", "group", "tip"],
        _about("How: named in kinetostat.toml, a group of the SRDF, or a tip of the tree."),
    ]
    joints: Annotated[tuple[str, ...], _about("The independent joints that move the tool, in path order.")]
    rows: Annotated[tuple[str, ...], _about("The rows of the twist that count: vx, vy, vz, wx, wy, wz.")]
    rank: Annotated[int | None, _about("At almost every configuration.")]
    length: Annotated[
        float | None,
        _about("The characteristic length that makes metres and radians comparable; null where it is not needed.", "m"),
    ]
    length_reference: Annotated[str, _about("How that was found.")]
    turns_only: Annotated[bool, _about("Whether its joints turn the tool but never move it along, as of some heads.")]
    singular_value_unit: Annotated[
        str, _about("Of singular values; 1 for pure numbers, mixed where metres and radians are.")
    ]
    samples: Annotated[int, _about("How many random configurations inside limits.")]
    reach: Annotated[
        float | None,
        _about(
            "Largest distance of the tool from the chain's first joint that is found inside limits: a lower bound.", "m"
        ),
    ]
    payload_at_mid: Annotated[
        PayloadRow | None, _about("The largest payload at the middle of limits; null where left says why.")
    ]
    asked_payload: Annotated[float | None, _about("What loaded uses are with.", "kg")]
    distributions: Annotated[tuple[DistributionRow, ...], _about("Of the measures over the random configurations.")]
    near: Annotated[float, _about("A configuration is near-singular with an inverse condition number below it.", "1")]
    near_singular_share: Annotated[float | None, _about("Of the random configurations, from 0 to 1.", "1")]
    worst_gravity_use: Annotated[
        float | None, _about("The largest use of an effort limit under weight among its joints: a lower bound.", "1")
    ]
    worst_gravity_joint: Annotated[str, _about("The joint that uses so much.")]
    worst_loaded_use: Annotated[float | None, _about("The same with the payload: a lower bound.", "1")]
    worst_loaded_joint: Annotated[str, _about("The joint that uses so much.")]
    poses: Annotated[tuple[PoseRow, ...], _about("Named poses.")]
    families: Annotated[tuple[FamilyRow, ...], _about("Singular configurations, those inside limits first.")]
    starts: Annotated[int, _about("Searches for singular configurations.")]
    converged: Annotated[int, _about("How many of the searches ended in one.")]
    unseen: Annotated[
        float | None,
        _about(
            "Good-Turing estimate of the chance that a further search ends on a family that is not in the list; null "
            "where no search ended in one.",
            "1",
        ),
    ]
    left: Annotated[tuple[LeftRow, ...], _about("What is not computed of the chain, and why.")]


class RobotDocument(Struct, frozen=True, kw_only=True):
    """One robot. Where status is not "done", only path, status, reason, verdict and findings tell something."""

    id: Annotated[str, _about("Its place in the page.")]
    path: Annotated[str, _about("As it was asked for.")]
    name: Annotated[str, _about("As the file says.")]
    sha256: Annotated[str, _about("Of the file's bytes; empty where it could not be read.")]
    status: Annotated[Literal["done", "unreadable", "crashed"], _about("How far it came.")]
    reason: Annotated[str, _about("Why not further; else empty.")]
    verdict: Annotated[Literal["pass", "fail", "crashed"], _about("Of `check`.")]
    links: Annotated[int, _about("How many.")]
    degrees_of_freedom: Annotated[int, _about("Of the independent joints.")]
    mass: Annotated[float | None, _about("Of all links; null where the file states no mass.", "kg")]
    reach: Annotated[float | None, _about("Longest path from the root to a link, stretched out.", "m")]
    tips: Annotated[int, _about("Links without children.")]
    chains: Annotated[tuple[ChainRow, ...], _about("Its limbs.")]
    joints: Annotated[tuple[JointRow, ...], _about("All that move, in file order.")]
    findings: Annotated[tuple[FindingRow, ...], _about("Of the rules of check.")]
    expectations: Annotated[tuple[ExpectationRow, ...], _about("Of the policy, judged.")]
    agreement: Annotated[
        Agreed | None, _about("How far the readers of the file agree; null where they were not compared.")
    ]
    certificate: Annotated[CertificateRow | None, _about("What the engines say of all its numbers together.")]
    left: Annotated[tuple[LeftRow, ...], _about("What is not computed or not shown of the robot, and why.")]


class FleetDocument(Struct, frozen=True, kw_only=True):
    """The report as a whole."""

    schema: Annotated[Literal["kinetostat/report/1"], _about("What this file is, and its version.")] = (
        "kinetostat/report/1"
    )
    made: Annotated[str, _about("When, UTC: the one thing that differs between two runs. SOURCE_DATE_EPOCH sets it.")]
    version: Annotated[str, _about("Of kinetostat.")]
    samples: Annotated[int, _about("Random configurations of each chain.")]
    seed: Annotated[int, _about("Of all random numbers.")]
    payload: Annotated[
        float | None, _about("Asked of every chain that the settings say nothing of; null for none.", "kg")
    ]
    robots: Annotated[tuple[RobotDocument, ...], _about("In the order in which they were asked for.")]
