"""Kinetostatics of URDF robots, every number computed twice: by Pinocchio, and by screw theory.

    import kinetostat as ks

    panda = ks.load("example:panda")
    q = ks.configuration(panda, "random:1").q
    result = ks.jacobian(panda, "panda_hand", q, reference="local")
    result.matrix, result.columns, result.certificate.max_difference

Six-vectors have their linear part first, lengths are metres, angles radians. Everything named in `__all__` is public;
nothing else is. Names are imported when first used, so that a query waits only for what it needs.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetostat.analysis.accuracy import ErrorPart, ToolError, tool_error
    from kinetostat.analysis.agreement import Agreement, Disagreement, agreement
    from kinetostat.analysis.approach import SingularApproach, singular_approach
    from kinetostat.analysis.capability.capability_map import CapabilityMap, capability_map
    from kinetostat.analysis.capability.placing import BasePlacement, PlacementMap, ProvedPlacement, base_placement
    from kinetostat.analysis.capacity import ForcePolytope, Strongest, force_polytope, strongest
    from kinetostat.analysis.configuration import Configuration, configuration, random_configurations
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.difference.difference import Difference, difference
    from kinetostat.analysis.euler import EulerSequence
    from kinetostat.analysis.inverse.ik import InverseKinematics, Solutions, ik, ik_all
    from kinetostat.analysis.inverse.pose import Pose, pose
    from kinetostat.analysis.jacobian import Jacobian, jacobian
    from kinetostat.analysis.joint_errors import joint_errors
    from kinetostat.analysis.joint_values import joint_rates
    from kinetostat.analysis.kinematics import FrameChange, Placement, adjoint, fk
    from kinetostat.analysis.loads import EffortLimits, Payload, load_at
    from kinetostat.analysis.manipulability import Block, Ellipsoid, Manipulability, Transmission, manipulability
    from kinetostat.analysis.profile.anatomy import Anatomy, ChosenChain, Limb
    from kinetostat.analysis.profile.limbs import limbs
    from kinetostat.analysis.profile.profiling import profile
    from kinetostat.analysis.profile.result import LimbPose, LimbProfile, RobotProfile
    from kinetostat.analysis.rates import ResolvedRates, resolved_rates
    from kinetostat.analysis.resolution import JointResolution, Requirement, joint_resolution
    from kinetostat.analysis.singular.at import SingularAt, singular_at
    from kinetostat.analysis.singular.find import Family, SingularFamilies, singular_find
    from kinetostat.analysis.statics import Reactions, Torques, reactions, torque
    from kinetostat.analysis.summary import Chain, Summary, summary
    from kinetostat.analysis.sweeping.cluster import cluster
    from kinetostat.analysis.sweeping.sweep import Distribution, Extreme, RowBlock, Sweep, sweep
    from kinetostat.analysis.trajectory.trajectory import Trajectory, trajectory
    from kinetostat.analysis.velocity import FrameMotions, InstantaneousScrew, velocity
    from kinetostat.analysis.worst import WorstTorques, worst_torques
    from kinetostat.conventions import Load, Order, Reference, Velocity, WrenchOrTwist
    from kinetostat.engines.model import Model, load
    from kinetostat.errors import (
        AmbiguousNameError,
        ConfigurationError,
        DisagreementError,
        EngineError,
        KinetostatError,
        LimitError,
        NumberError,
        RepresentationError,
        RobotError,
        SourceError,
        StructureError,
        UnknownNameError,
        UsageError,
        XmlError,
    )
    from kinetostat.gate.check import check
    from kinetostat.gate.result import CheckReport, FileCheck, Verdict
    from kinetostat.lint.finding import Finding, Severity
    from kinetostat.policy.outcome import Outcome
    from kinetostat.policy.settings import Settings, find_settings, read_settings
    from kinetostat.report.fleet.fleet import Fleet, fleet
    from kinetostat.urdf.description import Joint, JointType, Link, Robot

__version__ = "0.1.0"

_HOMES = {
    "analysis.accuracy": ("ErrorPart", "ToolError", "tool_error"),
    "analysis.agreement": ("Agreement", "Disagreement", "agreement"),
    "analysis.approach": ("SingularApproach", "singular_approach"),
    "analysis.capability.capability_map": ("CapabilityMap", "capability_map"),
    "analysis.capability.placing": ("BasePlacement", "PlacementMap", "ProvedPlacement", "base_placement"),
    "analysis.capacity": ("ForcePolytope", "Strongest", "force_polytope", "strongest"),
    "analysis.configuration": ("Configuration", "configuration", "random_configurations"),
    "analysis.crosscheck": ("Certificate",),
    "analysis.difference.difference": ("Difference", "difference"),
    "analysis.euler": ("EulerSequence",),
    "analysis.inverse.ik": ("InverseKinematics", "Solutions", "ik", "ik_all"),
    "analysis.inverse.pose": ("Pose", "pose"),
    "analysis.jacobian": ("Jacobian", "jacobian"),
    "analysis.joint_errors": ("joint_errors",),
    "analysis.joint_values": ("joint_rates",),
    "analysis.kinematics": ("FrameChange", "Placement", "adjoint", "fk"),
    "analysis.loads": ("EffortLimits", "Payload", "load_at"),
    "analysis.manipulability": ("Block", "Ellipsoid", "Manipulability", "Transmission", "manipulability"),
    "analysis.profile.anatomy": ("Anatomy", "ChosenChain", "Limb"),
    "analysis.profile.limbs": ("limbs",),
    "analysis.profile.profiling": ("profile",),
    "analysis.profile.result": ("LimbPose", "LimbProfile", "RobotProfile"),
    "analysis.rates": ("ResolvedRates", "resolved_rates"),
    "analysis.resolution": ("JointResolution", "Requirement", "joint_resolution"),
    "analysis.singular.at": ("SingularAt", "singular_at"),
    "analysis.singular.find": ("Family", "SingularFamilies", "singular_find"),
    "analysis.statics": ("Reactions", "Torques", "reactions", "torque"),
    "analysis.summary": ("Chain", "Summary", "summary"),
    "analysis.sweeping.cluster": ("cluster",),
    "analysis.sweeping.sweep": ("Distribution", "Extreme", "RowBlock", "Sweep", "sweep"),
    "analysis.trajectory.trajectory": ("Trajectory", "trajectory"),
    "analysis.velocity": ("FrameMotions", "InstantaneousScrew", "velocity"),
    "analysis.worst": ("WorstTorques", "worst_torques"),
    "conventions": ("Load", "Order", "Reference", "Velocity", "WrenchOrTwist"),
    "engines.model": ("Model", "load"),
    "gate.check": ("check",),
    "gate.result": ("CheckReport", "FileCheck", "Verdict"),
    "lint.finding": ("Finding", "Severity"),
    "policy.outcome": ("Outcome",),
    "policy.settings": ("Settings", "find_settings", "read_settings"),
    "report.fleet.fleet": ("Fleet", "fleet"),
    "urdf.description": ("Joint", "JointType", "Link", "Robot"),
}

__all__ = [
    "Agreement",
    "AmbiguousNameError",
    "Anatomy",
    "BasePlacement",
    "Block",
    "CapabilityMap",
    "Certificate",
    "Chain",
    "CheckReport",
    "ChosenChain",
    "Configuration",
    "ConfigurationError",
    "Difference",
    "Disagreement",
    "DisagreementError",
    "Distribution",
    "EffortLimits",
    "Ellipsoid",
    "EngineError",
    "ErrorPart",
    "EulerSequence",
    "Extreme",
    "Family",
    "FileCheck",
    "Finding",
    "Fleet",
    "ForcePolytope",
    "FrameChange",
    "FrameMotions",
    "InstantaneousScrew",
    "InverseKinematics",
    "Jacobian",
    "Joint",
    "JointResolution",
    "JointType",
    "KinetostatError",
    "Limb",
    "LimbPose",
    "LimbProfile",
    "LimitError",
    "Link",
    "Load",
    "Manipulability",
    "Model",
    "NumberError",
    "Order",
    "Outcome",
    "Payload",
    "Placement",
    "PlacementMap",
    "Pose",
    "ProvedPlacement",
    "Reactions",
    "Reference",
    "RepresentationError",
    "Requirement",
    "ResolvedRates",
    "Robot",
    "RobotError",
    "RobotProfile",
    "RowBlock",
    "Settings",
    "Severity",
    "SingularApproach",
    "SingularAt",
    "SingularFamilies",
    "Solutions",
    "SourceError",
    "Strongest",
    "StructureError",
    "Summary",
    "Sweep",
    "ToolError",
    "Torques",
    "Trajectory",
    "Transmission",
    "UnknownNameError",
    "UsageError",
    "Velocity",
    "Verdict",
    "WorstTorques",
    "WrenchOrTwist",
    "XmlError",
    "adjoint",
    "agreement",
    "base_placement",
    "capability_map",
    "check",
    "cluster",
    "configuration",
    "difference",
    "find_settings",
    "fk",
    "fleet",
    "force_polytope",
    "ik",
    "ik_all",
    "jacobian",
    "joint_errors",
    "joint_rates",
    "joint_resolution",
    "limbs",
    "load",
    "load_at",
    "manipulability",
    "pose",
    "profile",
    "random_configurations",
    "reactions",
    "read_settings",
    "resolved_rates",
    "singular_approach",
    "singular_at",
    "singular_find",
    "strongest",
    "summary",
    "sweep",
    "tool_error",
    "torque",
    "trajectory",
    "velocity",
    "worst_torques",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'kinetostat' has no attribute {name!r}")
    home = next((module for module, names in _HOMES.items() if name in names), "errors")
    value = getattr(import_module(f"kinetostat.{home}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
