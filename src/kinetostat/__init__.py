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
    from kinetostat.analysis.configuration import Configuration, configuration, random_configurations
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.euler import EulerSequence
    from kinetostat.analysis.jacobian import Jacobian, jacobian
    from kinetostat.analysis.joint_values import joint_rates
    from kinetostat.analysis.kinematics import FrameChange, Placement, adjoint, fk
    from kinetostat.analysis.manipulability import Block, Ellipsoid, Manipulability, Transmission, manipulability
    from kinetostat.analysis.singular.at import SingularAt, singular_at
    from kinetostat.analysis.singular.find import Family, SingularFamilies, singular_find
    from kinetostat.analysis.summary import Chain, Summary, summary
    from kinetostat.conventions import Order, Reference, Velocity, WrenchOrTwist
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
    from kinetostat.urdf.description import Joint, JointType, Link, Robot

__version__ = "0.1.0"

_HOMES = {
    "analysis.configuration": ("Configuration", "configuration", "random_configurations"),
    "analysis.crosscheck": ("Certificate",),
    "analysis.euler": ("EulerSequence",),
    "analysis.jacobian": ("Jacobian", "jacobian"),
    "analysis.joint_values": ("joint_rates",),
    "analysis.kinematics": ("FrameChange", "Placement", "adjoint", "fk"),
    "analysis.manipulability": ("Block", "Ellipsoid", "Manipulability", "Transmission", "manipulability"),
    "analysis.singular.at": ("SingularAt", "singular_at"),
    "analysis.singular.find": ("Family", "SingularFamilies", "singular_find"),
    "analysis.summary": ("Chain", "Summary", "summary"),
    "conventions": ("Order", "Reference", "Velocity", "WrenchOrTwist"),
    "engines.model": ("Model", "load"),
    "urdf.description": ("Joint", "JointType", "Link", "Robot"),
}

__all__ = [
    "AmbiguousNameError",
    "Block",
    "Certificate",
    "Chain",
    "Configuration",
    "ConfigurationError",
    "DisagreementError",
    "Ellipsoid",
    "EngineError",
    "EulerSequence",
    "Family",
    "FrameChange",
    "Jacobian",
    "Joint",
    "JointType",
    "KinetostatError",
    "LimitError",
    "Link",
    "Manipulability",
    "Model",
    "NumberError",
    "Order",
    "Placement",
    "Reference",
    "RepresentationError",
    "Robot",
    "RobotError",
    "SingularAt",
    "SingularFamilies",
    "SourceError",
    "StructureError",
    "Summary",
    "Transmission",
    "UnknownNameError",
    "UsageError",
    "Velocity",
    "WrenchOrTwist",
    "XmlError",
    "adjoint",
    "configuration",
    "fk",
    "jacobian",
    "joint_rates",
    "load",
    "manipulability",
    "random_configurations",
    "singular_at",
    "singular_find",
    "summary",
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
