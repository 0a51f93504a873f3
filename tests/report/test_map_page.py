"""The page of a reconstruction: true to the result, and silent where nothing is known."""

import csv
import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from auricle.report.map_figures import map_picture
from auricle.report.map_page import (
    CAPTIONS,
    map_answer,
    map_fields,
    map_page,
    next_points_csv,
    samples_csv,
    write_map,
)
from auricle.report.wording import percent
from auricle.study.mapping import map_samples
from auricle.study.mapping_result import MappingConfig, MappingResult
from auricle.surface.cleaning import clean
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface

FIGURES = {name: f"<{name}>".encode() for name in CAPTIONS}
HOSTILE = "<img src=x onerror=alert(1)>\"'&\u202e</td>"


@pytest.fixture(autouse=True)
def _coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small pictures: quicker to draw."""
    monkeypatch.setattr("auricle.report.maps.RESOLUTION", 50)


class Outline(HTMLParser):
    """Counts elements and gathers the text; complains of elements not closed in order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text = ""
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        assert not any(name.startswith("on") for name, _ in attrs)
        assert dict(attrs).get("src", "data:").startswith("data:")
        if tag not in {"meta", "img", "br", "link"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag
        self.text += " " if tag in ("td", "th", "p", "h3") else ""

    def handle_data(self, data):
        self.text += data if self.open and self.open[-1] != "style" else ""


def words(page: str) -> str:
    return " ".join(Outline(page).text.split())


def case(folder: Path, *, count: int = 80, heading: str = "LAT_ms", **parameters) -> MappingResult:
    sphere = icosphere(radius=30.0, subdivisions=3)
    x, y, z = sphere.vertices.T / 30
    mesh = Mesh(sphere.vertices * (1 + 0.15 * x * y + 0.1 * z**3)[:, None], sphere.faces)
    write_surface(folder / "chamber.vtp", mesh)
    rng = np.random.default_rng(2)
    at = rng.permutation(mesh.n_vertices)[:count]
    values = (100 + 30 * x + 20 * y * z)[at] + rng.normal(0, 2, count)
    np.savetxt(
        folder / "samples.csv",
        np.column_stack([mesh.vertices[at], values]),
        delimiter=",",
        header=f"x,y,z,{heading}",
        comments="",
    )
    config = MappingConfig(n_vertices=700, n_modes=80, **parameters)
    return map_samples(folder / "chamber.vtp", folder / "samples.csv", config)


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> MappingResult:
    return case(tmp_path_factory.mktemp("map"), noise=2.0)


@pytest.fixture(scope="module")
def nothing(tmp_path_factory) -> MappingResult:
    return case(tmp_path_factory.mktemp("nothing"), count=3)


@pytest.fixture(scope="module")
def cyclic(tmp_path_factory) -> MappingResult:
    return case(tmp_path_factory.mktemp("cyclic"), cycle_length_ms=150.0)


def test_the_page_begins_with_the_answer_and_holds_the_numbers(found):
    text = words(map_page(found, FIGURES))
    assert map_answer(found) in text
    assert f"Predicted error {percent(found.predicted_nrmse)} of the map's deviation" in text
    assert f"{percent(found.smooth_nrmse)} if all that was fitted as noise is noise" in text
    assert re.search(r"Noise of a sample [\d.]+ ms standard deviation, fitted; stated: 2 ms", text)
    assert found.samples_source.sha256 in text
    assert found.prepared.source.sha256 in text
    assert text.count("not a medical device") >= 2


def test_which_truth_is_meant_is_said(found):
    assert "noise stated (2 ms)" in words(map_page(found, {}))
    silent = replace(found, noise_stated=None)
    assert "No noise was stated" in words(map_page(silent, {}))
    ample = replace(found, noise_stated=9.0)
    assert "explains all that was fitted as noise" in words(map_page(ample, {}))


def test_what_the_map_is_a_mean_of_is_said_and_only_of_a_mean(found, nothing, cyclic):
    splines = found.hyperparameters.splines
    shares = [
        percent(1 - sum(term.share for term in splines)),
        *(percent(t.share) for t in splines),
    ]
    said = words(map_page(found, FIGURES))
    assert f"harmonics ({shares[0]})" in said
    assert f"splines through space ({' and '.join(shares[1:])})" in said
    assert "that many samples share" in said
    assert "that many samples share" not in words(map_page(cyclic, FIGURES))
    alone = replace(found, hyperparameters=replace(found.hyperparameters, splines=()))
    for without in (alone, nothing):
        assert "the mean of a Gaussian process" not in words(map_page(without, FIGURES))


def test_enough_is_said_only_if_the_verdict_says_so(found):
    assert map_answer(found).startswith("Enough for an error of 10 %") == found.verdict.enough
    doubt = replace(found, verdict=replace(found.verdict, enough=False, reasons=("a", "b")))
    assert map_answer(doubt) == "Not enough yet: a; b."


def test_where_nothing_is_known_nothing_is_claimed(nothing):
    """No error, no deviation, no noise, no bandwidth, in the page and in the tables."""
    page = map_page(nothing, {})
    text = words(page)
    assert map_answer(nothing) == (
        "Not enough yet: 3 samples say too little of the map to judge it by."
    )
    for claim in (
        "Predicted error",
        "predicted error",
        "Standard deviation",
        "Noise of a sample",
        "Bandwidth",
        "Correlation length",
        "Amplitude",
        "standardised",
        "too sparsely",
        "Finest wavelength",
        "Samples left out",
    ):
        assert claim not in text, claim
    assert "nan" not in text.lower().split()
    assert "no map is drawn and no error or uncertainty is given" in text
    errors = [
        row["predicted_nrmse"] for row in csv.DictReader(io.StringIO(next_points_csv(nothing)))
    ]
    assert errors == [""] * 5
    residuals = [row["residual_ms"] for row in csv.DictReader(io.StringIO(samples_csv(nothing)))]
    assert residuals == [""] * 3
    for field in map_fields(nothing)[:3]:
        assert np.isnan(field.values).all()


def test_samples_are_listed_with_their_row_place_value_and_residual(found):
    rows = list(csv.DictReader(io.StringIO(samples_csv(found))))
    assert len(rows) == len(found.placed)
    read = np.array([[float(row[f"{axis}_mm"]) for axis in "xyz"] for row in rows])
    places = found.placed.sites.positions(found.prepared.chamber.mesh)
    np.testing.assert_allclose(read, places, atol=5.1e-4)
    values = [float(row["value_ms"]) for row in rows]
    np.testing.assert_allclose(values, found.placed.values, rtol=1e-5)
    assert [int(row["row"]) for row in rows] == (found.placed.kept + 1).tolist()


def test_next_points_are_listed_best_first(found):
    errors = [
        float(row["predicted_nrmse"]) for row in csv.DictReader(io.StringIO(next_points_csv(found)))
    ]
    assert errors == sorted(errors, reverse=True)
    assert errors[0] < found.predicted_nrmse


@pytest.mark.parametrize("where", ["file", "samples", "name", "unit", "reason", "remark", "region"])
def test_what_a_file_holds_is_text_and_never_markup(found, where):
    prepared = found.prepared
    changed = {
        "file": {"prepared": replace(prepared, source=replace(prepared.source, name=HOSTILE))},
        "samples": {"samples_source": replace(found.samples_source, name=HOSTILE)},
        "name": {"placed": replace(found.placed, name=HOSTILE)},
        "unit": {"placed": replace(found.placed, unit=HOSTILE)},
        "reason": {"verdict": replace(found.verdict, enough=False, reasons=(HOSTILE,))},
        "remark": {"remarks": (HOSTILE,)},
        "region": {"config": replace(found.config, forbid=HOSTILE)},
    }[where]
    page = map_page(replace(found, **changed), {})
    assert "img" not in Outline(page).tags
    assert "script" not in Outline(page).tags
    assert "&lt;img src=x" in page
    assert "\u202e" not in page


@pytest.mark.parametrize("name", [HOSTILE, "undersampled", "\n", "=1+2"])
def test_values_of_any_name_can_be_written(found, tmp_path, name):
    odd = replace(found, placed=replace(found.placed, name=name, unit="$\u202e"))
    write_surface(tmp_path / "map.vtp", found.prepared.surface, map_fields(odd))
    assert len({field.name for field in map_fields(odd)}) == 4


def test_values_of_any_name_can_be_drawn(found):
    odd = replace(found, placed=replace(found.placed, name="$x_2 " + HOSTILE, unit="$\u202e"))
    FigureCanvasAgg(map_picture(odd)).draw()


def test_the_same_result_gives_the_same_page_whatever_time_it_took(found):
    later = replace(found, seconds={"rebuild": 123.456})
    assert map_page(later, FIGURES) == map_page(found, FIGURES)


def written(result: MappingResult, folder: Path) -> tuple[set[str], dict]:
    """Names of the files, and the document, which holds no number that JSON has not."""

    def refused(constant):
        raise AssertionError(constant)

    write_map(result, folder)
    names = {each.relative_to(folder).as_posix() for each in folder.rglob("*") if each.is_file()}
    return names, json.loads((folder / "result.json").read_text(), parse_constant=refused)


FILES = {"report.html", "result.json", "timings.json", "map.vtp", "samples.csv", "next_points.csv"}


def test_the_folder_is_complete(found, tmp_path):
    names, document = written(found, tmp_path / "out")
    assert names == FILES | {f"figures/{name}" for name in CAPTIONS}
    assert document["predicted_nrmse"] == pytest.approx(found.predicted_nrmse)
    assert document["unit"] == "ms"
    cleaned = clean(read_surface(tmp_path / "out/map.vtp"))
    fields = {field.name: field for field in cleaned.fields}
    np.testing.assert_allclose(fields["LAT"].values, found.mean)
    np.testing.assert_allclose(fields["LAT_standard_deviation"].values, found.std)
    assert fields["LAT"].unit == "ms"
    assert fields["supported_wavelength"].unit == "mm"


def test_the_folder_of_nothing_known_has_one_figure_of_the_bare_surface(nothing, tmp_path):
    names, document = written(nothing, tmp_path / "out")
    assert names == FILES | {"figures/map.png"}
    assert document["knows_nothing"] is True
    assert "The samples and where to go next" in (tmp_path / "out/report.html").read_text()


def test_times_of_a_cycle_have_their_numbers_in_ms(cyclic, tmp_path):
    _, document = written(cyclic, tmp_path / "out")
    text = words((tmp_path / "out/report.html").read_text())
    assert "Cycle length 150 ms" in text
    assert re.search(r"Noise of a sample [\d.]+ ms standard deviation, fitted; none stated", text)
    assert "of cosine and sine" in text
    header = (tmp_path / "out/samples.csv").read_text().splitlines()[0]
    assert header.endswith("value_ms,n_merged,residual_ms,doubted")
    assert document["noise_fitted"] == pytest.approx(cyclic.noise_fitted)
