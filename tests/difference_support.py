"""Robots edited as XML, and what changed: what the tests of `difference` share."""

import io
from xml.etree import ElementTree as ET

import kinetostat as ks
from kinetostat.analysis.difference.difference import difference
from kinetostat.urdf.files import locate
from trees import load_text


def document(source):
    """Return the XML tree of a robot that ships."""
    return ET.fromstring(locate(source).read_text())


def edited(source, change):
    """Return a robot that ships, its XML changed by `change(root)`, with the SRDF that it has."""
    root = document(source)
    change(root)
    return from_xml(root)


def from_xml(root):
    return load_text(ET.tostring(root, encoding="unicode"))


def joint(root, name):
    return next(e for e in root.iter("joint") if e.get("name") == name)


def link(root, name):
    return next(e for e in root.iter("link") if e.get("name") == name)


def put(element, path, **attributes):
    """Set attributes of a child element, made if it is missing."""
    child = element.find(path)
    if child is None:
        child = ET.SubElement(element, path)
    for key, value in attributes.items():
        child.set(key, value)


def told(result):
    """Return the changes as (kind, element, name, attribute)."""
    return [(c.kind, c.element, c.name, c.attribute) for c in result.changes]


def renaming(root, rename):
    """Rename every link and joint, wherever it is referred to."""
    for element in root.findall("link"):
        element.set("name", rename(element.get("name")))
    for element in root.findall("joint"):
        element.set("name", rename(element.get("name")))
        for end in ("parent", "child"):
            element.find(end).set("link", rename(element.find(end).get("link")))
        for law in element.findall("mimic"):
            law.set("joint", rename(law.get("joint")))


def plain(source):
    """Return a robot that ships without its SRDF, as edited ones are."""
    return ks.load("-", stdin=io.BytesIO(locate(source).read_bytes()))


def compared(source, change, **asked):
    """Return the difference of a robot that ships from itself, changed."""
    return difference(plain(source), edited(source, change), **asked)
