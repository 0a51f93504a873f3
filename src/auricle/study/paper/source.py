"""Where a case of the study comes from: a surface file, a contrast CT, or a generated one."""

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from auricle.errors import InputError
from auricle.imaging.image_files import is_image_file
from auricle.imaging.segmentation import SegmentationOptions, segment
from auricle.imaging.verdict import Reason, verdict_of
from auricle.imaging.volume import Volume
from auricle.progress import Progress, silent
from auricle.simulation.atrium import AtriumShape, atrium
from auricle.simulation.phantom import PhantomOptions, Truth, phantom
from auricle.simulation.phantom_options import hostile
from auricle.study.provenance import source_of
from auricle.study.result import Source
from auricle.study.segmented import segment_file
from auricle.surface.cleaning import CleanSurface, clean
from auricle.surface.endocardium import Endocardium, endocardium
from auricle.surface.mesh import Mesh
from auricle.surface.reading import read_surface
from auricle.surface.soup import TriangleSoup

PHANTOM, ATRIUM = "phantom:", "atrium:"
"""How the name of a generated CT, and of a generated surface, begins."""
_FINEST_MM = 0.4


@dataclass(frozen=True, eq=False)
class OriginalSurface:
    """The surface of a case before it is simplified, and where it comes from.

    Attributes
    ----------
    name
        Of the file without its folder, or the text of the generated CT.
    kind
        ``surface``, ``volume``, ``phantom`` or ``generated surface``.
    source
        Size and SHA-256 of what was read.
    cleaned
        The surface.
    remarks
        What reading did that should be known.
    scan
        What is known of the segmentation, ready for JSON; None for a surface file.
    truth
        The endocardium a CT was generated from; None for other sources.
    """

    name: str
    kind: str
    source: Source
    cleaned: CleanSurface
    remarks: tuple[str, ...]
    scan: dict[str, Any] | None = None
    truth: Truth | None = None


def phantom_options(text: str) -> PhantomOptions:
    """Options of a generated CT from a text as ``phantom:seed=3,preset=medium``.

    Any option of `PhantomOptions` may be given, and ``case``, one of the hard cases.

    Raises
    ------
    InputError
        If an option is unknown, of the wrong kind or out of range.

    Examples
    --------
    >>> phantom_options("phantom:seed=3,preset=medium,case=noisy").noise
    60.0
    """
    known = {each.name: each.default for each in fields(PhantomOptions)} | {"case": "nominal"}
    given = _given(text, PHANTOM, known)
    case = given.pop("case")
    return hostile(case, PhantomOptions(**given))


def original_surface(
    source: Path, *, accept_check: bool = False, progress: Progress = silent
) -> OriginalSurface:
    """The sound surface of a case.

    Parameters
    ----------
    source
        A surface file, a contrast CT (DICOM folder, NIfTI, NRRD, MetaImage), a text as
        `phantom_options` takes it, or one as ``atrium:seed=3,spacing=2`` for a generated surface,
        extracted on a grid of that many mm.
    accept_check
        Whether to go on where a segmentation's verdict is ``check``.
    progress
        Told how far the work is.

    Raises
    ------
    InputError
        If there is no such file, it cannot be used, or the verdict is not accepted.
    """
    if str(source).startswith(PHANTOM):
        return _generated(str(source), accept_check, progress)
    if str(source).startswith(ATRIUM):
        return _made_up(str(source))
    if source.is_dir() or is_image_file(source) or source.suffix.lower() == ".dcm":
        return _scanned(source, accept_check, progress)
    soup = read_surface(source)
    return OriginalSurface(source.name, "surface", source_of(source), clean(soup), soup.remarks)


def _scanned(path: Path, accept_check: bool, progress: Progress) -> OriginalSurface:
    case = segment_file(path, progress=progress)
    _require_verdict(case.reasons, accept_check)
    scan = _scan_document(case.reasons, case.endocardium)
    return OriginalSurface(
        case.source.name,
        "volume",
        case.source,
        _cleaned(case.endocardium),
        tuple(map(str, case.remarks)),
        scan,
    )


def _generated(text: str, accept_check: bool, progress: Progress) -> OriginalSurface:
    options = phantom_options(text)
    patient = phantom(options, progress=progress)
    found = segment(patient.volume, SegmentationOptions(), progress=progress)
    _require_verdict(found.reasons, accept_check)
    surface = endocardium(patient.volume, found, progress=progress)
    scan = {"phantom": asdict(options)} | _scan_document(found.reasons, surface)
    source = Source(text, patient.volume.voxels.nbytes, _digest(patient.volume))
    return OriginalSurface(text, "phantom", source, _cleaned(surface), (), scan, patient.truth)


def _made_up(text: str) -> OriginalSurface:
    """A generated atrium without a CT, the patient of its seed."""
    given = _given(text, ATRIUM, {"seed": 1, "spacing": 1.0})
    if given["seed"] < 0 or given["spacing"] < _FINEST_MM:
        raise InputError(f"{text}: give a seed from 0 and a spacing from {_FINEST_MM} mm")
    mesh = atrium(
        AtriumShape.random(np.random.default_rng(given["seed"])), spacing=given["spacing"]
    )
    digest = hashlib.sha256(mesh.vertices.tobytes() + mesh.faces.tobytes())
    source = Source(text, mesh.vertices.nbytes + mesh.faces.nbytes, digest.hexdigest())
    cleaned = clean(TriangleSoup(mesh.vertices, mesh.faces, space="LPS"))
    return OriginalSurface(text, "generated surface", source, cleaned, ())


def _cleaned(surface: Endocardium) -> CleanSurface:
    mesh: Mesh = surface.mesh
    return clean(TriangleSoup(mesh.vertices, mesh.faces, space="LPS"))


def _require_verdict(reasons: tuple[Reason, ...], accepted: bool) -> None:
    stopping = [str(reason) for reason in reasons if reason.stops]
    if stopping and not accepted:
        raise InputError(f"verdict check: {stopping[0]}; or set accept_check = true")


def _scan_document(reasons: tuple[Reason, ...], surface: Endocardium) -> dict[str, Any]:
    return {
        "verdict": verdict_of(reasons).value,
        "reasons": [str(reason) for reason in reasons],
        "n_vertices": surface.soundness.n_vertices,
        "volume_ml": (surface.soundness.volume_mm3 or 0.0) / 1000,
        "surface_spacing_mm": surface.spacing,
    }


def _digest(volume: Volume) -> str:
    digest = hashlib.sha256(volume.affine.tobytes())
    digest.update(np.ascontiguousarray(volume.voxels).tobytes())
    return digest.hexdigest()


def _given(text: str, kind: str, known: Mapping[str, Any]) -> dict[str, Any]:
    """The options a text gives, over their defaults."""
    given = dict(known)
    for part in filter(None, text.removeprefix(kind).split(",")):
        name, _, value = (each.strip() for each in part.partition("="))
        if name not in known:
            raise InputError(f"{text}: no option {name!r}: choose from {', '.join(known)}")
        given[name] = _converted(value, known[name], name)
    return given


def _converted(value: str, default: Any, name: str) -> Any:
    """A text as a value of the kind a default is of."""
    truths = {"true": True, "false": False}
    try:
        if isinstance(default, bool):
            return truths[value.lower()]
        return type(default)(value)
    except (KeyError, ValueError) as fault:
        raise InputError(f"{name}={value}: give a {type(default).__name__}") from fault
