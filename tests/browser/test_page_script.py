"""The page of a report in a browser: its script, its width, its policy; documents made by hand."""

import itertools

import pytest

from browser.visiting import SHOWN
from kinetostat.report.fleet.page import page as html_of
from report.fleet import fleet_documents as made


@pytest.fixture
def visit(visited, tmp_path):
    def opened(document):
        path = tmp_path / "index.html"
        path.write_text(html_of(document, made.drawings(document)), encoding="utf-8")
        return visited(path.as_uri())

    return opened


@pytest.fixture
def fleet(visit):
    return visit(made.fleet())


def test_it_asks_for_nothing_and_complains_of_nothing(fleet):
    fleet.press(4)
    fleet.tab.click("#chains tbody a")
    assert fleet.asked == [fleet.uri]
    assert fleet.said == []


def test_hostile_names_run_nothing(visit):
    hostile = visit(made.hostile(made.fleet(), "".join(made.HOSTILE[:12])))
    hostile.press(0)
    assert hostile.asked == [hostile.uri]
    assert hostile.said == []


def test_the_policy_stops_what_is_not_of_the_page(browser, tmp_path):
    path, document, said = tmp_path / "index.html", made.fleet(), []
    alien = "<script>document.title = 'taken'</script><style>h1 { color: red }</style><p style='color: red'>"
    html = html_of(document, made.drawings(document)).replace("</main>", f"{alien}</main>")
    path.write_text(html, encoding="utf-8")
    tab = browser.new_page()
    tab.on("console", lambda message: said.append(message.text))
    tab.goto(path.as_uri())
    assert tab.title() == "5 robots: kinetostat report"
    assert len(said) == 3
    assert all("Content Security Policy" in text for text in said)
    tab.close()


def test_the_third_click_is_a_way_back(fleet):
    before = fleet.rows(1)
    fleet.press(4)
    fleet.press(0)
    for way in ("ascending", "descending"):
        assert fleet.tab.get_attribute("#chains thead th:nth-child(1)", "aria-sort") == way
        assert fleet.rows(1) != before
        fleet.press(0)
    assert fleet.rows(1) == before
    assert fleet.tab.locator("#chains [aria-sort]").count() == 0


def test_numbers_of_different_units_are_not_sorted_among_each_other(visit):
    units = ("1", "m/rad", "1", "m/rad", "m")
    chains = tuple(
        made.chain(
            f"r1-{i}", f"c{i}", distributions=(made.distribution(unit=unit, median=(0.5, 0.1, 0.3, 0.4, 0.2)[i]),)
        )
        for i, unit in enumerate(units)
    )
    one = visit(made.document(made.robot(chains=chains)))
    one.press(6)
    assert one.rows(1) == ["c2", "c0", "c4", "c1", "c3"]
    one.press(6)
    assert one.rows(1) == ["c0", "c2", "c4", "c3", "c1"]


def test_numbers_are_sorted_up_and_down_and_what_is_missing_comes_last(fleet):
    key = "row => { let at = 0; for (const c of row.cells) { if (at === %d) return c.colSpan > 1 ? null : "
    key += "c.dataset.value ?? null; at += c.colSpan } return null }"
    ways = ((1, "ascending"), (-1, "descending"))
    for column, (sign, name) in itertools.product((*range(2, 6), *range(8, 14)), ways):  # 6, 7 have several units
        fleet.press(column)
        values = fleet.tab.evaluate(f"{SHOWN}.map({key % column})")
        known = [sign * float(value) for value in values if value is not None]
        assert known == sorted(known)
        assert values[len(known) :] == [None] * (len(values) - len(known))
        head = f"#chains thead th:nth-child({column + 1})"
        assert fleet.tab.get_attribute(head, "aria-sort") == name
    assert fleet.tab.locator("#chains [aria-sort]").count() == 1


def test_rows_that_are_equal_stay_in_order(fleet):
    fleet.press(0)
    before = fleet.rows()
    fleet.press(2)
    joints = fleet.tab.evaluate(f"{SHOWN}.map(row => row.cells[2].dataset.value)")
    for number in set(joints):
        kept = [name for name, value in zip(fleet.rows(), joints, strict=True) if value == number]
        assert kept == sorted(kept, key=before.index)


def test_names_are_sorted_as_people_do(visit):
    robots = [made.robot(f"r{i}", name, chains=()) for i, name in enumerate(("ur10", "Zeta", "ur5", "alpha"), 1)]
    one = visit(made.document(*robots))
    one.press(0)
    assert one.rows() == ["alpha", "ur5", "ur10", "Zeta"]


def test_it_is_sorted_by_the_keyboard_too(fleet):
    fleet.tab.focus("#chains thead th:nth-child(5) button")
    fleet.tab.keyboard.press("Enter")
    assert fleet.tab.get_attribute("#chains thead th:nth-child(5)", "aria-sort") == "ascending"


def test_it_is_filtered_by_words_status_and_joints(fleet):
    count = fleet.tab.locator("#count")
    assert count.inner_text() == "4 of 4 chains, and 2 robots without a chain"
    fleet.tab.fill("#search", "ARM two-")
    assert fleet.rows(1) == ["left_arm", "right_arm"]
    assert count.inner_text() == "2 of 4 chains"
    fleet.tab.fill("#search", "")
    for status, names in (
        ("failed", ["robots/broken.urdf"]),
        ("fails", ["two-armed"] * 2),
        ("disagree", ["two-armed"] * 2),
    ):
        fleet.tab.select_option("#status", status)
        assert fleet.rows() == names
    fleet.tab.select_option("#status", "")
    fleet.tab.fill("#joints", "4")
    assert fleet.rows() == ["robots/broken.urdf"], "a robot that failed stays visible"
    fleet.tab.fill("#joints", "3")
    assert count.inner_text() == "4 of 4 chains, and 1 robot without a chain"


def test_a_link_opens_what_it_leads_to(fleet):
    assert not fleet.is_open("r2")
    fleet.tab.click("#chains a[href='#r2-2']")
    fleet.tab.wait_for_function("document.getElementById('r2').open")
    assert abs(fleet.tab.locator("#r2-2").bounding_box()["y"]) < 60
    fleet.tab.click("text=Close all")
    assert not fleet.is_open("r2")
    fleet.tab.click("#chains a[href='#r2-2']")
    fleet.tab.wait_for_function("document.getElementById('r2').open")
    fleet.tab.click("text=Open all")
    assert fleet.tab.locator("details.robot[open]").count() == 5


def test_an_address_with_a_place_opens_there(fleet):
    fleet.tab.goto("about:blank")
    fleet.tab.goto(f"{fleet.uri}#r3-1")
    assert fleet.is_open("r3")
    assert not fleet.is_open("r1")


def test_all_of_it_is_printed_and_folded_as_before_afterwards(fleet):
    fleet.tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert fleet.tab.locator("details:not([open])").count() == 0
    fleet.tab.evaluate("dispatchEvent(new Event('afterprint'))")
    assert fleet.tab.locator("details.robot[open]").count() == 0
    assert fleet.tab.pdf().startswith(b"%PDF")


def test_on_paper_two_figures_fit_on_a_page_and_headers_can_repeat(fleet):
    fleet.tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    fleet.tab.emulate_media(media="print")
    style = "e => { const s = getComputedStyle(e); return [s.display, s.position] }"
    assert fleet.tab.locator("#chains thead").evaluate(style)[0] == "table-header-group"
    assert fleet.tab.locator("#chains thead button").count() == 0, "Chromium repeats no header that has one"
    assert fleet.tab.locator("#chains thead th").first.evaluate(style)[1] == "static"
    half = (297 - 2 * 14) / 2 / 25.4 * 96
    heights = fleet.tab.evaluate(
        "[...document.querySelectorAll('.robot figure')].map(e => e.getBoundingClientRect().height)"
    )
    assert max(heights) < half
    fleet.tab.evaluate("dispatchEvent(new Event('afterprint'))")
    fleet.tab.emulate_media(media="screen")
    fleet.press(4)
    assert fleet.tab.get_attribute("#chains thead th:nth-child(5)", "aria-sort") == "ascending"
    fleet.tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    fleet.tab.emulate_media(media="print")
    assert not fleet.tab.locator(".legend").is_visible()


def test_all_columns_fit_on_a_laptop(fleet):
    for width in (1280, 1366, 1920):
        fleet.tab.set_viewport_size({"width": width, "height": 800})
        room, wanted = fleet.tab.locator("#chains").evaluate("e => [e.parentElement.clientWidth, e.offsetWidth]")
        assert wanted <= room


@pytest.mark.parametrize("text", ["", "".join(made.HOSTILE[:11]), "x" * 10_000])
def test_the_page_never_scrolls_sideways(visit, text):
    one = visit(made.hostile(made.fleet(), text) if text else made.fleet())
    one.tab.evaluate("document.querySelectorAll('details').forEach(part => { part.open = true })")
    for width in (320, 360, 700, 1000, 1343, 1344, 1400, 2000):
        one.tab.set_viewport_size({"width": width, "height": 800})
        assert one.tab.evaluate("document.documentElement.scrollWidth") <= width


def test_what_scrolls_sideways_fades_at_its_edge_until_its_end(fleet):
    fleet.tab.set_viewport_size({"width": 360, "height": 800})
    masked = "e => getComputedStyle(e).maskImage !== 'none' && getComputedStyle(e).getPropertyValue('--fade') !== '0px'"
    table = fleet.tab.locator(".scrolls.tall")
    assert table.evaluate(masked)
    table.evaluate("e => new Promise(done => { e.scrollLeft = e.scrollWidth; setTimeout(done, 300) })")
    assert not table.evaluate(masked)
    fleet.tab.set_viewport_size({"width": 1400, "height": 800})
    table.evaluate("() => new Promise(done => setTimeout(done, 300))")
    assert not table.evaluate(masked)


def test_without_its_script_the_table_is_whole(browser, tmp_path):
    path = tmp_path / "index.html"
    document = made.fleet()
    path.write_text(html_of(document, made.drawings(document)), encoding="utf-8")
    context = browser.new_context(java_script_enabled=False)
    tab = context.new_page()
    tab.goto(path.as_uri())
    assert tab.locator("#chains tbody tr:visible").count() == 6
    assert not tab.locator("#filters").is_visible()
    assert not tab.locator("#folding").is_visible()
    context.close()
