"""Markdown as a Markdown parser reads it."""

from html.parser import HTMLParser

from markdown_it import MarkdownIt


class Page(HTMLParser):
    """The tags, cells and runs of text of a page; a comment ends a run, as in GitHub's filters."""

    def __init__(self, markdown):
        super().__init__()
        self.tags, self.attributes, self.runs, self.rows, self.folded = [], [], [], [], []
        self.feed(MarkdownIt("commonmark").enable(["table", "strikethrough"]).render(markdown))

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attributes]
        if tag == "tr":
            self.rows.append(0)
        if tag in ("td", "th"):
            self.rows[-1] += 1
        if tag == "details":
            self.folded.append(not attributes)

    def handle_data(self, data):
        self.runs.append(data)
