"""Round trips, with SimpleITK as the second opinion."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK

from auricle.errors import FormatError, OutputError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.image_files import image_from_file
from auricle.imaging.labels import label_mask
from auricle.imaging.mask import Mask
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume
from auricle.imaging.writing import WRITABLE, write_mask, write_volume

EXACT, SINGLE, DECIMALS = 1e-13, 2e-4, 1e-10
PLACES = [("a.nrrd", EXACT), ("a.mha", EXACT), ("a.nii", SINGLE), ("ä b.nii.gz", SINGLE)]


def noise(shape=(5, 6, 7), dtype=np.int16):
    return np.random.default_rng(3).integers(-1024, 3000, shape).astype(dtype)


@pytest.mark.parametrize("dtype", [np.int16, np.float32])
@pytest.mark.parametrize(("name", "tolerance"), PLACES)
def test_voxels_and_affine_survive_a_file(tmp_path, oblique_affine, name, tolerance, dtype):
    voxels = noise(dtype=dtype) + dtype(0.125 if dtype is np.float32 else 0)
    write_volume(Volume(voxels, oblique_affine), tmp_path / name)
    back = read_volume(tmp_path / name)
    np.testing.assert_array_equal(back.voxels, voxels)
    assert back.voxels.dtype == dtype
    np.testing.assert_allclose(back.affine, oblique_affine, atol=tolerance, rtol=0)
    assert back.remarks == ()
    assert back.orientation_known
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_voxels_and_affine_survive_dicom(tmp_path, oblique_affine):
    volume = Volume(noise(), oblique_affine)
    write_dicom_series(volume, tmp_path / "säries")
    back = read_volume(tmp_path / "säries")
    np.testing.assert_array_equal(back.voxels, volume.voxels)
    assert back.voxels.dtype == np.int16
    np.testing.assert_allclose(back.affine, oblique_affine, atol=DECIMALS, rtol=0)
    assert back.remarks == ()
    assert [path.name for path in tmp_path.iterdir()] == ["säries"]


def test_the_same_volume_gives_the_same_files(tmp_path, oblique_affine):
    volume = Volume(noise(), oblique_affine)
    for place in (tmp_path / "1", tmp_path / "2"):
        write_dicom_series(volume, place / "dicom")
        for end in WRITABLE:
            write_volume(volume, place / f"v{end}")
    first = sorted(path for path in (tmp_path / "1").rglob("*") if path.is_file())
    assert len(first) == 7 + len(WRITABLE)
    for path in first:
        twin = tmp_path / "2" / path.relative_to(tmp_path / "1")
        assert path.read_bytes() == twin.read_bytes(), path.name


def itk_image(voxels, affine):
    image = SimpleITK.GetImageFromArray(voxels.transpose(2, 1, 0))
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(affine[:3, 3].tolist())
    image.SetDirection((affine[:3, :3] / spacing).ravel().tolist())
    return image


@pytest.mark.parametrize("end", ["nii", "nii.gz", "nrrd", "nhdr", "mha", "mhd"])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.int32, np.float64])
def test_what_itk_writes_is_read_as_itk_meant_it(tmp_path, oblique_affine, end, dtype):
    voxels = np.random.default_rng(1).integers(0, 250, (3, 4, 5)).astype(dtype)
    for packed in (False, True):
        path = tmp_path / f"{packed}.{end}"
        SimpleITK.WriteImage(itk_image(voxels, oblique_affine), str(path), packed)
        image = image_from_file(path)
        np.testing.assert_array_equal(image.voxels, voxels)
        assert image.voxels.dtype == dtype
        np.testing.assert_allclose(image.affine, oblique_affine, atol=SINGLE, rtol=0)


@pytest.mark.parametrize("name", ["a.nrrd", "a.nii.gz", "a.mha"])
def test_itk_reads_what_we_write(tmp_path, oblique_affine, name):
    voxels = noise()
    write_volume(Volume(voxels, oblique_affine), tmp_path / name)
    image = SimpleITK.ReadImage(str(tmp_path / name))
    np.testing.assert_array_equal(SimpleITK.GetArrayFromImage(image).transpose(2, 1, 0), voxels)
    for index in ([0, 0, 0], [4, 0, 0], [0, 5, 0], [1, 2, 6]):
        point = image.TransformIndexToPhysicalPoint(index)
        np.testing.assert_allclose(point, (oblique_affine @ [*index, 1])[:3], atol=SINGLE, rtol=0)


def test_itk_reads_the_dicom_we_write(tmp_path, oblique_affine):
    voxels = noise()
    write_dicom_series(Volume(voxels, oblique_affine), tmp_path / "d")
    reader = SimpleITK.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(tmp_path / "d")))
    image = reader.Execute()
    np.testing.assert_array_equal(SimpleITK.GetArrayFromImage(image).transpose(2, 1, 0), voxels)
    np.testing.assert_allclose(
        image.TransformIndexToPhysicalPoint([1, 2, 6]),
        (oblique_affine @ [1, 2, 6, 1])[:3],
        atol=1e-6,
    )


@pytest.mark.parametrize("name", ["a.nrrd", "a.nii", "a.mha", "dicom"])
def test_left_handed_axes_are_turned_and_every_voxel_stays_in_its_place(
    tmp_path, oblique_affine, name
):
    affine = oblique_affine @ np.diag([1, 1, -1, 1])
    volume = Volume(noise(), affine)
    write = write_dicom_series if name == "dicom" else write_volume
    write(volume, tmp_path / name)
    back = read_volume(tmp_path / name)
    assert np.linalg.det(back.affine[:3, :3]) > 0
    indices = np.argwhere(np.ones(volume.shape, bool))
    places = np.rint(back.index_of(volume.points_at(indices))).astype(int)
    np.testing.assert_array_equal(back.voxels[tuple(places.T)], volume.voxels[tuple(indices.T)])


def test_a_mask_survives_a_file_under_its_label(tmp_path, oblique_affine):
    inside = noise() > 1000
    for end in WRITABLE:
        write_mask(Mask(inside, oblique_affine), tmp_path / f"m{end}", label=7)
        back = label_mask(tmp_path / f"m{end}", 7)
        np.testing.assert_array_equal(back.voxels, inside)
        np.testing.assert_allclose(back.affine, oblique_affine, atol=SINGLE, rtol=0)


def test_a_label_that_is_missing_is_answered_with_those_that_are_there(tmp_path):
    labels = np.zeros((10, 10, 10), np.uint8)
    labels[:5] = 2
    labels[5:7] = 4
    path = tmp_path / "labels.nrrd"
    SimpleITK.WriteImage(itk_image(labels, np.diag([2.0, 1.0, 1.0, 1.0])), str(path))
    with pytest.raises(FormatError, match=r"no label 3: it holds 2 \(1.0 ml\), 4 \(0.4 ml\); give"):
        label_mask(path, 3)
    assert label_mask(path, [2, 4]).volume_ml == pytest.approx(1.4)


def test_fractions_are_no_labels(tmp_path):
    path = tmp_path / "values.nrrd"
    values = np.random.default_rng(0).normal(size=(4, 4, 4)).astype(np.float32)
    values[0, 0, 0] = 1
    SimpleITK.WriteImage(itk_image(values, np.eye(4)), str(path))
    with pytest.raises(FormatError, match="fractions, not labels"):
        label_mask(path, 1)


def test_what_is_no_label_map_is_answered_with_what_would_be(tmp_path):
    path = tmp_path / "seg.dcm"
    path.write_bytes(b"x")
    with pytest.raises(FormatError, match="nor a DICOM-SEG: convert it"):
        label_mask(path, 1)


def test_what_cannot_be_written_leaves_nothing_behind(tmp_path, small_volume):
    with pytest.raises(OutputError, match=r"choose \.nrrd"):
        write_volume(small_volume, tmp_path / "a.png")
    mask = Mask(np.ones((2, 2, 2), bool), np.eye(4))
    with pytest.raises(OutputError, match="choose 1 to 255"):
        write_mask(mask, tmp_path / "a.nrrd", label=0)
    fractions = Volume(noise(dtype=np.float32) + np.float32(0.5), np.eye(4))
    with pytest.raises(OutputError, match="write NRRD or NIfTI"):
        write_dicom_series(fractions, tmp_path / "d")
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="cannot be written"):
        write_volume(small_volume, tmp_path / "file" / "a.nrrd")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "own.txt").write_bytes(b"mine")
    with pytest.raises(OutputError, match="new or empty folder"):
        write_dicom_series(small_volume, tmp_path / "full")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file", "full", "own.txt"]


def test_an_image_of_simpleitk_is_copied_before_it_is_gone():
    """Views of SimpleITK's images dangle; nothing here may hand one out."""
    source = (Path(__file__).parents[2] / "src").rglob("*.py")
    assert not [path for path in source if "GetArrayView" in path.read_text(encoding="utf-8")]


def test_real_labels_have_the_volumes_that_are_known(real_data):
    for name, volume_ml in (("wh_labels", 97.5), ("mmwhs_labels", 80.2)):
        mask = label_mask(real_data / "volumes" / "heart-labels" / f"{name}.nii.gz", 2)
        assert mask.volume_ml == pytest.approx(volume_ml, abs=0.05)
        assert np.linalg.det(mask.affine[:3, :3]) > 0


def test_a_real_atrium_in_parts_is_one_mask(real_data):
    path = real_data / "meshes" / "lasc2013-b002" / "gt_noclip.mhd"
    mask = label_mask(path, [36, 37, 76, 77, 78, 79])
    assert mask.volume_ml == pytest.approx(124.6, abs=0.1)


def test_the_real_ct_is_read_as_itk_reads_it(real_data):
    path = real_data / "volumes" / "ct-heart" / "ct_heart_cropped_1.5mm.nii.gz"
    volume = read_volume(path)
    image = SimpleITK.ReadImage(str(path))
    theirs = SimpleITK.GetArrayFromImage(image).transpose(2, 1, 0)
    np.testing.assert_array_equal(volume.voxels, np.maximum(theirs, -1024))
    np.testing.assert_allclose(volume.origin, image.GetOrigin())
    assert "191 voxels below −1024 HU" in volume.remarks[0]


def test_real_compressed_dicom_is_read_as_itk_reads_it(real_data):
    folder = real_data / "volumes" / "ct-heart" / "example_ct_dicom"
    volume = read_volume(folder)
    reader = SimpleITK.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(folder)))
    image = reader.Execute()
    theirs = SimpleITK.GetArrayFromImage(image).transpose(2, 1, 0)
    np.testing.assert_array_equal(volume.voxels, theirs)
    np.testing.assert_allclose(volume.spacing, [0.9765625, 0.9765625, 2.0])
    np.testing.assert_allclose(volume.origin, image.GetOrigin())
