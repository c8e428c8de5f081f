"""The browser that tests look at pages with."""

import pytest


@pytest.fixture
def page(browser, tmp_path):
    """A page from disk, with a script."""
    path = tmp_path / "page.html"
    path.write_text("<title>a page</title><p id=a>text</p><script>document.title += ' with a script'</script>")
    page = browser.new_page()
    page.goto(path.as_uri())
    yield page
    page.close()


def test_it_renders_a_page_from_disk(page):
    assert page.title() == "a page with a script"
    assert page.inner_text("#a") == "text"
    assert page.evaluate("document.getElementById('a').getBoundingClientRect().height") > 0


def test_it_takes_pictures(page):
    assert page.screenshot().startswith(b"\x89PNG")
