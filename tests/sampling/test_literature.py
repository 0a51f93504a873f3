"""Second opinions: published densities on a surface."""

import math

import pytest

from auricle.errors import InputError
from auricle.sampling.literature import (
    DENSITIES,
    FILL_DISTANCES_MM,
    samples_for_fill,
    second_opinions,
)


def test_numbers_are_densities_times_the_area_rounded_up():
    for opinion in second_opinions(10_000.0):
        assert opinion.n_samples == round(opinion.published.mean_per_cm2 * 100)
        assert opinion.n_low < opinion.n_samples < opinion.n_high


def test_published_orders_are_kept():
    focal, macro, localized = (opinion.n_samples for opinion in second_opinions(12_600.0)[:3])
    assert focal < macro < localized
    assert DENSITIES[-1].mean_per_cm2 == 20.0


def test_a_lattice_for_a_fill_distance_covers_the_plane():
    """A triangular lattice of spacing s has a hexagon of inradius s/2 for each point."""
    for distance in FILL_DISTANCES_MM.values():
        spacing = math.sqrt(3) * distance
        cell = math.sqrt(3) / 2 * spacing**2
        assert samples_for_fill(distance, accessible_area=1e6) == math.ceil(1e6 / cell)


def test_half_the_distance_takes_four_times_the_samples():
    wide, narrow = (samples_for_fill(each, accessible_area=1e7) for each in (10.0, 5.0))
    assert narrow == pytest.approx(4 * wide, rel=1e-3)


def test_areas_must_be_positive():
    with pytest.raises(InputError, match="area"):
        second_opinions(0.0)
    with pytest.raises(InputError, match="positive"):
        samples_for_fill(5.0, accessible_area=-1.0)
