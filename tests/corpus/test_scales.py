"""Robots of random shape whose numbers reach to the ends of what the reader accepts: both engines still agree."""

from __future__ import annotations

import random
import warnings
from dataclasses import dataclass

import pytest

from corpus.generated import robot
from corpus.mutations import judge

TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "screw")
ROBOTS = 250


@dataclass(frozen=True)
class Scale:
    """The largest powers of ten of each kind of number."""

    length: float
    angle: float
    limit: float
    mass: float
    multiplier: float
    offset: float
    pitch: float


SCALES = {
    "ordinary": Scale(0.5, 0.5, 1, 2, 0.5, 0.5, -1),
    "large": Scale(3, 2, 2, 5, 2, 2, 0),
    "to the ends": Scale(11.9, 5.9, 11, 14.9, 5.9, 11, 11),
}


class Maker:
    """Makes one robot by a seed."""

    def __init__(self, seed: int, scale: Scale) -> None:
        self.chance = random.Random(seed)
        self.scale = scale

    def number(self, smallest: float, largest: float) -> str:
        """Return a number of random sign, its size spread over the decades."""
        return repr(self.chance.choice((-1, 1)) * 10 ** self.chance.uniform(smallest, largest))

    def triple(self, smallest: float, largest: float) -> str:
        return " ".join(self.number(smallest, largest) for _ in range(3))

    def link(self, i: int) -> str:
        if self.chance.random() < 0.5:
            return f'<link name="l{i}"/>'
        moments = " ".join(
            f'{key}="{self.number(-12, self.scale.mass)}"' for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        placed = f'<origin xyz="{self.triple(-12, self.scale.length)}"/>'
        mass = f'<mass value="{self.number(-12, self.scale.mass)}"/>'
        return f'<link name="l{i}"><inertial>{placed}{mass}<inertia {moments}/></inertial></link>'

    def joint(self, i: int, leaders: list[str]) -> str:
        scale, kind, inside = self.scale, self.chance.choice(TYPES), ""
        if kind in ("revolute", "prismatic") and self.chance.random() < 0.8:
            inside += f'<limit lower="{self.number(-3, scale.limit)}" upper="{self.number(-3, scale.limit)}"/>'
        if kind == "screw":
            inside += f'<drake:screw_thread_pitch value="{self.number(-6, scale.pitch)}"/>'
        if kind in ("revolute", "prismatic", "continuous", "screw"):
            if leaders and self.chance.random() < 0.3:
                law = f'multiplier="{self.number(-3, scale.multiplier)}" offset="{self.number(-3, scale.offset)}"'
                inside += f'<mimic joint="{self.chance.choice(leaders)}" {law}/>'
            leaders.append(f"j{i}")
        # Often one component dominates: nearly along a coordinate axis, or nearly against it, is the hard part.
        axis = [self.number(-13, 0), self.number(-9, 0), self.number(-2, 1)]
        self.chance.shuffle(axis)
        tag = "drake:joint" if kind == "screw" else "joint"
        return (
            f'<{tag} name="j{i}" type="{kind}"><parent link="l{self.chance.randrange(i)}"/><child link="l{i}"/>'
            f'<origin xyz="{self.triple(-12, scale.length)}" rpy="{self.triple(-9, scale.angle)}"/>'
            f'<axis xyz="{" ".join(axis)}"/>{inside}</{tag}>'
        )

    def robot(self) -> bytes:
        count, leaders = self.chance.randrange(1, 8), list[str]()
        return robot([self.link(i) for i in range(count + 1)] + [self.joint(i, leaders) for i in range(1, count + 1)])


@pytest.mark.parametrize("name", SCALES)
def test_both_engines_agree_on_robots_of_every_scale(name, tmp_path):
    faults = []
    for seed in range(ROBOTS):
        data = Maker(seed, SCALES[name]).robot()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                assert judge(data, tmp_path / "made.urdf") == "answered"
        except Exception as error:
            faults.append(f"{name}, seed {seed}: {type(error).__name__}: {str(error)[:200]}\n{data.decode()}")
    assert not faults, f"{len(faults)} of {ROBOTS}; the shortest: {min(faults, key=len)}"
