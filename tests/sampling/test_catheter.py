import numpy as np
import pytest

from auricle.errors import InputError
from auricle.sampling.catheter import (
    ElectrodePattern,
    circular_catheter,
    grid_catheter,
    linear_catheter,
    placed,
    planned_placements,
    star_catheter,
)
from auricle.surface.geodesics import exact_geodesic_distances

CATHETERS = [
    grid_catheter(),
    grid_catheter(spacing=3.0),
    star_catheter(),
    circular_catheter(electrodes=10, diameter=15.0),
    circular_catheter(),
    linear_catheter(),
]


@pytest.mark.parametrize("pattern", CATHETERS, ids=lambda pattern: pattern.name)
def test_electrodes_keep_their_distance_from_the_centre(sphere_chamber, pattern):
    centre = 100
    found = placed(sphere_chamber, pattern, [centre])
    here = sphere_chamber.mesh.vertices[centre]
    away = found.sites.positions(sphere_chamber.mesh)
    angles = np.arctan2(np.linalg.norm(np.cross(away, here), axis=1), away @ here)
    np.testing.assert_allclose(30 * angles, np.linalg.norm(pattern.offsets, axis=1), atol=0.25)
    assert found.n_off == 0
    np.testing.assert_array_equal(found.electrode, np.arange(len(pattern.offsets)))


def test_electrodes_keep_their_distance_from_one_another(sphere_chamber):
    """Chords on a ball of 30 mm are up to 2 % shorter than on the flat grid; the mesh adds its."""
    pattern = grid_catheter(spacing=4.0)
    found = placed(sphere_chamber, pattern, [200], angles=0.7)
    positions = found.sites.positions(sphere_chamber.mesh)
    chords = np.linalg.norm(positions[:, None] - positions, axis=2)
    flat = np.linalg.norm(pattern.offsets[:, None] - pattern.offsets, axis=2)
    np.testing.assert_allclose(chords, flat, rtol=0.05, atol=1e-9)


def test_on_an_atrium_distances_from_the_centre_are_exact_within_a_tenth(atrium_chamber):
    pattern = circular_catheter(electrodes=10, diameter=15.0)
    found = planned_placements(atrium_chamber, pattern, 8)
    ratios = []
    for i, centre in enumerate(found.centres):
        exact = exact_geodesic_distances(atrium_chamber.mesh, int(centre), reach=15.0)
        ratios.append(found.sites[found.placement == i].of(exact) / 7.5)
    ratios = np.concatenate(ratios)
    assert len(ratios) > 60
    # Distances grow by up to 2 % when interpolated linearly in triangles of 3 mm, 7.5 mm away.
    assert np.median(np.abs(ratios - 1)) < 0.02
    assert np.abs(ratios - 1).max() < 0.1


def test_a_turn_moves_every_electrode_round_the_centre(sphere_chamber):
    straight, turned = (
        placed(sphere_chamber, linear_catheter(), [50], angles=angle) for angle in (0.0, np.pi / 2)
    )
    here = sphere_chamber.mesh.vertices[50] / 30
    one = straight.sites.positions(sphere_chamber.mesh)
    other = turned.sites.positions(sphere_chamber.mesh)
    quarter = np.cross(here, one) + np.outer(one @ here, here)
    np.testing.assert_allclose(other, quarter, atol=0.3)


def test_electrodes_and_centres_keep_off_caps_and_forbidden_surface(open_chamber):
    allowed = open_chamber.mesh.vertices[:, 0] > 0
    found = planned_placements(open_chamber, star_catheter(), 10, allowed=allowed)
    usable = allowed & open_chamber.accessible
    assert usable[found.centres].all()
    assert usable[found.sites.nearest_vertices].all()
    assert found.n_off == 10 * 20 - len(found.sites)
    assert found.n_off > 0


def test_placements_are_nested_and_grouped(atrium_chamber):
    more = planned_placements(atrium_chamber, grid_catheter(), 6)
    fewer = planned_placements(atrium_chamber, grid_catheter(), 4)
    np.testing.assert_array_equal(more.centres[:4], fewer.centres)
    kept = more.placement < 4
    np.testing.assert_array_equal(more.sites.corners[kept], fewer.sites.corners)
    np.testing.assert_array_equal(more.sites.weights[kept], fewer.sites.weights)
    assert (np.diff(more.placement) >= 0).all()


def test_a_generator_turns_each_placement(sphere_chamber, rng):
    pattern = linear_catheter()
    centres = planned_placements(sphere_chamber, pattern, 3).centres
    turned = planned_placements(sphere_chamber, pattern, 3, rng=rng)
    np.testing.assert_array_equal(turned.centres, centres)
    straight = placed(sphere_chamber, pattern, centres)
    one, other = (found.sites.positions(sphere_chamber.mesh) for found in (straight, turned))
    assert np.abs(one - other).max() > 0.5


def test_common_catheters_have_their_poles():
    assert [len(pattern.offsets) for pattern in CATHETERS] == [16, 16, 20, 10, 20, 4]
    assert star_catheter().radius == pytest.approx(16.0)
    assert circular_catheter(diameter=15.0).radius == pytest.approx(7.5)
    np.testing.assert_allclose(np.diff(linear_catheter().offsets[:, 0]), [2.0, 5.0, 2.0])
    gaps = np.linalg.norm(np.diff(grid_catheter(spacing=3.0).offsets[:4], axis=0), axis=1)
    np.testing.assert_allclose(gaps, 3.0)


@pytest.mark.parametrize("offsets", [np.zeros((0, 2)), np.zeros(4), np.full((3, 2), np.nan)])
def test_a_pattern_without_electrodes_is_refused(offsets):
    with pytest.raises(InputError, match="electrode"):
        ElectrodePattern("none", offsets)


def test_catheters_of_no_size_are_refused(sphere_chamber):
    for make in (
        lambda: grid_catheter(spacing=0.0),
        lambda: star_catheter(radii=()),
        lambda: circular_catheter(diameter=-1.0),
        lambda: linear_catheter(gaps=(1.0, 0.0)),
    ):
        with pytest.raises(InputError, match="catheter"):
            make()
    with pytest.raises(InputError, match="source"):
        placed(sphere_chamber, linear_catheter(), [642])
