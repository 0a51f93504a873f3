"""The page of a cohort, from cases on small surfaces."""

import copy
import csv
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.report.cohort_charts import banded
from auricle.report.cohort_further_tables import (
    bootstrap_table,
    class_table,
    recovered_table,
    resolution_table,
    segmentation_table,
    thinned_table,
)
from auricle.report.cohort_page import CAPTIONS, cohort_page, write_cohort
from auricle.report.cohort_tables import (
    assumption_table,
    case_table,
    count_table,
    decay_table,
    power_table,
    reading_table,
)
from auricle.study.paper.case import CaseDocument, run_case
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.tables import count_rows, decay_rows, headline_decays

NAME = "<b>atrium</b> & co"


@pytest.fixture(scope="module")
def documents():
    """Four cases: one worked out, the others like it but for τ, counts and name."""
    parameters = PaperParameters.tiny(convention_vertices=0, finer_vertices=(900,))
    first = run_case(Path("atrium:seed=1,spacing=2.5"), parameters=parameters)
    found = []
    for number, factor in enumerate((1.0, 1.1, 0.9, 1.05)):
        values = copy.deepcopy(first.values) | {"case": f"{NAME} {number}"}
        for record in values["decay"]:
            if record["tau"] is not None:
                record["tau"] *= factor * (1 + 0.02 * number * (record["method"] == "mha"))
        if number:
            values["surfaces"] = {}
        found.append(CaseDocument(values, {"harmonics": 1.0 + number, "features": 0.5}))
    return found


@pytest.fixture(scope="module")
def folder(documents, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cohort")
    write_cohort(documents, folder)
    return folder


@pytest.fixture(scope="module")
def page(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


class Balance(HTMLParser):
    """Counts tags that are open at the end."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag, attrs):
        del attrs
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_every_figure_of_the_paper_is_there(folder, page):
    for name, caption in CAPTIONS.items():
        assert (folder / "figures" / name).stat().st_size > 1_000
        assert caption.title in page
    for number in range(1, 6):
        assert f"Figure {number}:" in page


def test_the_page_is_complete_in_itself_and_well_formed(page):
    assert "<script" not in page
    assert not re.search(r"""(src|href)=["'](?!data:)""", page)
    balance = Balance()
    balance.feed(page)
    assert balance.open == []


def test_names_are_text(page):
    assert NAME not in page
    assert "&lt;b&gt;atrium&lt;/b&gt;" in page


def test_printed_values_stand_beside_ours(page):
    for printed in ("211.2 ± 89", "173.8 ± 19.7", "70.5 ± 17", "392.6 ± 214.1", "531", "960"):
        assert printed in page


def test_every_claim_has_its_outcome(page):
    assert (
        len(re.findall(r"<td>(confirmed|partly confirmed|refuted|cannot be told)</td>", page)) == 9
    )


def test_the_same_cases_give_the_same_files(documents, folder, tmp_path):
    write_cohort(documents, tmp_path)
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            assert path.read_bytes() == (tmp_path / path.relative_to(folder)).read_bytes()


def test_the_numbers_are_in_csv_too(folder, documents):
    values = [each.values for each in documents]
    with (folder / "table1.csv").open(encoding="utf-8", newline="") as file:
        counts = list(csv.DictReader(file))
    assert len(counts) == 20
    assert counts[0]["size"] == "geometry"
    assert float(counts[0]["printed"]) == 250
    with (folder / "decay.csv").open(encoding="utf-8", newline="") as file:
        decays = list(csv.DictReader(file))
    assert len(decays) == len(decay_rows(values))
    headline = headline_decays(decay_rows(values))[0]
    assert float(decays[0]["mha_mean"]) == headline.mha.mean


def test_every_row_fills_its_table(documents):
    values = [each.values for each in documents]
    rows = decay_rows(values)
    tables = (
        count_table(count_rows(values)),
        decay_table(headline_decays(rows), "τ"),
        assumption_table(headline_decays(rows)),
        reading_table(rows),
        power_table(values),
        case_table(values),
        class_table(values),
        resolution_table(values),
        recovered_table(values),
        thinned_table(values),
        segmentation_table(values),
        bootstrap_table(values),
    )
    for table in tables:
        assert all(len(row) == len(table.head) for row in table.rows), table.caption
    assert all(table.rows for table in tables if "Segmented" not in table.caption)


def test_one_case_without_surfaces_still_makes_a_page(documents):
    lone = CaseDocument(documents[1].values, {})
    page = cohort_page([lone], {})
    assert "What it cost" not in page
    assert "cannot be told" in page


def test_no_case_is_no_page(tmp_path):
    with pytest.raises(InputError, match="no case"):
        write_cohort([], tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_bands_keep_the_sum(rng):
    shares = rng.random(1000)
    harmonics, means = banded(shares)
    n_modes = len(shares)
    edges = np.unique(
        np.rint(np.geomspace(2, n_modes + 1, int(np.ceil(10 * np.log10(n_modes / 2))) + 2))
    )
    assert (means * np.diff(edges)).sum() == pytest.approx(shares[1:].sum())
    assert (np.diff(harmonics) > 0).all()
