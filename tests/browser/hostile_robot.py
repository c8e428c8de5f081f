"""An arm whose names are markup, scripts, templates, formulas and what cannot be printed; and its SRDF."""

from xml.sax.saxutils import quoteattr

ROBOT = "<script>window.taken = 'robot'</script>"
LINKS = (
    'base"><img src=x onerror="window.taken = \'link\'">',
    "</text></svg><iframe src=https://example.org></iframe>",
    "javascript:window.taken='link'",
    r"$\frac{1}{0}$ {{ 7 * 7 }} {% raw %} &lt;b&gt; &amp;",
)
JOINTS = (
    "</script><script>window.taken = 'joint'</script>",
    "' onmouseover='window.taken=1' autofocus onfocus='window.taken=1",
    "left\u202eright\u2066 zero\u200bwidth, one\nline\tmore",
)
GROUP = "<a href=\"javascript:window.taken='group'\">arm</a>"
TERMINAL = "<script>window.taken = 'terminal'</script>\x9b31m"  # a terminal's escape in one byte: no robot has that
STATE = "</title></style><svg onload=\"window.taken='state'\">"

_MASS = '<inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
_LIMIT = '<limit lower="-1" upper="2" effort="30" velocity="1"/>'


def _attribute(name):
    return quoteattr(name, {"\n": "&#10;", "\t": "&#9;"})


def urdf(joint_names=JOINTS):
    """Return the arm: three parallel joints, 0.3 m apart."""
    links = "".join(f"<link name={_attribute(name)}>{_MASS}</link>" for name in LINKS)
    joints = "".join(
        f'<joint name={_attribute(name)} type="revolute"><parent link={_attribute(parent)}/>'
        f'<child link={_attribute(child)}/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>{_LIMIT}</joint>'
        for name, parent, child in zip(joint_names, LINKS[:-1], LINKS[1:], strict=True)
    )
    return f"<robot name={_attribute(ROBOT)}>{links}{joints}</robot>"


def unreadable_urdf():
    """Return the arm with a name that no reader takes."""
    return urdf((TERMINAL, *JOINTS[1:]))


def srdf():
    """Return its SRDF: one group, one state."""
    positions = "".join(f'<joint name={_attribute(name)} value="0.5"/>' for name in JOINTS)
    return (
        f"<robot name={_attribute(ROBOT)}><group name={_attribute(GROUP)}>"
        f"<chain base_link={_attribute(LINKS[0])} tip_link={_attribute(LINKS[-1])}/></group>"
        f"<group_state name={_attribute(STATE)} group={_attribute(GROUP)}>{positions}</group_state></robot>"
    )
