"""Robots as URDF text, a few lines each, and what stands in for the work on a robot. They travel to it by name."""

import os
import signal
import time

from kinetostat.report.fleet.working import report_robot

INERTIAL = """<inertial><origin xyz="0.1 0 0.05"/><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>"""


def link(name, body=""):
    return f'<link name="{name}">{body}</link>'


AXIS = '<axis xyz="0 1 0"/>'
LIMIT = '<limit lower="-1" upper="1.5" effort="10" velocity="2"/>'


def joint(name, kind, parent, child, body=AXIS, limit=LIMIT):
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}"><origin xyz="0.3 0 0.1"/>{ends}{body}{limit}</joint>'


def chain(kind, count=1, inertial=INERTIAL, **how):
    """Return a robot with so many joints of a kind, one behind the other."""
    links = [link(f"l{i}", inertial if i else "") for i in range(count + 1)]
    joints = [joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", **how) for i in range(count)]
    return robot(*links, *joints)


def robot(*parts, name="arm"):
    return f'<robot name="{name}">{"".join(parts)}</robot>'


EDGES = {
    "one link": robot(link("only", INERTIAL)),
    "one link without mass": robot(link("only")),
    "one joint": chain("revolute"),
    "one slide": chain("prismatic"),
    "one wheel": chain("continuous", limit='<limit effort="10" velocity="2"/>'),
    "one planar joint": chain("planar", body='<axis xyz="0 0 1"/>', limit=""),
    "one floating joint": chain("floating", body="<!-- -->", limit=""),
    "no masses": chain("revolute", 3, inertial=""),
    "no effort limits": chain("revolute", 2, limit='<limit lower="-1" upper="1" effort="0" velocity="0"/>'),
    "endless joints": chain("continuous", 3, limit=""),
    "limits that are one value": chain("revolute", 2, limit='<limit lower="0" upper="0" effort="1" velocity="1"/>'),
    "fixed joints alone": chain("fixed", 2, limit=""),
    "a follower": robot(
        *(link(name, INERTIAL) for name in "abc"),
        joint("lead", "revolute", "a", "b"),
        joint("follow", "revolute", "b", "c", limit=f'{LIMIT}<mimic joint="lead" multiplier="-1"/>'),
    ),
    "a planar base with an arm": robot(
        *(link(name, INERTIAL) for name in "abcd"),
        joint("base", "planar", "a", "b", body='<axis xyz="0 0 1"/>', limit=""),
        joint("shoulder", "revolute", "b", "c"),
        joint("elbow", "revolute", "c", "d"),
    ),
    "hostile names": robot(
        link("a"),
        link("&lt;script>alert(1)&lt;/script>", INERTIAL),
        joint("&quot;>&lt;img src=x onerror=1>&#9;$x$", "revolute", "a", "&lt;script>alert(1)&lt;/script>"),
        name="&lt;b>]]&gt;&amp;amp; $\\alpha$ \u202egnp.exe",
    ),
}


def misbehave(task):
    """Do what the name of the robot's file says, or report it."""
    if "dies" in task.check.name:
        os.kill(os.getpid(), signal.SIGSEGV)
    if "hangs" in task.check.name:
        time.sleep(600)
    if "bug" in task.check.name:
        raise ValueError("no figure\x1b[31m")
    return report_robot(task)
