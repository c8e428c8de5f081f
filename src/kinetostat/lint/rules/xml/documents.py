"""X105 to X109: is the XML of the file a robot, whole and expanded?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import ClassVar

from kinetostat.errors import cut, quote
from kinetostat.lint.expressions import has_expression, unexpanded_tags
from kinetostat.lint.finding import Finding, Severity
from kinetostat.lint.rule import Example, Rule
from kinetostat.lint.schema import parts
from kinetostat.lint.subject import Subject
from kinetostat.urdf.document import Element

__all__ = ["DOCUMENTS"]


class BlankBeforeDeclaration(Rule):
    """Blank lines stand before the XML declaration.

    A declaration may only be the very first thing in a file. libxml2, expat and with them Python's ElementTree refuse
    the file; TinyXML, and so urdfdom, takes it.
    """

    code = "X105"
    name = "blank-before-declaration"
    severity = Severity.WARNING
    hint = "let the file start with <?xml, or remove the declaration"
    bad = Example('\ufeff\n<?xml version="1.0"?> <!-- X105 -->\n<robot name="example"><link name="base"/></robot>')
    good = Example('<?xml version="1.0"?>\n<robot name="example"><link name="base"/></robot>')

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a declaration that is not at the beginning."""
        assert subject.document is not None
        assert subject.source is not None
        for line, text in subject.document.remarks:
            if text.startswith("blank lines before the XML declaration"):
                before, found, _ = subject.source.data.partition(b"<?xml")
                yield self.finding(line + before.count(b"\n") if found else line, text)


class WrongRoot(Rule):
    """The root element is not `<robot>`.

    Whatever the file describes, it is not a URDF: every reader of URDF refuses it.
    """

    code = "X106"
    name = "wrong-root"
    severity = Severity.ERROR
    hint = "a URDF has <robot> as its root element"
    bad = Example("""
        <?xml version="1.0"?>
        <model name="example"> <!-- X106 -->
          <link name="base"/>
        </model>""")
    good = Example("""
        <robot name="example">
          <link name="base"/>
        </robot>""")

    _HINTS: ClassVar = {
        "sdf": "this is SDF, Gazebo's format: convert it to URDF first",
        "mujoco": "this is MJCF, MuJoCo's format: convert it to URDF first",
        "collada": "this is COLLADA, a mesh: a <mesh> of a robot file may name it",
        "launch": "this is a launch file: name the robot file that it loads",
    }

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield a root element that is another."""
        root = subject.root
        if root.tag != "robot":
            hint = self._HINTS.get(root.tag.lower())
            if root.tag.lower() == "robot":
                hint = "write <robot>, in small letters: XML tells them apart"
            yield self.finding(root, f"the root element is <{cut(root.tag)}>, not <robot>", hint=hint)


class UndeclaredPrefix(Rule):
    """A prefix of an element or attribute is nowhere declared.

    Readers that know namespaces (ElementTree, lxml, xacro) refuse the file; TinyXML, and so urdfdom, passes over it.
    """

    code = "X107"
    name = "undeclared-prefix"
    severity = Severity.WARNING
    hint = 'declare it in the root element, such as xmlns:drake="https://drake.mit.edu", or remove the prefix'
    bad = Example("""
        <link name="base"/>
        <controller:servo rate="100"/> <!-- X107 -->""")
    good = Example("""
        <robot name="example" xmlns:controller="http://example.org/controller">
          <link name="base"/>
          <controller:servo rate="100"/>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield each prefix once, where it is first used."""
        if not _some_undeclared(subject):
            return
        first_use, count, known = dict[str, Element](), Counter[str](), Counter({"xml": 1, "xmlns": 1})
        stack = [(subject.root, False)]
        while stack:
            element, leaving = stack.pop()
            prefixed = [name for name in (element.tag, *element.attributes) if ":" in name]
            declared = _declared(prefixed)
            if leaving:
                known.subtract(declared)
                continue
            known.update(declared)
            for prefix in {name.partition(":")[0] for name in prefixed}:
                if known[prefix] == 0:
                    first_use.setdefault(prefix, element)
                    count[prefix] += 1
            if declared:
                stack.append((element, True))
            stack.extend((child, False) for child in reversed(element.children))
        for prefix, element in first_use.items():
            times = f", used {count[prefix]} times," if count[prefix] > 1 else ""
            message = f"the prefix {quote(prefix)}{times} has no xmlns:{cut(prefix)}"
            yield self.finding(element, message, element=f"<{cut(element.tag)}>")


def _declared(names: Iterable[str]) -> list[str]:
    return [name.removeprefix("xmlns:") for name in names if name.startswith("xmlns:")]


def _some_undeclared(subject: Subject) -> bool:
    """Return whether some prefix is not declared at the root, as nearly all are."""
    used = {
        name.partition(":")[0]
        for element in subject.elements
        if ":" in element.tag or ":" in "".join(element.attributes)
        for name in (element.tag, *element.attributes)
        if ":" in name
    }
    return not used <= {"xml", "xmlns", *_declared(subject.root.attributes)}


class Unexpanded(Rule):
    """The file holds xacro that is not expanded: tags, `${...}` or `$(...)`.

    URDF has no macros and no variables. Readers pass over the tags, so parts of the robot are missing, and take an
    expression for a number that does not parse, or for a name.
    """

    code = "X108"
    name = "xacro-unexpanded"
    severity = Severity.ERROR
    hint = "name the file .urdf.xacro, or run xacro on it first"
    bad = Example("""
        <robot name="example" xmlns:xacro="http://www.ros.org/wiki/xacro">
          <xacro:property name="mass" value="1.5"/> <!-- X108 -->
          <link name="base"/>
        </robot>""")
    good = Example("""
        <robot name="example" xmlns:xacro="http://www.ros.org/wiki/xacro">
          <link name="base"/>
        </robot>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first tag with the number of them; where there is none, each value with an expression."""
        tags = unexpanded_tags(subject)
        if tags:
            others = f", and {len(tags) - 1} more like it" if len(tags) > 1 else ""
            message = f"a tag of xacro, not of URDF{others}"
            yield self.finding(tags[0], message, element=f"<{cut(tags[0].tag)}>")
            return
        for element, _ in parts(subject):
            for key, value in element.attributes.items():
                if has_expression(value):
                    yield self.finding(element, f"{key}={quote(value)} is an expression of xacro", attribute=key)


class DeeplyNested(Rule):
    """Elements are nested much deeper than any robot's are.

    libxml2 (lxml, yourdfpy) stops at 256 levels and urdfdom's reader at 500; readers that call themselves for each
    level run out of stack on the way. A robot has about six levels, with extension blocks a dozen.
    """

    code = "X109"
    name = "deeply-nested"
    severity = Severity.WARNING
    hint = "is this a robot file, and complete?"
    deepest: ClassVar = 100
    bad = Example('<link name="base"/>\n<gazebo>\n' + "<x>" * 99 + " <!-- X109 -->\n" + "</x>" * 99 + "\n</gazebo>")
    good = Example("""
        <link name="base"/>
        <gazebo><plugin name="p" filename="libp.so"><a><b><c/></b></a></plugin></gazebo>""")

    def check(self, subject: Subject) -> Iterator[Finding]:
        """Yield the first element below the deepest level, with the number of levels."""
        level, depth, first = [subject.root], 1, None
        while level := [child for element in level for child in element.children]:
            depth += 1
            if depth > self.deepest and first is None:
                first = level[0]
        if first is not None:
            yield self.finding(first, f"the file nests elements {depth} deep", element=f"<{cut(first.tag)}>")


DOCUMENTS: tuple[Rule, ...] = (
    BlankBeforeDeclaration(),
    WrongRoot(),
    UndeclaredPrefix(),
    Unexpanded(),
    DeeplyNested(),
)
