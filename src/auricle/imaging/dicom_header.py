"""The header of one DICOM file: geometry, scaling and phase, by an allow-list of tags.

Names, dates, places and free text are not on the list: they are never parsed, so they cannot reach
a result, a remark or an error. The two identifiers on it tell series and copies apart inside the
reader and go no further.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from auricle.errors import FormatError
from auricle.foreign import damaged, printable
from auricle.imaging.dicom_parsing import PARSER_FAULTS, parsed, quiet
from auricle.imaging.dicom_slice import Phase, Scaling, SliceHeader

ALLOWED = (
    "SOPClassUID",
    "SOPInstanceUID",
    "SeriesInstanceUID",
    "SeriesNumber",
    "Modality",
    "ImageType",
    "ConvolutionKernel",
    "Rows",
    "Columns",
    "SamplesPerPixel",
    "PhotometricInterpretation",
    "BitsAllocated",
    "BitsStored",
    "HighBit",
    "PixelRepresentation",
    "NumberOfFrames",
    "PixelSpacing",
    "ImageOrientationPatient",
    "ImagePositionPatient",
    "RescaleSlope",
    "RescaleIntercept",
    "RescaleType",
    "PixelPaddingValue",
    "PixelPaddingRangeLimit",
    "InstanceNumber",
    "AcquisitionNumber",
    "TemporalPositionIdentifier",
    "TriggerTime",
    "NominalPercentageOfCardiacPhase",
    "ImagesInAcquisition",
    "LossyImageCompression",
)
"""The tags the reader may look at, besides the pixels and the transfer syntax."""

_CT = "1.2.840.10008.5.1.4.1.1.2"
_ENHANCED_CT = ("1.2.840.10008.5.1.4.1.1.2.1", "1.2.840.10008.5.1.4.1.1.2.2")
_MODALITIES = ("MR", "NM", "PT", "US", "XA", "CR", "DX", "RF", "OT", "SC", "SEG", "PR", "SR")
_SQUARENESS = 1e-3
_NATIVE = {
    "1.2.840.10008.1.2": "<",
    "1.2.840.10008.1.2.1": "<",
    "1.2.840.10008.1.2.2": ">",
}
_PACKED = (
    "1.2.840.10008.1.2.5",  # RLE
    "1.2.840.10008.1.2.4.50",  # JPEG
    "1.2.840.10008.1.2.4.51",
    "1.2.840.10008.1.2.4.57",
    "1.2.840.10008.1.2.4.70",
    "1.2.840.10008.1.2.4.80",  # JPEG-LS
    "1.2.840.10008.1.2.4.81",
    "1.2.840.10008.1.2.4.90",  # JPEG 2000
    "1.2.840.10008.1.2.4.91",
)


def slice_header(path: Path) -> SliceHeader | str:
    """Read the header of one file, or say what kind of file it is if no slice of a CT.

    Returns
    -------
    SliceHeader or str
        ``no DICOM image``, ``localiser``, ``MR image`` … for what is to be set aside.

    Raises
    ------
    FormatError
        If the file is a slice of a CT, but a damaged one or one that cannot be read; the message
        begins with the file's name.
    """
    try:
        with quiet():
            dataset = parsed(path, ALLOWED)
            if dataset is None:
                return "no DICOM image"
            return _kind_if_no_slice(dataset) or _slice(path, dataset)
    except FormatError as fault:
        raise FormatError(f"{printable(path.name)} {fault}") from fault
    except PARSER_FAULTS as fault:
        raise FormatError(
            f"{printable(path.name)} cannot be understood ({type(fault).__name__}): "
            "the file is damaged or cut short; export it again"
        ) from fault


def _kind_if_no_slice(dataset: Any) -> str | None:
    """What a file is if it can be no slice of a CT, else None."""
    if "Rows" not in dataset or "Columns" not in dataset:
        if _class(dataset) == _CT:
            raise damaged("has no rows and columns")
        return "no DICOM image"
    if _class(dataset) in _ENHANCED_CT or int(dataset.get("NumberOfFrames") or 1) > 1:
        return "multi-frame image"
    if int(dataset.get("SamplesPerPixel") or 1) != 1 or not str(
        dataset.get("PhotometricInterpretation", "MONOCHROME2")
    ).startswith("MONOCHROME"):
        return "colour image"
    modality = str(dataset.get("Modality", ""))
    if modality != "CT":
        return f"{modality} image" if modality in _MODALITIES else "image of another kind"
    image_type = _words(dataset.get("ImageType"))
    if "LOCALIZER" in image_type:
        return "localiser"
    if "ImagePositionPatient" not in dataset and _class(dataset) != _CT:
        return "image without a position"
    return None


def _class(dataset: Any) -> str:
    """The class of the image; who strips identities may leave it in the file's head alone."""
    own = str(dataset.get("SOPClassUID") or "")
    return own or str(dataset.file_meta.get("MediaStorageSOPClassUID", ""))


def _slice(path: Path, dataset: Any) -> SliceHeader:
    shape = (int(dataset.Rows), int(dataset.Columns))
    syntax = str(dataset.file_meta.get("TransferSyntaxUID", "1.2.840.10008.1.2"))
    dtype, bits_stored = _pixel_type(dataset, syntax)
    _require_pixels(path, shape, dtype, packed=syntax in _PACKED)
    scaling, remarks = _scaling(dataset, dtype)
    inverted = str(dataset.get("PhotometricInterpretation")) == "MONOCHROME1"
    if syntax in _PACKED and (inverted or _class(dataset) != _CT):
        # its decoder turns MONOCHROME1 over, and scales other classes by rules of their own
        raise FormatError(
            "is compressed, but MONOCHROME1 or no CT image by its class: "
            "export it without compression"
        )
    if inverted:
        remarks += ("MONOCHROME1 concerns display only: HU taken as stored",)
    if str(dataset.get("LossyImageCompression", "")) == "01":
        remarks += ("the images were once compressed with loss",)
    first, second = _numbers(dataset, "PixelSpacing", 2)
    x, y, z = _numbers(dataset, "ImagePositionPatient", 3)
    return SliceHeader(
        path=path,
        series=str(dataset.get("SeriesInstanceUID", "")),
        instance=str(dataset.get("SOPInstanceUID", "")),
        number=_integer(dataset.get("SeriesNumber")) or 0,
        kind=_kind(dataset),
        shape=shape,
        spacing=(first, second),
        orientation=_orientation(dataset),
        position=(x, y, z),
        dtype=dtype,
        bits_stored=bits_stored,
        scaling=scaling,
        packed=syntax in _PACKED,
        order=_integer(dataset.get("InstanceNumber")),
        phase=_phase(dataset),
        announced=_integer(dataset.get("ImagesInAcquisition")),
        remarks=remarks,
    )


def _pixel_type(dataset: Any, syntax: str) -> tuple[np.dtype[np.generic], int]:
    if syntax not in _NATIVE and syntax not in _PACKED:
        raise FormatError(
            f"is compressed in a way that is not read ({_code(syntax)}): "
            "export it without compression"
        )
    allocated = int(dataset.get("BitsAllocated") or 0)
    if allocated not in (8, 16, 32):
        raise FormatError(f"stores {allocated} bits a pixel: export it with 16")
    stored = int(dataset.get("BitsStored") or allocated)
    high = dataset.get("HighBit")
    if not 1 <= stored <= allocated or (high is not None and int(high) != stored - 1):
        raise FormatError(f"stores its pixels in an odd way ({stored} bits): export it again")
    letter = "i" if int(dataset.get("PixelRepresentation") or 0) else "u"
    return np.dtype(f"{_NATIVE.get(syntax, '<')}{letter}{allocated // 8}"), stored


def _require_pixels(
    path: Path, shape: tuple[int, int], dtype: np.dtype[np.generic], *, packed: bool
) -> None:
    needed = shape[0] * shape[1] * dtype.itemsize
    if min(shape) < 2:
        raise damaged(f"announces {shape[0]}×{shape[1]} pixels")
    if not packed and needed > path.stat().st_size:
        raise damaged(
            f"announces {shape[0]}×{shape[1]} pixels, so {needed:,} bytes, "
            f"and has {path.stat().st_size:,}"
        )


def _scaling(dataset: Any, dtype: np.dtype[np.generic]) -> tuple[Scaling, tuple[str, ...]]:
    kind = str(dataset.get("RescaleType") or "HU").strip()
    if kind not in ("HU", "US"):
        raise FormatError("holds other values than HU (RescaleType): export the CT numbers")
    remarks: tuple[str, ...] = ()
    if "RescaleIntercept" not in dataset or "RescaleSlope" not in dataset:
        if dtype.kind == "u":
            raise FormatError(
                "has unsigned pixels and no RescaleSlope and RescaleIntercept, so no HU: "
                "export the original CT images"
            )
        remarks = ("no rescale tags: stored values taken as HU",)
    (slope,) = _numbers(dataset, "RescaleSlope", 1) if "RescaleSlope" in dataset else (1.0,)
    (intercept,) = (
        _numbers(dataset, "RescaleIntercept", 1) if "RescaleIntercept" in dataset else (0.0,)
    )
    if slope == 0:
        raise damaged("has a RescaleSlope of 0")
    padding = _pixel_value(dataset.get("PixelPaddingValue"), dtype)
    if padding is None:
        return Scaling(slope, intercept, None), remarks
    limit = _pixel_value(dataset.get("PixelPaddingRangeLimit"), dtype)
    ends = (padding, padding if limit is None else limit)
    return Scaling(slope, intercept, (min(ends), max(ends))), remarks


def _pixel_value(value: Any, dtype: np.dtype[np.generic]) -> int | None:
    """A stored number, whichever of US and SS the file gave it as."""
    if value is None or value == "":
        return None
    number = int(np.frombuffer(value, dtype)[0]) if isinstance(value, bytes) else int(value)
    number %= 1 << (8 * dtype.itemsize)
    top = 1 << (8 * dtype.itemsize - 1)
    return number - 2 * top if dtype.kind == "i" and number >= top else number


def _phase(dataset: Any) -> Phase:
    return Phase(
        percent=_real(dataset.get("NominalPercentageOfCardiacPhase")),
        temporal=_integer(dataset.get("TemporalPositionIdentifier")),
        trigger_ms=_real(dataset.get("TriggerTime")),
        acquisition=_integer(dataset.get("AcquisitionNumber")),
    )


def _kind(dataset: Any) -> str:
    words = [word.lower() for word in _words(dataset.get("ImageType"))[:3]]
    kernel = _words(dataset.get("ConvolutionKernel"))[:1]
    return " ".join(_code(word) for word in (*words, *kernel) if _code(word) and word != "primary")


def _orientation(dataset: Any) -> tuple[float, ...]:
    orientation = _numbers(dataset, "ImageOrientationPatient", 6)
    axes = np.array(orientation).reshape(2, 3)
    if np.abs(axes @ axes.T - np.eye(2)).max() > _SQUARENESS:
        raise FormatError(
            f"has an orientation that is none (ImageOrientationPatient {orientation}): "
            "export the original CT images"
        )
    return orientation


def _words(value: Any) -> list[str]:
    if value is None:
        return []
    return [value] if isinstance(value, str) else [str(word) for word in value]


def _code(word: str) -> str:
    """A code as scanners write them; nothing where it could be free text."""
    code = word.strip()
    plain = code.isascii() and re.fullmatch(r"[\w.-]{1,24}", code)
    return code if plain else ""


def _numbers(dataset: Any, keyword: str, count: int) -> tuple[float, ...]:
    value = dataset.get(keyword)
    if value is None or value == "":
        raise FormatError(f"has no {keyword}: export the original CT images")
    numbers = [value] if isinstance(value, (str, float, int)) else list(value)
    found = tuple(float(number) for number in numbers)
    if len(found) != count or not np.isfinite(found).all():
        raise damaged(f"has {len(found)} numbers or none that is finite as its {keyword}")
    return found


def _integer(value: Any) -> int | None:
    return None if value is None or value == "" else int(value)


def _real(value: Any) -> float | None:
    return None if value is None or value == "" else float(value)
