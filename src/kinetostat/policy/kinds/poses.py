"""Where frames are, and where they can be."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from kinetostat.policy import words
from kinetostat.policy.kinds.common import Kind, Observer, OfFrame, Point, Range, Seed, Start

__all__ = ["Golden", "Reach", "Reaches", "Symmetry"]


class Reaches(OfFrame, frozen=True, kw_only=True, tag="reaches"):
    """The frame reaches poses inside joint limits."""

    poses: Annotated[
        tuple[str | tuple[float, ...], ...],
        Meta(
            description="x, y, z in m; 6 with roll, pitch, yaw; 7 with a quaternion xyzw; 12 or 16 of a matrix; "
            "or text as of `kinetostat ik --pose`: 'x,y,z rpy r,p,y'."
        ),
    ] = ()
    file: Annotated[
        str, Meta(description="A CSV file beside this one: a pose a row, 3, 6, 7, 12 or 16 numbers; a header or none.")
    ] = ""
    at: Start = "zero"
    point: Point = None
    rows: Annotated[str, Meta(description="The rows that count. Default: all that a pose has.")] = ""
    reference: Annotated[
        Literal["aligned", "local"], Meta(description="Whose axes the rows are in: the observer's, or the frame's.")
    ] = "aligned"
    position_tolerance: Annotated[float, Meta(ge=0, description="What the position may be missed by, m.")] = 1e-6
    rotation_tolerance: Annotated[float, Meta(ge=0, description="What the rotation may be missed by, rad.")] = 1e-6
    tries: Annotated[int, Meta(ge=1, le=10_000, description="How many starts at most, the first being `at`.")] = 100
    seed: Seed = 0

    def __post_init__(self) -> None:
        """Refuse poses and rows that cannot be."""
        if bool(self.poses) == bool(self.file):
            raise ValueError("give either poses or a file of them")
        for one in self.poses:
            words.check_pose(one)
        if self.rows:
            words.check_rows(self.rows)

    @property
    def title(self) -> str:
        """Which frame, which poses."""
        number = f"the poses of {words.name(self.file)}" if self.file else words.counted(len(self.poses), "pose")
        return f"{words.frame(self.frame, self.relative_to)} reaches {number}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return f"every one inside joint limits, to {self.position_tolerance:g} m and {self.rotation_tolerance:g} rad"


class Reach(Range, frozen=True, kw_only=True, tag="reach"):
    """The largest distance between the origins of two frames, over all configurations inside limits."""

    about: ClassVar[str] = "reach"
    unit: ClassVar[str] = "m"

    samples: Annotated[int, Meta(ge=1, le=1_000_000, description="Random configurations to climb from.")] = 2000
    seed: Seed = 0


class Golden(Kind, frozen=True, kw_only=True, tag="golden"):
    """A placement or a Jacobian is what a file says: one that `kinetostat fk` or `jacobian` wrote as JSON."""

    file: Annotated[str, Meta(description="The file, beside this one: kinetostat fk ROBOT -F json -o golden.json.")]
    tolerance: Annotated[
        float,
        Meta(ge=0, description="What numbers may differ by: m and rad of a placement, entries of a Jacobian."),
    ] = 1e-9

    @property
    def title(self) -> str:
        """Which file."""
        return f"as in {words.name(self.file)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return f"within {self.tolerance:g}"


class Symmetry(Kind, frozen=True, kw_only=True, tag="symmetry"):
    """Two chains are mirror images of each other: at mirrored configurations their frames are mirrored.

    Joints are paired in the order in which they come on the two paths; those that both chains share stay at zero. The
    right frame may name its axes otherwise than the mirrored left one by quarter turns.
    """

    left: Annotated[str, Meta(description="One frame, a link.")]
    right: Annotated[str, Meta(description="The other.")]
    plane: Annotated[Literal["xy", "xz", "yz"], Meta(description="The mirror, in the observer's axes.")] = "xz"
    relative_to: Observer = ""
    tolerance: Annotated[float, Meta(ge=0, description="What placements may differ by, m and rad.")] = 1e-6
    masses: Annotated[bool, Meta(description="Compare the masses that the two chains move, too.")] = True
    mass_tolerance: Annotated[float, Meta(ge=0, le=1, description="What masses may differ by, as a share.")] = 1e-6
    limits: Annotated[bool, Meta(description="Compare limits of position, velocity and effort, too.")] = True
    samples: Annotated[int, Meta(ge=1, le=100_000, description="Random configurations that are compared.")] = 100
    seed: Seed = 0

    @property
    def title(self) -> str:
        """Which frames."""
        return f"{words.name(self.left)} mirrors {words.name(self.right)} about {self.plane}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return f"the same to {self.tolerance:g} m and rad"
