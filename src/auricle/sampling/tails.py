"""Tails: how the error of a map falls with the number of harmonics that stand for it."""

from dataclasses import dataclass

import numpy as np

from auricle.arrays import Floats, PerMode, Truths, read_only
from auricle.errors import BandError, InputError
from auricle.sampling.chamber import Chamber
from auricle.surface.field import FieldMap
from auricle.surface.filling import fill_unsampled

_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Tails:
    """How the error of some maps falls with the harmonics, each by itself.

    Attributes
    ----------
    squared_errors
        Squared nRMSE of the first 1, 2, …, K harmonics of each map, 1 − P(k), shape (M, K),
        over the area one can sample.
    source
        Where the maps are from, in a few words.
    """

    squared_errors: Floats
    source: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "squared_errors", read_only(self.squared_errors, np.float64))
        errors = self.squared_errors
        if errors.ndim != 2 or not errors.size:
            raise InputError(f"tails of shape {errors.shape}: give one row a map, at least one")
        if not (np.isfinite(errors).all() and (errors >= 0).all()):
            raise InputError("a tail is one finite number of at least 0 a harmonic")

    @property
    def n_maps(self) -> int:
        """Number of maps."""
        return len(self.squared_errors)

    @property
    def n_modes(self) -> int:
        """Number of harmonics the tails go up to."""
        return int(self.squared_errors.shape[1])

    def at(self, quantile: float) -> PerMode:
        """The tail that a share `quantile` of the maps stays below, mode by mode, shape (K,)."""
        _require_quantile(quantile)
        tail: PerMode = np.quantile(self.squared_errors, quantile, axis=0)
        return tail

    def modes_for_power(self, share: float, *, quantile: float = 0.5) -> int:
        """Number of harmonics from which on that share of the maps keeps 1 − P(k) ≤ 1 − share.

        Raises
        ------
        BandError
            If the harmonics at hand are too few.
        """
        if not 0 < share <= 1:
            raise InputError(f"a share of power lies in (0, 1], not {share}")
        return first_within(self.at(quantile), 1 - share)


def first_within(tail: PerMode, bound: float) -> int:
    """Least number of harmonics from which on a tail stays within a bound.

    Raises
    ------
    BandError
        If even the last one exceeds it.

    Examples
    --------
    >>> first_within(np.array([1.0, 0.2, 0.3, 0.1]), 0.2)
    4
    """
    beyond = np.flatnonzero(tail > bound + _ROUNDING * max(bound, float(tail[0])))
    n_modes = int(beyond[-1]) + 2 if len(beyond) else 1
    if n_modes > len(tail):
        raise BandError(
            f"{len(tail)} harmonics leave {tail[-1]:.1%} of the power and {bound:.1%} is asked "
            "for: solve for more harmonics"
        )
    return n_modes


def truncation_tail(chamber: Chamber, values: Floats, *, known: Truths | None = None) -> PerMode:
    """Squared nRMSE of the first 1, 2, …, K harmonics of a map, shape (K,).

    Parameters
    ----------
    chamber
        What the map lies on.
    values
        Shape (n,), or (n, c) for a map of several columns, whose errors are added up. On the
        caps the map's continuation; unsampled vertices (NaN) are filled harmonically.
    known
        Where the error counts, shape (n,): where the map has values and is accessible, and in
        addition here; everywhere by default.

    Returns
    -------
    PerMode
        Area-weighted, relative to the map's variance over the same area. On a closed chamber of
        which all is accessible it is 1 − P(k) with P the cumulative power without the constant.

    Raises
    ------
    InputError
        If the map does not vary where the error counts, or lacks values on most of the surface.
    """
    field = FieldMap(chamber.mesh, values, "map")
    counts = chamber.accessible & field.sampled
    counts = counts if known is None else counts & known
    residual = fill_unsampled(field).values.reshape(chamber.mesh.n_vertices, -1).copy()
    if not counts.any():
        raise InputError("the map has no values where the chamber is accessible: choose another")
    weights = np.where(counts, chamber.basis.areas, 0.0) / chamber.basis.areas[counts].sum()
    # Far from zero rounding would swamp the tail; the constant harmonic comes first in any case.
    residual -= weights @ residual
    variance = float(weights @ (residual**2).sum(axis=1))
    if not variance > _ROUNDING**2 * float((np.nan_to_num(values) ** 2).max()):
        raise InputError("the map is constant: it has no bandwidth; choose one that varies")
    coefficients = chamber.basis.transform(residual)
    tail = np.empty(chamber.basis.n_modes)
    for mode, harmonic in enumerate(chamber.basis.modes.T):
        residual -= np.outer(harmonic, coefficients[mode])
        tail[mode] = weights @ (residual**2).sum(axis=1)
    return tail / variance


def _require_quantile(quantile: float) -> None:
    if not 0 <= quantile <= 1:
        raise InputError(f"a quantile lies in [0, 1], not {quantile}")
