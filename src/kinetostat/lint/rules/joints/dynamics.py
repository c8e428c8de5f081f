"""J401 to J406: safety controller, damping and friction, calibration."""

from __future__ import annotations

from collections.abc import Iterator

from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.grouping import Found, grouped
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.rules.joints.common import kind, moves, span, unit
from kinetostat.lint.subject import Subject, first, name_of, number
from kinetostat.urdf.document import Element

__all__ = ["DYNAMICS"]

_SLACK = 0.01  # of the joint's range: limits are written with few digits


def _joint(*lines: str) -> Example:
    """Return an arm with further elements in its joint."""
    head = """
        <link name="base"/>
        <link name="arm"/>
        <joint name="shoulder" type="revolute">
          <parent link="base"/><child link="arm"/>
          <axis xyz="0 0 1"/>
          <limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>"""
    return Example("\n".join([head, *(f"          {line}" for line in lines), "        </joint>"]))


class SafetyWithoutVelocity(Rule):
    """A safety controller has no k_velocity.

    The attribute is required: urdfdom, and with it ROS, MoveIt and Pinocchio, refuses the whole file, even if the joint
    is fixed.
    """

    code = "J401"
    name = "safety-without-k-velocity"
    severity = Severity.ERROR
    hint = 'write k_velocity="..." (Nms/rad or Ns/m), or remove the <safety_controller>'
    bad = _joint('<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="20"/> <!-- J401 -->')
    good = _joint('<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="20" k_velocity="5"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the safety controllers without k_velocity."""
        found = []
        for joint in subject.joints:
            safety = first(joint, "safety_controller")
            if safety is not None and "k_velocity" not in safety.attributes and joint.tag == "joint":
                found.append(Found(safety, name_of(joint), "the safety controller has no k_velocity"))
        yield from grouped(self, found, what="joint")


class SoftLimits(Rule):
    """The soft limits of a safety controller leave no range, or lie outside the limits.

    The controller slows the joint down before a soft limit. Outside the limits it comes too late; a soft limit that is
    absent counts as 0, and two that are equal or reversed let the joint not move.
    """

    code = "J402"
    name = "soft-limits-inconsistent"
    severity = Severity.WARNING
    hint = "put the soft limits inside the limits, lower below upper"
    bad = _joint(
        '<safety_controller soft_lower_limit="-2" soft_upper_limit="1" k_position="20" k_velocity="5"/> <!-- J402 -->'
    )
    good = _joint('<safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="20" k_velocity="5"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the soft limits that contradict each other or the limits."""
        found = []
        for joint in subject.joints:
            safety, limits = first(joint, "safety_controller"), span(joint)
            if safety is None or limits is None or not _limits_position(safety):
                continue
            # What does not parse is another rule's.
            lower = number(safety, "soft_lower_limit") if "soft_lower_limit" in safety.attributes else 0.0
            upper = number(safety, "soft_upper_limit") if "soft_upper_limit" in safety.attributes else 0.0
            if lower is None or upper is None:
                continue
            wrong = _contradiction((lower, upper), limits)
            if wrong:
                found.append(Found(safety, name_of(joint), f"{wrong} {unit(joint)}", "soft_lower_limit"))
        yield from grouped(self, found, what="joint")


def _limits_position(safety: Element) -> bool:
    """Return whether a safety controller bounds the position: with a gain, and limits that are not all left at 0."""
    given = [number(safety, key) for key in ("soft_lower_limit", "soft_upper_limit") if key in safety.attributes]
    gain = number(safety, "k_position")
    return bool(gain) or (any(given) and "k_position" not in safety.attributes)


def _contradiction(soft: tuple[float, float], limits: tuple[float, float]) -> str:
    """Return what is wrong with soft limits; empty if nothing is."""
    shown = f"[{soft[0]:.6g}, {soft[1]:.6g}]"
    if soft[0] >= soft[1]:
        return f"the soft limits leave no range: {shown}"
    slack = _SLACK * (limits[1] - limits[0])
    if soft[0] < limits[0] - slack or soft[1] > limits[1] + slack:
        return f"the soft limits {shown} reach beyond the limits [{limits[0]:.6g}, {limits[1]:.6g}]"
    return ""


class NegativeDamping(Rule):
    """Damping or friction is negative.

    Such a joint feeds energy into the robot: the simulation runs away, or the tool refuses the file (Drake does, and
    Gazebo's DART fails on it). It is mostly a sign that slipped in.
    """

    code = "J403"
    name = "damping-negative"
    severity = Severity.WARNING
    hint = "write the magnitude, without the sign"
    bad = _joint('<dynamics damping="-0.5" friction="0"/> <!-- J403 -->')
    good = _joint('<dynamics damping="0.5" friction="0"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the negative dampings and frictions of joints that move."""
        found = []
        for joint in filter(moves, subject.joints):
            dynamics = first(joint, "dynamics")
            for key in ("damping", "friction"):
                value = number(dynamics, key)
                if dynamics is not None and value is not None and value < 0:
                    found.append(Found(dynamics, name_of(joint), f"{key} {value:g} is negative", key))
        yield from grouped(self, found, what="joint")


class EmptyCalibration(Rule):
    """A calibration says nothing.

    A `<calibration>` names the position at which a reference edge rises or falls. Without either nothing can be
    calibrated; readers take it as absent.
    """

    code = "J404"
    name = "calibration-empty"
    severity = Severity.WARNING
    hint = 'write rising="..." or falling="...", or remove the <calibration>'
    bad = _joint("<calibration/> <!-- J404 -->")
    good = _joint('<calibration rising="0"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each `<calibration>` without a position."""
        found = []
        for joint in subject.joints:
            calibration = first(joint, "calibration")
            known = {"rising", "falling", "reference_position"}
            if calibration is not None and not known & set(calibration.attributes):
                found.append(Found(calibration, name_of(joint), "<calibration> with neither rising nor falling"))
        yield from grouped(self, found, what="joint")


class TwoEdges(Rule):
    """A joint with stops has a rising and a falling edge.

    Only a continuous joint passes a reference switch on both sides; calibration controllers, such as that of the PR2,
    refuse both edges on any other.
    """

    code = "J405"
    name = "calibration-two-edges"
    severity = Severity.INFO
    hint = "keep the edge that the joint is calibrated with"
    bad = _joint('<calibration rising="-0.1" falling="0.1"/> <!-- J405 -->')
    good = _joint('<calibration rising="-0.1"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the calibrations of joints with stops that have both edges."""
        found = []
        for joint in subject.joints:
            calibration = first(joint, "calibration")
            rising, falling = number(calibration, "rising"), number(calibration, "falling")
            if calibration is not None and span(joint) and rising is not None and falling is not None:
                message = f"rising {rising:g} and falling {falling:g} are both given on a {kind(joint)} joint"
                found.append(Found(calibration, name_of(joint), message, "falling"))
        yield from grouped(self, found, what="joint")


class CalibrationOutsideLimits(Rule):
    """A joint is calibrated at a position that it cannot reach.

    The reference edge lies outside the limits, so the joint runs into its stop in search of it. Mostly the limits were
    changed and the calibration was forgotten, or one of the two is in degrees.
    """

    code = "J406"
    name = "calibration-outside-limits"
    severity = Severity.WARNING
    hint = "correct the position of the edge, or the limits"
    bad = _joint('<calibration rising="2.5"/> <!-- J406 -->')
    good = _joint('<calibration rising="1.2"/>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the calibrations outside the limits."""
        found = []
        for joint in subject.joints:
            calibration, limits = first(joint, "calibration"), span(joint)
            for key in ("rising", "falling"):
                edge = number(calibration, key)
                if calibration is None or limits is None or edge is None:
                    continue
                slack = _SLACK * (limits[1] - limits[0])
                if not limits[0] - slack <= edge <= limits[1] + slack:
                    message = f"{key} {edge:g} is outside the limits [{limits[0]:.6g}, {limits[1]:.6g}] {unit(joint)}"
                    found.append(Found(calibration, name_of(joint), message, key))
        yield from grouped(self, found, what="joint")


DYNAMICS: tuple[Rule, ...] = (
    SafetyWithoutVelocity(),
    SoftLimits(),
    NegativeDamping(),
    EmptyCalibration(),
    TwoEdges(),
    CalibrationOutsideLimits(),
)
"""The rules, in the order of their codes."""
