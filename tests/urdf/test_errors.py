"""The exception tree: pickled whole, one printable line, the right exit code, helpful about names."""

from __future__ import annotations

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor

import pytest

from kinetostat import errors
from kinetostat.errors import KinetostatError, NumberError, UnknownNameError, printable, quote, unknown_name

CLASSES = [kind for kind in map(errors.__dict__.get, errors.__all__) if isinstance(kind, type)]
FIELDS = {"file": "a b.urdf", "line": 7, "element": "<joint name='elbow'>", "remedy": "straighten it"}
EXIT_CODES = {
    "KinetostatError": 70,
    "UsageError": 2,
    "UnknownNameError": 2,
    "AmbiguousNameError": 2,
    "ConfigurationError": 2,
    "RepresentationError": 2,
    "RobotError": 3,
    "SourceError": 3,
    "XmlError": 3,
    "StructureError": 3,
    "NumberError": 3,
    "LimitError": 3,
    "EngineError": 3,
    "DisagreementError": 4,
}


def test_every_class_has_its_exit_code():
    assert {kind.__name__: kind.exit_code for kind in CLASSES} == EXIT_CODES


@pytest.mark.parametrize("kind", CLASSES)
def test_there_is_one_tree(kind):
    assert issubclass(kind, KinetostatError)
    assert kind.__doc__


@pytest.mark.parametrize("kind", CLASSES)
@pytest.mark.parametrize("fields", [FIELDS, {}, {"file": "f"}, {"line": 3}], ids=["all", "none", "file", "line"])
@pytest.mark.parametrize(
    "copied", [lambda e: pickle.loads(pickle.dumps(e)), copy.copy, copy.deepcopy], ids=["pickle", "copy", "deepcopy"]
)
def test_errors_survive_pickling_and_copying_with_all_fields(kind, fields, copied):
    error = kind("it bends the wrong way", **fields)
    error.__notes__ = ["a note"]
    again = copied(error)
    assert type(again) is kind
    assert str(again) == str(error)
    assert again.__dict__ == error.__dict__
    assert again.args == error.args
    assert again.exit_code == error.exit_code


def fail(name: str) -> None:
    raise NumberError("not a number", file=name, line=2, remedy="count again")


def test_errors_cross_a_process_pool():
    with ProcessPoolExecutor(1) as pool, pytest.raises(NumberError) as caught:
        pool.submit(fail, "f.urdf").result()
    assert (caught.value.file, caught.value.line, caught.value.remedy) == ("f.urdf", 2, "count again")


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        ({}, "it bends"),
        ({"file": "f.urdf"}, "f.urdf: it bends"),
        ({"file": "f.urdf", "line": 7}, "f.urdf:7: it bends"),
        ({"line": 7}, "line 7: it bends"),
        ({"file": "f.urdf", "line": 7, "element": "<axis>"}, "f.urdf:7: <axis>: it bends"),
        ({"remedy": "straighten it"}, "it bends (straighten it)"),
        ({"file": "a\nb\x1b[2J.urdf"}, r"a\nb\x1b[2J.urdf: it bends"),
        ({"file": ""}, "it bends"),
    ],
)
def test_an_error_is_one_line_that_says_where(fields, text):
    assert str(KinetostatError("it bends", **fields)) == text


PRINTABLE = {
    "plain": ("base_link", "base_link"),
    "accents": ("Gelenk é 机器", "Gelenk é 机器"),
    "line break": ("a\nb", r"a\nb"),
    "carriage return": ("a\rb", r"a\rb"),
    "tab": ("a\tb", r"a\tb"),
    "escape": ("\x1b[31m", r"\x1b[31m"),
    "bell": ("\x07", r"\x07"),
    "C1 control": ("\x9b31m", r"\x9b31m"),
    "delete": ("\x7f", r"\x7f"),
    "turned direction": ("\u202eabc", r"\u202eabc"),
    "invisible": ("a\u200bb", r"a\u200bb"),
    "line separator": ("a\u2028b", r"a\u2028b"),
    "no-break space": ("a\xa0b", r"a\xa0b"),
    "lone surrogate": ("\udce9", r"\udce9"),
    "not assigned": ("\U000e0001", r"\U000e0001"),
    "empty": ("", ""),
}


@pytest.mark.parametrize(("text", "shown"), PRINTABLE.values(), ids=PRINTABLE)
def test_what_is_shown_is_printable(text, shown):
    assert printable(text) == shown
    assert printable(text).isprintable()
    assert quote(text) == f"'{shown}'"


def test_what_is_printable_already_is_not_changed():
    assert printable(printable("\x1b\n")) == printable("\x1b\n")


@pytest.mark.parametrize("text", ["x" * 61, "x" * 10_000_000, "\x1b" * 1000])
def test_quotes_are_cut(text):
    assert len(quote(text)) == 62
    assert quote(text).endswith("...'")
    assert len(quote(text, 10)) == 12


def test_a_quote_of_just_the_longest_length_is_whole():
    assert quote("x" * 60) == f"'{'x' * 60}'"


NEAR = {
    "a typing error": ("panda_hnad", ["panda_hand", "panda_link1"], "'panda_hand'"),
    "another case": ("TOOL", ["tool", "base"], "'tool'"),
    "a part of the name": ("wrist", ["left_arm_wrist_roll_link", "base"], "'left_arm_wrist_roll_link'"),
    "nothing near, few names": ("xyz", ["a", "b"], "there are 'a', 'b'"),
    "nothing near, many names": ("xyz", [f"link{i}" for i in range(20)], "'kinetostat frames' lists them"),
    "an escape in a name": ("tool", ["tool\x1b[2J"], r"'tool\x1b[2J'"),
}


@pytest.mark.parametrize(("asked", "known", "remedy"), NEAR.values(), ids=NEAR)
def test_an_unknown_name_is_answered_with_the_nearest(asked, known, remedy):
    error = unknown_name("frame", asked, known, listing="'kinetostat frames' lists them")
    assert isinstance(error, UnknownNameError)
    assert error.message == f"there is no frame {quote(asked)}"
    assert error.remedy is not None
    assert remedy in error.remedy
    assert str(error).isprintable()


def test_an_unknown_name_among_none_has_no_remedy():
    assert unknown_name("state", "home", []).remedy is None


def test_an_unknown_name_of_a_megabyte_among_thousands_is_answered_soon():
    """Comparing long strings letter by letter would take minutes."""
    error = unknown_name("frame", "x" * 1_000_000, [f"link{i}" for i in range(5_000)])
    assert len(str(error)) < 1_000
