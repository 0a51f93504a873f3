"""A study in the page: its folder read back, its table and pictures in a browser."""

import base64
import json

import numpy as np
import pytest

from auricle.errors import FormatError, InputError
from auricle.surface.shapes import icosphere
from auricle.viewer.cohort_files import is_cohort
from auricle.viewer.cohort_session import cohort_session
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail

MARKUP = "<img src=x onerror=alert(1)>.vtp"
TABLE_1 = """\
n_foci,size,share,median,low,high,n,n_beyond,case_median_low,case_median_high,printed,ratio
,geometry,0.85,25,20,30,3,0,20,30,250,0.1
,geometry,0.9,80,70,inf,3,1,70,inf,960,0.083
1,small,0.85,30,10,inf,9,3,30,30,217,0.138
"""
DECAY = """\
error,reading,counts,with_floor,n,mha_mean,mha_deviation,qslim_mean,printed_mha,printed_qslim
GD,gd_from_original_mm,even,False,2,37.75,3.2,,211.2,173.8
GD,gd_from_original_mm,even,True,2,1,1,1,1,1
"""


def packed(values, step):
    whole = np.rint(np.asarray(values, float) / step).astype("<i4")
    content = base64.b64encode(whole.tobytes()).decode()
    return {"shape": list(whole.shape), "kind": "<i4", "step": step, "base64": content}


def case_document(name, radius, counts, tau, *, with_surface=True):
    mesh = icosphere(radius=radius, subdivisions=3)
    values = {
        "name": name,
        "kind": "surface",
        "surface_analyzed": {
            "n_vertices": mesh.n_vertices,
            "area_mm2": 4 * np.pi * radius**2,
            "volume_mm3": 4 / 3 * np.pi * radius**3,
        },
        "geometry": {"counts": {"0.85": counts[0], "0.9": counts[1]}},
        "features": [
            {"size": "small", "n_foci": 1, "counts": {"0.85": [10, 30, None], "0.9": [None] * 3}}
        ],
        "decay": [
            {
                "method": method,
                "error": error,
                "range": "even",
                "with_floor": False,
                "tau": tau if method == "mha" else None,
            }
            for method in ("mha", "qslim")
            for error in ("gd_from_original_mm", "mse_mm2")
        ],
        "surfaces": {
            "original": {
                "vertices_mm": packed(mesh.vertices, 0.01),
                "faces": packed(mesh.faces, 1.0),
            },
            "maps": [
                {
                    "n_foci": 2,
                    "sigma_mm": 4.0,
                    "values": packed(mesh.vertices[:, 2] / radius, 0.005),
                }
            ],
        },
    }
    if not with_surface:
        values["surfaces"] = {}
    return {"format": "auricle case 1", "key": name, "values": values}


def write(place, document):
    place.parent.mkdir(exist_ok=True)
    place.write_text(json.dumps(document), encoding="utf-8")


@pytest.fixture
def folder(tmp_path):
    """A study as `auricle study` writes it: three cases, one failed."""
    study = tmp_path / "study"
    study.mkdir()
    write(study / "cases" / "a1.json", case_document("atrium 10", 20.0, (30, 90), 35.5))
    write(study / "cases" / "b2.json", case_document("atrium 9", 25.0, (20, None), 40.0))
    plain = case_document(MARKUP, 30.0, (25, 70), None, with_surface=False)
    write(study / "cases" / "c3.json", plain)
    write(study / "failures" / "d4.json", {"case": "<b>torn</b>.stl", "error": "is empty: export"})
    write(study / "failures" / "a1.json", {"case": "atrium 10", "error": "of an earlier run"})
    (study / "table1.csv").write_text(TABLE_1, encoding="utf-8")
    (study / "decay.csv").write_text(DECAY, encoding="utf-8")
    return study


def test_a_study_is_known_by_its_cases(folder, tmp_path):
    assert is_cohort(folder)
    assert not is_cohort(tmp_path)
    assert not is_cohort(folder / "table1.csv")


def test_the_numbers_of_the_cases_and_tables_are_those_of_the_files(folder):
    document = cohort_session(folder).document()
    first, second, _ = document["cases"]
    assert first["numbers"]["area"] == pytest.approx(4 * np.pi * 4.0)
    assert first["numbers"]["volume"] == pytest.approx(4 / 3 * np.pi * 8.0)
    assert (first["numbers"]["geometry_85"], second["numbers"]["geometry_90"]) == (30.0, None)
    assert first["numbers"]["small_85"] == 30.0
    assert first["numbers"]["small_90"] is None
    assert (first["numbers"]["tau_mha_gd"], first["numbers"]["tau_qslim_gd"]) == (35.5, None)
    assert document["medians"]["geometry_85"] == 25.0
    assert document["table1"][1]["high"] is None
    assert [row["mha_mean"] for row in document["decay"]] == [37.75]
    assert [each["name"] for each in document["failed"]] == ["<b>torn</b>.stl"]
    json.dumps(document, allow_nan=False)


def test_the_surface_of_a_case_comes_back_with_its_maps(folder):
    name, soup = cohort_session(folder).surface("a1")
    mesh = icosphere(radius=20.0, subdivisions=3)
    assert name == "atrium 10"
    np.testing.assert_allclose(soup.vertices, mesh.vertices, atol=0.0051)
    np.testing.assert_array_equal(soup.faces, mesh.faces)
    (values,) = soup.point_fields.values()
    np.testing.assert_allclose(values, mesh.vertices[:, 2] / 20.0, atol=0.0026)


def torn(folder, change):
    place = folder / "cases" / "a1.json"
    document = json.loads(place.read_text(encoding="utf-8"))
    change(document["values"]["surfaces"])
    write(place, document)
    return cohort_session(folder)


@pytest.mark.parametrize(
    "change",
    [
        lambda kept: kept["original"].pop("faces"),
        lambda kept: kept["original"]["vertices_mm"].update(base64="!"),
        lambda kept: kept["original"]["vertices_mm"].update(shape=[2, 3]),
        lambda kept: kept["original"]["vertices_mm"].update(kind="object"),
        lambda kept: kept["maps"][0].update(values=packed([1.0], 1.0)),
        lambda kept: kept.update(original=3),
    ],
)
def test_a_torn_surface_is_refused_in_words(folder, change):
    with pytest.raises(FormatError, match="torn"):
        torn(folder, change).surface("a1")


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"format": "auricle case 1"}', "[" * 100_000])
def test_a_file_that_is_no_case_is_refused_by_its_name(folder, text):
    (folder / "cases" / "e5.json").write_text(text, encoding="utf-8")
    with pytest.raises(FormatError, match=r"e5\.json"):
        cohort_session(folder)


def test_a_case_of_another_study_cannot_be_asked_for(folder):
    session = cohort_session(folder)
    for key in ["../failures/d4", "nothing", ""]:
        with pytest.raises(InputError, match="no such case"):
            session.surface(key)
    with pytest.raises(FormatError, match="kept no surface"):
        session.surface("c3")


def names(page):
    rows = page.locator(".cases tbody tr:not(.failed) th")
    return [text.strip() for text in rows.all_inner_texts()]


def test_cases_are_sorted_pictured_and_opened(folder, serve, browsing):
    server = serve(cohort_session(folder), Detail(400, 30), name="study")
    page = browsing.open(server.address)
    page.wait_for_selector(".cases table")
    assert names(page) == [MARKUP, "atrium 9", "atrium 10"]
    page.get_by_role("button", name="Area").click()
    assert names(page) == ["atrium 10", "atrium 9", MARKUP]
    page.get_by_role("button", name="Geometry, 90 %").click()
    assert names(page) == [MARKUP, "atrium 10", "atrium 9"]
    page.get_by_role("button", name="Geometry, 90 %").click()
    assert names(page) == ["atrium 10", MARKUP, "atrium 9"]
    assert page.locator("th[aria-sort=descending]").inner_text().startswith("Geometry, 90 %")
    assert "<b>torn</b>.stl" in page.locator(".cases .failed").inner_text()
    assert page.locator("img").count() == 0

    pictures = page.locator(".picture svg")
    assert "geometry, 85 %: 25, printed 250" in pictures.first.get_attribute("aria-label")
    assert "GD, MHA: 37.8 ± 3.20, printed 211" in pictures.last.get_attribute("aria-label")
    assert page.locator(".picture .case[data-key]").count() == 4
    assert browsing.violations() == []

    with page.expect_download() as saved:
        page.get_by_role("button", name="Save as CSV").click()
    lines = saved.value.path().read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("Case,Kind,Vertices,Area (cm²)")
    assert lines[1].startswith("atrium 10,surface,642,")

    page.get_by_role("button", name="atrium 10").click()
    page.wait_for_selector("nav button[aria-current=page]:text-is('Explore')")
    assert server.workspace.require(OpenCase, "none").name == "atrium 10"
