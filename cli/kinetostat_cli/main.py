"""The entry point: the commands, and the boundary at which every error becomes one line and an exit code."""

from __future__ import annotations

import os
import signal
import sys
import traceback
from importlib import import_module
from typing import Annotated

import typer

from kinetostat_cli import completion
from kinetostat_cli.console import INTERRUPTED, say
from kinetostat_cli.options import joined_axes

__all__ = ["COMMANDS", "build", "main", "run"]

COMMANDS = (
    "robots",
    "info",
    "frames",
    "fk",
    "jacobian",
    "adjoint",
    "manipulability",
    "torque",
    "velocity",
    "rates",
    "ik",
    "error",
    "check",
    "rules",
    "explain",
    "init",
    "diff",
    "sweep",
    "map",
    "trajectory",
    "report",
    "singular",
)

BUG = 70
SIGNALLED = 128
# The base of Typer's usage errors, which it keeps in click or in a copy of click of its own.
_CommandLineError = typer.BadParameter.__mro__[2]


def build(arguments: list[str]) -> typer.Typer:
    """Return the application. Only the command that is asked for is loaded; all of them for help and completion."""
    app = typer.Typer(
        name="kinetostat",
        no_args_is_help=True,
        rich_markup_mode=None,  # plain help is easier to read in 80 columns
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_options)
    asked = [name for name in COMMANDS if arguments[:1] == [name]]
    for name in asked or COMMANDS:
        import_module(f"kinetostat_cli.commands.{name}").register(app)
    return app


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"kinetostat {version('kinetostat')} (Pinocchio {version('pin')}, NumPy {version('numpy')})")
        raise typer.Exit


def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show versions and exit.")
    ] = False,
) -> None:
    """Kinetostatics of URDF robots: every number computed twice, by Pinocchio and by screw theory."""


def main() -> None:
    """Run the command line and exit."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a name that the terminal's encoding cannot show is escaped, not fatal
            stream.reconfigure(errors="backslashreplace")
    for number in (signal.SIGTERM, signal.SIGHUP):  # so that what was started is stopped
        if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup wants it
            signal.signal(number, lambda received, _: sys.exit(SIGNALLED + received))
    if os.environ.get("_KINETOSTAT_COMPLETE") == "complete_bash":
        sys.exit(completion.answer_bash(lambda: run([])))
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code."""
    arguments, debug = joined_axes(arguments), "--debug" in arguments
    try:
        code = int(build(arguments)(arguments, standalone_mode=False, prog_name="kinetostat") or 0)
    except typer.Exit as stop:
        return stop.exit_code
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    except Exception as error:
        if debug:
            traceback.print_exc()
        if isinstance(error, _CommandLineError):
            return _usage(error)
        return _library(error)
    if code == INTERRUPTED:  # typer, too, makes this code of Ctrl-C
        print("kinetostat: interrupted", file=sys.stderr)
    return code


def _usage(error: Exception) -> int:
    """Answer for an unknown command or option, a missing argument."""
    if type(error).__name__ == "NoArgsIsHelpError":
        print(error.format_message())  # type: ignore[attr-defined]
        return 2
    context = getattr(error, "ctx", None)
    hint = f" (see '{context.command_path} --help')" if context is not None else ""
    say("error", f"{' '.join(error.format_message().split()).rstrip('.')}{hint}")  # type: ignore[attr-defined]
    return 2


def _library(error: Exception) -> int:
    """Answer for one of our own errors, or for a bug."""
    from kinetostat.errors import KinetostatError, printable

    if isinstance(error, KinetostatError):
        say("error", str(error))
        return error.exit_code
    say("error", f"this is a bug in kinetostat: {type(error).__name__}: {printable(str(error))[:200]}")
    say("error", "please report it with the robot file and the command; --debug shows where it happened")
    return BUG


if __name__ == "__main__":
    main()
