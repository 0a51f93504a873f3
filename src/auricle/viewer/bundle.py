"""The bundle: all the page needs to show a surface and rebuild it live, in one run of bytes."""

import gzip
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from auricle import __version__
from auricle.arrays import Floats, Modes
from auricle.electroanatomy.points import UNITS
from auricle.progress import Progress, silent
from auricle.study.fields import unfitness
from auricle.study.preparation import PreparedSurface
from auricle.surface.capping import cap_holes
from auricle.surface.field import FieldMap
from auricle.surface.filling import extend_over_caps
from auricle.surface.simplification import simplification_sequence
from auricle.viewer.approximation import harmonic_distances, point_distances
from auricle.viewer.container import packed
from auricle.viewer.shown_signal import ShownSignal, shown_signal

BUNDLE_FORMAT = "auricle page case 1"
_UNITS = UNITS | {"lat": "ms"}
_LARGEST = 32767
_COMPRESSION = 5

Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Shipped:
    """Header and arrays of a bundle, not yet bytes."""

    header: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]

    @property
    def content(self) -> bytes:
        """Compressed container; the same case gives the same bytes."""
        return gzip.compress(packed(self.header, self.arrays), _COMPRESSION, mtime=0)


def surface_bundle(
    prepared: PreparedSurface,
    *,
    name: str,
    n_modes: int | None = None,
    remarks: Sequence[str] = (),
    progress: Progress = silent,
) -> bytes:
    """What the page shows of a surface: gzip of a container (`auricle.viewer.container`).

    Parameters
    ----------
    prepared
        The surface, closed, with its harmonics and fields.
    name
        Its title on the page.
    n_modes
        How many harmonics to send; None for all. Fewer make a smaller exported page.
    remarks
        What its reader should know.
    progress
        Told how many distances are measured.

    Notes
    -----
    The harmonics go as 16-bit integers, each mode with a scale of its own, mode after mode: the
    page rebuilds a map by adding up rows. A mode is then wrong by at most 1/65534 of its largest
    value.
    """
    return shipped_surface(
        prepared, name=name, n_modes=n_modes, remarks=remarks, progress=progress
    ).content


def shipped_surface(
    prepared: PreparedSurface,
    *,
    name: str,
    n_modes: int | None = None,
    remarks: Sequence[str] = (),
    progress: Progress = silent,
) -> Shipped:
    """As `surface_bundle`, before it becomes bytes."""
    surface, basis = prepared.surface, _leading(prepared, n_modes).chamber.basis
    fields = [each for each in prepared.fields if each.values.ndim == 1]
    signals, faults = _signals(_leading(prepared, n_modes), fields)
    sequence = simplification_sequence(surface)
    scales, rows = quantized(basis.modes[: surface.n_vertices])
    arrays: Arrays = {
        "positions": surface.vertices.astype(np.float32),
        "faces": surface.faces.astype(np.uint32),
        "areas": basis.areas[: surface.n_vertices],
        "eigenvalues": basis.eigenvalues,
        "mode_scales": scales,
        "modes": rows,
        "collapse_kept": sequence.kept.astype(np.int32),
        "collapse_gone": sequence.gone.astype(np.int32),
        "collapse_places": sequence.places.astype(np.float32),
        "collapse_errors": sequence.errors,
    }
    for place, field in enumerate(fields):
        arrays[f"field_{place}"] = field.values.astype(np.float32)
    for place, signal in enumerate(signals):
        for part in ("coefficients", "power", "share", "error"):
            arrays[f"{part}_{place}"] = getattr(signal, part)
    geometric = harmonic_distances(surface, signals[0], progress=progress)
    pointwise = point_distances(sequence, most=basis.n_modes, progress=progress)
    header = {
        "format": BUNDLE_FORMAT,
        "version": __version__,
        "name": name,
        "space": prepared.space,
        "remarks": list(remarks),
        "area_mm2": surface.area,
        "fields": [
            _field_entry(field, fault, signals) for field, fault in zip(fields, faults, strict=True)
        ],
        "signals": [
            {
                "name": signal.name,
                "title": signal.title,
                "unit": signal.unit,
                "spread": signal.spread,
                "offset": signal.offset.tolist(),
            }
            for signal in signals
        ],
        "harmonic_distances": [asdict(each) for each in geometric],
        "point_distances": [asdict(each) for each in pointwise],
    }
    return Shipped(header, arrays)


def quantized(modes: Modes) -> tuple[Floats, NDArray[np.int16]]:
    """Harmonics as integers of 16 bits: a scale a mode, shape (k,), and rows, shape (k, n).

    Examples
    --------
    >>> scales, rows = quantized(np.array([[0.5], [-1.0]]))
    >>> (scales[0] * rows[0]).round(4).tolist()
    [0.5, -1.0]
    """
    sizes = np.abs(modes).max(axis=0)
    scales: Floats = np.where(sizes > 0, sizes, 1.0) / _LARGEST
    rows = np.empty(modes.shape[::-1], dtype=np.int16)
    for mode, scale in enumerate(scales):
        rows[mode] = np.rint(modes[:, mode] / scale)
    return scales, rows


def _leading(prepared: PreparedSurface, n_modes: int | None) -> PreparedSurface:
    """The same with no more than `n_modes` harmonics."""
    basis = prepared.chamber.basis
    if n_modes is None or n_modes >= basis.n_modes:
        return prepared
    fewer = replace(basis, eigenvalues=basis.eigenvalues[:n_modes], modes=basis.modes[:, :n_modes])
    return replace(prepared, chamber=replace(prepared.chamber, basis=fewer))


def _signals(
    prepared: PreparedSurface, fields: Sequence[FieldMap]
) -> tuple[list[ShownSignal], list[str]]:
    """The geometry and every field that has a spectrum; and why each of the others has none."""
    chamber, surface = prepared.chamber, prepared.surface
    n = surface.n_vertices
    capped = cap_holes(surface)
    signals = [
        shown_signal(
            chamber.basis,
            chamber.mesh.vertices,
            capped.original,
            name="geometry",
            unit="mm",
            n_vertices=n,
        )
    ]
    faults = [unfitness(field) for field in fields]
    for field, fault in zip(fields, faults, strict=True):
        if fault:
            continue
        known = np.zeros(chamber.mesh.n_vertices, dtype=np.bool_)
        known[:n] = field.sampled
        on_shell = extend_over_caps(capped, field).values
        signals.append(
            shown_signal(
                chamber.basis, on_shell, known, name=field.name, unit=_unit(field), n_vertices=n
            )
        )
    return signals, faults


def _field_entry(field: FieldMap, fault: str, signals: Sequence[ShownSignal]) -> dict[str, Any]:
    names = [signal.name for signal in signals[1:]]
    unit = _unit(field)
    return {
        "name": field.name,
        "title": " ".join(field.name.replace("_", " ").split()),
        "unit": unit,
        "cyclic": unit.startswith("ms"),
        "signal": -1 if fault else names.index(field.name) + 1,
        "fault": fault,
    }


def _unit(field: FieldMap) -> str:
    """As the file states it, else that of the quantity OpenEP calls so."""
    return field.unit or _UNITS.get(field.name.lower(), "")
