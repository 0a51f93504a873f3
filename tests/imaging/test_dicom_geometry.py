"""Stacks that must not become a volume, and what little is wrong with those that may."""

import shutil

import numpy as np
import pytest

from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume


def files(folder):
    return sorted(folder.rglob("*.dcm"))


def moved(along, across=0.0, down=0.0):
    def spoil(dataset):
        x, y, z = map(float, dataset.ImagePositionPatient)
        dataset.ImagePositionPatient = [x + across, y + down, z + along]

    return spoil


def renewed(number=None):
    """Make a copy an image of its own."""

    def spoil(dataset):
        dataset.SOPInstanceUID = dataset.SOPInstanceUID[:-3] + "777"
        if number is not None:
            dataset.InstanceNumber = number(dataset.InstanceNumber)

    return spoil


def test_missing_slices_in_the_middle_are_named_by_their_neighbours(ct_folder, fault_of):
    files(ct_folder)[4].unlink()
    files(ct_folder)[4].unlink()
    text = fault_of(ct_folder)
    assert text.startswith("2 slices are missing: 3 mm between IM0004.dcm and IM0007.dcm, 1 mm")


def test_missing_slices_at_an_end_are_remarked(ct_folder, small_volume):
    files(ct_folder)[-1].unlink()
    volume = read_volume(ct_folder)
    assert volume.remarks == (
        "the scanner announces 10 images, 9 are here: slices may be missing at an end",
    )
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels[:, :, :-1])


def test_copies_of_a_slice_are_dropped_and_counted(ct_folder, small_volume, edit):
    shutil.copy(files(ct_folder)[4], ct_folder / "IM0005 (copy).dcm")
    edit(files(ct_folder)[7], renewed(lambda _: 99), into=ct_folder / "again")
    volume = read_volume(ct_folder)
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels)
    np.testing.assert_allclose(volume.spacing, [0.5, 0.5, 1.0])
    assert volume.remarks == ("2 files left out: copies of slices that are there",)


def test_different_pixels_at_one_place_are_refused_with_both_names(ct_folder, edit, fault_of):
    def differ(dataset):
        renewed(lambda _: 99)(dataset)
        dataset.PixelData = dataset.PixelData[::-1]

    shutil.copy(files(ct_folder)[4], ct_folder / "other.dcm")
    edit(ct_folder / "other.dcm", differ)
    text = fault_of(ct_folder)
    assert "IM0005.dcm and other.dcm show different pixels at one place" in text


def test_a_tilted_gantry_is_refused_with_its_angle(ct_folder, edit, fault_of):
    shear = np.tan(np.radians(15))
    for k, path in enumerate(files(ct_folder)):
        edit(path, moved(0, down=k * shear))
    assert "tilted by 15.0° against their stack" in fault_of(ct_folder)


def test_one_slice_shifted_sideways_is_named(ct_folder, edit, fault_of):
    edit(files(ct_folder)[5], moved(0, across=0.2))
    assert fault_of(ct_folder).startswith("IM0006.dcm is shifted sideways by 0.2 mm")


def test_uneven_steps_are_refused_with_their_neighbours_named(ct_folder, edit, fault_of):
    edit(files(ct_folder)[5], moved(0.02))
    text = fault_of(ct_folder)
    assert text.startswith("the slices are unevenly spaced: 1.02 mm between IM0005.dcm and IM0006")


def test_a_hundredth_of_a_step_is_allowed_and_two_are_not(ct_folder, edit, fault_of):
    edit(files(ct_folder)[5], moved(0.0099))
    assert read_volume(ct_folder).spacing[2] == pytest.approx(1.0)
    edit(files(ct_folder)[5], moved(0.0101))
    assert "unevenly" in fault_of(ct_folder)


def test_steps_that_drift_are_refused(tmp_path, edit, fault_of):
    voxels = np.random.default_rng(0).integers(-1000, 1000, (4, 4, 60), dtype=np.int16)
    write_dicom_series(Volume(voxels, np.eye(4)), tmp_path / "ct")
    for k, path in enumerate(files(tmp_path / "ct")):
        edit(path, moved(0.0045 * abs(k - 30)))
    assert "steps drift from" in fault_of(tmp_path / "ct")


@pytest.mark.parametrize(
    ("tag", "value", "words"),
    [
        ("ImagePositionPatient", None, "IM0001.dcm has no ImagePositionPatient"),
        ("ImageOrientationPatient", None, "IM0001.dcm has no ImageOrientationPatient"),
        ("ImageOrientationPatient", [0] * 6, "IM0001.dcm has an orientation that is none"),
        ("ImageOrientationPatient", [1, 0, 0, 1, 0, 0], "has an orientation that is none"),
        ("ImageOrientationPatient", [1, 0, 0, 0, 1], "5 numbers"),
        ("PixelSpacing", None, "IM0001.dcm has no PixelSpacing"),
        ("PixelSpacing", [0, 0], "is it in metres, zero or missing?"),
        ("PixelSpacing", ["0.0005", "0.0005"], "is it in metres"),
        ("RescaleType", "MGML", "other values than HU (RescaleType)"),
        ("RescaleSlope", "0", "RescaleSlope of 0"),
        ("BitsAllocated", 12, "stores 12 bits"),
        ("HighBit", 7, "in an odd way"),
        ("Rows", None, "IM0001.dcm has no rows and columns"),
        ("Rows", 6000, "IM0001.dcm announces 6000×8 pixels, so 96,000 bytes"),
        ("Modality", "MR", "holds no CT (10 × MR image)"),
    ],
)
def test_a_wrong_tag_is_named_with_the_file(ct_folder, edit, tag, value, words, fault_of):
    def spoil(dataset):
        delattr(dataset, tag) if value is None else setattr(dataset, tag, value)

    edit(files(ct_folder), spoil)
    assert words in fault_of(ct_folder)


def test_all_slices_at_one_place_are_refused(ct_folder, edit, fault_of):
    edit(files(ct_folder), lambda dataset: setattr(dataset, "ImagePositionPatient", [0, 0, 0]))
    assert "all 10 slices lie at one place" in fault_of(ct_folder)


def test_a_turned_slice_is_named(ct_folder, edit, fault_of):
    edit(
        files(ct_folder)[3],
        lambda dataset: setattr(dataset, "ImageOrientationPatient", [1, 0.005, 0, -0.005, 1, 0]),
    )
    assert "IM0004.dcm is turned against IM0001.dcm" in fault_of(ct_folder)


def test_unsigned_pixels_without_an_intercept_are_no_hu(ct_folder, edit, fault_of):
    def spoil(dataset):
        dataset.PixelRepresentation = 0
        del dataset.RescaleIntercept
        del dataset.RescaleSlope

    edit(files(ct_folder), spoil)
    assert "no RescaleSlope and RescaleIntercept, so no HU" in fault_of(ct_folder)


def test_signed_pixels_without_rescale_tags_are_remarked(ct_folder, edit):
    def spoil(dataset):
        del dataset.RescaleIntercept
        del dataset.RescaleSlope

    edit(files(ct_folder), spoil)
    assert read_volume(ct_folder).remarks == ("no rescale tags: stored values taken as HU",)


def test_coarse_slices_are_remarked(tmp_path):
    voxels = np.random.default_rng(0).integers(-1000, 1000, (4, 4, 5), dtype=np.int16)
    write_dicom_series(Volume(voxels, np.diag([0.5, 0.5, 5, 1])), tmp_path / "ct")
    assert read_volume(tmp_path / "ct").remarks == ("slices 5 mm apart: coarse for an atrium",)


def test_a_stack_beyond_the_limit_is_refused_before_a_pixel_is_read(
    ct_folder, monkeypatch, fault_of
):
    monkeypatch.setattr("auricle.imaging.header.MOST_VOXELS", 500)
    monkeypatch.setattr("auricle.imaging.dicom.read_slices", None)
    assert fault_of(ct_folder).startswith("announces 8×7×10 voxels, the limit is 500: crop")
