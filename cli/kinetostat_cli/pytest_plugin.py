"""pytest plugin: `pytest --kinetostat` checks the robot files that it collects; the fixture `robot` loads one.

A test asks for a robot by mark, or is run for every robot that is collected:

    @pytest.mark.robot("urdf/arm.urdf")
    def test_reach(robot):
        assert robot.robot.reach > 0.8
"""

from __future__ import annotations

from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from kinetostat import Model
    from kinetostat.gate.result import CheckReport
    from kinetostat.policy.settings import Settings

__all__ = ["pytest_addoption", "pytest_collect_file", "pytest_configure", "robot"]

_EXCLUDED = pytest.StashKey[dict[Path, tuple[str, ...]]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add --kinetostat."""
    group = parser.getgroup("kinetostat", "robot models")
    group.addoption("--kinetostat", action="store_true", help="Check robot files (.urdf, .urdf.xacro) as tests.")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the mark."""
    config.addinivalue_line("markers", "robot(path): the robot that the fixture `robot` loads for this test")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Return a collector for a robot file; none for one that the settings exclude, unless it is named."""
    if not parent.config.getoption("--kinetostat"):
        return None
    from kinetostat.gate.targets import is_robot_file

    if not is_robot_file(file_path.name):
        return None
    if not parent.session.isinitpath(file_path) and _is_excluded(file_path, parent.config):
        return None
    return RobotFile.from_parent(parent, path=file_path)


class RobotFile(pytest.File):
    """A robot file: one test, which checks it."""

    def collect(self) -> Iterator[pytest.Item]:
        """Yield its test."""
        yield RobotItem.from_parent(self, name="check")


class CheckFailedError(Exception):
    """A robot file did not pass; holds the report as text."""


class RobotItem(pytest.Item):
    """The check of one robot file: what `kinetostat check FILE` says, in a process of its own."""

    def runtest(self) -> None:
        """Check the file.

        Raises:
            CheckFailedError: it does not pass.
        """
        report = _checked(self.path, self.config.rootpath)
        if not report.passed:
            from kinetostat.report.check import rendered

            raise CheckFailedError(rendered(report, "text"))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *args: Any, **kwargs: Any) -> Any:
        """Return the report, or the line that tells what cannot be asked like that, instead of a traceback."""
        from kinetostat import KinetostatError

        if isinstance(excinfo.value, CheckFailedError):
            return str(excinfo.value)
        if isinstance(excinfo.value, KinetostatError):
            return f"kinetostat: error: {excinfo.value}"
        return super().repr_failure(excinfo, *args, **kwargs)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Return what the summary shows."""
        return self.path, None, f"kinetostat check {self.path.name}"


def _is_excluded(path: Path, config: pytest.Config) -> bool:
    """Return whether the settings exclude a file, as `kinetostat check` does where they are."""
    from kinetostat import KinetostatError
    from kinetostat.gate.targets import from_folder
    from kinetostat.policy.settings import find_settings

    try:
        file = find_settings(path.parent)
        if file is None:
            return False
        known = config.stash.setdefault(_EXCLUDED, {})
        if file not in known:
            known[file] = tuple(_settings(file).check.exclude)
    except KinetostatError:
        return False  # the check of the file tells what is wrong with the settings
    name = from_folder(str(path), file.parent)
    return any(fnmatchcase(name, pattern) for pattern in known[file])


def _settings(file: Path) -> Settings:
    from kinetostat.policy.settings import read_settings

    return read_settings(file)


def _checked(path: Path, root: Path) -> CheckReport:
    import kinetostat
    from kinetostat.policy.settings import find_settings

    settings = find_settings(path.parent)
    shown = path.relative_to(root) if path.is_relative_to(root) and Path.cwd() == root else path
    return kinetostat.check(
        [shown],
        settings=_settings(settings) if settings else None,
        folder=settings.parent if settings else path.parent,
        jobs=1,
    )


@pytest.fixture
def robot(request: pytest.FixtureRequest) -> Model:
    """The robot that the test's mark names: `@pytest.mark.robot("arm.urdf")`.

    The path starts from the test's file, else from pytest's root folder.
    """
    import kinetostat

    mark = request.node.get_closest_marker("robot")
    if mark is None or len(mark.args) != 1:
        pytest.fail('the fixture robot needs @pytest.mark.robot("path/to/file.urdf")', pytrace=False)
    name = str(mark.args[0])
    if name.startswith(("example:", "textbook:")):
        return kinetostat.load(name)
    beside, below = request.path.parent / name, request.config.rootpath / name
    if not beside.exists() and not below.exists():
        pytest.fail(f"there is no {name} in {beside.parent}, nor in {request.config.rootpath}", pytrace=False)
    return kinetostat.load(beside if beside.exists() else below)
