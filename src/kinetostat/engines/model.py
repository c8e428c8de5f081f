"""A robot with its two engines: what every analysis is asked of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import BinaryIO

from kinetostat.engines.protocol import Engine
from kinetostat.errors import DisagreementError, EngineError, quote
from kinetostat.urdf.description import Robot
from kinetostat.urdf.files import MAX_BYTES
from kinetostat.urdf.loading import LoadedRobot, load_robot
from kinetostat.urdf.srdf import Semantics

__all__ = ["Model", "load"]


@dataclass(frozen=True, repr=False)
class Model:
    """A robot as read, and the engines that answer for it. Engines are built when first asked.

    Attributes:
        loaded: the file as read.
        robot: the description, with a free-flying root if `floating_base`.
        floating_base: whether a free-flying root was added.
        crosscheck: whether the screw engine computes every number a second time.
    """

    loaded: LoadedRobot
    robot: Robot
    floating_base: bool = False
    crosscheck: bool = True

    def __repr__(self) -> str:
        size = f"{len(self.robot.links)} links, {self.robot.nv} degrees of freedom"
        return f"<Model {quote(self.loaded.source.name)}: {size}>"

    def __getstate__(self) -> dict[str, object]:
        # Engines hold foreign data that does not travel; the process that unpickles builds its own.
        return {part.name: getattr(self, part.name) for part in fields(self)}

    @property
    def semantics(self) -> Semantics:
        """Groups and states of the SRDF; empty without one."""
        return self.loaded.semantics

    @cached_property
    def engine(self) -> Engine:
        """Pinocchio, whose numbers are given.

        Raises:
            EngineError: Pinocchio refuses the robot.
        """
        from kinetostat.engines.pinocchio import PinocchioEngine

        try:
            return PinocchioEngine(self.loaded.text, floating_base=self.floating_base)
        except EngineError as error:
            error.file = self.loaded.source.name
            error.remedy = error.remedy or "our reader accepts the robot: please report this with the file"
            raise

    @cached_property
    def witness(self) -> Engine | None:
        """The screw engine, which computes them again; None without cross-check.

        Raises:
            DisagreementError: the engines do not even see the same coordinates.
        """
        if not self.crosscheck:
            return None
        from kinetostat.engines.screw import ScrewEngine

        engine = ScrewEngine(self.robot)
        if (engine.position_names, engine.velocity_names) != (self.engine.position_names, self.engine.velocity_names):
            raise DisagreementError("the engines read different joints from the file", file=self.loaded.source.name)
        return engine


def load(
    source: str | Path,
    *,
    floating_base: bool = False,
    crosscheck: bool = True,
    srdf: str | Path | None = None,
    package_dirs: Sequence[str | Path] = (),
    xacro_arguments: Mapping[str, str] | None = None,
    max_bytes: int = MAX_BYTES,
    stdin: BinaryIO | None = None,
) -> Model:
    """Read a robot.

    Args:
        source: a path to a `.urdf` or `.xacro` file, `-` (standard input), `textbook:NAME` or `example:NAME`.
        floating_base: add a free-flying joint `root_joint` between a new link `universe` and the file's root link.
        crosscheck: compute every number a second time by the screw engine.
        srdf: the SRDF file; default, one of the robot's name beside it or in `../srdf`.
        package_dirs: folders to look for packages in first.
        xacro_arguments: the arguments of a xacro file.
        max_bytes: refuse larger files.
        stdin: where `-` reads from; default, the process's standard input.

    Raises:
        RobotError: the robot cannot be read, or is not a robot.
        UsageError: there is no such textbook or example robot; a name for the floating base is taken.
    """
    loaded = load_robot(
        str(source),
        srdf=None if srdf is None else Path(srdf),
        package_dirs=tuple(Path(folder) for folder in package_dirs),
        xacro_arguments=xacro_arguments,
        max_bytes=max_bytes,
        stdin=stdin,
    )
    robot = loaded.robot.with_floating_base() if floating_base else loaded.robot
    return Model(loaded, robot, floating_base, crosscheck)
