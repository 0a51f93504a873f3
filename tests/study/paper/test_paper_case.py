"""One case of the paper's study, on small surfaces."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.study.paper.case import run_case
from auricle.study.paper.features import places_of
from auricle.study.paper.packing import unpacked
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.surfaces import pictured_surfaces
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.writing import write_surface

PARAMETERS = PaperParameters.tiny(convention_vertices=0)


def bumpy(radius: float = 30.0) -> Mesh:
    sphere = icosphere(radius=radius, subdivisions=4)
    vertices = sphere.vertices * (1.4, 1.0, 0.9)
    vertices[:, 2] += 5.0 * np.sin(vertices[:, 0] / 8.0)
    return Mesh(vertices, sphere.faces)


def case_of(folder: Path, mesh: Mesh, **changed: object) -> dict:
    path = folder / "atrium.vtp"
    write_surface(path, mesh)
    return run_case(path, parameters=dataclasses.replace(PARAMETERS, **changed)).values


@pytest.fixture(scope="module")
def values(tmp_path_factory):
    return case_of(tmp_path_factory.mktemp("case"), bumpy())


def test_the_same_case_gives_the_same_bytes(values, tmp_path):
    again = case_of(tmp_path, bumpy())
    assert json.dumps(values, allow_nan=False) == json.dumps(again, allow_nan=False)


def test_no_path_and_no_time_is_in_a_case(values, tmp_path):
    text = json.dumps(values)
    assert str(tmp_path.parent) not in text
    assert values["name"] == "atrium.vtp"
    assert "seconds" not in text
    assert "wall" not in text


def test_parsevals_shares_end_below_one_and_rise(values):
    shares = np.array(values["geometry"]["accumulated_share"])
    assert shares[0] == 0.0
    assert (np.diff(shares) >= 0).all()
    assert 0.99 < shares[-1] <= 1.0


def test_coefficients_in_mm_add_up_to_the_spread(values):
    geometry = values["geometry"]
    squares = sum(np.square(column).sum() for column in geometry["coefficients_mm"].values())
    expected = geometry["spread_mm"] ** 2 * geometry["accumulated_share"][-1]
    assert squares == pytest.approx(expected, rel=1e-4)


def test_counts_are_read_off_the_shares(values):
    geometry = values["geometry"]
    for share in ("0.85", "0.9", "0.99"):
        count = geometry["counts"][share]
        assert geometry["accumulated_share"][count - 1] >= float(share)
        assert geometry["accumulated_share"][count - 2] < float(share)


def test_the_error_of_harmonics_is_what_the_shares_leave(values):
    quality, geometry = values["quality"]["mha"], values["geometry"]
    for count, mean_square in zip(quality["counts"], quality["mse_mm2"], strict=True):
        left = geometry["spread_mm"] ** 2 * (1 - geometry["accumulated_share"][count - 1])
        # The one is weighted by area, the other is not.
        assert mean_square == pytest.approx(left, rel=0.35)


def test_counts_of_a_focus_follow_the_closed_form(tmp_path):
    found = case_of(tmp_path, bumpy(), n_modes=300, focus_widths_mm=(6.0,), placements=6)
    for record in found["features"]:
        for share, expected in record["closed_form"].items():
            # The constant harmonic is counted here and not there.
            assert np.median(record["counts"][share]) - 1 == pytest.approx(expected, rel=0.25)


def test_what_harmonics_do_not_hold_has_no_count(values):
    small = values["features"][0]
    assert small["closed_form"]["0.9"] > values["parameters"]["n_modes"]
    assert small["counts"]["0.9"] == [None] * values["parameters"]["placements"]


def test_a_fourfold_area_needs_as_many_harmonics_for_foci_twice_as_wide(tmp_path):
    small = case_of(tmp_path, bumpy(20.0), focus_widths_mm=(7.0,))
    large = case_of(
        tmp_path, Mesh(2 * bumpy(20.0).vertices, bumpy().faces), focus_widths_mm=(14.0,)
    )
    assert small["features"][0]["counts"] == large["features"][0]["counts"]
    assert large["shell"]["area_mm2"] == pytest.approx(4 * small["shell"]["area_mm2"])


def test_renumbering_a_surface_moves_no_focus(rng):
    mesh = bumpy()
    order = rng.permutation(mesh.n_vertices)
    place = np.argsort(order)
    shuffled = Mesh(mesh.vertices[order], rng.permutation(place[mesh.faces], axis=0))
    for one, other in zip(
        places_of(mesh, PARAMETERS), places_of(shuffled, PARAMETERS), strict=True
    ):
        assert np.abs(one - other).max() < 1e-9


def test_fewer_foci_are_the_first_of_more():
    mesh = bumpy()
    alone = places_of(mesh, dataclasses.replace(PARAMETERS, focus_counts=(1,)))
    three = places_of(mesh, PARAMETERS)
    assert all(np.allclose(one[0], most[0]) for one, most in zip(alone, three, strict=True))


def test_the_pictured_surfaces_are_those_measured(values):
    found = pictured_surfaces(values["surfaces"])
    assert sorted(found.mha) == [50, 100]
    assert {count: mesh.n_vertices for count, mesh in found.qslim.items()} == {50: 50, 100: 100}
    mean_square = np.mean(((found.mha[50].vertices - found.original.vertices) ** 2).sum(axis=1))
    place = values["quality"]["mha"]["counts"].index(50)
    assert mean_square == pytest.approx(values["quality"]["mha"]["mse_mm2"][place], rel=0.02)
    assert [each.size for each in found.maps] == ["small", "medium", "wide"]
    assert unpacked(values["surfaces"]["maps"][0]["values"]).shape == (600,)


def test_surfaces_can_be_left_out(tmp_path):
    assert case_of(tmp_path, bumpy(), surfaces_kept=False)["surfaces"] == {}


def test_holes_are_capped_and_told(tmp_path):
    mesh = bumpy()
    kept = mesh.vertices[mesh.faces][:, :, 0].max(axis=1) < 30.0
    used, faces = np.unique(mesh.faces[kept], return_inverse=True)
    found = case_of(tmp_path, Mesh(mesh.vertices[used], faces.reshape(-1, 3)))
    assert len(found["shell"]["cap_areas_mm2"]) == 1
    assert found["surface_analyzed"]["n_vertices"] == 600
    assert found["shell"]["n_vertices"] > 600
    assert found["quality"]["qslim"]["counts"]


def test_more_vertices_are_another_look_at_the_same_maps(tmp_path):
    resolutions = {"n_vertices": 1_200, "finer_vertices": (2_400, 100_000)}
    found = case_of(tmp_path, bumpy(), n_modes=200, **resolutions)
    (finer,) = found["beyond"]["resolution"]
    assert finer["n_vertices"] == 2_400
    same = [each for each in found["features"] if each["n_foci"] == 1]
    for again, before in zip(finer["features"], same, strict=True):
        assert again["size"] == before["size"]
        if again["size"] != "small":  # whose width spans few of 1,200 vertices
            change = np.subtract(again["counts"]["0.9"], before["counts"]["0.9"])
            assert change == pytest.approx(0, abs=2)
    assert finer["geometry"]["0.9"] == found["geometry"]["counts"]["0.9"]


def test_a_surface_too_coarse_for_its_harmonics_is_refused(tmp_path):
    path = tmp_path / "coarse.vtp"
    write_surface(path, icosphere(radius=30.0, subdivisions=1))
    with pytest.raises(InputError, match="120 harmonics of 42 vertices"):
        run_case(path, parameters=PARAMETERS)


def test_counts_of_maps_hardly_change_on_the_recovered_surface(tmp_path):
    found = case_of(tmp_path, bumpy(), n_modes=200, focus_widths_mm=(8.0, 16.0))
    (again,) = found["beyond"]["recovered"]
    assert again["count"] == 100
    assert again["area_mm2"] == pytest.approx(found["shell"]["area_mm2"], rel=0.02)
    for after, before in zip(
        again["features"], (e for e in found["features"] if e["n_foci"] == 1), strict=True
    ):
        change = np.subtract(after["counts"]["0.9"], before["counts"]["0.9"])
        assert change == pytest.approx(0, abs=3)


def test_maps_thinned_out_in_four_dimensions_are_kept_for_pictures(values):
    for each in pictured_surfaces(values["surfaces"]).maps:
        assert {count: level.mesh.n_vertices for count, level in each.thinned.items()} == {
            50: 50,
            100: 100,
        }
        assert each.thinned[100].values.max() == pytest.approx(each.values.max(), abs=0.15)
