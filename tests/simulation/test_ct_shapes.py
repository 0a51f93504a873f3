"""Shapes on lattices: the distances they give are distances, in any orientation."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from auricle.simulation.ct_block import Block
from auricle.simulation.ct_shapes import (
    FAR,
    Apart,
    Cut,
    Union,
    ellipsoid,
    joined,
    sweep,
    tree,
)
from auricle.simulation.ct_valve import Funnel
from auricle.simulation.implicit import smooth_minimum

TURN = Rotation.from_rotvec([0.3, -0.5, 0.4]).as_matrix()
UPRIGHT = Block(np.array([-20.0, -18.0, -15.0]), np.diag([1.3, 1.1, 1.7]), (18, 33, 31))
OBLIQUE = Block(TURN @ UPRIGHT.origin, TURN @ UPRIGHT.steps, UPRIGHT.shape)


def positions(block: Block) -> np.ndarray:
    indices = np.indices(block.shape).reshape(3, -1)[::-1]
    return block.origin + indices.T @ block.steps.T


def values(shape, block: Block) -> np.ndarray:
    return shape.distance(block).reshape(-1).astype(float)


@pytest.mark.parametrize("block", [UPRIGHT, OBLIQUE], ids=["upright", "oblique"])
def test_coordinates_are_the_positions_of_the_voxels(block):
    columns = [np.broadcast_to(axis, block.shape).ravel() for axis in block.coordinates]
    np.testing.assert_allclose(np.column_stack(columns), positions(block), atol=1e-12)


@pytest.mark.parametrize("block", [UPRIGHT, OBLIQUE], ids=["upright", "oblique"])
def test_a_window_holds_every_voxel_of_its_box(block):
    low, high = np.array([-4.0, -7.0, 1.0]), np.array([6.0, -2.0, 9.0])
    window = block.window((low, high), margin=0.5)
    inside = np.zeros(block.shape, dtype=bool)
    inside[window] = True
    at = positions(block)
    near = ((at >= low - 0.5) & (at <= high + 0.5)).all(axis=1)
    assert near.sum() > 50
    assert inside.ravel()[near].all()
    assert inside.sum() < 6 * near.sum()
    np.testing.assert_allclose(positions(block.part(window)), at[inside.ravel()], atol=1e-12)


def test_a_box_beside_the_block_has_no_window():
    assert UPRIGHT.window((np.full(3, 90.0), np.full(3, 95.0)), margin=1.0) is None


@pytest.mark.parametrize("block", [UPRIGHT, OBLIQUE], ids=["upright", "oblique"])
def test_the_distance_to_a_ball_is_exact(block):
    centre = np.array([1.0, -2.0, 0.5])
    exact = np.linalg.norm(positions(block) - centre, axis=1) - 9.0
    np.testing.assert_allclose(values(ellipsoid(centre, np.full(3, 9.0)), block), exact, atol=1e-4)


def test_an_ellipsoid_lies_along_its_axis_and_its_distance_is_one_beside_it():
    axis = np.array([1.0, 2.0, -2.0]) / 3
    shape = ellipsoid(np.zeros(3), np.array([4.0, 4.0, 10.0]), axis)
    ends = Block(10.0 * axis, 0.1 * np.column_stack([axis, axis, axis]), (1, 1, 2))
    np.testing.assert_allclose(shape.distance(ends).ravel(), [0.0, 0.1], atol=2e-3)
    low, high = shape.box
    reach = np.sqrt(16.0 + (100.0 - 16.0) * axis**2)
    assert (high >= reach - 1e-9).all()
    assert (low <= -reach + 1e-9).all()


def test_a_blended_union_is_the_smooth_minimum_of_its_parts():
    first = ellipsoid(np.array([-6.0, 0.0, 0.0]), np.full(3, 7.0))
    second = ellipsoid(np.array([6.0, 1.0, 0.0]), np.full(3, 8.0))
    expected = smooth_minimum(values(first, UPRIGHT), values(second, UPRIGHT), blend=5.0)
    together = joined([first, second], blend=5.0)
    np.testing.assert_allclose(values(together, UPRIGHT), expected, atol=1e-4)
    union = Union(first, second, blend=5.0)
    np.testing.assert_allclose(values(union, UPRIGHT), expected, atol=1e-4)
    assert expected.min() < min(values(first, UPRIGHT).min(), values(second, UPRIGHT).min()) + 1


@pytest.mark.parametrize("block", [UPRIGHT, OBLIQUE], ids=["upright", "oblique"])
def test_the_distance_to_a_tube_is_that_to_its_line_less_its_radius(block):
    start, stop = np.array([-8.0, -3.0, -2.0]), np.array([9.0, 4.0, 3.0])
    nodes = start + np.linspace(0.0, 1.0, 5)[:, None] * (stop - start)
    tube = sweep(nodes, np.full(5, 3.0), reach=6.0)
    at = positions(block)
    way = stop - start
    share = np.clip((at - start) @ way / (way @ way), 0.0, 1.0)
    exact = np.linalg.norm(at - start - share[:, None] * way, axis=1) - 3.0
    found = values(tube, block)
    near = exact < 5.9
    np.testing.assert_allclose(found[near], exact[near], atol=1e-4)
    assert (found[exact > 6.1] == FAR).all()
    np.testing.assert_allclose(tube.distance_at(at), exact, atol=1e-9)


def test_a_tree_is_the_nearest_of_its_tubes():
    tubes = [
        sweep(np.array([[0.0, 0.0, -9.0], [0.0, 0.0, 9.0]]), np.array([2.0, 3.0]), reach=8.0),
        sweep(np.array([[0.0, 0.0, 0.0], [12.0, 3.0, 0.0]]), np.array([2.0, 1.0]), reach=8.0),
    ]
    nearest = np.minimum(*(values(tube, UPRIGHT) for tube in tubes))
    np.testing.assert_array_equal(values(tree(tubes), UPRIGHT), nearest)


def test_a_cut_shape_ends_at_its_plane():
    ball = ellipsoid(np.zeros(3), np.full(3, 9.0))
    half = Cut(ball, np.array([2.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    inside = values(half, UPRIGHT) < 0
    x = positions(UPRIGHT)[:, 0]
    assert inside.sum() > 200
    assert x[inside].max() < 2.0
    np.testing.assert_array_equal(inside, (values(ball, UPRIGHT) < 0) & (x < 2.0))


def test_shapes_keep_their_distance():
    ball = ellipsoid(np.zeros(3), np.full(3, 9.0))
    other = ellipsoid(np.array([9.0, 0.0, 0.0]), np.full(3, 6.0))
    inside = values(Apart(ball, other, 2.5), UPRIGHT) < 0
    assert inside.sum() > 200
    to_other = np.linalg.norm(positions(UPRIGHT) - (9.0, 0.0, 0.0), axis=1) - 6.0
    assert to_other[inside].min() >= 2.5
    np.testing.assert_array_equal(inside, (values(ball, UPRIGHT) < 0) & (to_other > 2.5))


@pytest.mark.parametrize("block", [UPRIGHT, OBLIQUE], ids=["upright", "oblique"])
def test_leaflets_are_a_cone_of_even_thickness(block):
    axis = np.array([0.0, 0.6, 0.8])
    leaflets = Funnel(np.zeros(3), axis, (1.0, 10.0), (9.0, 4.0), thickness=2.0)
    at = positions(block)
    height = at @ axis
    beside = np.linalg.norm(at - height[:, None] * axis, axis=1)
    inside = values(leaflets, block) < 0
    assert inside.sum() > 50
    between = inside & (height > 2.0) & (height < 8.0)
    # The cone's line is 10 - 6/8 (h - 1), seen at the cosine 8/10 from the side.
    off = np.abs(beside - (10.0 - 0.75 * (height - 1.0))) * 0.8
    assert off[between].max() < 1.0
    assert off[~inside & (height > 2.0) & (height < 8.0)].min() >= 1.0 - 1e-9
    assert height[inside].min() > -0.1
