"""Samples: what was measured at places in space, and where on a chamber that was."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from auricle.arrays import Floats, Integers, Points, read_only
from auricle.errors import InputError
from auricle.sampling.chamber import Chamber
from auricle.sampling.cycle import circular_difference
from auricle.sampling.sites import Sites

SAME_PLACE = 0.1
"""Samples whose sites lie within this many mm of one another are one, repeated."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Values at positions in space, as measured.

    Attributes
    ----------
    positions
        Shape (m, 3), mm, in the frame of the chamber; NaN allowed.
    values
        Shape (m,); NaN: not measured.
    noise
        Standard deviation of each, in the values' unit, shape (m,); None if unknown.
    name, unit
        Of the values.
    """

    positions: Points
    values: Floats
    noise: Floats | None = None
    name: str = "values"
    unit: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", read_only(self.positions, np.float64))
        object.__setattr__(self, "values", read_only(self.values, np.float64))
        n_samples = len(self.values) if self.values.ndim == 1 else -1
        if self.positions.shape != (n_samples, 3):
            raise InputError(
                f"positions of shape {self.positions.shape} and values of shape "
                f"{self.values.shape}: give (m, 3) and (m,)"
            )
        if self.noise is None:
            return
        object.__setattr__(self, "noise", read_only(self.noise, np.float64))
        if self.noise.shape != (n_samples,) or (self.noise <= 0).any():
            raise InputError("the noise is not one positive number a sample: correct or omit it")

    def __len__(self) -> int:
        return len(self.values)


@dataclass(frozen=True, eq=False)
class PlacedSamples:
    """Samples on a chamber's surface, each place once.

    Attributes
    ----------
    sites
        Where, m of them.
    values
        Shape (m,), finite; of samples in the same place their mean, weighted by 1/noise².
    noise
        Standard deviation of those means, shape (m,); None if that of the samples is unknown.
    counts
        How many samples each place stands for, shape (m,).
    distances
        How far off the surface the first of them lay, shape (m,), mm.
    kept
        Index of that first one among the samples handed in, shape (m,).
    remarks
        What was left out or merged, with counts, one phrase each.
    name, unit
        Of the values.
    """

    sites: Sites
    values: Floats
    noise: Floats | None
    counts: Integers
    distances: Floats
    kept: Integers
    remarks: tuple[str, ...]
    name: str
    unit: str

    def __len__(self) -> int:
        return len(self.values)

    @property
    def noise_shape(self) -> Floats:
        """Noise of each place relative to the others, shape (m,): 1/√count where unknown."""
        relative: Floats = 1 / np.sqrt(self.counts) if self.noise is None else self.noise
        return relative

    @property
    def noise_level(self) -> float | None:
        """Root mean square of the noise, in the values' unit; None if unknown."""
        return None if self.noise is None else float(np.sqrt(np.square(self.noise).mean()))


def place(
    samples: Samples,
    chamber: Chamber,
    *,
    max_distance: float = 5.0,
    cycle_length: float | None = None,
) -> PlacedSamples:
    """Put samples on the surface of a chamber.

    Left out: samples without a finite value, position or noise; those farther than
    `max_distance` off the surface; those whose nearest vertex is not accessible (they lie over a
    cap: a valve's plane or a vein's opening, where there is no wall to have a value). Samples
    within `SAME_PLACE` of one another on the surface are merged.

    Parameters
    ----------
    samples
        In the chamber's frame.
    chamber
        Closed; its accessible part is what samples are of.
    max_distance
        In mm; mapping studies reject points more than 5 mm off the shell.
    cycle_length
        Of activation times that wrap round: those of one place are then averaged on the circle.

    Raises
    ------
    InputError
        If nothing is left; the message says why.

    Examples
    --------
    >>> from auricle.sampling.chamber import chamber
    >>> from auricle.surface.shapes import icosphere
    >>> ball = chamber(icosphere(radius=10.0, subdivisions=2), 9)
    >>> positions = [[0, 0, 11.0], [0, 0, 11.0], [0, 12.0, 0], [0, 0, 40.0]]
    >>> placed = place(Samples(positions, [1.0, 3.0, 5.0, 7.0]), ball)
    >>> placed.values.tolist(), placed.counts.tolist()
    ([2.0, 5.0], [2, 1])
    >>> placed.remarks[0]
    '1 of 4 samples left out: more than 5 mm off the surface (30.0 mm in the median)'
    """
    if not len(samples):
        raise InputError("there is no sample: give one at least")
    finite = np.isfinite(samples.values) & np.isfinite(samples.positions).all(axis=1)
    if samples.noise is not None:
        finite &= np.isfinite(samples.noise)
    if not finite.any():
        raise InputError(
            f"none of {len(samples)} samples has a finite value, position and noise: check the "
            "columns"
        )
    measured = np.flatnonzero(finite)
    sites, distances = Sites.nearest(chamber.mesh, samples.positions[measured])
    far = distances > max_distance
    if far.all():
        raise InputError(
            f"all {len(far)} samples lie more than {max_distance:g} mm off the surface "
            f"({np.median(distances):.1f} mm in the median): check that positions are in mm and "
            "in the surface's frame"
        )
    hidden = ~far & ~chamber.accessible[sites.nearest_vertices]
    near = np.flatnonzero(~far & ~hidden)
    if not len(near):
        raise InputError(
            f"no sample lies on the accessible surface: {far.sum()} are too far off, "
            f"{hidden.sum()} over caps or parts that are not accessible: check the frame"
        )
    remarks = _left_out(
        len(samples), len(measured), distances[far], int(hidden.sum()), max_distance
    )
    chosen = sites[near]
    groups = _places(chosen.positions(chamber.mesh))
    merged = _merged(samples, measured[near], groups, cycle_length)
    apart = _apart(samples, measured[near], groups, cycle_length)
    return PlacedSamples(
        chosen[merged.first],
        merged.values,
        merged.noise,
        merged.counts,
        read_only(distances[near][merged.first], np.float64),
        read_only(measured[near][merged.first], np.int64),
        remarks + apart,
        samples.name,
        samples.unit,
    )


def _left_out(
    n_samples: int, n_measured: int, far: Floats, n_hidden: int, max_distance: float
) -> tuple[str, ...]:
    remarks = []
    if n_measured < n_samples:
        left = n_samples - n_measured
        remarks.append(
            f"{left} of {n_samples} samples left out: value, position or noise not finite"
        )
    if len(far):
        remarks.append(
            f"{len(far)} of {n_samples} samples left out: more than {max_distance:g} mm off the "
            f"surface ({np.median(far):.1f} mm in the median)"
        )
    if n_hidden:
        remarks.append(
            f"{n_hidden} of {n_samples} samples left out: over caps or parts not accessible"
        )
    return tuple(remarks)


def _places(positions: Points) -> Integers:
    """Which place each sample belongs to: numbers in order of first appearance, shape (m,)."""
    pairs = cKDTree(positions).query_pairs(SAME_PLACE, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (len(positions),) * 2)
    labels = connected_components(links, directed=False)[1]
    _, first, place_of = np.unique(labels, return_index=True, return_inverse=True)
    order: Integers = np.argsort(np.argsort(first))[place_of].astype(np.int64)
    return order


@dataclass(frozen=True, eq=False)
class _Merged:
    """One row a place: index of its first sample, mean, its noise, number of samples."""

    first: Integers
    values: Floats
    noise: Floats | None
    counts: Integers


def _merged(
    samples: Samples, indices: Integers, places: Integers, cycle_length: float | None
) -> _Merged:
    values = samples.values[indices]
    certainty = np.ones(len(indices))
    if samples.noise is not None:
        certainty = samples.noise[indices] ** -2.0
    counts = np.bincount(places)
    total = np.bincount(places, certainty)
    first = np.unique(places, return_index=True)[1]
    # Relative to the first of each place: once measured keeps its digits, circles their seam.
    deviation = _deviation(values, values[first][places], cycle_length)
    means = values[first] + np.bincount(places, certainty * deviation) / total
    return _Merged(
        first,
        read_only(means, np.float64),
        None if samples.noise is None else read_only(total**-0.5, np.float64),
        read_only(counts, np.int64),
    )


def _apart(
    samples: Samples, indices: Integers, places: Integers, cycle_length: float | None
) -> tuple[str, ...]:
    """What to say of places with several samples."""
    repeated = np.bincount(places) > 1
    if not repeated.any():
        return ()
    values = samples.values[indices]
    first = np.unique(places, return_index=True)[1]
    deviation = np.abs(_deviation(values, values[first][places], cycle_length))
    n_samples = int(repeated[places].sum())
    unit = f" {samples.unit}" if samples.unit else ""
    return (
        f"{n_samples} samples merged into {repeated.sum()} places (values there up to "
        f"{deviation.max():.3g}{unit} from the first)",
    )


def _deviation(values: Floats, reference: Floats, cycle_length: float | None) -> Floats:
    if cycle_length is None:
        return values - reference
    return circular_difference(values, reference, cycle_length)
