"""The profile of a robot: what is known of it, limb by limb, every number by both engines."""

from __future__ import annotations

from collections.abc import Callable

from kinetostat.analysis.configuration import configuration, contradicted
from kinetostat.analysis.crosscheck import Certificate
from kinetostat.analysis.profile.anatomy import Anatomy
from kinetostat.analysis.profile.gathering import Gathered
from kinetostat.analysis.profile.limb_profiling import Asked, limb_profile
from kinetostat.analysis.profile.limbs import limbs
from kinetostat.analysis.profile.result import LimbProfile, RobotProfile
from kinetostat.analysis.statics import refuse_negative_masses
from kinetostat.analysis.summary import Summary, summary
from kinetostat.analysis.worst import WorstTorques, worst_torques
from kinetostat.engines.model import Model
from kinetostat.errors import NumberError, cut, quoted
from kinetostat.urdf.description import Robot

__all__ = ["profile"]

_WORST = "worst gravity torques"
_CLIMBED = 150  # joints: the climb takes the third power of their number


def profile(
    model: Model,
    anatomy: Anatomy | None = None,
    *,
    samples: int = 20_000,
    seed: int = 0,
    payload: float | None = None,
    starts: int = 300,
    progress: Callable[[str, float], None] | None = None,
) -> RobotProfile:
    """Return what is known of a robot, limb by limb.

    What is refused of one limb, or of the robot, is None in the profile, and `left` says why; the rest goes on.

    Args:
        model: the robot.
        anatomy: its limbs; None: those that `limbs.limbs` finds.
        samples: how many random configurations inside limits each limb's measures are of.
        seed: of the random numbers.
        payload: what each limb is to carry, kg, but for those that have a payload of their own; None: nothing.
        starts: how many searches for singular configurations of each limb.
        progress: told what is being done, and which share of all it is.

    Raises:
        EngineError: Pinocchio refuses the robot.
    """
    tell, anatomy = progress or (lambda _what, _share: None), anatomy or limbs(model)
    certificates = dict[str, Certificate]()
    gathered = Gathered(certificates)
    made = summary(model)
    gathered.certify("masses", made.certificate)
    _say_how_limits_are_read(model.robot, gathered)
    weightless = _weightless(model, made)
    asked = Asked(samples, seed, payload, starts, weightless)
    steps = len(anatomy.limbs) + 1
    tell(_WORST, 0.0)
    worst = _worst(model, weightless, seed, gathered)
    found = list[LimbProfile]()
    for i, limb in enumerate(anatomy.limbs):

        def of_limb(what: str, share: float, done: int = i + 1, name: str = cut(limb.name)) -> None:
            tell(f"{name}: {what}", (done + share) / steps)

        found.append(limb_profile(model, limb, asked, certificates, of_limb))
    tell("done", 1.0)
    return RobotProfile(model, made, tuple(found), worst, (*anatomy.left, *gathered.left), certificates)


def _say_how_limits_are_read(robot: Robot, gathered: Gathered) -> None:
    """Tell of limits that are not taken as the file has them."""
    swapped = [joint.name for joint in robot.joints if joint.limit.swapped]
    if swapped:
        gathered.leave(f"limits of {quoted(swapped)}", "lower is above upper: read the other way round")
    leaders = contradicted(robot)
    if leaders:
        gathered.leave(f"limits of followers of {quoted(leaders)}", "they leave it no range: left out of account")


def _weightless(model: Model, made: Summary) -> str | None:
    """Return why nothing can be said of weight; None if it can."""
    try:
        refuse_negative_masses(model)
    except NumberError as error:
        return error.message
    return "no link that moves has a mass" if model.robot.independent and made.moving_mass == 0 else None


def _worst(model: Model, weightless: str | None, seed: int, gathered: Gathered) -> WorstTorques | None:
    if weightless is not None:
        gathered.leave(_WORST, weightless)
        return None
    joints = len(model.robot.independent)
    if joints > _CLIMBED:
        gathered.leave(_WORST, f"looked for in robots of up to {_CLIMBED} joints, and this has {joints}")
        return None
    found = gathered.attempt(_WORST, lambda: worst_torques(model, configuration(model, "mid").q, seed=seed))
    if found is not None:
        gathered.certify(_WORST, found.certificate)
    return found
