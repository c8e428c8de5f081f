"""Bytes to a document: encodings, line numbers, and the XML that is refused."""

from __future__ import annotations

import codecs
import os
import warnings

import pytest

from kinetostat.errors import XmlError
from kinetostat.urdf.document import Element, parse

BODY = '<robot name="é"><link name="a"/></robot>'


def name(data: bytes) -> str:
    return parse(data, "f.urdf").root.attributes["name"]


# --- encodings -------------------------------------------------------------------------------------------------

READ = {
    "UTF-8": (BODY.encode(), None),
    "UTF-8, declared": (b'<?xml version="1.0" encoding="UTF-8"?>' + BODY.encode(), None),
    "UTF-8, declared in lower case with single quotes": (
        b"<?xml version='1.0' encoding='utf-8'?>" + BODY.encode(),
        None,
    ),
    "UTF-8, declared without a hyphen": (b'<?xml version="1.0" encoding="utf8"?>' + BODY.encode(), None),
    "UTF-8 with byte-order mark": (codecs.BOM_UTF8 + BODY.encode(), None),
    "UTF-8 with byte-order mark, declared": (
        codecs.BOM_UTF8 + b'<?xml version="1.0" encoding="utf-8"?>' + BODY.encode(),
        None,
    ),
    "Latin-1, declared": (b'<?xml version="1.0" encoding="ISO-8859-1"?>' + BODY.encode("latin-1"), "ISO-8859-1"),
    "Latin-1, declared as latin1": (b'<?xml version="1.0" encoding="latin1"?>' + BODY.encode("latin-1"), "latin1"),
    "Windows-1252, declared": (
        b'<?xml version="1.0" encoding="windows-1252"?>' + BODY.encode("cp1252"),
        "windows-1252",
    ),
    "ASCII, declared as Python calls it": (
        b'<?xml version="1.0" encoding="ascii"?>' + BODY.replace("é", "&#xe9;").encode(),
        "ascii",
    ),
    "ASCII, declared": (
        b'<?xml version="1.0" encoding="us-ascii"?>' + BODY.replace("é", "&#xe9;").encode(),
        "us-ascii",
    ),
    "UTF-16 little-endian with byte-order mark": (codecs.BOM_UTF16_LE + BODY.encode("utf-16-le"), "utf-16"),
    "UTF-16 big-endian with byte-order mark": (codecs.BOM_UTF16_BE + BODY.encode("utf-16-be"), "utf-16"),
    "UTF-16 with byte-order mark, declared": (
        codecs.BOM_UTF16_LE + ('<?xml version="1.0" encoding="utf-16"?>' + BODY).encode("utf-16-le"),
        "utf-16",
    ),
}


@pytest.mark.parametrize(("data", "remarked"), READ.values(), ids=READ)
def test_an_encoding_is_read_and_an_unusual_one_is_said(data, remarked):
    document = parse(data, "f.urdf")
    assert document.root.attributes["name"] == "é"
    assert [(line, remarked in text) for line, text in document.remarks] == ([(1, True)] if remarked else [])


UNREAD = {
    "Latin-1, not declared": (BODY.encode("latin-1"), "byte 0xe9 is not utf-8 text"),
    "Latin-1, declared as ASCII": (
        b'<?xml version="1.0" encoding="us-ascii"?>' + BODY.encode("latin-1"),
        "byte 0xe9 is not us-ascii text",
    ),
    "UTF-16 without byte-order mark": (BODY.replace("é", "e").encode("utf-16-le"), "NUL"),
    "UTF-32 with byte-order mark": (codecs.BOM_UTF32_LE + BODY.encode("utf-32-le"), ""),
    "UTF-16 cut in the middle of a character": (codecs.BOM_UTF16_LE + BODY.encode("utf-16-le")[:-1], "not utf-16 text"),
    "UTF-16, declared, without byte-order mark": (
        b'<?xml version="1.0" encoding="utf-16"?>' + BODY.encode(),
        "'utf-16' is not read",
    ),
    "an encoding that does not exist": (
        b'<?xml version="1.0" encoding="ISO-8859-99"?>' + BODY.encode(),
        "'ISO-8859-99' is unknown",
    ),
    "an encoding that is a program": (
        b'<?xml version="1.0" encoding="unicode_escape"?>' + BODY.encode(),
        "is not read",
    ),
    "rot13": (b'<?xml version="1.0" encoding="rot13"?>' + BODY.encode(), "is not read"),
    "idna, slow on long names": (b'<?xml version="1.0" encoding="idna"?>' + BODY.encode(), "is not read"),
    "UTF-7, which hides brackets": (b'<?xml version="1.0" encoding="utf-7"?>' + BODY.encode(), "is not read"),
    "a lone surrogate in UTF-8": (BODY.encode().replace(b"\xc3\xa9", b"\xed\xa0\x80"), "byte 0xed"),
    "a lone surrogate in UTF-16": (
        codecs.BOM_UTF16_LE + BODY.encode("utf-16-le").replace(b"\xe9\x00", b"\x00\xd8"),
        "not utf-16 text",
    ),
    "overlong UTF-8": (BODY.encode().replace(b"\xc3\xa9", b"\xc0\xbc"), "byte 0xc0"),
    "a control character": (BODY.encode().replace(b"\xc3\xa9", b"\x1b"), "not well-formed"),
    "a control character by reference": (BODY.encode().replace(b"\xc3\xa9", b"&#27;"), "invalid character"),
    "NUL by reference": (BODY.encode().replace(b"\xc3\xa9", b"&#0;"), "invalid character"),
    "a noncharacter": (BODY.encode().replace(b"\xc3\xa9", "\uffff".encode()), "not well-formed"),
}


@pytest.mark.parametrize(("data", "why"), UNREAD.values(), ids=UNREAD)
def test_bytes_that_are_not_text_are_refused(data, why):
    with pytest.raises(XmlError) as caught:
        parse(data, "f.urdf")
    assert why in caught.value.message
    assert caught.value.file == "f.urdf"
    assert caught.value.remedy
    assert str(caught.value).isprintable()


# --- what is no XML at all -------------------------------------------------------------------------------------

NO_ROBOT = {
    "empty": (b"", "empty"),
    "blanks": (b" \n\t\r\n", "empty"),
    "a byte-order mark alone": (codecs.BOM_UTF8, "empty"),
    "an XML declaration alone": (b'<?xml version="1.0"?>', "no element found"),
    "a comment alone": (b"<!-- -->", "no element found"),
    "plain text": (b"hello", "not well-formed XML: syntax error"),
    "gzip": (b"\x1f\x8b\x08\x00", "gzip archive"),
    "zip": (b"PK\x03\x04", "zip archive"),
    "git-lfs": (b"version https://git-lfs.github.com/spec/v1\n", "git-lfs pointer"),
    "HTML with a DOCTYPE": (b"<!DOCTYPE html><html></html>", "HTML page"),
    "HTML after blank lines": (b"\n\n<HTML lang='en'>", "HTML page"),
    "JSON": (b'{"robot": 1}', "not well-formed"),
    "two roots": (b"<robot/><robot/>", "junk after document element"),
    "text after the root": (b"<robot/>text", "junk after document element"),
    "an element that does not end": (b"<robot><link></robot>", "mismatched tag"),
    "the same attribute twice": (b'<robot name="a" name="b"/>', "duplicate attribute"),
    "an attribute without quotes": (b"<robot name=a/>", "not well-formed"),
    "an attribute with a bracket": (b'<robot name="<"/>', "not well-formed"),
    "an entity that is not defined": (b"<robot>&nbsp;</robot>", "undefined entity"),
    "a character beyond Unicode": (b"<robot name='&#x110000;'/>", "reference to invalid character"),
    "two declarations": (b"<?xml version='1.0'?><?xml version='1.0'?><robot/>", "XML or text declaration not at start"),
    "a declaration after a comment": (b"<!-- --><?xml version='1.0'?><robot/>", "XML or text declaration not at start"),
}


@pytest.mark.parametrize(("data", "why"), NO_ROBOT.values(), ids=NO_ROBOT)
def test_what_is_no_robot_is_refused(data, why):
    with pytest.raises(XmlError) as caught:
        parse(data, "f.urdf")
    assert why in caught.value.message


DOCTYPES = (
    "<!DOCTYPE robot>",
    '<!DOCTYPE robot SYSTEM "robot.dtd">',
    '<!DOCTYPE robot PUBLIC "a" "http://example.com/robot.dtd">',
    '<!DOCTYPE robot [<!ENTITY a "b">]>',
    '<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE robot [<!ENTITY % a SYSTEM "file:///etc/passwd"> %a;]>',
    '<!DOCTYPE robot [<!ATTLIST link name CDATA "a">]>',
)


@pytest.mark.parametrize("doctype", DOCTYPES)
def test_every_doctype_is_refused_before_anything_is_made_of_it(doctype):
    with pytest.raises(XmlError, match="DOCTYPE is refused") as caught:
        parse(f'<?xml version="1.0"?>\n\n{doctype}<robot/>'.encode(), "f.urdf")
    assert caught.value.line == 3


# --- lines -----------------------------------------------------------------------------------------------------

LINES = {
    "the first line": (b"<robot>", 1),
    "the third": (b"<robot>\n\n<link", 3),
    "after Windows line ends": (b"<robot>\r\n\r\n<link", 3),
    "after blank lines before the declaration": (b"\n\n<?xml version='1.0'?>\n<robot>\n<link", 5),
    "after blank lines without a declaration": (b"\n\n<robot>\n<link", 4),
    "of a byte that is no text": (b"<robot>\n\n'\xe9'</robot>", 3),
    "of a NUL": (b"\n<robot>\n\0</robot>", 3),
    "of a control character after blank lines": (b"\n\n\n<robot>\n\x01", 5),
}


@pytest.mark.parametrize(("data", "line"), LINES.values(), ids=LINES)
def test_errors_name_their_line(data, line):
    with pytest.raises(XmlError) as caught:
        parse(data, "f.urdf")
    assert caught.value.line == line


@pytest.mark.parametrize("before", ["", "\n", "\n\n\r\n \t\n", "\ufeff\n\n"])
@pytest.mark.parametrize("declaration", ["", '<?xml version="1.0"?>\n'])
def test_elements_know_their_line_in_the_file_as_it_is(before, declaration):
    text = before + declaration + '<robot>\n<link\n  name="a"/>\n\n  <link name="b"/></robot>'
    lines = text.split("\n")
    links = parse(text.encode(), "f").root.all("link")
    expected = [next(i for i, line in enumerate(lines, 1) if "<link" in line), len(lines)]
    assert [link.line for link in links] == expected


def test_blank_lines_before_a_declaration_are_said():
    assert [line for line, _ in parse(b"\n<?xml version='1.0'?><robot/>", "f").remarks] == [1]
    assert parse(b"\n<robot/>", "f").remarks == ()


# --- elements --------------------------------------------------------------------------------------------------


def test_elements_are_kept_with_their_attributes_and_order():
    root = parse(b"<robot><b k='1'/>text<a/><!-- c --><?p i?><b k='2'><![CDATA[<a/>]]></b></robot>", "f").root
    assert [child.tag for child in root.children] == ["b", "a", "b"]
    assert [child.attributes for child in root.all("b")] == [{"k": "1"}, {"k": "2"}]
    assert root.all("c") == []
    assert all(child.parent is root for child in root.children)


def test_unbound_prefixes_are_part_of_names():
    root = parse(b"<robot xmlns:x='y' x:a='1'><drake:joint u:v='2'/></robot>", "f").root
    assert root.attributes == {"xmlns:x": "y", "x:a": "1"}
    assert (root.children[0].tag, root.children[0].attributes) == ("drake:joint", {"u:v": "2"})


def test_white_space_in_an_attribute_is_normalised_but_character_references_are_not():
    assert parse(b"<robot a='1\t2\n3\r\n4' b='1&#9;2&#10;3'/>", "f").root.attributes == {"a": "1 2 3 4", "b": "1\t2\n3"}


LABELS = {
    "by name": (("joint", {"name": "elbow"}), None, "<joint name='elbow'>"),
    "without a name": (("joint", {}), None, "<joint>"),
    "inside a named one": (("axis", {}), ("joint", {"name": "elbow"}), "<joint name='elbow'><axis>"),
    "inside an unnamed one": (("axis", {}), ("gazebo", {}), "<axis>"),
    "with an escape in its name": (("link", {"name": "\x1b[2J"}), None, r"<link name='\x1b[2J'>"),
    "with a line break in its name": (("link", {"name": "a\nb"}), None, r"<link name='a\nb'>"),
    "with a long name": (("link", {"name": "x" * 100}), None, "<link name='" + "x" * 37 + "...'>"),
    "with a long tag": (("x" * 100, {}), None, "<" + "x" * 57 + "...>"),
}


@pytest.mark.parametrize(("element", "around", "label"), LABELS.values(), ids=LABELS)
def test_labels_are_short_and_printable(element, around, label):
    parent = None if around is None else Element(*around, 1)
    assert Element(*element, 1, parent).label() == label


def test_depth_costs_no_recursion():
    depth = 50_000
    root = parse(b"<robot>" + b"<t>" * depth + b"</t>" * depth + b"</robot>", "f").root
    for _ in range(depth):
        root = root.children[0]
    assert root.children == []


def test_no_file_and_no_address_is_opened_while_parsing(tmp_path):
    """Nor is the folder of the process looked at: an outside entity is refused, never resolved."""
    secret = tmp_path / "secret"
    os.mkfifo(secret)  # opening it would block for ever
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for text in (
            f'<!DOCTYPE r [<!ENTITY a SYSTEM "file://{secret}">]><robot>&a;</robot>',
            f'<!DOCTYPE r SYSTEM "{secret}"><robot/>',
        ):
            with pytest.raises(XmlError, match="DOCTYPE"):
                parse(text.encode(), "f")


# --- places and what is written -----------------------------------------------------------------------------------


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_are_counted_whatever_ends_them(end):
    document = parse(f'{end}{end}<?xml version="1.0"?>{end}<robot>{end}<link/></robot>'.encode(), "r.urdf")
    assert [document.root.line, document.root.children[0].line] == [4, 5]
    assert document.remarks
    for wrong in (b"<robot>\xff", b"<robot>\0", b"<robot>&</robot>"):
        with pytest.raises(XmlError) as caught:
            parse(f"{end}{end}".encode() + wrong, "r.urdf")
        assert caught.value.line == 3


def test_attributes_broken_by_tabs_or_lines_are_kept_as_written():
    text = (
        "<!-- a='1\n' --><r u='1\t2'\n é='\n' plain='a b'><s u = \"3\r\n4\" v='&#9;'/>"
        "a='\t'<!-- b='\t' --><t/><![CDATA[<u u='\t'/>]]></r>"
    )
    document = parse(text.encode(), "r.urdf")
    assert [(e.tag, key, value) for e, key, value in document.broken if key == "u"] == [
        ("r", "u", "1\t2"),
        ("s", "u", "3\r\n4"),
    ]
    assert document.root.attributes["u"] == "1 2"
    assert all(key in element.attributes for element, key, _ in document.broken)
    assert parse(b"<r u='1 2'>\n</r>", "r.urdf").broken == ()


def test_processing_instructions_and_comments_have_places():
    document = parse(b"<?a?><r>\n <?b c?><!-- d --><s/>\n</r><?e?>", "r.urdf")
    assert document.instructions == ((2, "b"),)
    assert [(c.line, c.column, c.text) for c in document.comments] == [(2, 8, " d ")]
    assert (document.root.last_line, document.root.last_column) == (3, 0)
