import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.coverage import coverage
from auricle.sampling.farthest_point import farthest_point_sampling
from auricle.sampling.random_design import random_sampling
from auricle.sampling.sites import Sites
from auricle.spectral.harmonics import Harmonics
from auricle.surface.mesh import Mesh


def renumbered(chamber: Chamber, order):
    position = np.argsort(order)
    basis = chamber.basis
    turned = Harmonics(
        basis.eigenvalues, basis.modes[order], basis.areas[order], "cotangent", basis.certificate
    )
    mesh = Mesh(chamber.mesh.vertices[order], position[chamber.mesh.faces])
    return Chamber(mesh, turned, chamber.accessible[order])


def scaled(chamber: Chamber, by: float):
    basis = chamber.basis
    grown = Harmonics(
        basis.eigenvalues / by**2, basis.modes / by, basis.areas * by**2, "", basis.certificate
    )
    return Chamber(Mesh(by * chamber.mesh.vertices, chamber.mesh.faces), grown, chamber.accessible)


def test_a_shorter_design_is_the_beginning_of_a_longer_one(atrium_chamber):
    longer = farthest_point_sampling(atrium_chamber, 60)
    np.testing.assert_array_equal(farthest_point_sampling(atrium_chamber, 25), longer[:25])
    assert len(np.unique(longer)) == 60


def test_no_two_points_are_nearer_than_any_place_is_from_all(atrium_chamber):
    """What greed guarantees: within a factor of 2 of the best covering (Gonzalez 1985)."""
    points = farthest_point_sampling(atrium_chamber, 40)
    radius = coverage(atrium_chamber, Sites.at_vertices(points)).radius_mm
    apart = [
        atrium_chamber.marching.from_source([point])[np.setdiff1d(points, [point])].min()
        for point in points
    ]
    assert min(apart) >= 0.98 * radius


def test_points_cover_a_surface_with_fewer_gaps_than_random_ones(atrium_chamber, rng):
    spread = Sites.at_vertices(farthest_point_sampling(atrium_chamber, 50))
    random = Sites.at_vertices(random_sampling(atrium_chamber, 50, rng=rng))
    assert (
        1.4 * coverage(atrium_chamber, spread).radius_mm
        < coverage(atrium_chamber, random).radius_mm
    )


def test_points_stay_where_they_are_allowed_and_off_the_caps(open_chamber):
    allowed = open_chamber.mesh.vertices[:, 0] > 0
    points = farthest_point_sampling(open_chamber, 30, allowed=allowed)
    assert allowed[points].all()
    assert open_chamber.accessible[points].all()


def test_new_points_continue_the_design_that_exists(atrium_chamber):
    whole = farthest_point_sampling(atrium_chamber, 30)
    existing = Sites.at_vertices(whole[:10])
    np.testing.assert_array_equal(
        farthest_point_sampling(atrium_chamber, 20, existing=existing), whole[10:]
    )


def test_existing_points_between_vertices_keep_new_ones_away(atrium_chamber):
    face = atrium_chamber.mesh.faces[100]
    existing = Sites(face[None], np.array([[0.4, 0.3, 0.3]]))
    (point,) = farthest_point_sampling(atrium_chamber, 1, existing=existing)
    away = atrium_chamber.marching.from_source([face[0]])
    assert away[point] > 0.97 * away.max()


def test_the_design_does_not_depend_on_the_numbering_of_vertices(atrium_chamber, rng):
    order = rng.permutation(atrium_chamber.mesh.n_vertices)
    turned = renumbered(atrium_chamber, order)
    found = order[farthest_point_sampling(turned, 40)]
    np.testing.assert_array_equal(found, farthest_point_sampling(atrium_chamber, 40))


def test_scaling_the_chamber_changes_distances_and_no_point(atrium_chamber):
    large = scaled(atrium_chamber, 4.0)
    points = farthest_point_sampling(atrium_chamber, 40)
    np.testing.assert_array_equal(farthest_point_sampling(large, 40), points)
    sites = Sites.at_vertices(points)
    small_cover, large_cover = coverage(atrium_chamber, sites), coverage(large, sites)
    assert large_cover.radius_mm == pytest.approx(4.0 * small_cover.radius_mm, rel=1e-12)
    assert large_cover.spacing_mm == pytest.approx(4.0 * small_cover.spacing_mm, rel=1e-12)
    np.testing.assert_allclose(large_cover.shares, small_cover.shares, rtol=1e-12)


def test_every_vertex_can_be_sampled_once_and_no_more(sphere_chamber):
    allowed = np.arange(642) < 12
    points = farthest_point_sampling(sphere_chamber, 12, allowed=allowed)
    assert sorted(points) == list(range(12))
    with pytest.raises(InputError, match="12 vertices allowed"):
        farthest_point_sampling(sphere_chamber, 13, allowed=allowed)


def test_a_start_that_is_not_allowed_is_refused(open_chamber):
    hidden = int(np.flatnonzero(~open_chamber.accessible)[0])
    for start in (hidden, -1, 642):
        with pytest.raises(InputError, match="start"):
            farthest_point_sampling(open_chamber, 3, start=start)
    assert farthest_point_sampling(open_chamber, 3, start=40)[0] != hidden


@pytest.mark.parametrize("allowed", [np.ones(3, bool), np.arange(642)])
def test_a_region_that_is_no_truth_a_vertex_is_refused(sphere_chamber, allowed):
    with pytest.raises(InputError, match="allowed"):
        farthest_point_sampling(sphere_chamber, 3, allowed=allowed)
