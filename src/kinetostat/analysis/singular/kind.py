"""The kind of a singularity, from its second-order form.

Along rates v that move nothing, the tool's motion in a lost direction u is of second order: u . x'' = Q_u(v), with
Q_u(v) = u^T (dJ/dq v) v. Its sign says on which sides of the singularity the tool can get:

    fold         one v, Q not zero: a barrier seen from one side, where two branches of inverse kinematics meet
    boundary     several v, Q of one sign: the same for a redundant arm, which no self-motion leads around
    traversable  Q takes both signs: the arm can pass, or leave by a self-motion
    tangential   Q is zero: the arm moves inside without leaving the singularity, to second order

To tell singularities by the signature of this form is N. Bedrossian's ("Classification of singular configurations for
redundant manipulators", ICRA 1990); the four names are ours. Of one sign includes zeros beside it, which are taken for
self-motions.
"""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.singular.mechanism import MODEL, Mechanism
from kinetostat.conventions import Array

__all__ = ["kind", "second_order_forms"]

_NOTHING = 1e-8  # of the size of dJ
_TRIES = 64  # combinations of lost directions that an ascent starts from
_STEPS = 240
_SHRINK = 0.94
_NEARLY = 1e-4  # of the largest eigenvalue: how far from one sign an ascent may stop


def second_order_forms(mechanism: Mechanism, q: Array, lost: Array, motions: Array) -> Array:
    """Return Q_u for each lost direction u, a symmetric matrix over motions. (n,), (m, k), (n, l) -> (k, l, l)."""
    _, along = mechanism.derivatives(q)
    forms = np.einsum("rk,rij,ia,jb->kab", lost, along, motions, motions, optimize=True)
    symmetric: Array = (forms + np.swapaxes(forms, -1, -2)) / 2
    return symmetric


def kind(mechanism: Mechanism, q: Array, lost: Array, motions: Array) -> str:
    """Return the kind of a singular configuration.

    Where several directions are lost, it is a barrier if Q is of one sign for some combination of them.

    Args:
        mechanism: the chain and its task.
        q: coordinates (n,).
        lost: lost directions u as columns, (m, k).
        motions: rates v that move nothing as columns, (n, l).
    """
    matrix, along = mechanism.derivatives(q)
    forms = second_order_forms(mechanism, q, lost, motions)
    # As far as the matrix is from singular, so far is the form from what it would be if it were; or if the file did
    # not round its angles.
    off = float(np.max(np.linalg.norm(matrix @ motions, axis=0)))
    nothing = max(_NOTHING, 10 * off, MODEL if mechanism.rounded else 0.0) * max(1.0, float(np.max(np.abs(along))))
    if float(np.max(np.abs(forms))) < nothing:
        return "tangential"
    if not _one_sided(forms, nothing):
        return "traversable"
    return "fold" if forms.shape[-1] == 1 else "boundary"


def _one_sided(forms: Array, nothing: float) -> bool:
    """Return whether some combination of forms (k, l, l) is not zero and of one sign."""
    if len(forms) == 1:
        values = np.linalg.eigvalsh(forms[0])
        return bool(values[0] > -nothing or values[-1] < nothing)
    # The smallest eigenvalue of a combination is a concave function of it: go up from many.
    generator = np.random.default_rng(0)
    corners = np.concatenate([np.eye(len(forms)), -np.eye(len(forms))])
    chosen = np.concatenate([corners, generator.normal(size=(_TRIES, len(forms)))])
    step = 0.5
    for _ in range(_STEPS):
        chosen /= np.linalg.norm(chosen, axis=1, keepdims=True)
        values, vectors = np.linalg.eigh(np.einsum("ck,kab->cab", chosen, forms))
        largest = np.max(np.abs(values), axis=1)
        if np.any((values[:, 0] > -max(nothing, 0.0) - _NEARLY * largest) & (values[:, -1] > nothing + 0.1 * largest)):
            return True
        lowest = vectors[..., 0]
        uphill = np.einsum("ca,kab,cb->ck", lowest, forms, lowest)
        chosen = chosen + step * uphill / np.maximum(np.linalg.norm(uphill, axis=1, keepdims=True), nothing)
        step *= _SHRINK
    return False
