"""The joint resolution that a wanted accuracy of the tool needs, also as encoder counts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kinetostat.analysis.accuracy import ToolError
from kinetostat.conventions import Array
from kinetostat.errors import UsageError

__all__ = ["JointResolution", "Requirement", "joint_resolution"]

_SMALLEST = 1e-12  # m or rad
_LARGE = 0.1  # rad: where errors of joints stop being small


@dataclass(frozen=True)
class Requirement:
    """Joint errors that a wanted accuracy allows.

    Attributes:
        factor: by which the given joint errors may be multiplied; infinite where they do not move the tool. (...).
        errors: the allowed errors, rad and m, infinite where a joint does not matter. (..., n).
        counts: encoder counts per turn of the joint that do not exceed them; NaN where a joint slides, or needs no
            encoder because it is taken as exact or does not matter. (..., n).
    """

    factor: Array
    errors: Array
    counts: Array

    @property
    def bits(self) -> Array:
        """The counts as bits of an absolute encoder, rounded up; NaN where there are none. (..., n)."""
        return np.ceil(np.log2(np.maximum(self.counts, 2.0)))


@dataclass(frozen=True)
class JointResolution:
    """The joint resolution that a wanted accuracy of the tool needs.

    Attributes:
        accuracy: the wanted position accuracy in m, or None.
        accuracy_angle: the wanted rotation accuracy in rad, or None.
        worst: what is allowed if the accuracy is to hold in the worst case.
        sigma: what is allowed if it is to hold for the root mean square of the error, independent errors assumed.
        alone: what each joint is allowed in the worst case if all others are exact; its `factor` is 1.
        decides: "position" or "rotation": which of the two allows less, in the worst case. (...).
        warnings: what is to be said of it.
    """

    accuracy: float | None
    accuracy_angle: float | None
    worst: Requirement
    sigma: Requirement
    alone: Requirement
    decides: Array
    warnings: tuple[str, ...] = ()


def joint_resolution(
    error: ToolError, *, accuracy: float | None = None, accuracy_angle: float | None = None
) -> JointResolution:
    """Return the joint errors that a wanted accuracy allows, and the encoders that they need.

    Tool errors are proportional to joint errors, so those given, d, may be multiplied by

        f = min(accuracy / |position error|, accuracy_angle / |rotation error|)

    in the worst case, and likewise for root mean squares. An encoder of N counts per turn whose reading is rounded to
    the nearest count is off by half a count at most, pi / N, so N = ceil(pi / (f |d_j|)) is needed; its error is spread
    evenly over a count, with a standard deviation of 2 pi / (N sqrt 12) (B. Widrow, "Statistical analysis of
    amplitude-quantized sampled-data systems", 1961), so N = ceil(pi / (sqrt 3 f |d_j|)) for one sigma.

    Args:
        error: the tool error of joint errors, of which the proportions count. See `tool_error`; shapes are (..., n).
        accuracy: the largest position error, in m.
        accuracy_angle: the largest rotation error, in rad.

    Raises:
        UsageError: neither is given, or one that is not positive and finite.
    """
    wanted = [(accuracy, error.translation, slice(0, 3)), (accuracy_angle, error.rotation, slice(3, 6))]
    for size, name in ((accuracy, "--accuracy"), (accuracy_angle, "--accuracy-angle")):
        if size is not None and not _SMALLEST <= size <= 1 / _SMALLEST:
            message = f"{name} is between {_SMALLEST:g} and {1 / _SMALLEST:g}, not {size:g}"
            raise UsageError(message, remedy="for instance 0.001")
    if accuracy is None and accuracy_angle is None:
        raise UsageError("no accuracy is wanted", remedy="give --accuracy in m, or --accuracy-angle")
    sizes, turning = np.abs(error.joint_error), np.array([unit == "rad" for unit in error.column_units])
    floor = error.certificate.tolerance
    worst, sigma, alone = [], [], []
    for size, part, rows in wanted:
        target = math.inf if size is None else size
        worst.append(_allowed(target, part.worst, floor * float(np.max(sizes))))
        sigma.append(_allowed(target, part.sigma, floor * float(np.max(sizes))))
        alone.append(_allowed(target, np.linalg.norm(error.matrix[..., rows, :], axis=-2), floor))
    factor, factor_sigma, single = (np.minimum(*pair) for pair in (worst, sigma, alone))
    errors, errors_sigma = (_times(each, sizes) for each in (factor, factor_sigma))
    half_count, deviation = np.pi, np.pi / math.sqrt(3)
    largest = np.where(np.isfinite(errors_sigma) & turning, errors_sigma, 0.0)
    warnings = []
    if np.any(largest > _LARGE):
        warnings.append(f"allowed joint errors are beyond {_LARGE:g} rad, where first order tells little")
    return JointResolution(
        accuracy,
        accuracy_angle,
        Requirement(factor, errors, _counts(half_count, errors, turning)),
        Requirement(factor_sigma, errors_sigma, _counts(deviation, errors_sigma, turning)),
        Requirement(np.ones_like(factor), single, _counts(half_count, single, turning)),
        np.where(worst[0] <= worst[1], "position", "rotation"),
        tuple(warnings),
    )


def _allowed(target: float, size: Array, floor: float) -> Array:
    """Return target / size; infinite where nothing is wanted, or where nothing but rounding moves."""
    return np.divide(target, size, out=np.full_like(size, np.inf), where=size > floor)


def _times(factor: Array, sizes: Array) -> Array:
    """Return factor x size of each joint, where one that is exact stays so. (...), (n,) -> (..., n)."""
    exact = np.broadcast_to(sizes == 0, (*factor.shape, len(sizes)))
    return np.multiply(factor[..., None], sizes, out=np.zeros(exact.shape), where=~exact)


def _counts(share: float, errors: Array, turning: Array) -> Array:
    """Return ceil(share / error) for joints that turn; what is a whole number but for rounding is that number."""
    needed = turning & np.isfinite(errors) & (errors > 0)
    counts = np.divide(share, errors, out=np.full_like(errors, np.nan), where=needed)
    return np.ceil(counts * (1 - 1e-12))
