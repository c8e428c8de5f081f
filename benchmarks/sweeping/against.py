"""The kernel against peers: the same numbers first, then all asked in turn, round after round, on one core."""

import statistics
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from peers.chains import Measured, measured
from peers.starting import Peer, running, starts
from sweeping.cases import CHAINS, LARGE, SMALL, kernel_of, microseconds, one_core

SAME = 1e-9  # of the largest: what peers' numbers may differ by
CHECKED = 256
# What is asked, what of the kernel, and how many times faster than Pinocchio with LAPACK's singular values it is to be.
ASKED = (
    ("jacobian", ("jacobian",), "Jacobian", None),
    ("yoshikawa", ("jacobian", "yoshikawa"), "Jacobian and Yoshikawa", 12),
    ("singular_values", ("jacobian", "yoshikawa", "singular_values"), "and all singular values", 4),
)
OURS = "kinetostat"
KEPT, FAR, DROPPED = f"J too, batches of {SMALL}", f"J too, batches of {LARGE}", f"no J, batches of {LARGE}"
WITH_LAPACK = ("LAPACK singular values", "LAPACK", "numpy svd")


def compare(chain: Measured, peers: dict[str, Peer]) -> float:
    """Return the largest difference of a peer's numbers from ours, relative to the largest number.

    Raises:
        ValueError: they are not the same numbers.
    """
    mine = kernel_of(chain, ("yoshikawa", "singular_values"))(chain.q[:CHECKED])
    worst = 0.0
    for peer in peers.values():
        for question in peer.questions:
            ours = mine.get(question.split("/")[0])
            if ours is None:
                continue
            difference = np.max(np.abs(peer.numbers(question) - np.ravel(ours))) / np.max(ours)
            if not difference < SAME:
                raise ValueError(f"{chain.title}: {peer.name}, {question} differs from ours by {difference:.1e}")
            worst = max(worst, float(difference))
    return worst


def rounds(chain: Measured, peers: dict[str, Peer], count: int) -> dict[tuple[str, str], float]:
    """Return the median times of all questions, {(who, question): microseconds}, asked in turn."""
    asked: dict[tuple[str, str], Callable[[], float]] = {}
    for what, outputs, *_ in ASKED:
        kept = kernel_of(chain, outputs)
        asked[OURS, f"{what}/{KEPT}"] = partial(microseconds, kept, chain.q, SMALL)
        asked[OURS, f"{what}/{FAR}"] = partial(microseconds, kept, chain.q, LARGE)
        if what != "jacobian":
            dropped = kernel_of(chain, outputs[1:])
            asked[OURS, f"{what}/{DROPPED}"] = partial(microseconds, dropped, chain.q, LARGE)
    for peer in peers.values():
        for question in peer.questions:
            asked[peer.name, question] = partial(peer.time, question)
    times: dict[tuple[str, str], list[float]] = {key: [] for key in asked}
    for ask in asked.values():
        ask()
    for _ in range(count):
        for key, ask in asked.items():
            times[key].append(ask())
    return {key: statistics.median(values) for key, values in times.items()}


def show_peers(quick: bool) -> None:
    """Print the tables of all chains."""
    found, absent = starts()
    for title, why in absent.items():
        print(f"{title} is absent: {why}")
    for chain in (measured(*each, LARGE) for each in (CHAINS[:1] if quick else CHAINS)):
        with (
            one_core(),
            tempfile.TemporaryDirectory() as folder,
            running(found, chain, Path(folder)) as (peers, failed),
        ):
            for title, why in failed.items():
                print(f"{title} does not start: {why}")
            worst = compare(chain, peers)
            times = rounds(chain, peers, 3 if quick else 9)
        print(f"\n{chain.title}, {len(chain.coordinates.names)} joints; all agree to {worst:.0e}")
        print(f"  {'microseconds per configuration, and times ours':<62} {'us':>7} {'ratio':>7}")
        for what, _, title, wanted in ASKED:
            show_question(what, title, wanted, times)
        show_call(times)


def show_question(what: str, title: str, wanted: int | None, times: dict[tuple[str, str], float]) -> None:
    """Print who answers a question in what time, the fastest first, and how many times ours that is."""
    each = {(who, question.split("/", 1)[1]): us for (who, question), us in times.items() if question.startswith(what)}
    mine = each[OURS, KEPT]
    print(f"  {title}")
    for (who, way), us in sorted(each.items(), key=lambda item: item[1]):
        print(f"    {who:<31} {way:<28} {us:>7.3f} {us / mine:>7.1f}", flush=True)
    if wanted is None:
        return
    by_lapack = [us for (who, way), us in each.items() if "Pinocchio" in who and way in WITH_LAPACK]
    theirs = [us for (who, _), us in each.items() if who != OURS]
    if by_lapack:
        print(f"    Pinocchio and LAPACK's singular values, the faster: {min(by_lapack) / mine:.1f} (wanted: {wanted})")
    if theirs:
        print(f"    whatever else is fastest: {min(theirs) / mine:.1f}")


def show_call(times: dict[tuple[str, str], float]) -> None:
    """Print what a call of dynibo costs on a chain of one joint, which is mostly its binding."""
    for (who, question), us in times.items():
        if question.startswith("call/"):
            rest = times[who, "jacobian/Robot.jacobian"] - us
            print(f"  {who}: {us:.3f} us of a call are the binding and one joint, {rest:.3f} the others")
