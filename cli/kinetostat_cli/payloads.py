"""A payload that users give in an option: KG, or KG@X,Y,Z."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from kinetostat import Payload

__all__ = ["PayloadOption", "payload_of"]

PayloadOption = Annotated[
    str | None, typer.Option(metavar="KG[@X,Y,Z]", help="A mass that --frame holds, at a point of it in m.")
]


def payload_of(text: str | None, frame: str | None) -> Payload | None:
    """Return the payload of an option, held by the frame; None without one.

    Raises:
        UsageError: it is not of that form.
    """
    if text is None or frame is None:
        return None
    import kinetostat
    from kinetostat.errors import quote
    from kinetostat_cli.values import numbers

    mass, at, point = text.partition("@")
    try:
        kilograms = float(mass)
        x, y, z = numbers(point, "--payload", 3) if at else (0.0, 0.0, 0.0)
    except (ValueError, kinetostat.UsageError):
        message = f"--payload takes KG, or KG@X,Y,Z in the frame that -f names, not {quote(text)}"
        raise kinetostat.UsageError(message, remedy="for instance 3@0,0,0.08") from None
    return kinetostat.Payload(kilograms, frame, (x, y, z))
