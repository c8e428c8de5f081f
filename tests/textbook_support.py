"""What the textbook tests share: the real path from a robot's name to numbers that both engines agree on.

The expected side of a test is a closed form, written in NumPy where it is used; none is taken from kinetostat.
"""

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from itertools import product

import numpy as np
from numpy.testing import assert_allclose

import kinetostat as ks

QUARTERS = (0.0, np.pi / 2, np.pi, -np.pi / 2)


@cache
def textbook(name, *, floating_base=False):
    """Return a textbook robot, read once."""
    return ks.load(f"textbook:{name}", floating_base=floating_base)


def certified(result):
    """Return the matrix of a result that both engines have computed and agree on."""
    assert result.certificate.engines == ("pinocchio", "screw")
    assert result.certificate.agree is True, result.certificate
    return result.matrix


def jacobian_of(name, frame, q, *, floating_base=False, **asked):
    """Return the certified Jacobian (..., 6, n) of a frame of a textbook robot."""
    return certified(
        ks.jacobian(textbook(name, floating_base=floating_base), frame, np.asarray(q, dtype=float), **asked)
    )


def placement_of(name, frame, q, *, floating_base=False, **asked):
    """Return the certified placement (..., 4, 4) of a frame of a textbook robot."""
    return certified(ks.fk(textbook(name, floating_base=floating_base), frame, np.asarray(q, dtype=float), **asked))


def frame_change_of(name, start, end, q=(), *, floating_base=False, **asked):
    """Return the certified six-by-six between two frames of a textbook robot."""
    return certified(
        ks.adjoint(textbook(name, floating_base=floating_base), start, end, np.asarray(q, dtype=float), **asked)
    )


def angles(joints, seed, count=30):
    """Return configurations (n, joints): random angles; up to three joints, every combination of quarter turns too."""
    drawn = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, joints))
    return np.vstack([np.array(list(product(QUARTERS, repeat=joints))), drawn]) if joints <= 3 else drawn


def matrix_of(rows):
    """Return the arrays (..., r, c) whose entries are given row by row as numbers or arrays (...)."""
    entries = np.broadcast_arrays(*(np.asarray(entry, dtype=float) for row in rows for entry in row))
    return np.stack(entries, -1).reshape(*entries[0].shape, len(rows), len(rows[0]))


def vector_of(*entries):
    """Return the vectors (..., n) whose entries are given as numbers or arrays (...)."""
    return np.stack(np.broadcast_arrays(*(np.asarray(entry, dtype=float) for entry in entries)), -1)


def columns_of(*columns):
    """Return the matrix (..., 6, n) whose columns are given as six entries each."""
    return matrix_of(list(zip(*columns, strict=True)))


def cross_matrix(vector):
    """Return [v] with [v] u = v x u."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def turn_about(axis, angle):
    """Return Rodrigues' rotation by an angle about a unit axis."""
    skew = cross_matrix(axis)
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def turned(*turns):
    """Return the placement that turns about moved coordinate axes, one after the other: ("z", 0.3), ("x", 1)."""
    placement = np.eye(4)
    for axis, angle in turns:
        placement[:3, :3] = placement[:3, :3] @ turn_about(np.eye(3)["xyz".index(axis)], angle)
    return placement


def shifted(x, y, z):
    """Return the placement that shifts alone."""
    placement = np.eye(4)
    placement[:3, 3] = x, y, z
    return placement


def denavit_hartenberg(theta, d, a, alpha):
    """Return Rz(theta) Tz(d) Tx(a) Rx(alpha), the standard convention."""
    return turned(("z", theta)) @ shifted(a, 0, d) @ turned(("x", alpha))


def planar_tip(lengths, q):
    """Return the placements of the tip of a planar arm: links along x, joints about z."""
    heading = np.cumsum(q, -1)
    sine, cosine = np.sin(heading[..., -1]), np.cos(heading[..., -1])
    x, y = (lengths * np.cos(heading)).sum(-1), (lengths * np.sin(heading)).sum(-1)
    return matrix_of([[cosine, -sine, 0, x], [sine, cosine, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


def singular_values(matrix):
    """Return singular values, largest first."""
    return np.linalg.svd(matrix, compute_uv=False)


def assert_same(actual, expected, atol=1e-12):
    """Compare by absolute difference alone, shapes included."""
    assert np.shape(actual) == np.shape(expected)
    assert_allclose(actual, expected, rtol=0, atol=atol)


def command_line(*words):
    """Run the command line as a user would, asking for JSON; return the object that it writes."""
    done = subprocess.run(
        [sys.executable, "-m", "kinetostat_cli", *words, "-F", "json"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    payload = json.loads(done.stdout)
    assert payload["schema"] == f"kinetostat/{words[0]}/1"
    assert payload["warnings"] == []
    assert payload["crosscheck"]["engines"] == ["pinocchio", "screw"]
    assert payload["crosscheck"]["agree"] is True
    return payload
