"""`ik` against Pink and TRAC-IK: 1,000 reachable random poses of three arms, the same poses and starts for all.

A pose is that of random joints inside limits; a start is another such configuration. Success is judged here, for all
alike, by Pinocchio's forward kinematics: position within 1e-6 m, rotation within 1e-6 rad, joints inside their limits.
TRAC-IK stops at its own tolerance, 1e-5 unless told: it is run with that, and with 1e-7. Peers are asked for one pose
after the other, as their users do; they get the chain alone, hands locked. Times are per pose, in one process; TRAC-IK
has two threads of its own.
"""

import importlib.util
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import kinetostat as ks

ARMS = (
    ("example:panda", "panda_hand"),
    ("example:ur5_robot", "tool0"),
    ("example:kinova", "j2s6s200_end_effector"),
)
POSES = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
WANTED, LOOSE = 1e-6, 1e-5  # m and rad
SLACK = 1e-5  # rad by which a joint may be beyond its limit, which files round
PINK_STEPS, PINK_TRIES = 100, 100
TRAC_SECONDS = (0.005, 0.05)  # its default, and what makes it surer
MISSING = "not installed: pip install 'kinetostat[bench]'"


@dataclass(frozen=True)
class Arm:
    """A chain as Pinocchio sees it, other joints locked, and the poses and starts (N, n), in the chain's order."""

    model: ks.Model
    frame: str
    chain: Any
    indices: list[int]
    lower: np.ndarray
    upper: np.ndarray
    poses: np.ndarray
    starts: np.ndarray

    def inside(self, generator: np.random.Generator, count: int) -> np.ndarray:
        """Return random coordinates inside limits, (count, n); a joint without limits turns once."""
        low, high = (np.where(np.isfinite(x), x, side * np.pi) for x, side in ((self.lower, -1), (self.upper, 1)))
        return generator.uniform(low, high, (count, len(low)))

    def pinocchio(self, q: np.ndarray) -> np.ndarray:
        """Return Pinocchio's configuration: a continuous joint is a cosine and a sine."""
        parts = [
            [np.cos(x), np.sin(x)] if joint.nq == 2 else [x] for x, joint in zip(q, self.chain.joints[1:], strict=True)
        ]
        return np.concatenate(parts)

    def coordinates(self, full: np.ndarray) -> np.ndarray:
        """Return angles (n,) of Pinocchio's configuration."""
        return np.array(
            [
                np.arctan2(full[j.idx_q + 1], full[j.idx_q]) if j.nq == 2 else full[j.idx_q]
                for j in self.chain.joints[1:]
            ]
        )


def arm_of(source: str, frame: str) -> Arm:
    """Return an arm with its poses and starts."""
    model = ks.load(source)
    robot = model.robot
    path = robot.moving_joints(robot.root, frame)
    whole = pin.buildModelFromUrdf(str(model.loaded.source.path))  # the file itself: its limits are the peers'
    names = {joint.name for joint in path}
    locked = [i for i, name in enumerate(whole.names) if i and name not in names]
    chain = pin.buildReducedModel(whole, locked, pin.neutral(whole))
    limits = np.array([joint.limit.range for joint in path])
    indices = [robot.position_slices[joint.name].start for joint in path]
    assert list(chain.names)[1:] == [joint.name for joint in path]
    generator = np.random.default_rng(0)
    arm = Arm(model, frame, chain, indices, limits[:, 0], limits[:, 1], np.empty(0), np.empty(0))
    goals, starts = arm.inside(generator, POSES), arm.inside(generator, POSES)
    poses = np.array([placement(arm, arm.pinocchio(q)).homogeneous for q in goals])
    return Arm(model, frame, chain, indices, limits[:, 0], limits[:, 1], poses, starts)


def placement(arm: Arm, full: np.ndarray) -> Any:
    """Return Pinocchio's placement of the tool."""
    data = arm.chain.createData()
    pin.framesForwardKinematics(arm.chain, data, full)
    return data.oMf[arm.chain.getFrameId(arm.frame)]


def successes(arm: Arm, found: list[np.ndarray | None], tolerance: float) -> float:
    """Return the share of poses that are reached by joints inside limits."""
    good = 0
    for q, target in zip(found, arm.poses, strict=True):
        if q is None or not np.all((q >= arm.lower - SLACK) & (q <= arm.upper + SLACK)):
            continue
        here = placement(arm, arm.pinocchio(q)).homogeneous
        turn = np.linalg.norm(pin.log3(target[:3, :3] @ here[:3, :3].T))
        good += bool(np.linalg.norm(here[:3, 3] - target[:3, 3]) < tolerance and turn < tolerance)
    return good / len(found)


Solve = Callable[[np.ndarray, np.ndarray], np.ndarray | None]


def one_by_one(arm: Arm, solve: Solve) -> tuple[list[np.ndarray | None], np.ndarray]:
    """Return what each pose gives, and the seconds that it takes."""
    found, seconds = list[np.ndarray | None](), []
    for target, start in zip(arm.poses, arm.starts, strict=True):
        begun = time.perf_counter()
        found.append(solve(target, start))
        seconds.append(time.perf_counter() - begun)
    return found, np.array(seconds)


def show(name: str, arm: Arm, found: list[np.ndarray | None], seconds: np.ndarray) -> None:
    """Print a line of the table."""
    shares = "".join(f"{100 * successes(arm, found, tolerance):>9.1f} %" for tolerance in (WANTED, LOOSE))
    spread = f"{1e3 * np.median(seconds):>10.3f} {1e3 * np.quantile(seconds, 0.95):>9.3f}"
    print(f"  {name:<38}{shares}{spread}", flush=True)


# --- ours --------------------------------------------------------------------------------------------------------


def ours(arm: Arm, model: ks.Model) -> Solve:
    """Return a call of `ik` as a user makes it."""
    rest = ks.configuration(model, "zero").q

    def solve(target: np.ndarray, start: np.ndarray) -> np.ndarray:
        q = rest.copy()
        q[arm.indices] = start
        return ks.ik(model, arm.frame, target, q).q[arm.indices]

    return solve


def show_batch(arm: Arm, model: ks.Model) -> None:
    """Print the line of all poses in one call."""
    q = np.tile(ks.configuration(model, "zero").q, (POSES, 1))
    q[:, arm.indices] = arm.starts
    begun = time.perf_counter()
    found = ks.ik(model, arm.frame, arm.poses, q)
    each = (time.perf_counter() - begun) / POSES
    show("kinetostat, one call, cross-checked", arm, list(found.q[:, arm.indices]), np.full(POSES, each))


# --- peers -------------------------------------------------------------------------------------------------------


def pink(arm: Arm, tries: int) -> Solve:
    """Return Pink's differential loop, steps of 1 s at gain 1, until it is there; then other starts, if it may."""
    from pink import Configuration, solve_ik
    from pink.limits import ConfigurationLimit
    from pink.tasks import FrameTask

    task = FrameTask(arm.frame, position_cost=1.0, orientation_cost=1.0, lm_damping=1e-6)
    limits = [ConfigurationLimit(arm.chain)]
    data, generator = arm.chain.createData(), np.random.default_rng(1)

    def solve(target: np.ndarray, start: np.ndarray) -> np.ndarray | None:
        task.set_target(pin.SE3(target))
        for attempt in range(tries):
            first = start if attempt == 0 else arm.inside(generator, 1)[0]
            at = Configuration(arm.chain, data, arm.pinocchio(first))
            for _ in range(PINK_STEPS):
                if np.linalg.norm(task.compute_error(at)) < WANTED / 10:
                    return arm.coordinates(at.q)
                try:
                    rates = solve_ik(at, [task], 1.0, solver="quadprog", limits=limits, safety_break=False)
                except Exception:  # its QP has no solution: a failed attempt
                    break
                at.integrate_inplace(rates, 1.0)
        return None

    return solve


def trac(arm: Arm, seconds: float, tolerance: float) -> Solve:
    """Return a call of TRAC-IK, which has its own restarts."""
    import pytracik
    from trac_ik.trac_ik import quaternion_from_matrix

    text, root = Path(arm.model.loaded.source.path).read_text(), arm.model.robot.root
    solver = pytracik.TRAC_IK(root, arm.frame, text, seconds, tolerance, pytracik.SolveType.Speed)
    # The binding reads most limits as zero; a joint without limits may turn twice.
    lower, upper = (np.nan_to_num(x, neginf=-2 * np.pi, posinf=2 * np.pi) for x in (arm.lower, arm.upper))
    pytracik.set_joint_limits(solver, lower.tolist(), upper.tolist())

    def solve(target: np.ndarray, start: np.ndarray) -> np.ndarray | None:
        w, x, y, z = quaternion_from_matrix(target[:3, :3])
        found = np.asarray(pytracik.ik(solver, start, *target[:3, 3], x, y, z, w))
        return found[1:] if found[0] >= 0 else None

    return solve


def main() -> None:
    """Print a block for each arm."""
    installed = {name: importlib.util.find_spec(name) is not None for name in ("pink", "quadprog", "pytracik")}
    for name, there in installed.items():
        if not there:
            print(f"{name} is {MISSING}")
    print(f"{POSES} reachable poses, random starts; success: 1e-6 m and rad, limits kept (and the same at 1e-5)")
    print(f"  {'':<38}{'at 1e-6':>11}{'at 1e-5':>11}{'median ms':>10}{'95 % ms':>10}")
    for source, frame in ARMS:
        arm = arm_of(source, frame)
        print(f"{source}, {frame}, {len(arm.indices)} joints")
        alone = ks.load(source, crosscheck=False)
        show("kinetostat, cross-checked", arm, *one_by_one(arm, ours(arm, arm.model)))
        show("kinetostat, crosscheck=False", arm, *one_by_one(arm, ours(arm, alone)))
        show_batch(arm, arm.model)
        if installed["pink"] and installed["quadprog"]:
            for tries in (1, PINK_TRIES):
                name = f"Pink, {PINK_STEPS} steps" + (f", {tries} starts at most" if tries > 1 else ", one start")
                show(name, arm, *one_by_one(arm, pink(arm, tries)))
        if installed["pytracik"]:
            for seconds in TRAC_SECONDS:
                for tolerance in (LOOSE, WANTED / 10):
                    name = f"TRAC-IK, {1e3 * seconds:g} ms, eps {tolerance:g}"
                    show(name, arm, *one_by_one(arm, trac(arm, seconds, tolerance)))


if __name__ == "__main__":
    main()
