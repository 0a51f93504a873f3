"""Folders of DICOM as archives and people leave them, and what leaves the reader of them."""

import numpy as np
import pydicom
import pytest
from pydicom.dataset import Dataset

from auricle.errors import FormatError
from auricle.imaging.dicom import list_series
from auricle.imaging.dicom_header import ALLOWED
from auricle.imaging.reading import read_volume
from auricle.imaging.writing import write_volume


def files(folder):
    return sorted(folder.rglob("*.dcm"))


def moved(along, across=0.0, down=0.0):
    def spoil(dataset):
        x, y, z = map(float, dataset.ImagePositionPatient)
        dataset.ImagePositionPatient = [x + across, y + down, z + along]

    return spoil


def test_one_slice_is_no_volume(ct_folder, fault_of):
    for path in files(ct_folder)[1:]:
        path.unlink()
    assert fault_of(ct_folder) == "IM0001.dcm is the only slice: give the whole series"


@pytest.mark.parametrize("left", [130, 200, 500, 900])
def test_a_slice_cut_short_is_never_read_in_silence(ct_folder, left, fault_of):
    path = files(ct_folder)[4]
    path.write_bytes(path.read_bytes()[:left])
    assert "IM000" in fault_of(ct_folder)


def test_a_slice_that_lost_its_last_byte_is_named(ct_folder, fault_of):
    path = files(ct_folder)[4]
    path.write_bytes(path.read_bytes()[:-1])
    assert "IM0005.dcm" in fault_of(ct_folder)


def test_localisers_reports_and_other_files_are_set_aside_and_counted(
    ct_folder, small_volume, edit
):
    def localiser(dataset):
        dataset.ImageType = ["ORIGINAL", "PRIMARY", "LOCALIZER"]
        dataset.ImageOrientationPatient = [1, 0, 0, 0, 0, -1]

    def screenshot(dataset):
        dataset.SOPClassUID = "1.2.840.10008.5.1.4.1.1.7"
        dataset.SamplesPerPixel, dataset.PhotometricInterpretation = 3, "RGB"

    edit(files(ct_folder)[0], localiser, into=ct_folder / "a")
    edit(files(ct_folder)[0], screenshot, into=ct_folder / "b")
    (ct_folder / "readme.txt").write_bytes(b"hello")
    (ct_folder / "empty").write_bytes(b"")
    (ct_folder / ".DS_Store").write_bytes(b"x")
    volume = read_volume(ct_folder)
    np.testing.assert_array_equal(volume.voxels, small_volume.voxels)
    assert volume.remarks == (
        "4 files set aside: 1 × colour image, 1 × localiser, 2 × no DICOM image",
    )


def test_a_folder_without_ct_says_what_it_holds(tmp_path, small_volume, fault_of):
    (tmp_path / "nothing").mkdir()
    assert "is an empty folder" in fault_of(tmp_path / "nothing")
    (tmp_path / "junk").mkdir()
    (tmp_path / "junk" / "a.txt").write_bytes(b"hello")
    assert "holds no CT (1 × no DICOM image)" in fault_of(tmp_path / "junk")
    write_volume(small_volume, tmp_path / "images" / "heart.nii.gz")
    assert "give one of them (heart.nii.gz)" in fault_of(tmp_path / "images")
    assert "is no slice of a CT" in fault_of(tmp_path / "junk" / "a.txt")


def test_multi_frame_ct_is_refused_with_the_way_round(ct_folder, edit, fault_of):
    edit(files(ct_folder), lambda dataset: setattr(dataset, "NumberOfFrames", 10))
    assert fault_of(ct_folder).startswith("holds multi-frame (enhanced) CT, which is not read")


@pytest.mark.parametrize(
    ("syntax", "words"),
    [
        ("1.2.840.10008.1.2.1.99", "IM0001.dcm is a deflated DICOM file"),
        ("1.2.840.10008.1.2.4.201", "IM0001.dcm is compressed in a way that is not read"),
    ],
)
def test_unknown_compression_is_refused_before_anything_is_unpacked(
    ct_folder, syntax, words, fault_of
):
    for path in files(ct_folder):
        whole = path.read_bytes()
        old = b"1.2.840.10008.1.2.1\0"
        at = whole.index(old)
        new = syntax.encode() + b"\0" * (len(syntax) % 2)
        grown = len(new) - len(old)
        length = int.from_bytes(whole[at - 2 : at], "little") + grown
        group = int.from_bytes(whole[140:144], "little") + grown
        path.write_bytes(
            whole[:140]
            + group.to_bytes(4, "little")
            + whole[144 : at - 2]
            + length.to_bytes(2, "little")
            + new
            + whole[at + len(old) :]
        )
    assert words in fault_of(ct_folder)


def test_spoilt_bytes_of_a_header_give_a_volume_or_one_line(ct_folder, rng):
    path = files(ct_folder)[4]
    whole = path.read_bytes()
    outcomes = set()
    for _ in range(60):
        content = bytearray(whole)
        for place in rng.integers(0, len(whole) - 120, 3):
            content[place] = rng.integers(0, 256)
        path.write_bytes(content)
        try:
            read_volume(ct_folder)
            outcomes.add("read")
        except FormatError as fault:
            outcomes.add("refused" if str(fault).isprintable() else "unprintable")
    assert outcomes == {"read", "refused"}


PERSON = "Zyxwvut^Marked"


def planted():
    """A name or a date in every tag about a person, and in all free text."""
    values = dict.fromkeys(("PN", "LO", "LT", "ST", "UT"), PERSON)
    values |= {"SH": "ZyxwvutMarked", "DA": "19311122", "DT": "19311122"}
    dataset = Dataset()
    for keyword in filter(None, pydicom.datadict.keyword_dict):
        tag = pydicom.datadict.tag_for_keyword(keyword)
        vr = pydicom.datadict.dictionary_VR(tag)
        if keyword not in ALLOWED and vr in values and tag >> 16 > 2:
            setattr(dataset, keyword, values[vr])
    dataset.SeriesInstanceUID = "1.2.99.19311122"
    dataset.ConvolutionKernel = "Zyxwvut Marked"
    dataset.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL", "ZYXWVUTMARKED"]
    return dataset


def test_identity_leaves_the_reader_in_no_result_remark_or_error(
    ct_folder, edit, caplog, capfd, recwarn, fault_of
):
    marked = planted()
    assert len(marked) > 500
    edit(files(ct_folder), lambda dataset: dataset.update(marked))
    caplog.clear()
    assert b"Zyxwvut" in files(ct_folder)[0].read_bytes()
    volume = read_volume(ct_folder)
    said = [*volume.remarks, *map(str, list_series(ct_folder)), repr(list_series(ct_folder))]
    edit(files(ct_folder)[3], moved(0.3))
    said.append(fault_of(ct_folder))
    files(ct_folder)[6].unlink()
    said.append(fault_of(ct_folder))
    for modality in ("ZYXWVUT MARKED", "CT"):
        edit(files(ct_folder), lambda dataset, m=modality: setattr(dataset, "Modality", m))
        said.append(fault_of(ct_folder))
    caplog.clear()
    for path in files(ct_folder):  # no valid identifiers: pydicom warns and logs, quoting them
        path.write_bytes(path.read_bytes().replace(b"2.25.", b"Zyxwv"))
    said.append(fault_of(ct_folder))
    captured = capfd.readouterr()
    said += [caplog.text, captured.out, captured.err, *(str(one.message) for one in recwarn)]
    for text in said:
        for mark in ("zyxwv", "marked", "1931"):
            assert mark not in text.lower()


def test_no_tag_on_the_allow_list_names_a_person_a_date_or_a_place():
    for keyword in set(ALLOWED) - {"RescaleType"}:  # compared, never told
        vr = pydicom.datadict.dictionary_VR(pydicom.datadict.tag_for_keyword(keyword))
        assert vr not in ("PN", "LO", "LT", "ST", "UT", "DA", "DT", "TM", "AE", "AS"), keyword


def test_what_is_written_names_nobody(ct_folder):
    dataset = pydicom.dcmread(files(ct_folder)[0])
    for element in dataset:
        if element.VR in ("PN", "LO", "LT", "ST", "UT", "DA", "DT", "TM", "SH", "AE"):
            assert not element.value or element.value == "HU", element.keyword
        if element.VR == "UI" and element.keyword != "SOPClassUID":
            assert element.value.startswith("2.25.")
            assert len(element.value) <= 64
