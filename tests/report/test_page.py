"""The report's page: complete in itself, true to the case, safe against what files hold."""

import base64
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from auricle.report.answer import answer_sentence
from auricle.report.page import CAPTIONS, report_page
from auricle.report.tables import HARMONICS, quantity_table
from auricle.surface.cleaning import Repair

FIGURES = {name: f"<{name}>".encode() for name in CAPTIONS}
VOID = {"meta", "img", "br", "link"}


class Outline(HTMLParser):
    """Elements of a page, their attributes, its text; complains of elements not closed in order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        self.text += " " if tag in ("td", "th") else ""

    def handle_data(self, data):
        self.text += data if self.open and self.open[-1] != "style" else ""

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def words(page: str) -> str:
    return " ".join(Outline(page).text.split())


@pytest.fixture(scope="module")
def page(case) -> str:
    return report_page(case, FIGURES)


def test_the_page_begins_with_the_answer(case, page):
    text = words(page)
    assert answer_sentence(case) in text
    assert text.index(answer_sentence(case)) < text.index("How to read this")
    assert text.index("How to read this") < text.index("Limits") < text.index("All numbers")


def test_nothing_is_loaded_from_anywhere_and_nothing_runs(page):
    outline = Outline(page)
    (policy,) = [m["content"] for m in outline.all("meta") if m.get("http-equiv")]
    assert policy == "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
    for tag in ("script", "link", "iframe", "form", "object"):
        assert outline.all(tag) == []
    for _, attributes in outline.elements:
        assert attributes.get("src", "data:").startswith("data:")
        assert attributes.get("href", "#").startswith("#")
        assert not any(name.startswith("on") for name in attributes)
    assert "url(" not in page
    assert "@import" not in page


def test_every_figure_is_inside_with_its_bytes_and_words_for_those_who_cannot_see(page):
    images = Outline(page).all("img")
    assert len(images) == len(FIGURES)
    for name, image in zip(CAPTIONS, images, strict=True):
        head, _, content = image["src"].partition(";base64,")
        assert base64.b64decode(content) == FIGURES[name]
        assert head == ("data:image/svg+xml" if name.endswith("svg") else "data:image/png")
        assert len(image["alt"]) > 20


def test_missing_figures_leave_no_gap_and_new_ones_come_last(case):
    images = Outline(report_page(case, {"new.png": b"new", "spectrum.svg": b"s"})).all("img")
    assert [base64.b64decode(each["src"].partition(",")[2]) for each in images] == [b"s", b"new"]


def test_every_table_has_a_caption_and_heads_with_a_scope(page):
    outline = Outline(page)
    assert len(outline.all("table")) == len(outline.all("caption")) > 10
    assert all(head.get("scope") in ("row", "col") for head in outline.all("th"))
    assert outline.all("html")[0]["lang"] == "en"


def test_links_and_labels_lead_to_places_on_the_page(page):
    outline = Outline(page)
    places = [attributes["id"] for _, attributes in outline.elements if "id" in attributes]
    assert len(places) == len(set(places))
    linked = [link["href"][1:] for link in outline.all("a")]
    labels = [s["aria-labelledby"] for s in outline.all("section") if "aria-labelledby" in s]
    assert {*linked, *labels} <= set(places)


@pytest.mark.parametrize("where", ["file", "field", "remark", "repair"])
def test_what_a_file_holds_is_text_and_never_markup(case, where):
    hostile = "<img src=x onerror=alert(1)>\"'&\u202e\ud800</td>"
    field = replace(case.fields[0], name=hostile)
    changed = {
        "file": {"source": replace(case.source, name=hostile)},
        "field": {"fields": (field,)},
        "remark": {"remarks": (hostile,)},
        "repair": {"repairs": (Repair(hostile, 1),)},
    }[where]
    page = report_page(replace(case, **changed), {})
    assert Outline(page).all("img") == []
    assert "&lt;img src=x onerror" in page
    page.encode("utf-8")


def test_the_same_case_gives_the_same_page_whatever_time_it_took(case, page):
    assert report_page(replace(case, seconds={"harmonics": 123.456}), FIGURES) == page
    assert "123.456" not in page


def test_the_page_holds_the_numbers_of_the_tables(case, page):
    text = words(page)
    for row in quantity_table(case, HARMONICS).rows:
        assert " ".join(row) in text
    assert case.source.sha256 in text
    assert f"finds {case.certificate.n_modes} eigenvalues below" in text
    assert "none is missing" in text


def test_a_certificate_that_does_not_add_up_is_not_praised(case):
    doubtful = replace(case.certificate, eigenvalues_below_gap=case.certificate.n_modes + 1)
    text = words(report_page(replace(case, certificate=doubtful), {}))
    assert "none is missing" not in text
    assert "must not be used" in text


def test_repairs_are_named_with_their_count_or_none_is_said(case, page):
    assert "Repairs made None." in words(page)
    repaired = replace(case, repairs=(Repair("coincident vertices merged", 12),))
    assert "12 coincident vertices merged" in words(report_page(repaired, {}))


def test_remarks_stand_above_the_figures(case, page):
    assert case.remarks
    text = words(page)
    for remark in case.remarks:
        assert text.index(remark) < text.index("How to read this")


def test_holes_are_told_only_where_there_were_some(case, page):
    assert "The surface has no holes" in words(page)
    holed = replace(case, cap_areas_mm2=(200.0, 100.0))
    text = words(report_page(holed, {}))
    share = 100 * 300.0 / case.shell_area_mm2
    assert (
        f"2 holes of the surface were closed by caps ({share:.2g} % of the closed surface)" in text
    )


def test_the_page_can_be_written_without_any_map(case):
    bare = replace(case, fields=(), simulated=(), remarks=())
    assert "rebuild the shape" in words(report_page(bare, {}))


def test_light_dark_and_paper_are_provided_for(page):
    assert "prefers-color-scheme: dark" in page
    assert "@media print" in page


def test_it_says_what_it_is_not(page):
    assert words(page).count("not a medical device") >= 2
