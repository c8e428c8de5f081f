"""Statics: the joint torques that hold a robot still under wrenches, a payload and gravity; certified."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinetostat.analysis.configuration import checked
from kinetostat.analysis.crosscheck import Certificate, certified
from kinetostat.analysis.loads import (
    EffortLimits,
    Payload,
    carried,
    checked_gravity,
    effort_limits,
    effort_units,
    force_scale,
    load_scale,
)
from kinetostat.analysis.utilisation import most_used
from kinetostat.conventions import Array, Load, On
from kinetostat.engines.model import Model
from kinetostat.engines.protocol import Engine
from kinetostat.errors import NumberError, quote
from kinetostat.screw.chain import screw
from kinetostat.urdf.description import MASSLESS, JointType, Robot

__all__ = ["Reactions", "Torques", "reactions", "refuse_negative_masses", "torque"]


@dataclass(frozen=True, repr=False)
class Torques:
    """Joint torques (N for slides) that hold a robot still, one for each velocity coordinate.

    Attributes:
        columns: names of the coordinates, independent joints in file order; those of a floating base too.
        units: N or Nm of each.
        loads: the wrenches as given.
        on: whom they act on.
        payload: the payload, or None.
        exerted: all loads with the sign of what the robot exerts, the weight of the payload too.
        gravity_vector: the acceleration of gravity in the root's axes, (3,), m/s2; zero where links have no weight.
        payload_gravity: the same for the payload, (3,): 9.81 down the root's z where `gravity_vector` is left out.
        torques: from the wrenches, (..., n).
        gravity: from the weight of the links, (..., n).
        from_payload: from the weight of the payload, (..., n).
        total: the sum of the three, (..., n).
        limits: what the joints may give.
        certificate: what the two engines say of the three parts.
        warnings: what is to be said of it.
    """

    columns: tuple[str, ...]
    units: tuple[str, ...]
    loads: tuple[Load, ...]
    on: On
    payload: Payload | None
    exerted: tuple[Load, ...]
    gravity_vector: Array
    payload_gravity: Array
    torques: Array
    gravity: Array
    from_payload: Array
    total: Array
    limits: EffortLimits
    certificate: Certificate
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Torques of {len(self.columns)} coordinates, batch {self.total.shape[:-1]}>"

    @property
    def utilisation(self) -> Array:
        """Total over the effort limit in its direction, in [0, inf); NaN where there is no limit. (..., n)."""
        limit = np.where(self.total < 0, -self.limits.lower, self.limits.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            used = np.abs(self.total) / limit
        return np.where((self.total == 0) & ~np.isnan(limit), 0.0, used)

    @property
    def binding(self) -> Array:
        """Index of the coordinate with the largest utilisation, -1 where none has a limit. (...)."""
        return most_used(self.utilisation)

    @property
    def binding_joint(self) -> str | None:
        """The joint that is nearest to its effort limit, of one configuration; None where no joint has a limit."""
        index = int(self.binding)
        return None if index < 0 else self.columns[index]


def torque(
    model: Model,
    q: Array,
    wrenches: Sequence[Load] = (),
    *,
    on: On | str = On.ENVIRONMENT,
    gravity: Sequence[float] | Array | bool | None = None,
    payload: Payload | None = None,
    limits: Mapping[str, float | tuple[float, float]] | None = None,
) -> Torques:
    """Return the joint torques that hold a robot still.

        tau = J^T F + dU/dq

    F the wrench that the robot exerts on its surroundings (minus the one that they exert on it), U the potential energy
    of links and payload. A follower's share is its leader's, times the multiplier. Statics and duality: R. Murray, Z.
    Li and S. Sastry, "A Mathematical Introduction to Robotic Manipulation", 1994, section 3.4.3; link to link by R.
    Featherstone, "Rigid Body Dynamics Algorithms", 2008, section 5.3, at rest.

    Args:
        model: the robot.
        q: configurations (..., nq).
        wrenches: what acts where; see `load_at`.
        on: whether the robot exerts them on its "environment", or they act on the "robot".
        gravity: weight of the links: True (9.81 m/s2 down the root's z), a vector (3,) in the root's axes, or None.
        payload: a mass that is held; its weight counts in any case, along `gravity` or down the root's z.
        limits: effort limits of joints instead of the file's: a number, or (lower, upper).

    Raises:
        UnknownNameError: no such frame or joint.
        UsageError: gravity, payload, limits, or `on`, that cannot be.
        ConfigurationError: q has another shape, or a number that is not finite.
        NumberError: a link's mass is negative, and gravity counts.
    """
    robot, q, on = model.robot, checked(model.robot, q), On(on)
    down, none = checked_gravity(gravity), np.zeros(3)
    if np.any(down):
        refuse_negative_masses(model)
    # A payload has its weight in any case: without gravity of the links, 9.81 m/s2 down the root's z.
    pull = checked_gravity(True) if gravity is None or gravity is False else down
    exerted = [replace(load, wrench=-load.wrench) for load in wrenches] if on is On.ROBOT else list(wrenches)
    held = carried(robot, payload, pull)

    def part(engine: Engine, pulled: Array, borne: Sequence[Load]) -> Array:
        bears = bool(borne) or bool(np.any(pulled))
        return engine.holding_torques(q, pulled, borne) if bears else np.zeros((*q.shape[:-1], robot.nv))

    def parts(engine: Engine) -> Array:
        found = part(engine, none, exerted), part(engine, down, ()), part(engine, none, held)
        return np.stack(np.broadcast_arrays(*found), -2)

    loads = (*exerted, *held)
    value, certificate = certified(model, parts, load_scale(robot, q, loads), force_scale(model, down, loads))
    return Torques(
        robot.velocity_names,
        tuple(unit for joint in robot.independent for unit in effort_units(joint)),
        tuple(wrenches),
        on,
        payload,
        loads,
        down,
        pull,
        value[..., 0, :],
        value[..., 1, :],
        value[..., 2, :],
        np.sum(value, axis=-2),
        effort_limits(robot, limits),
        certificate,
        tuple(_about_masses(model) if np.any(down) else ()),
    )


def refuse_negative_masses(model: Model) -> None:
    """Refuse to weigh a robot with a mass below zero, whose centre Pinocchio loses without a word."""
    for link in model.robot.links:
        if link.inertial is not None and link.inertial.mass < 0:
            raise NumberError(
                f"the mass of link {quote(link.name)} is {link.inertial.mass:g} kg: below zero",
                file=model.loaded.source.name,
                line=link.line,
                remedy="correct it, or ask without gravity",
            )


def _about_masses(model: Model) -> list[str]:
    """Return what is to be said of the links' masses: those that were left out, and a robot without any."""
    lost = [remark for remark in model.robot.remarks if remark.text.endswith(MASSLESS)]
    warnings = [str(remark) for remark in lost[:3]]
    if len(lost) > 3:
        warnings.append(f"and {len(lost) - 3} more links count as massless ('kinetostat info' lists them)")
    if model.engine.masses()[1] == 0:
        warnings.append("no link that moves has a mass: gravity does nothing")
    return warnings


@dataclass(frozen=True, repr=False)
class Reactions:
    """The wrench by which each link is held: by the link before it through their joint, the root link by the ground.

    Attributes:
        links: the links that are held, in file order.
        holders: the link that holds each, None for the ground.
        joints: the joint between the two, None for the ground.
        local: force and moment about the link's origin, in its own axes. (..., k, 6), N and Nm.
        base: the same, about the same point, in the root's axes. (..., k, 6).
        projections: what each joint with one coordinate gives: the wrench's part along its screw, N or Nm; NaN for
            others. (..., k).
        residual: the largest difference between projections, folded onto leaders, and the joint torques. N or Nm.
        certificate: what the two engines say of the wrenches.
    """

    links: tuple[str, ...]
    holders: tuple[str | None, ...]
    joints: tuple[str | None, ...]
    local: Array
    base: Array
    projections: Array
    residual: float
    certificate: Certificate

    def __repr__(self) -> str:
        return f"<Reactions on {len(self.links)} links, batch {self.local.shape[:-2]}>"


def reactions(model: Model, q: Array, result: Torques) -> Reactions:
    """Return the wrenches that the links exert on each other under the loads of a result of `torque` at the same q.

    From the tip inward, F_link = (what it exerts) - (its weight) + sum of F of the links that it holds, each moved to
    the link's own origin; the torque of a joint is its part along the joint's screw: n . z of a revolute, f . z of a
    prismatic joint (J. Craig, "Introduction to Robotics", section 5.9).

    Args:
        model: the robot.
        q: the configurations of the result, (..., nq).
        result: the loads, and the torques that the projections are compared with.

    Raises:
        ConfigurationError: q has another shape, or a number that is not finite.
    """
    robot, q = model.robot, checked(model.robot, q)
    down, loads = result.gravity_vector, result.exerted
    links = [link.name for link in robot.links]

    def both(engine: Engine) -> Array:
        own = engine.joint_wrenches(q, down, loads, links)
        turns = np.stack([engine.placement(q, link, robot.root)[..., :3, :3] for link in links], -3)
        turned = [(turns @ own[..., half, None])[..., 0] for half in (slice(3), slice(3, 6))]
        return np.stack([own, np.concatenate(turned, -1)], -2)

    value, certificate = certified(model, both, load_scale(robot, q, loads), force_scale(model, down, loads))
    own = value[..., 0, :]
    above = [robot.parent_joint.get(link) for link in links]
    projections = np.stack([own[..., i, :] @ _screw(robot, link) for i, link in enumerate(links)], -1)
    return Reactions(
        tuple(links),
        tuple(joint.parent if joint else None for joint in above),
        tuple(joint.name if joint else None for joint in above),
        own,
        value[..., 1, :],
        projections,
        _residual(robot, links, projections, result.total),
        certificate,
    )


def _screw(robot: Robot, link: str) -> Array:
    """Return the screw of the joint before a link in the link's frame, (6,); NaN where it has none, or several."""
    joint = robot.parent_joint.get(link)
    if joint is None or joint.type.nv != 1:
        return np.full(6, np.nan)
    return screw(np.array(joint.axis), np.zeros(3), np.inf if joint.type is JointType.PRISMATIC else joint.pitch)


def _residual(robot: Robot, links: Sequence[str], projections: Array, total: Array) -> float:
    """Return how far the projections, each follower's times its multiplier on its leader, are from the torques."""
    worst = 0.0
    for leader in robot.independent:
        if leader.type.nv == 1:
            laws = {name: law.multiplier for name, law in robot.followers.items() if law.joint == leader.name}
            laws[leader.name] = 1.0
            parts = [factor * projections[..., links.index(robot.joint_by_name[j].child)] for j, factor in laws.items()]
            torque = total[..., robot.velocity_slices[leader.name].start]
            worst = max(worst, float(np.max(np.abs(np.sum(parts, axis=0) - torque), initial=0.0)))
    return worst
