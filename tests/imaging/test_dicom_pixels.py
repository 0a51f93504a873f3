"""One volume, however its slices are stored."""

import numpy as np
import pydicom
import pytest
import SimpleITK
from pydicom.dataset import Dataset
from pydicom.uid import ExplicitVRBigEndian, ImplicitVRLittleEndian, RLELossless

from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.reading import read_volume
from auricle.imaging.volume import Volume


def files(folder):
    return sorted(folder.rglob("*.dcm"))


def test_names_numbers_thickness_and_folders_change_nothing(ct_folder, small_volume, edit):
    def mislead(dataset):
        dataset.InstanceNumber = 100 - dataset.InstanceNumber
        dataset.SliceThickness = "7"
        dataset.SpacingBetweenSlices = "9"

    edit(files(ct_folder), mislead)
    for k, path in enumerate(files(ct_folder)):
        place = ct_folder / f"part{k % 3}" / f"{(7 * k) % 10}-é"
        place.parent.mkdir(exist_ok=True)
        path.rename(place)
    volume = read_volume(ct_folder)
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels)
    np.testing.assert_allclose(volume.affine, small_volume.affine, atol=1e-12)


def test_one_file_stands_for_its_series_and_a_dicomdir_for_its_folder(ct_folder, small_volume):
    (ct_folder / "DICOMDIR").write_bytes(b"x")
    for path in (files(ct_folder)[4], ct_folder / "DICOMDIR"):
        np.testing.assert_array_equal(read_volume(path).voxels, small_volume.voxels)


@pytest.mark.parametrize("syntax", [ImplicitVRLittleEndian, ExplicitVRBigEndian])
def test_other_byte_orders_give_the_same_voxels(ct_folder, small_volume, syntax):
    for path in files(ct_folder):
        dataset = pydicom.dcmread(path)
        if syntax == ExplicitVRBigEndian:
            pixels = np.frombuffer(dataset.PixelData, "<i2")
            dataset.PixelData = pixels.astype(">i2").tobytes()
        dataset.file_meta.TransferSyntaxUID = syntax
        other = Dataset()  # a new one: pydicom will not turn the byte order of one it has read
        other.update(dataset)
        other.file_meta = dataset.file_meta
        other.save_as(path, enforce_file_format=True)
    np.testing.assert_array_equal(read_volume(ct_folder).voxels, small_volume.voxels)


def test_files_without_the_usual_head_are_read(ct_folder, small_volume):
    """Old archives keep the bare data set: no preamble, no file meta."""
    for path in files(ct_folder):
        dataset = pydicom.dcmread(path)
        bare = Dataset()
        bare.update(dataset)
        bare.save_as(path, implicit_vr=True, little_endian=True)
        assert path.read_bytes()[:2] == b"\x08\x00"
    np.testing.assert_array_equal(read_volume(ct_folder).voxels, small_volume.voxels)


def packed(pixels, way, folder):
    """Compressed pixels of one slice, as SimpleITK writes them, and their transfer syntax."""
    writer = SimpleITK.ImageFileWriter()
    writer.SetImageIO("GDCMImageIO")
    writer.SetCompressor(way)
    writer.UseCompressionOn()
    writer.SetFileName(str(folder / "packed.dcm"))
    writer.Execute(SimpleITK.GetImageFromArray(pixels[None]))
    dataset = pydicom.dcmread(folder / "packed.dcm")
    return dataset["PixelData"], dataset.file_meta.TransferSyntaxUID


@pytest.mark.parametrize("way", ["RLE", "JPEG", "JPEG2000"])
def test_compressed_slices_are_decoded_and_damaged_ones_named(tmp_path, edit, way, fault_of):
    noise = np.random.default_rng(0).integers(-1024, 1500, (65, 64, 4), dtype=np.int16)
    write_dicom_series(Volume(noise, np.eye(4)), tmp_path / "ct")

    def pack(dataset):
        dataset.RescaleIntercept, dataset.RescaleSlope = "-10", "2"
        if dataset.InstanceNumber > 2:  # half a series stays, so that both ways meet
            return
        if way == "RLE":
            dataset.compress(RLELossless, generate_instance_uid=False)
            return
        pixels = np.frombuffer(dataset.PixelData, "<i2").reshape(64, 65)
        dataset["PixelData"], dataset.file_meta.TransferSyntaxUID = packed(pixels, way, tmp_path)

    edit(files(tmp_path / "ct"), pack)
    expected = np.maximum(noise * 2 - 10, -1024)
    np.testing.assert_array_equal(read_volume(tmp_path / "ct").voxels, expected)
    path = files(tmp_path / "ct")[1]
    path.write_bytes(path.read_bytes()[:-2000])
    assert "IM0002.dcm has compressed pixels that cannot be decoded" in fault_of(tmp_path / "ct")


@pytest.mark.parametrize(
    ("tag", "value"),
    [("PhotometricInterpretation", "MONOCHROME1"), ("SOPClassUID", "1.2.840.10008.5.1.4.1.1.7")],
)
def test_compressed_slices_the_decoder_would_change_are_refused(
    ct_folder, edit, tag, value, fault_of
):
    """GDCM inverts MONOCHROME1: −1 minus the stored number comes back."""

    def spoil(dataset):
        dataset.compress(RLELossless, generate_instance_uid=False)
        setattr(dataset, tag, value)

    edit(files(ct_folder), spoil)
    assert "IM0001.dcm is compressed, but MONOCHROME1 or no CT image" in fault_of(ct_folder)


def test_slope_and_intercept_of_each_slice_are_kept(ct_folder, small_volume, edit):
    def rescale(dataset):
        dataset.RescaleSlope = "0.5"
        dataset.RescaleIntercept = str(dataset.InstanceNumber)

    edit(files(ct_folder), rescale)
    volume = read_volume(ct_folder)
    expected = small_volume.voxels * 0.5 + np.arange(1, 11)
    np.testing.assert_array_equal(volume.voxels, expected)
    assert volume.voxels.dtype == np.float32


def test_twelve_bits_in_sixteen_lose_what_lies_above_them(ct_folder, edit):
    def unsigned(dataset):
        pixels = np.frombuffer(dataset.PixelData, "<i2").astype(np.int32) + 1024
        pixels = np.clip(pixels, 0, 4095) | 0xA000  # an overlay in the upper bits
        dataset.PixelData = pixels.astype("<u2").tobytes()
        dataset.BitsStored, dataset.HighBit, dataset.PixelRepresentation = 12, 11, 0
        dataset.RescaleIntercept = "-1024"

    before = read_volume(ct_folder).voxels
    edit(files(ct_folder), unsigned)
    np.testing.assert_array_equal(read_volume(ct_folder).voxels, before)


@pytest.mark.parametrize("value", [-2000, -900, 3000])
@pytest.mark.parametrize("representation", ["SS", "US"])
def test_padding_is_masked_to_air_and_counted(ct_folder, small_volume, edit, representation, value):
    """The tag may come as signed or unsigned, whatever the pixels are."""

    def pad(dataset):
        pixels = np.frombuffer(dataset.PixelData, "<i2").copy()
        pixels[pixels == value] = 0
        pixels[:3] = value
        dataset.PixelData = pixels.tobytes()
        written = value % 2**16 if representation == "US" else value
        dataset.add_new("PixelPaddingValue", representation, written)

    edit(files(ct_folder), pad)
    volume = read_volume(ct_folder)
    assert volume.remarks == ("30 voxels of padding set to −1024 HU",)
    np.testing.assert_array_equal(volume.voxels[:3, 0], -1024)
    kept = np.where(small_volume.voxels == value, 0, small_volume.voxels)
    np.testing.assert_array_equal(volume.voxels[3:], kept[3:])


def test_padding_of_unsigned_pixels_may_be_written_as_a_signed_number(ct_folder, edit):
    def pad(dataset):
        pixels = np.frombuffer(dataset.PixelData, "<i2").astype(np.int32) + 1024
        pixels[:3] = 2**16 - 2000
        dataset.PixelData = pixels.astype("<u2").tobytes()
        dataset.PixelRepresentation, dataset.RescaleIntercept = 0, "-1024"
        dataset.add_new("PixelPaddingValue", "SS", -2000)

    edit(files(ct_folder), pad)
    volume = read_volume(ct_folder)
    assert volume.remarks == ("30 voxels of padding set to −1024 HU",)
    assert volume.voxels.dtype == np.int16


def test_values_below_air_without_a_padding_tag_are_set_to_air(ct_folder, edit):
    def shift(dataset):
        dataset.RescaleIntercept = "-1000"

    edit(files(ct_folder), shift)
    volume = read_volume(ct_folder)
    assert volume.voxels.min() == -1024
    assert "below −1024 HU set to it" in volume.remarks[0]


def test_monochrome1_keeps_its_hu(ct_folder, small_volume, edit):
    edit(
        files(ct_folder),
        lambda dataset: setattr(dataset, "PhotometricInterpretation", "MONOCHROME1"),
    )
    volume = read_volume(ct_folder)
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels)
    assert volume.remarks == ("MONOCHROME1 concerns display only: HU taken as stored",)


def test_positions_rounded_to_two_decimals_are_even(tmp_path, edit):
    affine = np.diag([0.5, 0.5, 1 / 3, 1.0])
    voxels = np.random.default_rng(0).integers(-1000, 1000, (4, 4, 40), dtype=np.int16)
    write_dicom_series(Volume(voxels, affine), tmp_path / "ct")

    def rounded(dataset):
        dataset.ImagePositionPatient = [round(float(x), 2) for x in dataset.ImagePositionPatient]

    edit(files(tmp_path / "ct"), rounded)
    assert read_volume(tmp_path / "ct").spacing[2] == pytest.approx(1 / 3, rel=1e-4)
