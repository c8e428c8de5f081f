"""Results to JSON: one object with stable keys, numbers in full precision, SI units, no NaN."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinetostat.conventions import Array, Order
from kinetostat.urdf.description import Joint, Robot
from kinetostat.urdf.files import short_names

if TYPE_CHECKING:
    from kinetostat.analysis.configuration import Configuration
    from kinetostat.analysis.crosscheck import Certificate
    from kinetostat.analysis.jacobian import Jacobian
    from kinetostat.analysis.kinematics import FrameChange, Placement
    from kinetostat.analysis.summary import Summary
    from kinetostat.engines.model import Model
    from kinetostat.lint.finding import Finding

__all__ = [
    "adjoint_result",
    "closing",
    "envelope",
    "fk_result",
    "frames_result",
    "info_result",
    "jacobian_result",
    "nested",
    "number",
    "opening",
    "render",
    "robots_result",
]

Json = dict[str, Any]


def render(payload: Mapping[str, Any]) -> str:
    """Return the object as text, a matrix row to a line."""
    return _text(payload, "") + "\n"


def envelope(
    command: str,
    result: Any,
    *,
    model: Model | None = None,
    at: Configuration | None = None,
    certificate: Certificate | None = None,
    warnings: tuple[str, ...] = (),
) -> Json:
    """Return what every command's JSON has in common, around its result."""
    payload = opening(command, model)
    if at is not None:
        payload["configuration"] = at.by_joint()
    return payload | {"result": result} | closing(certificate, warnings)


def opening(command: str, model: Model | None) -> Json:
    """Return what comes before a result: the schema, and which robot."""
    payload: Json = {"schema": f"kinetostat/{command}/1"}
    if model is not None:
        source = model.loaded.source
        payload["robot"] = {"name": model.robot.name, "source": source.name, "sha256": source.sha256}
    return payload


def closing(certificate: Certificate | None, warnings: tuple[str, ...]) -> Json:
    """Return what comes after a result: the certificate, and the warnings."""
    payload: Json = {}
    if certificate is not None:
        payload["crosscheck"] = {
            "engines": list(certificate.engines),
            "max_difference": number(certificate.max_difference),
            "tolerance": certificate.tolerance,
            "agree": certificate.agree,
        }
        if certificate.values:
            named = zip(certificate.engines, certificate.values, strict=True)
            payload["crosscheck"]["values"] = {engine: nested(value) for engine, value in named}
        if certificate.max_difference is None:
            payload["crosscheck"]["reason"] = "left out by --no-crosscheck"
    return payload | {"warnings": list(warnings)}


def fk_result(result: Placement) -> Json:
    """Return the result object of `fk`: lengths in m, angles in rad."""
    return {
        "frame": result.frame,
        "relative_to": result.relative_to,
        "position": nested(result.position),
        "quaternion_xyzw": nested(result.quaternion_xyzw),
        "rpy": nested(result.rpy),
        "matrix": nested(result.matrix),
    }


def jacobian_result(result: Jacobian, order: Order) -> Json:
    """Return the result object of `jacobian`; rows in the given order."""
    velocity, rows = result.velocity, order.rows
    payload: Json = {
        "frame": velocity.of,
        "relative_to": velocity.relative_to,
        "reference": result.reference.value,
        "expressed_in": velocity.expressed_in,
        "point": None if velocity.point is None else list(velocity.point),
        "order": order.value,
        "rows": [result.rows[i] for i in rows],
        "row_units": [result.row_units[i] for i in rows],
        "columns": list(result.columns),
        "column_units": list(result.column_units),
        "matrix": nested(result.matrix[..., rows, :]),
    }
    if velocity.point is None:
        payload["point_reason"] = "reference world: the point of the frame at the observer's origin"
    if result.rates is not None:
        values = None if result.angles is None else nested(result.angles)
        payload["rates"] = {
            "sequence": result.rates.reading,
            "angles": list(result.rates.angle_names),
            "values": values,
        }
    if result.time_derivative is not None:
        payload["time_derivative"] = nested(result.time_derivative[..., rows, :])
    return payload


def adjoint_result(result: FrameChange, given: Array | None, applied: Array | None, order: Order) -> Json:
    """Return the result object of `adjoint`; rows, columns and six-vectors in the given order."""
    rows = order.rows
    return {
        "from": result.start,
        "to": result.end,
        "kind": result.kind.value,
        "order": order.value,
        "rows": [result.kind.rows[i] for i in rows],
        "row_units": [result.kind.units[i] for i in rows],
        "matrix": nested(result.matrix[..., rows, :][..., rows]),
        "given": None if given is None else nested(given[..., rows]),
        "applied": None if applied is None else nested(applied[..., rows]),
    }


def frames_result(robot: Robot) -> Json:
    """Return the result object of `frames`."""
    frames = []
    for link in robot.links:
        joint = robot.parent_joint.get(link.name)
        above = (
            {"parent": None, "joint": None, "type": None}
            if joint is None
            else {"parent": joint.parent, "joint": joint.name, "type": joint.type.value}
        )
        frames.append({"frame": link.name, **above, "line": link.line})
    return {"root": robot.root, "frames": frames}


def info_result(result: Summary, odd: Sequence[Finding]) -> Json:
    """Return the result object of `info`; `odd` is what is odd about the file."""
    robot = result.robot
    return {
        "root": robot.root,
        "degrees_of_freedom": robot.nv,
        "links": [
            {"name": link.name, "line": link.line, "mass": None if link.inertial is None else link.inertial.mass}
            for link in robot.links
        ],
        "joints": [_joint(joint) for joint in robot.joints],
        "chains": [{"tip": chain.tip, "joints": list(chain.joints)} for chain in result.chains],
        "mass": {
            "total": result.base_mass + result.moving_mass,
            "base_link": result.base_mass,
            "without_base_link": result.moving_mass,
        },
        "reach": result.reach,
        "groups": {name: list(joints) for name, joints in result.groups.items()},
        "states": list(result.states),
        "remarks": [
            {
                "code": finding.code,
                "severity": finding.severity.value,
                "line": finding.line or None,
                "element": finding.element,
                "message": finding.message,
                "hint": finding.hint,
            }
            for finding in odd
        ],
    }


def robots_result(textbook: Mapping[str, Path], example: Mapping[str, Path]) -> Json:
    """Return the result object of `robots`."""
    return {
        "textbook": [f"textbook:{name}" for name in textbook],
        "example": [f"example:{name}" for name in short_names(dict(example))],
    }


def _joint(joint: Joint) -> Json:
    lower, upper = map(number, joint.limit.range) if joint.type.nq == 1 else (None, None)
    unit = None if joint.type.nq != 1 else "rad" if joint.type.is_angle else "m"
    payload: Json = {
        "name": joint.name,
        "type": joint.type.value,
        "parent": joint.parent,
        "child": joint.child,
        "origin": {"xyz": list(joint.origin.xyz), "rpy": list(joint.origin.rpy)},
        "axis": list(joint.axis) if joint.type.nq in (1, 3) else None,
        "limits": {
            "lower": lower,
            "upper": upper,
            "unit": unit,
            "effort": number(joint.limit.effort),
            "velocity": number(joint.limit.velocity),
        },
        "mimic": None
        if joint.mimic is None
        else {"joint": joint.mimic.joint, "multiplier": joint.mimic.multiplier, "offset": joint.mimic.offset},
        "line": joint.line or None,
    }
    if joint.origin.quaternion_xyzw is not None:
        payload["origin"] = {"xyz": list(joint.origin.xyz), "quaternion_xyzw": list(joint.origin.quaternion_xyzw)}
    if joint.pitch:
        payload["pitch"] = joint.pitch
    return payload


def number(value: float | None) -> float | None:
    """Return a finite number, None for any other."""
    return value if value is not None and math.isfinite(value) else None


def nested(array: Array) -> Any:
    """Return nested lists of numbers; -0.0 becomes 0.0, what is not finite becomes None."""
    if array.ndim == 0:
        return number(float(array) + 0.0)
    return [nested(part) for part in array]


def _text(value: Any, indent: str) -> str:
    """Return JSON text: objects and lists of objects spread over lines, lists of numbers and words on one."""
    import json  # where it is used: tables, which people wait for, are written without it

    inner = indent + "  "
    if isinstance(value, Mapping) and value:
        items = ",\n".join(
            f"{inner}{json.dumps(str(key), ensure_ascii=False)}: {_text(part, inner)}" for key, part in value.items()
        )
        return f"{{\n{items}\n{indent}}}"
    if isinstance(value, list) and any(isinstance(part, (list, Mapping)) for part in value):
        items = ",\n".join(f"{inner}{_text(part, inner)}" for part in value)
        return f"[\n{items}\n{indent}]"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
