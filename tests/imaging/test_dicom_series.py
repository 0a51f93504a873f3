"""Several series, several phases."""

import shutil

import numpy as np
import pydicom
import pytest
import SimpleITK

from auricle.imaging.dicom import list_series
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


def test_sixteen_series_are_listed_and_one_is_chosen_by_its_number(
    tmp_path, small_volume, fault_of
):
    few = small_volume.voxels[:, :, :3]
    for n in range(16):
        voxels = np.roll(few, n, axis=0)
        place = tmp_path / "ct" / f"{(5 * n) % 16:02d}"
        write_dicom_series(Volume(voxels, small_volume.affine), place, series_number=n + 3)
    text = fault_of(tmp_path / "ct")
    assert text.startswith("holds 16 series, choose one with --series N: 1: CT derived axial, 3 ")
    assert "16: CT derived axial, 3 slices 8×7, 0.5×0.5×1 mm" in text
    volume = read_volume(tmp_path / "ct", series=6)
    np.testing.assert_array_equal(volume.voxels, np.roll(few, 5, axis=0))
    assert "has no series 17: 16 series, choose" in fault_of(tmp_path / "ct", series=17)
    inside = read_volume(tmp_path / "ct" / "00" / "IM0003.dcm")
    np.testing.assert_array_equal(inside.voxels, few)


PHASES = {
    "NominalPercentageOfCardiacPhase": (40, "75 % of the cycle"),
    "TriggerTime": ("400", "750 ms after the R wave"),
    "TemporalPositionIdentifier": (1, "temporal position 2"),
    "AcquisitionNumber": (1, "acquisition 2"),
    "InstanceNumber": (1, "run 2 of 2 by instance number"),
}


@pytest.mark.parametrize("tag", PHASES)
def test_two_phases_under_one_identifier_are_told_apart(
    tmp_path, small_volume, edit, tag, fault_of
):
    """SimpleITK's series reader makes one volume of twice the slices and half the spacing."""
    second = {
        "NominalPercentageOfCardiacPhase": 75,
        "TriggerTime": "750",
        "TemporalPositionIdentifier": 2,
        "AcquisitionNumber": 2,
    }
    write_dicom_series(small_volume, tmp_path / "ct")
    later = Volume(small_volume.voxels[::-1], small_volume.affine)
    write_dicom_series(later, tmp_path / "later")
    uid = pydicom.dcmread(files(tmp_path / "ct")[0]).SeriesInstanceUID

    def of_one_series(dataset):
        dataset.SeriesInstanceUID = uid
        dataset.InstanceNumber += 10
        if tag in second:
            setattr(dataset, tag, second[tag])

    edit(files(tmp_path / "later"), of_one_series, into=tmp_path / "ct" / "more")
    if tag in second:
        first = PHASES[tag][0]
        edit(files(tmp_path / "ct")[:10], lambda dataset: setattr(dataset, tag, first))
    summaries = list_series(tmp_path / "ct")
    assert [one.slices for one in summaries] == [10, 10]
    assert summaries[1].phase == PHASES[tag][1]
    assert "2 series, choose one with --series N" in fault_of(tmp_path / "ct")
    for number, expected in ((1, small_volume), (2, later)):
        volume = read_volume(tmp_path / "ct", series=number)
        np.testing.assert_array_equal(volume.voxels, expected.voxels)
        np.testing.assert_allclose(volume.affine, small_volume.affine, atol=1e-12)


def test_interleaved_phases_are_told_apart_by_their_share_of_the_cycle(
    tmp_path, small_volume, edit
):
    write_dicom_series(small_volume, tmp_path / "ct", phase_percent=40)
    write_dicom_series(small_volume, tmp_path / "b", phase_percent=75)
    uid = pydicom.dcmread(files(tmp_path / "ct")[0]).SeriesInstanceUID

    def between(dataset):
        dataset.SeriesInstanceUID = uid
        moved(0.5)(dataset)

    edit(files(tmp_path / "b"), between, into=tmp_path / "ct" / "b")
    assert [one.phase for one in list_series(tmp_path / "ct")] == [
        "40 % of the cycle",
        "75 % of the cycle",
    ]


def test_a_file_picks_its_phase_and_a_fault_of_another_phase_is_none_of_its(
    tmp_path, small_volume, edit, fault_of
):
    write_dicom_series(small_volume, tmp_path / "ct", phase_percent=40)
    uid = pydicom.dcmread(files(tmp_path / "ct")[0]).SeriesInstanceUID
    for path in files(tmp_path / "ct"):
        shutil.copy(path, tmp_path / "ct" / f"late-{path.name}")
    late = [path for path in files(tmp_path / "ct") if path.name.startswith("late")]

    def later(dataset):
        renewed()(dataset)
        dataset.NominalPercentageOfCardiacPhase = 75
        dataset.RescaleIntercept = "10"

    edit(late, later)
    shutil.copy(late[3], tmp_path / "ct" / "twice.dcm")
    edit(tmp_path / "ct" / "twice.dcm", lambda d: setattr(d, "PixelData", d.PixelData[::-1]))
    assert {pydicom.dcmread(path).SeriesInstanceUID for path in late} == {uid}
    volume = read_volume(tmp_path / "ct" / "IM0002.dcm")
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels)
    assert "phase: 40 % of the cycle" in volume.remarks
    assert "late-IM0004.dcm and twice.dcm" in fault_of(tmp_path / "ct", series=2)


def test_slabs_of_several_acquisitions_are_one_series(ct_folder, small_volume, edit):
    def slab(dataset):
        dataset.AcquisitionNumber = 1 + (dataset.InstanceNumber > 5)
        dataset.TriggerTime = 700 + dataset.AcquisitionNumber

    edit(files(ct_folder), slab)
    np.testing.assert_array_equal(read_volume(ct_folder).voxels, small_volume.voxels)


def test_two_kernels_are_two_series(ct_folder, edit, fault_of):
    for place, kernel in (("soft", "B26f"), ("sharp", "B46f")):
        edit(
            files(ct_folder)[:10],
            lambda d, k=kernel: setattr(d, "ConvolutionKernel", k),
            into=ct_folder / place,
        )
    for path in ct_folder.glob("*.dcm"):
        path.unlink()
    text = fault_of(ct_folder)
    assert "1: CT derived axial B26f" in text
    assert "2: CT derived axial B46f" in text


def test_what_the_stock_reader_makes_of_two_missing_slices(ct_folder):
    """Why we do not trust it: it stretches what is left over the gap, and returns."""
    files(ct_folder)[4].unlink()
    files(ct_folder)[4].unlink()
    reader = SimpleITK.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(ct_folder)))
    assert reader.Execute().GetSpacing()[2] == pytest.approx(9 / 7)
