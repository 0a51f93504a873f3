import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.coverage import coverage, neighbour_distances
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.sites import Sites
from auricle.sampling.voronoi import voronoi
from auricle.surface.geodesics import exact_geodesic_distances


def test_one_point_of_a_ball_covers_caps_of_known_area(sphere_chamber):
    found = coverage(sphere_chamber, Sites.at_vertices([0]))
    assert found.radius_mm == pytest.approx(30 * np.pi, rel=0.03)
    for radius in (10.0, 15.0):
        assert found.within[radius] == pytest.approx((1 - np.cos(radius / 30)) / 2, abs=0.01)
    assert found.shares.tolist() == [1.0]
    assert found.spacing_mm == np.inf
    assert found.density_per_cm2 == pytest.approx(100 / sphere_chamber.basis.area)


def test_the_twelve_corners_of_an_icosahedron_share_the_ball_equally(sphere_chamber):
    found = coverage(sphere_chamber, Sites.at_vertices(np.arange(12)))
    np.testing.assert_allclose(found.shares, 1 / 12, rtol=0.12)  # ties go to the first
    assert found.shares.sum() == pytest.approx(1.0, rel=1e-12)
    assert found.spacing_mm == pytest.approx(30 * np.arctan(2), rel=0.01)
    corner_of_cells = 30 * np.arccos(np.sqrt((5 + 2 * 5**0.5) / 15))  # between the vertices
    assert 0.92 < found.radius_mm / corner_of_cells < 1.0


def test_distances_and_shares_are_those_of_exact_geodesics(atrium_chamber):
    points = farthest_point_sampling(atrium_chamber, 4)
    exact = np.stack([exact_geodesic_distances(atrium_chamber.mesh, int(p)) for p in points])
    partition = voronoi(atrium_chamber, Sites.at_vertices(points))
    error = np.abs(partition.distances - exact.min(axis=0))
    assert np.median(error / np.maximum(exact.min(axis=0), 1e-9)) < 0.01
    areas = np.bincount(exact.argmin(axis=0), atrium_chamber.basis.areas)
    np.testing.assert_allclose(partition.shares, areas / areas.sum(), atol=0.01)


def test_points_on_the_surface_out_of_reach_do_not_count(open_chamber):
    """The pole, out of reach, is the farthest place from the other pole; the rim counts."""
    bottom = int(open_chamber.mesh.vertices[:, 2].argmin())
    found = coverage(open_chamber, Sites.at_vertices([bottom]))
    rim = open_chamber.mesh.vertices[open_chamber.accessible, 2].max()
    assert found.radius_mm == pytest.approx(30 * (np.pi - np.arccos(rim / 30)), rel=0.02)
    assert found.density_per_cm2 == pytest.approx(100 / open_chamber.accessible_area)


def test_more_points_never_cover_less(atrium_chamber):
    points = farthest_point_sampling(atrium_chamber, 64)
    few, many = (coverage(atrium_chamber, Sites.at_vertices(points[:n])) for n in (16, 64))
    assert many.radius_mm < few.radius_mm
    assert all(many.within[radius] >= few.within[radius] for radius in few.within)
    assert many.spacing_mm == pytest.approx(few.spacing_mm / 2, rel=0.2)


def test_a_repeated_site_has_its_half_and_no_distance(atrium_chamber):
    points = farthest_point_sampling(atrium_chamber, 10)
    face = atrium_chamber.mesh.faces[50]
    between = Sites(np.tile(face, (2, 1)), np.tile([0.2, 0.3, 0.5], (2, 1)))
    single = Sites.at_vertices(points)
    sites = Sites(
        np.concatenate([single.corners, single.corners[:1], between.corners]),
        np.concatenate([single.weights, single.weights[:1], between.weights]),
    )
    partition = voronoi(atrium_chamber, sites)
    assert partition.shares[0] == partition.shares[10]
    assert partition.shares[11] == partition.shares[12]
    assert partition.shares.sum() == pytest.approx(1.0)
    assert (neighbour_distances(atrium_chamber, sites, partition)[[0, 10, 11, 12]] == 0).all()


def test_neighbours_are_as_far_as_the_nearest_other_site_along_the_surface(atrium_chamber):
    points = farthest_point_sampling(atrium_chamber, 20)
    sites = Sites.at_vertices(points)
    found = neighbour_distances(atrium_chamber, sites, voronoi(atrium_chamber, sites))
    expected = [
        atrium_chamber.marching.from_source([p])[np.setdiff1d(points, [p])].min() for p in points
    ]
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_nothing_covers_nothing(sphere_chamber):
    with pytest.raises(InputError, match="no site"):
        coverage(sphere_chamber, Sites.at_vertices([]))
    assert isinstance(sphere_chamber, Chamber)
