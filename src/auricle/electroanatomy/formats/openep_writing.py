"""OpenEP's ``.mat`` files written, of version 7 or 7.3, the same bytes every time."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from auricle.arrays import Floats
from auricle.atomic import write_whole
from auricle.electroanatomy.electrogram import Electrogram
from auricle.electroanatomy.formats import openep_layout as layout
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import OutputError
from auricle.surface.soup import TriangleSoup

VERSIONS = ("7", "7.3")
"""Versions of MATLAB's format that can be written."""
_HEADER_BYTES, _TEXT_BYTES, _USER_BLOCK = 128, 116, 512
_LEVEL_5 = "MATLAB 5.0 MAT-file, written by auricle"
_HDF5 = "MATLAB 7.3 MAT-file, written by auricle"
_HDF5_MARK = b"\x00" * 8 + b"\x00\x02IM"
Numbers = dict[str, Floats]


def write_openep(path: Path, one: ElectroanatomicMap, *, version: str = "7") -> None:
    """Write one map as OpenEP's ``userdata``, for MATLAB and openep-py.

    Signals of points without an electrogram, and channels a point lacks, are NaN; names, tags and
    whatever else is text are not written. The first unipolar channel is written, no further one.

    Parameters
    ----------
    path
        Ends in ``.mat``.
    one
        The map; its electrograms must share length and rate.
    version
        One of `VERSIONS`; files beyond 2 GB need 7.3.

    Raises
    ------
    OutputError
        If the suffix or version is another, the electrograms differ, or it cannot be written.
    """
    if path.suffix.lower() != ".mat":
        raise OutputError(f"{path}: OpenEP's files end in .mat: choose such a name")
    if version not in VERSIONS:
        raise OutputError(f"{path}: version {version!r}: choose {' or '.join(VERSIONS)}")
    try:
        numbers = {**_points(one), **_signals(one), **_surface(one.surface)}
    except OutputError as fault:
        raise OutputError(f"{path}: {fault}") from fault

    def fill(place: Path) -> None:
        (_fill_level_5 if version == "7" else _fill_hdf5)(place, numbers)

    write_whole(path, fill)


def _points(one: ElectroanatomicMap) -> Numbers:
    points = one.points
    columns = {
        place: getattr(points, name)[:, None] for name, place in layout.POINT_COLUMNS.items()
    }
    return {
        layout.POSITIONS: points.positions,
        layout.PROJECTED: points.projected_positions,
        layout.INCLUDED: points.included.astype(np.float64)[:, None],
        **columns,
    }


def _signals(one: ElectroanatomicMap) -> Numbers:
    count, signals = len(one.points), one.electrograms
    marks = {row: signal for row, signal in signals.items()}
    rates = {signal.sampling_rate for signal in signals.values()}
    lengths = {len(signal.samples) for signal in signals.values()}
    if len(rates) > 1 or len(lengths) > 1:
        raise OutputError("electrograms differ in rate or length, OpenEP's may not: choose some")
    # Without electrograms, annotations at 1 kHz carry the activation times
    rate = rates.pop() if rates else 1000.0
    reference, mapped = np.full((count, 1), np.nan), np.full((count, 1), np.nan)
    times = one.points.local_activation_time
    known = np.isfinite(times)
    reference[known, 0], mapped[known, 0] = 0.0, times[known] / 1000.0 * rate
    windows = np.tile(np.array(one.window_of_interest), (count, 1))
    for row, signal in marks.items():
        reference[row], windows[row] = signal.reference_annotation, signal.window_of_interest
        mapped[row] = signal.map_annotation
    return {
        layout.SAMPLING_RATE: np.array([[rate]]),
        layout.REFERENCE_ANNOTATION: reference,
        layout.MAP_ANNOTATION: mapped,
        layout.WINDOW: windows,
        **_samples(signals.items(), count, lengths.pop() if lengths else 0),
    }


def _samples(signals: Any, count: int, length: int) -> Numbers:
    if not length:
        return {}
    tables = {
        place: np.full((count, length), np.nan)
        for place in (
            layout.BIPOLAR_SIGNALS,
            layout.UNIPOLAR_SIGNALS,
            layout.REFERENCE_SIGNALS,
        )
    }
    for row, signal in signals:
        for place, name in _roles(signal).items():
            if name:
                tables[place][row] = signal.channel(name)
    return tables


def _roles(signal: Electrogram) -> dict[str, str]:
    return {
        layout.BIPOLAR_SIGNALS: signal.bipolar,
        layout.UNIPOLAR_SIGNALS: signal.unipolar,
        layout.REFERENCE_SIGNALS: signal.reference,
    }


def _surface(soup: TriangleSoup | None) -> Numbers:
    if soup is None:
        return {}
    missing = np.full(len(soup.vertices), np.nan)
    columns = {
        place: np.column_stack([soup.point_fields.get(name, missing) for name in names])
        for place, names in layout.SURFACE_COLUMNS.items()
    }
    return {layout.VERTICES: soup.vertices, layout.FACES: soup.faces + 1.0, **columns}


def _nested(numbers: Numbers) -> dict[str, Any]:
    """Dotted paths as dictionaries within dictionaries."""
    root: dict[str, Any] = {}
    for place, values in numbers.items():
        *groups, name = place.split(".")
        inner = root
        for group in groups:
            inner = inner.setdefault(group, {})
        inner[name] = values
    return root


def _fill_level_5(place: Path, numbers: Numbers) -> None:
    from scipy.io import savemat

    savemat(place, {layout.ROOT: _nested(numbers)}, do_compression=True)
    with place.open("rb+") as file:  # scipy writes the machine and the hour
        file.write(_LEVEL_5.encode().ljust(_TEXT_BYTES))


def _fill_hdf5(place: Path, numbers: Numbers) -> None:
    import h5py  # type: ignore[import-untyped]

    with h5py.File(place, "w", userblock_size=_USER_BLOCK, libver=("earliest", "v110")) as file:
        root = file.create_group(layout.ROOT)
        root.attrs["MATLAB_class"] = np.bytes_("struct")
        for path, values in numbers.items():
            _fill_dataset(root, path.split("."), values)
    with place.open("rb+") as file:
        file.write(_HDF5.encode().ljust(_TEXT_BYTES) + _HDF5_MARK)


def _fill_dataset(group: Any, parts: list[str], values: Floats) -> None:
    *groups, name = parts
    for part in groups:
        group = group.require_group(part)
        group.attrs["MATLAB_class"] = np.bytes_("struct")
    empty = not math.prod(values.shape)
    # MATLAB counts the first index fastest, HDF5 the last; of an empty array only the shape stays
    stored = np.array(values.shape, np.uint64) if empty else np.ascontiguousarray(values.T)
    dataset = group.create_dataset(name, data=stored)
    dataset.attrs["MATLAB_class"] = np.bytes_("double")
    if empty:
        dataset.attrs["MATLAB_empty"] = np.uint8(1)
