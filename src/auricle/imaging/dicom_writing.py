"""CT series in DICOM made from a volume: valid, anonymous, the same bytes every time."""

import hashlib
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian
from pydicom.valuerep import format_number_as_ds

from auricle.arrays import Floats
from auricle.errors import OutputError
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent


@dataclass(frozen=True)
class _Series:
    """What all slices of a series share."""

    volume: Volume
    key: str
    number: int
    phase_percent: float | None


def write_dicom_series(
    volume: Volume,
    folder: Path,
    *,
    series_number: int = 1,
    phase_percent: float | None = None,
    progress: Progress = silent,
) -> None:
    """Write one classic CT image a slice, ``IM0001.dcm`` and on, into a new folder.

    HU are stored as signed 16-bit numbers, positions to about 1e-11 mm. The identifiers are
    derived from the voxels; there is no patient, date, place or machine in the files.

    Parameters
    ----------
    volume
        Its third axis becomes the stack.
    folder
        New or empty; it is whole or absent.
    series_number
        What the series is called in the files.
    phase_percent
        Nominal share of the heart's cycle, %, where it is one of several phases.
    progress
        Told how far the writing is.

    Raises
    ------
    OutputError
        If the folder holds something, cannot be written, or the values are no whole numbers of
        16 bits.
    """
    pixels = _pixels(volume, folder)
    digest = hashlib.sha256(pixels.data)
    digest.update(volume.affine.tobytes())
    key = f"{digest.hexdigest()} {series_number} {phase_percent}"
    series = _Series(volume, key, series_number, phase_percent)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        if folder.exists():
            folder.rmdir()
        beside = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        try:
            for k, pixel_rows in enumerate(pixels):
                slice_ = _slice(series, k, pixel_rows.tobytes())
                slice_.save_as(beside / f"IM{k + 1:04d}.dcm", enforce_file_format=True)
                progress("writing slices", k + 1, len(pixels))
            beside.chmod(0o755)
            beside.replace(folder)
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    except OSError as fault:
        reason = fault.strerror or str(fault)
        raise OutputError(
            f"{folder}: cannot be written ({reason}): choose a new or empty folder"
        ) from fault


def _pixels(volume: Volume, folder: Path) -> np.ndarray[tuple[int, ...], np.dtype[np.int16]]:
    """Stored numbers, shape (slices, rows, columns)."""
    stacked = volume.voxels.transpose(2, 1, 0)
    pixels = np.ascontiguousarray(stacked, dtype="<i2") if _fits(volume) else None
    if pixels is None or not np.array_equal(pixels, stacked):
        raise OutputError(
            f"{folder}: values that are no whole numbers of 16 bits have no place in DICOM: "
            "write NRRD or NIfTI"
        )
    return pixels


def _fits(volume: Volume) -> bool:
    limits = np.iinfo(np.int16)
    return bool(volume.voxels.min() >= limits.min and volume.voxels.max() <= limits.max)


def _slice(series: _Series, k: int, pixels: bytes) -> Dataset:
    columns, rows, slices = series.volume.shape
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.SOPClassUID = CTImageStorage
    dataset.SOPInstanceUID = _identifier(series.key, f"image {k}")
    dataset.ImageType = ["DERIVED", "PRIMARY", "AXIAL"]
    dataset.Modality = "CT"
    for keyword in _EMPTY:
        setattr(dataset, keyword, "")
    dataset.StudyInstanceUID = _identifier(series.key, "study")
    dataset.SeriesInstanceUID = _identifier(series.key, "series")
    dataset.FrameOfReferenceUID = _identifier(series.key, "frame")
    dataset.SeriesNumber = series.number
    dataset.InstanceNumber = k + 1
    dataset.AcquisitionNumber = 1
    dataset.ImagesInAcquisition = slices
    if series.phase_percent is not None:
        dataset.NominalPercentageOfCardiacPhase = series.phase_percent
    _place(dataset, series.volume, k)
    dataset.SamplesPerPixel = 1
    dataset.PhotometricInterpretation = "MONOCHROME2"
    dataset.Rows, dataset.Columns = rows, columns
    dataset.BitsAllocated = dataset.BitsStored = 16
    dataset.HighBit = 15
    dataset.PixelRepresentation = 1
    dataset.RescaleSlope, dataset.RescaleIntercept, dataset.RescaleType = "1", "0", "HU"
    dataset.WindowCenter, dataset.WindowWidth = "200", "700"
    dataset.PixelData = pixels
    dataset["PixelData"].VR = "OW"
    return dataset


_EMPTY = (
    "AccessionNumber",
    "ContentDate",
    "ContentTime",
    "KVP",
    "Manufacturer",
    "PatientBirthDate",
    "PatientID",
    "PatientName",
    "PatientSex",
    "PositionReferenceIndicator",
    "ReferringPhysicianName",
    "StudyDate",
    "StudyID",
    "StudyTime",
)
"""What the CT image's definition wants present, and allows to be empty."""


def _place(dataset: Dataset, volume: Volume, k: int) -> None:
    across, down, between = volume.spacing
    dataset.PatientPosition = "HFS"
    dataset.PixelSpacing = _decimals(np.array([down, across]))
    dataset.SliceThickness = format_number_as_ds(float(between))
    dataset.ImageOrientationPatient = _decimals(volume.direction[:, :2].T.ravel())
    dataset.ImagePositionPatient = _decimals(volume.points_at([0, 0, k]))


def _decimals(numbers: Floats) -> list[str]:
    """Decimal strings of at most 16 characters, as DICOM wants them."""
    return [format_number_as_ds(float(number)) for number in numbers]


def _identifier(key: str, what: str) -> str:
    """Identifier under 2.25, the root for those made from a 128-bit number."""
    return f"2.25.{int.from_bytes(hashlib.sha256(f'{key} {what}'.encode()).digest()[:16])}"
