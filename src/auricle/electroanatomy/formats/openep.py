"""OpenEP's ``.mat`` files: the numbers of ``userdata``, parsed in a child process.

Format after the data page of openep.io. Files of version 5 to 7 are read by scipy, of version 7.3
by h5py. Text in the file (patient, system, names and tags of points) is never read.
"""

import math
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from auricle.arrays import Floats, Truths
from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.formats import openep_layout as layout
from auricle.electroanatomy.formats.number_tables import LARGEST
from auricle.electroanatomy.formats.omissions import Omissions
from auricle.electroanatomy.formats.positions import require_positions
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap, ElectroanatomicStudy
from auricle.errors import FormatError
from auricle.isolation import run_child
from auricle.surface.formats.header import damaged, within_limits
from auricle.surface.soup import TriangleSoup

SYSTEM = "OpenEP"
BIPOLAR, UNIPOLAR, REFERENCE = "bipolar", "unipolar", "reference"
_MAGICS = (b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file")
_SECONDS, _BYTES_PER_SECOND = 120.0, 5_000_000.0
Arrays = dict[str, NDArray[np.float64]]


def read_openep(path: Path, *, signals: bool = True) -> ElectroanatomicStudy:
    """Read the one map of a ``.mat`` file.

    Annotations stay the sample numbers that they are in the file, and activation times are their
    differences over the sampling rate. Channels are called by their role: ``bipolar``,
    ``unipolar``, ``unipolar 2``, ``reference``; one without a sample is left out.

    Raises
    ------
    FormatError
        If it is no such file, holds no ``userdata``, or its arrays disagree.
    """
    within_limits(path)
    with path.open("rb") as file:
        start = file.read(len(_MAGICS[0]))
    if start not in _MAGICS:
        raise FormatError("is no MATLAB file of version 5, 7 or 7.3: save it as one of these")
    omissions = Omissions()
    arrays = {name: _bounded(values, omissions) for name, values in _isolated(path).items()}
    surface = _surface(arrays, omissions)
    if surface is None and layout.POSITIONS not in arrays:
        raise FormatError("holds neither surface.triRep as numbers nor electric.egmX: save both")
    points, placed = _points(arrays, omissions)
    found = ElectroanatomicMap(
        "map 1",
        surface,
        points,
        _electrograms(arrays, placed) if signals else {},
        window_of_interest=_common_window(arrays),
        remarks=omissions.remarks,
    )
    return ElectroanatomicStudy(SYSTEM, (found,))


def _isolated(path: Path) -> Arrays:
    with tempfile.TemporaryDirectory(prefix="auricle-", ignore_cleanup_errors=True) as folder:
        archive = Path(folder) / "numbers.npz"
        module = [sys.executable, "-P", "-m", "auricle.electroanatomy.formats.openep_child"]
        seconds = _SECONDS + path.stat().st_size / _BYTES_PER_SECOND
        run_child([*module, str(path.absolute()), str(archive)], seconds=seconds)
        with np.load(archive, allow_pickle=False) as found:
            return {name: np.asarray(found[name], np.float64) for name in found.files}


def _bounded(values: NDArray[np.float64], omissions: Omissions) -> NDArray[np.float64]:
    """Values with what is beyond all bounds taken for missing."""
    beyond = np.abs(values) > LARGEST
    omissions.add("infinite numbers taken for missing", int(beyond.sum()))
    return np.where(beyond, np.nan, values)


def _surface(arrays: Arrays, omissions: Omissions) -> TriangleSoup | None:
    vertices, faces = arrays.get(layout.VERTICES), arrays.get(layout.FACES)
    if vertices is None or faces is None or not vertices.size:
        omissions.add("surfaces not there, or MATLAB objects instead of numbers")
        return None
    if vertices.ndim != 2 or faces.ndim != 2 or vertices.shape[1] != 3 or faces.shape[1] != 3:
        raise damaged("holds a surface that is not triangles in space")
    if not ((faces == np.round(faces)) & (faces >= 1) & (faces <= len(vertices))).all():
        raise damaged(f"holds a triangle at a vertex that is none of 1 … {len(vertices):,}")
    triangles = faces.astype(np.int64) - 1
    require_positions(vertices, triangles)
    fields = {
        name: column
        for place, names in layout.SURFACE_COLUMNS.items()
        for name, column in _columns(arrays, place, names, len(vertices)).items()
    }
    return TriangleSoup(
        vertices,
        triangles,
        point_fields=fields,
        units={name: UNITS[name] for name in fields},
    )


def _columns(arrays: Arrays, place: str, names: tuple[str, ...], count: int) -> dict[str, Floats]:
    table = arrays.get(place)
    if table is None or not table.size:
        return {}
    if table.shape != (count, len(names)):
        raise damaged(f"holds {place} of shape {table.shape} for {count:,} vertices")
    return {
        name: column
        for name, column in zip(names, table.T, strict=True)
        if np.isfinite(column).any()
    }


def _points(arrays: Arrays, omissions: Omissions) -> tuple[MappingPoints, Truths]:
    """The table, and which rows of the file are in it."""
    positions = arrays.get(layout.POSITIONS, np.empty((0, 3)))
    if not positions.size:
        positions = np.empty((0, 3))
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise damaged(f"holds positions of shape {positions.shape}")
    placed = np.asarray(np.isfinite(positions).all(axis=1))
    count = len(positions)
    omissions.add("points without a position left out", int((~placed).sum()))
    projected = _rows(arrays, layout.PROJECTED, (count, 3))
    included = _rows(arrays, layout.INCLUDED, (count,))
    values = {
        name: _rows(arrays, place, (count,))[placed] for name, place in layout.POINT_COLUMNS.items()
    }
    points = MappingPoints(
        positions[placed],
        projected[placed],
        local_activation_time=_activation_times(arrays, count)[placed],
        identifiers=np.flatnonzero(placed) + 1,
        included=np.where(np.isnan(included), 1.0, included)[placed] != 0.0,
        **values,
    )
    return points, placed


def _rows(arrays: Arrays, place: str, shape: tuple[int, ...]) -> Floats:
    """One row a point; NaN where the file has none."""
    table = arrays.get(place)
    if table is None or not table.size:
        return np.full(shape, np.nan)
    if table.size != math.prod(shape):
        raise damaged(f"holds {place} of shape {table.shape} for {shape[0]:,} points")
    return table.reshape(shape)


def _activation_times(arrays: Arrays, count: int) -> Floats:
    samples = _rows(arrays, layout.MAP_ANNOTATION, (count,)) - _rows(
        arrays, layout.REFERENCE_ANNOTATION, (count,)
    )
    return samples / _sampling_rate(arrays) * MILLISECONDS


def _sampling_rate(arrays: Arrays) -> float:
    """Hz; NaN where the file has none."""
    rate = arrays.get(layout.SAMPLING_RATE, np.empty(0))
    if not rate.size:
        return math.nan
    value = float(rate.flat[0])
    if rate.size != 1 or not (math.isfinite(value) and value > 0):
        raise damaged("states a sampling rate that is no positive number")
    return value


def _electrograms(arrays: Arrays, placed: Truths) -> dict[int, Electrogram]:
    """Electrograms by row of the table."""
    signals = _signals(arrays, len(placed))
    rate = _sampling_rate(arrays)
    if not signals:
        return {}
    if math.isnan(rate):
        raise damaged("holds electrograms and no sampling rate")
    count = len(placed)
    reference = _rows(arrays, layout.REFERENCE_ANNOTATION, (count,))
    mapped = _rows(arrays, layout.MAP_ANNOTATION, (count,))
    windows = _rows(arrays, layout.WINDOW, (count, 2))
    found = {}
    for row, place in enumerate(np.flatnonzero(placed)):
        heard = {name: rows[place] for name, rows in signals.items()}
        heard = {name: signal for name, signal in heard.items() if np.isfinite(signal).any()}
        if heard:
            found[row] = Electrogram(
                np.column_stack(list(heard.values())),
                rate,
                tuple(heard),
                **{name: name for name in (BIPOLAR, UNIPOLAR, REFERENCE) if name in heard},
                reference_annotation=float(reference[place]),
                map_annotation=float(mapped[place]),
                window_of_interest=(float(windows[place, 0]), float(windows[place, 1])),
            )
    return found


def _signals(arrays: Arrays, count: int) -> dict[str, Floats]:
    """Signals of shape (points, samples) by channel."""
    signals: dict[str, Floats] = {}
    for channel, place in (
        (BIPOLAR, layout.BIPOLAR_SIGNALS),
        (UNIPOLAR, layout.UNIPOLAR_SIGNALS),
        (REFERENCE, layout.REFERENCE_SIGNALS),
    ):
        table = arrays.get(place, np.empty((0, 0)))
        if not table.size:
            continue
        if table.ndim not in (2, 3) or len(table) != count:
            raise damaged(f"holds {place} of shape {table.shape} for {count:,} points")
        layers = table.reshape(count, table.shape[1], -1)
        for k in range(layers.shape[2]):
            signals[channel if not k else f"{channel} {k + 1}"] = layers[:, :, k]
    if len({rows.shape for rows in signals.values()}) > 1:
        raise damaged("holds electrograms of different lengths")
    return signals


def _common_window(arrays: Arrays) -> tuple[float, float]:
    windows = arrays.get(layout.WINDOW, np.empty(0))
    if windows.ndim != 2 or windows.shape[1] != 2:
        return math.nan, math.nan
    known = windows[np.isfinite(windows).all(axis=1)]
    if not len(known):
        return math.nan, math.nan
    kinds, counts = np.unique(known, axis=0, return_counts=True)
    first, last = kinds[counts.argmax()]
    return float(first), float(last)
