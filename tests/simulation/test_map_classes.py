"""Map classes: every one can be drawn, repeated, moved about and told its parameters."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.simulation.foci import focal_map
from auricle.simulation.map_classes import MAP_CLASSES, TAIL_EXPONENTS
from auricle.surface.mesh import Mesh
from auricle.surface.shapes import icosphere

SPHERE = icosphere(radius=30.0, subdivisions=4)
every_class = pytest.mark.parametrize("map_class", MAP_CLASSES.values(), ids=MAP_CLASSES)


@every_class
def test_a_map_varies_and_has_a_value_everywhere(map_class):
    field = map_class.draw(SPHERE, np.random.default_rng(1))
    columns = map_class.columns(field)
    assert np.isfinite(columns).all()
    assert columns.std(axis=0).min() > 1e-3


@every_class
def test_the_same_seed_draws_the_same_map_and_another_does_not(map_class):
    one, same, other = (
        map_class.draw(SPHERE, np.random.default_rng(seed)).values for seed in (4, 4, 5)
    )
    assert np.array_equal(one, same)
    assert not np.allclose(one, other)


@every_class
def test_centres_stay_where_they_are_allowed(map_class):
    """With a seed fixed, forbidding where the map was centred moves it."""
    everywhere = np.ones(SPHERE.n_vertices, dtype=bool)
    free = map_class.draw(SPHERE, np.random.default_rng(2), allowed=everywhere).values
    upper = SPHERE.vertices[:, 2] > 0
    maps = [
        map_class.draw(SPHERE, np.random.default_rng(2), allowed=side).values
        for side in (upper, ~upper)
    ]
    assert not np.allclose(*maps)
    assert any(not np.allclose(free, each) for each in maps)


def test_foci_lie_where_they_are_allowed():
    upper = SPHERE.vertices[:, 2] > 10.0
    for seed in range(5):
        rng = np.random.default_rng(seed)
        times = MAP_CLASSES["activation"].draw(SPHERE, rng, allowed=upper, foci=3).values
        assert (times == 0).sum() == 3
        assert upper[times == 0].all()


@every_class
def test_larger_meshes_have_the_same_map_if_lengths_are_scaled(map_class):
    double = Mesh(2 * SPHERE.vertices, SPHERE.faces)
    scaled = {
        name: 2 * value
        for name, value in map_class.parameters.items()
        if name.endswith(("_mm", "_mm_per_ms"))
    }
    small = map_class.draw(SPHERE, np.random.default_rng(3))
    large = map_class.draw(double, np.random.default_rng(3), **scaled)
    assert np.allclose(map_class.columns(large), map_class.columns(small), atol=1e-6)


def test_gaussian_foci_are_those_of_exact_distances_within_a_hundredth():
    field = MAP_CLASSES["gaussian"].draw(SPHERE, np.random.default_rng(1))
    exact = focal_map(SPHERE, centres=[int(field.values.argmax())], width=8.0)
    assert np.abs(field.values - exact.values).max() < 0.01


def test_circular_maps_are_compared_as_cosine_and_sine():
    circular = {name for name, each in MAP_CLASSES.items() if each.is_circular}
    assert circular == {"macro_reentry", "rotor_pair"}
    field = MAP_CLASSES["rotor_pair"].draw(SPHERE, np.random.default_rng(1), cycle_length_ms=150)
    columns = MAP_CLASSES["rotor_pair"].columns(field, cycle_length_ms=150)
    assert np.allclose((columns**2).sum(axis=1), 1.0)
    angle = np.arctan2(columns[:, 1], columns[:, 0]) % (2 * np.pi)
    assert np.allclose(np.cos(angle - 2 * np.pi * field.values / 150), 1.0)


@every_class
def test_every_class_names_a_known_singularity(map_class):
    assert map_class.tail_exponent == TAIL_EXPONENTS[map_class.singularity]


def test_unknown_or_impossible_parameters_are_refused():
    rng = np.random.default_rng(1)
    with pytest.raises(InputError, match="no parameter 'sigma': choose among width_mm, foci"):
        MAP_CLASSES["gaussian"].draw(SPHERE, rng, sigma=3.0)
    with pytest.raises(InputError, match="width_mm = -1"):
        MAP_CLASSES["gaussian"].draw(SPHERE, rng, width_mm=-1.0)
    with pytest.raises(InputError, match="whole number"):
        MAP_CLASSES["gaussian"].draw(SPHERE, rng, foci=1.5)
    with pytest.raises(InputError, match="places fit"):
        MAP_CLASSES["activation"].draw(SPHERE, rng, foci=50, separation_mm=40.0)
