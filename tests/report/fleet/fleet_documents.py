"""Fleet documents made by hand: ordinary, failed, without chains or numbers, hostile; and stand-ins for drawings."""

import dataclasses
import types
import typing

import msgspec

from kinetostat.report.fleet.document import (
    Agreed,
    CertificateRow,
    ChainRow,
    DistributionRow,
    ExpectationRow,
    FamilyRow,
    FindingRow,
    FleetDocument,
    JointRow,
    LeftRow,
    PayloadRow,
    PoseRow,
    RobotDocument,
    UseRow,
)
from kinetostat.report.fleet.drawing import Drawing

HOSTILE = (
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "javascript:alert(1)",
    "{{7*7}}{% raw %}${7*7}#{7*7}",
    "\x1b[31mred\x1b[0m\x07",
    "a\u202eb\u2066c\u2028d",
    "</style></title></textarea></script><svg onload=alert(1)>",
    "]]><!-- --><![CDATA[ &lt;b&gt; &#60;i&#62;",
    "one\ntwo\r\nthree\ttabbed",
    "' onfocus=alert(1) autofocus='",
    "| a | b |\n\n# heading @someone #1 ``` [x](javascript:alert(1)) ![y](http://z)",
    "\ud800 lone, \x00 nul",
    "x" * 10_000,
    "<" * 10_000,
)


# --- ordinary --------------------------------------------------------------------------------------------------


def distribution(measure="yoshikawa", title="manipulability", unit="1", median=0.1, **changes):
    shares = {"0.01": 0.02, "0.05": 0.1, "0.1": 0.2, "0.25": 0.6, "0.5": 1.0, "0.75": 1.3, "0.9": 1.6, "0.99": 2.0}
    fields = {"measure": measure, "title": title, "unit": unit, "count": 20_000, "mean": 1.02 * median, "minimum": 0.0}
    fields |= {"maximum": 2.2 * median, "quantiles": {share: size * median for share, size in shares.items()}}
    return DistributionRow(**fields | changes)


def pose(name="mid", **changes):
    fields = {
        "name": name,
        "configuration": {"joint1": 0.0, "joint2": -0.785},
        "inside": True,
        "rank": 6,
        "dimension": 6,
    }
    fields |= {
        "yoshikawa": 0.0812,
        "smallest_singular_value": 0.214,
        "inverse_condition_number": 0.137,
        "effort_use": 0.31,
    }
    return PoseRow(**fields | changes)


def family(name="elbow", **changes):
    fields = {
        "name": name,
        "condition": "joint4 = 0",
        "codimension": 1,
        "kind": "fold",
        "inside_limits": True,
        "complete": True,
    }
    fields |= {"tolerance": "strict", "hits": 118, "causes": ("the arm is stretched: three parallel axes in a plane",)}
    return FamilyRow(**fields | changes)


def chain(key="r1-1", name="arm", reach=0.855, joints=("joint1", "joint2", "joint3"), **changes):
    fields = {"id": key, "name": name, "base": "base_link", "frame": "tool", "found": "group", "joints": tuple(joints)}
    fields |= {
        "rows": ("vx", "vy", "vz", "wx", "wy", "wz"),
        "rank": 6,
        "length": 0.31,
        "length_reference": "joint range",
    }
    fields |= {"singular_value_unit": "1", "samples": 20_000, "reach": reach, "asked_payload": None, "near": 0.01}
    fields |= {"payload_at_mid": PayloadRow(mass=7.31, binding_joint="joint2", least=None, unbounded=False)}
    fields |= {
        "distributions": (
            distribution("yoshikawa", "manipulability (Yoshikawa)", "1", 0.0713 * reach),
            distribution("minimum_singular_value", "smallest singular value", "1", 0.19),
            distribution("inverse_condition_number", "dexterity", "1", 0.1234),
            distribution("effort_use", "gravity use", "1", 0.4),
        )
    }
    fields |= {"turns_only": False}
    fields |= {"near_singular_share": 0.0123, "worst_gravity_use": 0.834, "worst_gravity_joint": "joint2"}
    fields |= {"worst_loaded_use": None, "worst_loaded_joint": "", "starts": 300, "converged": 212, "unseen": 0.004}
    fields |= {"poses": (pose("zero", inside=False, rank=5), pose("mid"), pose("home"))}
    fields |= {"families": (family(), family("wrist", condition="joint6 = 0 or joint6 = pi", hits=94)), "left": ()}
    return ChainRow(**fields | changes)


def joint(name="joint1", **changes):
    fields = {
        "name": name,
        "type": "revolute",
        "parent": "base_link",
        "child": "link1",
        "unit": "rad",
        "effort_unit": "Nm",
    }
    fields |= {
        "lower": -2.8973,
        "upper": 2.8973,
        "velocity": 2.175,
        "effort": 87.0,
        "follows": "",
        "limb": "arm",
        "loaded": None,
    }
    fields |= {"gravity": UseRow(torque=-48.2, use=0.554, configuration={name: 1.2})}
    return JointRow(**fields | changes)


def finding(severity="warning", **changes):
    fields = {"code": "KS201", "name": "inertia-not-physical", "severity": severity, "file": "", "line": 42}
    fields |= {"message": "the principal moments break the triangle inequality", "element": "link 'forearm'"}
    return FindingRow(**fields | {"hint": "compute the inertia again from the mesh"} | changes)


def certificate(**changes):
    fields = {"engines": ("pinocchio", "screw"), "numbers": 4312, "answers": 31, "max_difference": 3.1e-16}
    fields |= {"tolerance": 1.8e-12, "answer": "manipulability of arm at home", "agree": True}
    return CertificateRow(**fields | changes)


def agreed(**changes):
    fields = {
        "readers": ("pinocchio", "screw", "yourdfpy"),
        "frames": 12,
        "configurations": 20,
        "max_difference": 4.4e-16,
    }
    fields |= {"tolerance": 1.8e-12, "agree": True, "engines_agree": True, "disagreements": (), "notes": ()}
    return Agreed(**fields | changes)


def robot(key="r1", name="panda", **changes):
    fields = {
        "id": key,
        "path": f"example:{name}",
        "name": name,
        "sha256": "9f86d081884c7d65" * 4,
        "status": "done",
        "reason": "",
    }
    fields |= {"verdict": "pass", "links": 11, "degrees_of_freedom": 7, "mass": 17.8, "reach": 1.19, "tips": 1}
    names = ("joint1", "joint2", "joint3")
    fields |= {"chains": (chain(f"{key}-1", "arm", joints=names),), "joints": tuple(map(joint, names))}
    fields |= {"findings": (finding("info", line=3), finding(), finding("error", line=7)), "expectations": ()}
    fields |= {
        "agreement": agreed(),
        "certificate": certificate(),
        "left": (LeftRow(what="hand", why="it is a gripper"),),
    }
    return RobotDocument(**fields | changes)


def failed(key="r9", path="robots/broken.urdf", status="unreadable", **changes):
    fields = {
        "name": "",
        "sha256": "",
        "status": status,
        "verdict": "crashed",
        "links": 0,
        "degrees_of_freedom": 0,
        "mass": None,
    }
    fields |= {
        "reason": "robots/broken.urdf:12: <link>: two links are named 'arm' (rename one)",
        "reach": None,
        "tips": 0,
    }
    fields |= {
        "chains": (),
        "joints": (),
        "agreement": None,
        "certificate": None,
        "left": (),
        "findings": (),
        "expectations": (),
    }
    return robot(key, **fields | {"path": path} | changes)


def without_chains(key="r8", name="drone"):
    left = (LeftRow(what="chains", why="no joint moves"),)
    return robot(key, name, chains=(), joints=(), degrees_of_freedom=0, mass=0.9, left=left)


def document(*robots, **changes):
    fields = {"made": "2026-11-23 08:00:00 UTC", "version": "0.8.0", "samples": 20_000, "seed": 0, "payload": None}
    return FleetDocument(**fields | {"robots": robots} | changes)


def loaded_robot(key="r2"):
    """Return a robot with everything in it: followers, slides, payloads, expectations, disagreements, many findings."""
    uses = {"gravity": UseRow(torque=113.0, use=1.27, configuration={})}
    uses["loaded"] = UseRow(torque=-160.0, use=1.8, configuration={"lift": 0.1})
    joints = (
        joint("shoulder", **uses),
        joint("lift", type="prismatic", unit="m", effort_unit="N", lower=0.0, upper=0.4, velocity=None, effort=None,
              gravity=UseRow(torque=66.1, use=None, configuration={})),
        joint("wheel", type="continuous", lower=None, upper=None, limb="", gravity=None),
        joint("base", type="floating", unit="mixed", effort_unit="mixed", lower=None, upper=None, velocity=None,
              effort=None, gravity=None, limb=""),
        joint("finger_left", follows="finger_right * -1 + 0.04", limb=""),
    )  # fmt: skip
    chains = (
        chain(f"{key}-1", "left_arm", 1.31, asked_payload=5.0, worst_gravity_use=1.27, worst_loaded_use=1.8,
              worst_loaded_joint="shoulder", found="settings"),
        chain(f"{key}-2", "right_arm", 1.31, singular_value_unit="m/rad", found="tip", distributions=(
            distribution("yoshikawa", "manipulability", "(m/rad)^2", 0.2),)),
    )  # fmt: skip
    expectations = tuple(
        ExpectationRow(title="reach of the arm", met=met, wanted="at least 1.2 m", found="1.31 m", place="")
        for met in (True, False, None)
    )
    return robot(
        key, "two-armed", path="robots/two_armed.urdf", verdict="fail", mass=61.25, chains=chains, joints=joints,
        degrees_of_freedom=16, findings=tuple(finding("warning", line=i) for i in range(1, 31)),
        expectations=expectations, certificate=certificate(agree=False, max_difference=2e-9),
        agreement=agreed(agree=False, engines_agree=False, disagreements=("pinocchio and screw differ",), notes=("n",)),
    )  # fmt: skip


def fleet():
    """Return an ordinary report: arms, one of them with everything, one that cannot be read, one without chains."""
    small = robot("r3", "ur3", mass=11.0, chains=(chain("r3-1", "arm", 0.5, near_singular_share=0.2),), findings=())
    return document(robot("r1"), loaded_robot("r2"), small, failed("r4"), without_chains("r5"))


# --- extremes --------------------------------------------------------------------------------------------------


def _rebuilt(value, kind, change):
    """Return a value of the document anew, each leaf being what `change` makes of it and its type."""
    if isinstance(value, msgspec.Struct):
        kinds = typing.get_type_hints(type(value))
        return msgspec.structs.replace(
            value, **{name: _rebuilt(getattr(value, name), kinds[name], change) for name in value.__struct_fields__}
        )
    if isinstance(value, tuple):
        return tuple(_rebuilt(one, typing.get_args(kind)[0], change) for one in value)
    if isinstance(value, dict):
        names, values = typing.get_args(kind)
        return {_rebuilt(name, names, change): _rebuilt(one, values, change) for name, one in value.items()}
    return change(value, kind)


def without_numbers(ordinary):
    """Return the document with every number that may be unknown unknown."""

    def change(value, kind):
        optional = isinstance(kind, types.UnionType) and type(None) in typing.get_args(kind)
        return None if optional and isinstance(value, float | int) and not isinstance(value, bool) else value

    return _rebuilt(ordinary, type(ordinary), change)


def with_texts(ordinary, text):
    """Return the document with `text` for every free text in it, ids and keys of joints too; literals stay."""

    def change(value, kind):
        return text(value) if kind is str else value

    return _rebuilt(ordinary, type(ordinary), change)


def hostile(ordinary, text):
    """Return the document with a hostile text in every free text, behind what makes it unique."""
    return with_texts(ordinary, lambda value: f"{text}{value}")


# --- drawings --------------------------------------------------------------------------------------------------


def drawings(of, alt="what it shows"):
    """Return a stand-in for every drawing of a document: an empty box."""
    box = '<svg class="figure" viewBox="0 0 480 300" width="640" height="400">'
    box += '<path fill="none" stroke="#8a8a8a" d="M8 8h464v284h-464z"/></svg>'
    keys = {"fleet/scatter": 0.0}
    for each in of.robots:
        if each.status == "done":
            keys[f"{each.id}/tree"] = 0.0
        for one in each.chains:
            keys |= {f"{one.id}/{kind}": 0.0 for kind in ("poses", "reach", "distributions")}
            keys[f"{one.id}/thumbnail"] = 2.2 * (one.reach or 0.3)
    return {key: Drawing(svg=box, alt=f"{alt}: {key}", metres=metres) for key, metres in keys.items()}


def changed_drawings(given, **changes):
    """Return drawings with other fields."""
    return {key: dataclasses.replace(drawing, **changes) for key, drawing in given.items()}
