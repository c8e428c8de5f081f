"""Documents of the report: of real robots, of texts, and made by hand."""

from __future__ import annotations

from functools import cache

import kinetostat as ks
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.analysis.profile.profiling import profile
from kinetostat.gate.check import check
from kinetostat.gate.result import FileCheck, Verdict
from kinetostat.report.fleet.describing import robot_document
from kinetostat.report.fleet.document import FleetDocument, RobotDocument
from trees import load_text

SAMPLES, STARTS, PAYLOAD = 300, 20, 0.5
PASSED = FileCheck("arm.urdf", Verdict.PASS)


@cache
def checked(name: str) -> FileCheck:
    return check([name], samples=3).files[0]


@cache
def profiled(name: str):
    return profile_of(ks.load(name))


def profile_of(model, payload=PAYLOAD):
    return profile(model, limbs(model), samples=SAMPLES, starts=STARTS, payload=payload)


@cache
def described(name: str) -> RobotDocument:
    """Return the document of a robot that ships with something."""
    return robot_document("r1", checked(name), profiled(name), status="done", reason="", payload=PAYLOAD)


def described_text(text: str, check: FileCheck = PASSED, payload=PAYLOAD) -> RobotDocument:
    """Return the document of a robot's text."""
    found = profile_of(load_text(text), payload)
    return robot_document("r1", check, found, status="done", reason="", payload=payload)


def failed(path="broken.urdf", reason="not XML", status="unreadable", check=None) -> RobotDocument:
    check = check or FileCheck(path, Verdict.FAIL, readable=False)
    return robot_document("r2", check, None, status=status, reason=reason, payload=None)


def fleet_of(*robots: RobotDocument, made="2026-11-23T08:00:00Z") -> FleetDocument:
    return FleetDocument(made=made, version="0.0", samples=SAMPLES, seed=0, payload=PAYLOAD, robots=robots)


def arm(*joints: str, limit='<limit lower="-1" upper="1.5" effort="30" velocity="1"/>', mass=2.0, name="arm") -> str:
    """Return an arm of rods of 1 m along x, one for each joint: its type and axis, such as `revolute 0 1 0`."""
    text = '<link name="l0"/>'
    weight = (
        f'<inertial><origin xyz="0.5 0 0"/><mass value="{mass}"/>'
        '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
    )
    for i, joint in enumerate(joints, start=1):
        kind, _, axis = joint.partition(" ")
        text += (
            f'<link name="l{i}">{weight if mass else ""}</link><joint name="j{i}" type="{kind}">'
            f'<parent link="l{i - 1}"/><child link="l{i}"/><origin xyz="{float(i > 1)} 0 0"/>'
            f'<axis xyz="{axis}"/>{limit}</joint>'
        )
    tip = len(joints)
    text += (
        f'<link name="tool"/><joint name="end" type="fixed"><parent link="l{tip}"/><child link="tool"/>'
        '<origin xyz="1 0 0"/></joint>'
    )
    return f'<robot name="{name}">{text}</robot>'
