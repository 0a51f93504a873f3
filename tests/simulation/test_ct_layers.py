"""Layers on voxels: what is painted weighs what the shape weighs."""

import numpy as np
import pytest

from auricle.simulation.ct_block import Block
from auricle.simulation.ct_layers import AIR_HU, Layer, Tissue, paint
from auricle.simulation.ct_shapes import ellipsoid

BLOCK = Block(np.array([-15.2, -15.1, -15.3]), np.diag([0.9, 0.9, 1.1]), (28, 34, 34))
BALL = ellipsoid(np.zeros(3), np.full(3, 8.0))


def weight(radius):
    """Volume of a ball under a linear edge one voxel wide: the mean over radii across the edge."""
    return 4 / 3 * np.pi * (radius**3 + radius * BLOCK.edge**2 / 4)


def test_partial_volume_keeps_the_mass_of_a_ball():
    hu, labels = paint([Layer(BALL, 1000.0 + AIR_HU, Tissue.LIVER)], BLOCK)
    voxel = 0.9 * 0.9 * 1.1
    exact = 4 / 3 * np.pi * 8.0**3
    assert (hu - AIR_HU).sum(dtype=float) / 1000 * voxel == pytest.approx(weight(8.0), rel=1e-3)
    assert (labels == Tissue.LIVER).sum() * voxel == pytest.approx(exact, rel=0.02)
    assert ((hu > AIR_HU + 1) & (hu < -1)).sum() > 500


def test_growth_adds_to_the_radius():
    hu, _ = paint([Layer(BALL, 1000.0 + AIR_HU, Tissue.LIVER, growth=2.0)], BLOCK)
    assert (hu - AIR_HU).sum(dtype=float) / 1000 * 0.891 == pytest.approx(weight(10.0), rel=1e-3)


def test_later_layers_cover_earlier_ones_and_label_only_if_they_have_a_tissue():
    small = ellipsoid(np.zeros(3), np.full(3, 4.0))
    hu, labels = paint([Layer(BALL, 100.0, Tissue.LIVER), Layer(small, 300.0, Tissue.AORTA)], BLOCK)
    middle = tuple(np.round(-BLOCK.origin / np.diag(BLOCK.steps)).astype(int)[::-1])
    assert hu[middle] == 300.0
    assert labels[middle] == Tissue.AORTA
    assert labels[0, 0, 0] == Tissue.AIR
    hu, labels = paint([Layer(BALL, 100.0, Tissue.LIVER), Layer(small, 300.0, None)], BLOCK)
    assert hu[middle] == 300.0
    assert labels[middle] == Tissue.LIVER


def test_a_gradient_rises_towards_the_head_from_height_zero():
    hu, labels = paint([Layer(BALL, 100.0, Tissue.LIVER, gradient=2.0)], BLOCK)
    distance = BALL.distance(BLOCK)
    height = np.broadcast_to(BLOCK.coordinates[2], BLOCK.shape)
    core = distance < -2.0
    np.testing.assert_allclose(hu[core], 100.0 + 2.0 * height[core], atol=1e-3)
    assert (labels[core] == Tissue.LIVER).all()
