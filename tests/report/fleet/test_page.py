"""The page of a report: complete, self-contained, and names in it are text."""

import base64
import hashlib
import math
import re
from functools import cache

import msgspec
import pytest

from kinetostat.errors import cut, printable
from kinetostat.report.fleet.drawing import Drawing
from kinetostat.report.fleet.page import page
from report.fleet import fleet_documents as made
from report.fleet.html_page import HtmlPage


@cache
def shown(of=made.fleet):
    """Return the page of a document as a parser reads it."""
    document = of()
    return HtmlPage(page(document, made.drawings(document)))


def rows(of=made.fleet):
    return shown(of).root.one("table", id="chains").one("tbody").all("tr")


def lone():
    return made.document(made.robot())


def none():
    return made.document()


def unknown():
    return made.without_numbers(made.fleet())


FLEETS = (made.fleet, lone, none, unknown)


# --- one file, which asks for nothing --------------------------------------------------------------------------


@pytest.mark.parametrize("of", FLEETS)
def test_elements_are_nested_as_they_should_be(of):
    assert shown(of).problems == []
    assert shown(of).declarations == ["doctype html"]


@pytest.mark.parametrize("of", FLEETS)
def test_nothing_in_it_asks_for_anything(of):
    for element in shown(of).root.all():
        for name, value in element.attributes.items():
            assert not name.startswith("on"), "a handler"
            assert name not in ("style", "src", "srcset", "action", "formaction", "data"), name
            if name in ("href", "xlink:href"):
                assert value.startswith("#") or value == "data:,", value
        assert element.tag not in ("iframe", "object", "embed", "form", "base", "img")
    style = shown(of).root.one("style").text
    assert "url(" not in style
    assert "@import" not in style


def test_the_policy_allows_the_style_and_the_script_that_are_in_it_and_no_other():
    root = shown().root
    policy = root.one("meta", **{"http-equiv": "Content-Security-Policy"}).attributes["content"]
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    for tag, rule in (("style", "style-src"), ("script", "script-src")):
        digest = base64.b64encode(hashlib.sha256(root.one(tag).text.encode()).digest()).decode()
        assert rules.pop(rule) == f"'sha256-{digest}'"
    assert rules.pop("img-src") == "data:"
    assert {rule: rules[rule] for rule in ("default-src", "base-uri", "form-action")} == {
        "default-src": "'none'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    assert "unsafe" not in policy
    assert root.all("meta")[1].attributes["content"] == policy, "it stands before what it is about"


def test_the_same_document_gives_the_same_bytes():
    document = made.fleet()
    given = made.drawings(document)
    assert page(document, given) == page(made.fleet(), dict(reversed(given.items())))


@pytest.mark.parametrize("of", FLEETS)
def test_ids_are_unique_and_links_lead_somewhere(of):
    root = shown(of).root
    ids = [element.attributes["id"] for element in root.all() if "id" in element.attributes]
    assert len(ids) == len(set(ids))
    links = {link.attributes["href"] for link in root.all("a")}
    assert links <= {f"#{name}" for name in ids}


@pytest.mark.parametrize("of", FLEETS)
def test_what_is_not_known_is_never_a_word_of_python(of):
    text = shown(of).root.one("main").text
    assert not re.search(r"\b(None|nan|inf|True|False|Undefined)\b", text)


# --- names are data --------------------------------------------------------------------------------------------


@cache
def twin():
    document = made.hostile(made.fleet(), "benign")
    return HtmlPage(page(document, made.drawings(document, alt="benign")))


@pytest.mark.parametrize("text", made.HOSTILE, ids=range(len(made.HOSTILE)))
def test_hostile_texts_make_no_element_and_no_attribute(text):
    document = made.hostile(made.fleet(), text)
    html = page(document, made.drawings(document, alt=text))
    found = HtmlPage(html)
    assert found.shape() == twin().shape()
    assert found.problems == []
    assert found.comments == []
    assert all(c.isprintable() or c == "\n" for c in html)
    for element in found.root.all():
        for name in ("href", "xlink:href"):
            assert element.attributes.get(name, "#").startswith(("#", "data:,"))
    html.encode()


@pytest.mark.parametrize("text", made.HOSTILE, ids=range(len(made.HOSTILE)))
def test_hostile_texts_show_as_they_are(text):
    document = made.document(made.robot(name=text, findings=(made.finding(message=text),)))
    root = HtmlPage(page(document, {})).root
    assert root.one("h1").text == cut(text, 80)
    assert printable(text)[:900] in root.one("table", class_="findings").text


def test_a_name_of_ten_thousand_characters_does_not_fill_the_page():
    document = made.hostile(made.fleet(), "x" * 10_000)
    assert len(page(document, {})) < 600_000
    assert all(len(cell.text) < 200 for cell in HtmlPage(page(document, {})).root.one(id="chains").all("th"))


# --- the table -------------------------------------------------------------------------------------------------


def test_each_chain_has_a_row_and_so_has_each_robot_without():
    assert [row.one("th").text.strip() for row in rows()] == [
        "panda",
        "two-armed",
        "two-armed",
        "ur3",
        "robots/broken.urdf",
        "drone",
    ]
    assert sum("data-chain" in row.attributes for row in rows()) == 4


def test_each_row_spans_all_columns():
    columns = len(shown().root.one("table", id="chains").one("thead").all("th"))
    for row in rows():
        assert sum(int(cell.attributes.get("colspan", 1)) for cell in row.children) == columns


def test_a_robot_that_failed_says_why_and_not_by_colour_alone():
    (row,) = [row for row in rows() if row.has_class("failed")]
    assert "could not be read" in row.text
    assert "two links are named 'arm'" in row.text
    assert row.attributes["data-status"] == "failed"
    part = shown().root.one("details", id="r4")
    assert "two links are named 'arm'" in part.text


def test_cells_are_sorted_by_numbers_in_full():
    chain = made.chain(reach=0.123456789)
    root = HtmlPage(page(made.document(made.robot(chains=(chain,))), {})).root
    cells = [cell for cell in root.one(id="chains").all("td") if cell.attributes.get("data-value") == "0.123456789"]
    assert [cell.text.strip() for cell in cells] == ["0.123"]


def test_what_is_not_known_has_no_value_to_be_sorted_by():
    for row in rows(unknown):
        for cell in row.all("td"):
            if cell.all(class_="none"):
                assert "data-value" not in cell.attributes
    assert rows(unknown)[0].all(class_="none")


def test_values_to_be_sorted_by_are_finite_numbers():
    values = [
        cell.attributes["data-value"] for row in rows() for cell in row.all("td") if "data-value" in cell.attributes
    ]
    assert values
    assert all(math.isfinite(float(value)) for value in values)


def test_the_table_is_complete_without_the_script():
    root = shown().root
    assert "hidden" in root.one(id="filters").attributes
    assert "hidden" in root.one(id="folding").attributes
    assert root.one(id="chains").all("button") == []
    assert not any("hidden" in row.attributes for row in rows())


def test_what_is_over_its_limit_is_marked_by_more_than_a_colour():
    (row,) = [row for row in rows() if row.all("rect", class_="over")]
    cell = next(cell for cell in row.all("td") if cell.all("rect", class_="over"))
    assert "over the limit" in cell.text
    assert "▲ " in cell.text.replace("▲over the limit: ", "▲ ")


def test_bars_stay_within_their_track():
    for bar in shown().root.all("svg", class_="bar"):
        for rect in bar.all("rect"):
            assert 0 <= float(rect.attributes["width"]) <= 100


def test_totals_count_robots_chains_and_numbers():
    totals = shown().root.one("p", class_="totals").text
    assert "5 robots, 4 chains; 1 could not be read; 1 fails check; 17,248 numbers computed twice" in totals
    assert "The engines DISAGREE on two-armed" in re.sub(r"\s+", " ", totals)


def test_engines_that_agree_are_told_of():
    assert "Both engines agree" in shown(lone).root.one("p", class_="totals").text


# --- pictures --------------------------------------------------------------------------------------------------


def test_each_drawing_is_shown_once_with_what_it_shows():
    document = made.fleet()
    given = made.drawings(document)
    root = shown().root
    for key, drawing in given.items():
        (found,) = [one for one in root.all() if one.attributes.get("aria-label") == drawing.alt]
        assert found.attributes["role"] == ("group" if key == "fleet/scatter" else "img")
        assert len(found.all("svg", class_="figure")) == 1


@pytest.mark.parametrize("of", FLEETS)
def test_a_report_without_drawings_is_a_page(of):
    bare = HtmlPage(page(of(), {}))
    assert bare.problems == []
    assert bare.root.all("figure") == []
    assert bare.root.all(class_="thumbnails") == []


def test_thumbnails_are_at_one_scale_the_farthest_first():
    document = made.fleet()
    given = made.drawings(document)
    part = shown().root.one("section", class_="thumbnails")
    reaches = {f"#{chain.id}": chain.reach for robot in document.robots for chain in robot.chains}
    links = [link.attributes["href"] for link in part.all("a")]
    assert [reaches[link] for link in links] == sorted(reaches.values(), reverse=True)
    scales = set()
    for link in part.all("a"):
        svg = link.one("svg", class_="figure")
        scales.add(round(float(svg.attributes["width"]) / given[f"{link.attributes['href'][1:]}/thumbnail"].metres))
        wide, high = map(float, svg.attributes["viewbox"].split()[2:])
        assert float(svg.attributes["height"]) / float(svg.attributes["width"]) == pytest.approx(high / wide, abs=0.01)
    assert len(scales) == 1
    ruler = part.one("svg", class_="ruler")
    metres = float(part.one("p", class_="scale").text.split()[0])
    assert float(ruler.attributes["width"]) - 2 == pytest.approx(scales.pop() * metres, rel=0.01)


def test_thumbnails_of_other_sizes_are_at_scales_of_their_own():
    reaches = (9.0, 0.1, 1.3, 0.09, 0.5)
    document = made.document(*(made.robot(f"r{i}", f"a{i}", chains=(made.chain(f"r{i}-1", reach=reach),))
                               for i, reach in enumerate(reaches, 1)))  # fmt: skip
    given = made.drawings(document)
    part = HtmlPage(page(document, given)).root.one("section", class_="thumbnails")
    links = [[link.attributes["href"] for link in grid.all("a")] for grid in part.all("ul", class_="grid")]
    assert links == [["#r1-1"], ["#r3-1", "#r5-1"], ["#r2-1", "#r4-1"]]
    for ruler, text, grid in zip(
        part.all("svg", class_="ruler"), part.all("p", class_="scale"), part.all("ul", class_="grid"), strict=True
    ):
        scale = (float(ruler.attributes["width"]) - 2) / float(text.text.split()[0])
        for link in grid.all("a"):
            width = float(link.one("svg", class_="figure").attributes["width"])
            assert width == pytest.approx(scale * given[f"{link.attributes['href'][1:]}/thumbnail"].metres, rel=0.01)
            assert width > 40


def test_a_single_thumbnail_compares_nothing():
    assert shown(lone).root.all("section", class_="thumbnails") == []


def test_a_picture_has_what_it_shows_as_text():
    given = {"r1/tree": Drawing('<svg class="figure"/>', '"><b>bold</b> & {{ 7 * 7 }}')}
    root = HtmlPage(page(lone(), given)).root
    assert root.one("figcaption").text == '"><b>bold</b> & {{ 7 * 7 }}'


# --- robot by robot --------------------------------------------------------------------------------------------


def test_a_robot_alone_is_open_and_one_of_many_is_folded():
    assert "open" in shown(lone).root.one("details", class_="robot").attributes
    folded = shown().root.all("details", class_="robot")
    assert len(folded) == 5
    assert not any("open" in one.attributes for one in folded)


def test_errors_come_first_and_infos_are_folded():
    part = shown().root.one("details", id="r1")
    first, second = part.all("table", class_="findings")
    assert [row.one("th").text for row in first.one("tbody").all("tr")] == ["error", "warning"]
    assert [row.one("th").text for row in second.one("tbody").all("tr")] == ["info"]
    assert second.parent.parent.tag == "details"
    assert "open" not in second.parent.parent.attributes


def test_many_findings_fold_and_none_is_lost():
    part = shown().root.one("details", id="r2")
    lines = [row.all("td")[0].text for table in part.all("table", class_="findings") for row in table.all("tr")[1:]]
    assert lines == [str(i) for i in range(1, 31)]
    assert "15 more errors and warnings" in part.text


def test_units_that_differ_stand_with_their_numbers_and_others_in_the_header():
    alike, mixed = (shown().root.one("details", id=name) for name in ("r1", "r2"))
    head = alike.one(**{"aria-label": "Joints of panda"}).one("thead").text
    assert "from [rad]" in head
    assert "effort limit [Nm]" in head
    table = mixed.one(**{"aria-label": "Joints of two-armed"})
    assert "[rad]" not in table.one("thead").text
    assert "0.400 m" in table.text
    assert "follows finger_right \N{MULTIPLICATION SIGN} \N{MINUS SIGN}1 + 0.04" in table.text


def test_a_robot_tells_its_certificate_readers_expectations_and_what_is_left_out():
    text = re.sub(r"\s+", " ", shown().root.one("details", id="r2").text)
    assert "4,312 numbers in 31 answers computed twice, by pinocchio and screw" in text
    assert "largest difference 2.0e-09, tolerance 1.8e-12" in text
    assert "The engines DISAGREE." in text
    assert "pinocchio, screw and yourdfpy DISAGREE" in text
    assert re.search("hand *it is a gripper", text)
    table = shown().root.one("details", id="r2").one(**{"aria-label": "Expectations"})
    verdicts = [row.all("td")[0].text for row in table.one("tbody").all("tr")]
    assert verdicts == ["✓ met", "✕ not met", "✕ not judged"]


def test_a_robot_of_which_nothing_was_compared_says_so():
    document = made.document(made.robot(certificate=None, agreement=None))
    text = HtmlPage(page(document, {})).root.one("main").text
    assert "No number was computed twice." in text
    assert "The readers of the file were not compared." in text


def test_robots_of_one_name_are_told_apart_by_their_path():
    twins = [made.robot(f"r{i}", path=f"folder{i}/arm.urdf", chains=()) for i in (1, 2)]
    root = HtmlPage(page(made.document(*twins), {})).root
    rows = [row.one("th") for row in root.one(id="chains").one("tbody").all("tr")]
    assert [row.one("a").text for row in rows] == ["panda", "panda"]
    assert [row.one(class_="aside").text for row in rows] == ["folder1/arm.urdf", "folder2/arm.urdf"]
    assert [part.one(class_="aside").text for part in root.all("summary") if part.all("h2")] == [
        "folder1/arm.urdf",
        "folder2/arm.urdf",
    ]


def test_a_path_that_says_what_the_name_does_is_not_said_twice():
    document = made.document(made.robot(path="robots/Panda.urdf"), made.robot("r2", "two-armed", path="two_armed.urdf"))
    assert HtmlPage(page(document, {})).root.all(class_="aside") == []


# --- what check and the payload say ----------------------------------------------------------------------------


def test_a_robot_that_fails_check_is_told_in_its_row_its_summary_and_the_header_and_can_be_filtered():
    met, missed = made.ExpectationRow(title="reach", met=True, wanted="", found="", place=""), []
    for verdict in (False, None):
        missed.append(made.ExpectationRow(title="reach", met=verdict, wanted="", found="", place=""))
    failing = made.robot("r2", "short", verdict="fail", findings=(), expectations=(met, *missed))
    root = HtmlPage(page(made.document(made.robot(findings=()), failing), {})).root
    fine, short = root.one(id="chains").one("tbody").all("tr")
    assert "data-fails" in short.attributes
    assert "data-fails" not in fine.attributes
    assert "✕ 0 / 0 / 0 2 unmet" in re.sub(r"\s+", " ", short.text)
    assert "unmet" not in fine.text
    assert "✕ fails check: 2 of 3 expectations not met" in root.one("details", id="r2").all("summary")[0].text
    assert "1 fails check" in root.one("p", class_="totals").text


def test_what_died_was_not_checked():
    root = HtmlPage(
        page(made.document(made.failed("r1", status="crashed"), made.failed("r2", verdict="fail")), {})
    ).root
    died, unread = root.one(id="chains").one("tbody").all("tr")
    assert "not checked" in died.text
    assert "0 / 0 / 0" not in died.text
    assert "0 / 0 / 0" in unread.text


def columns(document):
    heads = HtmlPage(page(document, {})).root.one(id="chains").one("thead").all("th")
    return [re.sub(r"\s+", " ", head.text).strip() for head in heads]


def cells(document, column):
    rows = HtmlPage(page(document, {})).root.one(id="chains").one("tbody").all("tr")
    return [row.all("td")[columns(document).index(column) - 1] for row in rows]


def test_the_payload_that_is_asked_for_has_a_column_and_none_has_none():
    two = made.chain(asked_payload=3.0, worst_loaded_use=1.11), made.chain("r1-2", asked_payload=3.0)
    document = made.document(made.robot(chains=two))
    over, unknown = cells(document, "worst use with 3 kg [%]")
    assert over.attributes["data-value"] == "111.00000000000001"
    assert "over the limit" in over.text
    assert "not known" in unknown.text
    other = made.document(made.robot(chains=(two[0], made.chain("r1-2", asked_payload=5.0))))
    heavier, _ = cells(other, "worst use with the payload [%]")
    assert "with 3 kg" in heavier.text  # there are several
    assert not [title for title in columns(made.document(made.robot())) if "worst use" in title]


def test_a_payload_without_limit_is_sorted_as_the_largest():
    free = made.PayloadRow(mass=None, binding_joint="", least=0.0, unbounded=True)
    over = made.PayloadRow(mass=None, binding_joint="j1", least=1.0, unbounded=False)
    chains = made.chain(payload_at_mid=free), made.chain("r1-2"), made.chain("r1-3", payload_at_mid=over)
    first, second, third = cells(made.document(made.robot(chains=chains)), "payload at mid [kg]")
    assert third.text.strip() == "\N{MULTIPLICATION X} none"
    assert float(third.attributes["data-value"]) == 0
    assert first.text.strip() == "no limit"
    assert float(first.attributes["data-value"]) > 1e100 > float(second.attributes["data-value"])


def test_a_payload_of_many_times_the_robot_is_doubted():
    less = msgspec.structs.replace(made.chain().payload_at_mid, mass=5.0)
    heavy, believed = made.chain(), made.chain("r1-2", payload_at_mid=less)
    document = made.document(made.robot(mass=0.7, chains=(heavy, believed)))
    first, second = cells(document, "payload at mid [kg]")
    assert "doubtful" in first.text
    assert "doubtful" not in second.text


@pytest.mark.parametrize("changes", [{"joints": ("neck",)}, {"turns_only": True}])
def test_dexterity_that_compares_nothing_is_not_shown(changes):
    document = made.document(made.robot(chains=(made.chain(**changes), made.chain("r1-2"))))
    for column in ("dexterity, median", "near-singular [%]"):
        nothing, something = cells(document, column)
        assert "not known" in nothing.text
        assert "data-value" not in nothing.attributes
        assert "data-value" in something.attributes
    assert "dexterity, median" not in HtmlPage(page(document, {})).root.one(id="r1-1").one("dl", class_="facts").text


def test_numbers_of_different_units_say_so_to_what_sorts_them():
    feet = made.chain("r1-2", distributions=(made.distribution(unit="m/rad"),))
    document = made.document(made.robot(chains=(made.chain(), feet)))
    assert [c.attributes.get("data-unit") for c in cells(document, "manipu\xadlability, median")] == [None, "m/rad"]


# --- chains ----------------------------------------------------------------------------------------------------


def test_families_outside_limits_are_folded_below_those_inside():
    outside = made.family("far", inside_limits=False, condition="a-pi = -pi/2 and b = -1.5")
    document = made.document(made.robot(chains=(made.chain(families=(outside, made.family())),)))
    inside, folded = HtmlPage(page(document, {})).root.one(id="r1-1").all("table", class_="families")
    assert [row.one("th").text for row in inside.one("tbody").all("tr")] == ["elbow"]
    assert [row.one("th").text for row in folded.one("tbody").all("tr")] == ["far"]
    assert folded.parent.parent.tag == "details"
    assert "a-pi = \N{MINUS SIGN}π/2 and b = \N{MINUS SIGN}1.5" in folded.text


def test_limbs_of_a_robot_that_are_alike_are_one_thumbnail():
    def limbs(key, *reaches):
        return tuple(made.chain(f"{key}-{i}", f"leg{i}", reach) for i, reach in enumerate(reaches, 1))

    dog = made.robot("r1", "dog", chains=limbs("r1", 0.5, 0.502, 0.6, 0.498))
    document = made.document(dog, made.robot("r2", "cat", chains=limbs("r2", 0.5)))
    given = made.drawings(document)
    given = {key: drawing for key, drawing in given.items() if key != "r1-3/thumbnail"}
    part = HtmlPage(page(document, given)).root.one("section", class_="thumbnails")
    assert [link.attributes["href"] for link in part.all("a")] == ["#r1-1", "#r2-1"]
    assert [one.text for one in part.all(class_="alike")] == ["\N{MULTIPLICATION SIGN}3"]
    assert "Not shown: 1 chain " in part.text
