"""The two readings of the paper's MSE, and how they stand to the geometric distance."""

import numpy as np
import pytest

from auricle.errors import InputError
from auricle.surface.distance import (
    nearest_vertex_mean_square,
    point_to_surface,
    vertexwise_mean_square,
)
from auricle.surface.shapes import icosphere, rectangle
from auricle.surface.simplification import simplify

SPHERE = icosphere(radius=30.0, subdivisions=4)


def test_a_shift_counts_squared_vertex_by_vertex():
    shifted = SPHERE.vertices + np.array([2.0, 3.0, 6.0])
    assert vertexwise_mean_square(SPHERE.vertices, shifted) == pytest.approx(49.0, rel=1e-12)


def test_the_order_of_vertices_matters_to_one_and_not_to_the_other(rng):
    shuffled = rng.permutation(SPHERE.vertices)
    assert nearest_vertex_mean_square(SPHERE.vertices, shuffled) == 0.0
    assert vertexwise_mean_square(SPHERE.vertices, shuffled) > 100.0


def test_a_parallel_plane_lies_at_its_distance():
    plate = rectangle(width=10, height=10, n_x=6, n_y=6)
    raised = plate.vertices + np.array([0.0, 0.0, 4.0])
    assert nearest_vertex_mean_square(raised, plate.vertices) == pytest.approx(16.0)


def test_the_nearest_vertex_is_never_nearer_than_the_surface():
    coarse = simplify(SPHERE, 100)
    to_vertices = nearest_vertex_mean_square(SPHERE.vertices, coarse.vertices)
    to_surface = float((point_to_surface(SPHERE.vertices, coarse) ** 2).mean())
    assert to_vertices > 10 * to_surface


def test_shapes_of_different_size_have_no_vertexwise_error():
    with pytest.raises(InputError, match="do not belong together"):
        vertexwise_mean_square(SPHERE.vertices, SPHERE.vertices[1:])
