"""The kind of a singularity, from its second-order form.

Along rates v that move nothing, the tool's motion in a lost direction u is of second order: u . x'' = Q_u(v), with
Q_u(v) = u^T (dJ/dq v) v. Its sign says on which sides of the singularity the tool can get:

    fold         one v, Q not zero: a barrier seen from one side, where two branches of inverse kinematics meet
    boundary     several v, Q of one sign: the same for a redundant arm, which no self-motion leads around
    traversable  Q takes both signs: the arm can pass, or leave by a self-motion
    tangential   Q is zero: the arm moves inside without leaving the singularity, to second order

(N. Bedrossian, "Classification of singular configurations for redundant manipulators", ICRA 1990.)
"""

from __future__ import annotations

import numpy as np

from kinetostat.analysis.singular.mechanism import Mechanism
from kinetostat.conventions import Array

__all__ = ["kind"]

_NOTHING = 1e-8  # of the size of dJ


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
    forms = np.einsum("rk,rij,ia,jb->kab", lost, along, motions, motions, optimize=True)
    forms = (forms + np.swapaxes(forms, -1, -2)) / 2
    # As far as the matrix is from singular, so far is the form from what it would be if it were.
    off = float(np.max(np.linalg.norm(matrix @ motions, axis=0)))
    nothing = max(_NOTHING, 10 * off) * max(1.0, float(np.max(np.abs(along))))
    if float(np.max(np.abs(forms))) < nothing:
        return "tangential"
    generator = np.random.default_rng(0)
    combinations = np.eye(len(forms)) if len(forms) == 1 else generator.normal(size=(512, len(forms)))
    values = np.linalg.eigvalsh(np.einsum("ck,kab->cab", combinations, forms))
    one_sided = (values[:, 0] > -nothing) & (values[:, -1] > nothing) | (values[:, -1] < nothing) & (
        values[:, 0] < -nothing
    )
    if not np.any(one_sided):
        return "traversable"
    return "fold" if forms.shape[-1] == 1 else "boundary"
