"""Profiles of limbs made by hand: any frame of any robot at any poses, with a sweep or without."""

import numpy as np

import kinetostat as ks
from kinetostat.analysis.profile.anatomy import Left, Limb
from kinetostat.analysis.profile.result import LimbPose, LimbProfile
from kinetostat.analysis.sweeping.sweep import sweep

MEASURES = ("yoshikawa", "minimum_singular_value", "inverse_condition_number")


def limb_of(robot, frame, base=None, name=""):
    base = base or robot.root
    return Limb(name or frame, base, frame, tuple(joint.name for joint in robot.movable_path(base, frame)), "tip")


def pose_of(model, limb, name, q, axes=None, **changes):
    """Return a limb at a pose, measured over all rows of its twist, or over some."""
    at = ks.configuration(model, q)
    found = ks.manipulability(model, limb.frame, at.q, relative_to=limb.base, axes=axes)
    full = found.blocks["task" if axes else "full"]
    values = {
        "yoshikawa": float(full.yoshikawa),
        "minimum_singular_value": float(full.minimum_singular_value),
        "inverse_condition_number": float(full.inverse_condition_number),
    }
    return LimbPose(
        **{"name": name, "at": at, "inside": not at.warnings, "manipulability": found, "values": values} | changes
    )


def profile_of(model, limb, poses, samples=0, axes=None):
    """Return a profile with poses {name: q}, and a sweep if samples are asked for."""
    made = tuple(one if isinstance(one, LimbPose) else pose_of(model, limb, name, one) for name, one in poses.items())
    zero = ks.configuration(model, "zero").q
    asked = {"measures": MEASURES, "relative_to": limb.base, "axes": axes}
    swept = sweep(model, limb.frame, zero, samples=samples, **asked) if samples else None
    left = (Left("measures", "they are not asked for"),)
    return LimbProfile(limb, swept, np.zeros((0, 3)), np.zeros(0), None, None, made, None, (), None, left)
