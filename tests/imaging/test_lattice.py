import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from auricle.errors import ImageError
from auricle.imaging.mask import Mask
from auricle.imaging.volume import Volume

INDEX = st.floats(-50, 50)


def test_spacing_origin_and_direction_make_up_the_affine(oblique_affine):
    volume = Volume(np.zeros((2, 3, 4), np.int16), oblique_affine)
    np.testing.assert_allclose(volume.spacing, [0.5, 0.6, 0.7], rtol=1e-14)
    np.testing.assert_allclose(volume.direction @ volume.direction.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(volume.direction * volume.spacing, oblique_affine[:3, :3])
    np.testing.assert_array_equal(volume.origin, oblique_affine[:3, 3])
    assert volume.shape == (2, 3, 4)
    assert volume.voxel_volume == pytest.approx(0.5 * 0.6 * 0.7)


@given(i=INDEX, j=INDEX, k=INDEX)
def test_index_of_undoes_points_at(i, j, k):
    affine = np.array([[0, 0, 0.7, 5], [0.5, 0, 0, -6], [0, 0.6, 0, 7], [0, 0, 0, 1]], float)
    volume = Volume(np.zeros((2, 2, 2), np.int16), affine)
    points = volume.points_at([i, j, k])
    np.testing.assert_allclose(points, [0.7 * k + 5, 0.5 * i - 6, 0.6 * j + 7], atol=1e-12)
    np.testing.assert_allclose(volume.index_of(points), [i, j, k], atol=1e-12)


def test_points_of_many_indices_come_in_rows(oblique_affine):
    volume = Volume(np.zeros((2, 2, 2), np.int16), oblique_affine)
    indices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 1]])
    rows = volume.points_at(indices)
    assert rows.shape == (3, 3)
    np.testing.assert_allclose(rows[2], volume.points_at(indices[2]))
    np.testing.assert_allclose(volume.index_of(rows), indices, atol=1e-12)


def test_a_volume_cannot_be_changed_nor_through_the_array_it_was_made_of():
    voxels = np.zeros((2, 2, 2), np.int16)
    volume = Volume(voxels, np.eye(4))
    voxels[:] = 7
    assert not volume.voxels.any()
    with pytest.raises(ValueError, match="read-only"):
        volume.voxels[0, 0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        volume.affine[0, 0] = 2


def test_an_array_that_is_read_only_already_is_not_copied():
    for noun, dtype in ((Volume, np.float32), (Mask, bool)):
        voxels = np.zeros((2, 3, 4), dtype)
        voxels.flags.writeable = False
        assert noun(voxels, np.eye(4)).voxels is voxels


@pytest.mark.parametrize(
    ("voxels", "affine", "fault"),
    [
        (np.zeros((2, 2, 2, 2), np.int16), np.eye(4), "4-dimensional"),
        (np.zeros((2, 2, 1), np.int16), np.eye(4), "2×2×1 voxels"),
        (np.zeros((2, 2, 2), np.float64), np.eye(4), "float64"),
        (np.full((2, 2, 2), np.nan, np.float32), np.eye(4), "NaN"),
        (np.full((2, 2, 2), np.inf, np.float32), np.eye(4), "infinite"),
        (np.zeros((2, 2, 2), np.int16), np.eye(3), r"\(4, 4\)"),
        (np.zeros((2, 2, 2), np.int16), np.diag([1, 1, 0, 1]), "positive distances"),
        (np.zeros((2, 2, 2), np.int16), np.diag([1, np.nan, 1, 1]), "finite"),
        (np.zeros((2, 2, 2), np.int16), np.eye(4) + np.eye(4, k=-3), "0, 0, 0, 1"),
        (np.zeros((2, 2, 2), np.int16), np.eye(4) + 0.01 * np.eye(4, k=1), "right angles"),
    ],
)
def test_what_is_no_volume_is_refused(voxels, affine, fault):
    with pytest.raises(ImageError, match=fault):
        Volume(voxels, affine)


def test_a_mask_holds_truths_alone():
    with pytest.raises(ImageError, match="uint8"):
        Mask(np.ones((2, 2, 2), np.uint8), np.eye(4))
    mask = Mask(np.ones((10, 10, 10), bool), np.diag([2.0, 1.0, 0.5, 1.0]))
    assert mask.volume_ml == pytest.approx(1.0)
