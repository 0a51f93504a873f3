"""Synthetic maps: a catheter's way over a surface with known activation, recorded with its faults.

The truth is known at every point, so that readers, features and maps can be held against it; no
patient's data are in it, so that it can be handed on.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, Integers, PerVertex
from auricle.electroanatomy.electrogram import MILLISECONDS, Electrogram
from auricle.electroanatomy.points import UNITS, MappingPoints
from auricle.electroanatomy.study import ElectroanatomicMap
from auricle.errors import InputError
from auricle.surface.mesh import Mesh
from auricle.surface.soup import TriangleSoup

BIPOLAR, UNIPOLAR, REFERENCE = "M1-M2", "M1", "CS1-CS2"
"""Channels of a synthetic electrogram."""
_UNIPOLAR_WIDTH_MS, _BIPOLAR_WIDTH_MS = 4.0, 3.0
_UNIPOLAR_TO_BIPOLAR = 3.0
_RICKER_RANGE = 1.0 + 2.0 * np.exp(-1.5)
_DERIVATIVE_RANGE = np.sqrt(2.0) * np.exp(-0.5)
_WALK_NEIGHBOURS = 12


@dataclass(frozen=True)
class Acquisition:
    """How a catheter samples a surface.

    Attributes
    ----------
    n_points
        Mapping points, duplicates among them.
    off_surface
        Standard deviation of the distance from the surface, mm.
    duplicates
        Share of the points that repeat the place of the one before.
    missing
        Share of the points at which the unipole was not recorded.
    noise
        Standard deviation on every sample, mV.
    sampling_rate
        Hz.
    duration
        ms of every electrogram; the reference is activated in its middle.
    cycle_length
        ms between activations.

    Raises
    ------
    InputError
        If a number is out of its range.
    """

    n_points: int = 60
    off_surface: float = 1.0
    duplicates: float = 0.05
    missing: float = 0.1
    noise: float = 0.01
    sampling_rate: float = 1000.0
    duration: float = 800.0
    cycle_length: float = 300.0

    def __post_init__(self) -> None:
        if self.n_points < 1:
            raise InputError(f"{self.n_points} mapping points: give one or more")
        if not (0 <= self.duplicates <= 1 and 0 <= self.missing <= 1):
            raise InputError("the shares of duplicates and missing channels lie between 0 and 1")
        if min(self.off_surface, self.noise) < 0:
            raise InputError("distances from the surface and noise are 0 or more")
        if min(self.sampling_rate, self.duration, self.cycle_length) <= 0:
            raise InputError("rate, duration and cycle length are positive")


def synthetic_map(
    mesh: Mesh,
    fields: Mapping[str, PerVertex],
    *,
    acquisition: Acquisition,
    rng: np.random.Generator,
) -> ElectroanatomicMap:
    """Map of a surface whose activation is known.

    A point's activation time is that of its vertex, rounded to a sample; the unipole falls
    steepest and the bipole peaks at that sample, once every cycle.

    Parameters
    ----------
    mesh
        The surface.
    fields
        Truth at its vertices, by OpenEP's name: ``local_activation_time`` (ms after the
        reference, not missing) and ``bipolar_voltage`` (mV), others as they are.
    acquisition
        How it is sampled.
    rng
        Source of the way, distances and noise.

    Raises
    ------
    InputError
        If a needed field is not there or has missing values.
    """
    for name in ("local_activation_time", "bipolar_voltage"):
        if name not in fields or not np.isfinite(fields[name]).all():
            raise InputError(f"{name} is not given at every vertex: give the truth")
    way = catheter_way(mesh, acquisition, rng=rng)
    distance = rng.normal(0.0, acquisition.off_surface, len(way))
    rate = acquisition.sampling_rate
    ticks = np.round(fields["local_activation_time"][way] / MILLISECONDS * rate)
    bipolar = fields["bipolar_voltage"][way]
    values = {name: fields[name][way] for name in UNITS if name in fields}
    values["local_activation_time"] = ticks / rate * MILLISECONDS
    values["unipolar_voltage"] = _UNIPOLAR_TO_BIPOLAR * bipolar
    points = MappingPoints(
        mesh.vertices[way] + distance[:, None] * _vertex_normals(mesh)[way],
        mesh.vertices[way],
        **values,  # type: ignore[arg-type]
    )
    window = (-acquisition.cycle_length / 2.0, acquisition.cycle_length / 2.0)
    heard = rng.random(len(way)) >= acquisition.missing
    electrograms = {
        row: _electrogram(ticks[row], bipolar[row], acquisition, unipole=bool(heard[row]), rng=rng)
        for row in range(len(way))
    }
    soup = TriangleSoup(
        mesh.vertices,
        mesh.faces,
        point_fields={name: np.asarray(fields[name]) for name in UNITS if name in fields},
        units={name: unit for name, unit in UNITS.items() if name in fields},
    )
    return ElectroanatomicMap(
        "map 1",
        soup,
        points,
        electrograms,
        cycle_length=acquisition.cycle_length,
        window_of_interest=window,
    )


def catheter_way(mesh: Mesh, acquisition: Acquisition, *, rng: np.random.Generator) -> Integers:
    """Vertices a catheter visits, shape (n_points,): steps to some near place, jumps at times.

    Duplicates repeat the vertex before.
    """
    place = int(rng.integers(mesh.n_vertices))
    way = [place]
    while len(way) < acquisition.n_points:
        draw = rng.random()
        if draw >= acquisition.duplicates:
            place = _next_place(mesh, place, rng)
        way.append(place)
    return np.array(way, np.int64)


def _next_place(mesh: Mesh, place: int, rng: np.random.Generator) -> int:
    tried = rng.integers(mesh.n_vertices, size=_WALK_NEIGHBOURS)
    tried = tried[tried != place]
    if not len(tried):
        return place
    distances = np.linalg.norm(mesh.vertices[tried] - mesh.vertices[place], axis=1)
    return int(tried[distances.argmin()])


def _vertex_normals(mesh: Mesh) -> Floats:
    sums = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(sums, mesh.faces[:, corner], mesh.face_normals)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    normals: Floats = sums / np.where(lengths > 0, lengths, 1.0)
    return normals


def _electrogram(
    tick: float,
    voltage: float,
    acquisition: Acquisition,
    *,
    unipole: bool,
    rng: np.random.Generator,
) -> Electrogram:
    rate = acquisition.sampling_rate
    count = round(acquisition.duration / MILLISECONDS * rate)
    reference = count // 2
    time = (np.arange(count) - reference) / rate * MILLISECONDS
    lag = tick / rate * MILLISECONDS
    cycle = acquisition.cycle_length
    signals = {
        BIPOLAR: voltage * ricker(_phase(time - lag, cycle) / _BIPOLAR_WIDTH_MS),
        REFERENCE: ricker(_phase(time, cycle) / _BIPOLAR_WIDTH_MS),
    }
    if unipole:
        amplitude = _UNIPOLAR_TO_BIPOLAR * voltage
        signals[UNIPOLAR] = amplitude * downstroke(_phase(time - lag, cycle) / _UNIPOLAR_WIDTH_MS)
    samples = np.column_stack(list(signals.values()))
    half = cycle / 2.0
    return Electrogram(
        samples + rng.normal(0.0, acquisition.noise, samples.shape),
        rate,
        tuple(signals),
        bipolar=BIPOLAR,
        unipolar=UNIPOLAR if unipole else "",
        reference=REFERENCE,
        reference_annotation=float(reference),
        map_annotation=float(reference + tick),
        window_of_interest=(-half, half),
    )


def _phase(time: Floats, cycle: float) -> Floats:
    """Time from the nearest activation, ms."""
    phase: Floats = (time + cycle / 2.0) % cycle - cycle / 2.0
    return phase


def ricker(time: Floats) -> Floats:
    """Second derivative of a Gaussian, its peak at 0, peak to peak 1.

    >>> bool(abs(np.ptp(ricker(np.linspace(-9, 9, 20001))) - 1) < 1e-6)
    True
    """
    wave: Floats = (1.0 - time**2) * np.exp(-(time**2) / 2.0) / _RICKER_RANGE
    return wave


def downstroke(time: Floats) -> Floats:
    """First derivative of a Gaussian, falling steepest at 0, peak to peak 1.

    >>> bool(abs(np.ptp(downstroke(np.linspace(-9, 9, 20001))) - 1) < 1e-6)
    True
    """
    wave: Floats = -time * np.exp(-(time**2)) / _DERIVATIVE_RANGE
    return wave
