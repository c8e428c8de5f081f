"""How a configuration for a pose is looked for: words that the command line shows before anything is loaded."""

from __future__ import annotations

from kinetostat.conventions import Word

__all__ = ["Method"]


class Method(Word):
    """A method of inverse kinematics.

    damped: damped least squares inside limits, with restarts.
    newton: Newton-Raphson as in a textbook: no limits, no restarts.
    pseudo-inverse: Jacobian inversion, as rates, or as steps of a share f.
    """

    DAMPED = "damped"
    NEWTON = "newton"
    PSEUDO_INVERSE = "pseudo-inverse"
