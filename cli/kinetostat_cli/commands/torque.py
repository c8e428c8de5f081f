"""`kinetostat torque`: joint torques for wrenches, gravity and payload, and what effort limits allow."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinetostat.conventions import On, Order
from kinetostat_cli import completion
from kinetostat_cli.console import Answer, configuration, load, progress_bar, refuse, triple, write_answer
from kinetostat_cli.lists import Answers, ListOption, answer_list
from kinetostat_cli.options import (
    AxesOption,
    ConfigurationOptions,
    ExpressedInOption,
    FrameOption,
    OrderOption,
    OutputOptions,
    PointOption,
    RobotOptions,
    grouped,
)
from kinetostat_cli.payloads import payload_of

if TYPE_CHECKING:
    from kinetostat import Configuration, ForcePolytope, Load, Model, Strongest, Torques
    from kinetostat.conventions import Array

__all__ = ["register"]

_SAMPLES = 2000


@grouped
def torque(
    robot: RobotOptions,
    at: ConfigurationOptions,
    output: OutputOptions,
    wrench: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FRAME[@POINT]:FX,FY,FZ,MX,MY,MZ",
            help="A wrench at a frame's origin, in N and Nm; @X,Y,Z: at that point of the frame; @world: moment about "
            "the root's origin. May be repeated.",
        ),
    ] = None,
    axes_of: Annotated[
        list[str] | None,
        typer.Option(
            "--in",
            metavar="world|local|FRAME",
            help="Whose axes each --wrench is written in: the root link's, the frame's own, another's.",
        ),
    ] = None,
    on: Annotated[
        On, typer.Option(help="environment: the robot exerts the wrenches, tau = J^T F; robot: they act on it, -J^T F.")
    ] = On.ENVIRONMENT,
    gravity: Annotated[
        bool, typer.Option("--gravity", help="Count the weight of the links: 9.81 m/s2 down the root's z.")
    ] = False,
    gravity_vector: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Gravity in m/s2 in the root's axes; --gravity is 0,0,-9.81.")
    ] = None,
    payload: Annotated[
        str | None, typer.Option(metavar="KG[@X,Y,Z]", help="A mass that --frame holds, at a point of it in m.")
    ] = None,
    reactions: Annotated[
        bool, typer.Option("--reactions", help="Also give force and moment between each link and the next.")
    ] = False,
    largest: Annotated[
        str | None,
        typer.Option(
            "--max",
            metavar="X,Y,Z|x|-z|payload|all",
            help="The largest force of --frame along a direction that effort limits allow, or payload; or all forces. "
            "The links' weight counts (--gravity-vector 0,0,0 leaves it out).",
        ),
    ] = None,
    worst: Annotated[
        bool, typer.Option("--worst", help="The worst gravity torque of each joint over all configurations in limits.")
    ] = False,
    samples: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Random configurations of --worst. Default: 2000.")
    ] = None,
    effort_limits: Annotated[
        str | None,
        typer.Option(
            metavar="J=E,J=LO:HI",
            help="Effort limits in Nm or N instead of the file's.",
            autocompletion=completion.joints,
        ),
    ] = None,
    frame: FrameOption = None,
    expressed_in: ExpressedInOption = None,
    point: PointOption = None,
    axes: AxesOption = None,
    order: OrderOption = Order.LINEAR_FIRST,
    qs: ListOption = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw the arm with the forces of --max all: .svg, .png or .pdf.")
    ] = None,
) -> None:
    """Show the joint torques that hold a robot still.

    Against wrenches at its links, the weight of the links (--gravity) and of a payload: of each joint in Nm (N for
    slides), with its effort limit and use. --reactions, --max and --worst answer more.

    Example: kinetostat torque example:panda -f panda_hand -q default --gravity --payload 2
    """
    import kinetostat
    from kinetostat.analysis.crosscheck import combined
    from kinetostat.report import torque as report
    from kinetostat_cli.values import by_joint

    single = {"--wrench": wrench, "--reactions": reactions or None, "--max": largest, "--qs": qs}
    refuse(worst, single, "does not go with --worst", "leave one of the two out")
    whole = {"--reactions": reactions or None, "--max all": (largest == "all") or None}
    refuse(qs is not None, whole, "does not go with --qs", "leave it out")
    about = {"--expressed-in": expressed_in, "--point": point, "--axes": axes}
    refuse(largest is None, about, "belongs to --max", "add --max")
    refuse(not worst, {"--samples": samples}, "belongs to --worst", "add --worst")
    refuse(not wrench, {"--in": axes_of}, "belongs to --wrench", "add --wrench")
    if plot is not None:
        _check_plot(plot, largest)
    model = load(robot, output)
    tip = model.robot.frame(frame or model.robot.default_tip()) if frame or payload or largest else None
    down: Any = triple(gravity_vector, "--gravity-vector") or gravity or worst or largest is not None
    held, limits = payload_of(payload, tip), by_joint(effort_limits, "--effort-limits")
    bearing: Any = {"gravity": down, "payload": held, "limits": limits}
    if worst:
        _write_worst(model, at, output, samples, bearing)
        return
    wrenches = _wrenches(model, wrench or [], axes_of or [], order)
    if not wrenches and not down and held is None:
        remedy = "give --wrench, --gravity, --payload, --max, --worst"
        raise kinetostat.UsageError("nothing loads the robot", remedy=remedy)
    where = {"expressed_in": expressed_in, "point": triple(point, "--point")}
    question = _Question(model, wrenches, on, bearing, tip, largest, where, axes)
    if qs is not None:
        answer_list("torque", model, qs, at, output, question.row)
        return
    q = configuration(model, at)
    result = question.torques(q.q)
    sections, proofs, warnings = list[report.Section](), [result.certificate], list(result.warnings)
    if reactions:
        between = kinetostat.reactions(model, q.q, result)
        sections.append(report.reactions_section(between, order))
        proofs.append(between.certificate)
    if largest == "all":
        forces = question.all_forces(q.q, result)
        sections.append(report.polytope_section(forces))
        proofs.append(forces.certificate)
        warnings += forces.warnings
        _draw(plot, model, forces, q)
    elif largest is not None:
        most = question.largest_force(q.q, result)
        sections.append(report.strongest_section(most))
        proofs.append(most.certificate)
    write_answer(
        Answer(
            "torque",
            lambda: report.torque_view(result, q, sections, order=order, degrees=at.deg),
            lambda: report.torque_result(result, sections, order),
            model,
            q,
            combined(proofs),
            tuple(warnings),
        ),
        output,
    )


@dataclass(frozen=True)
class _Question:
    """What is asked, apart from the configuration."""

    model: Model
    wrenches: list[Load]
    on: On
    bearing: Any
    frame: str | None
    direction: str | None
    where: Any
    axes: str | None

    def torques(self, q: Array) -> Torques:
        """Return the joint torques."""
        import kinetostat

        return kinetostat.torque(self.model, q, self.wrenches, on=self.on, **self.bearing)

    def largest_force(self, q: Array, rest: Torques) -> Strongest:
        """Return the largest force along the direction, or payload."""
        import kinetostat

        text = self.direction or ""
        direction = triple(text, "--max x|-z|payload|all or") if "," in text else text
        return kinetostat.strongest(self.model, self.frame or "", q, direction or "", rest, **self.where)

    def all_forces(self, q: Array, rest: Torques) -> ForcePolytope:
        """Return the force polytope."""
        import kinetostat

        return kinetostat.force_polytope(self.model, self.frame or "", q, rest, axes=self.axes, **self.where)

    def row(self, q: Array) -> Answers:
        """Return the columns of a list."""
        from kinetostat.report import torque as report

        found = self.torques(q)
        most = None if self.direction is None else self.largest_force(q, found)
        return Answers(*report.torque_columns(found, most))


def _write_worst(
    model: Model, at: ConfigurationOptions, output: OutputOptions, samples: int | None, bearing: dict[str, Any]
) -> None:
    """Answer `torque --worst`; joints with several coordinates are held at the configuration."""
    import kinetostat
    from kinetostat.report import torque as report

    q = kinetostat.configuration(model, at.config, degrees=at.deg, quaternion_first=at.quat.value[0])
    with progress_bar() as tell:
        found = kinetostat.worst_torques(model, q.q, samples=samples or _SAMPLES, progress=tell, **bearing)
    write_answer(
        Answer(
            "torque",
            lambda: report.worst_view(found, q, degrees=at.deg),
            lambda: report.worst_result(found, q),
            model,
            q,
            found.certificate,
            found.warnings,
        ),
        output,
    )


def _draw(plot: Path | None, model: Model, forces: ForcePolytope, q: Configuration) -> None:
    if plot is not None:
        from kinetostat.report.figures import polytope_figure, save

        save(polytope_figure(model, forces, q), plot)


def _check_plot(plot: Path, largest: str | None) -> None:
    from kinetostat.errors import UsageError
    from kinetostat.report.figures import check_suffix

    check_suffix(plot)
    if largest != "all":
        raise UsageError("--plot draws the forces of --max all", remedy="add --max all")


def _wrenches(model: Model, texts: list[str], axes: list[str], order: Order) -> list[Load]:
    """Return the wrenches of --wrench, each written in its own --in, or all in the one that is given."""
    import kinetostat
    from kinetostat.errors import quote
    from kinetostat_cli.values import numbers

    if len(axes) > 1 and len(axes) != len(texts):
        message = f"{len(axes)} times --in for {len(texts)} times --wrench"
        raise kinetostat.UsageError(message, remedy="give one for all, or one for each, in their order")
    found = []
    for i, text in enumerate(texts):
        where, colon, six = text.rpartition(":")
        if not colon:
            message = f"--wrench {quote(text)} names no frame"
            raise kinetostat.UsageError(message, remedy="write FRAME:fx,fy,fz,mx,my,mz")
        link, at, place = where.rpartition("@")
        if where in model.robot.link_by_name or not at:  # a frame's own name may hold an @
            link, place = where, "0,0,0"
        point: Any = place if place == "world" else numbers(place, "--wrench FRAME@", 3)
        values = [numbers(six, "--wrench", 6)[row] for row in order.rows]
        written = axes[min(i, len(axes) - 1)] if axes else "world"
        found.append(kinetostat.load_at(model, link, values, axes=written, point=point))
    return found


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(torque)
