"""The page of real robots, as `kinetostat report` writes it, in a browser."""

import itertools
import re

import pytest

from browser.hostile_robot import GROUP, JOINTS, LINKS, ROBOT, STATE, TERMINAL
from browser.real_report import FAILED, written
from browser.visiting import SHOWN
from kinetostat.errors import cut, printable
from report.fleet.html_page import HtmlPage

AA = 4.5  # contrast of text, at least (WCAG 2.2, 1.4.3)
PLACES = f"{SHOWN}.map((row) => [...row.querySelectorAll('a')].map((link) => link.hash.slice(1)))"
# Pictures, groups, regions and controls of which nobody who does not see them is told what they are.
UNNAMED = """() => {
  const title = (one) => document.getElementById(one.getAttribute("aria-labelledby"))?.textContent;
  const named = (one) => ((one.getAttribute("aria-label") || title(one) || "").trim()) !== "";
  const told = (one) => one.labels?.length || one.textContent.trim();
  const heard = (one) => one.closest("[aria-hidden=true]") === null;
  const pictures = [...document.querySelectorAll("svg, img")]
    .map((one) => one.closest("[role=img], [role=group]") ?? one);
  const parts = [...document.querySelectorAll("[role=img], [role=group], [role=region], nav")];
  const controls = [...document.querySelectorAll("input, select, button, a, summary")];
  return [...pictures, ...parts].filter((one) => heard(one) && !named(one))
    .concat(controls.filter((one) => heard(one) && !told(one) && !one.querySelector("[role=img][aria-label]")))
    .map((one) => one.outerHTML.slice(0, 100));
}"""
# Of every text that is seen: how far its colour is from what is behind it.
CONTRASTS = """() => {
  const canvas = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  const known = new Map();
  const rgba = (colour) => {
    if (!known.has(colour)) {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = colour;
      canvas.fillRect(0, 0, 1, 1);
      known.set(colour, [...canvas.getImageData(0, 0, 1, 1).data]);
    }
    return known.get(colour);
  };
  const light = (colour) => {
    const [r, g, b] = rgba(colour).slice(0, 3).map((v) => v / 255)
      .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (one) => {
    for (let at = one; at !== null; at = at.parentElement) {
      const colour = getComputedStyle(at).backgroundColor;
      if (rgba(colour)[3] === 255) return colour;
    }
    return "white";
  };
  const found = {};
  for (const one of document.querySelectorAll("body *")) {
    const text = [...one.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim()).join("");
    if (!text || one.localName === "script" || !one.checkVisibility()) continue;
    const style = getComputedStyle(one);
    const ink = one.closest("svg") ? style.fill : style.color, paper = behind(one);
    const [low, high] = [light(ink), light(paper)].sort((a, b) => a - b);
    found[`${one.closest("svg") ? "svg" : "html"} ${ink} on ${paper}`] = [(high + 0.05) / (low + 0.05), text];
  }
  return found;
}"""
# Texts in pictures that stick out of their picture.
STICKING_OUT = """() => [...document.querySelectorAll("svg.figure")].flatMap((svg) => {
  const frame = svg.getBoundingClientRect();
  const out = ({ left, right, top, bottom }) =>
    left < frame.left - 2 || right > frame.right + 2 || top < frame.top - 2 || bottom > frame.bottom + 2;
  return [...svg.querySelectorAll("text")].filter((text) => out(text.getBoundingClientRect()))
    .map((text) => `${svg.parentElement.getAttribute("aria-label").slice(0, 60)}: ${text.textContent}`);
})"""


@pytest.fixture(scope="module")
def report(browser, tmp_path_factory):
    return written(tmp_path_factory.mktemp("robots"))


@pytest.fixture(scope="module")
def parsed(report):
    return HtmlPage((report.folder / "index.html").read_text(encoding="utf-8"))


@pytest.fixture
def opened(visited, report):
    return lambda place="", **how: visited(report.uri + place, **how)


@pytest.fixture
def visit(opened):
    return opened()


# --- the page --------------------------------------------------------------------------------------------------


def test_every_robot_is_in_it_and_those_that_cannot_be_read_are_exit_3(report, visit):
    assert report.code == 3
    assert [robot["path"] for robot in report.robots if robot["status"] != "done"] == list(FAILED)
    assert visit.tab.locator("details.robot").count() == len(report.robots) == 15
    assert visit.tab.evaluate(f"{SHOWN}.length") == len(report.rows)


def test_it_works_offline_and_asks_for_nothing_and_complains_of_nothing(visit):
    visit.tab.click("text=Open all")
    for button in visit.tab.locator("#chains thead button").all():
        button.click()
    visit.tab.fill("#search", "talos")
    visit.tab.click("#chains tbody tr:visible a >> nth=1")
    assert visit.tab.pdf().startswith(b"%PDF")
    assert visit.asked == [visit.uri]
    assert visit.said == []


def test_a_row_tells_what_the_numbers_of_the_report_are(report, visit):
    (row,) = [row for row in visit.tab.locator("#chains tbody tr").all() if "xarm7" in row.inner_text()]
    shown = row.locator("td, th").nth(column_of(visit, "reach") - 1).inner_text()
    assert float(shown) == pytest.approx(report.robot("example:xarm7")["chains"][0]["reach"], rel=5e-3)


def test_what_cannot_be_read_is_a_row_with_its_reason(report, visit):
    for path in FAILED:
        robot = report.robot(path)
        row = visit.tab.locator(f"#chains tr:has(a[href='#{robot['id']}'])")
        assert row.count() == 1
        text = row.inner_text()
        assert "could not be read" in text
        assert printable(robot["reason"]) in text


def test_a_robot_without_chains_is_told_as_such(report, visit):
    drone = report.robot("example:iris")
    assert drone["chains"] == []
    row = visit.tab.locator(f"#chains tr:has(a[href='#{drone['id']}'])")
    assert "no chain" in row.inner_text()
    visit.tab.click(f"#chains a[href='#{drone['id']}']")
    assert "Findings" in visit.tab.locator(f"#{drone['id']}").inner_text()


# --- the table -------------------------------------------------------------------------------------------------


def of_chain(key):
    return lambda robot, chain: None if chain is None else key(chain)


def quantile(measure, share):
    def key(chain):
        rows = [row for row in chain["distributions"] if row["measure"] == measure]
        return rows[0]["quantiles"].get(share) if rows else None

    return of_chain(key)


def findings(robot, _):
    severities = [finding["severity"] for finding in robot["findings"]]
    return tuple(severities.count(one) for one in ("error", "warning", "info"))


def joints(robot, chain):
    if chain is None:
        return None if robot["status"] != "done" else robot["degrees_of_freedom"]
    return len(chain["joints"])


def percent(value):
    return None if value is None else 100 * value


def payload(chain):
    found = chain["payload_at_mid"] or {}
    return float("inf") if found.get("unbounded") else found.get("mass")


def dexterity(key):
    """Return what is told of a chain that has a dexterity: not of one joint, nor of one that only turns."""
    return lambda robot, chain: (
        None if chain is None or len(chain["joints"]) == 1 or chain["turns_only"] else key(robot, chain)
    )


KEYS = {  # but manipulability, whose units differ from chain to chain
    "joints": joints,
    "mass": lambda robot, _: robot["mass"],
    "reach": of_chain(lambda chain: chain["reach"]),
    "payload": of_chain(payload),
    "dexterity": dexterity(quantile("inverse_condition_number", "0.5")),
    "near": dexterity(of_chain(lambda chain: percent(chain["near_singular_share"]))),
    "worst gravity use": of_chain(lambda chain: percent(chain["worst_gravity_use"])),
    "worst use with": of_chain(lambda chain: percent(chain["worst_loaded_use"])),
    "errors": findings,
}
TITLES = "[...document.querySelectorAll('#chains thead th')].map((head) => head.textContent.replace('\\u00ad', ''))"


def column_of(visit, title):
    """Return the number, from 1, of the column with a title."""
    return 1 + next(i for i, text in enumerate(visit.tab.evaluate(TITLES)) if text.startswith(title))


def ordered(rows, key, sign):
    """Return rows in the order of a key; those that have none last; equal ones as they were."""
    known = [row for row in rows if key(*row) is not None]
    order = sorted(known, key=lambda row: tuple(sign * part for part in as_tuple(key(*row))))
    return order + [row for row in rows if key(*row) is None]


def as_tuple(value):
    return value if isinstance(value, tuple) else (value,)


def test_columns_of_numbers_of_one_unit_are_sorted_by_their_button_as_the_report_has_them(report, visit):
    rows = report.rows
    for title, key in KEYS.items():
        for sign in (1, -1):
            visit.tab.click(f"#chains thead th:nth-child({column_of(visit, title)}) button")
            rows = ordered(rows, key, sign)
            places = [[one["id"] for one in row if one is not None] for row in rows]
            assert visit.tab.evaluate(PLACES) == places, (title, sign)


def test_by_tab_and_enter_alone_it_is_sorted_and_searched(report, visit):
    keyboard = visit.tab.keyboard
    focus = "document.activeElement.textContent"
    keyboard.press("Tab")
    assert visit.tab.evaluate(focus) == "To the table"
    keyboard.press("Enter")
    keyboard.press("Tab")
    keyboard.type("talos leg")
    assert len(visit.tab.evaluate(PLACES)) == 2
    for _ in range(30):
        keyboard.press("Tab")
        if visit.tab.evaluate(focus).startswith("mass"):
            break
    keyboard.press("Enter")
    assert visit.tab.get_attribute("#chains thead th:nth-child(4)", "aria-sort") == "ascending"
    keyboard.press("Space")
    assert visit.tab.get_attribute("#chains thead th:nth-child(4)", "aria-sort") == "descending"


@pytest.mark.parametrize(
    ("control", "value", "shown"),
    [
        ("#status", "failed", lambda robot, chain: robot["status"] != "done"),
        ("#status", "errors", lambda robot, chain: findings(robot, chain)[0] > 0),
        ("#status", "disagree", lambda robot, chain: False),
        ("#joints", "7", lambda robot, chain: robot["status"] != "done" or bool(chain and len(chain["joints"]) > 6)),
        ("#search", "arm", lambda robot, chain: "arm" in f"{robot['path']} {robot['name']} {(chain or robot)['name']}"),
    ],
)
def test_filters_leave_the_rows_that_they_say(report, visit, control, value, shown):
    if control == "#status":
        visit.tab.select_option(control, value)
    else:
        visit.tab.fill(control, value)
    rows = [row for row in report.rows if shown(*row)]
    assert visit.tab.evaluate(PLACES) == [[one["id"] for one in row if one is not None] for row in rows]
    chains, all_of_them = (len([chain for _, chain in some if chain]) for some in (rows, report.rows))
    others = f", and {len(rows) - chains} robot" if len(rows) > chains else ""
    assert visit.tab.inner_text("#count").startswith(f"{chains} of {all_of_them} chains{others}")


# --- places ----------------------------------------------------------------------------------------------------


def test_every_link_leads_to_something(parsed):
    places = {element.attributes["id"] for element in parsed.root.all() if "id" in element.attributes}
    links = [link.attributes["href"] for link in parsed.root.all("a")]
    assert {link[1:] for link in links if link.startswith("#")} - places == set()
    assert [link for link in links if not link.startswith("#")] == []


def test_a_limb_of_a_humanoid_is_opened_by_its_link(report, visit):
    talos = report.robot("example:talos_reduced")
    (leg,) = [chain for chain in talos["chains"] if chain["name"] == "r_leg"]
    assert not visit.is_open(talos["id"])
    visit.tab.click(f"#chains a[href='#{leg['id']}']")
    visit.tab.wait_for_function("(id) => document.getElementById(id).open", arg=talos["id"])
    section = visit.tab.locator(f"#{leg['id']}")
    assert abs(section.bounding_box()["y"]) < 60
    assert section.locator("h3").inner_text().startswith("r_leg")
    assert section.locator("figure").count() == 3


def test_its_address_opens_there_and_so_does_a_mark_in_a_picture(report, opened):
    hand = report.robot("example:allegro_right_hand")
    visit = opened(f"#{hand['chains'][1]['id']}")
    assert visit.tab.locator("details.robot[open]").count() == 1
    assert visit.is_open(hand["id"])
    link = visit.tab.locator(".scatter svg a[href='#r2-1']").first
    link.focus()
    visit.tab.keyboard.press("Enter")
    visit.tab.wait_for_function("document.getElementById('r2').open")


def test_all_robots_are_opened_and_closed_at_once(report, visit):
    visit.tab.click("text=Open all")
    assert visit.tab.locator("details.robot[open]").count() == len(report.robots)
    visit.tab.click("text=Close all")
    assert visit.tab.locator("details.robot[open]").count() == 0


# --- names -----------------------------------------------------------------------------------------------------


def test_hostile_names_are_text(report, visit):
    visit.open_all()
    text = visit.tab.locator(f"#{report.robot('hostile.urdf')['id']}").inner_text()
    for name in (ROBOT, *JOINTS, GROUP, STATE, LINKS[0], LINKS[-1]):
        assert cut(name, 80) in text, name
    assert TERMINAL[:30] in visit.tab.locator(f"#{report.robot('terminal.urdf')['id']}").inner_text()
    assert not re.search("[\u202e\u2066\u200b\x85\x9b]", visit.tab.inner_text("body"))


def test_nothing_comes_of_hostile_names(visit):
    visit.open_all()
    visit.tab.keyboard.press("Tab")
    for row in visit.tab.locator("details.robot:has-text('hostile.urdf') tbody tr:visible").all()[:4]:
        row.hover()
    assert visit.tab.evaluate("'taken' in window") is False
    assert visit.tab.evaluate("document.scripts.length") == 1
    assert visit.tab.locator("img, iframe, object, embed, form, base, foreignObject").count() == 0
    names = "[...document.querySelectorAll('*')].flatMap((one) => one.getAttributeNames())"
    assert [name for name in visit.tab.evaluate(names) if name.startswith("on")] == []
    assert visit.tab.title() == "15 robots: kinetostat report"
    assert visit.said == []


# --- pictures --------------------------------------------------------------------------------------------------


def test_texts_in_pictures_are_texts(report, visit):
    for path in ("example:ur5_robot", "example:baxter", "example:talos_reduced"):
        robot = report.robot(path)
        tree = visit.tab.locator(f"#{robot['id']} .body > figure svg text").all_text_contents()
        arms = {name for chain in robot["chains"] for name in chain["joints"]}
        texts = "".join(tree)  # a long name takes several lines; an ending that all share is dropped
        assert [name for name in sorted(arms) if name.removesuffix("_joint") not in texts] == []
        for chain in robot["chains"]:
            axes = " ".join(visit.tab.locator(f"#{chain['id']} figure svg text").all_text_contents())
            assert "share [%]" in axes
            assert ("[m]" in axes) or not chain["reach"]


@pytest.mark.parametrize("width", [360, 1400])
def test_texts_stay_in_their_pictures(opened, width):
    visit = opened(width=width)
    visit.open_all()
    assert visit.tab.locator("svg.figure text").count() > 500
    assert visit.tab.evaluate(STICKING_OUT) == []


@pytest.mark.parametrize("width", [360, 768, 1400])
def test_the_page_does_not_scroll_sideways(opened, width):
    visit = opened(width=width)
    visit.open_all()
    assert visit.tab.evaluate("document.documentElement.scrollWidth") == width


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_text_stands_out(opened, scheme):
    visit = opened(color_scheme=scheme)
    visit.open_all()
    contrasts = visit.tab.evaluate(CONTRASTS)
    assert {key.split()[0] for key in contrasts} == {"html", "svg"}
    assert {key: found for key, found in contrasts.items() if found[0] < AA} == {}
    paper = visit.tab.evaluate("getComputedStyle(document.body).backgroundColor")
    brightness = [int(part) for part in re.findall(r"\d+", paper)[:3]]
    assert max(brightness) < 64 if scheme == "dark" else min(brightness) > 192


# --- other readers ---------------------------------------------------------------------------------------------


def test_every_robot_is_printed(report, visit):
    visit.tab.emulate_media(media="print")
    for robot in report.robots:
        assert visit.tab.locator(f"#{robot['id']} .body").is_visible()
    assert visit.tab.pdf().count(b"/Type /Page\n") > len(report.robots)


def test_without_script_all_of_it_can_be_read(report, opened):
    tab = opened(java_script_enabled=False).tab
    assert tab.locator("#chains tbody tr:visible").count() == len(report.rows)
    for robot in report.robots:
        section = tab.locator(f"#{robot['id']}")
        section.locator("summary").first.click()
        assert section.locator(".body").is_visible()
        assert robot["path"] in section.inner_text()


def test_pictures_and_controls_have_names(visit):
    visit.open_all()
    assert visit.tab.evaluate(UNNAMED) == []


def test_headings_are_in_order(parsed):
    levels = [int(element.tag[1]) for element in parsed.root.all() if re.fullmatch("h[1-6]", element.tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(below <= above + 1 for above, below in itertools.pairwise(levels))


def test_it_is_nested_as_html_should_be_and_ids_are_unique(parsed):
    assert parsed.problems == []
    ids = [element.attributes["id"] for element in parsed.root.all() if "id" in element.attributes]
    assert len(ids) == len(set(ids))
    referred = {
        found for one in parsed.root.all() for value in one.attributes.values()
        for found in re.findall(r"url\(#([^)]*)\)", value or "")
    }  # fmt: skip
    assert referred - set(ids) == set()
