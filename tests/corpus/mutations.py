"""Seeded mutations of robot files, and the judgement of what the library makes of each.

    python -m corpus.mutations FIRST COUNT      (in tests/) judges the seeds FIRST, FIRST + 1, ...
    python -m corpus.mutations SEED             writes the mutated file of one seed to standard output

The same seed gives the same file wherever the same version of example-robot-data is installed. A seed is named before
it is judged, so that one which kills the process is known.
"""

from __future__ import annotations

import functools
import json
import math
import random
import re
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

import kinetostat as ks
from kinetostat.urdf.files import example_robots

FILES = Path(__file__).parent / "files"
LARGEST = 30_000  # bytes of an example robot

# Robots for the parts of the dialects that no small real file has.
DIALECTS = {
    "screw": """<robot name="r" xmlns:drake="http://drake.mit.edu"><link name="a"/><link name="b"/><link name="c"/>
<drake:joint name="s" type="screw"><parent link="a"/><child link="b"/><origin xyz="0 1 0"/><axis xyz="0 0.6 0.8"/>
<drake:screw_thread_pitch value="0.01"/></drake:joint>
<drake:joint name="p" type="planar"><parent link="b"/><child link="c"/><axis xyz="0 0.6 0.8"/></drake:joint></robot>""",
    "quaternion": """<robot name="r" version="1.1"><link name="a"/><link name="b"><inertial><origin xyz="0 0 1"
quat_xyzw="0 0 0 1"/><mass value="2"/><inertia ixx="1" ixy="0.1" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><origin xyz="1 2 3" quat_xyzw="0.5 0.5 0.5 0.5"/>
<axis xyz="1 0 0"/></joint></robot>""",
    "followers": """<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/><link name="e"/>
<joint name="z" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/>
<mimic joint="y" multiplier="-0.5" offset="0.1"/></joint>
<joint name="y" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>
<mimic joint="x" multiplier="2"/></joint>
<joint name="x" type="revolute"><parent link="c"/><child link="d"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1"/></joint>
<joint name="f" type="floating"><parent link="d"/><child link="e"/><origin rpy="1 2 3" xyz="3 2 1"/></joint></robot>""",
}
STORED = (
    "ok_base.urdf",
    "floating_leaf.urdf",
    "latin1_declared.urdf",
    "mesh_package.urdf",
    "mesh_traversal.urdf",
    "mimic_cont_of_rev.urdf",
    "mimic_later.urdf",
    "mimic_ok.urdf",
    "name_fixed_joint_eq_link.urdf",
    "nm_unicode.urdf",
    "pi_in_geometry.urdf",
    "planar_nolimit.urdf",
    "ros_blocks.urdf",
    "root_is_last.urdf",
    "two_inertials.urdf",
)


def _words(text: str) -> list[str]:
    return text.split()


TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "screw", "Revolute", "")
NUMBERS = (
    *_words("0 -0 1 -1 0.0 1e-9 1e-12 1e-300 4.9e-324 1e9 -1e11 1e12 1e13 1e15 1e30 1e154 1e155 1e300 1e309"),
    *_words("1.7976931348623157e308 -1.7976931348623157e308 inf -inf nan NaN 180 1e6 1e5 12345.678 000000001"),
    *_words("3.141592653589793 1.5707963267948966 -1.5707963267948966 6.283185307179586 1. .5 +.5e+1"),
    *_words("1,5 0x10 1_0 1e --1 ٣ 1f 1d3 0.1.2 1e- 1/2 ${x}"),
    *("1 ", " 1", "\t1\n", "1" * 40, "0." + "3" * 400),
)
TEXTS = (
    *_words("universe root_joint world a b base_link é \u202e \u200b"),
    *_words("&lt; &#10; &#9; &amp; &nosuch; &#27;[31m &#0; &#x85;"),
    *_words("../../etc/passwd package://a/b package://etc/passwd file:///dev/zero .. %00 ~ C:\\x"),
    *_words("{} %s [red] ' 1.1 1 2.0"),
    *("", " ", "a b", "$(find x)", "x" * 300),
)
TAGS = _words("link joint origin axis limit mimic parent child inertial mass inertia visual mesh robot x:y")
SNIPPETS = (
    '<mimic joint="{name}" multiplier="{number}" offset="{number}"/>',
    '<axis xyz="{number} {number} {number}"/>',
    '<origin xyz="{number} {number} {number}" rpy="{number} {number} {number}"/>',
    '<origin xyz="1 1 1" quat_xyzw="{number} {number} {number} {number}"/>',
    '<limit lower="{number}" upper="{number}" effort="{number}" velocity="{number}"/>',
    '<inertial><mass value="{number}"/><inertia ixx="{number}" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>',
    '<inertial><origin xyz="{number} 0 0"/><mass value="{number}"/></inertial>',
    '<visual><geometry><mesh filename="{text}"/></geometry></visual>',
    '<joint name="{text}" type="{type}"><parent link="{name}"/><child link="{name}"/></joint>',
    '<link name="{text}"/>',
    "<!-- -->",
    "<?x y?>",
    "<![CDATA[<]]>",
    "<drake:screw_thread_pitch value='{number}'/>",
)

_ATTRIBUTE = re.compile(rb"""([A-Za-z_:]+)(\s*=\s*)(["'])(.*?)\3""", re.DOTALL)
_TAG = re.compile(rb"<!--.*?-->|<\?.*?\?>|<(/?)([A-Za-z_:]+)((?:[^<>\"']|\"[^\"]*\"|'[^']*')*?)(/?)>", re.DOTALL)


# --- mutating --------------------------------------------------------------------------------------------------


@functools.cache
def originals() -> dict[str, bytes]:
    """Return the files to mutate by name."""
    found = {name: (FILES / name).read_bytes() for name in STORED}
    found |= {name: text.encode() for name, text in DIALECTS.items()}
    examples = {name: path.read_bytes() for name, path in example_robots().items() if path.stat().st_size <= LARGEST}
    return found | {name: data for name, data in examples.items() if b"<link" in data}  # ur3.urdf has none


def mutated(seed: int) -> tuple[str, bytes]:
    """Return the name of the original, and its mutation by this seed."""
    chance = random.Random(seed)
    name = chance.choice(sorted(originals()))
    data = originals()[name]
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 5))):
        kind = chance.choices((_bytes, _attribute, _element), (1, 4, 3))[0]
        data = kind(data, chance)
    return name, data


def _span(data: bytes, chance: random.Random, longest: int = 40) -> tuple[int, int]:
    start = chance.randrange(len(data) + 1)
    return start, min(len(data), start + chance.randrange(1, longest))


def _bytes(data: bytes, chance: random.Random) -> bytes:
    """Flip, replace, delete, insert, duplicate, swap or cut off bytes."""
    start, end = _span(data, chance)
    other, until = _span(data, chance)
    how = chance.randrange(7)
    if how == 0 and data:
        at = chance.randrange(len(data))
        return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]
    if how == 1:
        return data[:start] + chance.randbytes(1) + data[start + 1 :]
    if how == 2:
        return data[:start] + data[end:]
    if how == 3:
        return data[:start] + chance.randbytes(chance.randrange(1, 6)) + data[start:]
    if how == 4:
        return data[:start] + data[other:until] + data[start:]
    if how == 5:
        return data[:start] + data[other:until] + data[end:]
    return data[: chance.randrange(len(data) + 1)] if chance.random() < 0.3 else data[:end] + data[start:]


def _filled(snippet: str, data: bytes, chance: random.Random) -> str:
    names = [
        match[4].decode("utf-8", "replace") for match in _ATTRIBUTE.finditer(data) if match[1] in (b"name", b"link")
    ] or ["a"]
    choose: dict[str, Callable[[], str]] = {
        "{number}": lambda: chance.choice(NUMBERS),
        "{text}": lambda: chance.choice(TEXTS),
        "{name}": lambda: chance.choice(names),
        "{type}": lambda: chance.choice(TYPES),
    }
    return re.sub(r"\{\w+\}", lambda match: choose[match[0]](), snippet)


def _attribute(data: bytes, chance: random.Random) -> bytes:
    """Empty, replace, swap, delete, double or rename an attribute."""
    found = list(_ATTRIBUTE.finditer(data))
    if not found:
        return _bytes(data, chance)
    one, other = chance.choice(found), chance.choice(found)
    key, equals, mark, value = one.groups()
    alike = [match[4] for match in found if match[1] == key]
    how = chance.randrange(10)
    if how == 0:
        value = b""
    elif how == 1:
        value = other[4]
    elif how == 2:
        value = chance.choice(alike)
    elif how == 3:
        value = (chance.choice(TYPES) if key == b"type" else chance.choice(TEXTS)).encode()
    elif how in (4, 5, 6):
        words = value.split() or [b""]
        words[chance.randrange(len(words))] = chance.choice(NUMBERS).encode()
        value = b" ".join(words)
    elif how == 7:
        value = chance.choice((b" ", b"\t", b"\n", b"  ", b"\xc2\xa0")).join(value.split())
    elif how == 8:
        key = chance.choice(found)[1]
    else:
        again = chance.choice((b"", one[0] + b" " + one[0]))
        return data[: one.start()] + again + data[one.end() :]
    return data[: one.start()] + key + equals + mark + value + mark + data[one.end() :]


def _elements(data: bytes) -> list[tuple[int, int, int]]:
    """Return where each element starts, where its inside ends (its end if it is empty), and where it ends."""
    found: list[tuple[int, int, int]] = []
    waiting: list[tuple[int, bytes]] = []
    for match in _TAG.finditer(data):
        if match[2] is None:
            continue
        if match[4]:
            found.append((match.start(), match.end(), match.end()))
        elif not match[1]:
            waiting.append((match.start(), match[2]))
        elif waiting and waiting[-1][1] == match[2]:
            found.append((waiting.pop()[0], match.start(), match.end()))
    return found


def _element(data: bytes, chance: random.Random) -> bytes:
    """Delete, double, move, swap, rename or add an element."""
    found = _elements(data)
    if not found:
        return _bytes(data, chance)
    start, inside, end = chance.choice(found)
    other, into, until = chance.choice(found)
    element = data[start:end]
    how = chance.randrange(8)
    if how == 0:
        return data[:start] + data[end:]
    if how == 1:
        return data[:end] + element + data[end:]
    if how == 2:  # copied into another element
        return data[:into] + element + data[into:]
    if how == 3 and not start <= into <= end:  # moved into another element
        rest = data[:start] + data[end:]
        into -= len(element) if into > start else 0
        return rest[:into] + element + rest[into:]
    if how == 4 and (end <= other or until <= start):  # swapped
        (start, end), (other, until) = sorted(((start, end), (other, until)))
        return data[:start] + data[other:until] + data[end:other] + data[start:end] + data[until:]
    if how == 5:
        tag = chance.choice(TAGS).encode()
        return (
            data[:start]
            + re.sub(
                rb"^<[A-Za-z_:]+|(?<=</)[A-Za-z_:]+(?=>$)", lambda m: b"<" + tag if m[0][:1] == b"<" else tag, element
            )
            + data[end:]
        )
    snippet = _filled(chance.choice(SNIPPETS), data, chance).encode()
    return data[:inside] + snippet + data[inside:]


# --- judging ---------------------------------------------------------------------------------------------------


def judge(data: bytes, path: Path) -> str:
    """Return "answered", or the name of the error by which a file was refused.

    Raises:
        AssertionError, or whatever else comes through: the library did neither properly.
    """
    path.write_bytes(data)
    try:
        model = ks.load(path)
        found = ks.summary(model)
    except ks.RobotError as error:
        _check_message(error, path)
        return type(error).__name__
    assert all(map(math.isfinite, (found.base_mass, found.moving_mass, found.reach))), found
    assert found.certificate.agree is True, f"masses: {found.certificate}"
    outcome = "answered"
    frame = model.robot.links[-1].name
    for wanted in ("zero", "random:1", "mid"):
        try:
            q = ks.configuration(model.robot, wanted).q
        except ks.ConfigurationError as error:
            _check_message(error)
            outcome = type(error).__name__
            continue
        assert np.isfinite(q).all(), (wanted, q)
        for what, result in (("jacobian", ks.jacobian(model, frame, q)), ("fk", ks.fk(model, frame, q))):
            assert np.isfinite(result.matrix).all(), f"{what} at {wanted}: {result.matrix}"
            assert result.certificate.agree is True, f"{what} at {wanted}: {result.certificate}"
    return outcome


def _check_message(error: ks.KinetostatError, path: Path | None = None) -> None:
    text = str(error)
    assert text.isprintable(), repr(text)
    assert len(text) < 1500, len(text)
    assert path is None or str(path) in text, f"{type(error).__name__} does not name the file: {text}"
    assert error.exit_code == (2 if path is None else 3)


def main() -> None:
    """Judge seeds and say on standard output, line by line, what became of each."""
    first, *rest = map(int, sys.argv[1:])
    if not rest:
        sys.stdout.buffer.write(mutated(first)[1])
        return
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + rest[0]):
            print(json.dumps({"seed": seed}), flush=True)
            name, data = mutated(seed)
            try:
                outcome, fault = judge(data, Path(folder, "mutated.urdf")), ""
            except Exception as error:
                where = traceback.extract_tb(error.__traceback__)[-1]
                outcome = "fault"
                fault = (
                    f"{name}: {type(error).__name__} at {Path(where.filename).name}:{where.lineno}: {str(error)[:600]}"
                )
            print(json.dumps({"seed": seed, "outcome": outcome, "fault": fault}), flush=True)


if __name__ == "__main__":
    main()
