"""Scars: their size, their border, their unevenness."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.simulation.scar import ScarTissue, random_field, scar_map
from auricle.surface.geodesics import exact_geodesic_distances
from auricle.surface.shapes import icosphere
from auricle.surface.soundness import vertex_areas

SPHERE = icosphere(radius=30.0, subdivisions=5)
AREAS = vertex_areas(SPHERE)
COARSE = icosphere(radius=30.0, subdivisions=4)
EVEN = ScarTissue(radius=15.0, border=6.0, roughness=0.0)
HALF = 0.5 * (EVEN.scar_voltage + EVEN.healthy_voltage)


def test_the_boundary_of_an_even_scar_is_a_circle_of_its_radius(rng):
    voltage = scar_map(SPHERE, centres=[40], rng=rng, tissue=EVEN).values
    cap = 2 * np.pi * 30.0**2 * (1 - np.cos(15.0 / 30.0))
    assert AREAS[voltage < HALF].sum() == pytest.approx(cap, rel=0.03)


@pytest.mark.parametrize("border", [3.0, 6.0, 9.0])
def test_the_voltage_climbs_from_10_to_90_percent_over_the_border(rng, border):
    tissue = ScarTissue(radius=15.0, border=border, roughness=0.0)
    voltage = scar_map(SPHERE, centres=[40], rng=rng, tissue=tissue).values
    share = (voltage - tissue.scar_voltage) / (tissue.healthy_voltage - tissue.scar_voltage)
    distance = exact_geodesic_distances(SPHERE, 40, reach=30.0)
    order = np.argsort(distance)
    low, high = np.interp([0.1, 0.9], share[order], distance[order])
    assert high - low == pytest.approx(border, rel=0.05)


def contour_length(values: np.ndarray, level: float) -> float:
    """Length of the line on which values, linear in each triangle, equal a level."""
    corners, heights = SPHERE.vertices[SPHERE.faces], values[SPHERE.faces] - level
    after, next_heights = np.roll(corners, -1, axis=1), np.roll(heights, -1, axis=1)
    crossed = (heights > 0) != (next_heights > 0)
    faces = crossed.sum(axis=1) == 2
    share = np.where(crossed, heights / np.where(crossed, heights - next_heights, 1.0), 0.0)
    points = (corners + share[:, :, None] * (after - corners))[faces][crossed[faces]]
    return float(np.linalg.norm(np.diff(points.reshape(-1, 2, 3), axis=1), axis=2).sum())


def test_the_border_of_an_uneven_scar_is_as_wide_as_that_of_an_even_one():
    """The area of the border is its length times its width."""
    tissue = ScarTissue(radius=40.0, border=3.0, roughness=6.0, correlation=20.0)
    span = tissue.healthy_voltage - tissue.scar_voltage
    widths = []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        voltage = scar_map(SPHERE, centres=[40], rng=rng, tissue=tissue).values
        share = (voltage - tissue.scar_voltage) / span
        border = AREAS[(share > 0.1) & (share < 0.9)].sum()
        widths.append(border / contour_length(share, 0.5))
    assert np.mean(widths) == pytest.approx(3.0, rel=0.08)


def test_roughness_moves_the_boundary_by_its_standard_deviation():
    tissue = ScarTissue(radius=40.0, border=2.0, roughness=3.0, correlation=20.0)
    distance = exact_geodesic_distances(COARSE, 40)
    middle = 0.5 * (tissue.scar_voltage + tissue.healthy_voltage)
    offsets = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        scarred = scar_map(COARSE, centres=[40], rng=rng, tissue=tissue).values < middle
        ends = scarred[COARSE.faces]
        crossed = ends.any(axis=1) & ~ends.all(axis=1)
        offsets.append(distance[COARSE.faces[crossed]].mean(axis=1) - 40.0)
    assert np.concatenate(offsets).std() == pytest.approx(3.0, rel=0.2)


def test_patches_unite(rng):
    one, other, both = (
        scar_map(SPHERE, centres=centres, rng=rng, tissue=EVEN).values
        for centres in ([40], [5000], [40, 5000])
    )
    assert np.allclose(both, np.minimum(one, other), atol=0.02)


def test_a_random_field_has_mean_0_and_variance_1_and_its_correlation_length():
    fields = np.array(
        [random_field(COARSE, correlation=12.0, rng=np.random.default_rng(s)) for s in range(50)]
    )
    weights = vertex_areas(COARSE) / COARSE.area
    assert np.abs(fields @ weights).max() < 1e-10
    assert np.allclose(fields**2 @ weights, 1.0)
    distance = exact_geodesic_distances(COARSE, 40, reach=26.0)
    correlation = (fields * fields[:, [40]]).mean(axis=0) / (fields[:, 40] ** 2).mean()

    def at(millimetres: float) -> float:
        return float(correlation[np.abs(distance - millimetres) < 1.5].mean())

    assert at(12.0) == pytest.approx(0.1, abs=0.12)
    assert at(4.0) > 0.6
    assert abs(at(24.0)) < 0.15


def test_impossible_scars_are_refused(rng):
    with pytest.raises(InputError, match="no centres"):
        scar_map(SPHERE, centres=[], rng=rng)
    with pytest.raises(InputError, match="positive lengths"):
        ScarTissue(border=0.0)
    with pytest.raises(InputError, match="correlation length"):
        random_field(SPHERE, correlation=0.0, rng=rng)
