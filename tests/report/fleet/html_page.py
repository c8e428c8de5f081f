"""A page as a parser reads it: its elements, their attributes and texts, and what is nested wrongly."""

from html.parser import HTMLParser

VOID = {"meta", "link", "input", "br", "img", "hr", "wbr"}


class Element:
    """An element: its tag, attributes, parent, and the texts in it."""

    def __init__(self, tag, attributes, parent):
        self.tag, self.attributes, self.parent, self.pieces, self.children = tag, dict(attributes), parent, [], []

    @property
    def text(self):
        return "".join(piece if isinstance(piece, str) else piece.text for piece in self.pieces)

    def has_class(self, name):
        return name in (self.attributes.get("class") or "").split()

    def all(self, tag=None, **attributes):
        """Return the elements below it with a tag and attributes (`class_` is one of its classes)."""
        return [one for one in self._below() if _fits(one, tag, attributes)]

    def one(self, tag=None, **attributes):
        (found,) = self.all(tag, **attributes)
        return found

    def _below(self):
        for child in self.children:
            yield child
            yield from child._below()


def _fits(element, tag, attributes):
    wanted = dict(attributes)
    name = wanted.pop("class_", None)
    return (
        (tag is None or element.tag == tag)
        and (name is None or element.has_class(name))
        and all(element.attributes.get(key) == value for key, value in wanted.items())
    )


class HtmlPage(HTMLParser):
    """A page; `problems` says what is not closed or closed wrongly."""

    def __init__(self, html):
        super().__init__()
        self.root = Element("", (), None)
        self.at, self.problems, self.declarations, self.comments = self.root, [], [], []
        self.feed(html)
        self.close()
        if self.at is not self.root:
            self.problems.append(f"<{self.at.tag}> is not closed")

    def handle_starttag(self, tag, attributes):
        self.at = self._added(tag, attributes)
        if tag in VOID:
            self.at = self.at.parent

    def handle_startendtag(self, tag, attributes):
        self._added(tag, attributes)

    def _added(self, tag, attributes):
        if len({name for name, _ in attributes}) != len(attributes):
            self.problems.append(f"<{tag}> has an attribute twice")
        element = Element(tag, attributes, self.at)
        self.at.children.append(element)
        self.at.pieces.append(element)
        return element

    def handle_endtag(self, tag):
        if self.at.tag == tag:
            self.at = self.at.parent
        else:
            self.problems.append(f"</{tag}> in <{self.at.tag}>")

    def handle_data(self, data):
        self.at.pieces.append(data)

    def handle_decl(self, decl):
        self.declarations.append(decl)

    def handle_comment(self, data):
        self.comments.append(data)

    def shape(self):
        """Return every element as its tag and the names of its attributes, in order; not where a word may break."""
        return [(one.tag, *sorted(one.attributes)) for one in self.root.all() if one.tag != "wbr"]
