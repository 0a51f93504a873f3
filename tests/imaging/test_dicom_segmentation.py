import warnings
from importlib import util

import numpy as np
import pydicom
import pytest
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.sr.codedict import codes

from auricle.errors import FormatError
from auricle.imaging.dicom_writing import write_dicom_series
from auricle.imaging.labels import label_mask
from auricle.imaging.volume import Volume


def save_seg(path, inside, affine, tmp_path):
    """Two segments in one DICOM-SEG, as highdicom writes them on the slices they were drawn on."""
    hd = pytest.importorskip("highdicom", reason="no highdicom: DICOM-SEG is not read")
    drawn_on = Volume(np.arange(inside[0].size, dtype=np.int16).reshape(inside[0].shape), affine)
    write_dicom_series(drawn_on, tmp_path / "ct")
    source = [pydicom.dcmread(place) for place in sorted((tmp_path / "ct").iterdir())]
    descriptions = [
        hd.seg.SegmentDescription(
            segment_number=k + 1,
            segment_label=f"part {k + 1}",
            segmented_property_category=codes.SCT.AnatomicalStructure,
            segmented_property_type=codes.SCT.LeftAtrium,
            algorithm_type=hd.seg.SegmentAlgorithmTypeValues.MANUAL,
        )
        for k in range(2)
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        hd.seg.Segmentation(
            source_images=source,
            pixel_array=np.stack([part.transpose(2, 1, 0) for part in inside], axis=-1),
            segmentation_type="BINARY",
            segment_descriptions=descriptions,
            series_instance_uid=hd.UID(),
            series_number=2,
            sop_instance_uid=hd.UID(),
            instance_number=1,
            manufacturer="none",
            manufacturer_model_name="none",
            software_versions="0",
            device_serial_number="0",
        ).save_as(path)


@pytest.fixture
def parts():
    first = np.zeros((8, 9, 10), bool)
    first[2:5, 3:7, 2:5] = True
    second = np.zeros_like(first)
    second[3:6, 1:4, 7:9] = True
    return first, second


def test_segments_lie_where_they_were_drawn(tmp_path, oblique_affine, parts):
    path = tmp_path / "seg.dcm"
    save_seg(path, parts, oblique_affine, tmp_path)
    drawn_on = Volume(np.zeros(parts[0].shape, np.int16), oblique_affine)
    for label, inside in ((1, parts[0]), (2, parts[1]), ([1, 2], parts[0] | parts[1])):
        mask = label_mask(path, label)
        found = drawn_on.index_of(mask.points_at(np.argwhere(mask.voxels)))
        np.testing.assert_allclose(found, np.rint(found), atol=1e-6)
        assert set(map(tuple, np.rint(found).astype(int))) == set(map(tuple, np.argwhere(inside)))
        assert np.linalg.det(mask.affine[:3, :3]) > 0


def test_a_missing_segment_is_answered_with_those_there_are(tmp_path, oblique_affine, parts):
    path = tmp_path / "seg.dcm"
    save_seg(path, parts, oblique_affine, tmp_path)
    with pytest.raises(FormatError, match="has no segment 3: it holds 1, 2; give one"):
        label_mask(path, 3)
    path.write_bytes(path.read_bytes()[:-400])
    with pytest.raises(FormatError, match=r"seg\.dcm: is a DICOM-SEG that cannot be read"):
        label_mask(path, 1)


def test_without_highdicom_the_way_round_is_told(tmp_path, monkeypatch):
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    dataset.SOPClassUID = "1.2.840.10008.5.1.4.1.1.66.4"
    dataset.SOPInstanceUID = "2.25.1"
    dataset.save_as(tmp_path / "seg.dcm", enforce_file_format=True)
    monkeypatch.setattr(util, "find_spec", lambda _: None)
    with pytest.raises(FormatError, match="needs the package highdicom: install it, or convert"):
        label_mask(tmp_path / "seg.dcm", 1)
