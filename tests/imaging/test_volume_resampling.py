import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from auricle.errors import ImageError
from auricle.imaging.mask import Mask
from auricle.imaging.resampling import AIR, mask_box, mask_on, resampled, straight_affine
from auricle.imaging.volume import Volume


def oblique(spacing, angles, origin=(-40.0, 10.0, 300.0)):
    affine = np.eye(4)
    affine[:3, :3] = Rotation.from_euler("xyz", angles, degrees=True).as_matrix() * spacing
    affine[:3, 3] = origin
    return affine


@pytest.mark.parametrize("angles", [(0, 0, 0), (20, -10, 35), (180, 0, 90)])
def test_a_linear_field_is_reproduced_on_any_lattice(angles):
    affine = oblique((0.7, 0.9, 1.3), angles)
    slope = np.array([3.0, -2.0, 5.0])
    blank = Volume(np.zeros((40, 36, 30), np.int16), affine)
    nodes = blank.points_at(np.indices(blank.shape).reshape(3, -1).T)
    ramp = Volume((nodes @ slope - 1000.0).reshape(blank.shape).astype(np.float32), affine)
    middle = blank.points_at([20, 18, 15])
    box = resampled(ramp, low=middle - 5.0, high=middle + 5.0, step=0.8)
    inside = box.points_at(np.indices(box.shape).reshape(3, -1).T)
    np.testing.assert_allclose(box.voxels.ravel(), inside @ slope - 1000.0, atol=0.02)
    np.testing.assert_allclose(box.spacing, 0.8)


def test_beyond_the_volume_there_is_air():
    volume = Volume(np.full((4, 4, 4), 300, np.int16), np.eye(4))
    box = resampled(volume, low=[-5.0] * 3, high=[2.0] * 3, step=1.0)
    assert box.voxels[0, 0, 0] == AIR
    assert box.voxels[-1, -1, -1] == 300.0


def test_an_empty_box_and_a_bomb_are_refused():
    volume = Volume(np.zeros((4, 4, 4), np.int16), np.eye(4))
    with pytest.raises(ImageError, match="enlarge"):
        resampled(volume, low=[0.0] * 3, high=[0.0] * 3, step=1.0)
    with pytest.raises(ImageError, match="smaller box"):
        resampled(volume, low=[0.0] * 3, high=[1e4] * 3, step=1.0)


def test_a_mask_carried_to_an_oblique_lattice_keeps_its_volume_and_place():
    fine = np.zeros((60, 60, 60), dtype=bool)
    x, y, z = np.indices(fine.shape) - 30
    fine[x**2 + y**2 + z**2 < 20**2] = True
    mask = Mask(fine, straight_affine([-30.0, -30.0, -30.0], 1.0))
    affine = oblique((1.1, 1.2, 1.5), (10, 20, 30))
    affine[:3, 3] = -affine[:3, :3] @ [35, 30, 25]
    volume = Volume(np.zeros((70, 60, 50), np.int16), affine)
    carried = mask_on(mask, volume)
    assert carried.shape == volume.shape
    assert carried.volume_ml == pytest.approx(mask.volume_ml, rel=0.01)
    middle = carried.points_at(np.argwhere(carried.voxels)).mean(axis=0)
    np.testing.assert_allclose(middle, 0.0, atol=0.1)


def test_a_mask_beside_the_volume_is_empty_there():
    mask = Mask(np.ones((4, 4, 4), bool), straight_affine([100.0] * 3, 1.0))
    assert not mask_on(mask, Volume(np.zeros((4, 4, 4), np.int16), np.eye(4))).voxels.any()


def test_the_box_of_a_mask_holds_its_voxels_with_the_margin():
    voxels = np.zeros((9, 9, 9), dtype=bool)
    voxels[2:5, 3, 4:6] = True
    low, high = mask_box(Mask(voxels, np.diag([2.0, 1.0, 1.0, 1.0])), margin=1.0)
    assert (low.tolist(), high.tolist()) == ([3.0, 2.0, 3.0], [9.0, 4.0, 6.0])
