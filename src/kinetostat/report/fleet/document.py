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


def _about(text: str) -> Meta:
    return Meta(description=text)


class LeftRow(Struct, frozen=True, kw_only=True):
    """Something that is not computed or not shown, and why."""

    what: str
    why: str


class CertificateRow(Struct, frozen=True, kw_only=True):
    """What the engines say of all numbers of a robot together."""

    engines: tuple[str, ...]
    numbers: Annotated[int, _about("How many numbers were computed by both.")]
    answers: Annotated[int, _about("How many answers they belong to.")]
    max_difference: Annotated[float | None, _about("Largest difference, of the answer nearest to its tolerance.")]
    tolerance: Annotated[float | None, _about("That answer's tolerance.")]
    answer: Annotated[str, _about("Which answer that is.")]
    agree: Annotated[bool | None, _about("Null where nothing was compared.")]


class Agreed(Struct, frozen=True, kw_only=True):
    """How far the three readers of the file agree."""

    readers: tuple[str, ...]
    frames: int
    configurations: int
    max_difference: Annotated[float | None, _about("Between the two engines, m and 1.")]
    tolerance: float
    agree: bool
    engines_agree: bool
    disagreements: tuple[str, ...]
    notes: tuple[str, ...]


class FindingRow(Struct, frozen=True, kw_only=True):
    """What a rule of `check` found."""

    code: str
    name: str
    severity: Literal["error", "warning", "info"]
    message: str
    file: Annotated[str, _about("Empty for the robot's own file.")]
    line: Annotated[int, _about("0 for the file as a whole.")]
    element: str
    hint: str


class ExpectationRow(Struct, frozen=True, kw_only=True):
    """An expectation of the policy, judged."""

    title: str
    met: Annotated[bool | None, _about("Null where it could not be judged.")]
    wanted: str
    found: str
    place: str


class UseRow(Struct, frozen=True, kw_only=True):
    """The worst torque (or force) of a joint over all configurations that were looked at: a lower bound."""

    torque: Annotated[float, _about("Signed, Nm or N.")]
    use: Annotated[float | None, _about("Of the effort limit in its direction; 1 is all. Null without a limit.")]
    configuration: Annotated[dict[str, float], _about("Where.")]


class JointRow(Struct, frozen=True, kw_only=True):
    """A joint that moves."""

    name: str
    type: str
    parent: str
    child: str
    unit: Annotated[str, _about("Of its position: rad, m, or mixed.")]
    effort_unit: Annotated[str, _about("Nm, N, or mixed.")]
    lower: float | None
    upper: float | None
    velocity: Annotated[float | None, _about("Limit, rad/s or m/s.")]
    effort: Annotated[float | None, _about("Limit, Nm or N.")]
    follows: Annotated[str, _about("The joint that it follows, as a law: 'leader * 1 + 0'; empty if independent.")]
    limb: Annotated[str, _about("The limb that it belongs to; empty if none.")]
    gravity: UseRow | None
    loaded: Annotated[UseRow | None, _about("The same with the payload that was asked for.")]


class DistributionRow(Struct, frozen=True, kw_only=True):
    """How a measure is distributed over configurations inside limits."""

    measure: str
    title: Annotated[str, _about("In words.")]
    unit: str
    count: int
    mean: float | None
    minimum: float | None
    maximum: float | None
    quantiles: Annotated[dict[str, float], _about("By share: '0.01', '0.05', '0.1', '0.25', '0.5', '0.75', ...")]


class PoseRow(Struct, frozen=True, kw_only=True):
    """A limb at a named pose."""

    name: str
    configuration: Annotated[dict[str, float], _about("Of the limb's joints.")]
    inside: Annotated[bool, _about("Whether its joints are inside their limits.")]
    rank: int
    dimension: int
    yoshikawa: float | None
    smallest_singular_value: float | None
    inverse_condition_number: float | None
    effort_use: float | None


class FamilyRow(Struct, frozen=True, kw_only=True):
    """A family of singular configurations, as `singular find` tells it."""

    name: Annotated[str, _about("Shoulder, elbow, wrist, or several; empty where custom has no name.")]
    condition: str
    codimension: int
    kind: str
    inside_limits: bool
    complete: bool
    tolerance: str
    hits: int
    causes: tuple[str, ...]


class PayloadRow(Struct, frozen=True, kw_only=True):
    """The largest payload at the middle of limits, by effort limits alone."""

    mass: Annotated[float | None, _about("kg; null where no joint feels it, or none is possible.")]
    binding_joint: str
    least: Annotated[float | None, _about("kg: above 0 where the joints are overloaded without it.")]


class ChainRow(Struct, frozen=True, kw_only=True):
    """A limb of a robot: an arm, a leg, a finger."""

    id: Annotated[str, _about("Its place in the page.")]
    name: str
    base: str
    frame: str
    found: Literal["settings", "group", "tip"]
    joints: tuple[str, ...]
    rows: Annotated[tuple[str, ...], _about("The rows of the twist that count.")]
    rank: Annotated[int | None, _about("At almost every configuration.")]
    length: Annotated[float | None, _about("The characteristic length that makes m and rad comparable, m.")]
    length_reference: str
    singular_value_unit: str
    samples: int
    reach: Annotated[float | None, _about("Largest distance of the tool from the first joint that is found, m.")]
    payload_at_mid: PayloadRow | None
    asked_payload: Annotated[float | None, _about("kg that `loaded` is with.")]
    distributions: tuple[DistributionRow, ...]
    near: Annotated[float, _about("Near-singular: smallest over largest singular value below it.")]
    near_singular_share: float | None
    worst_gravity_use: float | None
    worst_gravity_joint: str
    worst_loaded_use: float | None
    worst_loaded_joint: str
    poses: tuple[PoseRow, ...]
    families: tuple[FamilyRow, ...]
    starts: Annotated[int, _about("Searches for singular configurations.")]
    converged: int
    unseen: Annotated[float | None, _about("Good-Turing estimate of what the searches have missed.")]
    left: tuple[LeftRow, ...]


class RobotDocument(Struct, frozen=True, kw_only=True):
    """One robot. Where `status` is not "done", only path, status and reason (and findings) tell something."""

    id: Annotated[str, _about("Its place in the page.")]
    path: Annotated[str, _about("As it was asked for.")]
    name: str
    sha256: Annotated[str, _about("Of the file's bytes; empty where it could not be read.")]
    status: Literal["done", "unreadable", "crashed"]
    reason: str
    verdict: Annotated[Literal["pass", "fail", "crashed"], _about("Of `check`.")]
    links: int
    degrees_of_freedom: Annotated[int, _about("Of the independent joints.")]
    mass: Annotated[float | None, _about("kg, of all links.")]
    reach: Annotated[float | None, _about("Longest path from the root, stretched out, m.")]
    tips: int
    chains: tuple[ChainRow, ...]
    joints: tuple[JointRow, ...]
    findings: tuple[FindingRow, ...]
    expectations: tuple[ExpectationRow, ...]
    agreement: Agreed | None
    certificate: CertificateRow | None
    left: tuple[LeftRow, ...]


class FleetDocument(Struct, frozen=True, kw_only=True):
    """The report: `kinetostat/report/1`."""

    schema: Literal["kinetostat/report/1"] = "kinetostat/report/1"
    made: Annotated[str, _about("When, UTC: the one thing that differs between two runs. SOURCE_DATE_EPOCH sets it.")]
    version: Annotated[str, _about("Of kinetostat.")]
    samples: Annotated[int, _about("Random configurations of each chain.")]
    seed: int
    payload: Annotated[float | None, _about("kg, asked of every chain that the settings say nothing of.")]
    robots: tuple[RobotDocument, ...]
