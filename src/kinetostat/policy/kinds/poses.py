"""Where frames are, and where they can be."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from msgspec import Meta

from kinetostat.policy import words
from kinetostat.policy.kinds.common import Kind, Observer, OfFrame, Point, Range, Seed, Start, measured_in

__all__ = ["Golden", "Reach", "Reaches", "Symmetry"]


class Reaches(OfFrame, frozen=True, kw_only=True, tag="reaches"):
    """The frame reaches poses inside joint limits.

    By inverse kinematics from several starts: a pose that is met is reached, by a configuration that both engines place
    there; that one is not met is no proof that it cannot be. The witness is what comes nearest.
    """

    example: ClassVar[str] = 'frame = "tool0"\nposes = [[0.4, 0.1, 0.3], "0.4,-0.1,0.3 rpy 0,3.1416,0"]'

    poses: Annotated[
        tuple[str | tuple[float, ...], ...],
        Meta(
            description="x, y, z in m; 6 with roll, pitch, yaw; 7 with a quaternion xyzw; 12 or 16 of a matrix; "
            "or text as of `kinetostat ik --pose`: 'x,y,z rpy r,p,y'.",
            examples=[[[0.4, 0.1, 0.3], [0.4, 0.1, 0.3, 0.0, 1.5708, 0.0]], ["0.4,0.1,0.3 rpy 0,1.5708,0"]],
            extra=measured_in("m, rad"),
        ),
    ] = ()
    file: Annotated[
        str,
        Meta(
            description="A CSV file beside this one: a pose a row, 3, 6, 7, 12 or 16 numbers; a header or none.",
            examples=["poses.csv"],
        ),
    ] = ""
    at: Start = "zero"
    point: Point = None
    rows: Annotated[
        str,
        Meta(
            description="The rows that count: all, translation, rotation, or some of x y z rx ry rz. Default: all that "
            "a pose has.",
            examples=["translation", "x y rz"],
        ),
    ] = ""
    reference: Annotated[
        Literal["aligned", "local"], Meta(description="Whose axes the rows are in: the observer's, or the frame's.")
    ] = "aligned"
    position_tolerance: Annotated[
        float, Meta(ge=0, description="What the position may be missed by.", extra=measured_in("m"))
    ] = 1e-6
    rotation_tolerance: Annotated[
        float, Meta(ge=0, description="What the rotation may be missed by.", extra=measured_in("rad"))
    ] = 1e-6
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
    """The largest distance between the origins of two frames, over all configurations inside limits.

    Searched from random configurations: a lower bound of the true one.
    """

    about: ClassVar[str] = "reach"
    unit: ClassVar[str] = "m"
    example: ClassVar[str] = 'frame = "tool0"\nrelative-to = "base_link"\nat-least = 0.85'

    samples: Annotated[int, Meta(ge=1, le=1_000_000, description="Random configurations to climb from.")] = 2000
    seed: Seed = 0


class Golden(Kind, frozen=True, kw_only=True, tag="golden"):
    """A placement or a Jacobian is what a file says: one that `kinetostat fk` or `jacobian` wrote as JSON.

    The file knows frame and configuration. `kinetostat fk ROBOT -f tool0 -q random:0 -F json -o tool0.json` writes one;
    a random configuration notices what zero does not, such as an axis that is turned round. Where the file is not met,
    the command that renews it is told.
    """

    example: ClassVar[str] = 'file = "tool0.json"'

    file: Annotated[str, Meta(description="The file, relative to this one's folder.", examples=["tool0.json"])]
    tolerance: Annotated[
        float,
        Meta(
            ge=0,
            description="What numbers may differ by: those of a placement, or the entries of a Jacobian.",
            extra=measured_in("m, rad"),
        ),
    ] = 1e-9

    @property
    def title(self) -> str:
        """Which file."""
        return f"as in {words.name(self.file)}"

    @property
    def wanted(self) -> str:
        """What is wanted."""
        return f"within {self.tolerance:g} m and rad"


class Symmetry(Kind, frozen=True, kw_only=True, tag="symmetry"):
    """Two chains are mirror images of each other: at mirrored configurations their frames are mirrored.

    Joints are paired in the order in which they come on the two paths; those that both chains share stay at zero. The
    right frame may name its axes otherwise than the mirrored left one by quarter turns.
    """

    example: ClassVar[str] = 'left = "left_hand"\nright = "right_hand"\nplane = "xz"'

    left: Annotated[str, Meta(description="One frame, a link.", examples=["left_hand"])]
    right: Annotated[str, Meta(description="The other.", examples=["right_hand"])]
    plane: Annotated[
        Literal["xy", "xz", "yz"],
        Meta(
            description="The mirror, a plane through the observer's origin that holds these two of its axes. xz: left "
            "and right are at +y and -y, as ROS has them."
        ),
    ] = "xz"
    relative_to: Observer = ""
    tolerance: Annotated[
        float, Meta(ge=0, description="What placements may differ by.", extra=measured_in("m, rad"))
    ] = 1e-6
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
