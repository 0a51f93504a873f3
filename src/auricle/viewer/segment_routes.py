"""What the page asks while someone segments: slices, trials, their masks, and the accepted case."""

import math
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from auricle.arrays import Truths
from auricle.errors import InputError
from auricle.imaging.segmentation import Segmentation
from auricle.imaging.verdict import SegmentationError
from auricle.imaging.writing import write_mask
from auricle.progress import Progress
from auricle.study.preparation import prepare_soup
from auricle.study.segmented import Place, SegmentationConfig, SegmentedCase
from auricle.study.segmented_store import found_document, reason_document, segmentation_document
from auricle.study.store import json_text
from auricle.surface.soup import TriangleSoup
from auricle.surface.writing import write_surface
from auricle.viewer.endpoints import Call, Endpoint, Work
from auricle.viewer.open_case import OpenCase
from auricle.viewer.opening import Detail
from auricle.viewer.volume_session import Trial, VolumeSession

_NO_VOLUME = "no CT is open"
_MOST_CORNERS = 500
_MOST_CUTS = 100
_NUMBERS = ("lower_hu", "upper_hu")
_KEYS = {"seed_mm", "region_mm", "region_depth_mm", "vein_stub_mm", "cuts_mm", *_NUMBERS}


def voxels(call: Call) -> bytes:
    """HU of the lattice slices are drawn from: int16, little-endian, x fastest, then y, then z."""
    shown = call.workspace.require(VolumeSession, _NO_VOLUME).shown
    return np.ascontiguousarray(shown.voxels.transpose(2, 1, 0)).astype("<i2").tobytes()


def sketch(call: Call) -> Mapping[str, Any]:
    """Segment on the coarse lattice with ``{"config": {…}}``, in about a second."""
    session = call.workspace.require(VolumeSession, _NO_VOLUME)
    config = config_of(call.document().get("config", {}))
    return trial_document(session.trial(config, sketch=True))


def preview(call: Call) -> Work:
    """Segment with ``{"config": {…}}`` as the command does; a refusal is an answer, no fault."""
    session = call.workspace.require(VolumeSession, _NO_VOLUME)
    config = config_of(call.document().get("config", {}))

    def run(progress: Progress) -> Mapping[str, Any]:
        return trial_document(session.trial(config, progress=progress))

    return Work(run)


def mask(call: Call) -> bytes:
    """A trial's mask: a byte a voxel, x fastest, on the lattice its document names."""
    session = call.workspace.require(VolumeSession, _NO_VOLUME)
    found = session.tried(call.path["key"]).found
    if found is None:
        raise InputError("a refused segmentation has no mask: look at its reason")
    return _as_bytes(found.mask.voxels)


def accept(call: Call) -> Work:
    """Take a preview, ``{"key": …}``: its surface is opened beside the CT."""
    workspace = call.workspace
    session = workspace.require(VolumeSession, _NO_VOLUME)
    key = str(call.document().get("key", ""))

    def run(progress: Progress) -> Mapping[str, Any]:
        case = session.accept(key, progress=progress)
        opened = _opened(case, workspace.find(Detail) or Detail(), progress)
        with workspace.lock:
            workspace.put(opened)
        return {"volume_ml": case.volume_ml, "verdict": case.verdict.value}

    return Work(run)


def file(call: Call) -> bytes:
    """A file of the accepted case: mask.nrrd, surface.vtp or result.json."""
    case = call.workspace.require(VolumeSession, _NO_VOLUME).accepted
    name = call.path["name"]
    if case is None:
        raise InputError("nothing has been accepted yet: accept first")
    if name not in _FILES:
        raise InputError(f"no such file: choose {', '.join(_FILES)}")
    with tempfile.TemporaryDirectory(dir=call.workspace.folder) as folder:
        place = Path(folder) / name
        _FILES[name](case, place)
        return place.read_bytes()


def _surface_file(case: SegmentedCase, place: Path) -> None:
    write_surface(place, case.endocardium.mesh, space="LPS")


def _result_file(case: SegmentedCase, place: Path) -> None:
    place.write_text(json_text(segmentation_document(case)), encoding="utf-8")


_FILES: Mapping[str, Callable[[SegmentedCase, Path], None]] = {
    "mask.nrrd": lambda case, place: write_mask(case.mask, place),
    "surface.vtp": _surface_file,
    "result.json": _result_file,
}


def _opened(case: SegmentedCase, detail: Detail, progress: Progress) -> OpenCase:
    """The accepted surface as a case to explore and plan on."""
    mesh = case.endocardium.mesh
    soup = TriangleSoup(vertices=mesh.vertices, faces=mesh.faces, space="LPS")
    prepared = prepare_soup(
        soup,
        case.source,
        n_vertices=detail.n_vertices,
        n_modes=detail.n_modes,
        progress=progress,
    )
    return OpenCase(f"left atrium of {case.source.name}", prepared, remarks=prepared.remarks)


def trial_document(found: Trial) -> dict[str, Any]:
    """A trial for the page: verdict, reasons, volume, thresholds, and where its mask lies."""
    document: dict[str, Any] = {
        "key": found.key,
        "sketch": found.sketch,
        "verdict": "refused",
        "reasons": [],
    }
    if found.refusal is not None:
        document["reasons"] = [_refusal(found.refusal)]
    if found.found is not None:
        document |= _found(found.found)
    return document


def _found(found: Segmentation) -> dict[str, Any]:
    return {
        **found_document(found),
        "verdict": found.verdict.value,
        "reasons": [reason_document(each) for each in found.reasons],
        "volume_ml": found.volume_ml,
        "step_mm": float(found.mask.spacing[0]),
        "mask_shape": list(found.mask.shape),
        "mask_origin_mm": found.mask.origin.tolist(),
    }


def _refusal(refusal: SegmentationError) -> dict[str, Any]:
    cause = str(refusal).removesuffix(f": {refusal.remedy}")
    return {
        "code": refusal.code,
        "cause": cause,
        "remedy": refusal.remedy,
        "stops": True,
        "position_mm": None,
    }


def _as_bytes(inside: Truths) -> bytes:
    return np.ascontiguousarray(inside.transpose(2, 1, 0)).astype(np.uint8).tobytes()


def config_of(document: object) -> SegmentationConfig:
    """The parameters the page sent.

    Raises
    ------
    InputError
        If one is unknown or no number where there should be one.

    Examples
    --------
    >>> config_of({"seed_mm": [1, 2, 3], "lower_hu": 210}).lower_hu
    210.0
    """
    if not isinstance(document, dict):
        raise InputError("the parameters are no JSON object: reload the page")
    if unknown := sorted(map(str, document.keys() - _KEYS)):
        raise InputError(f"unknown parameters {', '.join(unknown)}: reload the page")
    given = {name: value for name, value in document.items() if value is not None}
    plain = SegmentationConfig()
    return SegmentationConfig(
        seed_mm=_place(given["seed_mm"]) if "seed_mm" in given else None,
        region_mm=tuple(_place(each) for each in _list(given.get("region_mm", []), _MOST_CORNERS)),
        region_depth_mm=_number(given.get("region_depth_mm", plain.region_depth_mm)),
        lower_hu=_number(given["lower_hu"]) if "lower_hu" in given else None,
        upper_hu=_number(given["upper_hu"]) if "upper_hu" in given else None,
        vein_stub_mm=_number(given.get("vein_stub_mm", plain.vein_stub_mm)),
        cuts_mm=tuple(
            tuple(_number(part) for part in _list(each, 7))
            for each in _list(given.get("cuts_mm", []), _MOST_CUTS)
        ),
    )


def _place(value: object) -> Place:
    numbers = [_number(part) for part in _list(value, 3)]
    if len(numbers) != 3:
        raise InputError("a place is not three numbers: give x, y, z in mm, LPS")
    x, y, z = numbers
    return x, y, z


def _list(value: object, most: int) -> list[object]:
    if not isinstance(value, list) or len(value) > most:
        raise InputError(f"a parameter is no list of at most {most}: reload the page")
    return value


def _number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError("a parameter is no finite number: correct it")
    return float(value)


ENDPOINTS = (
    Endpoint("GET", "/api/segment/voxels", voxels),
    Endpoint("POST", "/api/segment/sketch", sketch),
    Endpoint("POST", "/api/segment/preview", preview),
    Endpoint("GET", "/api/segment/mask/{key}", mask),
    Endpoint("POST", "/api/segment/accept", accept),
    Endpoint("GET", "/api/segment/file/{name}", file),
)
