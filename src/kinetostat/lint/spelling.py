"""Names that are nearly right: what was meant?"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

__all__ = ["Speller", "meant"]

LONGEST = 40  # a longer word is nobody's slip
_NEAR = 0.82

# What other formats, and people, call the same thing.
_ALIASES = {
    "axes": "axis",
    "colour": "color",
    "damp": "damping",
    "euler": "rpy",
    "file": "filename",
    "height": "length",
    "high": "upper",
    "low": "lower",
    "max": "upper",
    "max_effort": "effort",
    "max_velocity": "velocity",
    "maximum": "upper",
    "min": "lower",
    "minimum": "lower",
    "orientation": "rpy",
    "path": "filename",
    "pose": "origin",
    "pos": "xyz",
    "position": "xyz",
    "ratio": "multiplier",
    "rot": "rpy",
    "src": "filename",
    "uri": "filename",
    "url": "filename",
}


def meant(word: str, known: Iterable[str]) -> str:
    """Return the one known word that a misspelt one was meant to be; empty if there is none near.

    Near is: another case or other joints between the words, a plural, another name of the same thing, letters
    exchanged, or nearly all letters in place.
    """
    if len(word) > LONGEST:
        return ""
    plain = {_plain(each): each for each in known}
    here = _plain(word)
    for candidate in (here, here.removesuffix("s"), _plain(_ALIASES.get(word.lower(), ""))):
        if candidate in plain:
            return plain[candidate]
    if len(here) > 2:
        for each, name in plain.items():
            if len(each) > 2 and sorted(each) == sorted(here):
                return name
    near = get_close_matches(here, plain, n=1, cutoff=_NEAR)
    return plain[near[0]] if near else ""


def _plain(word: str) -> str:
    return word.lower().replace("_", "").replace("-", "")


class Speller:
    """`meant`, which takes its time, asked at most so many times in a file."""

    limit = 200

    def __init__(self) -> None:
        self.known = dict[tuple[str, frozenset[str]], str]()

    def meant(self, word: str, known: frozenset[str]) -> str:
        """Return the one known word that a misspelt one was meant to be; empty if there is none near."""
        if (word, known) not in self.known:
            if len(self.known) >= self.limit:
                return ""
            self.known[word, known] = meant(word, known)
        return self.known[word, known]
