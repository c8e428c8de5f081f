"""A tab that looks at the page of a report."""

SHOWN = "[...document.querySelectorAll('#chains tbody tr')].filter((row) => !row.hidden)"


class Visit:
    """A tab with the page, and what it has asked for and complained of."""

    def __init__(self, browser, uri, width=1400, **context):
        self.context = browser.new_context(viewport={"width": width, "height": 900}, offline=True, **context)
        self.tab, self.uri = self.context.new_page(), uri
        self.said, self.asked = [], []
        self.tab.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.tab.on("pageerror", lambda error: self.said.append(str(error)))
        self.tab.on("dialog", lambda dialog: (self.said.append(dialog.message), dialog.dismiss()))
        self.tab.on("request", lambda request: self.asked.append(request.url))
        self.tab.goto(uri)

    def open_all(self):
        self.tab.evaluate("document.querySelectorAll('details').forEach((part) => { part.open = true })")

    def is_open(self, robot):
        return self.tab.evaluate("(id) => document.getElementById(id).open", robot)

    def rows(self, cell=0):
        return self.tab.evaluate(f"{SHOWN}.map((row) => row.cells[{cell}].textContent.trim())")

    def press(self, column):
        self.tab.click(f"#chains thead th:nth-child({column + 1}) button")
