"""Focal maps thinned out with the surface, in the fourth component of Qslim's quadric."""

import dataclasses

import numpy as np
import pytest

from auricle.spectral.harmonics import manifold_harmonics
from auricle.study.paper.features import Stage, marched_foci, places_of, relative_errors
from auricle.study.paper.parameters import PaperParameters
from auricle.study.paper.thinned_features import WAYS, thinned_maps, thinned_records
from auricle.surface.capping import cap_holes
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere
from auricle.surface.simplification import simplification_sequence

PARAMETERS = PaperParameters.tiny(n_modes=150, feature_counts=(20, 50, 100, 10_000))


@pytest.fixture(scope="module")
def stage():
    sphere = icosphere(radius=30.0, subdivisions=4)
    # Without a symmetry, so that no two edges cost the same.
    waves = np.sin(sphere.vertices @ (0.11, 0.07, 0.05) + 0.4)
    mesh = Mesh(sphere.vertices * (1.3, 1.0, 0.9) * (1 + 0.05 * waves)[:, None], sphere.faces)
    return Stage(mesh, cap_holes(mesh), manifold_harmonics(mesh, PARAMETERS.n_modes))


@pytest.fixture(scope="module")
def foci(stage):
    return marched_foci(stage, places_of(stage.surface, PARAMETERS), widest_mm=16.0)


@pytest.fixture(scope="module")
def records(stage, foci):
    return thinned_records(stage, foci, simplification_sequence(stage.surface), PARAMETERS)


def test_there_is_a_record_for_every_size_and_number_of_foci(records):
    kinds = [(each["size"], each["n_foci"]) for each in records]
    assert kinds == [(size, n) for size in ("small", "medium", "wide") for n in (1, 2, 3)]
    for each in records:
        assert each["counts"] == [20, 50, 100]
        assert tuple(each["nrmse"]) == WAYS


def test_a_map_recovered_as_its_mean_is_off_by_its_deviation(stage, foci):
    maps = foci[0].map_of(1, 8.0)[:, None]
    mean = np.full_like(maps, stage.basis.areas @ maps[:, 0] / stage.basis.area)
    assert relative_errors(stage, maps, mean) == pytest.approx([1.0], abs=1e-9)
    assert relative_errors(stage, maps, maps) == pytest.approx([0.0])


def test_the_error_of_harmonics_is_what_their_share_leaves(stage, foci, records):
    (small,) = (e for e in records if (e["size"], e["n_foci"]) == ("small", 1))
    left = []
    for each in foci[:2]:
        spectrum = stage.basis.power_spectrum(each.map_of(1, 4.0))
        left.append(np.sqrt(1 - spectrum.cumulative()[np.array(small["counts"]) - 1]))
    assert small["nrmse"]["harmonics"] == pytest.approx(np.mean(left, axis=0), rel=1e-4)


def test_points_that_know_the_map_keep_it_far_better_than_points_of_the_geometry(records):
    for each in records:
        if each["size"] != "wide":
            known, blind = each["nrmse"]["points_with_feature"], each["nrmse"]["points"]
            assert known[-1] < 0.5 * blind[-1]
        # For that the surface lies at most a fifth further off.
        distances = each["gd_mm"]
        assert distances["points_with_feature"][-1] < 1.2 * distances["points"][-1]


def test_errors_fall_with_the_number(records):
    for each in records:
        for errors in (*each["nrmse"].values(), *each["gd_mm"].values()):
            assert (np.diff(errors) < 0).all()


def test_without_weight_the_points_are_those_of_the_geometry(stage, foci):
    values = foci[0].map_of(1, 8.0)
    found = thinned_maps(stage, values, (100,), weight_mm=1e-9)[100]
    geometry = simplification_sequence(stage.surface).mesh_at(100)
    np.testing.assert_allclose(found.mesh.vertices, geometry.vertices, atol=1e-3)
    assert thinned_maps(stage, values, (2, 100_000), weight_mm=1.0) == {}


def test_points_gather_where_the_map_changes(stage, foci):
    values = foci[0].map_of(1, 4.0)
    centre = stage.surface.vertices[values.argmax()]

    def near(mesh: Mesh) -> int:
        return int((np.linalg.norm(mesh.vertices - centre, axis=1) < 12.0).sum())

    known = thinned_maps(stage, values, (100,), weight_mm=1.0)[100].mesh
    assert near(known) > 2 * near(simplification_sequence(stage.surface).mesh_at(100))


def test_only_the_first_placements_are_thinned_out(stage, foci):
    few = dataclasses.replace(PARAMETERS, focus_widths_mm=(8.0,), focus_counts=(1,))
    sequence = simplification_sequence(stage.surface)
    assert thinned_records(stage, foci[:2], sequence, few) == thinned_records(
        stage, foci, sequence, few
    )
